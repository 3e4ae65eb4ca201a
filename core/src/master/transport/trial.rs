//! One step, tried: old cohorts to its middle and its end, and two cohorts born in it.
//!
//! N(t), what breaks, is taken as quadratic in the step; contacts born in it may break in it, so that N and the births follow
//! from each other. Births have their mass and their mean time; they are put at the two points of Gauss's rule, which
//! keeps both, so that integrals over them are right to fourth order.

use super::broken::{BirthMoments, Broken, BrokenShare};
use super::cohort::{Cohort, Spent};
use super::model::{CohortModel, Tools};
use super::path::{Path, StepPart};
use super::seeds::Seed;
use crate::Result;
use crate::monitor::{Monitor, Watch};

/// A step, tried.
pub(super) struct Trial {
    /// All cohorts at its end, the newborn last.
    pub(super) cohorts: Vec<Cohort>,
    pub(super) share: BrokenShare,
    pub(super) born: f64,
    /// What breaks of the contacts born in it.
    pub(super) deaths: Deaths,
    /// Energies, those of the births among what is lost.
    pub(super) spent: Spent,
}

/// The shares of the contacts born at the two Gauss points of a step that break in it.
///
/// The share broken at an age of a steps is taken as αa + βa² through both.
#[derive(Debug, Clone, Copy)]
pub(super) struct Deaths {
    pub(super) early: f64,
    late: f64,
}

impl Deaths {
    /// α and β.
    pub(super) fn curve(self) -> (f64, f64) {
        let [short, long] = GAUSS;
        let (old, young) = (self.early / long, self.late / short);
        let beta = (old - young) / (long - short);
        (young - beta * short, beta)
    }
}

/// Points of the two-point Gauss rule on [0, 1].
pub(super) const GAUSS: [f64; 2] = [0.211_324_865_405_187_13, 0.788_675_134_594_812_9];

/// Numbers that a thread goes through before it asks whether to go on.
const LEAST: usize = 4096;

/// What becomes of all of these cohorts.
fn total(passed: &[(BrokenShare, Spent)]) -> (BrokenShare, Spent) {
    let nothing = (BrokenShare::default(), Spent::default());
    passed.iter().fold(nothing, |sum, (share, spent)| (sum.0.plus(*share), sum.1.plus(1.0, *spent)))
}

/// What does not change within a step.
pub(super) struct Stage<'a> {
    pub(super) model: &'a CohortModel,
    /// Where contacts re-form.
    pub(super) seeds: &'a [Seed],
    pub(super) broken: &'a Broken,
    pub(super) time: f64,
    /// What was broken as negligible and has not been counted.
    pub(super) dropped: f64,
}

impl Stage<'_> {
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
        let (old, seeds) = (cohorts.len(), self.seeds.len());
        let chunk = (LEAST / self.model.cells()).max(1);
        // Copies and births take as much of memory as steps do.
        let step = |tools: &mut Tools<'_, '_>, i: usize| {
            if let Some(cohort) = cohorts.get(i) {
                let mut cohort = cohort.clone();
                let passed = cohort.cross(self.model, path, tools);
                return (cohort, passed);
            }
            let (born, part) = ((i - old) / seeds, [StepPart::Early, StepPart::Late]);
            let mut cohort = self.newborn(&self.seeds[(i - old) % seeds], path, GAUSS[born], tools.watch);
            let stored = cohort.energy();
            let (end, spent) = cohort.arrive(self.model, path, part[born], tools);
            (cohort, (BrokenShare { middle: 0.0, end }, Spent { lost: spent.lost - stored, ..spent }))
        };
        let count = old + GAUSS.len() * seeds;
        let piece = |tools: &mut Tools<'_, '_>, number: usize| -> Vec<(Cohort, (BrokenShare, Spent))> {
            let from = number * chunk;
            (from..count.min(from + chunk)).map(|i| step(tools, i)).collect()
        };
        let watch = Watch::new(monitor);
        let pieces = watch.share(count.div_ceil(chunk), || Tools::new(&watch), piece)?;
        watch.check()?;
        let (mut cohorts, passed): (Vec<Cohort>, Vec<(BrokenShare, Spent)>) =
            pieces.into_iter().flatten().unzip();
        let dropped = BrokenShare { middle: 0.5 * self.dropped, end: self.dropped };
        let (before, spent) = total(&passed[..old]);
        let [early, late] = [old, old + seeds].map(|from| total(&passed[from..][..seeds]));
        let deaths = Deaths { early: early.0.end, late: late.0.end };
        let (share, masses) = self.settle(path, before.plus(dropped), deaths);
        for (i, cohort) in cohorts[old..].iter_mut().enumerate() {
            cohort.mass *= masses[i / seeds];
        }
        let spent = spent.plus(masses[0], early.1).plus(masses[1], late.1);
        Ok(Trial { cohorts, share, born: masses[0] + masses[1], deaths, spent })
    }

    /// Contacts born at the fraction s of a step, with a mass of 1 for all seeds.
    fn newborn(&self, seed: &Seed, path: &Path, s: f64, watch: &Watch<'_>) -> Cohort {
        let cell = if s < 0.5 { (0.0, 0.5) } else { (0.5, 1.0) };
        let spread = Seed {
            above: seed.above + path.advance(cell.0, s).abs(),
            below: seed.below + path.advance(s, cell.1).abs(),
            ..*seed
        };
        Cohort::born(self.model, &spread, seed.weight, watch)
    }

    /// What breaks and what is born, `before` coming from old cohorts.
    fn settle(&self, path: &Path, before: BrokenShare, deaths: Deaths) -> (BrokenShare, [f64; 2]) {
        /// Each round gains a factor of the deaths, which are below ½.
        const ROUNDS: usize = 60;
        let (alpha, beta) = deaths.curve();
        let mut share = before.rising();
        let mut masses = [0.0; 2];
        for _ in 0..ROUNDS {
            let BirthMoments { mass, moment } = self.broken.births(self.time, path.duration, share);
            let tilt = 3.0_f64.sqrt() * moment;
            masses = [0.5 * mass - tilt, 0.5 * mass + tilt];
            let by_middle = mass * (alpha / 8.0 + beta / 24.0) - 12.0 * moment * (alpha / 24.0 + beta / 64.0);
            let by_end = masses[0] * deaths.early + masses[1] * deaths.late;
            let next = before.plus(BrokenShare { middle: by_middle, end: by_end }).rising();
            let change = (next.middle - share.middle).abs() + (next.end - share.end).abs();
            share = next;
            if change <= f64::EPSILON * share.end {
                break;
            }
        }
        (share, masses)
    }
}
