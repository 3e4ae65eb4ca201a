//! How steady sliding answers to a small step: linear response, and the stiffness below which it is unstable.
//!
//! A slider that slides at v behind a spring K, K(X_T − X) = F, is displaced by δX e^{iωt} from steady sliding. With the
//! response r(t) of F, per length, to a small step of X at t = 0, its force changes by F̂(iω) δX e^{iωt},
//!
//! F̂(iω) = iω ∫₀^∞ r e^{−iωt} dt = r(0) + ∫₀^∞ r' e^{−iωt} dt,
//!
//! and steady sliding is neutral where K + F̂(iω) = 0: it is stable for K > K_c(v) = max −Re F̂(iω) over the ω at which
//! Im F̂ = 0, the limit −r(0) at ω → ∞ among them: there a step lowers the force by more than it relaxes the spring. At small
//! ω, F̂ ≈ iω ∫r dt = iω dF_k/dv.

use num_complex::Complex64;

use super::Transport;
use crate::Result;
use crate::contacts::Contacts;
use crate::history::{History, Piece};
use crate::monitor::Monitor;
use crate::numerics::roots::brent_root;

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

/// The step, in units of the length on which lives vary.
const STEP: f64 = 0.01;

/// Times in the longest step of the follower.
const FINER: f64 = 2.0;

/// The step is taken this much faster than the slider slides.
const FAST: f64 = 1e4;

impl Transport {
    /// The response of steady sliding at a velocity to a small step, for so many mean lives of a contact.
    ///
    /// # Errors
    /// Those of [`Transport::steady`]; a number of lives that is not above 0; stopped by the monitor.
    pub fn step_response(
        contacts: &Contacts,
        velocity: f64,
        lives: f64,
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<StepResponse> {
        super::positive("lives", lives)?;
        let mut steady = Self::steady(contacts, velocity, tolerance)?;
        steady.rough = None;
        let by = STEP * super::pace::scale(contacts);
        let during = by / (FAST * velocity);
        let duration = lives / steady.breaking_rate();
        let spacing = steady.pace.longest(velocity) / FINER;
        let count = (duration / spacing).ceil().max(1.0);
        let time: Vec<f64> = (0..=count as u32).map(|k| f64::from(k) / count * duration).collect();
        let history = History::new(vec![Piece { velocity, duration }])?;
        let mut displaced = steady.clone();
        displaced.step(by, during)?;
        let after = displaced.follow(&history, &time, monitor)?;
        let before = steady.follow(&history, &time, &mut ())?;
        let response = after.force.iter().zip(&before.force).map(|(after, before)| (after - before) / by);
        Ok(StepResponse { velocity, response: response.collect(), time })
    }
}

impl StepResponse {
    /// F̂(iω), with r straight between the times.
    pub fn at(&self, frequency: f64) -> Complex64 {
        let mut sum = Complex64::from(self.response[0]);
        for (time, response) in self.time.windows(2).zip(self.response.windows(2)) {
            let (half, middle) = (0.5 * (time[1] - time[0]), 0.5 * (time[0] + time[1]));
            let phase = frequency * half;
            let blur = if phase == 0.0 { 1.0 } else { phase.sin() / phase };
            sum += Complex64::from_polar((response[1] - response[0]) * blur, -frequency * middle);
        }
        sum
    }

    /// ∫r dt = dF_k/dv.
    pub fn integral(&self) -> f64 {
        let part =
            |(time, response): (&[f64], &[f64])| 0.5 * (time[1] - time[0]) * (response[0] + response[1]);
        self.time.windows(2).zip(self.response.windows(2)).map(part).sum()
    }

    /// K_c(v) and the ω of the oscillation that sets in there, infinite where the slider jumps; `None` where steady sliding is stable for every K > 0.
    pub fn critical_stiffness(&self) -> Option<(f64, f64)> {
        /// Frequencies looked at per e-fold.
        const PER_FOLD: f64 = 50.0;
        let (last, spacing) = (self.time[self.time.len() - 1], self.time[1]);
        let (low, high) = (1.0 / last, 1.0 / spacing);
        let count = ((high / low).ln() * PER_FOLD).ceil().max(1.0);
        let frequency = |k: u32| low * (high / low).powf(f64::from(k) / count);
        let loss = |frequency: f64| self.at(frequency).im;
        let crossings = (0..count as u32).filter_map(|k| {
            let (a, b) = (frequency(k), frequency(k + 1));
            let root = if (loss(a) > 0.0) == (loss(b) > 0.0) { None } else { brent_root(loss, a, b, 0.0) }?;
            Some((-self.at(root).re, root))
        });
        let jump = (-self.response[0], f64::INFINITY);
        crossings.chain([jump]).filter(|crossing| crossing.0 > 0.0).max_by(|a, b| a.0.total_cmp(&b.0))
    }
}
