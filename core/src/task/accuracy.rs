//! The error budget of a task: the estimated error of its forces, compared with the required accuracy.

use super::Output;
use crate::Result;
use crate::master::{self, Pull, SteadyState};
use crate::monitor::{Monitor, Part};
use crate::scenario::{Model, TaskStart};

/// How accurate the forces of a task are.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ForceAccuracy {
    /// Estimated total error of F/(N_c⟨k⟩), a length.
    pub error: f64,
    /// The unit of tolerances, a length: the mean life of a contact, or the mean threshold for motion in time.
    pub life: f64,
    /// Default target of the error, in units of `life`. `None` for motion in time, where estimates are upper limits.
    pub aim: Option<f64>,
}

impl ForceAccuracy {
    /// Accuracy of a solution of the renewal equation, with the error of F/(N_c⟨k⟩) and the mean life, both lengths.
    pub fn new(model: &Model, error: f64, life: f64) -> Self {
        Self { error, life, aim: Some(model.master_equation.tolerance().value()) }
    }

    /// Accuracy of the force on a pull. One that begins in steady sliding stays there; its distance from F_k is the error of the
    /// stretches with which it begins.
    pub fn of_pull(model: &Model, start: TaskStart, pull: &Pull, steady: &SteadyState) -> Self {
        let stays = start == TaskStart::Steady && !model.contacts.rules.are_time_dependent();
        let start = if stays { pull.distance_from(steady) + steady.error_estimate() } else { 0.0 };
        Self::new(model, pull.error_estimate() + start, steady.mean_life())
    }

    /// Accuracy of contacts followed through time, from the error of their force.
    pub fn in_time(model: &Model, force: f64) -> Self {
        Self { error: force / model.stiffness(), life: model.contacts.thresholds.mean(), aim: None }
    }

    /// The one with the larger relative error.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        if other.error / other.life > self.error / self.life { other } else { self }
    }

    /// Ratio of the error to the one that the scenario requires; 0 without a requirement.
    pub fn excess(&self, model: &Model) -> f64 {
        let required = model.master_equation.tolerance;
        required.map_or(0.0, |required| self.error / self.life / required)
    }

    /// Adds the accuracy of the force named `what` to an output, with a warning if the error is above the default target.
    ///
    /// # Errors
    /// The error is larger than the scenario requires.
    pub fn of<N>(self, model: &Model, what: &str, mut output: Output<N>) -> Result<Output<N>> {
        let reached = self.error / self.life;
        model.master_equation.tolerance().allows(reached, || what.to_owned())?;
        if let Some(aim) = self.aim.filter(|aim| reached > *aim) {
            output.warnings.push(format!(
                "the estimated error of the force is {reached:.1e} of N⟨k⟩ times the mean life of a contact, more than the \
                 aim of {aim:e}"
            ));
        }
        output.accuracy = Some(self.error);
        Ok(output)
    }
}

/// Calls `solve` with a tolerance, and with smaller ones while the result is less accurate than the scenario requires.
///
/// # Errors
/// Those of `solve`.
pub fn as_required<T>(
    model: &Model,
    tolerance: f64,
    monitor: &mut dyn Monitor,
    mut solve: impl FnMut(f64, &mut Part<'_>) -> Result<(T, ForceAccuracy)>,
) -> Result<(T, ForceAccuracy)> {
    let solve = |tolerance: f64, part: &mut Part<'_>| {
        let found = solve(tolerance, part)?;
        let excess = found.1.excess(model);
        Ok((found, excess))
    };
    let required = model.master_equation.tolerance.is_some();
    master::as_required(tolerance, required, monitor, solve).map(|(found, _)| found)
}
