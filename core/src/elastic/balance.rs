//! The one step: towards the nearest state in balance ahead, with or without viscosity.

use super::Interface;
use super::batch::{all, change, fill, largest};
use crate::Result;
use crate::monitor::Monitor;

/// The least spring of a step where a slope has no balance, of the steepest slope: the softer, the larger first steps
/// are and the less is known of the slope on them.
const SOFTEST: f64 = 0.05;

/// Forces in balance, of the largest that cells have.
const BALANCED: f64 = 1e-14;

/// Roundings of a position by which the slider pulls.
const ROUNDINGS: f64 = 4.0;

/// A change of slopes that is seen in what a step leaves, of the excess force: at a fold it leaves a quarter, and half of it
/// is bent.
const CURVED: f64 = 0.1;

/// A step that has been made.
pub(super) struct Step {
    /// Whether the state that it was made from is stable.
    pub stable: bool,
    /// The largest advance.
    pub largest: f64,
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
            self.coupling.respond(&springs, &mut self.excess);
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

    /// Goes on from the advances that are tried by δ with (η/dt + D + A) δ = excess, `rate` being η/dt.
    ///
    /// D_j ≥ F_j' + K_0j is an upper bound on the way that the cell takes, and (η/dt + D + A)⁻¹ has no entry below 0. So
    /// excess forces that are ≥ 0 stay so, and no state in balance is passed. Where slopes fall on the way F_j' where it
    /// begins is such a bound, and the step is Newton's; else a second solution takes the largest slope on the way of
    /// the first one, which is the longer.
    pub(super) fn step(&mut self, rate: f64) -> Result<Step> {
        let softest = SOFTEST * self.cells.steepest();
        let mut springs = std::mem::take(&mut self.springs);
        fill(&mut springs, |j| self.responses[j].tangent + self.connection(j) + rate);
        let mut way = self.excess.clone();
        let stable = self.coupling.respond(&springs, &mut way);
        if !stable {
            change(&mut springs, |_, spring| spring.max(softest));
            way.copy_from_slice(&self.excess);
            self.coupling.respond(&springs, &mut way);
        }
        change(&mut way, |j, way| self.by[j] + way);
        self.cells.slopes(Some(&self.by), &way, &mut self.slopes)?;
        let bound = |j: usize| self.slopes[j].largest + self.connection(j) + rate;
        if all(self.len(), |j| bound(j) <= springs[j]) {
            change(&mut way, |j, way| way - self.by[j]);
        } else {
            change(&mut springs, |j, spring| spring.max(bound(j)));
            way.copy_from_slice(&self.excess);
            self.coupling.respond(&springs, &mut way);
        }
        self.springs = springs;
        change(&mut self.by, |j, by| by + way[j]);
        let excess = largest(way.len(), |j| self.excess[j].abs());
        let bend = |j: usize| (self.slopes[j].largest - self.slopes[j].least) * way[j].abs();
        let curved = largest(way.len(), bend) > CURVED * excess;
        Ok(Step { stable, largest: largest(way.len(), |j| way[j].abs()), curved })
    }

    /// Whether every state between here and the advances that are tried is stable, so that there is one way in balance
    /// from here to there: the matrix of the least slopes is positive definite.
    pub(super) fn is_stable_ahead(&mut self) -> Result<bool> {
        self.cells.slopes(None, &self.by, &mut self.slopes)?;
        let least = |j: usize| self.slopes[j].least + self.connection(j);
        if all(self.len(), |j| least(j) > 0.0) {
            return Ok(true);
        }
        if !all(self.len(), |j| least(j) > f64::NEG_INFINITY) {
            return Ok(false);
        }
        let mut springs = vec![0.0; self.len()];
        fill(&mut springs, least);
        let mut answer = vec![1.0; self.len()];
        Ok(self.coupling.respond(&springs, &mut answer))
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
