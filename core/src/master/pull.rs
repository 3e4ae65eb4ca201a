//! A pull of the slider's bottom from X = 0: force, breaking rate and distribution of stretches at any X.

use std::sync::OnceLock;

use super::renewal::{RenewalSolution, unit_force};
use super::{Extremum, Stretches};
use crate::Result;
use crate::law::Atom;
use crate::life::Life;
use crate::monitor::Monitor;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::roots::{brent_minimum, brent_root};

/// Forces and slopes differ if they do by so many tolerances, or errors where these are larger.
const SLACK: f64 = 10.0;

/// The solution of a pull, functions of X in `[0, distance]`.
///
/// Γ solves the renewal equation Γ(X) = φ₀(X) + ∫₀^X Γ(Y) φ(X − Y) dY, and from it
/// F(X) = F₀(X) + ∫₀^X Γ(Y) m(X − Y) dY, with φ and m the breaking density and carried force of re-formed contacts,
/// φ₀ and F₀ those of the initial ones. Forces are totals, N_c⟨k⟩ included.
#[derive(Debug, Clone)]
pub struct Pull {
    leg: RenewalSolution,
    distance: f64,
    tolerance: f64,
    /// N_c⟨k⟩ or N_c κ.
    stiffness: f64,
    square: OnceLock<Piecewise>,
}

impl Pull {
    pub(super) fn new(leg: RenewalSolution, stiffness: f64, distance: f64, tolerance: f64) -> Self {
        Self { leg, distance, tolerance, stiffness, square: OnceLock::new() }
    }

    /// The distance asked for; the solution may reach further.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Number of cells of the solution.
    pub fn cells(&self) -> usize {
        self.leg.force.coefficients.len()
    }

    /// F(X), after the break where contacts break together at X.
    pub fn force(&self, position: f64) -> f64 {
        self.stiffness * at(&self.leg.force, position)
    }

    /// F'(X), from the right.
    pub fn slope(&self, position: f64) -> f64 {
        self.stiffness * at(&self.leg.slope, position)
    }

    /// Density part of Γ(X), the fraction of contacts that break per unit length.
    pub fn breaking_rate(&self, position: f64) -> f64 {
        self.leg.breaking_rate(position)
    }

    /// Atoms of Γ: positions at which a finite fraction of the contacts breaks together.
    pub fn breaking_atoms(&self) -> &[Atom] {
        let within = self.leg.solution.atoms.partition_point(|a| a.position <= self.distance * (1.0 + 1e-12));
        &self.leg.solution.atoms[..within]
    }

    /// Standard deviation of the force, as a function of the position X, where it is carried by `size` contacts drawn at random
    /// and scaled to N_c: contacts are independent under a rigid drive, so that it is N_c⟨k⟩ √([∫x²Q − (∫xQ)²]/size), exactly.
    /// What it takes is found once.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub fn force_std<'a>(
        &'a self,
        size: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<impl Fn(f64) -> f64 + Send + Sync + use<'a>> {
        if self.square.get().is_none() {
            let square = self.leg.sum(Life::square, monitor)?;
            self.square.get_or_init(|| square);
        }
        Ok(move |position: f64| {
            let mean = at(&self.leg.force, position);
            let square = self.square.get().map_or(f64::NAN, |square| at(square, position));
            self.stiffness * ((square - mean * mean).max(0.0) / size).sqrt()
        })
    }

    /// ∫Q(x; X) dx, after the break where contacts break together at X, by a quadrature that shares nothing with the
    /// solution of the renewal equation but Γ: 1.
    pub fn total_probability(&self, position: f64) -> f64 {
        self.leg.sum_at(Life::survival, position)
    }

    /// Q(x; X) at the given stretches, and its point masses.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub fn stretch_density(
        &self,
        position: f64,
        stretches: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Stretches> {
        self.leg.stretch_density(position, stretches, monitor)
    }

    /// F_s and X_s: the maximum of F on (0, distance) and its place, at a jump the left limit; the first of equals.
    /// `None` where F, to within the tolerance, does not fall from there, or ends higher.
    pub fn static_friction(&self) -> Option<Extremum> {
        let slack = self.slack() * unit_force(&self.leg.reborn);
        let cells = 0..=self.last_cell();
        let mut best = (0.0, f64::NEG_INFINITY, 0);
        for cell in cells.clone() {
            for (position, value) in self.peaks(cell) {
                if position > 0.0 && value > best.1 + slack {
                    best = (position, value, cell);
                }
            }
        }
        let (position, value, cell) = best;
        let ends = |later: usize| {
            let edges = &self.leg.force.boundaries;
            let from = if later == cell { position } else { edges[later] };
            [from, edges[later + 1].min(self.distance)].map(|x| self.leg.force.value_in(later, x))
        };
        let fallen = cells.skip(cell).any(|later| ends(later).into_iter().any(|force| force < value - slack));
        (fallen && position < self.distance).then_some(Extremum { position, value: self.stiffness * value })
    }

    fn last_cell(&self) -> usize {
        let edges = &self.leg.force.boundaries;
        edges.partition_point(|&b| b < self.distance * (1.0 - 1e-12)).saturating_sub(1).min(edges.len() - 2)
    }

    /// Local maxima of F in a cell: inside, and at its upper end.
    fn peaks(&self, cell: usize) -> Vec<(f64, f64)> {
        let (low, high) =
            (self.leg.force.boundaries[cell], self.leg.force.boundaries[cell + 1].min(self.distance));
        let slope = |x: f64| self.leg.slope.value_in(cell, x);
        let inside = windows(low, high).filter(|&(a, b)| slope(a) > 0.0 && slope(b) <= 0.0);
        let roots = inside.filter_map(|(a, b)| brent_root(slope, a, b, 1e-15 * high));
        roots.chain([high]).map(|x| (x, self.leg.force.value_in(cell, x))).collect()
    }

    /// How far forces per N_c⟨k⟩ and mean life, and slopes per N_c⟨k⟩, are apart that differ.
    fn slack(&self) -> f64 {
        SLACK * self.tolerance.max(self.leg.error)
    }

    /// K_c = max(0, −min F') over X ≥ 0; infinite where the force jumps down, 0 where it does not fall but by what the
    /// tolerance, or a larger error, leaves open: ten times that, of N_c⟨k⟩.
    pub fn critical_stiffness(&self) -> f64 {
        let jumps =
            self.leg.solution.atoms.iter().filter(|a| a.position > 0.0 && a.position < self.leg.force.end());
        let falls = |a: &Atom| {
            let after = self.leg.force.nearest(a.position);
            let before = self.leg.force.value_in(after.saturating_sub(1), a.position);
            before - self.leg.force.value_in(after, a.position) > 1e-12 * unit_force(&self.leg.reborn)
        };
        if jumps.into_iter().any(falls) {
            return f64::INFINITY;
        }
        let steepest = (0..self.leg.force.coefficients.len())
            .map(|cell| self.steepest(cell))
            .fold(f64::INFINITY, f64::min);
        if -steepest > self.slack() * self.leg.reborn.stiffness() { -self.stiffness * steepest } else { 0.0 }
    }

    /// The least slope in a cell, its ends included.
    fn steepest(&self, cell: usize) -> f64 {
        let (low, high) = (self.leg.force.boundaries[cell], self.leg.force.boundaries[cell + 1]);
        let slope = |x: f64| self.leg.slope.value_in(cell, x);
        let (mut least, mut near) = (slope(low), (low, low + (high - low) / 8.0));
        for (a, b) in windows(low, high) {
            if slope(b) < least {
                (least, near) = (slope(b), (a, (2.0 * b - a).min(high)));
            }
        }
        brent_minimum(slope, near.0, near.1, 1e-9 * (high - low)).1.min(least)
    }

    /// Estimated error of F/(N_c⟨k⟩), a length: that of the lives of contacts, of the solution of the renewal equation and of
    /// the polynomials that F is told by.
    pub fn error_estimate(&self) -> f64 {
        self.leg.error * self.leg.reborn.mean()
    }
}

/// The value at a position inside the pull, from the right where it jumps.
fn at(curve: &Piecewise, position: f64) -> f64 {
    curve.value_in(curve.nearest(position), position)
}

/// Eight parts of [low, high].
fn windows(low: f64, high: f64) -> impl Iterator<Item = (f64, f64)> {
    let edge = move |k: u32| low + (high - low) * f64::from(k) / 8.0;
    (0..8).map(move |k| (edge(k), edge(k + 1)))
}
