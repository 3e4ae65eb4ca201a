//! `[velocity_curve]`: kinetic friction against velocity.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{logarithmic, positive, size};
use crate::{Error, Result};

/// Kinetic friction at velocities evenly spaced in their logarithm, or at given ones.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    { "required": ["from", "to"] },
    { "required": ["velocities"], "not": { "required": ["points"] } }
]))]
#[non_exhaustive]
pub struct VelocityCurve {
    /// Lowest velocity of a curve of kinetic friction against velocity, above 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length/time"))]
    pub from: Option<f64>,
    /// Highest velocity.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length/time"))]
    pub to: Option<f64>,
    /// Number of velocities, evenly spaced in their logarithm, including both ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 2, "default" = 41))]
    pub points: Option<usize>,
    /// Velocities above 0, in increasing order; instead of `velocity_curve.from`, `to` and `points`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/time"))]
    pub velocities: Option<Vec<f64>>,
    /// List of temperatures, with a curve for each, instead of `contacts.temperature.energy`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0 }, "x-dimension" = "force*length"))]
    pub temperatures: Vec<f64>,
    /// Whether the critical stiffnesses at each velocity are also computed, which takes some seconds each where contacts age, and a
    /// tenth of a second with temperature alone, or a second if they re-form over a range; with `[block]` they are those for its
    /// mass and damping, and the growth rate of deviations from steady sliding is computed for its stiffness.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[schemars(extend("default" = false))]
    pub stability: bool,
}

/// Default of `points`.
const POINTS: usize = 41;

impl VelocityCurve {
    /// A curve between two velocities with the default number of points.
    pub fn between(from: f64, to: f64) -> Self {
        Self {
            from: Some(from),
            to: Some(to),
            points: None,
            velocities: None,
            temperatures: Vec::new(),
            stability: false,
        }
    }

    /// The velocities.
    pub fn velocities(&self) -> Vec<f64> {
        match (&self.velocities, self.from, self.to) {
            (Some(velocities), ..) => velocities.clone(),
            (None, Some(from), Some(to)) => logarithmic::spaced(from, to, self.points()),
            (None, ..) => Vec::new(),
        }
    }

    /// The number of velocities.
    pub fn points(&self) -> usize {
        self.velocities.as_ref().map_or(self.points.unwrap_or(POINTS), Vec::len)
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        match &self.velocities {
            Some(velocities) => self.check_given(velocities)?,
            None => logarithmic::check(end("from", self.from)?, end("to", self.to)?, self.points())?,
        }
        for (i, &energy) in self.temperatures.iter().enumerate() {
            positive(&format!("temperatures.{i}"), energy)?;
        }
        let key = if self.velocities.is_some() { "velocities" } else { "points" };
        size::check(key, self.points(), size::BYTES_PER_POINT * self.temperatures.len().max(1) as f64)
    }

    fn check_given(&self, velocities: &[f64]) -> Result<()> {
        let others =
            [("from", self.from.is_some()), ("to", self.to.is_some()), ("points", self.points.is_some())];
        if let Some((other, _)) = others.iter().find(|other| other.1) {
            let expected = "either velocities, or from and to with points";
            return Err(Error::invalid("velocities", expected, format!("velocities beside {other}")));
        }
        let mut before = 0.0;
        for (i, &velocity) in velocities.iter().enumerate() {
            let key = format!("velocities.{i}");
            positive(&key, velocity)?;
            if velocity <= before {
                return Err(Error::invalid(
                    key,
                    format!("a velocity above {before}, the one before"),
                    velocity,
                ));
            }
            before = velocity;
        }
        if velocities.is_empty() {
            return Err(Error::invalid("velocities", "one velocity or more", "none"));
        }
        Ok(())
    }
}

/// An end of the range of velocities, which must be given.
fn end(name: &str, value: Option<f64>) -> Result<f64> {
    value.ok_or_else(|| Error::invalid(name, "a velocity above 0, or velocities instead", "none"))
}
