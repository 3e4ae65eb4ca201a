//! One leg of motion: what breaks and what is carried on it, from the lives of its first contacts and of the re-formed.

use std::sync::Arc;

use crate::life::{Births, Layer, Life, ORDERS};
use crate::monitor::{Aside, Monitor};
use crate::numerics::breaks::{Atom, Break};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::{Accuracy, Kernel, Solution, solve};
use crate::{Error, Float, Result};

/// The solution of the renewal equation for monotone motion, as functions of the advance u of the slider.
///
/// Γ(u) = φ₀(u) + ∫₀^u Γ(v) φ(u − v) dv, with φ₀ the breaking density of the contacts that are there at u = 0 and φ that
/// of those that re-form. What contacts carry follows by the same convolution: F(u) = m₀(u) + ∫₀^u Γ(v) m(u − v) dv.
#[derive(Debug, Clone)]
pub(super) struct Leg {
    pub(super) first: Arc<Life>,
    pub(super) reborn: Arc<Life>,
    pub(super) solution: Solution,
    /// F and its slope, per unit stiffness.
    pub(super) force: Piecewise,
    pub(super) slope: Piecewise,
}

impl Leg {
    /// Solves on [0, end], F/(N_c⟨k⟩) to about `tolerance` × the mean life.
    ///
    /// # Errors
    /// Stopped by the monitor; too many point masses; accuracy not reached.
    pub(super) fn solve(
        first: &Arc<Life>,
        reborn: &Arc<Life>,
        end: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let leg = Self::with_cells(first, reborn, end, (tolerance, 0.1), monitor)?;
        if leg.lost_probability() <= tolerance {
            return Ok(leg);
        }
        // Something narrow was stepped over: begin with cells as fine as the finest part of the life.
        let leg = Self::with_cells(first, reborn, end, (tolerance, 1e-4), monitor)?;
        let reached = leg.lost_probability();
        if reached <= tolerance {
            return Ok(leg);
        }
        let what = format!("the probability of all stretches on a pull by {end}");
        Err(Error::Accuracy { what, reached: Float(reached), wanted: Float(tolerance) })
    }

    /// The solution, with cells that begin as narrow as those that hold the fraction `light` of what breaks.
    fn with_cells(
        first: &Arc<Life>,
        reborn: &Arc<Life>,
        end: f64,
        (tolerance, light): (f64, f64),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        // Lives are resolved to about 1e-13 per mean life; what a cell leaves out grows as its width to the 16th power.
        let accuracy = Accuracy {
            density: 0.3 * tolerance / reborn.mean(),
            mass: 3e-3 * tolerance,
            kept: tolerance,
            carried: 0.3 * tolerance * reborn.mean(),
            widening: (tolerance / 1e-13).powf(1.0 / 16.0),
            light,
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
        let slope = force.derivative();
        Ok(Self { first: first.clone(), reborn: reborn.clone(), solution, force, slope })
    }

    /// What all contacts together have of a curve of their lives.
    pub(super) fn sum(&self, curve: fn(&Life) -> &Kernel) -> Piecewise {
        let first = curve(&self.first).curve();
        self.solution.convolve(first, curve(&self.reborn), &mut ()).unwrap_or_default()
    }

    /// The same at one advance, by a quadrature that shares nothing with the solution but Γ; after the break where
    /// contacts break together there.
    pub(super) fn sum_at(&self, curve: fn(&Life) -> &Kernel, advance: f64) -> f64 {
        let start = self.force.boundaries[self.force.nearest(advance)];
        let past = if advance < start * (1.0 + 1e-11) { start * (1.0 + 2e-11) } else { advance };
        self.solution.convolve_at(curve(&self.first).curve(), curve(&self.reborn), past)
    }

    /// The largest |∫Q − 1| at points spread over the leg.
    pub(super) fn lost_probability(&self) -> f64 {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let end = self.force.end();
        let spread = (1..=16).map(|k| end * (f64::from(k) * GOLDEN).fract()).chain([end]);
        // In the middle of cells: atoms lie on their boundaries.
        let points = spread.map(|x| self.force.cell(self.force.nearest(x)).0);
        points.map(|x| (self.sum_at(Life::survival, x) - 1.0).abs()).fold(0.0, f64::max)
    }

    /// The contacts born up to the advance `u` in the given cell, and still there.
    pub(super) fn born(&self, u: f64, cell: usize) -> Layer {
        let rate = &self.solution.density;
        // What was born a life ago may just be about to break.
        let past = (u - self.reborn.survival().curve().end() * (1.0 + 1e-12)).max(0.0);
        let done = self.force.boundaries[cell] * (1.0 + 1e-12);
        let atoms = self.solution.atoms.iter().filter(|a| a.position >= past && a.position <= done);
        let atoms = atoms.map(|a| Atom { position: (u - a.position).max(0.0), ..*a }).collect();
        let breaks = self.solution.breaks.iter().filter(|b| b.position >= past && b.position < u);
        let mut breaks: Vec<_> = breaks.map(|b| Break { position: u - b.position, ..b.mirrored() }).collect();
        let end: [f64; ORDERS] = rate.jet_in(cell, u);
        breaks.extend((0_i32..).zip(end).map(|(order, derivative)| Break {
            position: 0.0,
            exponent: f64::from(order),
            amplitude: (-1.0_f64).powi(order) * derivative,
        }));
        let rate = rate.part(past, u).mirrored().shifted(u);
        self.reborn.born(&Births { rate, atoms, breaks })
    }
}
