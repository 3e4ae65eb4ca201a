//! What the fitted contacts would show at any positions.

use super::Estimates;
use super::expected::{ExpectedReadings, Values};
use super::free::values_at;
use super::measurement::Measurement;
use crate::error::all_finite;
use crate::monitor::{Monitor, Part};
use crate::numerics::order::sort_by_number;
use crate::{Error, Result};

/// Readings that are expected of the fitted contacts.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Prediction {
    /// The expected forces.
    pub forces: Vec<f64>,
    /// The standard deviation of a reading about them: noise of contacts or errors of positions, independent error and
    /// drift.
    pub std: Vec<f64>,
    /// The standard error of the expected forces, from the covariance of the estimates.
    pub error: Vec<f64>,
}

impl Estimates {
    /// The readings of curve `curve` that are expected at positions, in any order, as they are measured: with offset, trend, origin
    /// and compliance of the machine.
    ///
    /// With J the derivatives of the expected force by the free numbers, and V the covariance of their estimates, the standard
    /// error is √(J V Jᵀ).
    ///
    /// # Errors
    /// A number that no curve has; positions that are not finite; one before which the machine slips; errors of the solver; stopped
    /// by the monitor.
    pub fn predict(&self, curve: usize, positions: &[f64], monitor: &mut dyn Monitor) -> Result<Prediction> {
        let count = self.curves().len();
        if curve >= count {
            return Err(Error::invalid(
                "curve",
                format!("a number below {count}, that of the curves"),
                curve,
            ));
        }
        all_finite("position", positions)?;
        let mut order: Vec<usize> = (0..positions.len()).collect();
        sort_by_number(&mut order, |&a| positions[a]);
        let Some(&last) = order.last() else { return Ok(Prediction::default()) };
        let (likelihood, coordinates) = (&self.ended.likelihood, &self.ended.optimum.coordinates);
        let values = values_at(&likelihood.free, coordinates);
        let numbers = (likelihood.free.as_slice(), values.as_slice());
        let rising = order.iter().map(|&i| positions[i]).collect();
        let machine = self.curves()[curve].machine;
        let asked = Measurement { positions: rising, machine, ..Measurement::default() };
        let part = &mut Part::new(monitor, 0.0, 0.5);
        let found = ExpectedReadings::of_curve((curve, &asked), &likelihood.fit.equation, numbers, part)?;
        let found = found.ok_or_else(|| {
            let expected = "positions up to which the machine does not slip";
            Error::invalid("position", expected, positions[last])
        })?;
        let sorted = Prediction {
            std: self.deviations(&found, &mut Part::new(monitor, 0.5, 0.2))?,
            error: self.errors_of(
                &found,
                (curve, &asked.positions),
                numbers,
                &mut Part::new(monitor, 0.7, 0.3),
            )?,
            forces: found.forces,
        };
        Ok(sorted.at_places(&order))
    }

    /// The standard deviations of readings.
    fn deviations(&self, found: &ExpectedReadings, monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        let drift = self.ended.optimum.trial.curves[0].sizes.drift[0];
        let slow = self.reading.hypot(drift);
        let of_positions =
            self.ended.likelihood.fit.errors.position.map(|std| found.variances_by_positions(std));
        let mut deviations: Vec<f64> = match of_positions {
            Some(variances) => variances.iter().map(|variance| slow.hypot(variance.sqrt())).collect(),
            None => vec![slow; found.forces.len()],
        };
        if self.ended.likelihood.errors.have_contacts() {
            let contacts = &found.contacts;
            let noise = contacts.pull.force_std_with(contacts.equation.contacts().count, monitor)?;
            let at = |(&x, followed): (&f64, &f64)| noise(x.max(0.0)) * followed;
            let of_contacts = found.driven.positions.iter().zip(&found.driven.followed).map(at);
            deviations.iter_mut().zip(of_contacts).for_each(|(all, own)| *all = own.hypot(*all));
        }
        Ok(deviations)
    }

    /// The standard errors of the expected forces.
    fn errors_of(
        &self,
        found: &ExpectedReadings,
        (curve, measured): (usize, &[f64]),
        (free, values): Values<'_>,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<f64>> {
        let gradients = found.gradients((curve, free), monitor)?;
        let derivatives = found.derivatives((curve, measured), &gradients, (free, values));
        let count = free.len();
        let slopes: Vec<f64> =
            free.iter().zip(values).map(|(n, &value)| n.slope(n.coordinate(value))).collect();
        let by_value = |i: usize, k: usize| derivatives[(i, k)] / slopes[k];
        let variance = |i: usize| -> f64 {
            let pairs = (0..count).flat_map(|a| (0..count).map(move |b| (a, b)));
            pairs.map(|(a, b)| self.covariance[a * count + b] * by_value(i, a) * by_value(i, b)).sum()
        };
        // Rounding may make the variance of what does not vary negative.
        Ok((0..measured.len()).map(|i| variance(i).max(0.0).sqrt()).collect())
    }
}

impl Prediction {
    /// The same with entry i moved to the place `order[i]`.
    fn at_places(&self, order: &[usize]) -> Self {
        let moved = |sorted: &[f64]| {
            let mut values = vec![0.0; sorted.len()];
            for (&place, &value) in order.iter().zip(sorted) {
                values[place] = value;
            }
            values
        };
        Self { forces: moved(&self.forces), std: moved(&self.std), error: moved(&self.error) }
    }
}
