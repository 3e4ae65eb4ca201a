//! A trial step: existing cohorts advance to its middle and its end, and two cohorts form in it.
//!
//! N(t), the number of breaks, is quadratic in the step. Contacts that form in it may break in it, so that N
//! and the formation of contacts depend on each other; this is solved by iteration. Formation is represented
//! by its mass and mean time, at the two nodes of the Gauss rule, which conserves both, so that integrals are
//! accurate to fourth order.

use std::ops::Range;

use super::broken::{BirthMoments, Broken, BrokenFraction, EarlyBreaks};
use super::cohort::{Cohort, CohortForce, CohortStep, EnergyChange};
use super::contact_ages::{SharedStep, StepChanges};
use super::formed::FormedInStep;
use super::model::CohortModel;
use super::path::{GAUSS, Path, StepPart};
use super::seeds::Seed;
use super::shared_thresholds::StepThresholds;
use super::step_context::StepContext;
use crate::Result;
use crate::monitor::{Monitor, Watch};
use crate::numerics::legendre::NODES;

/// A trial step.
pub(super) struct Trial {
    /// All cohorts at its end, the newly formed last.
    pub(super) cohorts: Vec<Cohort>,
    pub(super) fraction: BrokenFraction,
    /// Contacts formed in it.
    pub(super) formed: FormedInStep,
    /// Force of the other cohorts in its middle, in units of the total stiffness.
    pub(super) middle_force: f64,
    /// Energies; those of formation are included in the losses.
    pub(super) spent: EnergyChange,
    /// P_c in it, and what makes P_c of it, where contacts share it.
    pub(super) thresholds: Option<StepThresholds>,
    pub(super) changes: Option<StepChanges>,
    /// An error of P_c inside it, as a fraction of contacts.
    pub(super) missed: f64,
}

/// Amount of work of a thread between two checks whether the monitor has stopped.
const LEAST: usize = 4096;

/// Sums over these cohorts.
fn total(passed: &[CohortStep]) -> CohortStep {
    passed.iter().fold(CohortStep::default(), |sum, one| sum.plus(one))
}

/// The masses at the Gauss nodes ½ ± 1/(2√3) with this sum and first moment.
pub(super) fn masses_at_nodes(mass: f64, moment: f64) -> [f64; 2] {
    let tilt = 3.0_f64.sqrt() * moment;
    [0.5 * mass - tilt, 0.5 * mass + tilt]
}

/// What does not change within a step.
pub(super) struct StepAttempt<'a> {
    pub(super) model: &'a CohortModel,
    /// Stretches at which contacts re-form.
    pub(super) seeds: &'a [Seed],
    pub(super) broken: &'a Broken,
    pub(super) time: f64,
    /// Fraction removed as negligible that has not been counted.
    pub(super) dropped: f64,
    /// Where contacts share one distribution of thresholds.
    pub(super) shared: Option<SharedStep<'a>>,
}

impl StepAttempt<'_> {
    /// The step along a path, with P_c where contacts share it.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn attempt_with(
        &self,
        thresholds: Option<&StepThresholds>,
        cohorts: &[Cohort],
        path: &Path,
        monitor: &mut dyn Monitor,
    ) -> Result<Trial> {
        let (old, seeds) = (cohorts.len(), self.seeds.len());
        let chunk = (LEAST / self.model.cells()).max(1);
        let count = old + GAUSS.len() * seeds;
        let watch = Watch::new(monitor);
        let (mut cohorts, passed) = if count <= chunk {
            // Few cohorts do not repay the start of a shared loop.
            self.moved(cohorts, 0..count, path, &mut StepContext::new(&watch, thresholds))
        } else {
            // Cohorts are copied and formed in parallel, too: that takes as long as a step.
            let piece = |context: &mut StepContext<'_, '_>, number: usize| {
                let from = number * chunk;
                self.moved(cohorts, from..count.min(from + chunk), path, context)
            };
            let mut all = (Vec::with_capacity(count), Vec::with_capacity(count));
            for (mut cohorts, mut passed) in
                watch.share(count.div_ceil(chunk), || StepContext::new(&watch, thresholds), piece)?
            {
                all.0.append(&mut cohorts);
                all.1.append(&mut passed);
            }
            all
        };
        watch.check()?;
        let dropped = BrokenFraction { middle: 0.5 * self.dropped, end: self.dropped };
        let before = total(&passed[..old]);
        let [early, late] = [old, old + seeds].map(|from| total(&passed[from..][..seeds]));
        let deaths = EarlyBreaks { early: early.fraction.end, late: late.fraction.end };
        // Cohorts formed in this step were advanced with unit mass; the balance of breaks and formation gives
        // their masses.
        let (fraction, masses) = self.balance(path, before.fraction.plus(dropped), deaths);
        let ends = [old, old + seeds].map(|from| CohortForce::of(&cohorts[from..][..seeds]));
        let formed = FormedInStep::new(path, masses, deaths, [early.passed, late.passed], ends);
        for (i, cohort) in cohorts[old..].iter_mut().enumerate() {
            cohort.mass *= masses[i / seeds];
        }
        let spent = before.spent.plus(masses[0], early.spent).plus(masses[1], late.spent);
        let middle_force = before.passed.force;
        Ok(Trial {
            cohorts,
            fraction,
            formed,
            middle_force,
            spent,
            thresholds: None,
            changes: None,
            missed: 0.0,
        })
    }

    /// The cohorts of these numbers at the end of the step, and what it does to them: the existing ones first, then those formed
    /// at the two Gauss nodes, seed by seed. After a stop of the watch they are invalid.
    fn moved(
        &self,
        existing: &[Cohort],
        numbers: Range<usize>,
        path: &Path,
        context: &mut StepContext<'_, '_>,
    ) -> (Vec<Cohort>, Vec<CohortStep>) {
        let (old, part) = (existing.len(), [StepPart::Early, StepPart::Late]);
        let node = |i: usize| (i - old) / self.seeds.len();
        let mut cohorts = Vec::with_capacity(numbers.len());
        cohorts.extend_from_slice(&existing[numbers.start.min(old)..numbers.end.min(old)]);
        for i in numbers.start.max(old)..numbers.end {
            let seed = &self.seeds[(i - old) % self.seeds.len()];
            cohorts.push(self.fresh(seed, path, GAUSS[node(i)], context.watch));
        }
        // Thresholds on panels are computed where they are first met, which may take a tenth of a second for one cohort, but mostly
        // takes no longer than to ask.
        const ASKED: usize = 8;
        let asks = self.model.cells() > NODES;
        let step = |(cohort, i): (&mut Cohort, usize)| {
            if asks && i.is_multiple_of(ASKED) && context.watch.stops() {
                return CohortStep::default();
            }
            if i < old {
                return cohort.advance_step(self.model, path, context);
            }
            let stored = cohort.energy();
            let mut passed = cohort.advance_from_formation(self.model, path, part[node(i)], context);
            passed.spent.lost -= stored;
            passed
        };
        let passed = cohorts.iter_mut().zip(numbers).map(step).collect();
        (cohorts, passed)
    }

    /// The breaks of these cohorts from the start of a step to a fraction of it, and their force there; with P_c in the whole
    /// step where contacts share it.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn partly(
        &self,
        (cohorts, thresholds): (&[Cohort], Option<&StepThresholds>),
        path: &Path,
        s: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<(f64, f64)> {
        // The way there is the first half of one twice as long.
        let twice = Path { duration: 2.0 * s * path.duration, by: 2.0 * s * path.by };
        let chunk = (LEAST / self.model.cells()).max(1);
        let piece = |context: &mut StepContext<'_, '_>, number: usize| {
            let part = &cohorts[number * chunk..cohorts.len().min((number + 1) * chunk)];
            part.iter().fold((0.0, 0.0), |(broken, force), cohort| {
                let mut cohort = cohort.clone();
                let breaks = cohort.advance(self.model, &twice, StepPart::First, context).0;
                (broken + breaks, force + cohort.force())
            })
        };
        let watch = Watch::new(monitor);
        let pieces =
            watch.share(cohorts.len().div_ceil(chunk), || StepContext::new(&watch, thresholds), piece)?;
        watch.check()?;
        Ok(pieces.into_iter().fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1)))
    }

    /// Contacts that form at the fraction s of a step, with a mass of 1 for all seeds.
    fn fresh(&self, seed: &Seed, path: &Path, s: f64, watch: &Watch<'_>) -> Cohort {
        let cell = if s < 0.5 { (0.0, 0.5) } else { (0.5, 1.0) };
        let spread = Seed {
            above: seed.above + path.advance(cell.0, s).abs(),
            below: seed.below + path.advance(s, cell.1).abs(),
            ..*seed
        };
        Cohort::born(self.model, &spread, seed.weight, watch)
    }

    /// Solves for breaks and formation by fixed-point iteration; `before` are the breaks of existing cohorts.
    fn balance(
        &self,
        path: &Path,
        before: BrokenFraction,
        deaths: EarlyBreaks,
    ) -> (BrokenFraction, [f64; 2]) {
        /// Each iteration gains a factor of the early breaks, which are below ½.
        const ROUNDS: usize = 60;
        let (alpha, beta) = deaths.curve();
        let mut fraction = before.rising();
        let mut masses = [0.0; 2];
        let known = self.broken.free_before(self.time, path.duration);
        for _ in 0..ROUNDS {
            let BirthMoments { mass, moment } = self.broken.births(self.time, path.duration, fraction, known);
            masses = masses_at_nodes(mass, moment);
            let by_middle = mass * (alpha / 8.0 + beta / 24.0) - 12.0 * moment * (alpha / 24.0 + beta / 64.0);
            let by_end = masses[0] * deaths.early + masses[1] * deaths.late;
            let next = before.plus(BrokenFraction { middle: by_middle, end: by_end }).rising();
            let change = (next.middle - fraction.middle).abs() + (next.end - fraction.end).abs();
            fraction = next;
            if change <= f64::EPSILON * fraction.end {
                break;
            }
        }
        (fraction, masses)
    }
}
