//! How long a step may be.

use serde::{Deserialize, Serialize};

use super::broken::BrokenShare;
use super::trial::Deaths;
use crate::contacts::Contacts;
use crate::law::Law;
use crate::{Error, Float, Result};

/// The choice of steps.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Pace {
    /// How far contacts may stretch in a step.
    #[serde(skip)]
    reach: f64,
    /// By how much of all contacts what breaks in a step may differ from what the step before foretells.
    #[serde(skip)]
    surprise: f64,
    /// How much of all contacts the curvature of the deaths of the newborn may be.
    #[serde(skip)]
    bend: f64,
    /// The duration that the next step may have.
    next: f64,
    /// The last step, as long as the next one goes on like it.
    last: Option<(f64, BrokenShare)>,
}

/// The longest step in units of the length on which lives vary is this times the fourth root of the tolerance.
const REACH: f64 = 6.0;

/// The longest step in units of the mean threshold is, where densities jump by the most of themselves, this times the square
/// root of the tolerance.
const JUMP: f64 = 3.0;

/// The largest surprise is this times tolerance^¾: a step's share of error falls with its surprise and with its length.
const SURPRISE: f64 = 10.0;

/// The share of the newborn of a step that may break in it.
const MOST_DEATHS: f64 = 0.3;

/// What the curvature of the deaths of the newborn may amount to, in tolerances: all but a hundredth of it is kept.
const BEND: f64 = 100.0;

/// Steps grow by no more than this factor, and shrink by no less than its inverse.
const GROWTH: f64 = 2.0;

impl Pace {
    pub(super) fn new(contacts: &Contacts, tolerance: f64) -> Self {
        let smooth = (REACH * tolerance.powf(0.25)).min(1.0) * scale(contacts);
        Self {
            reach: smooth.min(coarsest(contacts, tolerance)),
            surprise: SURPRISE * tolerance.powf(0.75),
            bend: BEND * tolerance,
            next: f64::INFINITY,
            last: None,
        }
    }

    /// The same, kept without what steps may be, which is that of `other` ones.
    pub(super) fn of(self, other: &Self) -> Self {
        let &Self { reach, surprise, bend, .. } = other;
        Self { reach, surprise, bend, ..self }
    }

    /// The length of a step, of what is left until something happens, at a velocity.
    pub(super) fn propose(&self, velocity: f64, left: f64) -> f64 {
        /// The first step of all, where nothing else limits it.
        const FIRST: f64 = 1e-6;
        let first = if self.next.is_finite() {
            self.next
        } else if velocity == 0.0 {
            FIRST * left
        } else {
            left
        };
        let step = first.min(self.longest(velocity));
        if step >= left {
            left
        } else if 2.0 * step > left {
            0.5 * left
        } else {
            step
        }
    }

    /// The longest step at a velocity.
    pub(super) fn longest(&self, velocity: f64) -> f64 {
        if velocity == 0.0 { f64::INFINITY } else { self.reach / velocity.abs() }
    }

    /// Forgets the last step: the next one is of another kind.
    pub(super) fn turn(&mut self) {
        self.last = None;
    }

    /// Whether a step of a duration is good enough; says how long the next one may be.
    pub(super) fn judge(&mut self, duration: f64, share: BrokenShare, deaths: Deaths) -> bool {
        let surprise = self.surprise(duration, share) / self.surprise;
        let bend = share.end * deaths.curve().1.abs() / self.bend;
        let early = deaths.early / MOST_DEATHS;
        let factor =
            (0.9 / surprise.cbrt()).min(0.9 / bend.cbrt()).min(0.9 / early).clamp(1.0 / GROWTH, GROWTH);
        if surprise > 1.0 || bend > 1.0 || early > 1.0 {
            self.next = factor.min(0.8) * duration;
            return false;
        }
        // A step cut short by what happens says little of longer ones.
        let longer = factor * duration;
        self.next = if factor >= 1.0 && self.next.is_finite() { longer.max(self.next) } else { longer };
        self.last = Some((duration, share));
        true
    }

    /// How far what breaks is from what the straight line of the last breaking rate foretells; after a turn, how far the
    /// breaking rate is from constant.
    fn surprise(&self, duration: f64, share: BrokenShare) -> f64 {
        let Some((before, last)) = self.last else { return (share.end - 2.0 * share.middle).abs() };
        let tilt = 4.0 * (last.end - 2.0 * last.middle);
        let between = 0.5 * (1.0 + duration / before);
        (share.end - duration / before * (last.end + tilt * between)).abs()
    }

    /// Refuses steps that shrink without end.
    ///
    /// # Errors
    /// The next step would be no step.
    pub(super) fn check(&self, refused: f64, tolerance: f64) -> Result<()> {
        if self.next > f64::MIN_POSITIVE && self.next < refused {
            return Ok(());
        }
        let what = "contacts followed through time, whose steps became too short".to_owned();
        Err(Error::Accuracy {
            key: "master_equation.tolerance".into(),
            what,
            reached: Float(f64::NAN),
            wanted: Float(tolerance),
        })
    }

    /// The step before the next one, if that goes on like it.
    pub(super) fn last(&self) -> Option<(f64, BrokenShare)> {
        self.last
    }
}

/// The length on which lives vary: that of the thresholds', and what temperature adds.
pub(super) fn scale(contacts: &Contacts) -> f64 {
    /// Where thresholds are identical and cold, in units of the mean one.
    const LEAST: f64 = 0.02;
    let mean = contacts.thresholds.mean();
    let ageing = contacts.rules.ageing.as_ref().and_then(|ageing| ageing.mature());
    let widths = [Some(&contacts.thresholds), ageing].into_iter().flatten().map(|law| width(law.as_ref()));
    let width = widths.fold(mean, f64::min);
    let thermal = contacts.rules.temperature.map_or(0.0, |t| t.energy / (contacts.stiffness.of(mean) * mean));
    if width == 0.0 { thermal.clamp(LEAST * mean, mean) } else { width.hypot(thermal).min(mean) }
}

/// The longest stretch on which sums go over where densities jump; infinite where they do not.
pub(super) fn coarsest(contacts: &Contacts, tolerance: f64) -> f64 {
    JUMP * tolerance.sqrt() * contacts.thresholds.mean() / jumps(contacts).sqrt()
}

/// By how much the density of thresholds jumps, in units of the inverse mean one; a point mass counts as its weight.
fn jumps(contacts: &Contacts) -> f64 {
    let law = &contacts.thresholds;
    let jumps = law.breakpoints().into_iter().filter(|b| b.exponent <= 0.0 && b.position > 0.0);
    let points = law.atoms().into_iter().map(|atom| atom.weight);
    jumps.map(|b| b.amplitude.abs() * law.mean()).chain(points).fold(0.0, f64::max)
}

/// The least length on which a density varies, 0 where there is none.
fn width(law: &dyn Law) -> f64 {
    let zones = law.zones();
    let spread = zones.iter().filter(|zone| zone.high > zone.low);
    let widths = spread.map(|zone| zone.resolution.min(0.5 * (zone.high - zone.low)));
    let least = widths.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}
