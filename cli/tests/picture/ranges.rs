//! The ranges of vertical axes, read from the labels of their ticks.

use asperity::record::Record;
use asperity_runner::output::Outcome;

use super::{frames, tags};

/// Variables, each with the picture and the panel whose vertical axis shows them.
const SHOWN: [(&str, usize, &str); 28] = [
    ("catalogue", 0, "force"),
    ("creep", 0, "drive"),
    ("covariance", 0, "covariance_position"),
    ("creep_rate", 0, "creep_velocity"),
    ("distribution", 0, "steady_stretch_density"),
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
    ("slip_rate", 0, "slip_rate_time"),
    ("slip_rate", 1, "slip_rate_step"),
    ("spectrum", 0, "spectrum"),
    ("spectrum", 0, "fit_expected_periodogram"),
    ("stability", 0, "stiffness"),
    ("static_fatigue", 0, "failure_time"),
    ("stick_slip", 0, "spring_force"),
    ("stick_slip", 0, "ensemble_spring_force"),
    ("stick_slip_scatter", 0, "ensemble_persistent"),
    ("stress_map", 0, "row"),
    ("thresholds", 0, "measured_density"),
    ("velocity_curve", 0, "kinetic_friction"),
];

/// Computes what an axis shows from a result.
type Values = fn(&Outcome) -> Option<Vec<f64>>;

/// The same for axes that show what is computed from variables.
const COMPUTED: [(&str, usize, Values); 10] = [
    ("corner", 1, |outcome| posterior(outcome, 1)),
    ("correlation", 0, |outcome| relative(outcome.record.values("autocovariance")?)),
    ("creep_curve", 0, |outcome| slip_since_loading(&outcome.record)),
    ("equilibrium", 0, |outcome| first_loading(&outcome.record, outcome.record.values("branch_drive")?)),
    ("evolution", 0, |outcome| first_density(&outcome.record)),
    ("main_shocks", 0, |outcome| around_main_shocks(&outcome.record)),
    ("potential", 0, |outcome| potentials(&outcome.record)),
    ("space_time", 0, |outcome| advance(&outcome.record)),
    ("sizes", 0, |outcome| events_of_one_contact(&outcome.record)),
    ("velocity_step", 0, after_the_first_step),
];

/// Standard deviations of thresholds over which scenarios of sweeps go, on the vertical axes of their maps.
const SWEPT: [(&str, [f64; 2]); 6] = [
    ("critical_stiffness", [0.05, 0.3]),
    ("critical_stiffness_sliding", [0.05, 0.3]),
    ("mean_drop", [0.02, 0.4]),
    ("period", [0.02, 0.4]),
    ("regime", [0.02, 0.4]),
    ("slips", [0.02, 0.4]),
];

/// How many axes are checked.
pub fn count() -> usize {
    SHOWN.len() + COMPUTED.len() + SWEPT.len()
}

/// Whether an axis of a picture is checked.
pub fn has(name: &str) -> bool {
    SHOWN.iter().any(|shown| shown.0 == name)
        || COMPUTED.iter().any(|shown| shown.0 == name)
        || SWEPT.iter().any(|shown| shown.0 == name)
}

/// The density at the first snapshot, if not all contacts are in point masses.
fn first_density(record: &Record) -> Option<Vec<f64>> {
    let density = record.row("stretch_density", 0)?;
    density.iter().any(|value| *value > 0.0).then(|| density.to_vec())
}

/// The time of the maps of an interface that follows a protocol, and the drive of others.
fn advance(record: &Record) -> Option<Vec<f64>> {
    Some(record.values("map_time").or_else(|| record.values("map_drive"))?.to_vec())
}

/// The rates around main shocks that a logarithmic axis shows.
fn around_main_shocks(record: &Record) -> Option<Vec<f64>> {
    let rates = [record.values("aftershock_rate")?, record.values("foreshock_rate")?].concat();
    Some(rates.into_iter().filter(|&rate| rate > 0.0).collect())
}

/// The draws of a number of a posterior.
fn posterior(outcome: &Outcome, number: usize) -> Option<Vec<f64>> {
    let reported = outcome.summary.numbers.fit()?.posterior.as_ref()?;
    let draws = outcome.record.values("posterior_value")?;
    Some(draws.chunks_exact(reported.chains * reported.draws).nth(number)?.to_vec())
}

/// Values over the first one.
fn relative(values: &[f64]) -> Option<Vec<f64>> {
    Some(values.iter().map(|value| value / values[0]).collect())
}

fn slip_since_loading(record: &Record) -> Option<Vec<f64>> {
    let loaded = record.values("loaded_position")?;
    let row = |i: usize| Some(record.row("creep_position", i)?.iter().map(move |at| at - loaded[i]));
    Some((0..loaded.len()).filter_map(row).flatten().collect())
}

/// Those of the values along the first loading that are at positions up to 1.5 times the end of the first slip, which are drawn.
fn first_loading(record: &Record, values: &[f64]) -> Option<Vec<f64>> {
    let position = record.values("branch_position")?;
    let end =
        record.values("event_position_turn").and_then(|turn| turn.first()).copied().unwrap_or(f64::INFINITY);
    Some(values.iter().zip(position).filter(|(_, at)| **at <= 1.5 * end).map(|(value, _)| *value).collect())
}

/// The potentials along the first loading, less those at its beginning.
fn potentials(record: &Record) -> Option<Vec<f64>> {
    let (position, start) =
        (record.values("branch_position")?, *record.values("event_position_before")?.first()?);
    let origin = position.partition_point(|at| *at < start);
    let rows = (0..record.values("potential_drive")?.len()).filter_map(|row| record.row("potential", row));
    let relative = rows.flat_map(|row| first_loading(record, row).map(|values| (values, row[origin])));
    Some(relative.flat_map(|(values, zero)| values.into_iter().map(move |value| value - zero)).collect())
}

/// The number of events in which one contact broke, the largest one.
fn events_of_one_contact(record: &Record) -> Option<Vec<f64>> {
    Some(vec![*record.values("size_events")?.first()?])
}

/// The forces after the first velocity step.
fn after_the_first_step(outcome: &Outcome) -> Option<Vec<f64>> {
    let step = outcome.summary.numbers.steps().iter().find(|step| step.rate_state.is_some())?;
    let (position, force) = (outcome.record.values("position")?, outcome.record.values("force")?);
    let (start, end) = (step.position, step.position + step.velocity * step.duration);
    Some(
        position
            .iter()
            .zip(force)
            .filter(|(at, _)| (start..=end).contains(*at))
            .map(|(_, force)| *force)
            .collect(),
    )
}

/// The least part of an axis that the values on it take: what is shown is neither flat nor in a corner.
const LEAST: f64 = 0.5;
/// Places of ticks are rounded to a hundredth of a unit of the canvas, of the hundred and more between the outermost ones.
const ROUNDING: f64 = 2e-4;

/// Every value is within the range of its axis and the values together fill half of it. Gives the numbers of the checked ones. Of
/// pictures without an entry, a variable of the result fills the first axis.
pub fn check(place: &str, name: &str, svg: &str, outcome: Option<&Outcome>) -> Vec<usize> {
    if !has(name) {
        let axis = Axis::of(svg, 0);
        let variables = outcome.map_or(&[][..], |outcome| &outcome.record.variables);
        assert!(
            variables.iter().any(|variable| fills(&axis, &variable.values)),
            "{place}: no variable fills the axis"
        );
    }
    let shown = SHOWN.iter().map(|(of, panel, variable)| {
        let values = outcome.and_then(|outcome| outcome.record.values(variable));
        (*of, *panel, values.map(<[f64]>::to_vec))
    });
    let computed = COMPUTED.iter().map(|(of, panel, values)| (*of, *panel, outcome.and_then(values)));
    let swept = SWEPT.iter().map(|(of, ends)| (*of, 0, Some(ends.to_vec())));
    let all = shown.chain(computed).chain(swept).enumerate();
    let with_values =
        all.filter_map(|(i, (of, panel, values))| Some((i, panel, values.filter(|_| of == name)?)));
    let checked = with_values.map(|(i, panel, values)| {
        is_shown(&format!("{place}, panel {panel}"), &Axis::of(svg, panel), &values);
        i
    });
    checked.collect()
}

/// The parts of an axis where the least and the largest of the values are.
fn range(axis: &Axis, values: &[f64]) -> [f64; 2] {
    let known = values.iter().map(|value| axis.share(*value)).filter(|share| share.is_finite());
    [known.clone().fold(f64::INFINITY, f64::min), known.fold(f64::NEG_INFINITY, f64::max)]
}

fn fills(axis: &Axis, values: &[f64]) -> bool {
    let [least, most] = range(axis, values);
    least > -ROUNDING && most < 1.0 + ROUNDING && most - least > LEAST
}

fn is_shown(place: &str, axis: &Axis, values: &[f64]) {
    let [least, most] = range(axis, values);
    assert!(least > -ROUNDING && most < 1.0 + ROUNDING, "{place}: from {least} to {most} of the axis");
    assert!(most - least > LEAST || values.len() == 1, "{place}: {} of the axis", most - least);
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
