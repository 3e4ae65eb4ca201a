//! The motion during a time step.

use serde::{Deserialize, Serialize};

/// Nodes of the two-point Gauss rule on [0, 1].
pub(super) const GAUSS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];

/// Where the contacts of a cohort are: at one stretch, or spread evenly over a cell around it.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Place {
    pub(super) stretch: f64,
    /// Extent of the cell below the stretch.
    pub(super) below: f64,
    /// Extent of the cell above the stretch.
    pub(super) above: f64,
    pub(super) age: f64,
}

impl Place {
    /// Whether all have one stretch.
    pub(super) fn is_point(&self) -> bool {
        self.below + self.above == 0.0
    }
}

/// Motion at constant velocity over the distance `by`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Path {
    pub(super) duration: f64,
    pub(super) by: f64,
}

/// A part of a step that a cohort covers at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StepPart {
    /// To the middle.
    First,
    /// From the middle to the end.
    Second,
    /// From the first node of the two-point Gauss rule to the end.
    Early,
    /// From the second node to the end.
    Late,
}

impl StepPart {
    /// Its ends, as fractions of the step.
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

    /// X(to) − X(from), for fractions of the step.
    pub(super) fn advance(&self, from: f64, to: f64) -> f64 {
        (to - from) * self.by
    }

    /// Duration of a part.
    pub(super) fn time(&self, part: StepPart) -> f64 {
        let (from, to) = part.ends();
        (to - from) * self.duration
    }
}
