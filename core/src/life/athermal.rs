//! The life of contacts that know neither time nor temperature: they break when the stretch reaches the threshold.

use super::Life;
use super::births::{BULK, Births, MOMENTS};
use crate::contacts::{Contacts, Stiffness};
use crate::law::{Atom, Break, SharedLaw};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// The life of contacts that start at stretches drawn from `starts`.
///
/// With `conditional`, the threshold of a contact that starts at r is drawn from P_c given x_s > r (equation:
/// ν = R/S); otherwise stretch and threshold are independent, and the fraction ∫R(1 − S) breaks at u = 0.
///
/// Only the moments b_n(u) = ∫ν(r) (r+u)ⁿ P_c(r+u) dr of what breaks are computed by quadrature; what is carried
/// follows from what breaks later: with s the survival, m the force and q its square,
/// s' = −b₀, m' = s − b₁, q' = 2m − b₂. For k = κ x_s, one order of ξ more: see `per_threshold`.
///
/// Contacts and starts are taken to have passed [`Contacts::check`].
pub fn athermal(contacts: &Contacts, starts: &SharedLaw, conditional: bool) -> Life {
    let Contacts { thresholds, stiffness, .. } = contacts;
    let births = Births::new(contacts, starts, conditional, BULK);
    let breaks = births.breaks();
    let end = births.end();
    let edges = births.edges(&breaks, end);
    let moments = Piecewise::resolve_all(|u| births.breaking(u), &edges, end, BULK.resolution);
    let carried = Carried { births: &births, moments: &moments, end };
    let survival = carried.survival();
    let (force, square) = match *stiffness {
        Stiffness::Equal(_) => carried.equal(&survival),
        Stiffness::PerThreshold(_) => carried.per_threshold(),
    };
    let smoother: Vec<_> = breaks.iter().map(|&b| Break { exponent: b.exponent + 1.0, ..b }).collect();
    let kernel = |curve: Piecewise| Kernel::new(curve, smoother.clone());
    let (survival, force, square) = (kernel(survival), kernel(force), kernel(square));
    let [breaking, ..] = moments;
    let breaking = Kernel::new(breaking, breaks);
    let Births { density, atoms, .. } = births;
    Life {
        survival,
        breaking,
        force,
        square,
        births: density,
        birth_atoms: atoms,
        thresholds: thresholds.clone(),
    }
}

/// What is carried, from what breaks: integrals from the end of life back to u.
struct Carried<'a> {
    births: &'a Births<'a>,
    moments: &'a [Piecewise; MOMENTS],
    end: f64,
}

impl Carried<'_> {
    /// ∫_u^∞ of `falls`, with the jumps b_order at atoms and the value at the end.
    fn back(&self, falls: &Piecewise, order: i32, last: impl Fn(f64) -> f64) -> Piecewise {
        let jump = |(u, b): &(f64, Atom)| (*u, b.weight * b.position.powi(order));
        let jumps: Vec<_> = self.births.struck.iter().map(jump).collect();
        falls.integrated_from_end(self.births.mean(last, self.end), &jumps)
    }

    fn survival(&self) -> Piecewise {
        self.back(&self.moments[0], 0, |x| self.births.thresholds.survival(x))
    }

    /// Force and square: m' = s − b₁, q' = 2m − b₂.
    fn equal(&self, survival: &Piecewise) -> (Piecewise, Piecewise) {
        let law = self.births.thresholds;
        let force = self.back(&self.moments[1].plus(-1.0, survival), 1, |x| x * law.survival(x));
        let square = self.back(&self.moments[2].plus(-2.0, &force), 2, |x| x * x * law.survival(x));
        (force, square)
    }

    /// With t_n = ∫ν M_n and w = ∫ν x M₂: t_n' = −b_n, m' = t₁ − b₂, w' = t₂ − b₃, q' = 2w − b₄.
    fn per_threshold(&self) -> (Piecewise, Piecewise) {
        let law = self.births.thresholds;
        let first = self.back(&self.moments[1], 1, |x| law.upper_moment(1, x));
        let force = self.back(&self.moments[2].plus(-1.0, &first), 2, |x| x * law.upper_moment(1, x));
        let second = self.back(&self.moments[2], 2, |x| law.upper_moment(2, x));
        let half = self.back(&self.moments[3].plus(-1.0, &second), 3, |x| x * law.upper_moment(2, x));
        let square = self.back(&self.moments[4].plus(-2.0, &half), 4, |x| x * x * law.upper_moment(2, x));
        (force, square)
    }
}
