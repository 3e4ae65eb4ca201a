//! Computation of a scenario, from its text to its outcome.

use asperity::monitor::Monitor;
use asperity::scenario::Scenario;
use asperity::{Result, task};

use crate::checkpoint::Checkpoints;
use crate::input;
use crate::output::Outcome;

/// Computes `scenario`.
///
/// # Errors
/// An invalid value, results too large for one file, a stop by the monitor.
pub fn run(scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<Outcome> {
    run_with(scenario, None, monitor)
}

/// As [`run`], resumed from the last of `checkpoints`, and storing new ones. Only `[drive]` of an `[interface]` uses them.
///
/// # Errors
/// As [`run`]; a stop if a checkpoint cannot be written or read ([`Checkpoints::failure`]).
pub fn run_with(
    scenario: &Scenario,
    checkpoints: Option<&mut Checkpoints>,
    monitor: &mut dyn Monitor,
) -> Result<Outcome> {
    let checkpoints = checkpoints.map(|checkpoints| checkpoints as &mut dyn task::Checkpoints);
    let (summary, record) = task::run_with(scenario, checkpoints, monitor)?;
    Ok(Outcome { scenario: input::to_text(scenario), summary, record })
}
