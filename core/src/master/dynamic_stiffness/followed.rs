//! The response of steady sliding to a small step, followed in time, with straight lines between the times.

use num_complex::Complex64;

use super::{ImmediateResponse, beyond};

/// A response in time.
#[derive(Debug, Clone)]
pub(super) struct FollowedResponse {
    /// Times t since the step, evenly spaced from 0.
    time: Vec<f64>,
    /// r(t), force per length; taken as 0 after the last time.
    response: Vec<f64>,
    /// Fraction of contacts that have broken until then because of the step, per length.
    breaks: Vec<f64>,
}

/// Time-independent contacts: the force of steady sliding does not depend on how the slider moves on, and a step breaks as many
/// contacts as the same distance of steady sliding.
#[derive(Debug, Clone)]
pub(super) struct NoResponse {
    /// Fraction of contacts that breaks per length.
    pub(super) breaks: f64,
    pub(super) duration: f64,
}

impl FollowedResponse {
    /// Of times, r and breaks.
    pub(super) fn new([time, response, breaks]: [Vec<f64>; 3]) -> Self {
        Self { time, response, breaks }
    }

    /// Both responses transformed, linear between the times.
    fn sums(&self, s: Complex64) -> [Complex64; 2] {
        let mut sums = self.at_once().map(Complex64::from);
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
}

impl ImmediateResponse for FollowedResponse {
    fn transforms(&self, s: Complex64) -> [Complex64; 2] {
        let highest = self.highest();
        if s.norm() <= highest {
            return self.sums(s);
        }
        beyond(s, highest, self.at_once(), self.sums(Complex64::new(0.0, highest)))
    }

    fn at_once(&self) -> [f64; 2] {
        [self.response[0], self.breaks[0]]
    }

    fn integrals(&self) -> [f64; 2] {
        let part =
            |(time, response): (&[f64], &[f64])| 0.5 * (time[1] - time[0]) * (response[0] + response[1]);
        let force = self.time.windows(2).zip(self.response.windows(2)).map(part).sum();
        [force, self.breaks[self.breaks.len() - 1]]
    }

    fn highest(&self) -> f64 {
        1.0 / self.time[1]
    }

    fn duration(&self) -> f64 {
        self.time[self.time.len() - 1]
    }
}

impl ImmediateResponse for NoResponse {
    fn transforms(&self, _s: Complex64) -> [Complex64; 2] {
        [Complex64::ZERO, self.breaks.into()]
    }

    fn at_once(&self) -> [f64; 2] {
        [0.0, self.breaks]
    }

    fn integrals(&self) -> [f64; 2] {
        [0.0, self.breaks]
    }

    fn highest(&self) -> f64 {
        1.0 / self.duration
    }

    fn duration(&self) -> f64 {
        self.duration
    }
}
