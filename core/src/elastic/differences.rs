//! How far cells are from the first one, where the slider is so stiff that their positions do not tell.

use serde::{Deserialize, Serialize};

use super::Interface;
use super::batch::{change, fill, largest};

/// Stiffness that a cell feels when it moves alone, of the steepest slope of its contacts, above which positions do not
/// tell: their roundings would be forces of 1e-12 of the strongest ones after ten mean thresholds.
const STIFF: f64 = 1e3;

/// Differences X_j − X_0 of positions, summed from those of advances.
///
/// A stiff slider keeps them small, so that they have digits that positions leave out: each rounding of X is a force of
/// A_jj ε X, each one of them of A_jj ε |X_j − X_0| only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Differences {
    now: Vec<f64>,
    /// Those of the advances that are tried, where more is known of them than advances tell.
    #[serde(skip)]
    ahead: Option<Vec<f64>>,
}

/// Differences from the first of `values`.
fn from_first(values: &[f64], out: &mut [f64]) {
    fill(out, |j| values[j] - values[0]);
}

impl Differences {
    /// Of cells that all are where the first one is.
    fn new(number: usize) -> Self {
        Self { now: vec![0.0; number], ahead: None }
    }

    /// Displacements that make the forces of the slider where cells are: positions, unless more is known.
    pub fn now<'a>(differences: Option<&'a Self>, positions: &'a [f64]) -> &'a [f64] {
        differences.map_or(positions, |differences| &differences.now)
    }

    /// Displacements that make the change of these forces on the advances that are tried.
    pub fn ahead<'a>(differences: Option<&'a Self>, by: &'a [f64]) -> &'a [f64] {
        differences.and_then(|differences| differences.ahead.as_deref()).unwrap_or(by)
    }

    /// Puts cells where positions tell.
    pub fn put(&mut self, positions: &[f64]) {
        from_first(positions, &mut self.now);
        self.ahead = None;
    }

    /// Advances are tried that will be corrected.
    pub fn aim(&mut self, by: &[f64]) {
        let mut ahead = self.ahead.take().unwrap_or_else(|| vec![0.0; by.len()]);
        from_first(by, &mut ahead);
        self.ahead = Some(ahead);
    }

    /// They are corrected.
    pub fn correct(&mut self, more: &[f64]) {
        if let Some(ahead) = &mut self.ahead {
            change(ahead, |j, ahead| ahead + (more[j] - more[0]));
        }
    }

    /// They are not made.
    pub fn drop_aim(&mut self) {
        self.ahead = None;
    }

    /// They are made.
    pub fn advance(&mut self, by: &[f64]) {
        match self.ahead.take() {
            Some(ahead) => change(&mut self.now, |j, now| now + ahead[j]),
            None => change(&mut self.now, |j, now| now + (by[j] - by[0])),
        }
    }

    /// Displacements halfway from those at `before`.
    pub fn halfway(&self, before: &Self, out: &mut [f64]) {
        fill(out, |j| 0.5 * (before.now[j] + self.now[j]));
    }
}

impl Interface {
    /// Keeps differences of cells, if the slider is that stiff, and if they are all that it feels.
    pub(super) fn refine(&mut self) {
        let number = self.len();
        let own = largest(number, |j| self.coupling.self_stiffness(j));
        let stiff = own > STIFF * self.cells.extremes().steepest;
        self.differences = (stiff && self.feels_differences_only(own)).then(|| Differences::new(number));
    }

    /// Whether cells that all move by the same make no forces, next to the stiffness `own` of one that moves alone: nothing else
    /// holds the slider.
    fn feels_differences_only(&mut self, own: f64) -> bool {
        const ROUNDING: f64 = 1e-9;
        let mut forces = vec![0.0; self.len()];
        self.coupling.forces(&vec![1.0; self.len()], &mut forces);
        forces.iter().all(|force| force.abs() <= ROUNDING * own)
    }

    /// No advances are tried.
    pub(super) fn stand(&mut self) {
        self.by.fill(0.0);
        if let Some(differences) = &mut self.differences {
            differences.drop_aim();
        }
    }
}
