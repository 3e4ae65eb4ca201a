//! What a fit to forces at several velocities has found.

use faer::Mat;

use super::super::ended::{Ended, methods_of_estimates};
use super::super::estimate::Estimate;
use super::super::misfit::{self, Misfit};
use super::super::search::Optimum;
use super::likelihood::{VelocityLikelihood, VelocityPoint};
use super::measured::MeasuredVelocityCurve;
use crate::Result;
use crate::contacts::Contacts;
use crate::master::MasterEquation;
use crate::monitor::{Monitor, Part};

/// Eigenvalue of the scaled information below which a direction counts as undetermined: the square of the relative error of the
/// derivatives by differences.
const UNDETERMINED: f64 = 1e-10;
/// Velocities of the smooth curve.
const POINTS: usize = 33;

/// The curve of a fit: forces as readings would be, background and offset included.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct FittedVelocityCurve {
    /// Velocities at equal ratios, from the lowest to the highest that was measured.
    pub velocities: Vec<f64>,
    /// Expected forces.
    pub forces: Vec<f64>,
    /// Their standard errors, which follow from the covariance of the estimates.
    pub errors: Vec<f64>,
}

/// What a fit to forces at several velocities has found.
#[derive(Debug)]
pub struct VelocityCurveEstimates {
    /// One for each free number.
    pub parameters: Vec<Estimate>,
    /// Covariance of their values, row by row.
    pub covariance: Vec<f64>,
    /// Whether the search has converged; otherwise the values are the last ones.
    pub converged: bool,
    /// Curves that the search took, without those for derivatives: one solution for each velocity.
    pub solutions: usize,
    /// How well the readings are described. Whiteness is that of residuals in the order of velocities.
    pub misfit: Misfit,
    /// The standard deviation of a reading: given or estimated; the root mean square of errors that are given one by one.
    pub reading: f64,
    /// The reading of the force where there is none.
    pub offset: f64,
    /// The background force.
    pub background: f64,
    /// Expected forces at the readings.
    pub expected: Vec<f64>,
    /// Standard deviations of the readings about them.
    pub std: Vec<f64>,
    /// The smooth curve.
    pub fitted: FittedVelocityCurve,
    equation: MasterEquation,
    ended: Ended<VelocityLikelihood>,
}

methods_of_estimates!(VelocityCurveEstimates);

impl VelocityCurveEstimates {
    /// Values, errors and all that follows from the end of a search.
    ///
    /// # Errors
    /// Numbers that the curve does not determine; errors of the solver; stopped by the monitor.
    pub(super) fn new(ended: Ended<VelocityLikelihood>, monitor: &mut dyn Monitor) -> Result<Self> {
        let found = ended.numbers(("curve", UNDETERMINED), |_| {}, &mut Part::new(monitor, 0.0, 0.1))?;
        let Ended { likelihood, optimum } = &ended;
        let (point, measured) = (&optimum.trial, &likelihood.fit.curve);
        let lowest = likelihood.velocities.first().copied().unwrap_or(1.0);
        let mean_square = point.std.iter().map(|s| s * s).sum::<f64>() / point.std.len() as f64;
        Ok(Self {
            parameters: found.parameters,
            covariance: found.covariance,
            converged: optimum.converged,
            solutions: optimum.solutions,
            misfit: misfit_of(likelihood, point),
            reading: mean_square.sqrt(),
            offset: likelihood.offset(&optimum.coordinates),
            background: likelihood.background(&optimum.coordinates),
            expected: measured.forces.iter().zip(&point.residuals).map(|(force, r)| force - r).collect(),
            std: point.std.clone(),
            fitted: fitted((likelihood, optimum), &found.of_coordinates, &mut Part::new(monitor, 0.1, 0.8))?,
            equation: likelihood.equation_at(
                &optimum.coordinates,
                lowest,
                &mut Part::new(monitor, 0.9, 0.1),
            )?,
            ended,
        })
    }

    /// The contacts of the estimated numbers.
    pub fn contacts(&self) -> &Contacts {
        self.equation.contacts()
    }

    /// The master equation of the estimated numbers, of contacts that have just re-formed, at the lowest velocity.
    pub fn equation(&self) -> &MasterEquation {
        &self.equation
    }

    /// What was measured.
    pub fn curve(&self) -> &MeasuredVelocityCurve {
        &self.ended.likelihood.fit.curve
    }

    /// The largest estimated error of F_k/(N_c⟨k⟩), a length, of the solutions at the measured velocities.
    pub fn error_estimate(&self) -> f64 {
        self.ended.optimum.trial.error
    }
}

/// The smooth curve, with the errors √(gᵀVg) of the covariance V of the coordinates, g the derivatives of a force.
fn fitted(
    (likelihood, optimum): (&VelocityLikelihood, &Optimum<VelocityPoint>),
    covariance: &Mat<f64>,
    monitor: &mut dyn Monitor,
) -> Result<FittedVelocityCurve> {
    let [Some(&low), Some(&high)] = [likelihood.velocities.first(), likelihood.velocities.last()] else {
        return Ok(FittedVelocityCurve::default());
    };
    let count = if high > low { POINTS } else { 1 };
    let share = |i: usize| i as f64 / (count - 1).max(1) as f64;
    // Both ends are what they are, without rounding.
    let at = |i: usize| match share(i) {
        0.0 => low,
        1.0 => high,
        share => (low.ln() + share * (high.ln() - low.ln())).exp(),
    };
    let velocities: Vec<f64> = (0..count).map(at).collect();
    let coordinates = optimum.coordinates.as_slice();
    let jobs: Vec<(&[f64], f64)> = velocities.iter().map(|&v| (coordinates, v)).collect();
    let friction = likelihood.frictions(&jobs, &mut Part::new(monitor, 0.0, 0.2))?;
    let friction: Vec<f64> =
        friction.into_iter().map(|found| found.map_or(f64::NAN, |found| found.0)).collect();
    let part = &mut Part::new(monitor, 0.2, 0.8);
    let derivatives = likelihood.derivatives(coordinates, (&velocities, &friction), part)?;
    let variances = &derivatives * covariance * derivatives.transpose();
    let constant = optimum.trial.constant;
    Ok(FittedVelocityCurve {
        velocities,
        forces: friction.iter().map(|friction| friction + constant).collect(),
        errors: (0..count).map(|i| variances[(i, i)].max(0.0).sqrt()).collect(),
    })
}

fn misfit_of(likelihood: &VelocityLikelihood, point: &VelocityPoint) -> Misfit {
    let whitened: Vec<f64> = point.residuals.iter().zip(&point.std).map(|(r, s)| r / s).collect();
    let chi_squared = whitened.iter().map(|r| r * r).sum();
    let estimated = likelihood.estimates_errors();
    let count = likelihood.free.len();
    let degrees_of_freedom = likelihood.readings().saturating_sub(count);
    let mut order: Vec<usize> = (0..whitened.len()).collect();
    order.sort_by_key(|&i| likelihood.places[i]);
    let numbers = count + usize::from(estimated);
    Misfit {
        chi_squared,
        degrees_of_freedom,
        probability: (!estimated && degrees_of_freedom > 0)
            .then(|| misfit::probability(chi_squared, degrees_of_freedom)),
        whiteness: misfit::whiteness(&[&Mat::from_fn(whitened.len(), 1, |i, _| whitened[order[i]])]),
        deviance: point.deviance,
        akaike: point.deviance + 2.0 * numbers as f64,
    }
}
