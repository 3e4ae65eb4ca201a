//! The linear response of steady sliding to a small step of the slider, and the complex dynamic stiffness of
//! the contacts.
//!
//! Contacts slide steadily at v. Let r(t) be the response of F, per length, to a small step of X at t = 0.
//! Then a displacement δX e^{st} of the slider changes the force by F̂(s) δX e^{st},
//!
//! F̂(s) = s ∫₀^∞ r e^{−st} dt = r(0) + ∫₀^∞ r' e^{−st} dt.
//!
//! F̂(iω) is the complex dynamic stiffness at the angular frequency ω. At small ω, F̂ ≈ iω ∫r dt = iω
//! dF_k/dv.
//!
//! With temperature and without ageing F̂ has a closed form ([`super::thermal_response`]). Else r is followed in time.
//!
//! A time between breaking and re-forming would let r jump, and contacts that are alike would stay in phase for long. So r is
//! that of contacts that re-form at once, with the response of their breaks, and the free time enters in closed form
//! ([`Reattachment`]).

use num_complex::Complex64;

use super::dense_output::RequestedReadings;
use super::merging::MergingRule;
use super::reattachment::Reattachment;
use super::settled::ConstantRate;
use super::thermal_response::ThermalResponse;
use super::{Transport, steady};
use crate::contacts::{Contacts, FreeFriction, FreeTime, Rules};
use crate::monitor::{Aside, Monitor, Part};
use crate::{Error, Result};

/// The response of steady sliding to a small step of the slider.
#[derive(Debug, Clone)]
pub struct StepResponse {
    velocity: f64,
    immediate: ImmediateResponse,
    reattachment: Option<Reattachment>,
}

/// The response of contacts that re-form at once.
#[derive(Debug, Clone)]
enum ImmediateResponse {
    Followed(FollowedResponse),
    Thermal(Box<ThermalResponse>),
}

/// A response in time.
#[derive(Debug, Clone)]
struct FollowedResponse {
    /// Times t since the step, evenly spaced from 0.
    time: Vec<f64>,
    /// r(t), force per length; taken as 0 after the last time.
    response: Vec<f64>,
    /// Fraction of contacts that have broken until then because of the step, per length.
    breaks: Vec<f64>,
}

/// Size of the step, in units of the length on which lives vary.
const STEP: f64 = 0.01;

/// Number of times in the longest time step.
const FINER: f64 = 2.0;

/// Velocity of the step, in units of the sliding velocity.
const FAST: f64 = 1e4;

/// Largest number of times, in each of which all cohorts move.
const MOST: f64 = 4_194_304.0;

/// Frequencies evaluated per factor e.
const PER_FOLD: f64 = 50.0;

/// Refuses more times than can be followed.
fn fits(velocity: f64, count: f64) -> Result<()> {
    if count <= MOST {
        return Ok(());
    }
    let expected = format!(
        "one at which lives are not very much longer than the stretch over which they end: the response of steady sliding is followed in at most {MOST:.1e} steps"
    );
    Err(Error::invalid("velocity", expected, format!("{velocity:e}, at which it takes {count:.1e}")))
}

impl Transport {
    /// The response of steady sliding at a velocity to a small step. It is 0 for time-independent contacts, and has a closed form
    /// with temperature and without ageing. Else it is followed in time over `lives` mean lives of a contact, to `tolerance`.
    ///
    /// # Errors
    /// Those of [`Transport::steady`]; a number of lives that is not above 0; a delay after which all contacts stay in phase;
    /// stopped by the monitor.
    pub fn step_response(
        contacts: &Contacts,
        velocity: f64,
        lives: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<StepResponse> {
        super::positive("lives", lives)?;
        super::positive("velocity", velocity)?;
        contacts.check(&steady::relaxed())?;
        let Rules { free_friction, .. } = &contacts.rules;
        if free_friction.viscosity > 0.0 {
            let expected =
                "0 where the response of steady sliding is computed: a step has no limit with a viscosity";
            return Err(Error::invalid("free_friction.viscosity", expected, free_friction.viscosity));
        }
        if let Some(thermal) = Self::thermal_response(contacts, velocity, monitor)? {
            return Ok(thermal);
        }
        let immediate = immediate(contacts);
        let reattachment =
            reattachment(contacts, &immediate, velocity, &mut Aside { fraction: 0.0, monitor })?;
        let response = if immediate.rules.are_time_dependent() {
            followed(&immediate, velocity, lives, tolerance, monitor)?
        } else {
            time_independent(contacts, velocity, reattachment.as_ref())
        };
        Ok(StepResponse { velocity, immediate: ImmediateResponse::Followed(response), reattachment })
    }

    /// The same where it has a closed form: with temperature, and without ageing.
    ///
    /// # Errors
    /// Those of [`Self::step_response`].
    pub(crate) fn thermal_response(
        contacts: &Contacts,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<StepResponse>> {
        if contacts.rules.temperature.is_none() || contacts.rules.ageing.is_some() {
            return Ok(None);
        }
        let immediate = immediate(contacts);
        let thermal = ThermalResponse::of(&immediate, velocity, &mut Part::new(monitor, 0.0, 0.9))?;
        let Some(thermal) = thermal else { return Ok(None) };
        let reattachment =
            reattachment(contacts, &immediate, velocity, &mut Aside { fraction: 0.9, monitor })?;
        let immediate = ImmediateResponse::Thermal(Box::new(thermal));
        Ok(Some(StepResponse { velocity, immediate, reattachment }))
    }

    /// Force and fraction of broken contacts at the times, of steady sliding on.
    fn readings(&mut self, velocity: f64, times: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<[f64; 2]>> {
        let (begun, duration) = (self.time, times[times.len() - 1]);
        let now =
            |transport: &Self| [transport.stiffness * transport.reading().force, transport.broken.all()];
        let mut readings = vec![now(self)];
        self.mark_kink();
        for ends in times.windows(2) {
            let asked = (&mut RequestedReadings::default(), MergingRule::Never);
            let part = |time: f64| ((time - begun) / duration).clamp(0.0, 1.0);
            self.advance_steadily(velocity, ends[1] - ends[0], asked, &part, monitor)?;
            self.time = begun + ends[1];
            readings.push(now(self));
        }
        Ok(readings)
    }
}

/// The same contacts, if they re-form at once.
fn immediate(contacts: &Contacts) -> Contacts {
    let mut immediate = contacts.clone();
    (immediate.rules.delay, immediate.rules.free_friction) = (FreeTime::default(), FreeFriction::default());
    immediate
}

/// What a free time changes, if there is one.
fn reattachment(
    contacts: &Contacts,
    immediate: &Contacts,
    velocity: f64,
    monitor: &mut dyn Monitor,
) -> Result<Option<Reattachment>> {
    let delayed = !contacts.rules.delay.is_none();
    delayed.then(|| Reattachment::new(contacts, immediate, velocity, monitor)).transpose()
}

/// Time-independent contacts: the force of steady sliding does not depend on how the slider moves on, and a step breaks as many
/// contacts as the same distance of steady sliding.
fn time_independent(contacts: &Contacts, velocity: f64, free: Option<&Reattachment>) -> FollowedResponse {
    let time = vec![0.0, contacts.thresholds.mean() / velocity];
    // Without a free time no response depends on breaks.
    let breaks = vec![free.map_or(0.0, Reattachment::breaks_per_length); 2];
    FollowedResponse { time, response: vec![0.0; 2], breaks }
}

/// The response of contacts that re-form at once, from two solutions: of steady sliding with and without a step.
fn followed(
    contacts: &Contacts,
    velocity: f64,
    lives: f64,
    tolerance: f64,
    monitor: &mut dyn Monitor,
) -> Result<FollowedResponse> {
    let aside = &mut Aside { fraction: 0.0, monitor };
    let mut steady = Transport::steady_with(contacts, velocity, tolerance, aside)?;
    (steady.rough, steady.constant) = (None, ConstantRate::unused());
    let by = STEP * super::step_control::scale(contacts);
    let during = by / (FAST * velocity);
    let duration = lives / steady.breaking_rate();
    let spacing = steady.pace.longest(velocity) / FINER;
    let count = (duration / spacing).ceil().max(1.0);
    fits(velocity, count)?;
    let time: Vec<f64> = (0..=count as u32).map(|k| f64::from(k) / count * duration).collect();
    let mut displaced = steady.clone();
    displaced.step(by, during, &mut Aside { fraction: 0.0, monitor })?;
    // Both solutions end steps at the times: their errors are then those of the same steps, and cancel.
    let after = displaced.readings(velocity, &time, &mut Part::new(monitor, 0.0, 0.5))?;
    let before = steady.readings(velocity, &time, &mut Part::new(monitor, 0.5, 0.5))?;
    let per_length =
        |of: usize| after.iter().zip(&before).map(|(after, before)| (after[of] - before[of]) / by).collect();
    let (response, breaks) = (per_length(0), per_length(1));
    Ok(FollowedResponse { time, response, breaks })
}

impl StepResponse {
    /// The response r at evenly spaced times from 0 of contacts that re-form at once.
    pub fn new(velocity: f64, time: Vec<f64>, response: Vec<f64>) -> Self {
        let breaks = vec![0.0; time.len()];
        let followed = FollowedResponse { time, response, breaks };
        Self { velocity, immediate: ImmediateResponse::Followed(followed), reattachment: None }
    }

    /// v.
    pub fn velocity(&self) -> f64 {
        self.velocity
    }

    /// F̂(s), Re s ≥ 0, with r linear between the times if it was followed in time. Beyond the frequencies that these resolve, F̂
    /// is then r(0) + ρ/s, as for |s| → ∞, with ρ from Im F̂ at the last resolved frequency.
    pub fn at(&self, s: Complex64) -> Complex64 {
        self.joined(s, Reattachment::force)
    }

    /// F̂(s) where contacts do not return in phase.
    pub(super) fn without_return(&self, s: Complex64) -> Complex64 {
        self.joined(s, Reattachment::force_without_return)
    }

    /// The least real part of F̂ at the frequencies ω → ∞ at which its imaginary part is 0.
    pub(super) fn least_at_once(&self) -> f64 {
        let [force, breaks] = self.at_once();
        match &self.reattachment {
            None => force,
            Some(free) => free.attached() * (force + breaks * free.least_force_at_once()),
        }
    }

    /// F̂(∞); with one delay for all breaks its value at the frequencies of which the delay is a multiple of the period.
    pub(crate) fn instantaneous(&self) -> f64 {
        let [force, breaks] = self.at_once();
        self.reattachment
            .as_ref()
            .map_or(force, |free| free.attached() * (force + breaks * free.force_in_phase()))
    }

    fn joined(&self, s: Complex64, force: impl Fn(&Reattachment, Complex64) -> Complex64) -> Complex64 {
        let [immediate, breaks] = match &self.immediate {
            ImmediateResponse::Followed(followed) => followed.transforms(s),
            ImmediateResponse::Thermal(thermal) => thermal.transforms(s),
        };
        match &self.reattachment {
            None => immediate,
            Some(free) => free.attached() * (immediate + breaks * force(free, s)),
        }
    }

    /// Both responses at the time of the step.
    fn at_once(&self) -> [f64; 2] {
        match &self.immediate {
            ImmediateResponse::Followed(followed) => [followed.response[0], followed.breaks[0]],
            ImmediateResponse::Thermal(thermal) => thermal.at_once(),
        }
    }

    /// The highest frequency at which the response has structure, or up to which it is resolved.
    fn resolved(&self) -> f64 {
        match &self.immediate {
            ImmediateResponse::Followed(followed) => followed.resolved(),
            ImmediateResponse::Thermal(thermal) => thermal.highest(),
        }
    }

    /// Duration after which there is no response.
    pub(super) fn known(&self) -> f64 {
        match &self.immediate {
            ImmediateResponse::Followed(followed) => followed.time[followed.time.len() - 1],
            ImmediateResponse::Thermal(thermal) => thermal.duration(),
        }
    }

    /// Frequencies between which F̂ is smooth.
    ///
    /// # Errors
    /// More than can be computed.
    pub(super) fn frequencies(&self) -> Result<Vec<f64>> {
        let (low, high) = (1.0 / self.known(), self.resolved());
        if let Some(free) = &self.reattachment {
            return free.frequencies(low, high, (1.0 / PER_FOLD).exp());
        }
        let count = ((high / low).ln() * PER_FOLD).ceil().max(1.0);
        Ok((0..=count as u32).map(|k| low * (high / low).powf(f64::from(k) / count)).collect())
    }

    /// The derivative of F̂ at s = 0: dF_k/dv.
    pub fn integral(&self) -> f64 {
        let [immediate, breaks] = match &self.immediate {
            ImmediateResponse::Followed(followed) => {
                [followed.integral(), followed.breaks[followed.breaks.len() - 1]]
            }
            ImmediateResponse::Thermal(thermal) => thermal.integrals(),
        };
        self.reattachment
            .as_ref()
            .map_or(immediate, |free| free.attached() * (immediate + breaks * free.force_rate()))
    }
}

impl FollowedResponse {
    /// s ∫r e^{−st} dt, and the same of the breaks.
    fn transforms(&self, s: Complex64) -> [Complex64; 2] {
        if s.norm() <= self.resolved() {
            return self.sums(s);
        }
        let last = Complex64::new(0.0, self.resolved());
        let first = [self.response[0], self.breaks[0]];
        let sums = self.sums(last);
        [0, 1].map(|i| Complex64::from(first[i]) - last.im * sums[i].im / s)
    }

    /// The highest frequency that the times resolve.
    fn resolved(&self) -> f64 {
        1.0 / self.time[1]
    }

    /// Both responses transformed, linear between the times.
    fn sums(&self, s: Complex64) -> [Complex64; 2] {
        let mut sums = [self.response[0], self.breaks[0]].map(Complex64::from);
        let responses = self.response.windows(2).zip(self.breaks.windows(2));
        for (time, (response, breaks)) in self.time.windows(2).zip(responses) {
            let (half, middle) = (0.5 * (time[1] - time[0]), 0.5 * (time[0] + time[1]));
            let phase = s * half;
            let blur = if phase.norm() == 0.0 { Complex64::from(1.0) } else { phase.sinh() / phase };
            let factor = blur * (-s * middle).exp();
            sums[0] += (response[1] - response[0]) * factor;
            sums[1] += (breaks[1] - breaks[0]) * factor;
        }
        sums
    }

    /// ∫r dt.
    fn integral(&self) -> f64 {
        let part =
            |(time, response): (&[f64], &[f64])| 0.5 * (time[1] - time[0]) * (response[0] + response[1]);
        self.time.windows(2).zip(self.response.windows(2)).map(part).sum()
    }
}
