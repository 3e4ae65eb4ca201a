//! The end of the search of any fit: the estimates of its free numbers, and what follows from the likelihood about them.

use faer::Mat;

use super::estimate::Estimate;
use super::free::{FreeParameter, Role};
use super::interval::{self, TWO_SIDED};
use super::matrix;
use super::search::{Objective, Optimum};
use super::standardised::Standardised;
use crate::error::as_many;
use crate::monitor::{Monitor, Part};
use crate::{Error, Result};

/// Standard error of a logarithm above which only a limit is reported.
const VAGUE: f64 = 1.0;

/// A search that has ended, with the likelihood that it has searched.
#[derive(Debug)]
pub(super) struct Ended<L: Objective> {
    pub likelihood: L,
    pub optimum: Optimum<L::Point>,
}

/// The free numbers at the end of a search.
pub(super) struct FreeNumbers {
    pub parameters: Vec<Estimate>,
    /// The covariance of their coordinates.
    pub of_coordinates: Mat<f64>,
    /// That of their values, row by row.
    pub covariance: Vec<f64>,
}

impl<L: Objective> Ended<L> {
    /// Values and errors of the free numbers, from the information of which eigenvalues below `least` count as 0. `widen` adds to
    /// the covariance of the coordinates errors that the information does not contain.
    ///
    /// # Errors
    /// Numbers that `what` has been measured does not determine; errors of the solver; stopped by the monitor.
    pub fn numbers(
        &self,
        (what, least): (&str, f64),
        widen: impl FnOnce(&mut Mat<f64>),
        monitor: &mut dyn Monitor,
    ) -> Result<FreeNumbers> {
        let Self { likelihood, optimum } = self;
        let (free, information) = (likelihood.free(), &optimum.score.information);
        let count = free.len();
        let active: Vec<usize> =
            (0..count).filter(|&k| !optimum.at_bound[k] && information[(k, k)] > 0.0).collect();
        refuse_unseen((free, &optimum.at_bound), information, what)?;
        refuse_undetermined(free, information, &active, (what, least))?;
        let covariance = matrix::covariance(information, &active);
        let mut covariance = covariance.unwrap_or_else(|| Mat::zeros(count, count));
        widen(&mut covariance);
        // A limit is a rise above the minimum.
        let with_limits = optimum.converged && likelihood.refuse_unmeasured().is_ok();
        let share = 1.0 / count as f64;
        let parameters = (0..count).map(|k| {
            let part = &mut Part::new(monitor, k as f64 * share, share);
            estimate((likelihood, optimum), (k, covariance[(k, k)].sqrt()), with_limits, part)
        });
        let parameters = parameters.collect::<Result<Vec<_>>>()?;
        let slope = |k: usize| free[k].slope(optimum.coordinates[k]);
        let rows = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
        let of_values = rows.map(|(i, j)| covariance[(i, j)] * slope(i) * slope(j)).collect();
        Ok(FreeNumbers { parameters, of_coordinates: covariance, covariance: of_values })
    }

    /// The search, if forces have been measured.
    ///
    /// # Errors
    /// A measurement that is only planned.
    pub fn measured(&self) -> Result<&Self> {
        self.likelihood.refuse_unmeasured().map(|()| self)
    }

    pub fn interval_by_profile(
        &self,
        parameters: &[Estimate],
        name: &str,
        monitor: &mut dyn Monitor,
    ) -> Result<[f64; 2]> {
        let number = self.number(name)?;
        let Self { likelihood, optimum } = self.measured()?;
        let slope = likelihood.free()[number].slope(optimum.coordinates[number]);
        interval::by_profile((likelihood, optimum), (number, parameters[number].error / slope), monitor)
    }

    pub fn profile(&self, name: &str, value: f64, monitor: &mut dyn Monitor) -> Result<f64> {
        let number = self.number(name)?;
        let Self { likelihood, optimum } = self.measured()?;
        let parameter = &likelihood.free()[number];
        let u = parameter.coordinate(value);
        if !u.is_finite() {
            let above = if parameter.logarithmic { " above 0" } else { "" };
            return Err(Error::invalid("values", format!("a finite number{above}"), value));
        }
        let lowest = interval::profile((likelihood, optimum), (number, u), monitor)?;
        Ok(lowest - L::deviance(&optimum.trial))
    }

    pub fn profile_values(&self, parameters: &[Estimate], name: &str, count: usize) -> Result<Vec<f64>> {
        /// Standard errors to both sides.
        const WIDTH: f64 = 3.0;
        let number = self.number(name)?;
        let (parameter, u) = (&self.likelihood.free()[number], self.optimum.coordinates[number]);
        let error = parameters[number].error / parameter.slope(u);
        let known = error > 0.0 && (error <= VAGUE || !parameter.logarithmic);
        let width = match parameters[number].limit {
            Some(limit) if !parameter.logarithmic => limit,
            _ => WIDTH * if known { error } else { VAGUE },
        };
        let place = |i: usize| 2.0 * i as f64 / count.saturating_sub(1).max(1) as f64 - 1.0;
        Ok((0..count)
            .map(|i| parameter.value((u + width * place(i)).clamp(parameter.bounds[0], parameter.bounds[1])))
            .collect())
    }

    pub fn log_likelihood(&self, values: &[f64], monitor: &mut dyn Monitor) -> Result<(f64, Vec<f64>)> {
        let likelihood = &self.measured()?.likelihood;
        let free = likelihood.free();
        as_many("values", values.len(), (free.len(), "values, one for each free number"))?;
        let coordinates: Vec<f64> =
            free.iter().zip(values).map(|(parameter, &value)| parameter.coordinate(value)).collect();
        let known = if coordinates.iter().all(|u| u.is_finite()) {
            likelihood.unrestricted(&coordinates, monitor)?
        } else {
            None
        };
        let Some((deviance, halved)) = known else {
            return Ok((f64::NEG_INFINITY, vec![f64::NAN; values.len()]));
        };
        let slope = |k: usize| -halved[(k, 0)] / free[k].slope(coordinates[k]);
        Ok((-0.5 * deviance, (0..values.len()).map(slope).collect()))
    }

    pub fn standardised(&self, estimates: (&[Estimate], &[f64])) -> Result<Standardised<'_>>
    where
        L: std::fmt::Debug + Sync,
    {
        let Self { likelihood, optimum } = self.measured()?;
        Standardised::new((likelihood, &optimum.coordinates), estimates)
    }

    fn number(&self, name: &str) -> Result<usize> {
        let free = self.likelihood.free();
        free.iter().position(|parameter| parameter.name == name).ok_or_else(|| {
            let names: Vec<_> = free.iter().map(|parameter| parameter.name.as_str()).collect();
            Error::invalid("name", format!("one of {}", names.join(", ")), name)
        })
    }
}

/// The methods that the estimates of every fit have, of the type of its estimates.
macro_rules! methods_of_estimates {
    ($estimates:ty) => {
        impl $estimates {
            /// The estimate of a name.
            pub fn estimate(&self, name: &str) -> Option<&$crate::fit::Estimate> {
                self.parameters.iter().find(|estimate| estimate.name == name)
            }

            /// Coefficients above 0.5, without sign, between the errors of two estimates.
            pub fn correlations(&self) -> Vec<$crate::fit::Correlation> {
                $crate::fit::estimate::correlations(&self.parameters, &self.covariance)
            }

            /// The interval of 95 % of a number by the profile of the likelihood: where −2 ln L, lowest in all other numbers,
            /// has risen by 3.84; for independent errors of one unknown size by ν ln(1 + t²/ν), with Student's t of ν = n − p
            /// degrees of freedom. Where a fit to curves of force has free sizes of errors, L is the restricted likelihood, but
            /// for thresholds of free form.
            ///
            /// # Errors
            /// A name that was not free; a measurement that is only planned; errors of the solver; stopped by the monitor.
            pub fn interval_by_profile(
                &self,
                name: &str,
                monitor: &mut dyn $crate::monitor::Monitor,
            ) -> $crate::Result<[f64; 2]> {
                self.ended.interval_by_profile(&self.parameters, name, monitor)
            }

            /// By how much −2 ln L, lowest in all other numbers, is above its minimum where a number has another value; ∞ where
            /// the likelihood is 0. L is that of [`Self::interval_by_profile`].
            ///
            /// # Errors
            /// As there; a value that is not finite, or not above 0 for a number that is.
            pub fn profile(
                &self,
                name: &str,
                value: f64,
                monitor: &mut dyn $crate::monitor::Monitor,
            ) -> $crate::Result<f64> {
                self.ended.profile(name, value, monitor)
            }

            /// `count` values of a number for [`Self::profile`], from three standard errors below its estimate to three above;
            /// of the logarithm for numbers above 0, where an error of 1 is taken for one that is larger or unknown.
            ///
            /// # Errors
            /// A name that was not free.
            pub fn profile_values(&self, name: &str, count: usize) -> $crate::Result<Vec<f64>> {
                self.ended.profile_values(&self.parameters, name, count)
            }

            /// ln L at values of the free numbers, in their order, and its gradient, priors included; −∞ and NaN where the
            /// likelihood is 0. The covariance of the noise of contacts on a curve of force is that of the estimates, scaled by
            /// N⟨k⟩².
            ///
            /// # Errors
            /// Another number of values than of free numbers; a measurement that is only planned; errors of the solver; stopped
            /// by the monitor.
            pub fn log_likelihood(
                &self,
                values: &[f64],
                monitor: &mut dyn $crate::monitor::Monitor,
            ) -> $crate::Result<(f64, Vec<f64>)> {
                self.ended.log_likelihood(values, monitor)
            }

            /// The posterior in standardised coordinates.
            ///
            /// # Errors
            /// A measurement that is only planned; no number with an error.
            pub fn standardised(&self) -> $crate::Result<$crate::fit::Standardised<'_>> {
                self.ended.standardised((&self.parameters, &self.covariance))
            }
        }
    };
}
pub(super) use methods_of_estimates;

/// # Errors
/// A number on which `what`, a curve or a record, does not depend at all, unless it is at the end of its range or says how large
/// errors are.
fn refuse_unseen(
    (free, at_bound): (&[FreeParameter], &[bool]),
    information: &Mat<f64>,
    what: &str,
) -> Result<()> {
    let seen = |k: usize| at_bound[k] || free[k].is_of_errors() || information[(k, k)] > 0.0;
    match (0..free.len()).find(|&k| !seen(k)) {
        Some(k) => {
            let expected = format!("numbers that the {what} determines (fix this one, or give it a prior)");
            Err(Error::invalid("free", expected, format!("{}, on which it does not depend", free[k].name)))
        }
        None => Ok(()),
    }
}

/// # Errors
/// Numbers that can change together without a change of `what`, a curve or a record: along an eigenvector of the scaled
/// information whose eigenvalue is below `least`.
fn refuse_undetermined(
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
fn estimate<O: Objective>(
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
    let end = |side: f64| parameter.value((u + side * width).clamp(parameter.bounds[0], parameter.bounds[1]));
    let interval = limit.map_or([end(-1.0), end(1.0)], |limit| [0.0, limit]);
    Ok(Estimate { name: parameter.name.clone(), value, error: error * parameter.slope(u), interval, limit })
}

/// A number rounded to three digits.
fn significant(value: f64) -> f64 {
    let unit = 10_f64.powf(value.abs().log10().floor() - 2.0);
    if unit.is_normal() { (value / unit).round() * unit } else { value }
}
