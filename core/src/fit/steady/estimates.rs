//! What a fit to a record in steady sliding has found.

use faer::Mat;

use super::super::ended::{Ended, methods_of_estimates};
use super::super::estimate::Estimate;
use super::super::friction::{FrictionEstimates, friction};
use super::super::misfit::{self, Misfit};
use super::likelihood::{SteadyLikelihood, SteadyPoint};
use super::record::{SteadyRecord, inverse, multiplicity};
use crate::Result;
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part};

/// Eigenvalue of the scaled information below which a direction counts as undetermined: the square of the relative error of the
/// derivatives by differences.
const UNDETERMINED: f64 = 1e-8;

/// Mean advances from break to break of the pull of which friction is reported.
const LIVES: f64 = 5.0;

/// The periodogram of a record and what is expected of it, for the wave numbers q_k = 2πk/nh, k = 1 … n/2, of a record of n
/// readings at the spacing h.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct FittedSpectrum {
    /// q_k, radians per length.
    pub wave_numbers: Vec<f64>,
    /// The periodogram h|Σ_j F_j e^{−iq_k jh}|²/n: forces squared times a length.
    pub periodogram: Vec<f64>,
    /// Its expectation: of the contacts of the estimated numbers, aliasing, leakage and the error of readings included.
    pub expected: Vec<f64>,
}

/// What a fit to a record in steady sliding has found.
#[derive(Debug)]
pub struct SteadyEstimates {
    /// One for each free number, that of the error of a reading last.
    pub parameters: Vec<Estimate>,
    /// Covariance of their values, row by row.
    pub covariance: Vec<f64>,
    /// Whether the search has converged; otherwise the values are the last ones.
    pub converged: bool,
    /// Solutions of the master equation that the search took, without those for derivatives.
    pub solutions: usize,
    /// How well the record is described. χ² sums the squares of its whitened Fourier components; they are made a record again
    /// for the test of whiteness.
    pub misfit: Misfit,
    /// The standard deviation of the independent error of a reading.
    pub reading: f64,
    /// The reading of the force where there is none.
    pub offset: f64,
    /// The periodogram and its expectation.
    pub spectrum: FittedSpectrum,
    ended: Ended<SteadyLikelihood>,
}

methods_of_estimates!(SteadyEstimates);

impl SteadyEstimates {
    /// Values, errors and all that follows from the end of a search.
    ///
    /// # Errors
    /// Numbers that the record does not determine; errors of the solver; stopped by the monitor.
    pub(super) fn new(ended: Ended<SteadyLikelihood>, monitor: &mut dyn Monitor) -> Result<Self> {
        let found = ended.numbers(("record", UNDETERMINED), |_| {}, monitor)?;
        let Ended { likelihood, optimum } = &ended;
        let point = &optimum.trial;
        Ok(Self {
            parameters: found.parameters,
            covariance: found.covariance,
            converged: optimum.converged,
            solutions: optimum.solutions,
            misfit: misfit_of(likelihood, point),
            reading: point.reading,
            offset: point.offset,
            spectrum: spectrum_of(likelihood, point),
            ended,
        })
    }

    /// The contacts of the estimated numbers.
    pub fn equation(&self) -> &MasterEquation {
        &self.ended.optimum.trial.equation
    }

    /// What was measured.
    pub fn record(&self) -> &SteadyRecord {
        &self.ended.likelihood.fit.record
    }

    /// F_s, F_k, X* and K_c, with the errors that follow from the covariance of the estimates. F_s and K_c are those of a pull
    /// from the initial state of the first values, of which the record contains nothing.
    ///
    /// # Errors
    /// Those of [`crate::master::Pull::friction_gradients`].
    pub fn friction(&self, monitor: &mut dyn Monitor) -> Result<FrictionEstimates> {
        let equation = self.equation();
        let distance = LIVES * equation.steady_state().mean_life();
        let pull = equation.pull_with(distance, None, &mut Part::new(monitor, 0.0, 0.3))?;
        let part = &mut Part::new(monitor, 0.3, 0.7);
        friction((equation, &pull, 0.0), (&self.ended.likelihood.free, &self.covariance), part)
    }
}

fn spectrum_of(likelihood: &SteadyLikelihood, point: &SteadyPoint) -> FittedSpectrum {
    let record = &likelihood.fit.record;
    let components = 1..=likelihood.readings() / 2;
    FittedSpectrum {
        wave_numbers: record.wave_numbers(),
        periodogram: components.clone().map(|k| record.spacing * likelihood.squares[k]).collect(),
        expected: components.map(|k| record.spacing * point.square(k)).collect(),
    }
}

fn misfit_of(likelihood: &SteadyLikelihood, point: &SteadyPoint) -> Misfit {
    let n = likelihood.readings();
    let chi_squared = (0..=n / 2)
        .map(|k| multiplicity(k, n) * likelihood.observed(k, point) / point.square(k))
        .sum::<f64>();
    let of_errors = likelihood.free.iter().filter(|parameter| parameter.is_of_errors()).count();
    let degrees_of_freedom = n - (likelihood.free.len() - of_errors);
    // The size of the noise is that of the record where its factor is free.
    let factor = |name: &str| likelihood.free.iter().any(|parameter| parameter.name == name);
    let estimated = of_errors > 0 || factor("count") || factor("stiffness");
    let modes = likelihood.fit.record.modes().into_iter().enumerate();
    let whitened = inverse(modes.map(|(k, mode)| mode / point.square(k).sqrt()).collect(), n);
    Misfit {
        chi_squared,
        degrees_of_freedom,
        probability: (!estimated).then(|| misfit::probability(chi_squared, degrees_of_freedom)),
        whiteness: misfit::whiteness(&[&Mat::from_fn(n, 1, |i, _| whitened[i])]),
        deviance: point.deviance,
        akaike: point.deviance + 2.0 * likelihood.free.len() as f64,
    }
}
