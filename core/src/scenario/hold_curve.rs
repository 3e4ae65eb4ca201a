//! `[hold_curve]`: static friction against hold time.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{logarithmic, positive, size};
use crate::Result;

/// Slide–hold–slide tests at hold times evenly spaced in their logarithm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct HoldCurve {
    /// Shortest hold time of a curve of static friction against hold time (healing), above 0.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "time"))]
    pub from: f64,
    /// Longest hold time.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "time"))]
    pub to: f64,
    /// Number of hold times, evenly spaced in their logarithm, including both ends.
    #[serde(default = "points")]
    #[schemars(extend("minimum" = 2))]
    pub points: usize,
    /// Velocity before and after the hold (slide-hold-slide), above 0: the slider slides until sliding is steady, is held,
    /// and slides again until the force has peaked.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length/time"))]
    pub velocity: f64,
}

fn points() -> usize {
    13
}

impl HoldCurve {
    /// A curve between two hold times with the default number of points; `velocity` is that before and after holds.
    pub fn between(from: f64, to: f64, velocity: f64) -> Self {
        Self { from, to, points: points(), velocity }
    }

    /// The hold times.
    pub fn holds(&self) -> Vec<f64> {
        logarithmic::spaced(self.from, self.to, self.points)
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        logarithmic::check(self.from, self.to, self.points)?;
        positive("velocity", self.velocity)?;
        size::check("points", self.points, size::BYTES_PER_POINT)
    }
}
