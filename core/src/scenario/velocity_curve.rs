//! `[velocity_curve]`: the force of steady sliding against the velocity.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{logarithmic, positive, size};
use crate::Result;

/// Kinetic friction at velocities from one to another, evenly spaced in their logarithm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VelocityCurve {
    /// Lowest velocity of a curve of kinetic friction against velocity, above 0.
    pub from: f64,
    /// Highest velocity.
    pub to: f64,
    /// Number of velocities, evenly spaced in their logarithm, including both ends.
    #[serde(default = "points")]
    pub points: usize,
    /// List of temperatures, with a curve for each, instead of `contacts.temperature.energy`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
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
    /// That between two velocities, at the default number of points.
    pub fn between(from: f64, to: f64) -> Self {
        Self { from, to, points: points(), temperatures: Vec::new(), stability: false }
    }

    /// The velocities.
    pub fn velocities(&self) -> Vec<f64> {
        logarithmic::spaced(self.from, self.to, self.points)
    }

    /// Whether every value is valid.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self) -> Result<()> {
        logarithmic::check(self.from, self.to, self.points)?;
        for (i, &energy) in self.temperatures.iter().enumerate() {
            positive(&format!("temperatures.{i}"), energy)?;
        }
        size::check("points", self.points, size::BYTES_PER_POINT * self.temperatures.len().max(1) as f64)
    }
}
