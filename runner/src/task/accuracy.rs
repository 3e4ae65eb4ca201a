//! The error budget of a task: what its forces are off by, held against what was asked for, and told.

use asperity::Result;
use asperity::contacts::Contacts;
use asperity::monitor::Monitor;

use super::Setting;
use super::part::Part;
use crate::summary::Summary;

/// How accurate the forces of a task are.
pub struct Accuracy {
    /// Estimated error of F/(N_c⟨k⟩), a length: all parts of the budget together.
    pub error: f64,
    /// The length that tolerances are counted in: the mean life of a contact, or its mean threshold in time.
    pub life: f64,
    /// The error aimed at where none is asked for, of that length; none in time, where estimates are on the safe side.
    pub aim: Option<f64>,
}

impl Accuracy {
    /// That of contacts that are solved for to the tolerance of a pull.
    pub fn new(setting: &Setting<'_>, error: f64, life: f64) -> Self {
        Self { error, life, aim: Some(setting.scenario.master_equation.tolerance().value()) }
    }

    /// That of contacts followed through time, of an error of their force.
    pub fn in_time(setting: &Setting<'_>, force: f64) -> Self {
        let contacts = &setting.contacts;
        Self { error: force / stiffness(contacts), life: contacts.thresholds.mean(), aim: None }
    }

    /// The larger of two errors, with the length that it is counted in.
    #[must_use]
    pub fn worse(self, other: Self) -> Self {
        if other.error / other.life > self.error / self.life { other } else { self }
    }

    /// How many times as large it is as what the scenario requires; 0 where that is nothing.
    pub fn missing(&self, setting: &Setting<'_>) -> f64 {
        let required = setting.scenario.master_equation.tolerance;
        required.map_or(0.0, |required| self.error / self.life / required)
    }

    /// Adds it to a summary, with a warning where it falls short of the aim.
    ///
    /// # Errors
    /// Larger than what the scenario requires.
    pub fn told(self, setting: &Setting<'_>, what: &str, mut summary: Summary) -> Result<Summary> {
        let reached = self.error / self.life;
        setting.scenario.master_equation.tolerance().allows(reached, || what.to_owned())?;
        if let Some(aim) = self.aim.filter(|aim| reached > *aim) {
            summary.warnings.push(format!(
                "the estimated error of the force is {reached:.1e} of N⟨k⟩ times the mean life of a contact, more than the \
                 aim of {aim:e}"
            ));
        }
        Ok(Summary { accuracy: Some(self.error), ..summary })
    }
}

/// What `solve` makes of contacts that are followed with a tolerance; where that is less accurate than what the scenario
/// requires, with a smaller one.
///
/// # Errors
/// Those of `solve`.
pub fn as_required<T>(
    setting: &Setting<'_>,
    mut tolerance: f64,
    monitor: &mut dyn Monitor,
    mut solve: impl FnMut(f64, &mut Part<'_>) -> Result<(T, Accuracy)>,
) -> Result<(T, Accuracy)> {
    /// How often that is tried, …
    const ATTEMPTS: u32 = 2;
    /// … and the smallest tolerance that there is.
    const FINEST: f64 = 1e-12;
    let required = setting.scenario.master_equation.tolerance.is_some();
    let share = if required { 1.0 / f64::from(ATTEMPTS) } else { 1.0 };
    let mut attempt = 1;
    loop {
        let (found, accuracy) =
            solve(tolerance, &mut Part::new(monitor, f64::from(attempt - 1) * share, share))?;
        let missing = accuracy.missing(setting);
        if missing <= 1.0 || attempt == ATTEMPTS || tolerance == FINEST {
            return Ok((found, accuracy));
        }
        (tolerance, attempt) = ((0.5 * tolerance / missing).max(FINEST), attempt + 1);
    }
}

/// N_c⟨k⟩.
pub fn stiffness(contacts: &Contacts) -> f64 {
    contacts.count * contacts.stiffness.of(contacts.thresholds.mean())
}
