//! How well a curve is described: χ² and the whiteness of the whitened residuals.

use faer::Mat;
use puruspe::gammq;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::numerics::ljung_box::ljung_box;

/// Lags of the autocorrelation of the whitened residuals.
const LAGS: usize = 20;
/// Readings of a curve below which its residuals are not tested for whiteness: its own numbers alone, such as an offset, would
/// make them correlated.
const SHORTEST: usize = 5;

/// How well a measured curve is described.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Misfit {
    /// χ² = rᵀΣ⁻¹r.
    pub chi_squared: f64,
    /// Number of readings less that of free numbers of the expected curve; of thresholds of free form, less the effective number.
    pub degrees_of_freedom: usize,
    /// The probability of a larger χ²; `None` without degrees of freedom, and where the sizes of errors are estimated, which makes
    /// χ² what it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// The probability of more autocorrelated residuals, by the test of Ljung and Box on the whitened residuals.
    pub whiteness: f64,
    /// −2 ln L, priors included, at the estimates; those of sizes of errors have the highest restricted likelihood.
    pub deviance: f64,
    /// Akaike's criterion: −2 ln L plus twice the number of free numbers, those of errors included; of thresholds of free form the
    /// effective number, without their penalty in −2 ln L.
    pub akaike: f64,
}

impl Misfit {
    /// Below this probability a curve is not of the kind that was fitted.
    pub const UNLIKELY: f64 = 1e-3;

    /// Whether the curve is not of the kind that was fitted, so that the errors of the estimates cannot be trusted.
    pub fn is_unlikely(&self) -> bool {
        self.probability.is_some_and(|probability| probability < Self::UNLIKELY)
            || self.whiteness < Self::UNLIKELY
    }
}

/// The probability that independent residuals are more autocorrelated, within each curve of five readings or more; 1 if
/// there is none.
pub(super) fn whiteness(curves: &[&Mat<f64>]) -> f64 {
    let curves: Vec<_> = curves.iter().filter(|whitened| whitened.nrows() >= SHORTEST).collect();
    let n: usize = curves.iter().map(|whitened| whitened.nrows()).sum();
    let longest = curves.iter().map(|whitened| whitened.nrows()).max().unwrap_or(1);
    let lags = LAGS.min(n / 5).min(longest - 1).max(1);
    let series: Vec<&[f64]> = curves.iter().map(|whitened| whitened.col_as_slice(0)).collect();
    ljung_box(&series, lags, lags).unwrap_or(1.0)
}

/// The probability of a larger χ² with this many degrees of freedom.
pub(super) fn probability(chi_squared: f64, degrees: usize) -> f64 {
    gammq(0.5 * degrees as f64, 0.5 * chi_squared)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(values: &[f64]) -> Mat<f64> {
        Mat::from_fn(values.len(), 1, |i, _| values[i])
    }

    /// A number of its own for each of many short curves makes their residuals opposite, whatever the errors are.
    #[test]
    fn curves_of_two_readings_tell_nothing_of_whiteness() {
        let opposite: Vec<Mat<f64>> = (0..60).map(|_| column(&[1.0, -1.0])).collect();
        assert_eq!(whiteness(&opposite.iter().collect::<Vec<_>>()), 1.0);
        let mut alternating = column(&[1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0]);
        let long = [&alternating, &opposite[0]];
        // The same as without the short one.
        assert_eq!(whiteness(&long), whiteness(&[&alternating]));
        // Lags 1 and 2 of n = 10: n(n + 2)(0.9²/9 + 0.8²/8) = 20.4, and exp(−20.4/2) for two degrees of freedom.
        assert!((whiteness(&[&alternating]) / (-10.2_f64).exp() - 1.0).abs() < 1e-10);
        alternating[(0, 0)] = -1.0;
        assert!(whiteness(&[&alternating]) > (-10.2_f64).exp());
    }
}
