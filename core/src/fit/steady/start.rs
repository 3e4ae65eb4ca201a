//! The values from which a search in the likelihood of a record begins.
//!
//! The spectrum has peaks at the multiples of 2π over the mean advance from break to break. Where first values put a peak
//! between two peaks of the record, the search would end there. All lengths of the contacts are therefore varied first, at
//! first with wide peaks, which overlap, and then with ever narrower ones. This needs no new lives: with lengths a times as
//! large, the autocovariance is a² c(u/a).

use super::super::free::{Role, first_coordinates};
use super::super::search::Objective;
use super::expected::ExpectedRecord;
use super::likelihood::{SteadyLikelihood, SteadyPoint};
use super::record::multiplicity;
use crate::Result;
use crate::monitor::{Aside, Monitor, Part};

/// Factors of all lengths that are tried with the widest peaks: powers of this number, up to this one in both directions, from
/// 1/2 to 2. Half the width of these peaks is a sixth of their distance.
const FACTOR: f64 = 1.08;
const POWERS: i32 = 9;
/// Peaks become narrower by this factor, and so do the steps, of which there are this many in both directions.
const NARROWER: f64 = 4.0;
const FINER: i32 = 4;

/// The parameters of thresholds that are a length all of them are proportional to, or that bounds them.
const LENGTHS: [&str; 4] = ["thresholds.mean", "thresholds.scale", "thresholds.min", "thresholds.max"];

impl SteadyLikelihood {
    /// The coordinates from which to search, the given ones first; `None` where no force follows from these.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    pub fn first_values(&self, monitor: &mut dyn Monitor) -> Result<Option<Vec<Vec<f64>>>> {
        let given = first_coordinates(&self.free);
        let Some(point) = self.trial(&given, &mut Part::new(monitor, 0.0, 0.1))? else { return Ok(None) };
        let kept = self.with_size(&given, &point);
        let Some(moved) = self.with_length(&given, &point, &mut Aside { fraction: 0.1, monitor })? else {
            return Ok(Some(vec![kept]));
        };
        let point = self.trial(&moved, &mut Part::new(monitor, 0.7, 0.3))?;
        let moved = point.map(|point| self.with_size(&moved, &point));
        Ok(Some(std::iter::once(kept).chain(moved).collect()))
    }

    /// The coordinates with the thresholds that put the peaks of the spectrum where those of the record are; `None` where they
    /// are there, or thresholds have no free length.
    fn with_length(
        &self,
        coordinates: &[f64],
        point: &SteadyPoint,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Vec<f64>>> {
        if !self.free.iter().any(|parameter| LENGTHS.contains(&parameter.name.as_str())) {
            return Ok(None);
        }
        let (life, dephasing) = {
            let steady = point.equation.steady_state();
            (steady.mean_life(), steady.dephasing_length())
        };
        let (mut length, mut step, mut powers, mut factor) = (life, FACTOR, POWERS, 1.0);
        loop {
            let mut best = (f64::INFINITY, factor);
            for power in -powers..=powers {
                let tried = factor * step.powi(power);
                let record = (self.readings(), self.fit.record.spacing / tried);
                let expected = ExpectedRecord::widened(&point.equation, record, length, monitor)?;
                let deviance = self.shape_deviance(&expected);
                if deviance < best.0 {
                    best = (deviance, tried);
                }
            }
            factor = best.1;
            // Peaks are no narrower than contacts dephase.
            if length > dephasing || length > self.fit.record.distance() {
                break;
            }
            (length, step, powers) = (NARROWER * length, step.powf(1.0 / NARROWER), FINER);
        }
        let longer = (factor - 1.0) * life;
        if longer == 0.0 {
            return Ok(None);
        }
        let factor = 1.0 + longer / point.equation.contacts().thresholds.mean();
        let moved = self.free.iter().zip(coordinates).map(|(parameter, &u)| {
            let is_length = LENGTHS.contains(&parameter.name.as_str());
            if is_length { parameter.coordinate(factor * parameter.value(u)) } else { u }
        });
        Ok(Some(moved.collect()))
    }

    /// −2 ln L of the record without its mean, for noise of any size, up to a constant.
    fn shape_deviance(&self, expected: &ExpectedRecord) -> f64 {
        let n = self.readings();
        let sum = |of: &dyn Fn(usize) -> f64| (1..=n / 2).map(|k| multiplicity(k, n) * of(k)).sum::<f64>();
        let size = sum(&|k| self.squares[k] / expected.squares[k]) / n as f64;
        sum(&|k| expected.squares[k].ln()) + n as f64 * size.ln()
    }

    /// The coordinates with count and stiffness, where they are free, for which the mean and the size of the noise are those of
    /// the record.
    fn with_size(&self, coordinates: &[f64], point: &SteadyPoint) -> Vec<f64> {
        let n = self.readings();
        let sum = |of: &dyn Fn(usize) -> f64| (1..=n / 2).map(|k| multiplicity(k, n) * of(k)).sum::<f64>();
        let noise = (sum(&|k| self.squares[k]) / sum(&|k| point.expected.squares[k])).ln();
        let mean = ((self.mean - point.offset) / point.expected.mean).ln();
        let place = |name: &str| self.free.iter().position(|parameter| parameter.name == name);
        let offset_is_known = !self.free.iter().any(|parameter| parameter.role == Role::Offset);
        let mut sized = coordinates.to_vec();
        // The mean is proportional to N_c⟨k⟩, the noise to N_c⟨k⟩².
        match (place("count"), place("stiffness")) {
            (Some(count), Some(stiffness)) if offset_is_known && mean.is_finite() => {
                sized[count] += 2.0 * mean - noise;
                sized[stiffness] += noise - mean;
            }
            (Some(either), None) | (None, Some(either)) if offset_is_known && mean.is_finite() => {
                sized[either] += mean;
            }
            (Some(count), _) => sized[count] += noise,
            (None, Some(stiffness)) => sized[stiffness] += 0.5 * noise,
            (None, None) => {}
        }
        sized
    }
}
