//! The one step: towards the nearest state in balance ahead, with or without viscosity.

use super::Interface;
use super::batch::{all, change, fill, largest};
use super::cells::{Extremes, Slopes};
use super::differences::Differences;
use super::solve::MOST_STEPS;
use crate::Result;
use crate::monitor::Monitor;

/// Steps that lead farther, in lengths on which slopes change, are out of bounds.
const FAR: f64 = 100.0;

/// What a solution leaves of the largest force.
const SOLVED: f64 = 1e-4;

/// The same in Newton's method, which has to converge alone.
const NEWTON: f64 = 1e-3;

/// Forces in balance, of the largest that cells have.
const BALANCED: f64 = 1e-14;

/// The same while cells creep: the next stride begins from forces, not from what the last one has left of them.
const CALM: f64 = 1e-11;

/// What a solution leaves of a force of 1, where it is not 1 but above 0 that matters.
const POSITIVE: f64 = 0.5;

/// Roundings of a position by which the slider pulls.
const ROUNDINGS: f64 = 4.0;

/// A change of slopes that is seen in what a step leaves, of the excess force: at a fold it leaves a quarter, and half of it
/// is bent.
const CURVED: f64 = 0.1;

/// A step that has been made.
pub(super) struct BalanceStep {
    /// η/dt.
    pub rate: f64,
    /// How many responses on equal springs it took.
    pub taken: usize,
    /// Whether slopes on the way mattered for what the step has left of the excess forces: then it is no rounding.
    pub curved: bool,
}

impl Interface {
    /// Finds the balance from which the interface starts.
    pub(super) fn begin(&mut self) -> Result<()> {
        if self.excess_here()? > 0.0 {
            self.drive = self.force()? / (self.connected as f64 * self.setting.connection);
            self.excess_here()?;
            let connection = self.connections();
            fill(&mut self.springs, connection);
            let goal = self.precision();
            self.coupling.solve_variable(&self.springs, &mut self.excess, goal);
            self.positions.copy_from_slice(&self.excess);
            if let Some(differences) = &mut self.differences {
                differences.put(&self.positions);
            }
        }
        self.closed = self.stored();
        Ok(())
    }

    /// What is rounding in a force out of balance.
    pub(super) fn precision(&self) -> f64 {
        let (number, displaced) = (self.len(), Differences::now(self.differences.as_ref(), &self.positions));
        let pull = largest(number, |j| {
            self.connection(j) * self.drive.abs() + self.coupling.self_stiffness(j) * displaced[j].abs()
        });
        BALANCED * self.cells.extremes().strongest + ROUNDINGS * f64::EPSILON * pull
    }

    /// What creep leaves of forces out of balance.
    pub(super) fn calm(&self) -> f64 {
        self.precision().max(CALM * self.cells.extremes().strongest)
    }

    /// The largest force out of balance where the cells are, no advances being tried; all of them are known then.
    pub(super) fn excess_here(&mut self) -> Result<f64> {
        self.pull_here();
        self.resist()
    }

    /// The same after the advances that are tried, from where the slider pulls by `held`.
    pub(super) fn excess_ahead(&mut self, held: &[f64]) -> Result<f64> {
        self.coupling.forces(Differences::ahead(self.differences.as_ref(), &self.by), &mut self.excess);
        let connection = self.connections();
        let (drive, positions, by) = (self.drive, &self.positions, &self.by);
        let pull = |j: usize| connection(j) * (drive - positions[j] - by[j]);
        change(&mut self.excess, |j, force| pull(j) + (held[j] + force));
        self.resist()
    }

    /// In place of the excess the forces by which drive and slider pull at cells where they are.
    pub(super) fn pull_here(&mut self) {
        self.coupling.forces(Differences::now(self.differences.as_ref(), &self.positions), &mut self.excess);
        let (connection, drive, positions) = (self.connections(), self.drive, &self.positions);
        change(&mut self.excess, |j, held| connection(j) * (drive - positions[j]) + held);
    }

    /// Takes the forces of the contacts after the advances that are tried off the pulls; the largest excess that is left.
    pub(super) fn resist(&mut self) -> Result<f64> {
        self.cells.residual(&self.by, &mut self.excess, &mut self.springs)
    }

    /// Makes springs F' + K_0 + η/dt of the tangents.
    pub(super) fn stiffen(&mut self, rate: f64) {
        let connection = self.connections();
        change(&mut self.springs, |j, tangent| tangent + (connection(j) + rate));
    }

    /// The largest force out of balance that was found.
    fn largest_excess(&self) -> f64 {
        largest(self.len(), |j| self.excess[j].abs())
    }

    /// Tries to go on by δ with (η/dt + D + A) δ = excess, `rate` being η/dt; none, and no advance, where
    /// F' + K_0 + η/dt + A is not positive definite, or hardly. The excess has just been asked for, and is not known
    /// afterwards.
    ///
    /// D_j ≥ F_j' + K_0j is an upper bound on the way that the cell takes, and (η/dt + D + A)⁻¹ has no entry below 0. So
    /// excess forces that are ≥ 0 stay so, and no state in balance is passed. Where slopes fall on the way F_j' where it
    /// begins is such a bound, and the step is Newton's; else a second solution takes the largest slope on the way of
    /// the first one, which is the longer.
    pub(super) fn step(&mut self, rate: f64) -> Result<Option<BalanceStep>> {
        let excess = self.largest_excess();
        let goal = (SOLVED * excess).max(0.3 * self.precision());
        self.stiffen(rate);
        let stable = self.coupling.solve_variable(&self.springs, &mut self.excess, goal);
        let Some(mut taken) = stable.filter(|_| self.largest_excess() <= FAR * self.length()) else {
            return Ok(None);
        };
        let connection = self.connections();
        let mut slopes = self.slopes_ahead()?;
        let bound = |j: usize| slopes[j].largest + connection(j) + rate;
        if !all(self.len(), |j| bound(j) <= self.springs[j]) {
            // By so much less, (D + A)⁻¹ (D − F' − K_0 − η/dt) times the first solution.
            self.by.copy_from_slice(&self.excess);
            let (by, springs) = (&self.by, &self.springs);
            fill(&mut self.excess, |j| (bound(j) - springs[j]).max(0.0) * by[j]);
            change(&mut self.springs, |j, spring| spring.max(bound(j)));
            drop(slopes);
            taken += self.coupling.solve_variable(&self.springs, &mut self.excess, goal).unwrap_or_default();
            let by = &self.by;
            change(&mut self.excess, |j, less| by[j] - less);
            slopes = self.slopes_ahead()?;
        }
        self.by.copy_from_slice(&self.excess);
        let bent = |j: usize| self.springs[j] - rate - connection(j) - slopes[j].least;
        let curved = largest(self.len(), |j| bent(j) * self.excess[j].abs()) > CURVED * excess;
        Ok(Some(BalanceStep { rate, taken, curved }))
    }

    /// Slopes on the way of a solution in place of the excess.
    fn slopes_ahead(&mut self) -> Result<Vec<Slopes>> {
        let mut slopes = vec![Slopes::default(); self.len()];
        self.cells.slopes(&self.excess, &mut slopes)?;
        Ok(slopes)
    }

    /// The length on which the steepest slope makes the strongest force.
    pub(super) fn length(&self) -> f64 {
        let Extremes { strongest, steepest, .. } = self.cells.extremes();
        strongest / steepest
    }

    /// Goes on from the advances that are tried by Newton's step, the largest excess having just been asked for; whether
    /// the state there is stable.
    pub(super) fn newton(&mut self, excess: f64) -> bool {
        self.stiffen(0.0);
        let goal = (NEWTON * excess).max(0.3 * self.calm());
        let stable = self.coupling.solve_variable(&self.springs, &mut self.excess, goal).is_some();
        if stable {
            change(&mut self.by, |j, by| by + self.excess[j]);
            if let Some(differences) = &mut self.differences {
                differences.correct(&self.excess);
            }
        }
        stable
    }

    /// Whether every state between here and the advances that are tried, both in balance, is stable, so that there is one
    /// way from here to there: the matrix M of the least slopes is positive definite.
    ///
    /// It is, its off-diagonals being ≤ 0, if M δ > 0 for some δ > 0, such as the advances themselves often are, or what
    /// comes near the response to equal forces.
    pub(super) fn is_stable_ahead(&mut self) -> Result<bool> {
        let (number, connection) = (self.len(), self.connections());
        let mut slopes = vec![Slopes::default(); number];
        self.cells.slopes(&self.by, &mut slopes)?;
        fill(&mut self.springs, |j| slopes[j].least + connection(j));
        drop(slopes);
        if all(number, |j| self.springs[j] > 0.0) {
            return Ok(true);
        }
        if !all(number, |j| self.springs[j] > f64::NEG_INFINITY) {
            return Ok(false);
        }
        self.coupling.forces(Differences::ahead(self.differences.as_ref(), &self.by), &mut self.excess);
        if all(number, |j| self.by[j] > 0.0 && self.springs[j] * self.by[j] > self.excess[j]) {
            return Ok(true);
        }
        self.excess.fill(1.0);
        let taken = self.coupling.solve_variable(&self.springs, &mut self.excess, POSITIVE);
        let found = taken.is_some_and(|taken| taken < MOST_STEPS);
        Ok(found && all(number, |j| self.excess[j] > 0.0))
    }

    /// Makes the advances that were tried.
    pub(super) fn commit(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        self.cells.advance(&self.by, monitor)?;
        change(&mut self.positions, |j, position| position + self.by[j]);
        if let Some(differences) = &mut self.differences {
            differences.advance(&self.by);
        }
        self.by.fill(0.0);
        Ok(())
    }
}
