//! How large a scenario may be where others than its author compute it.

use asperity::scenario::Scenario;
use asperity::{Error, Result};

/// The largest scenario that is computed. Time and memory have their limits in the monitor.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Points of a curve or of a grid.
    pub points: usize,
    /// Contacts of an ensemble.
    pub contacts: usize,
    /// Cells of an interface.
    pub cells: usize,
}

impl Limits {
    /// What a page may ask for: curves with more points than a screen shows, and interfaces of 512 × 512 cells.
    pub const PAGE: Self = Self { points: 100_000, contacts: 100_000_000, cells: 262_144 };

    /// Refuses a scenario beyond the limits.
    ///
    /// # Errors
    /// The key with a larger number.
    pub fn check(&self, scenario: &Scenario) -> Result<()> {
        let counts = counts(scenario).into_iter().flatten();
        let of_points = counts.map(|(key, count)| (key, count, self.points, "points"));
        let ensemble = scenario.ensemble.as_ref().map_or(0, |ensemble| ensemble.size());
        let cells = scenario.interface.as_ref().map_or(0, |interface| interface.size());
        let others = [
            ("ensemble.size", ensemble, self.contacts, "contacts"),
            ("interface.cells", cells, self.cells, "cells"),
        ];
        match of_points.chain(others).find(|&(_, count, most, _)| count > most) {
            None => Ok(()),
            Some((key, count, most, what)) => {
                Err(Error::invalid(key, format!("at most {most} {what} in the explorer"), count))
            }
        }
    }
}

/// The number of points of each task that `scenario` has, with its key.
fn counts(scenario: &Scenario) -> [Option<(&'static str, usize)>; 9] {
    let draws = scenario.fit.as_ref().and_then(|fit| fit.posterior.as_ref());
    [
        scenario.pull.as_ref().map(|pull| ("pull.points", pull.points)),
        scenario.drive.as_ref().map(|drive| ("drive.points", drive.points)),
        scenario.protocol.as_ref().map(|protocol| ("protocol", protocol.points())),
        scenario.velocity_curve.as_ref().map(|curve| ("velocity_curve.points", curve.points())),
        scenario.hold_curve.as_ref().map(|curve| ("hold_curve.points", curve.points)),
        scenario.creep.as_ref().map(|task| ("creep.points", task.points.saturating_mul(task.forces.len()))),
        scenario.spectrum.as_ref().map(|spectrum| ("spectrum.points", spectrum.points)),
        scenario.renormalisation.as_ref().map(|task| ("renormalisation.points", task.points)),
        draws.map(|posterior| ("fit.posterior.draws", posterior.draws.saturating_mul(posterior.chains))),
    ]
}
