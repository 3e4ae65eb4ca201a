//! What is ahead of a balance: how fast cells go on, how they hurry, and where balance will be lost.

use super::Interface;
use super::batch::{change, fill, gather, largest, sum};
use crate::Result;

/// What solutions leave, of the largest force: what is ahead is a guess.
const SOLVED: f64 = 1e-2;

/// The way on which a change of slopes is looked at, of the length on which slopes change.
const LOOK: f64 = 1e-6;

/// How cells go on from a balance as the drive does.
pub(super) struct FoldPrediction {
    /// dX_j/dX_T = (F' + K_0 + A)⁻¹ K_0.
    speeds: Vec<f64>,
    /// d²X_j/dX_T² = −(F' + K_0 + A)⁻¹ F'' (dX_j/dX_T)².
    growth: Vec<f64>,
    /// How far the drive may go until balance is lost.
    pub fold: f64,
    /// How well that is known, of itself.
    pub doubt: f64,
    /// How far it may go until a cell has gone a length on which slopes are others.
    pub limit: f64,
}

impl FoldPrediction {
    /// How far a cell goes.
    ///
    /// Speeds near a fold at a distance d grow as 1/√d, and from it a cell is d = v/(2 dv/dX_T) away: to that the way of cells
    /// that hurry is extrapolated, others' as a parabola.
    pub fn way(&self, cell: usize, distance: f64) -> f64 {
        let (speed, growth) = (self.speeds[cell], self.growth[cell]);
        let part = 2.0 * growth * distance / speed;
        if part > 0.0 && part < 1.0 {
            // 2 d v (1 − √(1 − h/d)).
            2.0 * speed * distance / (1.0 + (1.0 - part).sqrt())
        } else {
            speed * distance + 0.5 * growth * distance * distance
        }
    }
}

impl Interface {
    /// What is ahead of the balance in which cells are; none if it is not stable.
    pub(super) fn outlook(&mut self) -> Result<Option<FoldPrediction>> {
        let number = self.len();
        self.excess_here()?;
        let found = self.speeds_and_growth()?;
        self.by.fill(0.0);
        let Some((speeds, growth)) = found else { return Ok(None) };
        let nearer = |a: (f64, f64), b: (f64, f64)| if b.0 < a.0 { b } else { a };
        let add = |nearest: (f64, f64), j: usize| {
            let fold = 0.5 * speeds[j] / growth[j];
            if fold > 0.0 { nearer(nearest, (fold, speeds[j])) } else { nearest }
        };
        let (fold, speed) = gather(number, || (f64::INFINITY, f64::INFINITY), add, nearer);
        // Of a speed v the part that does not grow is about the mean one, u, and no more than that of the drive:
        // v/(2 dv/dX_T) is then d (1 + u/v + …).
        let calm = (sum(number, |j| speeds[j]) / number as f64).min(1.0) / speed;
        let limit = self.length() / largest(number, |j| speeds[j].abs());
        Ok(Some(FoldPrediction { speeds, growth, fold: fold / (1.0 + calm), doubt: calm * calm, limit }))
    }

    fn speeds_and_growth(&mut self) -> Result<Option<(Vec<f64>, Vec<f64>)>> {
        let number = self.len();
        self.stiffen(0.0);
        let mut speeds: Vec<f64> = (0..number).map(|j| self.connection(j)).collect();
        let goal = SOLVED * self.setting.connection;
        if self.coupling.solve_variable(&self.springs, &mut speeds, goal).is_none() {
            return Ok(None);
        }
        let fastest = largest(number, |j| speeds[j].abs());
        let distance = LOOK * self.length() / fastest;
        fill(&mut self.by, |j| speeds[j] * distance);
        // Tangents there, and then the forces by which they differ.
        let mut growth = vec![0.0; number];
        self.cells.residual(&self.by, &mut self.excess, &mut growth)?;
        let slope = |j: usize| self.springs[j] - self.connection(j);
        change(&mut growth, |j, tangent| -speeds[j] * (tangent - slope(j)) / distance);
        let most = largest(number, |j| growth[j].abs());
        let stable = self.coupling.solve_variable(&self.springs, &mut growth, SOLVED * most);
        Ok(stable.map(|_| (speeds, growth)))
    }
}
