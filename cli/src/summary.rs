//! The numbers of a run, for people.

use std::fmt::Write as _;

use asperity::record::Quantity;
use asperity::scenario::Disorder;
use asperity_runner::summary::{StaticFriction, Summary};

/// Aligned lines: what it is, its value with its unit.
pub fn readable(summary: &Summary) -> String {
    let value = |number: f64, quantity| {
        let unit = summary.units.label(quantity);
        if unit == "1" || !number.is_finite() { digits(number) } else { format!("{} {unit}", digits(number)) }
    };
    let mut lines: Vec<(&str, String)> = Vec::new();
    lines.push((
        "static friction",
        match summary.static_friction {
            StaticFriction::Reached { force, position } => {
                format!(
                    "F_s = {} at X_s = {}",
                    value(force, Quantity::Force),
                    value(position, Quantity::Length)
                )
            }
            StaticFriction::NotReached => "not reached: the force still rises at the end".into(),
        },
    ));
    lines.push(("kinetic friction", format!("F_k = {}", value(summary.kinetic_friction, Quantity::Force))));
    let (length, paper) = (summary.relaxation_length.0, summary.relaxation_length_paper.0);
    let estimate = format!("(the paper's estimate {})", value(paper, Quantity::Length));
    lines.push(("relaxation length", format!("X*  = {} {estimate}", value(length, Quantity::Length))));
    lines.push((
        "critical stiffness",
        match summary.critical_stiffness.0 {
            never if never <= 0.0 => {
                "none: the force never falls, and a slider of any stiffness is stable".into()
            }
            stiffness => format!("K_c = {}", value(stiffness, Quantity::Stiffness)),
        },
    ));
    if let Some(coefficients) = summary.friction_coefficients {
        let at_rest = coefficients.at_rest.map_or("not reached".into(), digits);
        let load = value(coefficients.normal_load, Quantity::Force);
        let both = format!("static {at_rest}, kinetic {} (load {load})", digits(coefficients.kinetic));
        lines.push(("friction coefficients", both));
    }
    if let (Some(seed), Some(size)) = (summary.seed, summary.sample) {
        let quenched =
            if summary.disorder == Some(Disorder::Quenched) { "quenched thresholds, " } else { "" };
        lines.push(("ensemble", format!("{size} contacts, {quenched}seed {seed}")));
    }
    if let Some(compared) = summary.compare {
        let rms = compared.residual_rms.map_or("no point within the pull".into(), |rms| {
            format!("rms residual {} over {} points", value(rms, Quantity::Force), compared.points)
        });
        lines.push(("compared curve", rms));
    }
    let mut text = if summary.title.is_empty() { String::new() } else { format!("{}\n\n", summary.title) };
    for (name, value) in lines {
        let _ = writeln!(text, "{name:<22} {value}");
    }
    text
}

/// Six significant digits, no trailing zeros.
fn digits(number: f64) -> String {
    if !number.is_finite() {
        return if number.is_nan() { "not known" } else { "infinite" }.into();
    }
    let magnitude = number.abs().log10().floor();
    if number != 0.0 && !(-4.0..7.0).contains(&magnitude) {
        return format!("{number:.5e}");
    }
    let decimals = (5.0 - magnitude).clamp(0.0, 9.0) as usize;
    let text = format!("{number:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_six_digits() {
        for (number, text) in [
            (0.868081709809, "0.868082"),
            (0.50125, "0.50125"),
            (20.2704854183, "20.2705"),
            (100000.0, "100000"),
            (0.0, "0"),
            (1.5e-7, "1.50000e-7"),
            (f64::INFINITY, "infinite"),
            (f64::NAN, "not known"),
        ] {
            assert_eq!(digits(number), text);
        }
    }
}
