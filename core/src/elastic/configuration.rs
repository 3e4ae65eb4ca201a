//! Where the drive and the cells are, and advances of the cells from there.

use serde::{Deserialize, Serialize};

use super::batch::{change, fill};

/// X_T, X_j and the time.
///
/// Under a stiff slider the differences X_j − X_0 are also stored, summed from those of the advances. They have digits
/// that positions lack: each rounding of a position X is a force A_jj ε X, each one of a difference only
/// A_jj ε |X_j − X_0|.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Configuration {
    /// X_T.
    pub drive: f64,
    /// Time that slides have taken so far.
    pub time: f64,
    /// X_j.
    pub positions: Vec<f64>,
    /// X_j − X_0, where they are kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    differences: Option<Vec<f64>>,
}

/// Advances of all cells, not made yet.
pub(super) struct Advances {
    /// δ_j.
    pub by: Vec<f64>,
    /// δ_j − δ_0, where they are known better than from δ.
    differences: Option<Vec<f64>>,
}

/// Differences from the first one of `values`.
fn from_first(values: &[f64]) -> Vec<f64> {
    let mut differences = vec![0.0; values.len()];
    fill(&mut differences, |j| values[j] - values[0]);
    differences
}

impl Configuration {
    /// Cells at 0, with differences of their positions if the slider is stiff.
    pub fn new(cells: usize, stiff: bool) -> Self {
        let zeros = || vec![0.0; cells];
        Self { drive: 0.0, time: 0.0, positions: zeros(), differences: stiff.then(zeros) }
    }

    /// Displacements that the slider's elastic forces follow from: positions, or their differences where these are kept.
    /// Both give the same forces, since the coupling of such a slider resists differences only.
    pub fn displacements(&self) -> &[f64] {
        self.differences.as_deref().unwrap_or(&self.positions)
    }

    /// Puts the cells somewhere.
    pub fn put(&mut self, positions: Vec<f64>) {
        self.differences = self.differences.is_some().then(|| from_first(&positions));
        self.positions = positions;
    }

    /// Advances whose corrections will keep the digits of differences, where these are kept.
    pub fn correctable(&self, by: Vec<f64>) -> Advances {
        let differences = self.differences.is_some().then(|| from_first(&by));
        Advances { by, differences }
    }

    /// Makes the advances.
    pub fn advance(&mut self, advances: &Advances) {
        let by = &advances.by;
        change(&mut self.positions, |j, position| position + by[j]);
        if let Some(now) = &mut self.differences {
            match &advances.differences {
                Some(differences) => change(now, |j, now| now + differences[j]),
                None => change(now, |j, now| now + (by[j] - by[0])),
            }
        }
    }

    /// [`Configuration::displacements`] halfway between an earlier configuration and this one.
    pub fn displacements_halfway(&self, before: &Self) -> Vec<f64> {
        let (before, now) = (before.displacements(), self.displacements());
        let mut halfway = vec![0.0; now.len()];
        fill(&mut halfway, |j| 0.5 * (before[j] + now[j]));
        halfway
    }
}

impl Advances {
    /// Advances that will not be corrected.
    pub fn new(by: Vec<f64>) -> Self {
        Self { by, differences: None }
    }

    /// As [`Configuration::displacements`].
    pub fn displacements(&self) -> &[f64] {
        self.differences.as_deref().unwrap_or(&self.by)
    }

    /// Adds a correction to the advances.
    pub fn correct(&mut self, correction: &[f64]) {
        change(&mut self.by, |j, by| by + correction[j]);
        if let Some(differences) = &mut self.differences {
            change(differences, |j, difference| difference + (correction[j] - correction[0]));
        }
    }
}
