//! The life of a contact: what becomes of it as the slider advances by u after it was formed.
//!
//! Everything that friction does follows from these curves, whatever the contacts are made of.

mod athermal;
mod births;
mod breaking;
mod cells;
mod continuation;
mod layer;
mod panels;
mod stock;

pub use athermal::athermal;
pub(crate) use births::Births;
pub(crate) use cells::{ORDERS, walls};
pub(crate) use continuation::Continuation;
pub(crate) use layer::Layer;
use layer::Lump;
pub(crate) use stock::{Sums, life_of, strikes, tidied};

use crate::law::{Atom, SharedLaw};
use crate::numerics::volterra::Kernel;

/// The life of contacts that start together, as curves of the advance u, per contact started and per unit stiffness
/// (⟨k⟩, or κ where k = κ x_s).
///
/// With ν the law of starting stretches over their survival, ν = R/S (ν = Q_ini where stretches and
/// thresholds are independent), and M_n(x) = ∫_x^∞ ξⁿ P_c dξ:
///
/// | curve | equation | k = κ x_s |
/// |---|---|---|
/// | survival | ∫ν(r) S(x) dr, x = r+u | the same |
/// | breaking density | ∫ν(r) P_c(x) dr | the same |
/// | carried force | ∫ν(r) x S(x) dr | ∫ν(r) x M₁(x) dr |
/// | its square | ∫ν(r) x² S(x) dr | ∫ν(r) x² M₂(x) dr |
/// | elastic energy | ½∫ν(r) x² S(x) dr | ½∫ν(r) x² M₁(x) dr |
/// | breaking energy | ½∫ν(r) M₂(x) dr | ½∫ν(r) M₃(x) dr |
///
/// Of contacts that have moved forth and back, S and M are taken at the largest |x| known, which may exceed x.
#[derive(Debug, Clone)]
pub struct Life {
    survival: Kernel,
    breaking: Kernel,
    force: Kernel,
    square: Kernel,
    energy: Kernel,
    breaking_energy: Kernel,
    /// The contacts at u = 0.
    layers: Vec<Layer>,
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

    /// The elastic energy of the unbroken; an area (a volume where k = κ x_s).
    pub fn energy(&self) -> &Kernel {
        &self.energy
    }

    /// The elastic energy that the unbroken will have lost when all have broken, each at its threshold.
    pub fn breaking_energy(&self) -> &Kernel {
        &self.breaking_energy
    }

    /// The contacts at u = 0.
    pub(crate) fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// The layer that births form now, if each starts as the contacts of this life.
    pub(crate) fn born(&self, births: &Births) -> Layer {
        births.layer(&self.layers[0])
    }

    /// The mean advance that a contact survives.
    pub fn mean(&self) -> f64 {
        self.survival.curve().integral()
    }

    /// Density at stretch x of contacts that started u ago, per contact started; atoms not counted.
    pub fn stretch_density(&self, x: f64, u: f64) -> f64 {
        let unbroken =
            |layer: &Layer| layer.density_at(x - u) * self.thresholds.survival(layer.largest(x - u, u));
        self.layers.iter().map(unbroken).sum()
    }

    /// Stretches of the contacts that started u ago at point masses, with the fraction still there.
    pub fn stretch_atoms(&self, u: f64) -> impl Iterator<Item = Atom> + '_ {
        let unbroken = move |layer: &Layer, start: &Lump| {
            let survival = self.thresholds.survival(layer.largest(start.position, u));
            Atom { position: start.position + u, weight: start.weight * survival }
        };
        self.layers.iter().flat_map(move |layer| layer.lumps.iter().map(move |start| unbroken(layer, start)))
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
        let cuts: Vec<f64> = cuts.map(|u| x - u).collect();
        survival * self.layers.iter().map(|layer| layer.sum_below(x, |r| rate(x - r), &cuts)).sum::<f64>()
    }
}
