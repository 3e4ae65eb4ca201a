//! A scenario computed, from its text to what is written of it.

use asperity::monitor::Monitor;
use asperity::scenario::Scenario;
use asperity::{Result, task};

use crate::checkpoint::Checkpoints;
use crate::input;
use crate::output::Outcome;

/// Computes `scenario`.
///
/// # Errors
/// A value that makes no sense, results too large for one file, or the monitor's wish to stop.
pub fn run(scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<Outcome> {
    run_with(scenario, None, monitor)
}

/// The same, going on from the last of `checkpoints` and keeping new ones. Only `[drive]` of an `[interface]` has any.
///
/// # Errors
/// As [`run`]; a stop, too, where a checkpoint could not be written or read ([`Checkpoints::failure`]).
pub fn run_with(
    scenario: &Scenario,
    checkpoints: Option<&mut Checkpoints>,
    monitor: &mut dyn Monitor,
) -> Result<Outcome> {
    let checkpoints = checkpoints.map(|checkpoints| checkpoints as &mut dyn task::Checkpoints);
    let (summary, record) = task::run_with(scenario, checkpoints, monitor)?;
    Ok(Outcome { scenario: input::to_text(scenario), summary, record })
}
