//! `[units]`: labels, never conversions.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Names of the units in which the scenario is written; numbers are never converted.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Units {
    /// Unit of length, such as `µm`; dimensionless by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub length: Option<String>,
    /// Unit of force, such as `mN`; dimensionless by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<String>,
    /// Unit of time, such as `s`; dimensionless by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<String>,
}

impl Units {
    /// Whether no unit is named.
    pub fn is_dimensionless(&self) -> bool {
        *self == Self::default()
    }
}
