//! Text of the summary for the question whether a slider sticks and slips.

use asperity::record::Quantity;
use asperity::task::summary::{Fitted, SimulatedStickSlip, StickSlipNumbers, Summary};

use super::{coarse, fitted, with_unit};

/// Largest number of velocities that are listed.
const LISTED: usize = 12;

/// Lines for each velocity: the answer, and the three stiffnesses.
pub fn lines(summary: &Summary) -> Vec<(&'static str, String)> {
    let answers = summary.numbers.stick_slip();
    let mut lines: Vec<_> = answers.iter().take(LISTED).flat_map(|answer| one(summary, answer)).collect();
    if answers.len() > LISTED {
        lines.push(("", format!("and {} more velocities", answers.len() - LISTED)));
    }
    lines
}

/// A number with four digits.
fn value(summary: &Summary, number: f64, quantity: Quantity) -> String {
    with_unit(coarse(number), number, &summary.units.label(quantity))
}

fn one(summary: &Summary, found: &StickSlipNumbers) -> Vec<(&'static str, String)> {
    let stiffness = |number| value(summary, number, Quantity::Stiffness);
    let velocity = |v| format!(", v = {}", value(summary, v, Quantity::Velocity));
    let at = found.velocity.map_or(String::new(), velocity);
    let word = found.stick_slip.word();
    let reason = found.reason.strip_prefix(&format!("{word} stick-slip: ")).unwrap_or(&found.reason);
    let end = match (found.persistent_stiffness, found.persistent_stiffness_above.0) {
        (low, _) if low <= 0.0 => "for no K".to_owned(),
        (low, high) if high.is_finite() => {
            format!("for K up to {}, not from {} on", stiffness(low), stiffness(high))
        }
        (low, _) => format!("for K up to {} at least", stiffness(low)),
    };
    let below = |words: &str, critical: f64| match critical {
        _ if critical <= 0.0 => format!("{words} for no K"),
        _ if critical.is_finite() => format!("{words} for K below {}", stiffness(critical)),
        _ => format!("{words} for any K"),
    };
    let mut lines = vec![
        ("stick-slip", format!("{word} at K = {}{at}: {reason}", stiffness(found.stiffness))),
        ("  persistent", end),
        ("  first pull", below("begins with a slip", found.critical_stiffness.0)),
        ("  steady sliding", below("unstable", found.critical_stiffness_sliding.0)),
    ];
    lines.extend(found.ensemble.iter().flat_map(|ensemble| simulated(summary, found, ensemble)));
    lines
}

/// Lines for the simulations of single contacts.
fn simulated(
    summary: &Summary,
    expected: &StickSlipNumbers,
    found: &SimulatedStickSlip,
) -> Vec<(&'static str, String)> {
    let counts = [
        ("none", found.none),
        ("transient", found.transient),
        ("persistent", found.persistent),
        ("undecided", found.undecided),
    ];
    let counted: Vec<String> =
        counts.iter().filter(|count| count.1 > 0).map(|(word, count)| format!("{word} in {count}")).collect();
    let runs = if found.simulations == 1 { "simulation" } else { "simulations" };
    let mut lines =
        vec![("  single contacts", format!("{} of {} {runs}", counted.join(", "), found.simulations))];
    if let Some(drop) = found.mean_drop {
        let infinitely = expected
            .mean_drop
            .map_or("none that persists".to_owned(), |drop| value(summary, drop, Quantity::Force));
        let drop = scattered(summary, drop, found.drop_std, Quantity::Force);
        lines.push(("    drop", format!("{drop} (infinitely many contacts: {infinitely})")));
    }
    let end = match found.persistent_stiffness.0 {
        never if never <= 0.0 => "for no K".to_owned(),
        mean if mean.is_finite() => {
            format!(
                "for K up to {}",
                scattered(summary, mean, found.persistent_stiffness_std, Quantity::Stiffness)
            )
        }
        _ => "for any K that was tried, in one simulation or more".to_owned(),
    };
    lines.push(("    persistent", end));
    lines
}

/// A mean and the standard deviation over the simulations.
fn scattered(summary: &Summary, mean: f64, std: Option<f64>, quantity: Quantity) -> String {
    match std {
        Some(std) if std > 0.0 => fitted(summary, Fitted { value: mean, error: std }, quantity),
        _ => value(summary, mean, quantity),
    }
}
