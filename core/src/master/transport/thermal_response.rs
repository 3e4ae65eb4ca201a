//! The linear response of steady sliding of contacts that break thermally at constant thresholds, from the renewal equation.
//!
//! A contact formed at t − a has been carried from the stretch r to x = r + va. A small step δX of the slider at its age a₀
//! changes its cumulative hazard up to the age a by [ℓ(a) − ℓ(a₀)] δX, with ℓ the hazard per length; a contact that reaches its
//! threshold breaks earlier by δX/v. For a motion δX e^{st}, in which contacts stay as many, with σ = s/v, u the advance and
//! transforms ∫ e^{−σu} … du,
//!
//! F̂(s) = N_c (σ/ū) [Ĉ_x − Ĉ p̂/Ŝ], sβ̂(s) = (s/ū)(1 − Ĉ/Ŝ),
//!
//! where S is the survival and p the force of a contact ([`Life`](crate::life::Life)), ū = Ŝ(0), and
//! C(u) = ⟨∫ ℓ(u₀) S(u₀ + u) du₀⟩ and C_x(u), the same with the force, say how breaking and later survival are correlated.
//! Without temperature ℓ = 0, and the force does not depend on how the slider moves on. s → 0 gives
//! dF_k/dv = N_c/(ū v) ∫ (C_x − C F_k/N_c) du.

use num_complex::Complex64;

use crate::Result;
use crate::contacts::Contacts;
use crate::life::{HazardCorrelation, Piecewise};
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part, Watch};

/// Contacts that re-form at once.
#[derive(Debug, Clone)]
pub(super) struct ThermalResponse {
    equation: MasterEquation,
    correlation: HazardCorrelation,
    velocity: f64,
    /// ū.
    mean_life: f64,
}

/// Mean lives for which a response lasts: below its inverse F̂ has no more structure.
const LIVES: f64 = 30.0;

/// The highest frequency in units of v over the narrowest cell of the correlation: the next terms of the expansion in 1/s are
/// less by as much.
const SHARP: f64 = 100.0;

impl ThermalResponse {
    /// Of contacts that slide at `velocity`; none if it has no closed form.
    ///
    /// # Errors
    /// Those of [`MasterEquation::at`]; stopped by the monitor.
    pub(super) fn of(contacts: &Contacts, velocity: f64, monitor: &mut dyn Monitor) -> Result<Option<Self>> {
        let part = &mut Part::new(monitor, 0.0, 0.9);
        let Some(correlation) = HazardCorrelation::of(contacts, velocity, &Watch::new(part))? else {
            return Ok(None);
        };
        let part = &mut Part::new(monitor, 0.9, 0.1);
        let equation = MasterEquation::reformed(contacts.clone(), Some(velocity), part)?;
        let mean_life = equation.life().mean();
        Ok(Some(Self { equation, correlation, velocity, mean_life }))
    }

    /// F̂ and sβ̂/s, the fraction of contacts that break because of the step, per length.
    pub(super) fn transforms(&self, s: Complex64) -> [Complex64; 2] {
        let advance = s / self.velocity;
        let [survival, force, correlated, carried] = self.curves().map(|curve| curve.transform(advance).0);
        let per_length = correlated / survival;
        let unit = self.equation.stiffness() / self.mean_life;
        [unit * advance * (carried - per_length * force), (1.0 - per_length) / self.mean_life]
    }

    /// Both at the time of the step, for s → ∞.
    pub(super) fn at_once(&self) -> [f64; 2] {
        let [survival, force, correlated, carried] = self.curves().map(|curve| curve.value(0.0));
        let per_length = correlated / survival;
        let unit = self.equation.stiffness() / self.mean_life;
        [unit * (carried - per_length * force), (1.0 - per_length) / self.mean_life]
    }

    /// dF_k/dv, and the fraction of contacts that break because of a step in all, per length.
    pub(super) fn integrals(&self) -> [f64; 2] {
        let [survival, force, correlated, carried] = self.curves().map(Piecewise::integral);
        let per_length = correlated / survival;
        let unit = self.equation.stiffness() / (self.mean_life * self.velocity);
        [unit * (carried - per_length * force), (1.0 - per_length) / self.mean_life]
    }

    /// Where the response has no more structure: a frequency.
    pub(super) fn highest(&self) -> f64 {
        let widths = self.correlation.survival.boundaries.windows(2).map(|cell| cell[1] - cell[0]);
        SHARP * self.velocity / widths.fold(self.mean_life, f64::min)
    }

    /// How long there is a response.
    pub(super) fn duration(&self) -> f64 {
        LIVES * self.mean_life / self.velocity
    }

    /// S, p, C and C_x.
    fn curves(&self) -> [&Piecewise; 4] {
        let (life, correlation) = (self.equation.life(), &self.correlation);
        [life.survival().curve(), life.force().curve(), &correlation.survival, &correlation.force]
    }
}
