//! Text of the summary for motion in time: steps, curves, and rate-and-state parameters.

use asperity::rate_state::{MeasuredValue, StateLaw};
use asperity::record::Quantity;
use asperity::task::summary::{
    CurveLimits, Fitted, HealingCurve, MeasuredRateState, ProtocolStep, RateState, SlidingStability,
    SpringRateState, Summary,
};

use super::fit::probability;
use super::{digits, fitted, with_unit};

/// Largest number of steps that are listed.
const LISTED: usize = 12;
/// Adds lines in the form of the rest of the summary.
pub fn lines(summary: &Summary) -> Vec<(&'static str, String)> {
    let mut lines: Vec<_> =
        summary.numbers.limits().iter().flat_map(|limits| ends(summary, limits)).collect();
    lines.extend(
        summary.numbers.stability().into_iter().map(|found| ("steady sliding", stable(summary, found))),
    );
    for step in summary.numbers.steps().iter().take(LISTED) {
        lines.push(("step", step_text(summary, step)));
        let forces = [("at the end", Some(step.force)), ("maximum", Some(step.peak.force))];
        let forces = forces.into_iter().chain([("kinetic", step.kinetic_friction)]);
        let load = summary.normal_load.map(|load| step.load() * load);
        lines.extend(coefficients(load, "  coefficients", forces));
        if let Some(read) = &step.rate_state {
            lines.push(("  rate and state", read_as(summary, read)));
            lines.extend(coefficients(load, "", [("a =", Some(read.a)), ("b =", Some(read.b))]));
        }
        let computed = step.rate_state_spring.iter();
        lines.extend(computed.flat_map(|read| behind_spring(summary, load, "  rate and state", read)));
        lines.extend(step.measured.iter().flat_map(|read| measured(summary, load, read)));
        let compared = step.measured_spring.iter();
        lines.extend(compared.flat_map(|read| behind_spring(summary, load, "  compared curve", read)));
        lines.extend(
            step.not_read.iter().map(|why| ("  compared curve", format!("not read as a step: {why}"))),
        );
    }
    if summary.numbers.steps().len() > LISTED {
        lines.push(("", format!("and {} more steps", summary.numbers.steps().len() - LISTED)));
    }
    if let Some(curve) = summary.numbers.hold_curve() {
        lines.extend(healed(summary, curve));
    }
    lines
}

/// A value with five digits, the accuracy of motion in time.
fn value(summary: &Summary, number: f64, quantity: Quantity) -> String {
    let rounded = format!("{number:.4e}").parse().unwrap_or(number);
    with_unit(digits(rounded), number, &summary.units.label(quantity))
}

/// Forces divided by the normal load, each after its name, if there is one.
fn coefficients<'a>(
    load: Option<f64>,
    name: &'static str,
    forces: impl IntoIterator<Item = (&'a str, Option<f64>)>,
) -> Option<(&'static str, String)> {
    let load = load?;
    let all = forces.into_iter().filter_map(|(name, force)| {
        let rounded = format!("{:.4e}", force? / load).parse().unwrap_or(f64::NAN);
        Some(format!("{name} {}", digits(rounded)))
    });
    let kind = if name.is_empty() { " (friction coefficients)" } else { "" };
    Some((name, format!("{}{kind}", all.collect::<Vec<_>>().join(", "))))
}

fn ends(summary: &Summary, limits: &CurveLimits) -> Vec<(&'static str, String)> {
    let at = limits
        .temperature
        .map_or(String::new(), |t| format!(" at T = {}", value(summary, t, Quantity::Energy)));
    let force = |number| value(summary, number, Quantity::Force);
    let mut lines = vec![("fast sliding", format!("F_k → {}{at}", force(limits.fast)))];
    lines.extend(limits.slow.map(|slow| ("slow sliding", format!("F_k → {}{at}", force(slow)))));
    lines.extend(limits.viscosity.map(|viscosity| {
        ("slow sliding", format!("F_k → {}·v{at}", value(summary, viscosity, Quantity::Number)))
    }));
    let both = [("fast", Some(limits.fast)), ("slow", limits.slow)];
    let coefficients = coefficients(summary.normal_load, "friction coefficients", both);
    lines.extend(coefficients.map(|(name, text)| (name, format!("{text}{at}"))));
    lines
}

/// The stability of steady sliding, without mass and damping or with those of the block.
fn stable(summary: &Summary, found: &SlidingStability) -> String {
    let stiffness = found.critical_stiffness_sliding.0;
    let who = match found.unstable {
        None => "of a slider without mass and damping".to_owned(),
        Some(0) => "of this block, stable at all velocities".to_owned(),
        Some(unstable) => format!("of this block, unstable at {unstable} of {} velocities", found.velocities),
    };
    match stiffness {
        _ if stiffness <= 0.0 => format!("{who}: stable for any stiffness K"),
        _ if stiffness.is_finite() => {
            format!("{who}: stable for K > {}", value(summary, stiffness, Quantity::Stiffness))
        }
        _ => format!("{who}: unstable for any stiffness K"),
    }
}

fn step_text(summary: &Summary, step: &ProtocolStep) -> String {
    let time = value(summary, step.duration, Quantity::Time);
    let force = value(summary, step.force, Quantity::Force);
    let velocity = |number| value(summary, number, Quantity::Velocity);
    let motion = match (step.velocity_from, step.pieces.unwrap_or(1)) {
        (Some(from), pieces) => {
            format!("v from {} to {} for {time}, in {pieces} pieces", velocity(from), velocity(step.velocity))
        }
        (None, _) if step.velocity == 0.0 => format!("hold of {time}"),
        (None, _) => format!("v = {} for {time}", velocity(step.velocity)),
    };
    let load = step
        .relative_normal_load
        .map_or(String::new(), |load| format!(", normal load × {}", value(summary, load, Quantity::Number)));
    let peak = value(summary, step.peak.force, Quantity::Force);
    let steady = step
        .kinetic_friction
        .map_or(String::new(), |f| format!(", F_k = {}", value(summary, f, Quantity::Force)));
    format!("{motion}{load}: F = {force} at the end, maximum {peak}{steady}")
}

fn read_as(summary: &Summary, read: &RateState) -> String {
    let (a, b) = (short(summary, read.a, Quantity::Force), short(summary, read.b, Quantity::Force));
    let distance = short(summary, read.distance, Quantity::Length);
    let residual = percent(read.residual_relative);
    format!("a = {a}, b = {b}, D_c = {distance}, residual {residual} of the range of F")
}

/// The misfit, and the parameters behind the spring of the machine.
fn behind_spring(
    summary: &Summary,
    load: Option<f64>,
    name: &'static str,
    read: &SpringRateState,
) -> Vec<(&'static str, String)> {
    let residual = percent(read.residual_relative);
    let rms = short(summary, read.residual, Quantity::Force);
    let law = match read.law {
        StateLaw::Ageing => "ageing law",
        StateLaw::Slip => "slip law",
    };
    let stiffness = value(summary, read.stiffness, Quantity::Stiffness);
    let all = |numbers: &[f64], quantity| {
        let numbers: Vec<_> = numbers.iter().map(|number| short(summary, *number, quantity)).collect();
        numbers.join(" and ")
    };
    let (b, distance) = (all(&read.b, Quantity::Force), all(&read.distance, Quantity::Length));
    let a = short(summary, read.a, Quantity::Force);
    let mut lines = vec![
        (name, format!("residual {residual} of the range of F, rms {rms}, {law} behind K = {stiffness}")),
        ("", format!("a = {a}, b = {b}, D_c = {distance}")),
    ];
    let forces = [("a =", Some(read.a))].into_iter().chain(read.b.iter().map(|b| ("b =", Some(*b))));
    lines.extend(coefficients(load, "", forces));
    lines
}

/// A computed value with four digits: the curve does not follow the fitted equation more closely.
fn short(summary: &Summary, number: f64, quantity: Quantity) -> String {
    let rounded = format!("{number:.3e}").parse().unwrap_or(number);
    with_unit(digits(rounded), number, &summary.units.label(quantity))
}

/// A fraction in percent, with two digits.
fn percent(fraction: f64) -> String {
    format!("{} %", digits(format!("{:.1e}", 100.0 * fraction).parse().unwrap_or(fraction)))
}

/// The parameters of the compared curve, with their errors and what is left.
fn measured(summary: &Summary, load: Option<f64>, read: &MeasuredRateState) -> Vec<(&'static str, String)> {
    let with_error = |found: MeasuredValue, quantity| {
        fitted(summary, Fitted { value: found.value, error: found.error }, quantity)
    };
    let force = |found| with_error(found, Quantity::Force);
    let distance = with_error(read.distance, Quantity::Length);
    let end = |end: Option<f64>| end.map_or("no limit".into(), |end| short(summary, end, Quantity::Length));
    let [low, high] = [read.distance.low, read.distance.high].map(end);
    let residual = short(summary, read.residual, Quantity::Force);
    let mut lines = vec![
        ("  compared curve", format!("a = {}, b = {}, D_c = {distance}", force(read.a), force(read.b))),
        (
            "",
            format!(
                "a − b = {}, 95 % interval of D_c: {low} to {high}, rms residual {residual}",
                force(read.a_minus_b)
            ),
        ),
    ];
    lines.extend(load.map(|load| {
        let of = |found: MeasuredValue| {
            let coefficient = Fitted { value: found.value / load, error: found.error / load };
            fitted(summary, coefficient, Quantity::Number)
        };
        let [a, b, difference] = [read.a, read.b, read.a_minus_b].map(of);
        ("", format!("a = {a}, b = {b}, a − b = {difference} (friction coefficients)"))
    }));
    let white = |p| format!("whitened residuals white with p = {} (Ljung–Box)", probability(p));
    lines.extend(read.whiteness.map(|p| ("", white(p))));
    lines.extend(read.warnings.iter().map(|warning| ("", warning.clone())));
    lines
}

fn healed(summary: &Summary, curve: &HealingCurve) -> Vec<(&'static str, String)> {
    let velocity = value(summary, curve.velocity, Quantity::Velocity);
    let steady = value(summary, curve.kinetic_friction, Quantity::Force);
    let mut lines = vec![("kinetic friction", format!("F_k = {steady} at v = {velocity}"))];
    if let (Some(healing), Some(relative)) = (curve.healing_per_decade, curve.healing_relative) {
        let text = short(summary, healing, Quantity::Force);
        let residual = curve.residual_relative.map_or(String::new(), |residual| {
            format!(", residual {} of the range of F_s", percent(residual))
        });
        lines.push((
            "healing",
            format!("{text} per factor of ten in hold time ({:.2} % of F_k){residual}", 100.0 * relative),
        ));
    }
    if let Some(cutoff) = curve.healing_cutoff {
        lines.push(("", format!("cutoff time {}", short(summary, cutoff, Quantity::Time))));
    }
    let forces =
        [("kinetic", Some(curve.kinetic_friction)), ("healing per factor of ten", curve.healing_per_decade)];
    lines.extend(coefficients(summary.normal_load, "friction coefficients", forces));
    lines
}
