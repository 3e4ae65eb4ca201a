//! The ranges of vertical axes, read from the labels of their ticks.

use asperity::record::Record;

use super::{frames, tags};

/// Variables, each with the picture and the panel whose vertical axis shows them.
pub const SHOWN: [(&str, usize, &str); 23] = [
    ("catalogue", 0, "force"),
    ("creep", 0, "drive"),
    ("creep_rate", 0, "creep_velocity"),
    ("fit", 0, "measured_force"),
    ("fit", 1, "whitened_residual"),
    ("force", 0, "force"),
    ("force", 0, "compared_force"),
    ("free_form", 0, "free_form_density"),
    ("hold_curve", 0, "static_friction"),
    ("hysteresis", 0, "force"),
    ("protocol", 1, "force"),
    ("slip", 0, "slip_position"),
    ("slip", 1, "slip_velocity"),
    ("slip", 2, "slip_force"),
    ("spectrum", 0, "spectrum"),
    ("spectrum", 0, "fit_expected_periodogram"),
    ("stability", 0, "stiffness"),
    ("static_fatigue", 0, "failure_time"),
    ("stick_slip", 0, "spring_force"),
    ("stick_slip", 0, "ensemble_spring_force"),
    ("stress_map", 0, "row"),
    ("thresholds", 0, "measured_density"),
    ("velocity_curve", 0, "kinetic_friction"),
];

/// The least part of an axis that the values on it take: what is shown is neither flat nor in a corner.
const LEAST: f64 = 0.5;
/// Places of ticks are rounded to a hundredth of a unit of the canvas, of the hundred and more between the outermost ones.
const ROUNDING: f64 = 2e-4;

/// Every value is within the range of its axis and the values together fill half of it. Gives the numbers of the checked ones.
pub fn check(place: &str, name: &str, svg: &str, record: &Record) -> Vec<usize> {
    let of_picture = SHOWN.iter().enumerate().filter(|(_, shown)| shown.0 == name);
    let with_values = of_picture.filter_map(|(number, shown)| Some((number, shown, record.values(shown.2)?)));
    with_values
        .map(|(number, (_, panel, variable), values)| {
            let axis = Axis::of(svg, *panel);
            let at = |value: &f64| axis.share(*value);
            let known: Vec<f64> = values.iter().map(at).filter(|share| share.is_finite()).collect();
            let least = known.iter().copied().fold(f64::INFINITY, f64::min);
            let most = known.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            assert!(
                least > -ROUNDING && most < 1.0 + ROUNDING,
                "{place}: {variable} from {least} to {most} of the axis"
            );
            assert!(most - least > LEAST, "{place}: {variable} fills {} of the axis", most - least);
            number
        })
        .collect()
}

/// A vertical axis: two values, where they are as parts of the height from below, and whether it is logarithmic.
struct Axis {
    ticks: [(f64, f64); 2],
    is_logarithmic: bool,
}

impl Axis {
    fn of(svg: &str, panel: usize) -> Self {
        let [left, top, _, height] = frames(svg)[panel];
        let within =
            |x: f64, y: f64| (left - 60.0..left).contains(&x) && (top - 1.0..top + height + 1.0).contains(&y);
        let mut ticks: Vec<(f64, f64)> = labels(svg)
            .into_iter()
            .filter(|(x, y, _)| within(*x, *y))
            .map(|(_, y, value)| (value, (top + height - y) / height))
            .collect();
        ticks.sort_by(|a, b| a.1.total_cmp(&b.1));
        assert!(ticks.len() > 1, "panel {panel} has less than two ticks");
        let linear = Self { ticks: [ticks[0], ticks[ticks.len() - 1]], is_logarithmic: false };
        let logarithmic = Self { is_logarithmic: true, ..linear };
        // Logarithms are of positive numbers only.
        if ticks[0].0 <= 0.0 {
            return linear;
        }
        let misfit =
            |axis: &Self| ticks.iter().map(|(value, at)| (axis.share(*value) - at).abs()).fold(0.0, f64::max);
        // With two ticks both fit: those of a linear axis are not ten times apart.
        let decades = ticks.len() == 2 && ticks[1].0 / ticks[0].0 > 9.0;
        if decades || misfit(&logarithmic) < misfit(&linear) { logarithmic } else { linear }
    }

    /// Where a value is, as a part of the height from below.
    fn share(&self, value: f64) -> f64 {
        let scale = |value: f64| if self.is_logarithmic { value.ln() } else { value };
        let [low, high] = self.ticks;
        low.1 + (high.1 - low.1) * (scale(value) - scale(low.0)) / (scale(high.0) - scale(low.0))
    }
}

/// Numbers that end where they stand, as those beside vertical axes: where, the middle of their height, and their values.
fn labels(svg: &str) -> Vec<(f64, f64, f64)> {
    /// Height of the middle of digits over the font size.
    const MIDDLE: f64 = 0.3645;
    let placed = tags(svg).into_iter().filter(|tag| tag.text.contains("text-anchor=\"end\""));
    placed
        .filter_map(|tag| {
            let attribute =
                |key: &str| super::numbers(tag.text, key, '"').and_then(|found| found.first().copied());
            let (x, y, size) = (attribute(" x=\"")?, attribute(" y=\"")?, attribute("font-size=\"")?);
            Some((tag.at[0] + x, tag.at[1] + y - MIDDLE * size, number(tag.content)?))
        })
        .collect()
}

/// The value of a label such as −0.5 or 2 × 10⁻³.
fn number(label: &str) -> Option<f64> {
    let plain = label.replace('−', "-");
    if let Ok(value) = plain.parse() {
        return Some(value);
    }
    let (factor, power) = plain.split_once(" × ").unwrap_or(("1", &plain));
    let digit = |letter: char| match letter {
        '⁻' => Some('-'),
        '¹' => Some('1'),
        '²' => Some('2'),
        '³' => Some('3'),
        _ => char::from_digit((letter as u32).checked_sub('⁰' as u32)?, 10),
    };
    let exponent: Option<String> = power.strip_prefix("10")?.chars().map(digit).collect();
    Some(factor.parse::<f64>().ok()? * 10f64.powi(exponent?.parse().ok()?))
}
