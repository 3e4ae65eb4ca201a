//! Thresholds of free form: a fit of the density itself, as smooth as the curve allows.

use faer::Mat;

use super::ended::Ended;
use super::estimates::Estimates;
use super::free::{FreeParameter, first_coordinates};
use super::friction::WithError;
use super::interval::TWO_SIDED;
use super::likelihood::{Errors, Likelihood};
use super::matrix;
use super::search::{COARSE, Objective, Optimum, SHORT, search_each, search_from, search_from_score};
use super::smoothness::Smoothness;
use super::{Fit, Role};
use crate::law::{Law, LogKernels};
use crate::monitor::{Monitor, Part};
use crate::numerics::legendre::RULE;
use crate::{Error, Result};

/// Thresholds of free form as a fit has found them.
#[derive(Debug)]
#[non_exhaustive]
pub struct FreeForm {
    /// The fit, whose free numbers are the coefficients of the kernels (`thresholds.coefficient_0`, …) and the others.
    pub estimates: Estimates,
    /// The thresholds.
    pub thresholds: LogKernels,
    /// λ, the strength of the penalty for third differences of the coefficients.
    pub strength: f64,
    /// The number of parameters that the curve determines, of those of the shape beyond a Gaussian.
    pub effective: f64,
    /// The mean threshold.
    pub mean: WithError,
    /// The standard deviation of the thresholds.
    pub std: WithError,
}

/// The density and the distribution function of thresholds of free form at some thresholds, with standard errors.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ThresholdBand {
    /// Thresholds.
    pub thresholds: Vec<f64>,
    /// P_c.
    pub density: Vec<f64>,
    /// The ends of its interval of 95 %, 1.96 standard errors of ln P_c to both sides, or Student's t if errors are independent and
    /// of unknown size.
    pub low: Vec<f64>,
    /// The upper ends.
    pub high: Vec<f64>,
    /// The distribution function ∫_0^x P_c.
    pub cumulative: Vec<f64>,
    /// Its standard error.
    pub cumulative_error: Vec<f64>,
}

/// Standard deviations of the thresholds to both sides of their mean that the density covers.
const REACH: f64 = 8.0;
/// Those above the mean beyond which it is expected to continue like the distribution of the fit before.
const FAR: f64 = 4.0;
/// First strength of the penalty, and the range to which it is confined.
const STRENGTH: f64 = 10.0;
const STRENGTHS: [f64; 2] = [0.01, 1e8];
/// Most renewals of the strength, and the change of its logarithm that ends them.
const RENEWALS: usize = 30;
const SETTLED: f64 = 0.3;
/// The same of the size of independent errors.
const SETTLED_READING: f64 = 0.02;

impl Fit {
    /// The same fit with thresholds of free form: ln P_c is a sum of `count` Gaussian kernels, over eight standard
    /// deviations of the thresholds `found` by a fit with a distribution to both sides of their mean.
    ///
    /// Third differences of the coefficients are normal of variance 1/λ, so that what the curve does not determine is continued like a
    /// Gaussian; those of kernels more than four standard deviations above the mean of `found` are normal about the values of
    /// `found` besides, with a standard deviation of 3. λ is the most probable one (D. J. C. MacKay, Neural Comput. 4, 415
    /// (1992)): λ Σ(Δ³θ)² = γ, the effective number of parameters γ = λ tr (Π⁻¹ − V) DᵀD, with Π the precision of what is known
    /// beforehand and V the covariance of the estimates. Errors hold at this λ.
    ///
    /// # Errors
    /// Fewer than 12 coefficients; thresholds that are not free; a measurement that is only planned; those of [`Fit::run`].
    pub fn free_form(&self, found: &Estimates, count: usize, monitor: &mut dyn Monitor) -> Result<FreeForm> {
        self.refuse_planned()?;
        if count < 12 {
            return Err(Error::invalid("kernels", "12 or more", count));
        }
        if !self.free.iter().any(|name| name.starts_with("thresholds.")) {
            let expected = "numbers of the thresholds, for thresholds of free form";
            return Err(Error::invalid("free", expected, self.free.join(", ")));
        }
        let near = &found.equation().contacts().thresholds;
        let law = LogKernels::near(near.as_ref(), REACH, count)?;
        let coefficients = law.coefficients().to_vec();
        let is_far = |i: &usize| law.place(*i) > near.mean() + FAR * near.std();
        let far = (0..count).filter(is_far).map(|i| (i, coefficients[i])).collect();
        let own = super::names_of(&law);
        let part = &mut Part::new(monitor, 0.0, 0.02);
        let mut fit = self.with_law((std::sync::Arc::new(law), own), part)?;
        fit.start_from(found, &mut Part::new(monitor, 0.02, 0.02))?;
        let level = coefficients.iter().sum::<f64>() / count as f64;
        let smoothness = Smoothness { places: 0..count, strength: STRENGTH, level, far };
        let mut free = fit.free_parameters()?;
        if !fit.is_profiled() {
            free.extend(fit.free_errors_of(found));
        }
        let coordinates = first_coordinates(&free);
        let likelihood =
            fit.likelihood_near((free, found.reading), &coordinates, &mut Part::new(monitor, 0.04, 0.06))?;
        let likelihood = Likelihood { smoothness: Some(smoothness), ..likelihood };
        let (likelihood, optimum) =
            most_probable(likelihood, &coordinates, &mut Part::new(monitor, 0.1, 0.7))?;
        FreeForm::new(Ended { likelihood, optimum }, &mut Part::new(monitor, 0.8, 0.2))
    }

    /// Takes the values of a fit as first values of all numbers but those of the thresholds.
    fn start_from(&mut self, found: &Estimates, monitor: &mut dyn Monitor) -> Result<()> {
        let own = |parameter: &&FreeParameter| {
            parameter.role == Role::Contacts
                && parameter.curve.is_none()
                && !parameter.quantity.starts_with("thresholds.")
        };
        let free = &found.ended.likelihood.free;
        let values: Vec<(&str, f64)> = free
            .iter()
            .zip(&found.parameters)
            .filter(|(parameter, _)| own(parameter))
            .map(|(parameter, estimate)| (parameter.quantity.as_str(), estimate.value))
            .collect();
        self.equation = self.equation.with_parameters(&values, monitor)?;
        for (c, curve) in self.curves.iter_mut().enumerate() {
            curve.machine = found.machine(c);
        }
        Ok(())
    }

    /// The free numbers of the errors, from their values in a fit.
    fn free_errors_of(&self, found: &Estimates) -> Vec<FreeParameter> {
        let mut free = self.free_errors(found.reading, 0.0);
        for parameter in &mut free {
            if let Some(estimate) = found.estimate(&parameter.name) {
                parameter.start = estimate.value;
            }
        }
        free
    }

    /// The likelihood whose noise of contacts is that at these coordinates, or whose independent errors of unknown size begin at
    /// `reading`.
    fn likelihood_near(
        &self,
        (free, reading): (Vec<FreeParameter>, f64),
        coordinates: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Likelihood> {
        let white = Likelihood {
            fit: self.clone(),
            free,
            errors: Errors::RenewedWhite { reading, fitted: 0.0 },
            smoothness: None,
            restricted: None,
        };
        if self.is_profiled() {
            return Ok(white);
        }
        let likelihood = Likelihood { errors: Errors::Modelled(None), ..white };
        let readings = likelihood.expected(coordinates, &mut Part::new(monitor, 0.0, 0.3))?;
        let readings = readings.ok_or_else(none)?;
        let known = self.known_errors(&readings, coordinates, &mut Part::new(monitor, 0.3, 0.7))?;
        Ok(Likelihood { errors: Errors::Modelled(known), ..likelihood })
    }
}

/// The most probable coordinates at the most probable strength of the penalty: the strength is renewed between coarse searches.
///
/// # Errors
/// Those of [`search`].
fn most_probable(
    mut likelihood: Likelihood,
    start: &[f64],
    monitor: &mut dyn Monitor,
) -> Result<(Likelihood, Optimum)> {
    let mut found = search_each(&likelihood, &[start.to_vec()], COARSE, &mut Part::new(monitor, 0.0, 0.2))?;
    let mut renewals = StrengthRenewals::default();
    for renewal in 0..=RENEWALS {
        let Some(before) = likelihood.smoothness.clone() else { break };
        let plain = renewed(&before, &found);
        let reading = renewed_reading(&likelihood, &found);
        let moves = reading
            .is_some_and(|[reading, _]| (reading / found.trial.reading()).ln().abs() > SETTLED_READING);
        let settled = renewal == RENEWALS || ((plain / before.strength).ln().abs() < SETTLED && !moves);
        if moves {
            renewals = StrengthRenewals::default();
        }
        let strength = if settled { before.strength } else { renewals.next(before.strength, plain) };
        likelihood.smoothness = Some(Smoothness { strength, ..before.clone() });
        if let Some([reading, fitted]) = reading {
            let reading = if settled { found.trial.reading() } else { reading };
            likelihood.errors = Errors::RenewedWhite { reading, fitted };
        }
        // The number of renewals is not known beforehand.
        let done = 0.2 + 0.6 * (1.0 - 0.85_f64.powi(renewal as i32));
        let part = &mut Part::new(monitor, done, 0.1);
        let short = if settled { SHORT } else { COARSE };
        let optimum = restarted(&likelihood, (found, &before), short, part)?;
        if settled {
            return Ok((likelihood, optimum));
        }
        found = optimum;
    }
    unreachable!("a free form has a penalty, and its last renewal returns")
}

/// The error of thresholds from which no curve follows.
fn none() -> Error {
    Error::invalid("thresholds", "a density from which a curve follows", "none at the fitted thresholds")
}

/// The standard deviation σ² = Σr²/(n − p) of independent errors of unknown size, and p, the number of numbers that the curve
/// determines; at least one reading is left for the errors.
fn renewed_reading(likelihood: &Likelihood, found: &Optimum) -> Option<[f64; 2]> {
    if !matches!(likelihood.errors, Errors::RenewedWhite { .. }) {
        return None;
    }
    let fitted = likelihood.determined(&found.score.information, &found.at_bound);
    let freedom = (likelihood.count() as f64 - fitted).max(1.0);
    let reading = found.trial.reading() * (found.trial.chi_squared() / freedom).sqrt();
    Some([reading.max(likelihood.least_reading()), fitted])
}

/// The search from where one with the penalty `before` has ended.
///
/// # Errors
/// Errors of the solver; stopped by the monitor.
fn restarted(
    likelihood: &Likelihood,
    (ended, before): (Optimum, &Smoothness),
    short: f64,
    monitor: &mut dyn Monitor,
) -> Result<Optimum> {
    let Optimum { coordinates, mut trial, mut score, solutions, .. } = ended;
    let held = vec![false; coordinates.len()];
    if matches!(likelihood.errors, Errors::RenewedWhite { .. }) {
        let readings = trial.curves.into_iter().map(|curve| curve.readings).collect();
        let trial = likelihood.at_readings(&coordinates, readings).ok_or_else(none)?;
        let mut found = search_from(likelihood, (&coordinates, trial), (&held, short), monitor)?;
        found.solutions += solutions;
        return Ok(found);
    }
    let strength = likelihood.smoothness.as_ref().map_or(0.0, |now| now.strength);
    let change = strength - before.strength;
    trial.deviance += change * before.roughness(&coordinates);
    before.add_roughness((change, &coordinates), &mut score.slope, &mut score.information);
    let mut found = search_from_score(likelihood, (&coordinates, trial, score), (&held, short), monitor)?;
    found.solutions += solutions;
    Ok(found)
}

/// Renewals of the strength of a penalty, a fixed-point iteration of its logarithm made faster by secants.
#[derive(Debug, Default)]
struct StrengthRenewals {
    /// The logarithm before, and its plain change.
    before: Option<[f64; 2]>,
}

impl StrengthRenewals {
    /// The next strength after `strength`, for which a plain iteration has `plain`.
    fn next(&mut self, strength: f64, plain: f64) -> f64 {
        /// Longest step, in plain changes.
        const LONGEST: f64 = 4.0;
        let (u, change) = (strength.ln(), (plain / strength).ln());
        let longer = self.before.map_or(1.0, |[before, change_before]| {
            let slope = (change - change_before) / (u - before);
            if slope < 0.0 { (-1.0 / slope).min(LONGEST) } else { LONGEST }
        });
        self.before = Some([u, change]);
        (u + longer * change).exp().clamp(STRENGTHS[0], STRENGTHS[1])
    }
}

/// γ/Σ(Δ³θ)².
fn renewed(smoothness: &Smoothness, optimum: &Optimum) -> f64 {
    let effective = smoothness.effective(&optimum.score.information, &optimum.at_bound);
    let roughness = smoothness.roughness(&optimum.coordinates);
    (effective.max(1e-3) / roughness.max(f64::MIN_POSITIVE)).clamp(STRENGTHS[0], STRENGTHS[1])
}

impl FreeForm {
    fn new(ended: Ended<Likelihood>, monitor: &mut dyn Monitor) -> Result<Self> {
        let Some(smoothness) = ended.likelihood.smoothness.clone() else {
            unreachable!("the likelihood of a free form has a penalty")
        };
        let known = smoothness.known(&ended.optimum.score.information, &ended.optimum.at_bound);
        // A Gaussian has a mean and a width.
        let effective = (smoothness.places.len() as f64 - known - 2.0).max(0.0);
        let first = &ended.likelihood.fit.equation.contacts().thresholds;
        let coordinates = ended.optimum.coordinates[smoothness.places.clone()].to_vec();
        let ends = [first.quantile(0.0), first.quantile(1.0)];
        let thresholds = LogKernels::new(ends, coordinates)?;
        let estimates = ended.estimates(monitor)?;
        let (mean, std) = (thresholds.mean(), thresholds.std());
        let moment = |order: i32| {
            let by = |x: f64| if order == 1 { x } else { (x - mean).powi(2) / (2.0 * std) };
            propagated(&thresholds, &estimates, by)
        };
        let (mean_error, std_error) = (moment(1), moment(2));
        Ok(Self {
            estimates,
            thresholds,
            strength: smoothness.strength,
            effective,
            mean: WithError { value: mean, error: mean_error },
            std: WithError { value: std, error: std_error },
        })
    }

    /// [`Self::band`] at 201 thresholds, over all but 1e-5 of the contacts at either end.
    ///
    /// # Errors
    /// Those of [`Self::band`].
    pub fn table(&self) -> Result<ThresholdBand> {
        const POINTS: usize = 201;
        const LEFT_OUT: f64 = 1e-5;
        let (low, high) = (self.thresholds.quantile(LEFT_OUT), self.thresholds.upper_quantile(LEFT_OUT));
        let place = |i: usize| low + (high - low) * (i as f64 / (POINTS - 1) as f64);
        self.band(&(0..POINTS).map(place).collect::<Vec<_>>())
    }

    /// P_c and its distribution function at thresholds, with standard errors that follow from the covariance V of the coefficients:
    /// ∂ ln P_c/∂θ_i = B_i − ∫P_c B_i, and −∂S/∂θ_i.
    ///
    /// # Errors
    /// None for finite thresholds.
    pub fn band(&self, thresholds: &[f64]) -> Result<ThresholdBand> {
        let law = &self.thresholds;
        let names: Vec<String> = law.parameters().into_iter().map(|p| p.name.into_owned()).collect();
        let changes = names.iter().map(|name| law.survival_derivative(name)).collect::<Result<Vec<_>>>()?;
        let means = kernel_means(law);
        let error = |gradient: &[f64]| self.estimates.propagate(gradient);
        let width = TWO_SIDED.quantile(self.estimates.ended.likelihood.freedom());
        let mut band = ThresholdBand { thresholds: thresholds.to_vec(), ..ThresholdBand::default() };
        for &x in thresholds {
            let by_log: Vec<f64> = law.kernels(x).iter().zip(&means).map(|(b, mean)| b - mean).collect();
            let by_cumulative: Vec<f64> = changes.iter().map(|change| -change(x)).collect();
            band.density.push(law.density(x));
            let factor = (width * error(&by_log)).exp();
            band.low.push(law.density(x) / factor);
            band.high.push(law.density(x) * factor);
            band.cumulative.push(law.cumulative(x));
            band.cumulative_error.push(error(&by_cumulative));
        }
        Ok(band)
    }
}

/// ∫P_c B_i of all kernels.
fn kernel_means(law: &LogKernels) -> Vec<f64> {
    expected(law, |_| 1.0)
}

/// ∫g P_c B_i of all kernels.
fn expected(law: &LogKernels, g: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut sums = vec![0.0; law.coefficients().len()];
    for ends in law.series().boundaries().windows(2) {
        let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
        for (t, weight) in RULE.nodes.iter().zip(&RULE.weights) {
            let x = middle + half * t;
            let part = half * weight * law.density(x) * g(x);
            sums.iter_mut().zip(law.kernels(x)).for_each(|(sum, kernel)| *sum += part * kernel);
        }
    }
    sums
}

/// The standard error of the expectation of g: its derivatives are ∫(g − ⟨g⟩) P_c B_i.
fn propagated(law: &LogKernels, estimates: &Estimates, g: impl Fn(f64) -> f64) -> f64 {
    let mean: f64 = expected(law, &g).iter().sum();
    // The kernels add up to 1.
    let gradient = expected(law, |x| g(x) - mean);
    estimates.propagate(&gradient)
}

impl Estimates {
    /// The fit with thresholds of free form: [`Fit::free_form`].
    ///
    /// # Errors
    /// Those of [`Fit::free_form`].
    pub fn free_form(&self, count: usize, monitor: &mut dyn Monitor) -> Result<FreeForm> {
        self.ended.likelihood.fit.free_form(self, count, monitor)
    }

    /// The standard error of what has these derivatives by the first free numbers, and none by the others.
    fn propagate(&self, gradient: &[f64]) -> f64 {
        let (n, m) = (self.parameters.len(), gradient.len());
        let covariance = Mat::from_fn(m, m, |i, j| self.covariance[i * n + j]);
        let column = Mat::from_fn(m, 1, |i, _| gradient[i]);
        // Rounding may make the variance of what does not vary negative.
        matrix::inner(&column, &(&covariance * &column)).max(0.0).sqrt()
    }
}
