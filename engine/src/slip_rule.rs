//! The rules of slip, with numbers for those that have some.

use asperity::block::Slip;
use asperity::scenario::Scenario;

/// The names of all rules, as in scenarios.
pub const NAMES: [&str; 5] = ["reset", "overdamped", "arrest", "damped", "inertial"];
/// Duration of a slip, in the time in which the drive moves by the mean threshold, which is 1 without a velocity.
const DURATION: f64 = 0.1;

/// The name of a rule.
pub fn name(rule: Slip) -> &'static str {
    match rule {
        Slip::Overdamped => "overdamped",
        Slip::Arrest => "arrest",
        Slip::Damped { .. } => "damped",
        Slip::Inertial { .. } => "inertial",
        _ => "reset",
    }
}

/// The rule of a name. A damped slider relaxes in γ/K, and one with mass oscillates at √(K/M), here with half of the critical
/// damping.
pub fn of_name(scenario: &Scenario, name: &str) -> Option<Slip> {
    let stiffness = scenario.block.as_ref().map_or(1.0, |block| block.stiffness);
    let time = DURATION * passage(scenario);
    Some(match name {
        "reset" => Slip::Reset,
        "overdamped" => Slip::Overdamped,
        "arrest" => Slip::Arrest,
        "damped" => Slip::Damped { damping: stiffness * time },
        "inertial" => Slip::Inertial { mass: stiffness * time * time, damping: stiffness * time },
        _ => return None,
    })
}

/// The time in which the drive moves by the mean threshold.
fn passage(scenario: &Scenario) -> f64 {
    let velocity = scenario.drive.as_ref().and_then(|drive| drive.velocity);
    let contacts = scenario.contacts.build().ok();
    match (velocity, contacts) {
        (Some(velocity), Some(contacts)) if velocity > 0.0 => contacts.thresholds.mean() / velocity,
        _ => 1.0,
    }
}
