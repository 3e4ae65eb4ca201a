//! The likelihood of a fit as what its search makes as high as possible.

use faer::Mat;

use super::free::{FreeParameter, Role};
use super::likelihood::{Errors, Likelihood, LikelihoodPoint};
use super::linearised;
use super::score::Score;
use super::search::Objective;
use crate::Result;
use crate::monitor::{Monitor, Part};

impl Objective for Likelihood {
    type Point = LikelihoodPoint;

    fn free(&self) -> &[FreeParameter] {
        &self.free
    }

    fn refuse_unmeasured(&self) -> Result<()> {
        self.fit.refuse_planned()
    }

    /// Before the machine slips, its compliance and the lengths of the thresholds change a curve almost alike.
    fn halvings(&self) -> i32 {
        if self.free.iter().any(|parameter| parameter.role == Role::Compliance) { 4 } else { 0 }
    }

    fn trial(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<LikelihoodPoint>> {
        Self::trial(self, coordinates, monitor)
    }

    fn deviance(point: &LikelihoodPoint) -> f64 {
        point.restricted_deviance()
    }

    fn score(
        &self,
        coordinates: &[f64],
        point: &LikelihoodPoint,
        monitor: &mut dyn Monitor,
    ) -> Result<Score> {
        Self::score(self, coordinates, point, monitor)
    }

    fn unrestricted(
        &self,
        coordinates: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(f64, Mat<f64>)>> {
        let trial = self.unrestricted_trial(coordinates, &mut Part::new(monitor, 0.0, 0.5))?;
        let Some(trial) = trial else { return Ok(None) };
        let derivatives = self.derivatives(coordinates, &trial, &mut Part::new(monitor, 0.5, 0.5))?;
        Ok(Some((trial.deviance, self.unrestricted_score(derivatives, (coordinates, &trial)).slope)))
    }

    fn freedom(&self) -> Option<f64> {
        match self.errors {
            Errors::ProfiledWhite { fitted } | Errors::RenewedWhite { fitted, .. } => {
                Some((self.count() as f64 - fitted).max(1.0))
            }
            Errors::Modelled(_) => None,
        }
    }

    fn is_profiled(&self) -> bool {
        matches!(self.errors, Errors::ProfiledWhite { .. })
    }

    fn without_solutions(
        &self,
        at: (&[f64], &LikelihoodPoint, &Score),
        to: (&[bool], f64),
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Vec<f64>>> {
        linearised::highest(self, at, to, monitor)
    }
}
