//! What a fit to curves of force has found: values with errors and intervals, the readings as described, the misfit.

use super::ended::{Ended, methods_of_estimates};
use super::error_covariance::KnownCovariance;
use super::estimate::Estimate;
use super::expected::ExpectedReadings;
use super::free::FreeParameter;
use super::likelihood::{Errors, Likelihood};
use super::measurement::{Machine, Measurement};
use super::misfit::{self, Misfit};
use crate::Result;
use crate::master::{MasterEquation, Pull};
use crate::monitor::Monitor;

/// Eigenvalue of the scaled information below which a direction counts as undetermined.
const UNDETERMINED: f64 = 1e-10;
/// The same for thresholds of free form: the common level of the coefficients changes no density, and is held weakly.
const UNDETERMINED_FORM: f64 = 1e-12;

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
    pub(super) ended: Ended<Likelihood>,
}

methods_of_estimates!(Estimates);

impl Estimates {
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
}

impl Ended<Likelihood> {
    /// Values, errors and all that follows.
    ///
    /// # Errors
    /// Numbers that the data do not determine; errors of the solver; stopped by the monitor.
    pub fn estimates(self, monitor: &mut dyn Monitor) -> Result<Estimates> {
        let Self { likelihood, optimum } = &self;
        let least = if likelihood.smoothness.is_some() { UNDETERMINED_FORM } else { UNDETERMINED };
        let widen = |covariance: &mut _| self.add_kurtosis(covariance);
        let found = self.numbers(("curve", least), widen, monitor)?;
        Ok(Estimates {
            parameters: found.parameters,
            covariance: found.covariance,
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

    fn misfit(&self) -> Misfit {
        let Self { likelihood, optimum } = self;
        let chi_squared = optimum.trial.chi_squared();
        let of_errors = likelihood.free.iter().filter(|parameter| parameter.is_of_errors()).count();
        let determined = likelihood.determined(&optimum.score.information, &optimum.at_bound);
        // N and ⟨k⟩ change a curve alike.
        let alike = likelihood.divided_noises() as f64;
        let of_curve = determined - of_errors as f64 - alike;
        let degrees_of_freedom = likelihood.count().saturating_sub(of_curve.round() as usize);
        let profiled =
            matches!(likelihood.errors, Errors::ProfiledWhite { .. } | Errors::RenewedWhite { .. });
        let estimated = profiled || alike > 0.0 || likelihood.free.iter().any(FreeParameter::is_of_errors);
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
