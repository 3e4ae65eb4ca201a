//! A pull computed by the ensemble: single contacts, drawn at random.

use crate::Result;
use crate::ensemble::{Ensemble, Snapshots};
use crate::monitor::Monitor;
use crate::record::{Column, Quantity, Record};
use crate::scenario;

use super::grid::Grid;

/// Smallest length of a pull whose end counts as steady sliding, in mean thresholds and in relaxation lengths.
/// The first is a little below 200, because laws truncated at 0 have means a little above their parameter.
const SETTLED: (f64, f64) = (199.9, 5.0);
/// Length of the end of such a pull over which stretches are averaged, in mean thresholds, and the number of snapshots.
const WINDOW: (f64, usize) = (10.0, 101);

const FORCE: Column =
    Column::new("ensemble_force", "friction force of the ensemble", Quantity::Force, &["position"]);
const ERROR: Column = Column::new("ensemble_error", "its standard error", Quantity::Force, &["position"]);
const BIN: Column = Column::new("bin", "stretch at the middle of a bin", Quantity::Length, &["bin"]);
const STRETCH_DENSITY: Column = Column::new(
    "ensemble_stretch_density",
    "density of stretches of the ensemble",
    Quantity::PerLength,
    &["snapshot", "bin"],
);
const STEADY_DENSITY: Column = Column::new(
    "steady_ensemble_density",
    "density of stretches of the ensemble, averaged over the end of the pull",
    Quantity::PerLength,
    &["bin"],
);
const AVERAGED: Column = Column::new(
    "averaged_position",
    "first and last position averaged over",
    Quantity::Length,
    &["averaged"],
);

/// The variables of a pull of the ensemble.
pub(super) const COLUMNS: [Column; 6] = [FORCE, ERROR, BIN, STRETCH_DENSITY, STEADY_DENSITY, AVERAGED];

/// Columns of the force of the ensemble and its standard error along `dimensions`.
pub(super) const fn force_columns(
    long_name: &'static str,
    dimensions: &'static [&'static str],
) -> [Column; 2] {
    [Column { long_name, dimensions, ..FORCE }, ERROR.along(dimensions)]
}

/// A pull of the ensemble.
pub(super) struct PulledEnsemble<'a> {
    /// The task.
    pub task: &'a scenario::Pull,
    /// The stretches, which give the range of histograms.
    pub grid: &'a Grid,
    /// Mean threshold.
    pub mean: f64,
    /// Relaxation length X*.
    pub memory: f64,
}

/// Records the force of an ensemble, and its standard error unless there is a single contact, whose scatter is unknown.
pub(super) fn add_force(record: &mut Record, columns: [Column; 2], force: Vec<f64>, error: Vec<f64>) {
    record.add(columns[0], force);
    if !error.iter().any(|error| error.is_nan()) {
        record.add(columns[1], error);
    }
}

impl PulledEnsemble<'_> {
    /// Pulls `model` and records force, stretches at the snapshots, and stretches in steady sliding.
    ///
    /// # Errors
    /// A computation that is too large, a stop by the monitor.
    pub fn record(&self, model: &Ensemble, record: &mut Record, monitor: &mut dyn Monitor) -> Result<()> {
        let requested = &self.task.snapshots;
        let last = self.last_positions();
        // The two lists overlap: one histogram is taken at each position that is in either of them.
        let mut positions = [requested.as_slice(), &last].concat();
        positions.sort_by(f64::total_cmp);
        positions.dedup();
        let edges = self.grid.edges(model.size());
        let centres = edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let snapshots = Snapshots { positions, edges };
        let pull = match self.task.velocity {
            Some(velocity) => model.pull_at_with(velocity, &self.task.positions(), &snapshots, monitor)?,
            None => model.pull_with(&self.task.positions(), &snapshots, monitor)?,
        };
        add_force(record, [FORCE, ERROR], pull.force.clone(), pull.error.clone());
        let at = |x: &f64| snapshots.positions.partition_point(|p| p < x);
        if requested.is_empty() && last.is_empty() {
            return Ok(());
        }
        record.add(BIN, centres);
        if !requested.is_empty() {
            let density = requested.iter().flat_map(|x| pull.stretch_density(at(x)..at(x) + 1)).collect();
            record.add(STRETCH_DENSITY, density);
        }
        if let (Some(first), Some(end)) = (last.first(), last.last()) {
            let density = pull.stretch_density(at(first)..at(end) + 1);
            record.add(STEADY_DENSITY, density);
            record.add(AVERAGED, vec![*first, *end]);
        }
        Ok(())
    }

    /// Positions at the end of the pull over which stretches are averaged; none if the pull is too short to be steady there.
    fn last_positions(&self) -> Vec<f64> {
        let end = self.task.distance;
        let settled = end >= SETTLED.0 * self.mean && end >= SETTLED.1 * self.memory;
        if !settled {
            return Vec::new();
        }
        let steps = WINDOW.1 - 1;
        let back = |i: usize| end - WINDOW.0 * self.mean * ((steps - i) as f64 / steps as f64);
        (0..=steps).map(back).collect()
    }
}
