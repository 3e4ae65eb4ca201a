//! Forces of steady sliding, measured at several velocities.

use crate::error::{all_finite, as_many, positive};
use crate::{Error, Result};

/// Forces of steady sliding, measured at several velocities.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeasuredVelocityCurve {
    /// The velocities of the slider, above 0, in any order; a velocity may occur several times.
    pub velocities: Vec<f64>,
    /// The n measured forces, each the mean over a distance of steady sliding.
    pub forces: Vec<f64>,
    /// The standard deviations of their independent errors, above 0; without them, all errors have one size.
    pub errors: Option<Vec<f64>>,
}

impl MeasuredVelocityCurve {
    /// The velocities that occur, rising, and the place in them of each reading.
    pub(super) fn distinct(&self) -> (Vec<f64>, Vec<usize>) {
        let mut distinct = self.velocities.clone();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        let place = |velocity: &f64| distinct.partition_point(|other| other < velocity);
        let places = self.velocities.iter().map(place).collect();
        (distinct, places)
    }

    /// # Errors
    /// No reading; not as many forces, or errors, as velocities; a velocity or an error that is not above 0, a force that is not
    /// finite.
    pub(super) fn check(&self) -> Result<()> {
        let n = self.velocities.len();
        if n == 0 {
            return Err(Error::invalid("velocity", "at least one velocity", "none"));
        }
        let lists = [("force", Some(&self.forces)), ("error", self.errors.as_ref())];
        for (key, list) in lists.into_iter().filter_map(|(key, list)| Some((key, list?))) {
            as_many(key, list.len(), (n, "values, one for each velocity"))?;
        }
        let above = [("velocity", Some(&self.velocities)), ("error", self.errors.as_ref())];
        for (key, list) in above.into_iter().filter_map(|(key, list)| Some((key, list?))) {
            list.iter().enumerate().try_for_each(|(i, &x)| positive(&format!("{key}.{i}"), x).map(drop))?;
        }
        all_finite("force", &self.forces)
    }
}
