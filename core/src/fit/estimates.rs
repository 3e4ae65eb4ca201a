//! What a fit has found: values with errors and intervals, the readings as described, the misfit.

use faer::Mat;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::error_covariance::KnownCovariance;
use super::expected::ExpectedReadings;
use super::free::{FreeParameter, Role};
use super::interval::{self, TWO_SIDED};
use super::likelihood::{Errors, Likelihood};
use super::matrix;
use super::measurement::{Machine, Measurement};
use super::misfit::{self, Misfit};
use super::search::{Objective, Optimum};
use crate::master::{MasterEquation, Pull};
use crate::monitor::{Monitor, Part};
use crate::{Error, Result};

/// Eigenvalue of the scaled information below which a direction counts as undetermined.
const UNDETERMINED: f64 = 1e-10;
/// The same for thresholds of free form: the common level of the coefficients changes no density, and is held weakly.
const UNDETERMINED_FORM: f64 = 1e-12;
/// Standard error of a logarithm above which only a limit is reported.
const VAGUE: f64 = 1.0;
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

/// The readings of a curve as the fit describes them.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Readings {
    /// Positions X of the slider.
    pub positions: Vec<f64>,
    /// Expected forces.
    pub expected: Vec<f64>,
    /// Measured minus expected forces; 0 where none were measured.
    pub residuals: Vec<f64>,
    /// Standard deviation of each reading: noise of contacts or errors of positions, independent error and drift.
    pub std: Vec<f64>,
    /// Whitened residuals, independent and of variance 1 if the description holds.
    pub whitened: Vec<f64>,
}

/// What a fit has found.
#[derive(Debug)]
pub struct Estimates {
    /// One for each free number, those of errors last.
    pub parameters: Vec<Estimate>,
    /// Covariance of their values, row by row.
    pub covariance: Vec<f64>,
    /// Whether the search has converged; otherwise the values are the last ones.
    pub converged: bool,
    /// Solutions of the master equation that the search took.
    pub solutions: usize,
    /// How well the curve is described; `None` where none was measured.
    pub misfit: Option<Misfit>,
    /// The standard deviation of the independent error of a reading.
    pub reading: f64,
    /// The readings of each curve as described.
    pub readings: Vec<Readings>,
    pub(super) ended: Ended,
}

/// A search that has ended, with the likelihood that it has searched.
#[derive(Debug)]
pub(super) struct Ended {
    pub likelihood: Likelihood,
    pub optimum: Optimum,
}

impl Estimates {
    /// The estimate of a name.
    pub fn estimate(&self, name: &str) -> Option<&Estimate> {
        self.parameters.iter().find(|estimate| estimate.name == name)
    }

    /// The contacts of the estimated numbers, of curve 0 where curves differ.
    pub fn equation(&self) -> &MasterEquation {
        &self.expected(0).contacts.equation
    }

    /// The machine of the estimated numbers, of curve `curve`.
    pub fn machine(&self, curve: usize) -> Machine {
        self.expected(curve).machine
    }

    /// What was measured: the curves.
    pub fn curves(&self) -> &[Measurement] {
        &self.ended.likelihood.fit.curves
    }

    /// The pull of the estimated contacts of curve `curve`; if they are common to all curves, it ends with the longest of them.
    pub fn pull(&self, curve: usize) -> &Pull {
        &self.expected(curve).contacts.pull
    }

    fn expected(&self, curve: usize) -> &ExpectedReadings {
        &self.ended.optimum.trial.curves[curve].readings
    }

    /// Whether the readings of all curves are on average farther apart than a third of the mean life of the estimated contacts.
    /// Contacts whose lives are longer or shorter by a factor may then have the same forces at the readings (aliasing), and the
    /// search may have found them.
    pub fn is_sparse(&self) -> bool {
        /// Readings in a mean life, over which the force rises and falls once.
        const ENOUGH: f64 = 3.0;
        let lives =
            self.ended.optimum.trial.curves.iter().map(|c| c.readings.contacts.equation.life().mean());
        self.curves().iter().zip(lives).all(|(curve, life)| ENOUGH * curve.spacing() > life)
    }

    /// Coefficients above 0.5, without sign, between the errors of two estimates.
    pub fn correlations(&self) -> Vec<Correlation> {
        correlations(&self.parameters, &self.covariance)
    }

    /// The interval of 95 % of a number by the profile of the likelihood: where −2 ln L, lowest in all other numbers, has
    /// risen by 3.84. Where sizes of errors are free, L is the restricted likelihood, but for thresholds of free form. For
    /// independent errors of unknown size the rise is ν ln(1 + t²/ν), with Student's t for ν = n − p.
    ///
    /// # Errors
    /// A name that was not free; a measurement that is only planned; errors of the solver; stopped by the monitor.
    pub fn interval_by_profile(&self, name: &str, monitor: &mut dyn Monitor) -> Result<[f64; 2]> {
        let number = self.number(name)?;
        let Ended { likelihood, optimum } = self.measured()?;
        let parameter = &likelihood.free[number];
        let slope = parameter.slope(optimum.coordinates[number]);
        let error = self.parameters[number].error / slope;
        interval::by_profile((likelihood, optimum), (number, error), monitor)
    }

    /// By how much −2 ln L, lowest in all other numbers, is above its minimum where a number has another value; ∞ where there
    /// is no curve. Where sizes of errors are free, L is the restricted likelihood, but for thresholds of free form.
    ///
    /// # Errors
    /// As [`Self::interval_by_profile`]; a value that is not finite, or not above 0 for a number that is.
    pub fn profile(&self, name: &str, value: f64, monitor: &mut dyn Monitor) -> Result<f64> {
        let number = self.number(name)?;
        let Ended { likelihood, optimum } = self.measured()?;
        let u = likelihood.free[number].coordinate(value);
        if !u.is_finite() {
            let above = if likelihood.free[number].logarithmic { " above 0" } else { "" };
            return Err(Error::invalid("values", format!("a finite number{above}"), value));
        }
        let lowest = interval::profile((likelihood, optimum), (number, u), monitor)?;
        Ok(lowest - optimum.trial.restricted_deviance())
    }

    /// `count` values of a number for [`Self::profile`], from three standard errors below its estimate to three above; of the
    /// logarithm for numbers above 0, where an error of 1 is taken for one that is larger or unknown.
    ///
    /// # Errors
    /// A name that was not free.
    pub fn profile_values(&self, name: &str, count: usize) -> Result<Vec<f64>> {
        /// Standard errors to both sides.
        const WIDTH: f64 = 3.0;
        let number = self.number(name)?;
        let Ended { likelihood, optimum } = &self.ended;
        let (parameter, u) = (&likelihood.free[number], optimum.coordinates[number]);
        let error = self.parameters[number].error / parameter.slope(u);
        let known = error > 0.0 && (error <= VAGUE || !parameter.logarithmic);
        let width = match self.parameters[number].limit {
            Some(limit) if !parameter.logarithmic => limit,
            _ => WIDTH * if known { error } else { VAGUE },
        };
        let place = |i: usize| 2.0 * i as f64 / count.saturating_sub(1).max(1) as f64 - 1.0;
        Ok((0..count).map(|i| parameter.value((u + width * place(i)).max(parameter.bounds[0]))).collect())
    }

    /// ln L at values of the free numbers, in their order, and its gradient, priors included; −∞ and NaN where the likelihood is
    /// 0. The covariance of the noise of contacts is that of the estimates, scaled by N⟨k⟩².
    ///
    /// # Errors
    /// Another number of values than of free numbers; a measurement that is only planned; errors of the solver; stopped by the monitor.
    pub fn log_likelihood(&self, values: &[f64], monitor: &mut dyn Monitor) -> Result<(f64, Vec<f64>)> {
        let likelihood = &self.measured()?.likelihood;
        if values.len() != likelihood.free.len() {
            let expected = format!("{} values, one for each free number", likelihood.free.len());
            return Err(Error::invalid("values", expected, values.len()));
        }
        let coordinates: Vec<f64> = likelihood
            .free
            .iter()
            .zip(values)
            .map(|(parameter, &value)| parameter.coordinate(value))
            .collect();
        let known = if coordinates.iter().all(|u| u.is_finite()) {
            likelihood.unrestricted(&coordinates, monitor)?
        } else {
            None
        };
        let Some((deviance, halved)) = known else {
            return Ok((f64::NEG_INFINITY, vec![f64::NAN; values.len()]));
        };
        let slope = |k: usize| -halved[(k, 0)] / likelihood.free[k].slope(coordinates[k]);
        Ok((-0.5 * deviance, (0..values.len()).map(slope).collect()))
    }

    /// The search, which has found the highest likelihood of measured forces.
    pub(super) fn measured(&self) -> Result<&Ended> {
        self.ended.likelihood.fit.refuse_planned().map(|()| &self.ended)
    }

    fn number(&self, name: &str) -> Result<usize> {
        let found = self.parameters.iter().position(|estimate| estimate.name == name);
        found.ok_or_else(|| {
            let names: Vec<_> = self.parameters.iter().map(|estimate| estimate.name.as_str()).collect();
            Error::invalid("name", format!("one of {}", names.join(", ")), name)
        })
    }
}

impl Ended {
    /// Values, errors and all that follows.
    ///
    /// # Errors
    /// Numbers that the data do not determine; errors of the solver; stopped by the monitor.
    pub fn estimates(self, monitor: &mut dyn Monitor) -> Result<Estimates> {
        let Self { likelihood, optimum } = &self;
        let free = &likelihood.free;
        let active: Vec<usize> = (0..free.len())
            .filter(|&k| !optimum.at_bound[k] && optimum.score.information[(k, k)] > 0.0)
            .collect();
        let least = if likelihood.smoothness.is_some() { UNDETERMINED_FORM } else { UNDETERMINED };
        refuse_undetermined(free, &optimum.score.information, &active, ("curve", least))?;
        let covariance = matrix::covariance(&optimum.score.information, &active);
        let mut covariance = covariance.unwrap_or_else(|| Mat::zeros(free.len(), free.len()));
        self.add_kurtosis(&mut covariance);
        let share = 1.0 / free.len() as f64;
        let parameters = (0..free.len()).map(|k| {
            let part = &mut Part::new(monitor, k as f64 * share, share);
            let measured = !likelihood.fit.is_planned();
            estimate((likelihood, optimum), (k, covariance[(k, k)].sqrt()), measured, part)
        });
        let parameters = parameters.collect::<Result<Vec<_>>>()?;
        let slope = |k: usize| free[k].slope(optimum.coordinates[k]);
        let natural = Mat::from_fn(free.len(), free.len(), |i, j| covariance[(i, j)] * slope(i) * slope(j));
        let rows = (0..free.len()).flat_map(|i| (0..free.len()).map(move |j| (i, j)));
        Ok(Estimates {
            parameters,
            covariance: rows.map(|(i, j)| natural[(i, j)]).collect(),
            converged: optimum.converged,
            solutions: optimum.solutions,
            misfit: (!likelihood.fit.is_planned()).then(|| self.misfit()),
            reading: optimum.trial.reading(),
            readings: (0..likelihood.fit.curves.len()).map(|curve| self.readings(curve)).collect(),
            ended: self,
        })
    }

    fn readings(&self, curve: usize) -> Readings {
        let trial = &self.optimum.trial.curves[curve];
        let sizes = trial.sizes;
        let known = match &self.likelihood.errors {
            Errors::Modelled(Some(known)) => Some(&known.covariances[curve]),
            _ => None,
        };
        let of_known: Option<Vec<f64>> = known.and_then(|known| match known {
            KnownCovariance::None => None,
            KnownCovariance::Contacts(noise) => {
                Some(noise.diagonal().into_iter().map(|variance| sizes.noise * variance).collect())
            }
            KnownCovariance::Positions(variances) => Some(variances.clone()),
        });
        let white = sizes.reading * sizes.reading + sizes.drift[0] * sizes.drift[0];
        let std = |i: usize| (of_known.as_ref().map_or(0.0, |variances| variances[i]) + white).sqrt();
        let n = trial.whitened.nrows();
        Readings {
            positions: trial.readings.driven.positions.clone(),
            expected: trial.readings.forces.clone(),
            residuals: (0..n).map(|i| trial.residuals[(i, 0)]).collect(),
            std: (0..n).map(std).collect(),
            whitened: (0..n).map(|i| trial.whitened[(i, 0)]).collect(),
        }
    }

    /// Whether the size of the noise of contacts, N⟨k⟩², is free: the curve determines N⟨k⟩ only.
    fn divides_noise(&self) -> bool {
        let free = |name: &str| self.likelihood.free.iter().any(|parameter| parameter.name == name);
        self.likelihood.errors.have_contacts() && free("count") && free("stiffness")
    }

    fn misfit(&self) -> Misfit {
        let Self { likelihood, optimum } = self;
        let chi_squared = optimum.trial.chi_squared();
        let of_errors = likelihood.free.iter().filter(|parameter| parameter.is_of_errors()).count();
        let determined = likelihood.determined(&optimum.score.information, &optimum.at_bound);
        // N and ⟨k⟩ change a curve alike.
        let alike = f64::from(u8::from(self.divides_noise()));
        let of_curve = determined - of_errors as f64 - alike;
        let degrees_of_freedom = likelihood.count().saturating_sub(of_curve.round() as usize);
        let profiled =
            matches!(likelihood.errors, Errors::ProfiledWhite { .. } | Errors::RenewedWhite { .. });
        let estimated =
            profiled || self.divides_noise() || likelihood.free.iter().any(FreeParameter::is_of_errors);
        let deviance = optimum.trial.deviance;
        let whitened: Vec<_> = optimum.trial.curves.iter().map(|curve| &curve.whitened).collect();
        let count = determined + f64::from(u8::from(profiled));
        let penalty = likelihood.smoothness.as_ref();
        let penalty = penalty.map_or(0.0, |smoothness| smoothness.penalty(&optimum.coordinates));
        Misfit {
            chi_squared,
            degrees_of_freedom,
            probability: (!estimated && degrees_of_freedom > 0)
                .then(|| misfit::probability(chi_squared, degrees_of_freedom)),
            whiteness: misfit::whiteness(&whitened),
            deviance,
            akaike: deviance - penalty + 2.0 * count,
        }
    }
}

/// # Errors
/// Numbers that can change together without a change of `what`, a curve or a record: along an eigenvector of the scaled
/// information whose eigenvalue is below `least`.
pub(super) fn refuse_undetermined(
    free: &[FreeParameter],
    information: &Mat<f64>,
    active: &[usize],
    (what, least): (&str, f64),
) -> Result<()> {
    let Some(direction) = matrix::undetermined(information, active, least).into_iter().next() else {
        return Ok(());
    };
    let change = |(&k, d): (&usize, &f64)| {
        let parameter = &free[k];
        let change = d / information[(k, k)].sqrt();
        (change, parameter.name.clone(), parameter.logarithmic)
    };
    let changes: Vec<_> = active.iter().zip(&direction).map(change).collect();
    let part = |(k, d): (usize, &f64)| (d.abs() > 0.05).then_some(k);
    let named: Vec<usize> = direction.iter().enumerate().filter_map(part).collect();
    let first = named.first().map_or(1.0, |&k| changes[k].0);
    let reported = named.iter().map(|&k| {
        let (change, name, logarithmic) = &changes[k];
        let of = if *logarithmic { "ln " } else { "" };
        format!("{of}{name} by {:+}", significant(change / first))
    });
    let expected = format!("numbers that the {what} determines (fix one of these, or give it a prior)");
    let reported = reported.collect::<Vec<_>>().join(", ");
    let found = format!("the same {what} if these change together: {reported}");
    Err(Error::invalid("free", expected, found))
}

/// The estimate of number `k`, whose coordinate has the standard error `error`; with the limit below which it is, where
/// only this is known and it is asked for.
pub(super) fn estimate<O: Objective>(
    (likelihood, optimum): (&O, &Optimum<O::Point>),
    (k, error): (usize, f64),
    with_limit: bool,
    monitor: &mut dyn Monitor,
) -> Result<Estimate> {
    let parameter = &likelihood.free()[k];
    let u = optimum.coordinates[k];
    let value = parameter.value(u);
    let low = optimum.at_bound[k] && u <= parameter.bounds[0];
    let vague = parameter.is_of_errors() && parameter.logarithmic && (error.is_nan() || error > VAGUE);
    let limited = (low || vague) && parameter.role != Role::DriftLength;
    let limit = if limited && with_limit {
        Some(interval::upper_limit((likelihood, optimum), k, monitor)?)
    } else {
        None
    };
    let width = TWO_SIDED.quantile(likelihood.freedom()) * error;
    let end = |side: f64| parameter.value((u + side * width).max(parameter.bounds[0]));
    let interval = limit.map_or([end(-1.0), end(1.0)], |limit| [0.0, limit]);
    Ok(Estimate { name: parameter.name.clone(), value, error: error * parameter.slope(u), interval, limit })
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

/// A number rounded to three digits.
fn significant(value: f64) -> f64 {
    let unit = 10_f64.powf(value.abs().log10().floor() - 2.0);
    if unit.is_normal() { (value / unit).round() * unit } else { value }
}
