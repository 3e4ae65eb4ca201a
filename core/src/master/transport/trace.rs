//! Readings of contacts followed through time.

use super::dense_output::Reading;
use crate::Result;
use crate::contacts::FreeFriction;
use crate::master::Tolerance;

/// Results at given times. At simultaneous breaks the force is that after the break.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct Trace {
    /// Time t.
    pub time: Vec<f64>,
    /// Position X.
    pub position: Vec<f64>,
    /// Velocity, from the right.
    pub velocity: Vec<f64>,
    /// Force F.
    pub force: Vec<f64>,
    /// Breaking rate, a fraction of contacts per time, without simultaneous breaks.
    pub breaking_rate: Vec<f64>,
    /// The fraction of free contacts.
    pub free: Vec<f64>,
    /// Normal load relative to that at the start. Where it steps there are two readings at one time, before and after the step.
    pub relative_normal_load: Vec<f64>,
    /// Estimate of the largest error of F, on the safe side: the difference to F at sixteen times the
    /// tolerance.
    pub error: f64,
}

impl Trace {
    /// The readings at these times, which are times of the trace.
    pub(crate) fn at(&self, times: &[f64]) -> Self {
        let places = |time: &f64| {
            let first = self.time.partition_point(|t| t < time).min(self.time.len() - 1);
            first..self.time.partition_point(|t| t <= time).max(first + 1)
        };
        let places: Vec<usize> = times.iter().flat_map(places).collect();
        let of = |values: &[f64]| places.iter().map(|&i| values[i]).collect();
        Self {
            time: of(&self.time),
            position: of(&self.position),
            velocity: of(&self.velocity),
            force: of(&self.force),
            breaking_rate: of(&self.breaking_rate),
            free: of(&self.free),
            relative_normal_load: of(&self.relative_normal_load),
            error: self.error,
        }
    }

    /// Refuses a trace whose estimated error exceeds the required one of F/(N_c⟨k⟩) per mean threshold;
    /// `unit` is N_c⟨k⟩ × the mean threshold.
    ///
    /// # Errors
    /// [`crate::Error::Accuracy`].
    pub fn check(&self, unit: f64, required: Option<f64>) -> Result<()> {
        let what = || "the force of contacts followed through time".to_owned();
        required.map_or(Ok(()), |required| Tolerance::from(required).allows(self.error / unit, what))
    }

    /// Adds a reading, whose force is in units of `stiffness`, with the `friction` of free contacts.
    pub(super) fn push(
        &mut self,
        (time, position): (f64, f64),
        velocity: f64,
        reading: Reading,
        (stiffness, friction): (f64, FreeFriction),
    ) {
        self.time.push(time);
        self.position.push(position);
        self.velocity.push(velocity);
        self.force.push(stiffness * reading.force + reading.free * friction.at(velocity));
        self.breaking_rate.push(reading.rate);
        self.free.push(reading.free);
        self.relative_normal_load.push(1.0);
    }
}
