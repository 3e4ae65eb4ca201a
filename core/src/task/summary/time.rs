//! Summary of motion in time: protocol steps with rate-and-state parameters, velocity curves and hold curves.

use crate::master::Limits;
use crate::rate_state::{
    Healing, MachineStep, MeasuredNoise, MeasuredValue, MeasuredVelocityStep, StateLaw, StateVariable,
    VelocityStep,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Extended;

/// A step of a protocol.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProtocolStep {
    /// Velocity, of a ramp at its end; 0 in a hold.
    pub velocity: f64,
    /// Velocity at the beginning of a ramp.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity_from: Option<f64>,
    /// Normal load relative to that at the start of the protocol, if it is another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_normal_load: Option<f64>,
    /// Position X at its start; of the load point beside a `[block]`.
    pub position: f64,
    /// Duration of the step.
    pub duration: f64,
    /// Number of pieces of constant velocity, if there are several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pieces: Option<usize>,
    /// Friction force at its end; force of the spring beside a `[block]`.
    pub force: f64,
    /// Highest force in the step.
    pub peak: Peak,
    /// F_k of steady sliding at its velocity; absent for holds and ramps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kinetic_friction: Option<f64>,
    /// Rate-and-state parameters of the velocity step with which it begins.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_state: Option<RateState>,
    /// Those of the compared curve; absent without points of it after the step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured: Option<MeasuredRateState>,
    /// Those of the force of the spring of a `[block]`, beside a compared curve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_state_spring: Option<SpringRateState>,
    /// Those of the compared curve, in a machine whose stiffness is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measured_spring: Option<SpringRateState>,
    /// Why the compared curve, which has points after the step, has no such parameters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub not_read: Option<String>,
}

/// A maximum of the force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Peak {
    /// The force.
    #[schemars(extend("x-dimension" = "force"))]
    pub force: f64,
    /// Position X there.
    #[schemars(extend("x-dimension" = "length"))]
    pub position: f64,
}

/// Rate-and-state parameters of a velocity step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RateState {
    /// Velocity v_0 before the step.
    pub velocity_before: f64,
    /// Force F_0 before the step, the reference for `a` and `b`.
    pub force_before: f64,
    /// Direct effect, a force per ln(v/v_0).
    pub a: f64,
    /// Evolution effect, a force per ln(v/v_0).
    pub b: f64,
    /// Characteristic slip distance D_c.
    pub distance: f64,
    /// Displacement from the step to the extremum of the force after it, where the fit begins.
    pub peak: f64,
    /// a/F_0.
    pub a_relative: f64,
    /// b/F_0.
    pub b_relative: f64,
    /// Root mean square of the residuals of the fit, a force.
    pub residual: f64,
    /// The residual relative to the range of the force from F_0 on.
    pub residual_relative: f64,
}

/// Rate-and-state parameters of a measured velocity step, with errors and 95 % intervals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuredRateState {
    /// Force F_0 before the step.
    pub force_before: MeasuredValue,
    /// Direct effect for the position of the peak, a force per ln(v/v_0).
    pub a: MeasuredValue,
    /// Evolution effect for the position of the peak, a force per ln(v/v_0).
    pub b: MeasuredValue,
    /// a − b, the change of the steady force per ln(v/v_0).
    pub a_minus_b: MeasuredValue,
    /// Characteristic slip distance D_c.
    pub distance: MeasuredValue,
    /// Displacement from the step to X_p, from which on the force relaxes, where the fit begins.
    pub peak: f64,
    /// Root mean square of the residuals of the fit, a force.
    pub residual: f64,
    /// White noise and drift, estimated from the residuals.
    pub noise: MeasuredNoise,
    /// Probability that white noise has correlations as large as those of the whitened residuals.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub whiteness: Option<f64>,
    /// Sentences about numbers that are not to be trusted.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// Rate-and-state friction behind the spring of a machine, fitted to a velocity step, with the misfit first and without errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpringRateState {
    /// Root mean square of the residuals of the fit, a force.
    pub residual: f64,
    /// The residual relative to the range of the force.
    pub residual_relative: f64,
    /// Force F_0 before the step.
    pub force_before: f64,
    /// Direct effect of the slider itself, a force per ln(V/v_0).
    pub a: f64,
    /// Evolution effects of the state variables, that of the shorter distance first.
    pub b: Vec<f64>,
    /// Their characteristic slip distances.
    pub distance: Vec<f64>,
    /// The law of the state variables.
    pub law: StateLaw,
    /// v/v_0 of the load point.
    pub ratio: f64,
    /// Stiffness K of the machine.
    pub stiffness: f64,
}

/// Limits of a velocity curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CurveLimits {
    /// Temperature of the curve, if there are several curves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<f64>,
    /// F_k as v → ∞.
    pub fast: f64,
    /// F_k as v → 0; absent if there is no plateau.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slow: Option<f64>,
    /// Viscosity F_k/v as v → 0, for contacts with a temperature.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub viscosity: Option<f64>,
}

/// Stability of steady sliding at the velocities of one or several curves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SlidingStability {
    /// Largest K_c(v), for a slider without mass and damping or for the block; 0 if sliding is always stable.
    pub critical_stiffness_sliding: Extended,
    /// Number of velocities.
    pub velocities: usize,
    /// Number of velocities at which sliding is unstable with the block; absent without a block.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unstable: Option<usize>,
}

/// Healing from a hold curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct HealingCurve {
    /// Velocity before and after the holds.
    pub velocity: f64,
    /// F_k at that velocity.
    pub kinetic_friction: f64,
    /// Growth of static friction per decade of hold time; absent for fewer than 4 holds, or if the growth is
    /// not logarithmic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub healing_per_decade: Option<f64>,
    /// That growth divided by F_k.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub healing_relative: Option<f64>,
    /// Cut-off time t_c of F_s = F_s(0) + β ln(1 + t/t_c); absent if all holds are much longer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub healing_cutoff: Option<f64>,
    /// The fitted static friction after a hold of 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_one: Option<f64>,
    /// Root mean square of the residuals of the fit, relative to the range of static friction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual_relative: Option<f64>,
}

impl ProtocolStep {
    /// The normal load in it, relative to that at the start of the protocol.
    pub fn load(&self) -> f64 {
        self.relative_normal_load.unwrap_or(1.0)
    }

    /// Whether the compared curve was read as a velocity step.
    pub fn is_measured(&self) -> bool {
        self.measured.is_some() || self.measured_spring.is_some()
    }
}

impl RateState {
    /// Parameters of a step from `velocity_before`.
    pub fn new(velocity_before: f64, read: &VelocityStep) -> Self {
        Self {
            velocity_before,
            force_before: read.before,
            a: read.direct,
            b: read.evolution,
            distance: read.distance,
            peak: read.peak,
            a_relative: read.direct / read.before,
            b_relative: read.evolution / read.before,
            residual: read.residual,
            residual_relative: read.residual_relative,
        }
    }
}

impl MeasuredRateState {
    /// The numbers of a step that was read.
    pub fn new(read: &MeasuredVelocityStep) -> Self {
        Self {
            force_before: read.before,
            a: read.direct,
            b: read.evolution,
            a_minus_b: read.steady,
            distance: read.distance,
            peak: read.peak,
            residual: read.residual,
            noise: read.noise.clone(),
            whiteness: read.whiteness,
            warnings: read.warnings(),
        }
    }
}

impl SpringRateState {
    /// The numbers of a step that was read with the spring.
    pub fn new(read: &MachineStep) -> Self {
        Self {
            residual: read.residual,
            residual_relative: read.residual_relative,
            force_before: read.before,
            a: read.direct,
            b: read.states.iter().map(|state| state.evolution).collect(),
            distance: read.states.iter().map(|state| state.distance).collect(),
            law: read.law,
            ratio: read.ratio,
            stiffness: read.stiffness,
        }
    }

    /// The fitted force at rising displacements of the load point since the step.
    pub fn forces(&self, displacement: &[f64]) -> Vec<f64> {
        let states = self.b.iter().zip(&self.distance);
        let states = states.map(|(&evolution, &distance)| StateVariable { evolution, distance }).collect();
        let step = MachineStep {
            residual: self.residual,
            residual_relative: self.residual_relative,
            direct: self.a,
            states,
            before: self.force_before,
            law: self.law,
            ratio: self.ratio,
            stiffness: self.stiffness,
        };
        step.forces(displacement)
    }
}

impl CurveLimits {
    /// Limits of the curve at `temperature`, if there are several curves, with a background force.
    pub fn new(temperature: Option<f64>, limits: &Limits, background: f64) -> Self {
        let slow = limits.slow.map(|friction| friction + background);
        Self { temperature, fast: limits.fast + background, slow, viscosity: limits.viscosity }
    }
}

impl HealingCurve {
    /// Healing relative to the kinetic friction before the holds.
    pub fn new(velocity: f64, kinetic_friction: f64, healing: Option<Healing>) -> Self {
        Self {
            velocity,
            kinetic_friction,
            healing_per_decade: healing.map(|healing| healing.per_decade),
            healing_relative: healing.map(|healing| healing.per_decade / kinetic_friction),
            healing_cutoff: healing.and_then(|healing| healing.cutoff),
            at_one: healing.map(|healing| healing.at_one),
            residual_relative: healing.map(|healing| healing.residual_relative),
        }
    }
}
