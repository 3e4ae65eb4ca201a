//! Steps of Newton's method towards balance, and the test that a path of balances is stable.
//!
//! With the diagonal d_j = F_j' + K_0j + η_j/dt each step solves (d + A) δ = r for the advances δ of the cells, r being the
//! residual. A is an M-matrix: its off-diagonal entries are ≤ 0 and its rows add up to ≥ 0. If d + A is positive definite,
//! it is an M-matrix too, and its inverse has no negative entry (A. Berman and R. J. Plemmons, *Nonnegative Matrices in the
//! Mathematical Sciences*, SIAM 1994, chapter 6, doi:10.1137/1.9781611971262).

use super::batch::{all, change, fill, largest};
use super::configuration::Advances;
use super::coupling::MOST_ITERATIONS;
use super::residual::{InterfaceModel, Residual};
use crate::Result;
use crate::monitor::Monitor;

/// Steps that lead farther, in lengths on which slopes change, are rejected.
const FAR: f64 = 100.0;

/// Residual of the linear system of a monotone step, relative to the largest force out of balance.
const SOLVED: f64 = 1e-4;

/// The same of a plain Newton step, which has to converge quickly.
const NEWTON: f64 = 1e-3;

/// Residual of the linear system with right-hand side 1, of whose solution only the sign matters.
const POSITIVE: f64 = 0.5;

/// Part of a linear residual goal that is due to rounding.
const ROUNDED: f64 = 0.3;

/// Largest change of the residual by changes of the slopes, relative to the residual, at which a step counts as linear: at a
/// fold a step leaves a quarter of the residual, and the slopes make half of the change.
const CURVED: f64 = 0.1;

/// A step towards the nearest balance.
pub(super) struct MonotoneStep {
    /// δ_j.
    pub by: Vec<f64>,
    /// η/dt of a cell of area 1.
    pub rate: f64,
    /// Number of applications of the preconditioner.
    pub iterations: usize,
    /// Whether the residual after the step is due to slopes that changed on the way, so that it is no rounding error.
    pub curved: bool,
}

impl InterfaceModel {
    /// A step that passes no balance: Newton's method with an upper bound of the slopes (J. M. Ortega and W. C. Rheinboldt,
    /// *Iterative Solution of Nonlinear Equations in Several Variables*, SIAM 2000, chapter 13,
    /// doi:10.1137/1.9780898719468). None where d + A is not positive definite, or hardly so. `rate` is η/dt of a cell of
    /// area 1, and `rounding` the rounding error of the residual.
    ///
    /// If D_j ≥ F_j' on the way that cell j takes, plus K_0j + η_j/dt, the step (D + A)⁻¹ r leaves a residual ≥ 0 where it
    /// was ≥ 0, because (D + A)⁻¹ has no negative entry. So all cells move forward, and none passes the nearest balance
    /// ahead. Where slopes fall on the way, the slope at its start is such a bound, and the step is Newton's. Otherwise D is
    /// the largest slope on the way of the Newton step, which is the longer one.
    pub fn monotone_step(
        &mut self,
        r: Residual,
        rate: f64,
        rounding: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<MonotoneStep>> {
        let Residual { forces, tangents, largest: residual } = r;
        // The springs share the areas: to clone them is cheap.
        let (number, springs) = (forces.len(), self.springs.clone());
        // An inexact Newton method (R. S. Dembo, S. C. Eisenstat and T. Steihaug, SIAM J. Numer.
        // Anal. 19, 400 (1982)): far from balance the linear system need not be solved to rounding.
        let goal = (SOLVED * residual).max(ROUNDED * rounding);
        let (mut diagonal, mut by) = (self.diagonal(tangents, rate), forces);
        let solved = self.coupling.solve_variable(&diagonal, &mut by, goal, monitor)?;
        // Close to singular matrices give steps beyond any use, for which curves would have to be
        // tabulated.
        let near = |by: &[f64]| largest(number, |j| by[j].abs()) <= FAR * self.length();
        let Some(mut iterations) = solved.filter(|_| near(&by)) else { return Ok(None) };
        let mut slopes = self.slopes(&by, monitor)?;
        let bound = |j: usize| slopes[j].largest + springs.of(j) + springs.areas().of(j) * rate;
        if !all(number, |j| bound(j) <= diagonal[j]) {
            // (D + A)⁻¹ r = δ − (D + A)⁻¹ (D − d) δ, with the Newton step δ.
            let mut less = vec![0.0; number];
            fill(&mut less, |j| (bound(j) - diagonal[j]).max(0.0) * by[j]);
            change(&mut diagonal, |j, d| d.max(bound(j)));
            drop(slopes);
            let solved = self.coupling.solve_variable(&diagonal, &mut less, goal, monitor)?;
            iterations += solved.unwrap_or_default();
            change(&mut by, |j, by| by - less[j]);
            slopes = self.slopes(&by, monitor)?;
        }
        let damping = |j: usize| springs.areas().of(j) * rate;
        let fall = |j: usize| diagonal[j] - damping(j) - springs.of(j) - slopes[j].least;
        let curved = largest(number, |j| fall(j) * by[j].abs()) > CURVED * residual;
        Ok(Some(MonotoneStep { by, rate, iterations, curved }))
    }

    /// The correction by Newton's method, to be added to advances that leave the residual; none where the state is not
    /// stable. `tolerance` is the residual that is aimed at.
    pub fn newton_correction(
        &mut self,
        r: Residual,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Vec<f64>>> {
        let Residual { forces, tangents, largest } = r;
        let goal = (NEWTON * largest).max(ROUNDED * tolerance);
        let (diagonal, mut correction) = (self.diagonal(tangents, 0.0), forces);
        let solved = self.coupling.solve_variable(&diagonal, &mut correction, goal, monitor)?;
        Ok(solved.map(|_| correction))
    }

    /// Whether every state between the present one and the one after the advances, both in balance, is stable, so that
    /// there is only one path of balances from one to the other: the matrix M with the least slopes on the diagonal is
    /// positive definite.
    ///
    /// Because its off-diagonal entries are ≤ 0, M is positive definite if M x > 0 for some x > 0 (Berman and Plemmons,
    /// chapter 6). Two x are tried: the advances, and the solution of M x = 1.
    pub fn is_stable_ahead(&mut self, advances: &Advances, monitor: &mut dyn Monitor) -> Result<bool> {
        let (number, springs, by) = (self.len(), self.springs.clone(), &advances.by);
        let slopes = self.slopes(by, monitor)?;
        let mut diagonal = vec![0.0; number];
        fill(&mut diagonal, |j| slopes[j].least + springs.of(j));
        drop(slopes);
        // A is weakly diagonally dominant, so that a positive diagonal makes M positive definite.
        if all(number, |j| diagonal[j] > 0.0) {
            return Ok(true);
        }
        if !all(number, |j| diagonal[j] > f64::NEG_INFINITY) {
            return Ok(false);
        }
        let mut elastic = self.elastic_forces(advances.displacements(), monitor)?;
        if all(number, |j| by[j] > 0.0 && diagonal[j] * by[j] > elastic[j]) {
            return Ok(true);
        }
        let x = &mut elastic;
        x.fill(1.0);
        let iterations = self.coupling.solve_variable(&diagonal, x, POSITIVE, monitor)?;
        let found = iterations.is_some_and(|iterations| iterations < MOST_ITERATIONS);
        Ok(found && all(number, |j| x[j] > 0.0))
    }
}
