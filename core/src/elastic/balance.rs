//! The one step: towards the nearest state in balance ahead, with or without viscosity.

use super::Interface;
use super::batch::{all, change, fill, largest};
use crate::Result;
use crate::monitor::Monitor;

/// Steps that lead farther, in lengths on which slopes change, are out of bounds.
const FAR: f64 = 100.0;

/// What a solution leaves of the largest force.
const SOLVED: f64 = 1e-4;

/// Forces in balance, of the largest that cells have.
const BALANCED: f64 = 1e-14;

/// Roundings of a position by which the slider pulls.
const ROUNDINGS: f64 = 4.0;

/// A change of slopes that is seen in what a step leaves, of the excess force: at a fold it leaves a quarter, and half of it
/// is bent.
const CURVED: f64 = 0.1;

/// A step that has been made.
pub(super) struct Step {
    /// η/dt.
    pub rate: f64,
    /// Whether slopes on the way mattered for what the step has left of the excess forces: then it is no rounding.
    pub curved: bool,
}

impl Interface {
    /// Finds the balance from which the interface starts.
    pub(super) fn begin(&mut self) -> Result<()> {
        if self.excess_here()? > 0.0 {
            let connected = self.connected as f64 * self.setting.connection;
            self.drive = self.total_force() / connected;
            self.excess_here()?;
            let springs: Vec<f64> = (0..self.len()).map(|j| self.connection(j)).collect();
            let goal = self.precision();
            self.coupling.respond(&springs, &mut self.excess, goal);
            self.positions.copy_from_slice(&self.excess);
            self.coupling.forces(&self.positions, &mut self.held);
        }
        self.closed = self.stored();
        Ok(())
    }

    /// What is rounding in a force out of balance.
    pub(super) fn precision(&self) -> f64 {
        let number = self.len();
        let pull = largest(number, |j| {
            self.connection(j) * self.drive.abs() + self.coupling.own(j) * self.positions[j].abs()
        });
        BALANCED * self.cells.strongest() + ROUNDINGS * f64::EPSILON * pull
    }

    /// The largest force out of balance where the cells are; forces, tangents and all excesses are known then.
    pub(super) fn excess_here(&mut self) -> Result<f64> {
        self.excess.fill(0.0);
        self.sense()
    }

    /// The same after the advances that are tried.
    pub(super) fn excess_ahead(&mut self) -> Result<f64> {
        self.coupling.forces(&self.by, &mut self.excess);
        self.sense()
    }

    /// Adds everything to the forces by which the slider answers to the advances that are tried.
    fn sense(&mut self) -> Result<f64> {
        self.cells.ahead(&self.by, &mut self.responses)?;
        let (drive, connected, stiffness) = (self.drive, self.connected, self.setting.connection);
        let (positions, by, held, responses) = (&self.positions, &self.by, &self.held, &self.responses);
        change(&mut self.excess, |j, force| {
            let pull = if j < connected { stiffness * (drive - positions[j] - by[j]) } else { 0.0 };
            pull + (held[j] + force) - responses[j].force
        });
        Ok(largest(self.len(), |j| self.excess[j].abs()))
    }

    /// Goes on from the advances that are tried by δ with (η/dt + D + A) δ = excess, `rate` being η/dt; none, and nothing
    /// done, where F' + K_0 + η/dt + A is not positive definite, or hardly.
    ///
    /// D_j ≥ F_j' + K_0j is an upper bound on the way that the cell takes, and (η/dt + D + A)⁻¹ has no entry below 0. So
    /// excess forces that are ≥ 0 stay so, and no state in balance is passed. Where slopes fall on the way F_j' where it
    /// begins is such a bound, and the step is Newton's; else a second solution takes the largest slope on the way of
    /// the first one, which is the longer.
    pub(super) fn step(&mut self, rate: f64) -> Result<Option<Step>> {
        let excess = largest(self.len(), |j| self.excess[j].abs());
        let goal = self.goal(excess);
        let mut springs = std::mem::take(&mut self.springs);
        fill(&mut springs, |j| self.responses[j].tangent + self.connection(j) + rate);
        let mut way = self.excess.clone();
        let stable = self.coupling.respond(&springs, &mut way, goal);
        if !stable || largest(way.len(), |j| way[j].abs()) > FAR * self.length() {
            self.springs = springs;
            return Ok(None);
        }
        change(&mut way, |j, way| self.by[j] + way);
        self.cells.slopes(Some(&self.by), &way, &mut self.slopes)?;
        let bound = |j: usize| self.slopes[j].largest + self.connection(j) + rate;
        if all(self.len(), |j| bound(j) <= springs[j]) {
            change(&mut way, |j, way| way - self.by[j]);
        } else {
            change(&mut springs, |j, spring| spring.max(bound(j)));
            way.copy_from_slice(&self.excess);
            self.coupling.respond(&springs, &mut way, goal);
        }
        self.springs = springs;
        change(&mut self.by, |j, by| by + way[j]);
        let bend = |j: usize| (self.slopes[j].largest - self.slopes[j].least) * way[j].abs();
        let curved = largest(way.len(), bend) > CURVED * excess;
        Ok(Some(Step { rate, curved }))
    }

    /// The length on which the steepest slope makes the strongest force.
    pub(super) fn length(&self) -> f64 {
        self.cells.strongest() / self.cells.steepest()
    }

    /// What a solution for such forces may leave of them.
    fn goal(&self, excess: f64) -> f64 {
        (SOLVED * excess).max(0.3 * self.precision())
    }

    /// Goes on from the advances that are tried by Newton's step; whether the state there is stable.
    pub(super) fn newton(&mut self) -> bool {
        let mut springs = std::mem::take(&mut self.springs);
        fill(&mut springs, |j| self.responses[j].tangent + self.connection(j));
        let mut way = self.excess.clone();
        let goal = self.goal(largest(self.len(), |j| self.excess[j].abs()));
        let stable = self.coupling.respond(&springs, &mut way, goal);
        self.springs = springs;
        if stable {
            change(&mut self.by, |j, by| by + way[j]);
        }
        stable
    }

    /// Whether every state between here, with the given forces, and the advances that are tried, in balance at a drive that
    /// has gone by `distance`, is stable, so that there is one way from here to there: the matrix M of the least slopes is
    /// positive definite.
    ///
    /// It is, its off-diagonals being ≤ 0, if M δ > 0 for some δ > 0. The balances before and after give that for the
    /// advances δ themselves: (M δ)_j = K_0j ΔX_T − (ΔF_j − least slope · δ_j).
    pub(super) fn is_stable_ahead(&mut self, forces: &[f64], distance: f64) -> Result<bool> {
        self.cells.slopes(None, &self.by, &mut self.slopes)?;
        let least = |j: usize| self.slopes[j].least + self.connection(j);
        let bent = |j: usize| self.responses[j].force - forces[j] - self.slopes[j].least * self.by[j];
        let proven = |j: usize| self.by[j] > 0.0 && bent(j) < self.connection(j) * distance;
        if all(self.len(), |j| least(j) > 0.0) || all(self.len(), proven) {
            return Ok(true);
        }
        if !all(self.len(), |j| least(j) > f64::NEG_INFINITY) {
            return Ok(false);
        }
        let mut springs = vec![0.0; self.len()];
        fill(&mut springs, least);
        let mut answer = vec![1.0; self.len()];
        Ok(self.coupling.respond(&springs, &mut answer, SOLVED))
    }

    /// Makes the advances that were tried.
    pub(super) fn commit(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        self.cells.advance(&self.by, monitor)?;
        change(&mut self.positions, |j, position| position + self.by[j]);
        self.by.fill(0.0);
        self.coupling.forces(&self.positions, &mut self.held);
        Ok(())
    }
}
