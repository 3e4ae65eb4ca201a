//! `[master_equation]`: how accurately it is solved.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Error, Result};

/// How the master equation is solved.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MasterEquation {
    /// Error allowed in the force per contact and per ⟨k⟩x̄, from 1e-12 to 1e-2.
    pub tolerance: f64,
}

impl Default for MasterEquation {
    fn default() -> Self {
        Self { tolerance: 1e-10 }
    }
}

impl MasterEquation {
    /// Whether every value makes sense.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self) -> Result<()> {
        if (1e-12..=1e-2).contains(&self.tolerance) {
            return Ok(());
        }
        Err(Error::invalid("tolerance", "a number from 1e-12 to 1e-2", format!("{:e}", self.tolerance)))
    }
}
