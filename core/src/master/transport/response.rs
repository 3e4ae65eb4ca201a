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

use num_complex::Complex64;

use super::Transport;
use super::settled::ConstantRate;
use crate::contacts::Contacts;
use crate::history::{History, Piece};
use crate::monitor::{Aside, Monitor, Part};
use crate::{Error, Result};

/// The response of the force in steady sliding to a small step of the slider.
#[derive(Debug, Clone, PartialEq)]
pub struct StepResponse {
    /// v.
    pub velocity: f64,
    /// Times t since the step, evenly spaced from 0.
    pub time: Vec<f64>,
    /// r(t), force per length; taken as 0 after the last time.
    pub response: Vec<f64>,
}

/// Size of the step, in units of the length on which lives vary.
const STEP: f64 = 0.01;

/// Number of times in the longest time step.
const FINER: f64 = 2.0;

/// Velocity of the step, in units of the sliding velocity.
const FAST: f64 = 1e4;

/// Largest number of times, in each of which all cohorts move.
const MOST: f64 = 4_194_304.0;

/// Refuses more times than can be followed: where contacts are free for very much longer than they hold.
fn fits(velocity: f64, count: f64) -> Result<()> {
    if count <= MOST {
        return Ok(());
    }
    let expected = format!(
        "one at which contacts are not free for very much longer than they hold: the response of steady sliding is followed in at most {MOST:.1e} steps"
    );
    Err(Error::invalid("velocity", expected, format!("{velocity:e}, at which it takes {count:.1e}")))
}

impl Transport {
    /// The response of steady sliding at a velocity to a small step, over `lives` mean lives of a contact; 0
    /// for time-independent contacts.
    ///
    /// # Errors
    /// Those of [`Transport::steady`]; a number of lives that is not above 0; a velocity at which contacts
    /// are free for very much longer than they hold; stopped by the monitor.
    pub fn step_response(
        contacts: &Contacts,
        velocity: f64,
        lives: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<StepResponse> {
        super::positive("lives", lives)?;
        super::positive("velocity", velocity)?;
        if !contacts.rules.are_time_dependent() {
            // Then the force of steady sliding does not depend on how the slider moves on.
            contacts.check(&super::steady::relaxed())?;
            let time = vec![0.0, contacts.thresholds.mean() / velocity];
            return Ok(StepResponse { velocity, response: vec![0.0; time.len()], time });
        }
        let viscosity = contacts.rules.free_friction.viscosity;
        if viscosity > 0.0 {
            let expected =
                "0 where the response of steady sliding is computed: a step has no limit with a viscosity";
            return Err(Error::invalid("free_friction.viscosity", expected, viscosity));
        }
        let mut steady =
            Self::steady_with(contacts, velocity, tolerance, &mut Aside { fraction: 0.0, monitor })?;
        (steady.rough, steady.constant) = (None, ConstantRate::unused());
        let by = STEP * super::step_control::scale(contacts);
        let during = by / (FAST * velocity);
        let duration = lives / steady.breaking_rate();
        let spacing = steady.pace.longest(velocity) / FINER;
        let count = (duration / spacing).ceil().max(1.0);
        fits(velocity, count)?;
        let time: Vec<f64> = (0..=count as u32).map(|k| f64::from(k) / count * duration).collect();
        let history = History::new(vec![Piece { velocity, duration }])?;
        let mut displaced = steady.clone();
        displaced.step(by, during, &mut Aside { fraction: 0.0, monitor })?;
        // Both solutions end steps at the times: their errors are then those of the same steps, and cancel.
        let after = displaced.run(&history, &time, true, &mut Part::new(monitor, 0.0, 0.5))?;
        let before = steady.run(&history, &time, true, &mut Part::new(monitor, 0.5, 0.5))?;
        let response = after.force.iter().zip(&before.force).map(|(after, before)| (after - before) / by);
        Ok(StepResponse { velocity, response: response.collect(), time })
    }
}

impl StepResponse {
    /// F̂(s), Re s ≥ 0, with r linear between the times. Beyond the frequencies that these resolve it is r(0)
    /// + ρ/s, as for |s| → ∞, with ρ from Im F̂ at the last resolved frequency.
    pub fn at(&self, s: Complex64) -> Complex64 {
        if s.norm() <= self.resolved() {
            return self.sum(s);
        }
        let last = Complex64::new(0.0, self.resolved());
        Complex64::from(self.response[0]) - last.im * self.sum(last).im / s
    }

    /// The highest frequency that the times resolve.
    pub(super) fn resolved(&self) -> f64 {
        1.0 / self.time[1]
    }

    /// Duration for which the response is known.
    pub(super) fn known(&self) -> f64 {
        self.time[self.time.len() - 1]
    }

    fn sum(&self, s: Complex64) -> Complex64 {
        let mut sum = Complex64::from(self.response[0]);
        for (time, response) in self.time.windows(2).zip(self.response.windows(2)) {
            let (half, middle) = (0.5 * (time[1] - time[0]), 0.5 * (time[0] + time[1]));
            let phase = s * half;
            let blur = if phase.norm() == 0.0 { Complex64::from(1.0) } else { phase.sinh() / phase };
            sum += (response[1] - response[0]) * blur * (-s * middle).exp();
        }
        sum
    }

    /// ∫r dt = dF_k/dv.
    pub fn integral(&self) -> f64 {
        let part =
            |(time, response): (&[f64], &[f64])| 0.5 * (time[1] - time[0]) * (response[0] + response[1]);
        self.time.windows(2).zip(self.response.windows(2)).map(part).sum()
    }
}
