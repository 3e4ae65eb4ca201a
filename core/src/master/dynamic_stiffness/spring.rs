//! The linear response of contacts behind a spring without mass and damping.
//!
//! A displacement δX_T e^{st} of the load point changes position and force by δX = K/(K + F̂) δX_T and δF = KF̂/(K + F̂) δX_T.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::reattachment::Reattachment;
use super::{DynamicStiffness, PHASE};
use crate::error::positive;
use crate::monitor::{Monitor, Watch};
use crate::{Error, Result};

/// The motion after a small change of the velocity of the load point, per change of the velocity.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SpringResponse {
    /// δX/δV, a time: the change of the position of the slider relative to its steady motion.
    pub position: Vec<f64>,
    /// δF/δV, force per velocity.
    pub force: Vec<f64>,
}

/// Frequencies of the transform into time: from and to, in units of v over the mean threshold, and their number without a delay.
const FREQUENCIES: (f64, f64, u32) = (1e-3, 300.0, 400);

/// Most frequencies, each of which takes a millisecond.
const MOST: f64 = 1e4;

impl DynamicStiffness {
    /// The dynamic stiffness KF̂/(K + F̂) of contacts and a spring K in series: the change of the force per displacement
    /// δX_T e^{st} of the load point.
    pub fn behind(&self, stiffness: f64, s: Complex64) -> Complex64 {
        let contacts = self.at(s);
        stiffness * contacts / (stiffness + contacts)
    }

    /// The motion of steady sliding behind a spring K without mass and damping after a small change δV of the load-point
    /// velocity, at `times` since then.
    ///
    /// δF/δV = (2/π) ∫₀^∞ Im[KF̂/(K + F̂)] sin(ωt)/ω² dω, by Filon's rule to some 1e-3 of its largest value; K must be above the
    /// critical stiffness. The square of δV/v is left out.
    ///
    /// # Errors
    /// A stiffness that is not a finite number above 0; a delay too long for the frequencies to resolve; stopped by the monitor.
    pub fn after_velocity_change(
        &self,
        stiffness: f64,
        times: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<SpringResponse> {
        positive("stiffness", stiffness)?;
        let watch = Watch::new(monitor);
        let mut frequencies = self.frequencies_of_transform()?;
        let part = |frequency: f64| {
            watch.value(|| self.behind(stiffness, Complex64::new(0.0, frequency)).im / frequency)
        };
        let parts: Vec<f64> = frequencies.iter().map(|&frequency| part(frequency)).collect();
        watch.check()?;
        // The pole at ω = 0, dF_k/dv/ω, is that of an exponential approach, in closed form; the rest is regular.
        let (steady, corner) = (parts[0], self.velocity / self.length);
        let rest = |(frequency, part): (&f64, &f64)| {
            (part - steady / (1.0 + (frequency / corner).powi(2))) / frequency
        };
        let mut rests: Vec<f64> = frequencies.iter().zip(&parts).map(rest).collect();
        frequencies.insert(0, 0.0);
        rests.insert(0, 0.0);
        let force_at = |&time: &f64| {
            let cells = frequencies.windows(2).zip(rests.windows(2));
            let sum: f64 = cells.map(|(ends, values)| filon(ends, values, time)).sum();
            2.0 / PI * sum - steady * (-corner * time).exp_m1()
        };
        let force: Vec<f64> = times.iter().map(force_at).collect();
        let position = times.iter().zip(&force).map(|(time, force)| time - force / stiffness).collect();
        Ok(SpringResponse { position, force })
    }

    /// Angular frequencies between which F̂ is smooth.
    fn frequencies_of_transform(&self) -> Result<Vec<f64>> {
        let (low, high, count) = FREQUENCIES;
        let unit = self.velocity / self.length;
        let delay = self.reattachment.as_ref().map_or(0.0, Reattachment::delay);
        let needed = unit * high * delay / PHASE;
        if needed > MOST {
            let expected = format!(
                "at most {} at this velocity, so that the frequencies resolve it",
                MOST / needed * delay
            );
            return Err(Error::invalid("delay", expected, delay));
        }
        let sparse = (0..=count).map(|i| unit * low * (high / low).powf(f64::from(i) / f64::from(count)));
        let mut frequencies: Vec<f64> = Vec::new();
        for next in sparse {
            let last = frequencies.last().copied().unwrap_or(next);
            let parts = ((next - last) * delay / PHASE).ceil().max(1.0);
            frequencies.extend((1..=parts as u32).map(|i| last + f64::from(i) / parts * (next - last)));
        }
        Ok(frequencies)
    }
}

/// ∫ f sin(ωt) dω over an interval on which f is linear.
fn filon(ends: &[f64], values: &[f64], time: f64) -> f64 {
    let (half, middle) = (0.5 * (ends[1] - ends[0]), 0.5 * (ends[0] + ends[1]));
    let (mean, tilt) = (0.5 * (values[0] + values[1]), 0.5 * (values[1] - values[0]));
    let phase = half * time;
    let (sine, cosine) = (middle * time).sin_cos();
    // ∫ cos and ∫ u sin over u from −1 to 1, by series where they would lose digits.
    let (even, odd) = if phase.abs() < 1e-2 {
        (2.0 - phase * phase / 3.0, 2.0 * phase / 3.0)
    } else {
        (2.0 * phase.sin() / phase, 2.0 * (phase.sin() / phase - phase.cos()) / phase)
    };
    half * (mean * sine * even + tilt * cosine * odd)
}
