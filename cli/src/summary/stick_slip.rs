//! Text of the summary for the question whether a slider sticks and slips.

use asperity::record::Quantity;
use asperity::task::summary::{StickSlipNumbers, Summary};

use super::{digits, with_unit};

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

fn one(summary: &Summary, found: &StickSlipNumbers) -> Vec<(&'static str, String)> {
    let value = |number: f64, quantity| {
        let rounded = format!("{number:.3e}").parse().unwrap_or(number);
        with_unit(digits(rounded), number, &summary.units.label(quantity))
    };
    let stiffness = |number| value(number, Quantity::Stiffness);
    let at = found.velocity.map_or(String::new(), |v| format!(", v = {}", value(v, Quantity::Velocity)));
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
    vec![
        ("stick-slip", format!("{word} at K = {}{at}: {reason}", stiffness(found.stiffness))),
        ("  persistent", end),
        ("  first pull", below("begins with a slip", found.critical_stiffness.0)),
        ("  steady sliding", below("unstable", found.critical_stiffness_sliding.0)),
    ]
}
