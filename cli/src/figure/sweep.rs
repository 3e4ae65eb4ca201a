//! Pictures of a sweep: lines over one axis, with the scatter of replicas, and maps over two.

use std::sync::Arc;

use asperity_runner::sweep::{Axis, Dataset, Labelled, Values};
use kuva::plot::{ColorMap, MarkerShape};
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{curve, errors, line};
use super::field::{self, Field, bar, room, scale};
use super::grid::Grid;
use super::style::{self, BLACK, BLUE, GREEN, GREY, ORANGE, Page, Plots, RED};
use super::sweep_label::label;
use super::{legend, ticks};

/// Colours of words that are known, as in the picture of `[stability]`.
const KNOWN: [(&str, &str); 5] =
    [("smooth", LIGHT), ("none", LIGHT), ("transient", BLUE), ("persistent", ORANGE), ("undecided", BLACK)];
const LIGHT: &str = "#C8C8C8";
/// Colours of other words, in their order.
const COLOURS: [&str; 6] = [GREEN, RED, GREY, BLUE, ORANGE, LIGHT];
/// Colour of what has no value.
const NONE: &str = "#FFFFFF";
/// Width of the panel of the colour scale beside its numbers, the least room for them, and the margins of the map.
const BAR: f64 = 49.0;
const ROOM: f64 = 56.0;
const MARGINS: (f64, f64) = (12.0, 56.0);

/// The pictures that can be drawn, each with its name.
pub fn scenes(dataset: &Dataset, page: Page) -> Vec<(String, Scene)> {
    let drawn =
        dataset.variables.iter().filter(|variable| variable.name != "failure" && variable.name != "accuracy");
    drawn
        .filter_map(|variable| {
            Some((variable.name.clone(), legend::fitted(page, |page| scene((dataset, page), variable))?))
        })
        .collect()
}

/// A variable over the dimensions that it has beside that of replicas.
fn scene((dataset, page): (&Dataset, Page), variable: &Labelled) -> Option<Scene> {
    let all: Vec<&Axis> = dataset.axes.iter().chain(&dataset.grids).collect();
    let along =
        variable.dimensions.iter().filter_map(|name| all.iter().find(|axis| axis.name == *name).copied());
    let axes: Vec<&Axis> = along.collect();
    let drawn: Vec<&Axis> = axes.iter().copied().filter(|axis| axis.name != "repeat").collect();
    match (&drawn[..], &variable.values) {
        ([x], Values::Numbers(numbers)) => lines((dataset, page), variable, x, &replicas(&axes, numbers)),
        ([y, x], Values::Numbers(numbers)) => {
            let means: Vec<f64> = replicas(&axes, numbers).iter().map(|found| found.0).collect();
            map((dataset, page), variable, [x, y], &means)
        }
        ([y, x], Values::Texts(words)) if axes.len() == 2 => kinds((dataset, page), [x, y], words),
        _ => None,
    }
}

/// Mean and standard error over replicas, which are the last axis of the sweep, of each place along the other dimensions. A value
/// that is not there for one of them is not there at all.
fn replicas(axes: &[&Axis], numbers: &[f64]) -> Vec<(f64, f64)> {
    let Some(place) = axes.iter().position(|axis| axis.name == "repeat") else {
        return numbers.iter().map(|&number| (number, 0.0)).collect();
    };
    let count = axes[place].length;
    let inner: usize = axes[place + 1..].iter().map(|axis| axis.length).product();
    let mut found = Vec::new();
    for block in numbers.chunks_exact(count * inner) {
        for i in 0..inner {
            let values: Vec<f64> = block[i..].iter().step_by(inner).copied().collect();
            let mean = values.iter().sum::<f64>() / count as f64;
            let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
            let variance = if count > 1 { squares / (count - 1) as f64 } else { 0.0 };
            found.push((mean, (variance / count as f64).sqrt()));
        }
    }
    found
}

/// The places along an axis, if they are numbers, and their label, with those of the keys that change with them.
fn places(axis: &Axis) -> Option<(&[f64], String)> {
    let Values::Numbers(numbers) = &axis.coordinates[0].values else { return None };
    let labels: Vec<String> = axis.coordinates.iter().map(label).collect();
    Some((numbers, labels.join("; ")))
}

/// Whether rising values are drawn on a logarithmic axis: over a narrow one there would be no ticks.
fn is_logarithmic(axis: &Axis, values: &[f64]) -> bool {
    const NARROW: f64 = 3.0;
    axis.is_logarithmic() && values[values.len() - 1] >= NARROW * values[0]
}

fn lines(
    (dataset, page): (&Dataset, Page),
    variable: &Labelled,
    axis: &Axis,
    found: &[(f64, f64)],
) -> Option<Scene> {
    let (x, words) = places(axis)?;
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|&a, &b| x[a].total_cmp(&x[b]));
    let column = |of: &dyn Fn(usize) -> f64| order.iter().map(|&i| of(i)).collect::<Vec<f64>>();
    let (x, y) = (column(&|i| x[i]), column(&|i| found[i].0));
    let error = column(&|i| found[i].1);
    let (low, high) = style::range([y.as_slice()]);
    if x.len() < 2 || low > high {
        return None;
    }
    let mut plots = Plots::new();
    plots.push(line(curve(&x, &y), BLUE, 2.0, None));
    // Replicas that are equal differ by rounding at most.
    let scattered = error.iter().any(|&error| error > 1e-9 * high.abs().max(low.abs()));
    plots.extend(errors(&x, &y, if scattered { &error } else { &[] }, BLUE));
    let logarithmic = is_logarithmic(axis, &x);
    let ends = if logarithmic { style::decades(&x) } else { (x[0], x[x.len() - 1]) };
    let (low, high) = if high > low { style::heights(low, high) } else { scale(&y) };
    let mut layout = style::layout(ends, (low, high));
    if logarithmic {
        layout = layout.with_log_x().with_x_tick_format(style::powers(ends));
    }
    let layout = page.titled(layout, &dataset.title).with_x_label(words).with_y_label(label(variable));
    Some(ticks::panel(plots, layout))
}

/// An axis of a map: the centres of its cells in the coordinate that is drawn.
struct Side {
    /// The indices of the values in rising order.
    order: Vec<usize>,
    range: (f64, f64),
    /// Whether the coordinate is the decimal logarithm.
    exponents: bool,
    ticks: TickFormat,
    label: String,
}

impl Side {
    /// Cells have equal widths: in the value or its logarithm if these are evenly spaced, otherwise in the number of the value.
    fn new(axis: &Axis) -> Option<Self> {
        let (values, label) = places(axis)?;
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let sorted: Vec<f64> = order.iter().map(|&i| values[i]).collect();
        let (first, last) = (*sorted.first()?, *sorted.last()?);
        let edges = |low: f64, high: f64| {
            let half = 0.5 * (high - low) / (sorted.len() - 1).max(1) as f64;
            (low - half, high + half)
        };
        if sorted.len() < 2 {
            return None;
        }
        if is_logarithmic(axis, &sorted) {
            let range = edges(first.log10(), last.log10());
            let numbers = if first < 1e-3 || last >= 1e5 { powers } else { short };
            let ticks = TickFormat::Custom(Arc::new(move |place: f64| numbers(10f64.powf(place))));
            return Some(Self { order, range, exponents: true, ticks, label });
        }
        let step = (last - first) / (sorted.len() - 1) as f64;
        // Rounding of values that are evenly spaced.
        let even = sorted.windows(2).all(|pair| ((pair[1] - pair[0]) / step - 1.0).abs() < 1e-6);
        if even {
            let range = edges(first, last);
            return Some(Self { order, range, exponents: false, ticks: style::numbers(range), label });
        }
        let count = sorted.len();
        let named = move |place: f64| {
            let index = place.round();
            let whole = (place - index).abs() < 1e-6 && index >= 0.0 && index < sorted.len() as f64;
            if whole { style::digits(sorted[index as usize]) } else { String::new() }
        };
        let range = (-0.5, count as f64 - 0.5);
        Some(Self { order, range, exponents: false, ticks: TickFormat::Custom(Arc::new(named)), label })
    }

    /// Whether ticks are at powers of ten: where there are two of them or more.
    fn decades(&self) -> bool {
        self.exponents && self.range.1.floor() > self.range.0.ceil()
    }
}

/// A number with three digits.
fn short(value: f64) -> String {
    style::digits(format!("{value:.2e}").parse().unwrap_or(value))
}

/// The same with a power of ten.
fn powers(value: f64) -> String {
    let digits = short(value);
    let scientific = digits.parse().map_or(digits, |rounded: f64| format!("{rounded:e}"));
    style::typeset_number(&scientific).unwrap_or(scientific)
}

/// The values row by row, in rising order along both sides.
fn sorted(values: &[f64], [x, y]: [&Side; 2]) -> Vec<f64> {
    y.order
        .iter()
        .flat_map(|&row| x.order.iter().map(move |&column| values[row * x.order.len() + column]))
        .collect()
}

fn layout([x, y]: [&Side; 2]) -> Layout {
    let mut layout = field::axes(x.range, y.range);
    if x.decades() {
        layout = layout.with_x_tick_step(1.0);
    }
    if y.decades() {
        layout = layout.with_y_tick_step(1.0);
    }
    layout
        .with_x_tick_format(x.ticks.clone())
        .with_y_tick_format(y.ticks.clone())
        .with_x_label(x.label.clone())
        .with_y_label(y.label.clone())
}

/// Numbers over two axes, with a colour scale.
fn map(
    (dataset, page): (&Dataset, Page),
    variable: &Labelled,
    axes: [&Axis; 2],
    values: &[f64],
) -> Option<Scene> {
    let [x, y] = [Side::new(axes[0])?, Side::new(axes[1])?];
    if !values.iter().any(|value| value.is_finite()) {
        return None;
    }
    let values = sorted(values, [&x, &y]);
    let ends = scale(&values);
    let colours = ColorMap::Custom(Arc::new(|part: f64| match part.is_finite() {
        true => ColorMap::Viridis.map(part.clamp(0.0, 1.0)),
        false => NONE.to_owned(),
    }));
    let field = Field { values: &values, sides: [y.order.len(), x.order.len()], x: x.range, y: y.range };
    let left = room(y.range, &y.ticks, 13.0).max(style::SIDES.0);
    let layout = layout([&x, &y]).with_force_margins(left, style::SIDES.1);
    let layout = layout.with_force_margins_y(MARGINS.0, MARGINS.1);
    let (scale_plots, scale_axes) = bar(ends, &ColorMap::Viridis, &label(variable));
    let room = room(ends, &style::numbers(ends), 11.0).max(ROOM);
    let grid = Grid::new(1, 2, (page.width - BAR - room, page.height(style::HEIGHT) - 40.0))
        .with_structure(vec![vec![0], vec![1]])
        .with_title(page.heading(&dataset.title))
        .with_column_width(1, BAR + room);
    let axes = scale_axes.with_force_margins(room, 14.0).with_force_margins_y(MARGINS.0, MARGINS.1);
    let plots: Plots = vec![field.plot(ends, &colours, 1)];
    let exponents = [[x.exponents, y.exponents], [false; 2]];
    Some(ticks::panels_of_exponents(grid, vec![plots, scale_plots], vec![layout, axes], &exponents))
}

/// Words over two axes, each with its colour.
fn kinds((dataset, page): (&Dataset, Page), axes: [&Axis; 2], words: &[String]) -> Option<Scene> {
    let [x, y] = [Side::new(axes[0])?, Side::new(axes[1])?];
    let mut known: Vec<&String> = words.iter().filter(|word| !word.is_empty()).collect();
    known.sort();
    known.dedup();
    if known.is_empty() || known.len() > COLOURS.len() {
        return None;
    }
    let number = |word: &String| known.iter().position(|known| *known == word).map_or(f64::NAN, |i| i as f64);
    let values = sorted(&words.iter().map(number).collect::<Vec<_>>(), [&x, &y]);
    let last = (known.len() - 1).max(1) as f64;
    let chosen: Vec<&str> = known.iter().zip(COLOURS).map(|(word, other)| colour(word, other)).collect();
    let drawn = chosen.clone();
    let colours = ColorMap::Custom(Arc::new(move |part: f64| match part.is_finite() {
        true => drawn[((part * last).round() as usize).min(drawn.len() - 1)].to_owned(),
        false => NONE.to_owned(),
    }));
    let field = Field { values: &values, sides: [y.order.len(), x.order.len()], x: x.range, y: y.range };
    let entries = known.iter().zip(&chosen);
    let mut legend: Vec<_> =
        entries.map(|(word, color)| style::marker(word.as_str(), color, MarkerShape::Square)).collect();
    if values.iter().any(|value| value.is_nan()) {
        legend.push(style::marker("no value", NONE, MarkerShape::Square));
    }
    let plots: Vec<Plot> = vec![field.plot((0.0, last), &colours, 1)];
    let layout = page.titled(layout([&x, &y]), &dataset.title);
    let exponents = [x.exponents, y.exponents];
    Some(legend::placed(ticks::panel_of_exponents(plots, layout, exponents), &legend, &[0]))
}

/// The colour of a word.
fn colour(word: &str, other: &'static str) -> &'static str {
    KNOWN.iter().find(|(known, _)| *known == word).map_or(other, |(_, colour)| colour)
}
