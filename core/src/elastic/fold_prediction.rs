//! Prediction of creep from a balance: how cells move as the drive rises, and where balance will be lost.
//!
//! Balance is lost at a fold (saddle-node bifurcation) of the path of balances. Near it positions change as the square root
//! of the drive that is left, and the velocity v of the unstable cells grows as 1/√d with the distance d to the fold. So
//! v and dv/dX_T at one balance give d = v/(2 dv/dX_T).

use super::batch::{change, fill, gather, largest, sum};
use super::configuration::Configuration;
use super::residual::{InterfaceModel, Residual};
use crate::Result;
use crate::monitor::Monitor;

/// Residual of the linear systems, relative to their largest force: a prediction need not be better.
const SOLVED: f64 = 1e-2;

/// Displacement for the finite difference of the slopes, relative to the length on which slopes change.
const DIFFERENCE: f64 = 1e-6;

/// Prediction of the creep of all cells from a balance as the drive rises.
pub(super) struct FoldPrediction {
    /// v_j = dX_j/dX_T = (F' + K_0 + A)⁻¹ K_0.
    velocities: Vec<f64>,
    /// d²X_j/dX_T² = −(F' + K_0 + A)⁻¹ F'' v².
    accelerations: Vec<f64>,
    /// Distance of the drive to where balance is lost.
    pub fold: f64,
    /// Relative uncertainty of that.
    pub uncertainty: f64,
    /// Distance of the drive after which a cell has moved by the length on which slopes change.
    pub limit: f64,
}

impl FoldPrediction {
    /// Advance of a cell when the drive rises by a distance: by the square-root law of a fold where the cell accelerates
    /// towards one, otherwise to second order.
    pub fn advance(&self, cell: usize, distance: f64) -> f64 {
        let (velocity, acceleration) = (self.velocities[cell], self.accelerations[cell]);
        let to_fold = 2.0 * acceleration * distance / velocity;
        // A second-order expansion fails near the fold, where all derivatives diverge; the
        // square-root law has the right singularity and agrees with it far from the fold.
        if to_fold > 0.0 && to_fold < 1.0 {
            // 2 d v (1 − √(1 − h/d)) after a distance h, with the distance d of the fold.
            2.0 * velocity * distance / (1.0 + (1.0 - to_fold).sqrt())
        } else {
            velocity * distance + 0.5 * acceleration * distance * distance
        }
    }
}

impl InterfaceModel {
    /// The prediction from the present balance; `None` if it is not stable.
    pub fn predict_fold(
        &mut self,
        configuration: &Configuration,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<FoldPrediction>> {
        let number = self.len();
        let residual = self.residual(configuration, monitor)?;
        let Some((velocities, accelerations)) = self.creep_derivatives(residual, monitor)? else {
            return Ok(None);
        };
        let nearer = |a: (f64, f64), b: (f64, f64)| if b.0 < a.0 { b } else { a };
        let add = |nearest: (f64, f64), j: usize| {
            let fold = 0.5 * velocities[j] / accelerations[j];
            if fold > 0.0 { nearer(nearest, (fold, velocities[j])) } else { nearest }
        };
        let (fold, velocity) = gather(number, || (f64::INFINITY, f64::INFINITY), add, nearer);
        // The part of v that does not diverge is about the mean velocity u, and at most that of the drive, 1: the distance
        // is then d (1 + u/v + …).
        let regular = (sum(number, |j| velocities[j]) / number as f64).min(1.0) / velocity;
        let limit = self.length() / largest(number, |j| velocities[j].abs());
        let (fold, uncertainty) = (fold / (1.0 + regular), regular * regular);
        Ok(Some(FoldPrediction { velocities, accelerations, fold, uncertainty, limit }))
    }

    /// First and second derivatives of the positions by the drive; none where the matrix is not positive definite.
    fn creep_derivatives(
        &mut self,
        balance: Residual,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(Vec<f64>, Vec<f64>)>> {
        let (number, springs) = (self.len(), self.springs.clone());
        let diagonal = self.diagonal(balance.tangents, 0.0);
        let mut velocities: Vec<f64> = (0..number).map(|j| springs.of(j)).collect();
        let goal = SOLVED * springs.largest();
        if self.coupling.solve_variable(&diagonal, &mut velocities, goal, monitor)?.is_none() {
            return Ok(None);
        }
        let fastest = largest(number, |j| velocities[j].abs());
        // F'' v² from a finite difference of the tangents along the velocities.
        // F'' along one direction only: one more evaluation of tangents, in place of second
        // derivatives of every curve.
        let distance = DIFFERENCE * self.length() / fastest;
        let mut by = balance.forces;
        fill(&mut by, |j| velocities[j] * distance);
        let mut accelerations = self.tangents(&by, monitor)?;
        let tangent = |j: usize| diagonal[j] - springs.of(j);
        change(&mut accelerations, |j, ahead| -velocities[j] * (ahead - tangent(j)) / distance);
        let largest = largest(number, |j| accelerations[j].abs());
        drop(by);
        let goal = SOLVED * largest;
        let stable = self.coupling.solve_variable(&diagonal, &mut accelerations, goal, monitor)?;
        Ok(stable.map(|_| (velocities, accelerations)))
    }
}
