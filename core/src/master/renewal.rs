//! The renewal equation for motion in one direction: breaking rate and carried force from the lives of
//! initial and re-formed contacts.

use std::sync::Arc;

use super::Tolerance;
use crate::life::{Births, Layer, Life, ORDERS};
use crate::monitor::{Aside, Monitor, Rising};
use crate::numerics::breakpoints::{Atom, Breakpoint};
use crate::numerics::legendre::NODES;
use crate::numerics::order::{largest, sort_by_number};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::{Accuracy, Kernel, Solution, solve};
use crate::{Error, Result};

/// The solution of the renewal equation for monotonic motion, as functions of the advance u of the slider.
///
/// Γ(u) = φ₀(u) + ∫₀^u Γ(v) φ(u − v) dv, with φ₀ the breaking density of the contacts at u = 0 and φ that of
/// re-formed ones. The force follows by the same convolution: F(u) = m₀(u) + ∫₀^u Γ(v) m(u − v) dv.
#[derive(Debug, Clone)]
pub(super) struct RenewalSolution {
    pub(super) first: Arc<Life>,
    pub(super) reformed: Arc<Life>,
    pub(super) solution: Solution,
    /// F and its slope, per unit stiffness.
    pub(super) force: Piecewise,
    pub(super) slope: Piecewise,
    /// Estimated error of F/(N_c⟨k⟩), per mean life.
    pub(super) error: f64,
}

impl RenewalSolution {
    /// Solves on [0, end], with F/(N_c⟨k⟩) accurate to `tolerance` × the mean life.
    ///
    /// # Errors
    /// Stopped by the monitor; too many point masses; a required tolerance that is not reached.
    pub(super) fn solve(
        first: &Arc<Life>,
        reformed: &Arc<Life>,
        end: f64,
        tolerance: Tolerance,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let mut rising = Rising::new(monitor);
        let monitor: &mut dyn Monitor = &mut rising;
        // The solution need not be more accurate than the lives.
        let known = first.error().max(reformed.error());
        let value = tolerance.value().max(known);
        let renewal = match (Self::refined(first, reformed, end, value, monitor), tolerance.coarser()) {
            (Err(Error::Accuracy { .. }), Some(coarser)) => {
                return Self::solve(first, reformed, end, coarser, monitor);
            }
            (solved, _) => solved?,
        };
        tolerance.allows(renewal.error, || format!("the force on a pull by {end}"))?;
        Ok(renewal)
    }

    /// The solution with cells of the usual initial width or, if a narrow feature was stepped over, with
    /// initial cells as narrow as the finest part of the life.
    fn refined(
        first: &Arc<Life>,
        reformed: &Arc<Life>,
        end: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let usual = Self::with_cells(first, reformed, end, (tolerance, 0.1), monitor)?;
        if usual.error <= tolerance.max(2.0 * usual.of_lives()) {
            return Ok(usual);
        }
        let fine = Self::with_cells(first, reformed, end, (tolerance, 1e-4), monitor)?;
        Ok(if fine.error < usual.error { fine } else { usual })
    }

    /// The solution whose initial cells are as narrow as those that hold the fraction `narrow_fraction` of
    /// the breaking density.
    fn with_cells(
        first: &Arc<Life>,
        reformed: &Arc<Life>,
        end: f64,
        (tolerance, narrow_fraction): (f64, f64),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        // Lives are accurate to about 1e-13 per mean life; the truncation error of a cell grows as the 16th
        // power of its width.
        let accuracy = Accuracy {
            density: 0.3 * tolerance / reformed.mean(),
            mass: 3e-3 * tolerance,
            conservation: tolerance,
            // Contacts carry a force while they hold, however long they are free before.
            convolved: 0.3 * tolerance * reformed.mean_held() * reformed.stiffness(),
            initial_width: (tolerance / 1e-13).powf(1.0 / 16.0),
            narrow_fraction,
        };
        let kept = (first.survival().curve(), reformed.survival());
        let onsets = [first, reformed].map(|life| [life.reattachment(), life.kinks_of_stiffness()].concat());
        let onsets = [onsets[0].as_slice(), onsets[1].as_slice()];
        let solution = solve(first.breaking(), reformed.breaking(), kept, onsets, end, accuracy, monitor)
            .map_err(|error| error.under("thresholds"))?;
        let force = solution.convolve(
            first.force().curve(),
            reformed.force(),
            &mut Aside { fraction: 1.0, monitor },
        )?;
        let slope = slope(&force, reformed);
        // The error is measured on the result, not inferred from the tolerances.
        let mut renewal =
            Self { first: first.clone(), reformed: reformed.clone(), solution, force, slope, error: 0.0 };
        renewal.error = renewal.estimated_error();
        Ok(renewal)
    }

    /// The error of F/(N_c⟨k⟩) per mean life: that of the lives, plus the larger of the error of ∫Q and that
    /// of the polynomials of F, measured by two quadratures that share only Γ with the solution.
    fn estimated_error(&self) -> f64 {
        let lost = |(_, x)| (self.sum_at(Life::survival, x) - 1.0).abs();
        let off = |(cell, x)| (self.sum_at(Life::force, x) - self.force.value_in(cell, x)).abs();
        let probability_error = largest(self.spread().map(lost));
        // A spread misses narrow cells. Beside a pole these hold mass somewhere within them, which no force feels.
        let force_error = largest(self.spread().chain(self.narrowest()).map(off));
        self.of_lives() + probability_error.max(force_error / unit_force(&self.reformed))
    }

    /// The error of the lives.
    fn of_lives(&self) -> f64 {
        self.first.error().max(self.reformed.error())
    }

    /// Sum over all contacts of a curve of their lives.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn sum(&self, curve: fn(&Life) -> &Kernel, monitor: &mut dyn Monitor) -> Result<Piecewise> {
        let first = curve(&self.first).curve();
        self.solution.convolve(first, curve(&self.reformed), monitor)
    }

    /// The same at one advance, by a quadrature that shares only Γ with the solution; after simultaneous
    /// breaks there.
    pub(super) fn sum_at(&self, curve: fn(&Life) -> &Kernel, advance: f64) -> f64 {
        let start = self.force.boundaries[self.force.nearest(advance)];
        let past = if advance < start * (1.0 + 1e-11) { start * (1.0 + 2e-11) } else { advance };
        self.solution.convolve_at(curve(&self.first).curve(), curve(&self.reformed), past)
    }

    /// Test points with their cells, spread over the interval, and the end of the last cell.
    fn spread(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let end = self.force.end();
        // Multiples of the golden ratio are spread evenly over the interval, and meet no period of
        // the solution.
        let places = (1..=16).map(move |k| end * (f64::from(k) * GOLDEN).fract()).chain([end]);
        let inside = places.map(|x| self.test_point(self.force.nearest(x)));
        inside.chain([(self.force.nearest(end), end * (1.0 - 1e-12))])
    }

    /// Test points of the four narrowest cells whose positions keep their digits.
    fn narrowest(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        const CLEAR: f64 = 1e-9;
        let edges = &self.force.boundaries;
        let width = |cell: usize| edges[cell + 1] - edges[cell];
        let mut cells: Vec<usize> =
            (0..edges.len() - 1).filter(|&cell| width(cell) > CLEAR * edges[cell]).collect();
        sort_by_number(&mut cells, |&a| width(a));
        cells.into_iter().take(4).map(|cell| self.test_point(cell))
    }

    /// Halfway between the middle of a cell, where a polynomial is most accurate, and its end, where point
    /// masses may lie.
    fn test_point(&self, cell: usize) -> (usize, f64) {
        let (middle, half) = self.force.cell(cell);
        (cell, middle + 0.5 * half)
    }

    /// The contacts that formed up to the advance `u`, in the given cell, and may still exist.
    pub(super) fn born(&self, u: f64, cell: usize) -> Layer {
        let rate = &self.solution.density;
        // Contacts formed one life ago may just be about to break.
        let past = (u - self.reformed.survival().curve().end() * (1.0 + 1e-12)).max(0.0);
        let done = self.force.boundaries[cell] * (1.0 + 1e-12);
        let atoms = self.solution.atoms.iter().filter(|a| a.position >= past && a.position <= done);
        let atoms = atoms.map(|a| Atom { position: (u - a.position).max(0.0), ..*a }).collect();
        let breakpoints = self.solution.breakpoints.iter().filter(|b| b.position >= past && b.position < u);
        let mut breakpoints: Vec<_> =
            breakpoints.map(|b| Breakpoint { position: u - b.position, ..b.mirrored() }).collect();
        let end: [f64; ORDERS] = rate.jet_in(cell, u);
        // The density of ages begins at age 0 with the present rate: value and derivatives of Γ
        // there are jumps of this density and of its derivatives.
        breakpoints.extend((0_i32..).zip(end).map(|(order, derivative)| Breakpoint {
            position: 0.0,
            exponent: f64::from(order),
            amplitude: (-1.0_f64).powi(order) * derivative,
        }));
        let rate = rate.part(past, u).mirrored().shifted(u);
        self.reformed.born(&Births { rate, atoms, breakpoints })
    }
}

/// Length, in mean lives, over which slopes of forces are measured at least: over less, they are lost in the
/// rounding of the force.
const CHORD: f64 = 1e-6;

/// The force of contacts stretched by their mean life, per unit stiffness.
pub(super) fn unit_force(life: &Life) -> f64 {
    life.mean() * life.stiffness()
}

/// The slope of a force on its own cells, for contacts with this life.
///
/// Cells beside a singularity double in width starting from almost nothing. The derivative of a polynomial on
/// such a cell is little more than the rounding of the force divided by its width: cells that together span
/// less than [`CHORD`], with no jump between them, get the slope of their chord.
pub(super) fn slope(force: &Piecewise, life: &Life) -> Piecewise {
    let (edges, count, beside) = (&force.boundaries, force.coefficients.len(), CHORD * life.mean());
    let least = 1e-12 * unit_force(life);
    let jumps = |cell: usize| {
        let [before, after] = [cell - 1, cell].map(|cell_of| force.value_in(cell_of, edges[cell]));
        (after - before).abs() > least
    };
    let mut slope = force.derivative();
    let mut first = 0;
    while first < count {
        let near = |&next: &usize| edges[next + 1] - edges[first] < beside && !jumps(next);
        let next = first + 1 + (first + 1..count).take_while(near).count();
        if edges[next] - edges[first] < beside {
            let rise = force.value_in(next - 1, edges[next]) - force.value_in(first, edges[first]);
            let mut chord = [0.0; NODES];
            chord[0] = rise / (edges[next] - edges[first]);
            slope.coefficients[first..next].fill(chord);
        }
        first = next;
    }
    slope
}
