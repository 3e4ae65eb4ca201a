//! `[stability]`: whether a slider sticks and slips.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{positive, size};
use crate::{Error, Result};

/// Stick-slip of a block behind its spring and behind others: none, transient or persistent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Stability {
    /// Velocities of the load point, above 0; required for time-dependent contacts (temperature, ageing), without effect for
    /// others.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("default" = [], "items" = { "type": "number", "exclusiveMinimum": 0 }, "x-dimension" = "length/time"))]
    pub velocities: Vec<f64>,
    /// Stiffnesses of springs, for a map of stick-slip over them and the velocities; without this key that of `[block]`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[schemars(extend("default" = [], "items" = { "type": "number", "exclusiveMinimum": 0 }, "x-dimension" = "force/length"))]
    pub stiffnesses: Vec<f64>,
    /// The two stiffnesses that enclose the end of persistent stick-slip have a ratio up to 1 plus this number; from 1e-4 to 1.
    #[schemars(extend("minimum" = 1e-4, "maximum" = 1, "x-dimension" = "1"))]
    pub resolution: f64,
    /// Number of simulations with different single contacts, beside the master equation; 1 or more. Requires `[ensemble]`,
    /// whose `size` is the number of contacts of each simulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1, "default" = 10))]
    pub simulations: Option<usize>,
}

impl Stability {
    /// Default of `resolution`.
    pub const RESOLUTION: f64 = 0.02;

    /// Default of `simulations`, with an ensemble.
    pub const SIMULATIONS: usize = 10;

    /// Number of simulations, where there is an ensemble.
    pub fn simulations(&self) -> usize {
        self.simulations.unwrap_or(Self::SIMULATIONS)
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        for (name, values) in [("velocities", &self.velocities), ("stiffnesses", &self.stiffnesses)] {
            for (i, &value) in values.iter().enumerate() {
                positive(&format!("{name}.{i}"), value)?;
            }
            size::check(name, values.len(), size::BYTES_PER_POINT)?;
        }
        if !(1e-4..=1.0).contains(&self.resolution) {
            return Err(Error::invalid("resolution", "a number from 1e-4 to 1", self.resolution));
        }
        if self.simulations == Some(0) {
            return Err(Error::invalid("simulations", "1 simulation or more", 0));
        }
        size::check("simulations", self.simulations(), size::BYTES_PER_POINT)
    }
}

impl Default for Stability {
    fn default() -> Self {
        Self {
            velocities: Vec::new(),
            stiffnesses: Vec::new(),
            resolution: Self::RESOLUTION,
            simulations: None,
        }
    }
}
