//! The error budget of a task: what its forces are off by, held against what was asked for, and told.

use crate::Result;
use crate::monitor::Monitor;

use super::Output;
use crate::monitor::Part;
use crate::scenario::Model;

/// How accurate the forces of a task are.
pub struct ForceAccuracy {
    /// Estimated error of F/(N_c⟨k⟩), a length: all parts of the budget together.
    pub error: f64,
    /// The length that tolerances are counted in: the mean life of a contact, or its mean threshold in time.
    pub life: f64,
    /// The error aimed at where none is asked for, of that length; none in time, where estimates are on the safe side.
    pub aim: Option<f64>,
}

impl ForceAccuracy {
    /// That of contacts that are solved for to the tolerance of a pull.
    pub fn new(model: &Model, error: f64, life: f64) -> Self {
        Self { error, life, aim: Some(model.master_equation.tolerance().value()) }
    }

    /// That of contacts followed through time, of an error of their force.
    pub fn in_time(model: &Model, force: f64) -> Self {
        Self { error: force / model.stiffness(), life: model.contacts.thresholds.mean(), aim: None }
    }

    /// The larger of two errors, with the length that it is counted in.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        if other.error / other.life > self.error / self.life { other } else { self }
    }

    /// How many times as large it is as what the scenario requires; 0 where that is nothing.
    pub fn missing(&self, model: &Model) -> f64 {
        let required = model.master_equation.tolerance;
        required.map_or(0.0, |required| self.error / self.life / required)
    }

    /// Adds it to an output, with a warning where it falls short of the aim; `what` it is the accuracy of.
    ///
    /// # Errors
    /// Larger than what the scenario requires.
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

/// What `solve` makes of contacts that are followed with a tolerance; where that is less accurate than what the scenario
/// requires, with a smaller one.
///
/// # Errors
/// Those of `solve`.
pub fn as_required<T>(
    model: &Model,
    mut tolerance: f64,
    monitor: &mut dyn Monitor,
    mut solve: impl FnMut(f64, &mut Part<'_>) -> Result<(T, ForceAccuracy)>,
) -> Result<(T, ForceAccuracy)> {
    /// How often that is tried, …
    const ATTEMPTS: u32 = 2;
    /// … and the smallest tolerance that there is.
    const FINEST: f64 = 1e-12;
    let required = model.master_equation.tolerance.is_some();
    let share = if required { 1.0 / f64::from(ATTEMPTS) } else { 1.0 };
    let mut attempt = 1;
    loop {
        let (found, accuracy) =
            solve(tolerance, &mut Part::new(monitor, f64::from(attempt - 1) * share, share))?;
        let missing = accuracy.missing(model);
        if missing <= 1.0 || attempt == ATTEMPTS || tolerance == FINEST {
            return Ok((found, accuracy));
        }
        (tolerance, attempt) = ((0.5 * tolerance / missing).max(FINEST), attempt + 1);
    }
}
