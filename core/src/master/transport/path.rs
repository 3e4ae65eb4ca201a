//! The slider's way during a step.

use super::trial::GAUSS;

/// Motion at one velocity during a step, `by` a length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Path {
    pub(super) duration: f64,
    pub(super) by: f64,
}

/// A part of a step that a cohort goes in one go.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StepPart {
    /// To the middle.
    First,
    /// From the middle to the end.
    Second,
    /// To the end, from the first point of the two-point Gauss rule …
    Early,
    /// … and from the second.
    Late,
}

impl StepPart {
    /// The fractions between which it lies.
    pub(super) fn ends(self) -> (f64, f64) {
        match self {
            Self::First => (0.0, 0.5),
            Self::Second => (0.5, 1.0),
            Self::Early => (GAUSS[0], 1.0),
            Self::Late => (GAUSS[1], 1.0),
        }
    }
}

impl Path {
    /// Motion at one velocity.
    pub(super) fn steady(velocity: f64, duration: f64) -> Self {
        Self { duration, by: velocity * duration }
    }

    /// X(to) − X(from).
    pub(super) fn advance(&self, from: f64, to: f64) -> f64 {
        (to - from) * self.by
    }

    /// How long a part lasts.
    pub(super) fn time(&self, part: StepPart) -> f64 {
        let (from, to) = part.ends();
        (to - from) * self.duration
    }
}
