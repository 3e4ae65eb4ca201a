//! A pull of the slider from X = 0: force, breaking rate and distribution of stretches at any X.

use std::sync::OnceLock;

use super::renewal::{RenewalSolution, unit_force};
use super::{Extremum, MasterEquation, SteadyState, Stretches, Tolerance};
use crate::Result;
use crate::law::Atom;
use crate::life::Life;
use crate::monitor::Monitor;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::roots::{brent_minimum, brent_root};

/// Forces and slopes differ if they differ by this many tolerances, or errors if these are larger.
const SLACK: f64 = 10.0;

/// The solution of a pull, as functions of X in `[0, distance]`.
///
/// Γ solves the renewal equation Γ(X) = φ₀(X) + ∫₀^X Γ(Y) φ(X − Y) dY; then F(X) = F₀(X) + ∫₀^X Γ(Y) m(X − Y)
/// dY. φ and m are the breaking density and carried force of re-formed contacts, φ₀ and F₀ those of the
/// initial ones. Forces are totals, N_c⟨k⟩ included.
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// # use asperity::master::MasterEquation;
/// let pull = MasterEquation::new(contacts, &Initial::default())?.pull(20.0)?;
/// // Contacts that start relaxed are stretched together at first.
/// assert!((pull.force(0.3) - 0.3).abs() < 1e-9);
/// let peak = pull.static_friction().expect("the force has a maximum");
/// assert!(peak.value > pull.force(20.0) && pull.critical_stiffness() > 0.0);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Pull {
    pub(super) equation: MasterEquation,
    pub(super) renewal: RenewalSolution,
    distance: f64,
    pub(super) tolerance: Tolerance,
    /// N_c⟨k⟩ or N_c κ.
    pub(super) stiffness: f64,
    square: OnceLock<Piecewise>,
}

impl Pull {
    pub(super) fn new(
        equation: MasterEquation,
        renewal: RenewalSolution,
        distance: f64,
        tolerance: Tolerance,
    ) -> Self {
        let stiffness = equation.stiffness();
        Self { equation, renewal, distance, tolerance, stiffness, square: OnceLock::new() }
    }

    /// The requested distance; the solution may extend further.
    pub fn distance(&self) -> f64 {
        self.distance
    }

    /// Number of cells of the solution.
    pub fn cells(&self) -> usize {
        self.renewal.force.coefficients.len()
    }

    /// F(X), after the break if contacts break simultaneously at X; NaN before 0 and where the solution has ended.
    pub fn force(&self, position: f64) -> f64 {
        if position == 0.0 && self.renewal.first.starts_unstretched() {
            return 0.0;
        }
        self.stiffness * self.if_solved(position, at(&self.renewal.force, position))
    }

    /// F'(X), from the right; NaN before 0 and where the solution has ended.
    pub fn slope(&self, position: f64) -> f64 {
        self.stiffness * self.if_solved(position, at(&self.renewal.slope, position))
    }

    /// Density part of Γ(X), the fraction of contacts that break per unit length; NaN before 0 and where the solution has ended.
    pub fn breaking_rate(&self, position: f64) -> f64 {
        self.if_solved(position, self.renewal.breaking_rate(position))
    }

    /// The value of a curve at a position; NaN before 0 and where the solution has ended.
    fn if_solved(&self, position: f64, value: f64) -> f64 {
        /// Of the length of the solution: what rounding adds to positions.
        const ROUNDING: f64 = 1e-9;
        let end = self.renewal.force.end();
        if (-ROUNDING * end..=(1.0 + ROUNDING) * end).contains(&position) { value } else { f64::NAN }
    }

    /// Point masses of Γ: positions at which a finite fraction of the contacts breaks simultaneously.
    pub fn breaking_atoms(&self) -> &[Atom] {
        let within =
            self.renewal.solution.atoms.partition_point(|a| a.position <= self.distance * (1.0 + 1e-12));
        &self.renewal.solution.atoms[..within]
    }

    /// Standard deviation of the force as a function of X for `size` contacts drawn at random, scaled to N_c.
    /// Contacts are independent under a rigid drive, so that it is exactly N_c⟨k⟩ √([∫x²Q − (∫xQ)²]/size).
    /// The curve of ∫x²Q is computed once.
    ///
    /// # Errors
    /// None: only a monitor can stop it.
    pub fn force_std<'a>(&'a self, size: f64) -> Result<impl Fn(f64) -> f64 + Send + Sync + use<'a>> {
        self.force_std_with(size, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::force_std`]; stopped by the monitor.
    pub fn force_std_with<'a>(
        &'a self,
        size: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<impl Fn(f64) -> f64 + Send + Sync + use<'a>> {
        let square = self.square(monitor)?;
        Ok(move |position: f64| {
            let mean = at(&self.renewal.force, position);
            self.stiffness * ((at(square, position) - mean * mean).max(0.0) / size).sqrt()
        })
    }

    /// ∫x²Q dx as a function of X, computed once.
    pub(super) fn square(&self, monitor: &mut dyn Monitor) -> Result<&Piecewise> {
        if let Some(known) = self.square.get() {
            return Ok(known);
        }
        let square = self.renewal.sum(Life::square, monitor)?;
        Ok(self.square.get_or_init(|| square))
    }

    /// ∫Q(x; X) dx, after simultaneous breaks at X, by a quadrature that shares only Γ with the solution of
    /// the renewal equation: 1.
    pub fn total_probability(&self, position: f64) -> f64 {
        self.renewal.sum_at(Life::survival, position)
    }

    /// Q(x; X) at the given stretches, per length, and its point masses.
    ///
    /// # Errors
    /// None: only a monitor can stop it.
    pub fn stretch_density(&self, position: f64, stretches: &[f64]) -> Result<Stretches> {
        self.stretch_density_with(position, stretches, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::stretch_density`]; stopped by the monitor.
    pub fn stretch_density_with(
        &self,
        position: f64,
        stretches: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Stretches> {
        self.renewal.stretch_density(position, stretches, monitor)
    }

    /// F_s and X_s: the maximum of F on [0, distance) and its position, at a jump the left limit; the first
    /// of equal maxima, X_s = 0 if F falls from the start and does not reach F(0) again. `None` if F, to within the
    /// tolerance, does not fall after it, or ends higher.
    pub fn static_friction(&self) -> Option<Extremum> {
        self.peak().map(|(peak, _)| peak)
    }

    /// The maximum of F, with the cell that it lies in or ends.
    pub(super) fn peak(&self) -> Option<(Extremum, usize)> {
        let slack = self.slack() * unit_force(&self.renewal.reformed);
        let cells = 0..=self.last_cell();
        let mut best = (0.0, self.renewal.force.value_in(0, 0.0), 0);
        for cell in cells.clone() {
            for (position, value) in self.peaks(cell) {
                // Later maxima count only if they are higher by more than the error: of equal ones
                // the first is returned.
                if value > best.1 + slack {
                    best = (position, value, cell);
                }
            }
        }
        let (position, value, cell) = best;
        let ends = |later: usize| {
            let edges = &self.renewal.force.boundaries;
            let from = if later == cell { position } else { edges[later] };
            [from, edges[later + 1].min(self.distance)].map(|x| self.renewal.force.value_in(later, x))
        };
        let fallen = cells.skip(cell).any(|later| ends(later).into_iter().any(|force| force < value - slack));
        let peak = Extremum { position, value: self.stiffness * value };
        (fallen && position < self.distance).then_some((peak, cell))
    }

    fn last_cell(&self) -> usize {
        let edges = &self.renewal.force.boundaries;
        edges.partition_point(|&b| b < self.distance * (1.0 - 1e-12)).saturating_sub(1).min(edges.len() - 2)
    }

    /// Local maxima of F in a cell: inside, and at its upper end.
    fn peaks(&self, cell: usize) -> Vec<(f64, f64)> {
        let (low, high) =
            (self.renewal.force.boundaries[cell], self.renewal.force.boundaries[cell + 1].min(self.distance));
        let slope = |x: f64| self.renewal.slope.value_in(cell, x);
        // A cell resolves the force by a polynomial of degree 15: two extrema in an eighth of it
        // are not expected.
        let inside = windows(low, high).filter(|&(a, b)| slope(a) > 0.0 && slope(b) <= 0.0);
        let roots = inside.filter_map(|(a, b)| brent_root(slope, a, b, 1e-15 * high));
        roots.chain([high]).map(|x| (x, self.renewal.force.value_in(cell, x))).collect()
    }

    /// The difference above which forces per N_c⟨k⟩ and mean life, and slopes per N_c⟨k⟩, count as different.
    fn slack(&self) -> f64 {
        SLACK * self.tolerance.value().max(self.renewal.error)
    }

    /// K_c = max(0, −min F') over X ≥ 0. Infinite where the force jumps down; 0 where F does not fall by more
    /// than ten times the tolerance, or error if that is larger, of N_c⟨k⟩.
    pub fn critical_stiffness(&self) -> f64 {
        let jumps = self
            .renewal
            .solution
            .atoms
            .iter()
            .filter(|a| a.position > 0.0 && a.position < self.renewal.force.end());
        let falls = |a: &Atom| {
            let after = self.renewal.force.nearest(a.position);
            let before = self.renewal.force.value_in(after.saturating_sub(1), a.position);
            before - self.renewal.force.value_in(after, a.position)
                > 1e-12 * unit_force(&self.renewal.reformed)
        };
        if jumps.into_iter().any(falls) {
            return f64::INFINITY;
        }
        let (_, _, steepest) = self.steepest_fall();
        if -steepest > self.slack() * self.renewal.reformed.stiffness() {
            -self.stiffness * steepest
        } else {
            0.0
        }
    }

    /// The cell and the place where F falls most steeply, and its slope there per unit stiffness.
    pub(super) fn steepest_fall(&self) -> (usize, f64, f64) {
        let steepest = |cell: usize| {
            let (place, slope) = self.steepest(cell);
            (cell, place, slope)
        };
        let cells = (0..self.renewal.force.coefficients.len()).map(steepest);
        cells.fold((0, f64::NAN, f64::INFINITY), |least, next| if next.2 < least.2 { next } else { least })
    }

    /// The place and the value of the smallest slope in a cell, its ends included.
    fn steepest(&self, cell: usize) -> (f64, f64) {
        let (low, high) = (self.renewal.force.boundaries[cell], self.renewal.force.boundaries[cell + 1]);
        let slope = |x: f64| self.renewal.slope.value_in(cell, x);
        let (mut least, mut near) = ((low, slope(low)), (low, low + (high - low) / 8.0));
        for (a, b) in windows(low, high) {
            if slope(b) < least.1 {
                (least, near) = ((b, slope(b)), (a, (2.0 * b - a).min(high)));
            }
        }
        let inside = brent_minimum(slope, near.0, near.1, 1e-9 * (high - low));
        if inside.1 < least.1 { inside } else { least }
    }

    /// F and F' at a position in a cell.
    pub(super) fn force_in(&self, cell: usize, position: f64) -> f64 {
        self.stiffness * self.renewal.force.value_in(cell, position)
    }

    pub(super) fn slope_in(&self, cell: usize, position: f64) -> f64 {
        self.stiffness * self.renewal.slope.value_in(cell, position)
    }

    /// The cells of the pull in parts in which no two extrema of F' are expected, each with its cell.
    pub(super) fn parts_of_cells(&self) -> impl Iterator<Item = (usize, f64, f64)> {
        let edges = &self.renewal.force.boundaries;
        (0..=self.last_cell()).flat_map(move |cell| {
            windows(edges[cell], edges[cell + 1].min(self.distance)).map(move |(low, high)| (cell, low, high))
        })
    }

    /// Estimated error of F/(N_c⟨k⟩), a length: errors of the lives, of the solution of the renewal equation
    /// and of the polynomials.
    pub fn error_estimate(&self) -> f64 {
        self.renewal.error * self.renewal.reformed.mean()
    }

    /// Largest distance of F/(N_c⟨k⟩) from that of steady sliding, a length, at the ends and in the middle of each cell: the error
    /// of a pull that begins in steady sliding and should stay there.
    pub(crate) fn distance_from(&self, steady: &SteadyState) -> f64 {
        let friction = steady.kinetic_friction() / self.stiffness;
        let edges = &self.renewal.force.boundaries;
        let distance = |(cell, part): (usize, f64)| {
            let x = edges[cell] + part * (edges[cell + 1] - edges[cell]);
            (self.renewal.force.value_in(cell, x) - friction).abs()
        };
        let places = (0..self.cells()).flat_map(|cell| [0.0, 0.5, 1.0].map(|part| (cell, part)));
        places.map(distance).fold(0.0, f64::max)
    }
}

/// The value at a position inside the pull, from the right where it jumps.
pub(super) fn at(curve: &Piecewise, position: f64) -> f64 {
    curve.value_in(curve.nearest(position), position)
}

/// Eight equal parts of [low, high].
fn windows(low: f64, high: f64) -> impl Iterator<Item = (f64, f64)> {
    let edge = move |k: u32| low + (high - low) * f64::from(k) / 8.0;
    (0..8).map(move |k| (edge(k), edge(k + 1)))
}
