//! Step-size control.

use crate::{Error, Float, Result};

/// First step, as a fraction of the available time.
const FIRST: f64 = 1e-3;

/// Steps shorter than this fraction of the time are lost in rounding.
const SHORTEST: f64 = 1e-15;

/// Largest growth factor of a step.
const GROW: f64 = 3.0;

/// Tolerance of the equations of the stages, as a fraction of the tolerance of a step.
const STAGE: f64 = 0.01;

/// Elementary step-size control of a method of second order: the local error is of third order in the duration, so that the
/// step is multiplied by 0.9 (error/tolerance)^{−1/3} within bounds.
#[derive(Debug, Clone, Copy)]
pub struct MotionStepControl {
    /// Tolerance of a step, a length.
    pub tolerance: f64,
    /// Duration of the next step; infinite before the first one.
    pub next: f64,
}

impl MotionStepControl {
    /// Smallest factor by which a rejected step is shortened.
    pub const SHRINK: f64 = 0.2;

    /// Control for a tolerance, a length.
    pub fn new(tolerance: f64) -> Self {
        Self { tolerance, next: f64::INFINITY }
    }

    /// Tolerance of the advances of stages, a length.
    pub fn stage_accuracy(&self) -> f64 {
        STAGE * self.tolerance
    }

    /// The first trial duration with the time `left`. A step that does not reach the end takes at most half of it.
    pub fn first(&self, left: f64) -> f64 {
        let duration = if self.next.is_finite() { self.next } else { FIRST * left };
        // Two equal steps instead of a long one and a tiny rest.
        if duration >= left { left } else { duration.min(0.5 * left) }
    }

    /// Refuses a duration that is too short to change the time.
    ///
    /// # Errors
    /// A duration lost in rounding.
    pub fn check(&self, duration: f64, left: f64, time: f64) -> Result<()> {
        if !self.is_too_short(duration, time + left) {
            return Ok(());
        }
        let (time, tolerance) = (Float(time), Float(self.tolerance));
        Err(Error::StepTooShort { what: "a slider".to_owned(), time, tolerance })
    }

    /// Whether a step is lost in the rounding of `time`.
    pub fn is_too_short(&self, duration: f64, time: f64) -> bool {
        duration < SHORTEST * time
    }

    /// The factor by which a step with this error must be shortened; `None` if it is accepted.
    pub fn shorter(&self, error: f64) -> Option<f64> {
        (error / self.tolerance > 1.0).then(|| self.factor(error).min(0.9))
    }

    /// Sets the next duration after an accepted step with this error and the time `left` at its beginning.
    pub fn accept(&mut self, error: f64, duration: f64, left: f64) {
        let longer = self.factor(error) * duration;
        // A step that was cut short by the end is no reason for a shorter next step.
        self.next = if duration < left { longer } else { self.next.max(longer) };
    }

    fn factor(&self, error: f64) -> f64 {
        (0.9 / (error / self.tolerance).cbrt()).clamp(Self::SHRINK, GROW)
    }
}
