//! How well a curve is described: χ² and the whiteness of the whitened residuals.

use faer::Mat;
use puruspe::gammq;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Lags of the autocorrelation of the whitened residuals.
const LAGS: usize = 20;

/// How well a measured curve is described.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Misfit {
    /// χ² = rᵀΣ⁻¹r.
    pub chi_squared: f64,
    /// Number of readings less that of free numbers of the expected curve.
    pub degrees_of_freedom: usize,
    /// The probability of a larger χ²; `None` where the sizes of errors are estimated, which makes χ² what it is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub probability: Option<f64>,
    /// The probability of more autocorrelated residuals, by the test of Ljung and Box on the whitened residuals.
    pub whiteness: f64,
    /// −2 ln L, priors included.
    pub deviance: f64,
    /// Akaike's criterion: −2 ln L plus twice the number of free numbers, those of errors included.
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

/// The probability that independent residuals are more autocorrelated (G. M. Ljung and G. E. P. Box, Biometrika 65, 297
/// (1978)), within each curve.
pub(super) fn whiteness(curves: &[&Mat<f64>]) -> f64 {
    let n: usize = curves.iter().map(|whitened| whitened.nrows()).sum();
    let lags = LAGS.min(n / 5).max(1);
    let total: f64 = curves.iter().map(|whitened| whitened.squared_norm_l2()).sum();
    if total == 0.0 {
        return 1.0;
    }
    let products = |whitened: &Mat<f64>, lag: usize| {
        (lag..whitened.nrows()).map(|i| whitened[(i, 0)] * whitened[(i - lag, 0)]).sum::<f64>()
    };
    let correlation = |lag: usize| curves.iter().map(|whitened| products(whitened, lag)).sum::<f64>() / total;
    let pairs =
        |lag: usize| curves.iter().map(|whitened| whitened.nrows().saturating_sub(lag)).sum::<usize>();
    let sum: f64 = (1..=lags)
        .filter(|&lag| pairs(lag) > 0)
        .map(|lag| correlation(lag).powi(2) / pairs(lag) as f64)
        .sum();
    gammq(0.5 * lags as f64, 0.5 * n as f64 * (n + 2) as f64 * sum)
}

/// The probability of a larger χ² with this many degrees of freedom.
pub(super) fn probability(chi_squared: f64, degrees: usize) -> f64 {
    gammq(0.5 * degrees as f64, 0.5 * chi_squared)
}
