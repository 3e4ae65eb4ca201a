//! What a time between breaking and re-forming changes in the dynamic stiffness of contacts.
//!
//! Let F̂₀(s) be the dynamic stiffness of the same contacts if they re-form at once, and sβ̂(s) δX the deviation of the rate at
//! which they break. The free time has the mean ⟨τ⟩ and the Laplace transform d̂(s). A contact has the survival S(a) and carries
//! the force p(a) at the age a; a free one carries the friction f. With H = ∫S e^{−sa} da, P = ∫p e^{−sa} da, the transform
//! φ̂ = 1 − sH of the density of lives and the attached fraction A = H(0)/(H(0) + ⟨τ⟩), Eq. (dynamic stiffness) of the theory is
//!
//! F̂(s) = A {F̂₀ + N_c β̂ s (1 − d̂)(f H − P)/(1 − d̂ φ̂)}.

use std::f64::consts::TAU;

use num_complex::Complex64;

use super::{PHASE, SHARP};
use crate::contacts::{Contacts, FreeTime};
use crate::master::MasterEquation;
use crate::master::transport::length_of_lives;
use crate::monitor::Monitor;
use crate::{Error, Result};

/// Contacts that are free for a time before they re-form, in steady sliding.
#[derive(Debug, Clone)]
pub(super) struct Reattachment {
    /// Contacts that re-form at once.
    equation: MasterEquation,
    velocity: f64,
    delay: FreeTime,
    /// N_c f.
    friction: f64,
    /// H(0), a time.
    held: f64,
    /// Where lives and free times have no more structure: a frequency.
    highest: f64,
}

/// Periods of the first resonance over which the slowest oscillations are resolved.
const PERIODS: f64 = 30.0;
/// Highest frequency times the mean free time, at which shorter lives than that have no influence.
const SHORT: f64 = 40.0;
/// Contacts that dephase over more mean lives than this are alike, to rounding.
const IN_PHASE: f64 = 1e8;
/// |d̂| below which its phase has no influence.
const FADED: f64 = 1e-3;
/// Steps over the swings of a single delay that are resolved.
const SWINGS: f64 = 20_000.0;

impl Reattachment {
    /// Of contacts that slide at `velocity`; `immediate` are the same that re-form at once.
    ///
    /// # Errors
    /// Lives that are all alike, with which contacts stay in phase; those of [`MasterEquation::at`]; stopped by the monitor.
    pub(super) fn new(
        contacts: &Contacts,
        immediate: &Contacts,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let equation = MasterEquation::reformed(immediate.clone(), Some(velocity), monitor)?;
        let steady = equation.steady_state();
        let delay = contacts.rules.delay.clone();
        if matches!(delay, FreeTime::Fixed(_)) && steady.dephasing_length() > IN_PHASE * steady.mean_life() {
            let expected = "lives that differ beside one delay: contacts that are alike stay in phase, and no spring makes sliding stable";
            let found = format!("a life of {} of every contact", steady.mean_life());
            return Err(Error::invalid("thresholds", expected, found));
        }
        let held = steady.mean_life() / velocity;
        let friction = contacts.count * contacts.rules.free_friction.force;
        let wide = SHARP * velocity / length_of_lives(contacts);
        let highest = wide.max(SHORT / delay.mean());
        Ok(Self { equation, velocity, delay, friction, held, highest })
    }

    /// Fraction of contacts that breaks per length in steady sliding, if they re-form at once.
    pub(super) fn breaks_per_length(&self) -> f64 {
        self.equation.steady_state().breaking_rate()
    }

    /// ⟨τ⟩.
    pub(super) fn delay(&self) -> f64 {
        self.delay.mean()
    }

    /// A, the attached fraction.
    pub(super) fn attached(&self) -> f64 {
        self.held / (self.held + self.delay.mean())
    }

    /// N_c s (1 − d̂)(f H − P)/(1 − d̂ φ̂), a force.
    pub(super) fn force(&self, s: Complex64) -> Complex64 {
        let (free, [survival, force]) = (self.free(s), self.transforms(s));
        // 1 − d̂ φ̂ without a difference of nearly equal numbers.
        let denominator = free + (1.0 - free) * s * survival;
        s * free * (self.friction * survival - force) / denominator
    }

    /// The same where d̂ = 0.
    pub(super) fn force_without_return(&self, s: Complex64) -> Complex64 {
        let [survival, force] = self.transforms(s);
        s * (self.friction * survival - force)
    }

    /// The derivative of [`Self::force`] at s = 0, a force times a time.
    pub(super) fn force_rate(&self) -> f64 {
        let [survival, force] = self.transforms(Complex64::ZERO).map(|integral| integral.re);
        let delay = self.delay.mean();
        delay * (self.friction * survival - force) / (survival + delay)
    }

    /// The least real part of [`Self::force`] for s → i∞ where its imaginary part is 0: the forces are those of contacts that
    /// have just broken or re-formed.
    pub(super) fn least_force_at_once(&self) -> f64 {
        let life = self.equation.life();
        let change = self.friction - self.equation.stiffness() * life.force().curve().value(0.0);
        match self.delay {
            // d̂ is 1 or −1.
            FreeTime::Fixed(_) => (2.0 * change).min(0.0),
            FreeTime::Distributed(_) => change,
        }
    }

    /// [`Self::force`] for s → i∞ where d̂ is 1 in phase, or 0 for free times that differ.
    pub(super) fn force_in_phase(&self) -> f64 {
        match self.delay {
            FreeTime::Fixed(_) => 0.0,
            FreeTime::Distributed(_) => self.least_force_at_once(),
        }
    }

    /// The frequency above which there are resonances: their slowest oscillations are resolved from there on.
    pub(super) fn lowest(&self) -> f64 {
        TAU / (PERIODS * (self.held + self.delay.mean()))
    }

    /// The frequency above which lives and free times have no more structure.
    pub(super) fn highest(&self) -> f64 {
        self.highest
    }

    /// The longest step of a frequency over which d̂ is smooth. That of a single delay has no end: its swings are resolved up to some
    /// thousand periods, or as long as contacts return in phase.
    pub(super) fn longest_step(&self, frequency: f64) -> f64 {
        let step = PHASE / self.delay.mean();
        let resolved = self.highest.max(SWINGS * step);
        let swings = (1.0 - self.free(Complex64::new(0.0, frequency))).norm() > FADED;
        if frequency < resolved && swings { step } else { f64::INFINITY }
    }

    /// The velocity is so low that the frequencies are too many.
    pub(super) fn too_slow(&self) -> Error {
        let expected = "one at which contacts are not free for very much longer than they hold";
        let found = format!(
            "{:e}, at which they hold for {} and are free for {}",
            self.velocity,
            self.held,
            self.delay.mean()
        );
        Error::invalid("velocity", expected, found)
    }

    /// 1 − d̂(s), the transform of the fraction that is still free.
    fn free(&self, s: Complex64) -> Complex64 {
        let mean = self.delay.mean();
        if s.norm() * mean < 1e-8 {
            return s * mean;
        }
        match &self.delay {
            FreeTime::Fixed(delay) => 1.0 - (-s * delay).exp(),
            FreeTime::Distributed(law) => 1.0 - law.laplace(s),
        }
    }

    /// H and N_c P.
    #[inline(never)]
    fn transforms(&self, s: Complex64) -> [Complex64; 2] {
        let life = self.equation.life();
        let of = |curve: &crate::life::Piecewise| curve.transform(s / self.velocity).0 / self.velocity;
        [of(life.survival().curve()), self.equation.stiffness() * of(life.force().curve())]
    }
}
