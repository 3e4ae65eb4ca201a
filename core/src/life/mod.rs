//! The life of a contact: what becomes of it as the slider advances by u after it was formed.
//!
//! Everything that friction does follows from these curves, whatever the contacts are made of.

mod athermal;
mod births;
mod continuation;

pub use athermal::athermal;
pub(crate) use continuation::Continuation;

use crate::law::{Atom, SharedLaw};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// The life of contacts that start together, as curves of the advance u, per contact started and per unit stiffness
/// (⟨k⟩, or κ where k = κ x_s).
///
/// With ν the law of starting stretches over their survival, ν = R/S (ν = Q_ini where stretches and
/// thresholds are independent), and M_n(x) = ∫_x^∞ ξⁿ P_c dξ:
///
/// | curve | equation | k = κ x_s |
/// |---|---|---|
/// | survival | ∫ν(r) S(r+u) dr | the same |
/// | breaking density | ∫ν(r) P_c(r+u) dr | the same |
/// | carried force | ∫ν(r) x S(x) dr, x = r+u | ∫ν(r) x M₁(x) dr |
/// | its square | ∫ν(r) x² S(x) dr | ∫ν(r) x² M₂(x) dr |
#[derive(Debug, Clone)]
pub struct Life {
    survival: Kernel,
    breaking: Kernel,
    force: Kernel,
    square: Kernel,
    /// ν: its density and its atoms.
    births: Piecewise,
    birth_atoms: Vec<Atom>,
    thresholds: SharedLaw,
}

impl Life {
    /// The fraction that is unbroken.
    pub fn survival(&self) -> &Kernel {
        &self.survival
    }

    /// The fraction that breaks per unit advance, and the atoms where fractions break together.
    pub fn breaking(&self) -> &Kernel {
        &self.breaking
    }

    /// The mean force of a contact, broken ones counted as 0; a length (a length squared where k = κ x_s).
    pub fn force(&self) -> &Kernel {
        &self.force
    }

    /// The mean square of a contact's force.
    pub fn square(&self) -> &Kernel {
        &self.square
    }

    /// The mean advance that a contact survives.
    pub fn mean(&self) -> f64 {
        self.survival.curve().integral()
    }

    /// Density at stretch x of contacts that started u ago, per contact started; atoms not counted.
    pub fn stretch_density(&self, x: f64, u: f64) -> f64 {
        self.births.value(x - u).max(0.0) * self.thresholds.survival(x)
    }

    /// Stretches of the contacts that started u ago at point masses, with the fraction still there.
    pub fn stretch_atoms(&self, u: f64) -> impl Iterator<Item = Atom> + '_ {
        self.birth_atoms.iter().map(move |birth| {
            let position = birth.position + u;
            Atom { position, weight: birth.weight * self.thresholds.survival(position) }
        })
    }

    /// Σ over births of rate(r): the density at stretch x of contacts born at stretches r at the given rates is this
    /// times S(x). `cuts` are stretches r at which the rate is not smooth.
    fn born(&self, x: f64, rate: impl Fn(f64) -> f64, cuts: impl Iterator<Item = f64>) -> f64 {
        let atoms = self.birth_atoms.iter().filter(|birth| birth.position <= x);
        let together: f64 = atoms.map(|birth| birth.weight * rate(birth.position)).sum();
        let (low, high) = (0.0, x.min(self.births.end()));
        if high <= low {
            return together;
        }
        let mut edges: Vec<f64> = self.births.boundaries.iter().copied().chain(cuts).collect();
        edges.retain(|&r| r > low && r < high);
        edges.extend([low, high]);
        edges.sort_by(f64::total_cmp);
        let integrand = |r: f64| self.births.value(r).max(0.0) * rate(r);
        let rule = &crate::numerics::legendre::RULE;
        together + edges.windows(2).map(|pair| rule.integrate(pair[0], pair[1], integrand)).sum::<f64>()
    }

    /// Density at stretch x of contacts that have been born at the rate `rate(advance)` per contact, the advance
    /// counted back from now; `cuts` are advances at which that rate is not smooth.
    pub fn standing_density(
        &self,
        x: f64,
        rate: impl Fn(f64) -> f64,
        cuts: impl Iterator<Item = f64>,
    ) -> f64 {
        let survival = self.thresholds.survival(x);
        if survival == 0.0 {
            return 0.0;
        }
        survival * self.born(x, |r| rate(x - r), cuts.map(|u| x - u))
    }
}
