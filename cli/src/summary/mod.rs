//! Text of the summary of a run.

mod catalogue;
mod creep;
mod derivatives;
mod fit;
mod noise;
mod renormalisation;
mod stick_slip;
mod timed;

use std::fmt::Write as _;

use asperity::record::Quantity;
use asperity::scenario::Disorder;
use asperity::task::summary::{Fitted, Friction, SliderState, Sliding, StaticFriction, Summary};

/// Aligned lines: a label, and a value with its unit.
pub fn readable(summary: &Summary) -> String {
    let value = |number: f64, quantity| with_unit(digits(number), number, &summary.units.label(quantity));
    let mut lines = summary.numbers.friction().map_or_else(Vec::new, |friction| rubbed(summary, friction));
    if let Some(coefficients) = summary.numbers.friction().and_then(|friction| friction.friction_coefficients)
    {
        let at_rest = coefficients.at_rest.map_or("not reached".into(), digits);
        let load = value(coefficients.normal_load, Quantity::Force);
        let both = format!("static {at_rest}, kinetic {} (load {load})", digits(coefficients.kinetic));
        lines.push(("friction coefficients", both));
    }
    if let Some(force) = summary.background_force {
        lines.push((
            "background force",
            format!("{}, part of every friction force", value(force, Quantity::Force)),
        ));
    }
    lines.extend(derivatives::lines(summary.numbers.derivatives()));
    if let Some(sliding) = summary.numbers.sliding() {
        lines.extend(slid(summary, sliding));
    }
    lines.extend(summary.numbers.noise().into_iter().flat_map(|found| noise::lines(summary, found)));
    lines.extend(stick_slip::lines(summary));
    lines.extend(timed::lines(summary));
    lines.extend(creep::lines(summary));
    if let Some(catalogue) = summary.numbers.catalogue() {
        lines.extend(catalogue::lines(summary, catalogue));
    }
    lines.extend(
        summary
            .numbers
            .renormalisation()
            .into_iter()
            .flat_map(|found| renormalisation::lines(summary, found)),
    );
    // The seed of a fit is that of draws from the posterior.
    let sample = summary.sample.filter(|_| summary.numbers.fit().is_none());
    if let (Some(seed), Some(size)) = (summary.seed, sample) {
        let quenched =
            if summary.disorder == Some(Disorder::Quenched) { "quenched thresholds, " } else { "" };
        lines.push(("ensemble", format!("{size} contacts, {quenched}seed {seed}")));
    }
    if let Some(compared) = summary.numbers.compare() {
        let rms = compared.residual_rms.map_or("no point within the pull".into(), |rms| {
            let points = match compared.measured {
                all if all == compared.points => all.to_string(),
                all => format!("{} of {all}", compared.points),
            };
            format!("rms residual {} over {points} points", value(rms, Quantity::Force))
        });
        lines.push(("compared curve", rms));
    }
    let mut text = if summary.title.is_empty() { String::new() } else { format!("{}\n\n", summary.title) };
    for (name, value) in lines {
        let _ = writeln!(text, "{name:<22} {value}");
    }
    let estimates = summary.numbers.fit().map_or_else(Vec::new, |found| fit::lines(summary, found));
    // Keys of a scenario may be longer than the names of other lines.
    let width = estimates.iter().fold(22, |widest, (name, _)| widest.max(name.chars().count()));
    for (name, value) in estimates {
        let _ = writeln!(text, "{name:<width$} {value}");
    }
    let ensemble = summary.numbers.sliding().and_then(|sliding| sliding.ensemble.as_deref());
    for (name, value) in ensemble.into_iter().flat_map(|sliding| slid(summary, sliding)) {
        let _ = writeln!(text, "  {name:<20} {value}");
    }
    text
}

/// The friction of a pull at one velocity.
fn rubbed(summary: &Summary, friction: &Friction) -> Vec<(&'static str, String)> {
    let value = |number: f64, quantity| with_unit(digits(number), number, &summary.units.label(quantity));
    let peak = match friction.static_friction {
        StaticFriction::Reached { force, position } => {
            format!("F_s = {} at X_s = {}", value(force, Quantity::Force), value(position, Quantity::Length))
        }
        StaticFriction::NotReached => "not reached: the force is highest at the end".into(),
    };
    let estimate = value(friction.relaxation_length_paper.0, Quantity::Length);
    let length = value(friction.relaxation_length.0, Quantity::Length);
    let critical = match friction.critical_stiffness.0 {
        never if never <= 0.0 => "none: the force of this pull never decreases".into(),
        stiffness => format!("K_c = {}", value(stiffness, Quantity::Stiffness)),
    };
    vec![
        ("static friction", peak),
        ("kinetic friction", format!("F_k = {}", value(friction.kinetic_friction, Quantity::Force))),
        ("relaxation length", format!("X*  = {length} (the paper's estimate {estimate})")),
        ("critical stiffness", critical),
    ]
}

/// The motion of a driven slider.
fn slid(summary: &Summary, sliding: &Sliding) -> Vec<(&'static str, String)> {
    let text = if sliding.timed { coarse } else { fine };
    let value = |number: f64, quantity| with_unit(text(number), number, &summary.units.label(quantity));
    let place = |place: &SliderState| {
        let at = (value(place.force, Quantity::Force), value(place.position, Quantity::Length));
        format!("F = {} at X = {}", at.0, at.1)
    };
    let mut lines = vec![("sliding", sliding.reason.clone())];
    if let Some(first) = &sliding.first_instability {
        let drive = value(first.drive, Quantity::Length);
        lines.push(("first slip", format!("{}, X_T = {drive}", place(first))));
    }
    if let Some(runaway) = &sliding.runaway {
        lines.push(("runaway", place(runaway)));
    }
    if let Some(period) = sliding.period {
        lines.push(("period", value(period, Quantity::Length)));
    }
    if let Some(drop) = sliding.mean_drop {
        lines.push(("drop", value(drop, Quantity::Force)));
    }
    lines
}

/// A fitted number, with at most two digits of its error.
fn fitted(summary: &Summary, fitted: Fitted, quantity: Quantity) -> String {
    with_unit(with_error(fitted), fitted.value, &summary.units.label(quantity))
}

/// A fitted number and its error, with two digits of the error.
fn with_error(Fitted { value, error }: Fitted) -> String {
    let (value, error) = fit::rounded(value, error);
    format!("{value} ± {error}")
}

fn with_unit(text: String, number: f64, unit: &str) -> String {
    if unit == "1" || !number.is_finite() { text } else { format!("{text} {unit}") }
}

/// Four digits, those of motion in time that are right.
fn coarse(number: f64) -> String {
    digits(format!("{number:.3e}").parse().unwrap_or(number))
}

/// Seven decimals of a number of order 1, the same number of digits of others.
fn fine(number: f64) -> String {
    let magnitude = number.abs().log10().floor();
    if !(-4.0..7.0).contains(&magnitude) {
        return digits(number);
    }
    let decimals = (7.0 - magnitude.max(0.0)) as usize;
    format!("{number:.decimals$}").trim_end_matches('0').trim_end_matches('.').into()
}

/// Six significant digits, without trailing zeros.
fn digits(number: f64) -> String {
    if !number.is_finite() {
        return if number.is_nan() { "not known" } else { "infinite" }.into();
    }
    let magnitude = number.abs().log10().floor();
    if number != 0.0 && !(-4.0..7.0).contains(&magnitude) {
        let text = format!("{number:.5e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'));
    }
    let decimals = (5.0 - magnitude).clamp(0.0, 9.0) as usize;
    let text = format!("{number:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn periods_keep_seven_decimals() {
        for (number, text) in [
            (1.666198355430, "1.6661984"),
            (0.7736105511280, "0.7736106"),
            (120.0, "120"),
            (1234.56789012, "1234.5679"),
            (1e-9, "1e-9"),
        ] {
            assert_eq!(fine(number), text);
        }
    }

    #[test]
    fn numbers_keep_six_digits() {
        for (number, text) in [
            (0.868081709809, "0.868082"),
            (0.50125, "0.50125"),
            (20.2704854183, "20.2705"),
            (100000.0, "100000"),
            (0.0, "0"),
            (1.5e-7, "1.5e-7"),
            (f64::INFINITY, "infinite"),
            (f64::NAN, "not known"),
        ] {
            assert_eq!(digits(number), text);
        }
    }
}
