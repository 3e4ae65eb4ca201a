//! The life of a contact: its probability of survival, breaking density, force and energies after the slider has advanced
//! by u since the contact formed.
//!
//! All solvers use only these curves. They are the same type for every kind of contact, athermal or time-dependent.

mod additive;
mod advance_map;
mod ageing_correlation;
mod athermal;
mod births;
mod breaking;
mod breaking_model;
mod cells;
mod cohorts;
mod constant_threshold;
mod continuation;
mod derivative;
mod grid;
mod hazard_correlation;
mod hazard_table;
mod layer;
mod merge;
mod moving;
mod panels;
mod running_maximum;
mod smoluchowski;
mod start_quadrature;
mod starts_below;
mod step_correlation;
mod thermal_hazard;
mod timed;
mod waits;

pub(crate) use advance_map::{AdvanceMap, FAINT, points};
pub use athermal::athermal;
pub(crate) use athermal::cells_of;
use athermal::jumps;
pub(crate) use births::Births;
pub(crate) use cells::{ORDERS, threshold_atoms};
use cohorts::Cohorts;
pub(crate) use continuation::Continuation;
pub(crate) use derivative::{LawDerivatives, LifeDerivative, LifePair, StartingContacts};
pub(crate) use layer::Layer;
use layer::PointMass;
pub(crate) use merge::{LayerSums, life_of, reaches_threshold_atom, simplified};
pub use moving::moving;
pub(crate) use step_correlation::StepCorrelation;

use waits::DelayedLife;

pub use crate::numerics::piecewise::{Piecewise, Resolution};
pub use crate::numerics::volterra::Kernel;

use num_complex::Complex64;

use crate::law::{Atom, Breakpoint, SharedLaw};
use crate::monitor::Watch;

/// The life of contacts that start together, as functions of the advance u, per contact and per unit
/// stiffness (⟨k⟩, or κ for k = κ x_s).
///
/// With ν the density of starting stretches over their survival, ν = R/S (ν = Q_ini if stretches and
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
/// For contacts that have moved back and forth, S and M are taken at the largest |x| reached, which may
/// exceed x. For contacts at a velocity, S(x) is the surviving fraction of those formed at r, M₁ and M₂ are
/// its sums of present thresholds, and the breaking energy is that at the stretches at which they will break.
/// Contacts that are free before they form count as surviving; they carry the friction force of a free contact, if any, and no
/// energy.
///
/// ```
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// # use asperity::master::MasterEquation;
/// let equation = MasterEquation::new(contacts, &Initial::default())?;
/// let life = equation.life();
/// // The mean advance from forming to breaking is the mean threshold of contacts that form relaxed.
/// assert!((life.mean() - 1.0).abs() < 1e-9);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Life {
    survival: Kernel,
    breaking: Kernel,
    force: Kernel,
    square: Kernel,
    energy: Kernel,
    breaking_energy: Kernel,
    /// Where contacts start.
    starts: Starts,
    /// The advance for which contacts are free before they form.
    wait: f64,
    /// Contacts that are free for a time of a distribution before they form.
    waiting: Option<DelayedLife>,
    /// Mean stiffness of a contact, per unit stiffness.
    stiffness: f64,
    /// Estimated error of survival, and of the carried force per mean life and mean stiffness.
    error: f64,
}

/// Where contacts start, with what is needed to compute their survival.
#[derive(Debug, Clone)]
enum Starts {
    /// Time-independent contacts, in layers with a history.
    Layers { layers: Vec<Layer>, thresholds: SharedLaw },
    /// Contacts at a velocity.
    Cohorts(Box<Cohorts>),
}

impl Life {
    /// The fraction of unbroken contacts.
    pub fn survival(&self) -> &Kernel {
        &self.survival
    }

    /// The fraction that breaks per unit advance, with point masses where contacts break simultaneously.
    pub fn breaking(&self) -> &Kernel {
        &self.breaking
    }

    /// The mean force of a contact, broken ones counted as 0: a length (a length squared for k = κ x_s).
    pub fn force(&self) -> &Kernel {
        &self.force
    }

    /// The mean square of the force of a contact.
    pub fn square(&self) -> &Kernel {
        &self.square
    }

    /// The elastic energy of the unbroken contacts: an area (a volume for k = κ x_s).
    pub fn energy(&self) -> &Kernel {
        &self.energy
    }

    /// The energy that the surviving contacts will dissipate when they break, each at its threshold.
    pub fn breaking_energy(&self) -> &Kernel {
        &self.breaking_energy
    }

    /// The contacts at u = 0; empty for time-dependent contacts, which cannot be followed back.
    pub(crate) fn layers(&self) -> &[Layer] {
        match &self.starts {
            Starts::Layers { layers, .. } => layers,
            Starts::Cohorts(_) => &[],
        }
    }

    /// Whether all contacts are unstretched at u = 0, so that they carry no force, also without rounding.
    pub(crate) fn starts_unstretched(&self) -> bool {
        let layers = self.layers();
        !layers.is_empty() && layers.iter().all(|layer| layer.range() == Some((0.0, 0.0)))
    }

    /// The layer formed by `births` until now, if each contact starts as those of this life.
    pub(crate) fn born(&self, births: &Births) -> Layer {
        self.layers().first().map_or_else(Layer::default, |starts| births.layer(starts))
    }

    /// Mean stiffness of a contact, per unit stiffness: 1, the mean threshold where k = κ x_s, or the mean of a table.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Estimated error of survival, and of the carried force per mean life and mean stiffness.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The mean advance after which a contact breaks, including the time for which it was free.
    pub fn mean(&self) -> f64 {
        self.survival.curve().integral()
    }

    /// The same without the time for which it was free.
    pub(crate) fn mean_held(&self) -> f64 {
        let formed = self.formed();
        formed.mean() - formed.wait
    }

    /// ⟨u²⟩ of the advance after which a contact breaks, 2∫u S du.
    pub(crate) fn mean_square(&self) -> f64 {
        -2.0 * self.survival.curve().transform(Complex64::ZERO).1.re
    }

    /// The advance from formation after which a fraction of at most `fraction` of the contacts survives.
    pub fn longest(&self, fraction: f64) -> f64 {
        if let Some(waiting) = &self.waiting {
            return waiting.formed.longest(fraction);
        }
        let survival = self.survival.curve();
        let (mut low, mut high) = (self.wait, survival.end());
        while high - low > 1e-6 * high {
            let middle = 0.5 * (low + high);
            if survival.value(middle) > fraction { low = middle } else { high = middle }
        }
        high - self.wait
    }

    /// Density at x of the stretches at which contacts break, without point masses.
    pub(crate) fn breaking_stretch_density(&self, x: f64, watch: &Watch<'_>) -> f64 {
        match &self.starts {
            Starts::Layers { layers, thresholds } => {
                thresholds.density(x)
                    * layers.iter().map(|layer| layer.sum_below(x, |_| 1.0, &[])).sum::<f64>()
            }
            Starts::Cohorts(cohorts) => cohorts.breaking(x, watch),
        }
    }

    /// Point masses among the stretches at which contacts that start at point masses break.
    pub(crate) fn breaking_stretch_atoms(&self, watch: &Watch<'_>) -> Vec<Atom> {
        match &self.starts {
            Starts::Layers { layers, thresholds } => {
                let started =
                    |x: f64| layers.iter().map(|layer| layer.sum_below(x, |_| 1.0, &[])).sum::<f64>();
                let met = |atom: Atom| Atom { weight: atom.weight * started(atom.position), ..atom };
                thresholds.atoms().into_iter().map(met).collect()
            }
            Starts::Cohorts(cohorts) => cohorts.breaking_stretch_atoms(watch),
        }
    }

    /// The elastic energy of a contact that has just formed.
    pub(crate) fn fresh_energy(&self) -> f64 {
        self.formed().energy.curve().value(self.wait)
    }

    /// The life of the same contacts from forming on, if they are free for a time of a distribution before; else this life.
    pub(crate) fn formed(&self) -> &Self {
        self.waiting.as_ref().map_or(self, |waiting| &waiting.formed)
    }

    /// The density of the advance for which contacts are free before they form, without its point masses, and these; `None` if
    /// all are free for the same advance.
    pub(crate) fn waits(&self) -> Option<(Kernel, &[Atom])> {
        self.waiting.as_ref().map(|waiting| (waiting.waits.kernel(), waiting.waits.atoms.as_slice()))
    }

    /// Density at stretch x of contacts that started u ago, per contact, without point masses.
    pub(crate) fn stretch_density(&self, x: f64, u: f64, watch: &Watch<'_>) -> f64 {
        let u = u - self.wait;
        if u < 0.0 {
            return 0.0;
        }
        match &self.starts {
            Starts::Layers { layers, thresholds } => {
                let unbroken = |l: &Layer| l.density_at(x - u) * thresholds.survival(l.largest(x - u, u));
                layers.iter().map(unbroken).sum()
            }
            Starts::Cohorts(cohorts) => cohorts.density(x, u, watch),
        }
    }

    /// Stretches of the contacts that started u ago at point masses, with the surviving fraction.
    pub(crate) fn stretch_atoms(&self, u: f64, watch: &Watch<'_>) -> Vec<Atom> {
        let u = u - self.wait;
        if u < 0.0 {
            return Vec::new();
        }
        match &self.starts {
            Starts::Layers { layers, thresholds } => {
                let unbroken = |layer: &Layer, start: &PointMass| {
                    let survival = thresholds.survival(layer.largest(start.position, u));
                    Atom { position: start.position + u, weight: start.weight * survival }
                };
                let all = layers
                    .iter()
                    .flat_map(|layer| layer.point_masses.iter().map(move |start| (layer, start)));
                all.map(|(layer, start)| unbroken(layer, start)).collect()
            }
            Starts::Cohorts(cohorts) => cohorts.atoms(u, watch).collect(),
        }
    }

    /// Density at stretch x of contacts that have formed at the rate `rate(advance)` per contact, the advance
    /// counted back from now; `cuts` are advances at which that rate is not smooth.
    pub(crate) fn standing_density(
        &self,
        x: f64,
        rate: impl Fn(f64) -> f64,
        cuts: impl Iterator<Item = f64>,
        watch: &Watch<'_>,
    ) -> f64 {
        let rate = |u: f64| rate(u + self.wait);
        let cuts: Vec<f64> = cuts.map(|u| x - (u - self.wait)).collect();
        match &self.starts {
            Starts::Layers { layers, thresholds } => {
                let survival = thresholds.survival(x);
                if survival == 0.0 {
                    return 0.0;
                }
                let standing = |layer: &Layer| layer.sum_below(x, |r| rate(x - r), &cuts);
                survival * layers.iter().map(standing).sum::<f64>()
            }
            Starts::Cohorts(cohorts) => cohorts.standing(x, rate, &cuts, watch),
        }
    }

    /// Jumps of the carried force and of its slope at the advance at which free contacts re-form; empty
    /// without a delay.
    pub(crate) fn reattachment(&self) -> Vec<Breakpoint> {
        let waits: Vec<f64> = match &self.waiting {
            Some(waiting) => waiting.waits.edges().collect(),
            None if self.wait > 0.0 => vec![self.wait],
            None => Vec::new(),
        };
        let begins = |b: &&Breakpoint| waits.contains(&b.position);
        self.force.breakpoints().iter().filter(begins).copied().collect()
    }

    /// Kinks of the slope of the carried force where nothing happens to the breaking density: those of a table of
    /// stiffnesses, which contacts with a delay do not have.
    pub(crate) fn kinks_of_stiffness(&self) -> Vec<Breakpoint> {
        if self.wait > 0.0 || self.waiting.is_some() {
            return Vec::new();
        }
        let known = self.survival.breakpoints();
        self.force.breakpoints().iter().filter(|b| !known.contains(b)).copied().collect()
    }

    /// The same contacts, each free for the advance `by` before it forms, with a force `friction` meanwhile.
    #[must_use]
    fn delayed(self, by: f64, friction: f64) -> Self {
        if by == 0.0 {
            return self;
        }
        let shifted = |kernel: &Kernel| -> Vec<Breakpoint> {
            kernel.breakpoints().iter().map(|b| Breakpoint { position: b.position + by, ..*b }).collect()
        };
        // Nothing breaks where contacts re-form, but the force jumps there, or its slope does.
        let late = |kernel: Kernel, before: f64| {
            let curve = kernel.curve().preceded(by, before);
            let mut breakpoints = shifted(&kernel);
            breakpoints.extend(jumps(&curve, by, 2));
            Breakpoint::sort(&mut breakpoints);
            Kernel::new(curve, breakpoints)
        };
        let breaking = Kernel::new(self.breaking.curve().preceded(by, 0.0), shifted(&self.breaking));
        let whole = self.survival.curve().value(0.0);
        let doomed = self.breaking_energy.curve().value(0.0);
        Self {
            survival: late(self.survival, whole),
            breaking,
            force: late(self.force, friction),
            square: late(self.square, friction * friction),
            energy: late(self.energy, 0.0),
            breaking_energy: late(self.breaking_energy, doomed),
            starts: self.starts,
            wait: self.wait + by,
            waiting: self.waiting,
            stiffness: self.stiffness,
            error: self.error,
        }
    }
}
