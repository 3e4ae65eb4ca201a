//! The likelihood where the expected curve is taken for a linear function of the numbers, as it is about one solution of the master
//! equation.
//!
//! Sizes of errors, and the number of contacts beside their stiffness, change the likelihood far from the quadratic function that a
//! step of Newton follows, and the curve hardly. With the curve along its tangent they are found without further solutions.

use faer::Mat;

use super::expected::ExpectedReadings;
use super::free::FreeParameter;
use super::likelihood::{Errors, Likelihood, LikelihoodPoint};
use super::score::Score;
use super::search::{Objective, search_from_score};
use crate::Result;
use crate::monitor::{Monitor, report};

/// The likelihood with curves along their tangents at a point.
struct Linearised<'a> {
    likelihood: &'a Likelihood,
    /// The coordinates of the point, and the readings expected there.
    at: &'a [f64],
    readings: Vec<&'a ExpectedReadings>,
    /// The derivatives of the readings of each curve by the coordinates.
    derivatives: Vec<Mat<f64>>,
}

/// The coordinates of the highest likelihood with curves along their tangents at a point, with the numbers that are `held` fixed and to
/// within `short`; `None` where no size of errors is free, or no such coordinates are found.
///
/// # Errors
/// Errors of the solver; stopped by the monitor.
pub(super) fn highest(
    likelihood: &Likelihood,
    (at, point, score): (&[f64], &LikelihoodPoint, &Score),
    (held, short): (&[bool], f64),
    monitor: &mut dyn Monitor,
) -> Result<Option<Vec<f64>>> {
    let modelled = matches!(likelihood.errors, Errors::Modelled(_)) && likelihood.smoothness.is_none();
    if !modelled || !likelihood.has_free_errors() {
        return Ok(None);
    }
    let derivatives = likelihood.derivatives(at, point, monitor)?;
    let readings = point.curves.iter().map(|curve| &curve.readings).collect();
    let linearised = Linearised { likelihood, at, readings, derivatives };
    let Some(start) = linearised.trial(at, monitor)? else { return Ok(None) };
    let found = search_from_score(&linearised, (at, start, score.clone()), (held, short), monitor)?;
    Ok(found.converged.then_some(found.coordinates))
}

impl Linearised<'_> {
    /// The readings of curve `curve` along its tangent.
    fn readings(&self, curve: usize, step: &Mat<f64>) -> ExpectedReadings {
        let mut readings = self.readings[curve].clone();
        let change = &self.derivatives[curve] * step;
        readings.forces.iter_mut().enumerate().for_each(|(i, force)| *force += change[(i, 0)]);
        readings
    }
}

impl Objective for Linearised<'_> {
    type Point = LikelihoodPoint;

    fn free(&self) -> &[FreeParameter] {
        &self.likelihood.free
    }

    fn halvings(&self) -> i32 {
        self.likelihood.halvings()
    }

    fn trial(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<LikelihoodPoint>> {
        report(monitor, 0.0)?;
        let step = Mat::from_fn(self.at.len(), 1, |k, _| coordinates[k] - self.at[k]);
        let readings = (0..self.readings.len()).map(|curve| self.readings(curve, &step)).collect();
        Ok(self.likelihood.at_readings(coordinates, readings))
    }

    fn deviance(point: &LikelihoodPoint) -> f64 {
        point.restricted_deviance()
    }

    fn score(&self, coordinates: &[f64], point: &LikelihoodPoint, _: &mut dyn Monitor) -> Result<Score> {
        Ok(self.likelihood.score_by(self.derivatives.clone(), (coordinates, point)))
    }
}
