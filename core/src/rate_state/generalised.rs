//! Generalised least squares of a curve that is linear in all its parameters but a scale, with errors and intervals.
//!
//! For noise of covariance C the parameters minimise χ² = (y − f)ᵀC⁻¹(y − f). All but the scale are
//! eliminated (variable projection, G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10, 413 (1973)). C is
//! estimated from the residuals, and the fit repeated with it.

use super::MeasuredValue;
use super::drift::{MeasuredNoise, Residuals};
use super::separable::nearest_scale;
use crate::Result;
use crate::monitor::{Counted, Monitor, Watch};
use crate::numerics::least_squares::LeastSquares;
use crate::numerics::roots::brent_root;
use crate::numerics::student::two_sided;

/// Largest number of times that the noise is estimated.
const ROUNDS: usize = 4;
/// The noise is estimated until the scale changes by less than this fraction of its error.
const SETTLED: f64 = 0.01;
/// Probability that a value lies outside of its interval.
const OUTSIDE: f64 = 0.05;
/// Scales between the ends of its interval for which the other parameters are computed.
const PROFILE: usize = 65;
/// Residuals relative to the values below which they are rounding.
pub(super) const ROUNDING: f64 = 1e-13;

/// The curve f(X) = Σ_j c_j g_j(X; s) with a scale s, and the values measured at rising positions.
pub(super) struct ScaledCurve<'a> {
    pub position: &'a [f64],
    pub values: &'a [f64],
    /// g_j at the positions.
    pub columns: &'a dyn Fn(f64) -> Vec<Vec<f64>>,
    /// ∂f/∂s at the positions, for s and c.
    pub by_scale: &'a dyn Fn(f64, &[f64]) -> Vec<f64>,
    /// Scales among which it is sought.
    pub scales: (f64, f64),
}

/// A fit of such a curve.
pub(super) struct GeneralisedFit<'a> {
    curve: &'a ScaledCurve<'a>,
    pub scale: f64,
    pub coefficients: Vec<f64>,
    pub noise: MeasuredNoise,
    /// Residuals, whitened and divided by their standard deviation.
    pub whitened: Vec<f64>,
    /// Root mean square of the residuals.
    pub residual: f64,
    /// χ² at the best scale, and χ² per degree of freedom.
    squares: f64,
    variance: f64,
    /// The linearised fit, with ∂f/∂s as its last column.
    linearised: LeastSquares,
    /// Student's t at the ends of the intervals.
    quantile: f64,
    /// Linearised fits of what is left in noise with other correlation lengths, each with its weight.
    alternatives: Vec<(f64, LeastSquares)>,
    /// Scales from the lower to the upper end of the interval, and the fits at them.
    profile: Vec<(f64, LeastSquares)>,
}

impl<'a> GeneralisedFit<'a> {
    /// Fits `curve` with white noise, or with drift as well. `None` if its parameters are not determined by the values.
    ///
    /// # Errors
    /// A stop by the monitor.
    pub fn new(
        curve: &'a ScaledCurve<'a>,
        drift: bool,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<GeneralisedFit<'a>>> {
        let watch = &Watch::new(monitor);
        let Some(mut fit) = Self::with(curve, &MeasuredNoise::UNIT, watch)? else { return Ok(None) };
        let size = curve.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        if drift && fit.residual > ROUNDING * size {
            let mut before = None;
            for _ in 0..ROUNDS {
                let gradients = curve.gradients(fit.scale, &fit.coefficients);
                let residual = curve.residual(fit.scale, &fit.coefficients);
                let residuals =
                    Residuals { position: curve.position, residual: &residual, gradients: &gradients };
                let noise = residuals.noise(before.as_ref(), &mut Counted(watch))?;
                let Some(noise) = noise else { return Ok(None) };
                let Some(next) = Self::with(curve, &noise, watch)? else { return Ok(None) };
                let moved = (next.scale - fit.scale).abs();
                (fit, before) = (next, Some(noise));
                if moved < SETTLED * fit.scale_error() {
                    break;
                }
            }
            fit.alternatives = fit.alternatives(&mut Counted(watch))?;
        }
        fit.profile = fit.profiled(watch);
        watch.check()?;
        Ok(Some(fit))
    }

    /// Fits `curve` in noise whose covariance is known up to a factor. `None` if its parameters are not determined.
    fn with(curve: &'a ScaledCurve<'a>, noise: &MeasuredNoise, watch: &Watch<'_>) -> Result<Option<Self>> {
        let squares =
            |scale: f64| watch.value(|| curve.fitted(scale, noise).map_or(f64::INFINITY, |fit| fit.squares));
        let scale = nearest_scale(squares, curve.scales);
        watch.check()?;
        Ok(scale.and_then(|scale| Self::at(curve, scale, noise)))
    }

    /// The fit of `curve` with a scale.
    fn at(curve: &'a ScaledCurve<'a>, scale: f64, noise: &MeasuredNoise) -> Option<Self> {
        let best = curve.fitted(scale, noise)?;
        let gradients = curve.gradients(scale, &best.coefficients);
        let parameters = gradients.len();
        let freedom = curve.values.len().checked_sub(parameters).filter(|&freedom| freedom > 0)? as f64;
        let mut residual = vec![curve.residual(scale, &best.coefficients)];
        let rms = (square(&residual[0]) / residual[0].len() as f64).sqrt();
        noise.whiten(curve.position, &mut residual);
        let [whitened] = <[Vec<f64>; 1]>::try_from(residual).ok()?;
        let linearised = least_squares(curve.position, gradients, whitened.clone(), noise)?;
        // The covariance is scaled to the residuals: estimated drift already is, white noise of size 1 is not.
        let variance = best.squares / freedom;
        let std = variance.sqrt();
        Some(Self {
            curve,
            scale,
            coefficients: best.coefficients.clone(),
            noise: noise.clone(),
            whitened: whitened.iter().map(|value| value / std).collect(),
            residual: rms,
            squares: best.squares,
            variance,
            linearised,
            quantile: two_sided(OUTSIDE, freedom),
            alternatives: Vec::new(),
            profile: Vec::new(),
        })
    }

    /// The noise, scaled to the residuals.
    pub fn measured_noise(&self) -> MeasuredNoise {
        self.noise.clone().scaled(self.variance.sqrt())
    }

    /// The scale.
    pub fn scale_value(&self) -> MeasuredValue {
        let (low, high) = (self.profile[0].0, self.profile[self.profile.len() - 1].0);
        let (below, above) = self.open();
        let widened = self.widened(&self.scale_gradient());
        let end = |end: f64| self.scale * (end / self.scale).powf(widened);
        MeasuredValue {
            value: self.scale,
            error: widened * self.scale_error(),
            low: Some(if below { 0.0 } else { end(low) }),
            high: (!above).then(|| end(high)),
        }
    }

    /// Σ w_j c_j for w that may depend on the scale: `weights(s)` gives w and its derivative by s.
    pub fn value(&self, weights: &dyn Fn(f64) -> (Vec<f64>, Vec<f64>)) -> MeasuredValue {
        let (mut gradient, slopes) = weights(self.scale);
        let value = product(&gradient, &self.coefficients);
        gradient.push(product(&slopes, &self.coefficients));
        let widened = self.widened(&gradient);
        let error = widened * self.linearised_error(&gradient);
        let (low, high) = self.interval(weights);
        let growth = self.growth(weights);
        MeasuredValue {
            value,
            error,
            low: (growth >= 0.0).then_some(value - widened * (value - low)),
            high: (growth <= 0.0).then_some(value + widened * (high - value)),
        }
    }

    /// By how much a value grows with the logarithm of the scale at the last one searched, if any larger scale fits as well, and
    /// the growth is ever more, and more than the uncertainty there: as that of b, of which only b/D is known of a D without upper
    /// end. 0 otherwise.
    fn growth(&self, weights: &dyn Fn(f64) -> (Vec<f64>, Vec<f64>)) -> f64 {
        let [.., first, before, last] = &self.profile[..] else { return 0.0 };
        let at = |(scale, fit): &(f64, LeastSquares)| product(&weights(*scale).0, &fit.coefficients);
        let [earlier, growth] =
            [(first, before), (before, last)].map(|(one, next)| (at(next) - at(one)) / (next.0 / one.0).ln());
        let uncertain = self.quantile * (self.variance * last.1.variance(&weights(last.0).0)).sqrt();
        let grows = growth.abs() > earlier.abs().max(uncertain);
        if self.open().1 && grows { growth } else { 0.0 }
    }

    /// The coefficient `index`.
    pub fn coefficient(&self, index: usize) -> MeasuredValue {
        let mut weights = vec![0.0; self.coefficients.len()];
        weights[index] = 1.0;
        self.value(&|_| (weights.clone(), vec![0.0; weights.len()]))
    }

    fn scale_error(&self) -> f64 {
        self.linearised_error(&self.scale_gradient())
    }

    fn scale_gradient(&self) -> Vec<f64> {
        let mut gradient = vec![0.0; self.coefficients.len()];
        gradient.push(1.0);
        gradient
    }

    /// The standard error of the number whose derivatives by the parameters are `gradient`, in noise as estimated.
    fn linearised_error(&self, gradient: &[f64]) -> f64 {
        (self.variance * self.linearised.variance(gradient)).sqrt()
    }

    fn alternatives(&self, monitor: &mut dyn Monitor) -> Result<Vec<(f64, LeastSquares)>> {
        let gradients = self.curve.gradients(self.scale, &self.coefficients);
        let residual = self.curve.residual(self.scale, &self.coefficients);
        let residuals =
            Residuals { position: self.curve.position, residual: &residual, gradients: &gradients };
        let found = residuals.alternatives(&self.noise, monitor)?;
        let fits =
            found.into_iter().filter_map(|(weight, noise)| Some((weight, residuals.fitted(&noise)?.0)));
        Ok(fits.collect())
    }

    /// By how much the uncertainty of the correlation length widens the error of a number: the standard
    /// deviation of the mixture of its distributions for all lengths, over the standard error at the
    /// estimated one; at least 1.
    fn widened(&self, gradient: &[f64]) -> f64 {
        let moments = self.alternatives.iter().fold([0.0; 3], |[sum, first, second], (weight, fit)| {
            let shift = product(gradient, &fit.coefficients);
            let square = fit.variance(gradient) + shift * shift;
            [sum + weight, first + weight * shift, second + weight * square]
        });
        let [sum, first, second] = moments;
        if sum == 0.0 {
            return 1.0;
        }
        let variance = second / sum - (first / sum).powi(2);
        (variance.sqrt() / self.linearised_error(gradient)).max(1.0)
    }

    /// By how much χ² exceeds its minimum, over that of the end of an interval.
    fn excess(&self, fit: &LeastSquares) -> f64 {
        (fit.squares - self.squares).max(0.0) / self.variance - self.quantile.powi(2)
    }

    /// The ends of the interval of the scale: where χ² exceeds its minimum by t² (profile likelihood), or the
    /// ends of the range of scales.
    fn scale_ends(&self, watch: &Watch<'_>) -> (f64, f64) {
        let excess = |log: f64| {
            let fitted = || self.curve.fitted(log.exp(), &self.noise);
            watch.value(|| fitted().map_or(f64::INFINITY, |fit| self.excess(&fit)))
        };
        let best = self.scale.ln();
        let end = |limit: f64| {
            let log = limit.ln();
            if excess(log) <= 0.0 { None } else { brent_root(excess, best, log, 1e-6) }
                .map_or(limit, f64::exp)
        };
        (end(self.curve.scales.0), end(self.curve.scales.1))
    }

    fn profiled(&self, watch: &Watch<'_>) -> Vec<(f64, LeastSquares)> {
        let (low, high) = self.scale_ends(watch);
        let (first, width) = (low.ln(), high.ln() - low.ln());
        let scale = |i: usize| match i {
            0 => low,
            _ if i + 1 == PROFILE => high,
            _ => (first + width * i as f64 / (PROFILE - 1) as f64).exp(),
        };
        let fits = (0..PROFILE).map(scale);
        let mut fits: Vec<_> = fits
            .take_while(|_| !watch.stops())
            .filter_map(|scale| Some((scale, self.curve.fitted(scale, &self.noise)?)))
            .collect();
        if fits.is_empty() {
            fits.extend(self.curve.fitted(self.scale, &self.noise).map(|fit| (self.scale, fit)));
        }
        fits
    }

    /// Whether the interval of the scale has no lower and no upper end.
    fn open(&self) -> (bool, bool) {
        let (low, high) = self.curve.scales;
        (self.profile[0].0 <= low, self.profile[self.profile.len() - 1].0 >= high)
    }

    /// The values at which χ², minimised over all other parameters, exceeds its minimum by at most t². For a
    /// given scale χ² is a parabola in the value, so that the interval is the union of those of all scales.
    fn interval(&self, weights: &dyn Fn(f64) -> (Vec<f64>, Vec<f64>)) -> (f64, f64) {
        self.profile.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |ends, (scale, fit)| {
            let weights = weights(*scale).0;
            let middle = product(&weights, &fit.coefficients);
            let left = (-self.excess(fit)).max(0.0);
            let half = (left * self.variance * fit.variance(&weights)).sqrt();
            (ends.0.min(middle - half), ends.1.max(middle + half))
        })
    }
}

impl ScaledCurve<'_> {
    /// The best fit at a scale.
    fn fitted(&self, scale: f64, noise: &MeasuredNoise) -> Option<LeastSquares> {
        let mut values = vec![self.values.to_vec()];
        noise.whiten(self.position, &mut values);
        least_squares(self.position, (self.columns)(scale), values.pop()?, noise)
    }

    fn gradients(&self, scale: f64, coefficients: &[f64]) -> Vec<Vec<f64>> {
        let mut gradients = (self.columns)(scale);
        gradients.push((self.by_scale)(scale, coefficients));
        gradients
    }

    fn residual(&self, scale: f64, coefficients: &[f64]) -> Vec<f64> {
        let mut rest = self.values.to_vec();
        for (column, coefficient) in (self.columns)(scale).iter().zip(coefficients) {
            rest.iter_mut().zip(column).for_each(|(value, part)| *value -= coefficient * part);
        }
        rest
    }
}

/// Least squares with columns that are whitened first, and a right side that is white already.
fn least_squares(
    position: &[f64],
    mut columns: Vec<Vec<f64>>,
    white: Vec<f64>,
    noise: &MeasuredNoise,
) -> Option<LeastSquares> {
    noise.whiten(position, &mut columns);
    LeastSquares::new(columns, white)
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn square(values: &[f64]) -> f64 {
    product(values, values)
}

/// Both coefficients of two columns with independent noise of one size, and the root-mean-square residual.
pub(super) fn straight(columns: Vec<Vec<f64>>, values: &[f64]) -> Option<([MeasuredValue; 2], f64)> {
    let fit = LeastSquares::new(columns, values.to_vec())?;
    let freedom = values.len().checked_sub(2).filter(|&freedom| freedom > 0)? as f64;
    let quantile = two_sided(OUTSIDE, freedom);
    let coefficient = |i: usize| {
        let weights = [f64::from(i == 0), f64::from(i == 1)];
        let error = (fit.squares / freedom * fit.variance(&weights)).sqrt();
        let value = fit.coefficients[i];
        let [low, high] = [-1.0, 1.0].map(|side| Some(value + side * quantile * error));
        MeasuredValue { value, error, low, high }
    };
    Some(([coefficient(0), coefficient(1)], (fit.squares / values.len() as f64).sqrt()))
}
