//! Rate-and-state parameters from friction curves: direct effect, evolution effect and critical distance of a
//! velocity step, healing rate of slide–hold–slide tests.
//!
//! Rate-and-state friction (J. H. Dieterich, J. Geophys. Res. 84, 2161 (1979); A. Ruina, J. Geophys. Res. 88,
//! 10359 (1983)) describes the force after the velocity jumps from v₀ to v by
//!
//! F(X) = F₀ + a ln(v/v₀) − b ln(v/v₀) (1 − e^{−(X − X_p)/D_c}),
//!
//! and static friction after a hold of duration t by
//!
//! F_s(t) = F_s(0) + β ln(1 + t/t_c),
//!
//! which heals by β ln 10 per factor of ten in hold time for t ≫ t_c.
//!
//! Computed curves ([`VelocityStep`], [`Healing`]) have no noise: what a fit leaves is the difference between
//! the curve and the equation, and is stated as a residual, not as errors of the parameters. So is that of a
//! step behind the spring of a machine, solved with it ([`MachineStep`]), and of slide–hold–slide tests behind it
//! ([`MachineHealing`]). Measured curves
//! ([`MeasuredVelocityStep`], [`MeasuredHealing`]) have errors and intervals that follow from their noise
//! ([`MeasuredNoise`]).

mod drift;
mod generalised;
mod healing;
mod levenberg_marquardt;
mod machine_healing;
mod machine_step;
mod measured_healing;
mod measured_velocity_step;
mod separable;
mod spring_friction;
mod velocity_step;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

pub use drift::{MeasuredNoise, OrnsteinUhlenbeck};
pub use healing::Healing;
pub use machine_healing::{HoldTests, MachineHealing};
pub use machine_step::MachineStep;
pub use measured_healing::MeasuredHealing;
pub use measured_velocity_step::{MeasuredVelocityStep, StepReading};
pub use spring_friction::{StateLaw, StateVariable};
pub use velocity_step::VelocityStep;

/// An estimated number with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Fitted {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
}

/// A parameter of a measured curve, with its standard error and its 95 % interval.
///
/// The error is that of the linearised fit. The interval is that of the profile likelihood: the values for
/// which χ², minimised over all other parameters, exceeds its minimum by at most t², with the quantile t of
/// Student's distribution. It need not be symmetric. Where that of D_c or t_c has no upper end, those of parameters that grow
/// with it without limit have none on that side either.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MeasuredValue {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// Lower end of the interval; `None` if it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low: Option<f64>,
    /// Upper end of the interval; `None` if it has none: any larger D_c or t_c fits as well.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub high: Option<f64>,
}

/// The smallest and the largest of some values.
fn extent<'a>(values: impl IntoIterator<Item = &'a f64>) -> (f64, f64) {
    let values = values.into_iter();
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)))
}

impl MeasuredValue {
    /// The same with an interval that contains that of another one.
    fn widened(self, other: Self) -> Self {
        let end = |own: Option<f64>, other: Option<f64>, of: fn(f64, f64) -> f64| Some(of(own?, other?));
        Self { low: end(self.low, other.low, f64::min), high: end(self.high, other.high, f64::max), ..self }
    }
}
