//! The same pull by the ensemble: contacts one by one, drawn at random.

use asperity::Result;
use asperity::ensemble::{Ensemble, Snapshots};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::scenario;

use super::grid::Grid;

/// Mean thresholds that a pull must be long, and relaxation lengths, before its end is called steady.
/// The first is a little below 200: laws cut at 0 have means a little above their parameter.
const SETTLED: (f64, f64) = (199.9, 5.0);
/// Mean thresholds at the end of such a pull over which stretches are averaged, and snapshots for it.
const AVERAGED: (f64, usize) = (10.0, 101);

/// A pull of the ensemble.
pub struct Pulled<'a> {
    /// The task.
    pub task: &'a scenario::Pull,
    /// Where histograms reach.
    pub grid: &'a Grid,
    /// Mean threshold.
    pub mean: f64,
    /// Relaxation length X*.
    pub memory: f64,
}

/// Records the force of an ensemble, and its standard error where there is one: the scatter of one contact is not known.
pub fn force(record: &mut Record, words: &str, dimension: &str, force: Vec<f64>, error: Vec<f64>) {
    record.push("ensemble_force", words, Quantity::Force, &[dimension], force);
    if !error.iter().any(|error| error.is_nan()) {
        record.push("ensemble_error", "its standard error", Quantity::Force, &[dimension], error);
    }
}

impl Pulled<'_> {
    /// Pulls `model` and records force, stretches at the snapshots, and stretches in steady sliding.
    ///
    /// # Errors
    /// A job too big, or stopped by the monitor.
    pub fn record(&self, model: &Ensemble, record: &mut Record, monitor: &mut dyn Monitor) -> Result<()> {
        let asked = &self.task.snapshots;
        let last = self.last_positions();
        // the two lists overlap: one histogram is taken at each position of either
        let mut positions = [asked.as_slice(), &last].concat();
        positions.sort_by(f64::total_cmp);
        positions.dedup();
        let edges = self.grid.edges(model.size());
        let centres = edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let snapshots = Snapshots { positions, edges };
        let pull = match self.task.velocity {
            Some(velocity) => model.pull_at(velocity, &self.task.positions(), &snapshots, monitor)?,
            None => model.pull(&self.task.positions(), &snapshots, monitor)?,
        };
        let words = "friction force of the ensemble";
        force(record, words, "position", pull.force.clone(), pull.error.clone());
        let at = |x: &f64| snapshots.positions.partition_point(|p| p < x);
        if asked.is_empty() && last.is_empty() {
            return Ok(());
        }
        record.push("bin", "stretch at the middle of a bin", Quantity::Length, &["bin"], centres);
        if !asked.is_empty() {
            let density = asked.iter().flat_map(|x| pull.stretch_density(at(x)..at(x) + 1)).collect();
            let (words, along) = ("density of stretches of the ensemble", &["snapshot", "bin"]);
            record.push("ensemble_stretch_density", words, Quantity::PerLength, along, density);
        }
        if let (Some(first), Some(end)) = (last.first(), last.last()) {
            let density = pull.stretch_density(at(first)..at(end) + 1);
            let words = "density of stretches of the ensemble, averaged over the end of the pull";
            record.push("steady_ensemble_density", words, Quantity::PerLength, &["bin"], density);
            let words = "first and last position averaged over";
            record.push("averaged_position", words, Quantity::Length, &["averaged"], vec![*first, *end]);
        }
        Ok(())
    }

    /// Positions at the end of the pull, if it is long enough for contacts to have forgotten the start.
    fn last_positions(&self) -> Vec<f64> {
        let end = self.task.distance;
        let settled = end >= SETTLED.0 * self.mean && end >= SETTLED.1 * self.memory;
        if !settled {
            return Vec::new();
        }
        let steps = AVERAGED.1 - 1;
        let back = |i: usize| end - AVERAGED.0 * self.mean * ((steps - i) as f64 / steps as f64);
        (0..=steps).map(back).collect()
    }
}
