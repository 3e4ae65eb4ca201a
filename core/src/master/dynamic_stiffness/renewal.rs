//! The linear response of steady sliding from the renewal equation, of contacts that re-form at once.
//!
//! Let a step δX at the advance u₀ of a contact lower its surviving fraction at the advance u by D(u, u₀) δX, with φ the breaking
//! density and p the force of a contact. For a motion δX e^{st} in which contacts stay as many, with σ = s/v, the survival S
//! ([`Life`](crate::life::Life)), ū = Ŝ(0) and transforms ∫ e^{−σu} … du,
//!
//! F̂(s) = N_c (σ/ū) [Ĉ_x − Ĉ p̂/Ŝ], sβ̂(s) = (s/ū)(1 − Ĉ/Ŝ), C(u) = ∫ [φ(u₀ + u) − D(u₀ + u, u₀)] du₀,
//!
//! and C_x(u) the same with the force ([`StepCorrelation`]). If contacts break at stretches that do not depend on the motion, C = 0,
//! and the force does not depend on how the slider moves on. s → 0 gives dF_k/dv = N_c/(ū v) ∫ (C_x − C F_k/N_c) du.

use num_complex::Complex64;

use super::{ImmediateResponse, LIVES};
use crate::Result;
use crate::contacts::Contacts;
use crate::life::{Piecewise, StepCorrelation};
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part, Watch};

/// Contacts that re-form at once.
#[derive(Debug, Clone)]
pub(super) struct RenewalResponse {
    equation: MasterEquation,
    correlation: StepCorrelation,
    velocity: f64,
    /// ū.
    mean_life: f64,
}

/// The highest frequency in units of v over the narrowest cell of the correlation: the next terms of the expansion in 1/s are
/// less by as much.
const SHARP: f64 = 100.0;

/// The highest frequency in units of v over the mean life: rounding of phases is 1e-8 there.
const EXACT: f64 = 1e8;

impl RenewalResponse {
    /// Of contacts that slide at `velocity`; none if it has no closed form.
    ///
    /// # Errors
    /// Those of [`MasterEquation::at`]; stopped by the monitor.
    pub(super) fn of(contacts: &Contacts, velocity: f64, monitor: &mut dyn Monitor) -> Result<Option<Self>> {
        let part = &mut Part::new(monitor, 0.0, 0.9);
        let Some(correlation) = StepCorrelation::of(contacts, velocity, &Watch::new(part))? else {
            return Ok(None);
        };
        let part = &mut Part::new(monitor, 0.9, 0.1);
        let equation = MasterEquation::reformed(contacts.clone(), Some(velocity), part)?;
        let mean_life = equation.life().mean();
        Ok(Some(Self { equation, correlation, velocity, mean_life }))
    }

    /// S, p, C and C_x.
    fn curves(&self) -> [&Piecewise; 4] {
        let (life, correlation) = (self.equation.life(), &self.correlation);
        [life.survival().curve(), life.force().curve(), &correlation.survival, &correlation.force]
    }
}

impl ImmediateResponse for RenewalResponse {
    fn transforms(&self, s: Complex64) -> [Complex64; 2] {
        let advance = s / self.velocity;
        let [survival, force, correlated, carried] = self.curves().map(|curve| curve.transform(advance).0);
        let per_length = correlated / survival;
        let unit = self.equation.stiffness() / self.mean_life;
        [unit * advance * (carried - per_length * force), (1.0 - per_length) / self.mean_life]
    }

    fn at_once(&self) -> [f64; 2] {
        let [survival, force, correlated, carried] = self.curves().map(|curve| curve.value(0.0));
        let per_length = correlated / survival;
        let unit = self.equation.stiffness() / self.mean_life;
        [unit * (carried - per_length * force), (1.0 - per_length) / self.mean_life]
    }

    fn integrals(&self) -> [f64; 2] {
        let [survival, force, correlated, carried] = self.curves().map(Piecewise::integral);
        let per_length = correlated / survival;
        let unit = self.equation.stiffness() / (self.mean_life * self.velocity);
        [unit * (carried - per_length * force), (1.0 - per_length) / self.mean_life]
    }

    fn highest(&self) -> f64 {
        let widths = self.correlation.survival.boundaries.windows(2).map(|cell| cell[1] - cell[0]);
        let narrowest = widths.fold(self.mean_life, f64::min);
        (SHARP / narrowest).min(EXACT / self.mean_life) * self.velocity
    }

    fn duration(&self) -> f64 {
        LIVES * self.mean_life / self.velocity
    }
}
