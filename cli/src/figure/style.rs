//! The common style of all pictures: size, fonts, colours, labels.

use std::sync::Arc;

use asperity::record::Variable;
use asperity::scenario::Disorder;
use asperity_runner::output::Outcome;
use kuva::plot::{ColorMap, LegendEntry, LegendShape, MarkerShape};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::theme::Theme;

/// Colours that are distinguishable for colour-blind readers and in grey (Okabe and Ito, 2008).
pub const BLUE: &str = "#0072B2";
pub const ORANGE: &str = "#E69F00";
pub const RED: &str = "#D55E00";
pub const GREEN: &str = "#009E73";
pub const BLACK: &str = "#000000";
pub const WHITE: &str = "#FFFFFF";
pub const GREY: &str = "#767676";

/// Width of a picture with letters of the usual size, in units of the canvas, and height of a picture of one panel.
pub const WIDTH: f64 = 660.0;
pub const HEIGHT: f64 = 480.0;
/// Font size of the labels of axes, in units of the canvas.
pub const LABELS: f64 = 15.0;
/// Height of the label of the lowest of several panels.
pub const LABEL_HEIGHT: f64 = 26.0;
/// Left and right margins of panels above each other, so that their axes begin and end together.
pub const SIDES: (f64, f64) = (82.0, 16.0);
/// The same with an axis on the right.
pub const TWO_SIDES: (f64, f64) = (82.0, 66.0);

/// Dashes of lines.
pub const DASHES: &str = "8 5";

/// The canvas of a picture. Its unit is a fraction of the font size, so that large letters leave less room.
#[derive(Debug, Clone, Copy)]
pub struct Page {
    /// Width of a picture.
    pub width: f64,
    /// Height of panels over the usual one.
    stretch: f64,
    /// What is left free below a picture of one panel.
    free: f64,
}

impl Page {
    /// A canvas of this width whose pictures of one panel have this ratio of height to width.
    pub fn new(width: f64, aspect: Option<f64>) -> Self {
        let stretch = width * aspect.map_or(1.0 / WIDTH, |aspect| aspect / HEIGHT);
        Self { width, stretch, free: 0.0 }
    }

    /// The height of what is as high as this on the usual canvas.
    pub fn height(self, usual: f64) -> f64 {
        usual * self.stretch
    }

    /// The canvas on which so much is left free below a picture of one panel.
    pub fn with_free(self, free: f64) -> Self {
        Self { free, ..self }
    }

    /// The size of a picture of one panel, and the title above it, with a font size that fits its length.
    pub fn titled(self, layout: Layout, title: &str) -> Layout {
        let (text, size) = self.heading(title);
        let layout = layout.with_width(self.width).with_height(self.height(HEIGHT) - self.free);
        // The plot library leaves room above an empty title, too.
        if text.is_empty() { layout } else { layout.with_title(text).with_title_size(size) }
    }

    /// A title that fits on one line, shortened if needed, and its font size.
    pub fn heading(self, title: &str) -> (String, u32) {
        const SIZES: std::ops::RangeInclusive<usize> = 10..=15;
        // Letters of size s are about 0.58 s wide, and the axes begin to the right of the canvas's edge.
        let room = (self.width - 80.0).max(0.0) / 0.58;
        let length = title.chars().count();
        let size = ((room / length.max(1) as f64) as usize).clamp(*SIZES.start(), *SIZES.end());
        let most = ((room / size as f64) as usize).max(1);
        if length <= most {
            return (title.to_owned(), size as u32);
        }
        (title.chars().take(most - 1).chain(['…']).collect(), size as u32)
    }

    /// The title of a picture that shows some of many, such as maps, and its font size. Of a long title the user's words are
    /// shortened. Where no title is wanted there is none.
    pub fn heading_of_some(self, title: &str, [shown, all]: [usize; 2], what: &str) -> (String, u32) {
        if shown == all || title.is_empty() {
            return self.heading(title);
        }
        let some = format!(" ({shown} of {all} {what})");
        let whole = self.heading(&format!("{title}{some}"));
        if whole.0.ends_with(&some) {
            return whole;
        }
        let room = whole.0.chars().count().saturating_sub(some.chars().count() + 1);
        (title.chars().take(room).chain(['…']).collect::<String>() + &some, whole.1)
    }
}

/// Axes that include `x` and `y`, with the common fonts and lines.
pub fn layout(x: (f64, f64), y: (f64, f64)) -> Layout {
    let mut theme = Theme::light();
    theme.legend_border = "none".into();
    Layout::new(x, y)
        .with_x_axis_min(x.0)
        .with_x_axis_max(x.1)
        .with_y_axis_min(y.0)
        .with_y_axis_max(y.1)
        .with_x_tick_format(numbers(x))
        .with_y_tick_format(numbers(y))
        .with_y2_tick_format(TickFormat::Custom(Arc::new(number)))
        .with_theme(theme)
        .with_label_size(LABELS as u32)
        .with_tick_size(13)
        .with_body_size(12)
        .with_show_grid(false)
        .with_box_axes()
        .with_tick_align("in")
}

/// Fraction of contacts, or of the maximum of a curve, that is too small to be visible.
pub const INVISIBLE: f64 = 1e-3;

/// The smallest abscissa beyond which no curve exceeds a thousandth of its maximum.
pub fn reach(x: &[f64], curves: &[&[f64]]) -> f64 {
    let last = |curve: &&[f64]| {
        let high = range([*curve]).1;
        curve.iter().rposition(|&v| v > INVISIBLE * high)
    };
    let index = curves.iter().filter_map(last).max().map_or(x.len(), |i| i + 2);
    x[index.min(x.len()) - 1]
}

/// A legend entry for a line.
pub fn line(label: impl Into<String>, color: &str, dashes: Option<&str>) -> LegendEntry {
    LegendEntry {
        label: label.into(),
        color: color.into(),
        shape: LegendShape::Line,
        dasharray: dashes.map(str::to_owned),
    }
}

/// Colours of `count` curves in a row: up to five that can be told apart, more of them along Viridis but for its light end.
pub fn colours(count: usize) -> Vec<String> {
    const FEW: [&str; 5] = [BLUE, RED, GREEN, ORANGE, BLACK];
    const LIGHT: f64 = 0.9;
    if count <= FEW.len() {
        return FEW.map(str::to_owned).to_vec();
    }
    let place = |i: usize| LIGHT * i as f64 / (count - 1) as f64;
    (0..count).map(|i| ColorMap::Viridis.map(place(i))).collect()
}

/// A legend entry for markers.
pub fn marker(label: impl Into<String>, color: &str, shape: MarkerShape) -> LegendEntry {
    LegendEntry {
        label: label.into(),
        color: color.into(),
        shape: LegendShape::Marker(shape),
        dasharray: None,
    }
}

/// A legend entry for a shaded area.
pub fn area(label: impl Into<String>, color: &str) -> LegendEntry {
    LegendEntry { label: label.into(), color: color.into(), shape: LegendShape::Rect, dasharray: None }
}

/// `words (unit)`, or `words` without a unit.
pub fn axis(outcome: &Outcome, words: &str, variable: &Variable) -> String {
    match outcome.summary.units.label(variable.quantity).as_str() {
        "1" => words.to_owned(),
        unit => format!("{words} ({unit})"),
    }
}

/// The label of the ensemble.
pub fn ensemble(outcome: &Outcome) -> &'static str {
    match outcome.summary.disorder {
        Some(Disorder::Quenched) => "quenched ensemble",
        _ => "ensemble",
    }
}

/// The label of the ensemble with its number of contacts.
pub fn sized_ensemble(outcome: &Outcome) -> String {
    format!("{}, N = {}", ensemble(outcome), digits(outcome.summary.sample.unwrap_or(f64::NAN)))
}

/// `value` with five digits.
pub fn digits(value: f64) -> String {
    rounded(value, 4)
}

/// `value` with so many digits after the first one.
fn rounded(value: f64, decimals: usize) -> String {
    let rounded: f64 = format!("{value:.decimals$e}").parse().unwrap_or(value);
    asperity_runner::output::shortest(rounded)
}

/// Ticks of a linear axis: five digits, or as many as tell them apart.
pub fn numbers((low, high): (f64, f64)) -> TickFormat {
    /// Digits beyond the first one that differs, and the most that there are.
    const BEYOND: f64 = 2.0;
    const MOST: f64 = 14.0;
    let equal = (low.abs().max(high.abs()) / (high - low)).log10().ceil();
    let decimals = if equal > BEYOND { (equal + BEYOND).min(MOST) as usize } else { 4 };
    TickFormat::Custom(Arc::new(
        move |value| if decimals == 4 { number(value) } else { rounded(value, decimals) },
    ))
}

/// `value` with five digits as it is printed, a power of ten among them where it is very small or large.
fn number(value: f64) -> String {
    let digits = digits(value);
    if value == 0.0 || (1e-3..1e6).contains(&value.abs()) {
        return digits;
    }
    let scientific = digits.parse().map_or(digits, |rounded: f64| format!("{rounded:e}"));
    typeset_number(&scientific).unwrap_or(scientific)
}

/// A number as it is printed; `None` if the word is none that would change.
pub fn typeset_number(word: &str) -> Option<String> {
    word.parse::<f64>().ok().filter(|value| value.is_finite())?;
    let Some((mantissa, exponent)) = word.split_once('e') else { return Some(word.replace('-', "−")) };
    let mantissa = mantissa.replace('-', "−");
    let power = power(exponent.parse().ok()?);
    Some(match mantissa.as_str() {
        "1" => power,
        "−1" => format!("−{power}"),
        _ => format!("{mantissa} × {power}"),
    })
}

/// A value with its unit.
pub fn with_unit(value: f64, unit: &str) -> String {
    if unit == "1" { digits(value) } else { format!("{} {unit}", digits(value)) }
}

/// A value of a variable with its unit.
pub fn value_of(outcome: &Outcome, value: f64, variable: &Variable) -> String {
    with_unit(value, &outcome.summary.units.label(variable.quantity))
}

/// The smallest and the largest finite value of all curves.
pub fn range<'a>(curves: impl IntoIterator<Item = &'a [f64]>) -> (f64, f64) {
    let finite = curves.into_iter().flatten().copied().filter(|v| v.is_finite());
    finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// The upper end of an axis from 0, with a margin above `top`.
pub fn headroom(top: f64) -> f64 {
    if top > 0.0 { 1.08 * top } else { 1.0 }
}

/// The ends of a logarithmic axis, with margins around ascending values, and with two labels at least.
pub fn decades(values: &[f64]) -> (f64, f64) {
    let (first, last) = (values[0], values[values.len() - 1]);
    let air = (last / first).powf(0.03);
    with_labels((first / air, last * air))
}

/// A logarithmic axis that contains two of 1, 2 and 5 times powers of ten, which have labels on a short one.
pub fn with_labels((low, high): (f64, f64)) -> (f64, f64) {
    // Others have no logarithms, or no powers of ten beside them.
    if !(low > 1e-300 && high < 1e300) {
        return (low, high);
    }
    let exponents = low.log10().floor() as i32 - 1..=high.log10().floor() as i32 + 1;
    let labels: Vec<f64> = exponents.flat_map(|n| [1.0, 2.0, 5.0].map(|k| k * 10f64.powi(n))).collect();
    let (below, above) = (labels.partition_point(|at| *at < low), labels.partition_point(|at| *at <= high));
    let (lower, higher) = (labels[below - 1], labels[above]);
    match above - below {
        0 => (lower, higher),
        1 if low / lower < higher / high => (lower, high),
        1 => (low, higher),
        _ => (low, high),
    }
}

/// Minimum of an axis, relative to its maximum, above which 0 is not shown.
const SMALL: f64 = 0.5;

/// The range of a vertical axis: from 0, unless the curves would then look flat.
pub fn heights(low: f64, high: f64) -> (f64, f64) {
    if high <= 0.0 && low < 0.0 {
        let (low, high) = heights(-high, -low);
        // 0 less 0 has no sign.
        return (-high, 0.0 - low);
    }
    if low > SMALL * high {
        let air = 0.3 * (high - low);
        return (low - air, high + air);
    }
    from_zero(low, high)
}

/// The range of a vertical axis that 0 is on.
pub fn from_zero(low: f64, high: f64) -> (f64, f64) {
    let is_negative = high <= 0.0 && low < 0.0;
    (1.08 * low.min(0.0), if is_negative { 0.0 } else { headroom(high) })
}

/// Ticks of a logarithmic axis: powers of ten; decimals on a short axis near 1, which has ticks between them.
pub fn powers(ends: (f64, f64)) -> TickFormat {
    some_powers(ends, usize::MAX)
}

/// The same with labels at `most` powers of ten or fewer.
pub fn some_powers((low, high): (f64, f64), most: usize) -> TickFormat {
    let short = high < SHORT * low && low > 1e-4 && high < 1e4;
    let every = ((high / low).log10().floor() / most as f64).ceil().max(1.0);
    TickFormat::Custom(Arc::new(move |value: f64| {
        let exponent = value.log10();
        let whole = (exponent - exponent.round()).abs() < 1e-9;
        match whole && !short {
            true if exponent.round() % every != 0.0 => String::new(),
            true => power(exponent.round() + 0.0),
            false => digits(value),
        }
    }))
}

/// Ratio of the ends of a logarithmic axis from which on it has ticks at powers of ten alone.
const SHORT: f64 = 1e3;

/// A power of ten.
pub fn power(exponent: f64) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).map_or('⁻', |digit| RAISED[digit as usize]);
    format!("{exponent:.0}").chars().map(raise).fold("10".into(), |text, c| text + &c.to_string())
}

/// So many indices of a row of panels at most: all, or an even selection with the first and the last.
pub fn chosen(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    (0..most).map(|i| i * (count - 1) / (most - 1)).collect()
}

/// One of several panels above each other with these upper and lower margins, whose axes begin and end together.
pub fn stacked(layout: Layout, (above, below): (f64, f64), sides: (f64, f64)) -> Layout {
    layout
        .with_force_margins_y(above, below)
        .with_force_margins(sides.0, sides.1)
        .with_tick_size(11)
        .with_label_size(13)
}

/// Plots in the order in which they are drawn.
pub type Plots = Vec<Plot>;
