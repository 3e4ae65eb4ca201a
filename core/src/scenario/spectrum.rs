//! `[spectrum]`: the noise of the force in steady sliding.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{positive, size};
use crate::{Error, Result};

/// Spectrum and autocovariance of the force of a finite number of contacts in steady sliding.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[non_exhaustive]
pub struct Spectrum {
    /// Largest wave number, in radians per length; without it the fifth multiple of 2π over the mean displacement between
    /// breaks of a contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "1/length"))]
    pub highest: Option<f64>,
    /// Largest displacement of the autocovariance; without it ten times the mean displacement between breaks.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length"))]
    pub displacement: Option<f64>,
    /// Number of wave numbers and of displacements, evenly spaced from 0, including both ends.
    #[schemars(extend("minimum" = 2))]
    pub points: usize,
    /// Velocity of the slider, above 0; required for time-dependent contacts (temperature, ageing), without effect for
    /// others.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length/time"))]
    pub velocity: Option<f64>,
}

impl Default for Spectrum {
    fn default() -> Self {
        Self { highest: None, displacement: None, points: 1001, velocity: None }
    }
}

impl Spectrum {
    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        for (name, value) in
            [("highest", self.highest), ("displacement", self.displacement), ("velocity", self.velocity)]
        {
            value.map(|value| positive(name, value)).transpose()?;
        }
        if self.points < 2 {
            return Err(Error::invalid("points", "2 points or more (both ends count)", self.points));
        }
        size::check_anywhere("points", self.points, size::BYTES_PER_POINT)
    }
}
