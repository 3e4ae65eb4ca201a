//! One leg of motion: what breaks and what is carried on it, from the lives of its first contacts and of the re-formed.

use std::sync::Arc;

use super::Tolerance;
use crate::life::{Births, Layer, Life, ORDERS};
use crate::monitor::{Aside, Monitor, Rising};
use crate::numerics::breakpoints::{Atom, Breakpoint};
use crate::numerics::legendre::NODES;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::{Accuracy, Kernel, Solution, solve};
use crate::{Error, Result};

/// The solution of the renewal equation for monotone motion, as functions of the advance u of the slider.
///
/// Γ(u) = φ₀(u) + ∫₀^u Γ(v) φ(u − v) dv, with φ₀ the breaking density of the contacts that are there at u = 0 and φ that
/// of those that re-form. What contacts carry follows by the same convolution: F(u) = m₀(u) + ∫₀^u Γ(v) m(u − v) dv.
#[derive(Debug, Clone)]
pub(super) struct RenewalSolution {
    pub(super) first: Arc<Life>,
    pub(super) reborn: Arc<Life>,
    pub(super) solution: Solution,
    /// F and its slope, per unit stiffness.
    pub(super) force: Piecewise,
    pub(super) slope: Piecewise,
    /// Estimated error of F/(N_c⟨k⟩), per mean life.
    pub(super) error: f64,
}

impl RenewalSolution {
    /// Solves on [0, end], F/(N_c⟨k⟩) to `tolerance` × the mean life.
    ///
    /// # Errors
    /// Stopped by the monitor; too many point masses; a tolerance that was required and is not reached.
    pub(super) fn solve(
        first: &Arc<Life>,
        reborn: &Arc<Life>,
        end: f64,
        tolerance: Tolerance,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let mut rising = Rising::new(monitor);
        let monitor: &mut dyn Monitor = &mut rising;
        // What lives are off by is not solved for.
        let known = first.error().max(reborn.error());
        let value = tolerance.value().max(known);
        let leg = match (Self::refined(first, reborn, end, value, monitor), tolerance.coarser()) {
            (Err(Error::Accuracy { .. }), Some(coarser)) => {
                return Self::solve(first, reborn, end, coarser, monitor);
            }
            (solved, _) => solved?,
        };
        tolerance.allows(leg.error, || format!("the force on a pull by {end}"))?;
        Ok(leg)
    }

    /// The solution with cells of the usual width, or, where something narrow was stepped over, with cells that begin as fine
    /// as the finest part of the life.
    fn refined(
        first: &Arc<Life>,
        reborn: &Arc<Life>,
        end: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let usual = Self::with_cells(first, reborn, end, (tolerance, 0.1), monitor)?;
        if usual.error <= tolerance.max(2.0 * usual.of_lives()) {
            return Ok(usual);
        }
        let fine = Self::with_cells(first, reborn, end, (tolerance, 1e-4), monitor)?;
        Ok(if fine.error < usual.error { fine } else { usual })
    }

    /// The solution, with cells that begin as narrow as those that hold the fraction `narrow_fraction` of what breaks.
    fn with_cells(
        first: &Arc<Life>,
        reborn: &Arc<Life>,
        end: f64,
        (tolerance, narrow_fraction): (f64, f64),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        // Lives are resolved to about 1e-13 per mean life; what a cell leaves out grows as its width to the 16th power.
        let accuracy = Accuracy {
            density: 0.3 * tolerance / reborn.mean(),
            mass: 3e-3 * tolerance,
            conservation: tolerance,
            convolved: 0.3 * tolerance * unit_force(reborn),
            initial_width: (tolerance / 1e-13).powf(1.0 / 16.0),
            narrow_fraction,
        };
        let kept = (first.survival().curve(), reborn.survival());
        let onsets = [first.reattachment(), reborn.reattachment()];
        let onsets = [onsets[0].as_slice(), onsets[1].as_slice()];
        let solution = solve(first.breaking(), reborn.breaking(), kept, onsets, end, accuracy, monitor)
            .map_err(|error| error.under("contacts.thresholds"))?;
        let force = solution.convolve(
            first.force().curve(),
            reborn.force(),
            &mut Aside { fraction: 1.0, monitor },
        )?;
        let slope = slope(&force, reborn);
        let mut leg =
            Self { first: first.clone(), reborn: reborn.clone(), solution, force, slope, error: 0.0 };
        leg.error = leg.estimated_error();
        Ok(leg)
    }

    /// The error budget, of F/(N_c⟨k⟩) per mean life: that of the lives, and the larger of what ∫Q is off by and of what the
    /// polynomials of F are off by, as two quadratures tell which share nothing with the solution but Γ.
    fn estimated_error(&self) -> f64 {
        let (mut lost, mut apart) = (0.0_f64, 0.0_f64);
        for (cell, x) in self.places() {
            lost = lost.max((self.sum_at(Life::survival, x) - 1.0).abs());
            apart = apart.max((self.sum_at(Life::force, x) - self.force.value_in(cell, x)).abs());
        }
        self.of_lives() + lost.max(apart / unit_force(&self.reborn))
    }

    /// What the lives themselves are off by.
    fn of_lives(&self) -> f64 {
        self.first.error().max(self.reborn.error())
    }

    /// What all contacts together have of a curve of their lives.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn sum(&self, curve: fn(&Life) -> &Kernel, monitor: &mut dyn Monitor) -> Result<Piecewise> {
        let first = curve(&self.first).curve();
        self.solution.convolve(first, curve(&self.reborn), monitor)
    }

    /// The same at one advance, by a quadrature that shares nothing with the solution but Γ; after the break where
    /// contacts break together there.
    pub(super) fn sum_at(&self, curve: fn(&Life) -> &Kernel, advance: f64) -> f64 {
        let start = self.force.boundaries[self.force.nearest(advance)];
        let past = if advance < start * (1.0 + 1e-11) { start * (1.0 + 2e-11) } else { advance };
        self.solution.convolve_at(curve(&self.first).curve(), curve(&self.reborn), past)
    }

    /// Points spread over the leg, with their cells: halfway between the middle of a cell, where a polynomial is at its best,
    /// and its end; atoms lie on boundaries. Of the last cell the end, too.
    fn places(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let end = self.force.end();
        let spread = (1..=16).map(move |k| end * (f64::from(k) * GOLDEN).fract()).chain([end]);
        let inside = spread.map(|x| {
            let cell = self.force.nearest(x);
            let (middle, half) = self.force.cell(cell);
            (cell, middle + 0.5 * half)
        });
        inside.chain([(self.force.nearest(end), end * (1.0 - 1e-12))])
    }

    /// The contacts born up to the advance `u` in the given cell, and still there.
    pub(super) fn born(&self, u: f64, cell: usize) -> Layer {
        let rate = &self.solution.density;
        // What was born a life ago may just be about to break.
        let past = (u - self.reborn.survival().curve().end() * (1.0 + 1e-12)).max(0.0);
        let done = self.force.boundaries[cell] * (1.0 + 1e-12);
        let atoms = self.solution.atoms.iter().filter(|a| a.position >= past && a.position <= done);
        let atoms = atoms.map(|a| Atom { position: (u - a.position).max(0.0), ..*a }).collect();
        let breakpoints = self.solution.breakpoints.iter().filter(|b| b.position >= past && b.position < u);
        let mut breakpoints: Vec<_> =
            breakpoints.map(|b| Breakpoint { position: u - b.position, ..b.mirrored() }).collect();
        let end: [f64; ORDERS] = rate.jet_in(cell, u);
        breakpoints.extend((0_i32..).zip(end).map(|(order, derivative)| Breakpoint {
            position: 0.0,
            exponent: f64::from(order),
            amplitude: (-1.0_f64).powi(order) * derivative,
        }));
        let rate = rate.part(past, u).mirrored().shifted(u);
        self.reborn.born(&Births { rate, atoms, breakpoints })
    }
}

/// What slopes of forces are told over, of a mean life: over less, they are lost in the rounding of the force.
const CHORD: f64 = 1e-6;

/// The force of contacts stretched by their mean life, per unit stiffness.
pub(super) fn unit_force(life: &Life) -> f64 {
    life.mean() * life.stiffness()
}

/// The slope of a force on its own cells, of contacts with this life.
///
/// Cells beside a singularity double in width from next to nothing. The derivative of a polynomial on one of them is little
/// but the rounding of the force over its width: those that lie within [`CHORD`] together, with no jump between them, have
/// the slope of their chord.
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
