//! What is quoted of motion in time: steps, their reading by rate and state, curves against velocity and hold time.

use crate::master::Limits;
use crate::rate_state::{Fitted, Healing, VelocityStep};
use serde::{Deserialize, Serialize};

use super::Extended;

/// A step of a protocol.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ProtocolStep {
    /// Velocity at its end; 0 in a hold.
    pub velocity: f64,
    /// Position X at its start.
    pub position: f64,
    /// How long it took.
    pub duration: f64,
    /// Pieces of constant velocity that it was made of, if more than one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pieces: Option<usize>,
    /// Friction force at its end.
    pub force: f64,
    /// Highest force in it, and the position there.
    pub peak: Peak,
    /// F_k of steady sliding at its velocity; absent in holds and ramps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kinetic_friction: Option<f64>,
    /// The step of the velocity with which it begins, in the words of rate and state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_state: Option<RateState>,
}

/// A highest force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// The force.
    pub force: f64,
    /// Position X there.
    pub position: f64,
}

/// A step of the velocity in the words of rate and state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RateState {
    /// v_0, the velocity before the step.
    pub velocity_before: f64,
    /// F_0, the force before the step, to which `a` and `b` are to be compared.
    pub force_before: f64,
    /// Direct effect, a force per ln(v/v_0).
    pub a: Fitted,
    /// Evolution effect, a force per ln(v/v_0).
    pub b: Fitted,
    /// D_c.
    pub distance: Fitted,
    /// Way from the step to the force's extremum after it, from which the fit begins.
    pub peak: f64,
    /// a/F_0.
    pub a_relative: f64,
    /// b/F_0.
    pub b_relative: f64,
    /// Root mean square of what the fit leaves over.
    pub residual: f64,
}

/// What a velocity curve tends to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CurveLimits {
    /// The temperature, where there are several curves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// F_k as v → ∞.
    pub fast: f64,
    /// F_k as v → 0; absent where there is no plateau.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slow: Option<f64>,
    /// F_k/v as v → 0, of thermal contacts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity: Option<f64>,
}

/// Whether steady sliding is stable at the velocities of a curve, or of several.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    /// The largest K_c(v), of a slider without mass and damping or of the block; 0 where every spring is stiff enough.
    pub critical_stiffness_sliding: Extended,
    /// Number of velocities.
    pub velocities: usize,
    /// At how many of them deviations grow behind the block; absent where there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unstable: Option<usize>,
}

/// What a hold curve says.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HealingCurve {
    /// Velocity before and after the holds.
    pub velocity: f64,
    /// F_k there.
    pub kinetic_friction: f64,
    /// Growth of static friction per factor of ten in hold time, where that is logarithmic; absent for fewer than 4 holds,
    /// and where it is not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub healing_per_decade: Option<Fitted>,
    /// The same over F_k.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub healing_relative: Option<f64>,
    /// The hold time t_c from which on it is, F_s = F_s(0) + β ln(1 + t/t_c); absent where all holds are much longer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub healing_cutoff: Option<Fitted>,
    /// The fitted static friction after a hold of 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_one: Option<f64>,
}

impl RateState {
    /// A reading of a step from `velocity_before`.
    pub fn new(velocity_before: f64, read: &VelocityStep) -> Self {
        Self {
            velocity_before,
            force_before: read.before,
            a: read.direct,
            b: read.evolution,
            distance: read.distance,
            peak: read.peak,
            a_relative: read.direct.value / read.before,
            b_relative: read.evolution.value / read.before,
            residual: read.residual,
        }
    }
}

impl CurveLimits {
    /// Limits of the curve at a temperature, if there are several.
    pub fn new(temperature: Option<f64>, limits: &Limits) -> Self {
        Self { temperature, fast: limits.fast, slow: limits.slow, viscosity: limits.viscosity }
    }
}

impl HealingCurve {
    /// What static friction after holds tells beside the kinetic friction before them.
    pub fn new(velocity: f64, kinetic_friction: f64, healing: Option<Healing>) -> Self {
        Self {
            velocity,
            kinetic_friction,
            healing_per_decade: healing.map(|healing| healing.per_decade),
            healing_relative: healing.map(|healing| healing.per_decade.value / kinetic_friction),
            healing_cutoff: healing.and_then(|healing| healing.cutoff),
            at_one: healing.map(|healing| healing.at_one.value),
        }
    }
}
