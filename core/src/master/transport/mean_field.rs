//! A step of contacts that share one distribution of thresholds: P_c and the stretches of contacts advance together.
//!
//! The breaks in a step depend on P_c in it, and P_c on the breaks. With P_c given at the start, the middle and the end of
//! the step the cohorts advance, and their breaks give P_c anew; the first guess continues the breaks of the step before. Every
//! round gains a factor of about the fraction of contacts that breaks in the step.

use std::sync::Arc;

use super::broken::{BirthMoments, BrokenFraction};
use super::cohort::Cohort;
use super::contact_ages::{ContactAges, SharedStep, StepChanges};
use super::path::Path;
use super::shared_thresholds::StepThresholds;
use super::trial::{StepAttempt, Trial, masses_at_nodes};
use crate::contacts::{
    Contacts, MaturingTable, ThresholdDensity, ThresholdFokkerPlanck, mean_advance, self_consistent_advance,
    starts,
};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// The thresholds of contacts of all ages.
///
/// # Errors
/// Thresholds with point masses; stiffnesses that depend on them; stopped by the monitor.
pub(super) fn table(contacts: &Contacts, monitor: &mut dyn Monitor) -> Result<Arc<MaturingTable>> {
    if let Some(atom) = contacts.thresholds.atoms().first() {
        let expected =
            "a distribution without point masses, where thresholds shared by mean_field are followed in time";
        return Err(Error::invalid("thresholds", expected, format!("one at {}", atom.position)));
    }
    contacts.have_equal_stiffness()?;
    let maturing = ThresholdFokkerPlanck::of(contacts).expect("mean_field has a mature law");
    MaturingTable::new(maturing, monitor).map(Arc::new)
}

/// The mean age of the contacts in steady sliding, and their P_c: the age is the time in which the slider moves by the mean
/// advance of a contact.
pub(super) fn steady(table: &MaturingTable, contacts: &Contacts, velocity: f64) -> (f64, ThresholdDensity) {
    let maturing = table.maturing();
    let starts = starts(maturing, &contacts.reforming);
    let at = |advance: f64| ContactAges::steady(advance / velocity, 1.0).thresholds(table);
    let excess = |advance: f64| mean_advance(&at(advance).elements(), &starts) - advance;
    let advance = self_consistent_advance(maturing, excess);
    (advance / velocity, at(advance))
}

/// Largest number of rounds; a step that needs more is too long.
const ROUNDS: usize = 12;

/// Change of the breaks in the last round, in units of the tolerance; the next round would change them by some hundredths of it.
const SETTLED: f64 = 1e-2;

/// Error of P_c inside the step as a parabola in time, in units of the error of extrapolated breaks. Of a parabola through both
/// ends and the middle the error is odd in time, so that the breaks of the whole step are more accurate.
const PARABOLA: f64 = 60.0;

impl StepAttempt<'_> {
    /// The step along a path.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn attempt(
        &self,
        cohorts: &[Cohort],
        path: &Path,
        monitor: &mut dyn Monitor,
    ) -> Result<Trial> {
        let Some(shared) = &self.shared else { return self.attempt_with(None, cohorts, path, monitor) };
        let start = shared.ages.thresholds(shared.table);
        let mut guess = shared.guess(path);
        for round in 1.. {
            let changes = self.changes(shared, path, guess);
            let at = |s: f64| shared.ages.thresholds_at(shared.table, &changes, s);
            let thresholds =
                StepThresholds::new(path.duration, [start.clone(), at(0.5), at(1.0)], shared.tolerance);
            let mut trial = self.attempt_with(Some(&thresholds), cohorts, path, monitor)?;
            let found = trial.fraction;
            let change = (found.middle - guess.middle).abs().max((found.end - guess.end).abs());
            guess = found;
            let settled = path.by == 0.0 || change <= SETTLED * shared.tolerance;
            if settled || round == ROUNDS {
                // Contacts at rest do not break, however their thresholds change.
                let missed = if path.by == 0.0 { 0.0 } else { PARABOLA * thresholds.missed(&at(0.25)) };
                trial.missed = if settled { missed } else { f64::INFINITY };
                trial.changes = Some(self.changes(shared, path, guess));
                trial.thresholds = Some(thresholds);
                return Ok(trial);
            }
        }
        unreachable!("the last round is returned")
    }

    /// What breaks and forms in a step in which this fraction breaks.
    fn changes(&self, shared: &SharedStep<'_>, path: &Path, broken: BrokenFraction) -> StepChanges {
        let known = self.broken.free_before(self.time, path.duration);
        let BirthMoments { mass, moment } = self.broken.births(self.time, path.duration, broken, known);
        let formed = masses_at_nodes(mass, moment);
        StepChanges { duration: path.duration, broken, formed, attached: shared.ages.attached() }
    }
}
