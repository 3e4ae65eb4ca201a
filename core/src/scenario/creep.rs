//! `[creep]`: slip under a constant force, and the time to failure.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{positive, size};
use crate::{Error, Result};

/// Creep under constant forces, one after the other on contacts that begin alike, each up to the failure of the slider.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[non_exhaustive]
pub struct Creep {
    /// Constant forces on the slider, above 0: it creeps under each of them on contacts that begin alike, until it fails.
    #[schemars(extend("minItems" = 1, "items" = { "type": "number", "exclusiveMinimum": 0 }, "x-dimension" = "force"))]
    pub forces: Vec<f64>,
    /// Time from the start, above 0, after which a motion without failure ends.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "time"))]
    pub duration: f64,
    /// Rate at which a force is raised at the start, force per time, above 0; without it, at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force/time"))]
    pub loading_rate: Option<f64>,
    /// Number of points of each creep curve, evenly spaced in slip from the end of loading on, including both ends.
    #[serde(default = "points")]
    #[schemars(extend("minimum" = 2))]
    pub points: usize,
}

fn points() -> usize {
    201
}

impl Creep {
    /// Creep under these forces, raised at once, with the default number of points.
    pub fn under(forces: Vec<f64>, duration: f64) -> Self {
        Self { forces, duration, loading_rate: None, points: points() }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        if self.forces.is_empty() {
            return Err(Error::invalid("forces", "one force or more", "none"));
        }
        for (i, &force) in self.forces.iter().enumerate() {
            positive(&format!("forces.{i}"), force)?;
        }
        positive("duration", self.duration)?;
        self.loading_rate.map(|rate| positive("loading_rate", rate)).transpose()?;
        if self.points < 2 {
            return Err(Error::invalid("points", "2 points or more (both ends count)", self.points));
        }
        let all = self.points.saturating_mul(self.forces.len());
        size::check("points", all, size::BYTES_PER_POINT)
    }
}
