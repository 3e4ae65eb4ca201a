//! The friction force of free contacts.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The friction force of a free contact, which slides: f + ηv against the motion at the velocity v, and at rest what the balance
/// of forces asks for, up to f.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FreeFriction {
    /// Friction force f of a free contact, 0 or above, against the motion.
    #[schemars(extend("minimum" = 0, "x-dimension" = "force"))]
    pub force: f64,
    /// Viscosity η of a free contact, a force per velocity, 0 or above.
    #[schemars(extend("minimum" = 0, "x-dimension" = "force*time/length"))]
    pub viscosity: f64,
}

impl FreeFriction {
    /// Whether free contacts carry nothing.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// The same of this number of contacts.
    #[must_use]
    pub fn scaled(self, number: f64) -> Self {
        Self { force: number * self.force, viscosity: number * self.viscosity }
    }

    /// The force at a velocity; at rest as after a motion forward.
    pub fn at(&self, velocity: f64) -> f64 {
        (if velocity < 0.0 { -self.force } else { self.force }) + self.viscosity * velocity
    }
}
