//! The linear response of steady sliding: the dynamic stiffness of the contacts, alone and behind a spring.
//!
//! Contacts slide steadily at v. Let r(t) be the response of F, per length, to a small step of X at t = 0. Then a displacement
//! δX e^{st} of the slider changes the force by F̂(s) δX e^{st},
//!
//! F̂(s) = s ∫₀^∞ r e^{−st} dt = r(0) + ∫₀^∞ r' e^{−st} dt.
//!
//! F̂(iω) is the complex dynamic stiffness at the angular frequency ω. At small ω, F̂ ≈ iω ∫r dt = iω dF_k/dv.
//!
//! A time between breaking and re-forming would let r jump, and contacts that are alike would stay in phase for long. So the
//! response is that of contacts that re-form at once, with the response of their breaks, in one of three forms: closed
//! ([`renewal`]), by integrals over the ages of contacts ([`ages`]), or followed in time ([`followed`]). The free time enters in
//! closed form ([`reattachment`]).

mod ages;
mod followed;
mod reattachment;
mod renewal;
mod spring;
mod stability;

pub use spring::SpringResponse;
pub use stability::Slider;

use std::fmt;
use std::sync::Arc;

use num_complex::Complex64;

use crate::contacts::{Contacts, FreeFriction, FreeTime, Initial};
use crate::error::positive;
use crate::master::transport::{Transport, length_of_lives};
use crate::monitor::{Aside, Monitor, Part};
use crate::{Error, Result};
use ages::AgeIntegrals;
use followed::{FollowedResponse, NoResponse};
use reattachment::Reattachment;
use renewal::RenewalResponse;

/// The dynamic stiffness F̂(s) of contacts in steady sliding, force per length.
#[derive(Debug, Clone)]
pub struct DynamicStiffness {
    velocity: f64,
    /// The mean fresh threshold.
    length: f64,
    /// The frequency up to which lives that begin together end in phase.
    in_phase: f64,
    immediate: Arc<dyn ImmediateResponse>,
    reattachment: Option<Reattachment>,
}

/// The response of contacts that re-form at once to a step of the slider: of the force, and of the fraction of contacts that break
/// because of the step, each per length.
trait ImmediateResponse: Send + Sync {
    /// s ∫r e^{−st} dt for both, Re s ≥ 0.
    fn transforms(&self, s: Complex64) -> [Complex64; 2];

    /// Both at the time of the step, for s → ∞.
    fn at_once(&self) -> [f64; 2];

    /// ∫r dt of the force, dF_k/dv, and the fraction of contacts that break because of the step in all.
    fn integrals(&self) -> [f64; 2];

    /// The highest frequency at which there is structure, or up to which it is known.
    fn highest(&self) -> f64;

    /// Duration after which there is no response.
    fn duration(&self) -> f64;
}

/// Without the curves: the names of all their fields would be in every program, as in the engine of the explorer.
impl fmt::Debug for dyn ImmediateResponse {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("ImmediateResponse").finish_non_exhaustive()
    }
}

/// Sliding distance over which a response is followed in time, in mean lives of a contact.
const LIVES: f64 = 30.0;
/// Tolerance of a response that is followed in time; the error of K_c is then some 1e-3 of the stiffness of the contacts, or of K_c
/// if that is larger.
const RESPONSE: f64 = 1e-5;
/// Frequencies evaluated per factor e.
const PER_FOLD: f64 = 50.0;
/// Largest step of a phase between frequencies, in radians.
const PHASE: f64 = 0.25;
/// Frequency in units of v over the width of lives above which their phases have no influence: the transform of a Gaussian
/// distribution is 1e-14 there.
const SHARP: f64 = 8.0;
/// The highest frequency, in units of v over the mean threshold, at which phases of lives are resolved.
const RESOLVED: f64 = 500.0;
/// Most frequencies.
const MOST: usize = 100_000;

impl DynamicStiffness {
    /// Of contacts that slide steadily at `velocity`. It is 0 for time-independent contacts without a free time.
    ///
    /// | contacts | form | error, force per length in units of N_c⟨k⟩ |
    /// |---|---|---|
    /// | with temperature, without ageing | closed | 1e-9 |
    /// | with ageing by age (`logarithmic`, `frozen_rank`), without temperature; they re-form at single stretches and have equal stiffnesses | closed | 1e-9 |
    /// | with both, or ageing ones of different stiffnesses; thresholds have a density, they re-form without stretch, and the ages resolve how they break | integrals over ages | 1e-4 (trapezoidal rule to 1e-3, extrapolated) |
    /// | others | followed in time | 1e-3 |
    ///
    /// Zeros of Im F̂ are looked for at frequencies 2 % apart, and closer where lives and free times of contacts are in phase.
    ///
    /// # Errors
    /// Those of [`Contacts::check`] and [`Transport::steady`]; viscous friction of free contacts; a delay after which all contacts
    /// stay in phase.
    pub fn new(contacts: &Contacts, velocity: f64) -> Result<Self> {
        Self::new_with(contacts, velocity, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::new`]; stopped by the monitor.
    pub fn new_with(contacts: &Contacts, velocity: f64, monitor: &mut dyn Monitor) -> Result<Self> {
        Self::joined_of(contacts, velocity, monitor, |immediate, monitor| {
            // Contacts that age may turn out to have no closed form.
            let share = if immediate.rules.ageing.is_some() { 0.2 } else { 1.0 };
            if let Some(renewal) =
                RenewalResponse::of(immediate, velocity, &mut Part::new(monitor, 0.0, share))?
            {
                return Ok(Arc::new(renewal));
            }
            let monitor = &mut Part::new(monitor, share, 1.0 - share);
            if let Some(ages) = AgeIntegrals::of(immediate, velocity, monitor)? {
                return Ok(Arc::new(ages));
            }
            let steps = Transport::step_response(immediate, velocity, LIVES, RESPONSE, monitor)?;
            Ok(Arc::new(FollowedResponse::new(steps)))
        })
    }

    /// The same with a response that is followed in time over `lives` mean lives of a contact, to `tolerance`, also where there is
    /// another form; that of time-independent contacts is 0.
    ///
    /// # Errors
    /// As [`Self::new_with`]; a number of lives that is not above 0.
    pub fn followed(
        contacts: &Contacts,
        velocity: f64,
        lives: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        positive("lives", lives)?;
        Self::joined_of(contacts, velocity, monitor, |immediate, monitor| {
            let steps = Transport::step_response(immediate, velocity, lives, tolerance, monitor)?;
            Ok(Arc::new(FollowedResponse::new(steps)))
        })
    }

    /// Of the response r of the force to a step, at evenly spaced times from 0 up to some thirty mean lives.
    pub fn of_step_response(velocity: f64, time: Vec<f64>, response: Vec<f64>) -> Self {
        let (length, breaks) = (velocity * time[time.len() - 1] / LIVES, vec![0.0; time.len()]);
        let immediate = Arc::new(FollowedResponse::new([time, response, breaks]));
        Self { velocity, length, in_phase: 0.0, immediate, reattachment: None }
    }

    /// Of the response `of` the same contacts if they re-form at once.
    fn joined_of(
        contacts: &Contacts,
        velocity: f64,
        monitor: &mut dyn Monitor,
        of: impl FnOnce(&Contacts, &mut dyn Monitor) -> Result<Arc<dyn ImmediateResponse>>,
    ) -> Result<Self> {
        positive("velocity", velocity)?;
        contacts.check(&Initial::default())?;
        let viscosity = contacts.rules.free_friction.viscosity;
        if viscosity > 0.0 {
            let expected = "0 where the response of steady sliding is computed";
            return Err(Error::invalid("free_friction.viscosity", expected, viscosity));
        }
        let mut at_once = contacts.clone();
        (at_once.rules.delay, at_once.rules.free_friction) = (FreeTime::default(), FreeFriction::default());
        let length = contacts.thresholds.mean();
        let aside = &mut Aside { fraction: 0.0, monitor: &mut *monitor };
        let delayed = !contacts.rules.delay.is_none();
        let reattachment =
            delayed.then(|| Reattachment::new(contacts, &at_once, velocity, aside)).transpose()?;
        let immediate = if at_once.rules.are_time_dependent() {
            of(&at_once, monitor)?
        } else {
            // Without a free time no response depends on breaks.
            let breaks = reattachment.as_ref().map_or(0.0, Reattachment::breaks_per_length);
            Arc::new(NoResponse { breaks, duration: length / velocity })
        };
        let in_phase = (SHARP / length_of_lives(contacts)).min(RESOLVED / length) * velocity;
        Ok(Self { velocity, length, in_phase, immediate, reattachment })
    }

    /// v.
    pub fn velocity(&self) -> f64 {
        self.velocity
    }

    /// F̂(s), Re s ≥ 0. Of contacts without a closed form, beyond the frequencies that ages or times resolve, it is r(0) + ρ/s, as
    /// for |s| → ∞, with ρ from Im F̂ at the last resolved frequency.
    pub fn at(&self, s: Complex64) -> Complex64 {
        self.joined(s, Reattachment::force)
    }

    /// F̂(s) where contacts do not return in phase.
    fn without_return(&self, s: Complex64) -> Complex64 {
        self.joined(s, Reattachment::force_without_return)
    }

    fn joined(&self, s: Complex64, force: impl Fn(&Reattachment, Complex64) -> Complex64) -> Complex64 {
        let [immediate, breaks] = self.immediate.transforms(s);
        match &self.reattachment {
            None => immediate,
            Some(free) => free.attached() * (immediate + breaks * force(free, s)),
        }
    }

    /// F̂(∞), the response to a sudden displacement. With one delay for all breaks F̂ has no limit for s → i∞; this is its value at
    /// the frequencies of which the delay is a multiple of the period.
    pub fn instantaneous(&self) -> f64 {
        self.joined_at_once(Reattachment::force_in_phase)
    }

    /// The least real part of F̂ at the frequencies ω → ∞ at which its imaginary part is 0.
    fn least_at_once(&self) -> f64 {
        self.joined_at_once(Reattachment::least_force_at_once)
    }

    fn joined_at_once(&self, force: impl Fn(&Reattachment) -> f64) -> f64 {
        let [immediate, breaks] = self.immediate.at_once();
        self.reattachment
            .as_ref()
            .map_or(immediate, |free| free.attached() * (immediate + breaks * force(free)))
    }

    /// The derivative of F̂ at s = 0: dF_k/dv.
    pub fn integral(&self) -> f64 {
        let [immediate, breaks] = self.immediate.integrals();
        self.reattachment
            .as_ref()
            .map_or(immediate, |free| free.attached() * (immediate + breaks * free.force_rate()))
    }

    /// Frequencies between which F̂ is smooth: they rise by a factor, and by no more than a fraction of a period of what swings with
    /// the lives and the free times of contacts, as far as these are in phase.
    ///
    /// # Errors
    /// More than can be computed.
    fn frequencies(&self) -> Result<Vec<f64>> {
        let (low, high) = (1.0 / self.immediate.duration(), self.immediate.highest());
        let free = self.reattachment.as_ref();
        let mut frequency = free.map_or(low, |free| low.min(free.lowest()));
        let high = free.map_or(high, |free| high.max(free.highest()));
        let (swings, in_phase) = (PHASE * self.velocity / self.length, self.in_phase.min(high));
        let mut frequencies = vec![frequency];
        while frequency < high {
            let mut step = ((1.0 / PER_FOLD).exp() - 1.0) * frequency;
            if frequency < in_phase {
                step = step.min(swings);
            }
            step = free.map_or(step, |free| step.min(free.longest_step(frequency)));
            frequency = (frequency + step).min(high);
            frequencies.push(frequency);
            if let Some(free) = free.filter(|_| frequencies.len() > MOST) {
                return Err(free.too_slow());
            }
        }
        Ok(frequencies)
    }
}

/// Both transforms at a frequency beyond the highest known one, at which they are `last`.
#[inline(never)]
fn beyond(s: Complex64, highest: f64, at_once: [f64; 2], last: [Complex64; 2]) -> [Complex64; 2] {
    [0, 1].map(|i| Complex64::from(at_once[i]) - highest * last[i].im / s)
}
