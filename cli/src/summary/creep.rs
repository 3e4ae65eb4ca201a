//! Text of the summary for creep under constant forces.

use asperity::record::Quantity;
use asperity::task::summary::{CreepAtForce, Fitted, Summary};

use super::{coarse, fitted, with_unit};

/// Largest number of forces that are listed.
const LISTED: usize = 20;

/// Adds lines in the form of the rest of the summary.
pub fn lines(summary: &Summary) -> Vec<(&'static str, String)> {
    let all = summary.numbers.creep();
    let mut lines: Vec<_> = all.iter().take(LISTED).map(|at| ("constant force", text(summary, at))).collect();
    if all.len() > LISTED {
        lines.push(("", format!("and {} more forces", all.len() - LISTED)));
    }
    lines
}

fn text(summary: &Summary, at: &CreepAtForce) -> String {
    let value = |number: f64, quantity| with_unit(coarse(number), number, &summary.units.label(quantity));
    let force = value(at.force, Quantity::Force);
    let slip = value(at.final_position - at.loaded_position, Quantity::Length);
    let ends = match (at.failure_time, at.failure_time_error) {
        (None, _) => "no failure within the duration".to_owned(),
        (Some(0.0), _) => {
            return format!(
                "F = {force}: fails at once, at X = {}",
                value(at.final_position, Quantity::Length)
            );
        }
        (Some(time), Some(error)) if error > 0.0 => {
            format!("failure at t = {}", fitted(summary, Fitted { value: time, error }, Quantity::Time))
        }
        (Some(time), _) => format!("failure at t = {}", value(time, Quantity::Time)),
    };
    if at.slowest_velocity.is_none() {
        return format!("F = {force}: {ends}, before it is reached");
    }
    let velocity = |words, found: Option<f64>| {
        found.map_or(String::new(), |v| format!(", {words} {}", value(v, Quantity::Velocity)))
    };
    let (slowest, last) = (
        velocity("slowest velocity", at.slowest_velocity),
        velocity("velocity at the end", at.final_velocity),
    );
    format!("F = {force}: {ends}, slip {slip}{slowest}{last}")
}
