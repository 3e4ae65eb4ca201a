//! `[velocity_curve]`: kinetic friction against velocity.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{logarithmic, positive, size};
use crate::Result;

/// Kinetic friction at velocities evenly spaced in their logarithm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VelocityCurve {
    /// Lowest velocity of a curve of kinetic friction against velocity, above 0.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length/time"))]
    pub from: f64,
    /// Highest velocity.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length/time"))]
    pub to: f64,
    /// Number of velocities, evenly spaced in their logarithm, including both ends.
    #[serde(default = "points")]
    #[schemars(extend("minimum" = 2))]
    pub points: usize,
    /// List of temperatures, with a curve for each, instead of `contacts.temperature.energy`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0 }, "x-dimension" = "force*length"))]
    pub temperatures: Vec<f64>,
    /// Whether the critical stiffnesses at each velocity are also computed, which takes about a second each; with `[block]`
    /// they are those for its mass and damping, and the growth rate of deviations from steady sliding is computed for its
    /// stiffness.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[schemars(extend("default" = false))]
    pub stability: bool,
}

fn points() -> usize {
    41
}

impl VelocityCurve {
    /// A curve between two velocities with the default number of points.
    pub fn between(from: f64, to: f64) -> Self {
        Self { from, to, points: points(), temperatures: Vec::new(), stability: false }
    }

    /// The velocities.
    pub fn velocities(&self) -> Vec<f64> {
        logarithmic::spaced(self.from, self.to, self.points)
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        logarithmic::check(self.from, self.to, self.points)?;
        for (i, &energy) in self.temperatures.iter().enumerate() {
            positive(&format!("temperatures.{i}"), energy)?;
        }
        size::check("points", self.points, size::BYTES_PER_POINT * self.temperatures.len().max(1) as f64)
    }
}
