//! The estimate of a free number, and correlations of estimates.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Correlations that are reported.
const CORRELATED: f64 = 0.5;

/// The estimate of a free number.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Its most probable value.
    pub value: f64,
    /// Its standard error.
    pub error: f64,
    /// The interval that holds the true value with 95 %: 1.96 standard errors to both sides of the value, or of its logarithm
    /// for numbers above 0, but not beyond the end of its range. For independent errors of unknown size it is Student's t of n − p
    /// degrees of freedom in place of 1.96.
    pub interval: [f64; 2],
    /// Where only a limit is known: the value below which it is with 95 %, by the profile of the likelihood.
    pub limit: Option<f64>,
}

/// The correlation of the errors of two estimates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Correlation {
    /// The names.
    pub between: [String; 2],
    /// The coefficient, from −1 to 1.
    pub coefficient: f64,
}

/// Coefficients above [`CORRELATED`], without sign, of estimates of this covariance.
pub(super) fn correlations(parameters: &[Estimate], covariance: &[f64]) -> Vec<Correlation> {
    let n = parameters.len();
    let coefficient =
        |i: usize, j: usize| covariance[i * n + j] / (parameters[i].error * parameters[j].error);
    let pairs = (0..n).flat_map(|i| (0..i).map(move |j| (j, i)));
    let large = pairs.filter(|&(i, j)| coefficient(i, j).abs() > CORRELATED);
    large
        .map(|(i, j)| Correlation {
            between: [parameters[i].name.clone(), parameters[j].name.clone()],
            coefficient: coefficient(i, j),
        })
        .collect()
}
