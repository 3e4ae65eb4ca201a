//! Coordinates in which the likelihood of a fit is near a standard normal distribution, for samplers.

use faer::{Mat, Side};

use super::estimate::Estimate;
use super::free::FreeParameter;
use super::search::Objective;
use crate::monitor::Monitor;
use crate::{Error, Result};

/// A likelihood of any kind, with its priors, as a function of the coordinates of free numbers.
pub(super) trait LogDensity: std::fmt::Debug + Sync {
    fn free(&self) -> &[FreeParameter];

    /// −2 ln L and half its slope; `None` where the likelihood is 0.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    fn deviance(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<(f64, Mat<f64>)>>;
}

impl<O: Objective + std::fmt::Debug + Sync> LogDensity for O {
    fn free(&self) -> &[FreeParameter] {
        Objective::free(self)
    }

    fn deviance(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<(f64, Mat<f64>)>> {
        self.unrestricted(coordinates, monitor)
    }
}

/// The posterior of a fit in coordinates z in which the expected information at the estimates is the unit matrix: u = û + L z,
/// with u the logarithm of a number above 0 or the number itself, û its estimate and L Lᵀ the covariance of u.
///
/// Numbers that are known only by a limit, or are at the end of their range, keep their estimates.
#[derive(Debug)]
pub struct Standardised<'a> {
    likelihood: &'a dyn LogDensity,
    /// û.
    estimates: &'a [f64],
    /// Which of the free numbers are varied.
    varied: Vec<usize>,
    /// L.
    factor: Mat<f64>,
}

impl<'a> Standardised<'a> {
    /// The posterior about the `estimates` of a search, which have these `parameters` and the `covariance` of their values.
    ///
    /// # Errors
    /// No number with an error.
    pub(super) fn new(
        (likelihood, estimates): (&'a dyn LogDensity, &'a [f64]),
        (parameters, covariance): (&[Estimate], &[f64]),
    ) -> Result<Self> {
        let known = |k: &usize| parameters[*k].error > 0.0 && parameters[*k].limit.is_none();
        let varied: Vec<usize> = (0..parameters.len()).filter(known).collect();
        let none = || Error::invalid("free", "a number with a finite error", "none");
        if varied.is_empty() {
            return Err(none());
        }
        let slope = |k: usize| likelihood.free()[k].slope(estimates[k]);
        let covariance = Mat::from_fn(varied.len(), varied.len(), |i, j| {
            let (a, b) = (varied[i], varied[j]);
            covariance[a * parameters.len() + b] / (slope(a) * slope(b))
        });
        let factor = covariance.llt(Side::Lower).map_err(|_| none())?.L().to_owned();
        Ok(Self { likelihood, estimates, varied, factor })
    }
}

impl Standardised<'_> {
    /// The names of the n numbers that are varied.
    pub fn names(&self) -> Vec<&str> {
        self.varied.iter().map(|&k| self.likelihood.free()[k].name.as_str()).collect()
    }

    /// The values of these numbers at z, a list of n numbers.
    ///
    /// # Panics
    /// Another number of coordinates.
    pub fn values(&self, z: &[f64]) -> Vec<f64> {
        let coordinates = self.coordinates(z);
        self.varied.iter().map(|&k| self.likelihood.free()[k].value(coordinates[k])).collect()
    }

    /// ln L + ln(prior) at z, and its gradient by z; −∞ and zeros where the likelihood is 0, and beyond the range of a number.
    ///
    /// The prior is flat in u where none is given. The covariance of the noise of contacts is that of the estimates, scaled by
    /// N⟨k⟩². With independent errors of unknown size, L is the highest for any size; up to a constant this is the integral over
    /// the size with a flat prior of its logarithm.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    ///
    /// # Panics
    /// Another number of coordinates than [`Self::names`] has.
    pub fn log_density(&self, z: &[f64], monitor: &mut dyn Monitor) -> Result<(f64, Vec<f64>)> {
        let coordinates = self.coordinates(z);
        let within = |&k: &usize| {
            let [low, high] = self.likelihood.free()[k].bounds;
            (low..=high).contains(&coordinates[k])
        };
        let known = if self.varied.iter().all(within) {
            self.likelihood.deviance(&coordinates, monitor)?
        } else {
            None
        };
        let Some((deviance, halved)) = known else { return Ok((f64::NEG_INFINITY, vec![0.0; z.len()])) };
        let slope = |j: usize| {
            let rows = self.varied.iter().enumerate().skip(j);
            -rows.map(|(i, &k)| self.factor[(i, j)] * halved[(k, 0)]).sum::<f64>()
        };
        Ok((-0.5 * deviance, (0..z.len()).map(slope).collect()))
    }

    /// The coordinates u of all free numbers.
    fn coordinates(&self, z: &[f64]) -> Vec<f64> {
        assert_eq!(z.len(), self.varied.len(), "one coordinate for each number");
        let mut coordinates = self.estimates.to_vec();
        for (i, &k) in self.varied.iter().enumerate() {
            coordinates[k] += (0..=i).map(|j| self.factor[(i, j)] * z[j]).sum::<f64>();
        }
        coordinates
    }
}
