//! Step-size control.

use crate::{Error, Float, Result};

/// The first step, as a fraction of what it may be.
const FIRST: f64 = 1e-3;

/// Steps shorter than this fraction of the time are rounded away.
const SHORTEST: f64 = 1e-15;

/// The largest factor by which a step grows.
const GROW: f64 = 3.0;

/// Equations of stages are solved to this fraction of the tolerance.
const STAGE: f64 = 0.01;

/// Step-size control of a method of second order, whose local error is of third order in the duration.
#[derive(Debug, Clone, Copy)]
pub struct MotionStepControl {
    /// The length to which a step is right.
    pub tolerance: f64,
    /// How long the next step may be; infinite before the first one.
    pub next: f64,
}

impl MotionStepControl {
    /// The least factor by which a step shrinks that is tried again.
    pub const SHRINK: f64 = 0.2;

    /// For steps that are right to a length.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, next: f64::INFINITY }
    }

    /// The length to which advances of stages are wanted.
    pub fn stage_accuracy(&self) -> f64 {
        STAGE * self.tolerance
    }

    /// The duration to try first where so much is left. A step that does not reach the end leaves at least as much again.
    pub fn first(&self, left: f64) -> f64 {
        let duration = if self.next.is_finite() { self.next } else { FIRST * left };
        if duration >= left { left } else { duration.min(0.5 * left) }
    }

    /// Whether a step of a duration is long enough to change the time at all.
    ///
    /// # Errors
    /// It is not.
    pub fn check(&self, duration: f64, left: f64, time: f64) -> Result<()> {
        if !self.is_too_short(duration, time + left) {
            return Ok(());
        }
        let (reached, wanted) = (Float(f64::NAN), Float(self.tolerance));
        Err(Error::Accuracy { key: String::new(), what: format!("a slider at t = {time}"), reached, wanted })
    }

    /// Whether a step cannot be shortened further, beside this time.
    pub fn is_too_short(&self, duration: f64, time: f64) -> bool {
        duration < SHORTEST * time
    }

    /// The factor by which a step of this error has to be shortened, if it has to be.
    pub fn shorter(&self, error: f64) -> Option<f64> {
        (error / self.tolerance > 1.0).then(|| self.factor(error).min(0.9))
    }

    /// A step of this error is taken, where so much was left.
    pub fn accept(&mut self, error: f64, duration: f64, left: f64) {
        let longer = self.factor(error) * duration;
        // A step that was cut short by the end tells nothing against longer ones.
        self.next = if duration < left { longer } else { self.next.max(longer) };
    }

    fn factor(&self, error: f64) -> f64 {
        (0.9 / (error / self.tolerance).cbrt()).clamp(Self::SHRINK, GROW)
    }
}
