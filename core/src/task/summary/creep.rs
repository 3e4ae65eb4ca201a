//! The numbers of creep under constant forces.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The numbers of creep under constant forces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CreepNumbers {
    /// Creep under each force, in the order of the scenario.
    pub creep: Vec<CreepAtForce>,
}

/// Creep under a constant force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CreepAtForce {
    /// The force.
    #[schemars(extend("x-dimension" = "force"))]
    pub force: f64,
    /// Time to failure; 0 if the contacts never carry the force; absent if the slider does not fail within the duration.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "time"))]
    pub failure_time: Option<f64>,
    /// Its estimated error: the difference from a solution with a larger tolerance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "time"))]
    pub failure_time_error: Option<f64>,
    /// Position X at the end of loading.
    #[schemars(extend("x-dimension" = "length"))]
    pub loaded_position: f64,
    /// Position X at failure, or at the end.
    #[schemars(extend("x-dimension" = "length"))]
    pub final_position: f64,
    /// Velocity at the end; absent if the slider fails.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/time"))]
    pub final_velocity: Option<f64>,
    /// Lowest velocity after loading, that of secondary creep if failure follows; absent if the slider fails during loading.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/time"))]
    pub slowest_velocity: Option<f64>,
    /// Its time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "time"))]
    pub slowest_time: Option<f64>,
}
