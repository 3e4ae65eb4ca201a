//! The test of autocorrelated residuals of G. M. Ljung and G. E. P. Box, Biometrika 65, 297 (1978).

use puruspe::gammq;

/// The probability that independent values, of one series or several, are more autocorrelated up to `lags` values apart, where the
/// statistic has so many degrees of `freedom`: the lags less the numbers that were fitted to the correlations. `None` if all
/// values are 0, or one is not finite.
pub fn ljung_box(series: &[&[f64]], lags: usize, freedom: usize) -> Option<f64> {
    let count: usize = series.iter().map(|values| values.len()).sum();
    let square: f64 = series.iter().flat_map(|values| values.iter()).map(|value| value * value).sum();
    let products =
        |values: &[f64], lag: usize| values.iter().skip(lag).zip(values).map(|(a, b)| a * b).sum::<f64>();
    let correlation = |lag: usize| series.iter().map(|values| products(values, lag)).sum::<f64>() / square;
    let pairs = |lag: usize| series.iter().map(|values| values.len().saturating_sub(lag)).sum::<usize>();
    let terms = (1..=lags).map(|lag| correlation(lag).powi(2) / pairs(lag) as f64);
    let statistic = count as f64 * (count + 2) as f64 * terms.sum::<f64>();
    statistic.is_finite().then(|| gammq(0.5 * freedom as f64, 0.5 * statistic))
}
