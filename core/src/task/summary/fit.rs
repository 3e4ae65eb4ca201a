//! What a fit has found.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Extended, PosteriorSummary};
use crate::fit::{Correlation, Misfit};
use crate::scenario::FitSource;

/// What a fit has found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitSummary {
    /// Whether the search has converged; otherwise the values are the last ones.
    pub converged: bool,
    /// Number of readings, after averaging.
    pub readings: usize,
    /// Solutions of the master equation that the search took.
    pub solutions: usize,
    /// The estimates, those of the sizes of errors last.
    pub numbers: Vec<FitNumber>,
    /// The numbers that were not free: those of the contacts, and those of the machine that are not 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fixed: Vec<FitFixed>,
    /// Standard deviation of the independent error of a reading; the root mean square of errors that are given one by one.
    pub reading: f64,
    /// Displacement of the slider up to the last reading, of each curve; none of forces at several velocities.
    pub distances: Vec<f64>,
    /// How well the curve is described; absent for a measurement that is only planned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub misfit: Option<Misfit>,
    /// Covariance of the errors of the estimates, in their order.
    pub covariance: Vec<Vec<f64>>,
    /// Correlations of errors above 0.5, without sign.
    pub correlations: Vec<Correlation>,
    /// Friction of the fitted contacts; absent where it was measured at several velocities.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction: Option<FitFriction>,
    /// The comparison with other distributions of thresholds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub laws: Option<FitLaws>,
    /// Thresholds of free form.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub free_form: Option<FitFreeForm>,
    /// Draws from the posterior.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub posterior: Option<PosteriorSummary>,
    /// The files that the curves were read from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<FitSource>,
}

/// Thresholds of free form; their density is in the record.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitFreeForm {
    /// Whether the search has converged.
    pub converged: bool,
    /// The mean threshold.
    pub mean: Uncertain,
    /// The standard deviation of the thresholds.
    pub std: Uncertain,
    /// λ, the strength of the penalty for third differences of the logarithmic density.
    pub strength: f64,
    /// The number of parameters of the shape beyond a Gaussian that the curve determines.
    pub effective: f64,
    /// χ²; absent for a measurement that is only planned.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub chi_squared: Option<f64>,
}

/// A comparison of distributions of thresholds by Akaike's criterion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitLaws {
    /// The criterion for the distribution of the scenario less the lowest of all.
    pub difference: f64,
    /// The same fit with other distributions, in the order of `fit.laws`.
    pub others: Vec<FitLaw>,
}

/// A fit with another distribution of thresholds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitLaw {
    /// The name of the distribution.
    pub law: String,
    /// Akaike's criterion less the lowest of all distributions, the scenario's own included; above about 10 a distribution is
    /// hardly the one that made the curve. Absent where there is no such fit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference: Option<f64>,
    /// Whether the search has converged.
    pub converged: bool,
    /// The estimates.
    pub numbers: Vec<FitNumber>,
    /// Why there is no fit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

/// An estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitNumber {
    /// Its key in the scenario.
    pub key: String,
    /// Its most probable value.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// The interval that holds the true value with 95 %.
    pub interval: [Extended; 2],
    /// Where only a limit is known: the value below which it is with 95 %.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<Extended>,
}

/// A number that was not free.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitFixed {
    /// Its key in the scenario.
    pub key: String,
    /// Its value.
    pub value: f64,
}

/// A value with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Uncertain {
    /// The value.
    pub value: Extended,
    /// Its standard error; NaN where the value has no derivative.
    pub error: Extended,
}

/// Friction of the fitted contacts, with propagated errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FitFriction {
    /// F_s; absent if it is not reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub static_friction: Option<Uncertain>,
    /// F_k.
    pub kinetic_friction: Uncertain,
    /// X*.
    pub relaxation_length: Uncertain,
    /// K_c.
    pub critical_stiffness: Uncertain,
}
