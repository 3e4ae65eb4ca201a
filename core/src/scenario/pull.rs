//! `[pull]`: the base of the slider is moved, as by an infinitely stiff drive.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{TaskStart, positive, size};
use crate::{Error, Result};

/// Moves the base of the slider from X = 0 and records the force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Pull {
    /// Displacement of the slider's base.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length"))]
    pub distance: f64,
    /// Number of output positions, evenly spaced, including both ends.
    #[schemars(extend("minimum" = 2))]
    pub points: usize,
    /// Positions at which the distribution of stretches is stored, in increasing order.
    #[schemars(extend("x-dimension" = "length"))]
    pub snapshots: Vec<f64>,
    /// Positions at which the covariance of the force of `ensemble.size` contacts, or of `contacts.count`, is stored, in
    /// increasing order.
    #[schemars(extend("x-dimension" = "length"))]
    pub covariance: Vec<f64>,
    /// Also the derivatives of static and kinetic friction, relaxation length and critical stiffness by every parameter
    /// of the contacts, for the propagation of errors.
    pub derivatives: bool,
    /// `"conditional"` or `"relaxed"`: relation between initial stretches and thresholds; `"steady"`: the stretches of steady
    /// sliding, for time-independent contacts.
    pub start: TaskStart,
    /// Velocity of the slider, above 0; required for time-dependent contacts (temperature, ageing, delay), without effect
    /// for others.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length/time"))]
    pub velocity: Option<f64>,
}

impl Default for Pull {
    fn default() -> Self {
        Self {
            distance: 20.0,
            points: 2001,
            snapshots: Vec::new(),
            covariance: Vec::new(),
            derivatives: false,
            start: TaskStart::Conditional,
            velocity: None,
        }
    }
}

impl Pull {
    /// The output positions.
    pub fn positions(&self) -> Vec<f64> {
        let last = (self.points - 1) as f64;
        (0..self.points).map(|i| self.distance * (i as f64 / last)).collect()
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        positive("distance", self.distance)?;
        self.velocity.map(|velocity| positive("velocity", velocity)).transpose()?;
        if self.points < 2 {
            return Err(Error::invalid("points", "2 points or more (both ends count)", self.points));
        }
        size::check_anywhere("points", self.points, size::BYTES_PER_POINT)?;
        self.ascending("snapshots", &self.snapshots)?;
        self.ascending("covariance", &self.covariance)?;
        size::check("covariance", self.covariance.len().pow(2), size::BYTES_PER_POINT / 4.0)
    }

    /// Checks that positions lie on the pull and ascend.
    fn ascending(&self, name: &str, positions: &[f64]) -> Result<()> {
        let mut previous = f64::NEG_INFINITY;
        for (i, &position) in positions.iter().enumerate() {
            let key = format!("{name}.{i}");
            if !(0.0..=self.distance).contains(&position) {
                let expected = format!("a position from 0 to the distance {}", self.distance);
                return Err(Error::invalid(key, expected, position));
            }
            if position <= previous {
                return Err(Error::invalid(
                    key,
                    format!("a position above {previous}, the one before"),
                    position,
                ));
            }
            previous = position;
        }
        Ok(())
    }
}
