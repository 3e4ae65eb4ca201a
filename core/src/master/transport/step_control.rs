//! Control of the time step.

use serde::{Deserialize, Serialize};

use super::broken::{BrokenFraction, EarlyBreaks};
use crate::contacts::{Ageing, Contacts};
use crate::law::Law;
use crate::{Error, Float, Result};

/// Control of the time step.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct StepControl {
    /// Largest stretching in a step.
    #[serde(skip)]
    reach: f64,
    /// The same if the density of thresholds had no jumps.
    #[serde(skip)]
    farthest: f64,
    /// Whether the density of thresholds has no jumps.
    #[serde(skip)]
    smooth: bool,
    /// Largest allowed error of the extrapolated number of breaks, per contact.
    #[serde(skip)]
    extrapolation_error: f64,
    /// Largest allowed curvature of the breaks of contacts formed in the step, per contact.
    #[serde(skip)]
    curvature: f64,
    /// The duration that the next step may have.
    next: f64,
    /// The last step, if the next one continues it smoothly.
    last: Option<(f64, BrokenFraction)>,
    /// What formed in it, if that does not follow from what broke a delay before.
    formed: Option<BrokenFraction>,
}

/// Longest step in units of the length on which lives vary: this times the fourth root of the tolerance.
const REACH: f64 = 6.0;

/// Longest step in units of the mean threshold for densities with the largest jumps: this times the square
/// root of the tolerance.
const JUMP: f64 = 3.0;

/// Largest extrapolation error: this times tolerance^¾. The error of a step decreases with its extrapolation
/// error and with its length.
const SURPRISE: f64 = 10.0;

/// Largest fraction of the contacts formed in a step that may break in it.
const MOST_DEATHS: f64 = 0.3;

/// Largest curvature of the breaks of contacts formed in a step, in units of the tolerance; all but a
/// hundredth of it is accounted for.
const BEND: f64 = 100.0;

/// Largest factor by which steps grow or shrink.
const GROWTH: f64 = 2.0;

impl StepControl {
    pub(super) fn new(contacts: &Contacts, tolerance: f64) -> Self {
        let smooth = (REACH * tolerance.powf(0.25)).min(1.0) * smoothness(contacts);
        let coarsest = coarsest(contacts, tolerance);
        Self {
            reach: smooth.min(coarsest),
            farthest: smooth,
            smooth: coarsest.is_infinite(),
            extrapolation_error: SURPRISE * tolerance.powf(0.75),
            curvature: BEND * tolerance,
            next: f64::INFINITY,
            last: None,
            formed: None,
        }
    }

    /// The same with the settings of `other`, which are not serialised.
    pub(super) fn of(self, other: &Self) -> Self {
        let &Self { reach, farthest, smooth, extrapolation_error, curvature, .. } = other;
        Self { reach, farthest, smooth, extrapolation_error, curvature, ..self }
    }

    /// Whether the density of thresholds has no jumps, so that forces are smooth inside steps.
    pub(super) fn is_smooth(&self) -> bool {
        self.smooth
    }

    /// The duration of the next step at a velocity, with the time `left` until the next event.
    pub(super) fn propose(&self, velocity: f64, left: f64) -> f64 {
        /// The first step, if nothing else limits it.
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

    /// The longest panel of ages at a velocity if it concerns this fraction of contacts. What jumps of the density miss is of second
    /// order in its length, and in proportion to the fraction.
    pub(super) fn longest_of(&self, fraction: f64, velocity: f64) -> f64 {
        /// Fraction below which contacts are rare.
        const RARE: f64 = 1e-3;
        let wider = (RARE / fraction).sqrt().max(1.0);
        (self.reach * wider).min(self.farthest.max(self.reach)) / velocity.abs()
    }

    /// Discards the last step: the next one does not continue it.
    pub(super) fn restart(&mut self) {
        self.last = None;
        self.formed = None;
    }

    /// Whether a step is accurate enough; sets the duration of the next one. `missed` is an error of third order in the duration
    /// of the thresholds in it, as a fraction of contacts.
    pub(super) fn judge(
        &mut self,
        duration: f64,
        (fraction, formed): (BrokenFraction, Option<BrokenFraction>),
        deaths: EarlyBreaks,
        missed: f64,
    ) -> bool {
        // The number of breaks is computed, not extrapolated; the difference from its extrapolation
        // measures how well a parabola in time describes it in this step.
        let last = self.last.map(|last| last.0).zip(self.formed);
        let of_formed = formed.map_or(0.0, |formed| extrapolation_error(last, duration, formed));
        let of_breaks = extrapolation_error(self.last, duration, fraction);
        let extrapolation_error = of_breaks.max(of_formed).max(missed) / self.extrapolation_error;
        let curvature = fraction.end * deaths.curve().1.abs() / self.curvature;
        let early = deaths.early / MOST_DEATHS;
        // The extrapolation error is of third order in the duration, the curvature too.
        let factor = (0.9 / extrapolation_error.cbrt())
            .min(0.9 / curvature.cbrt())
            .min(0.9 / early)
            .clamp(1.0 / GROWTH, GROWTH);
        if extrapolation_error > 1.0 || curvature > 1.0 || early > 1.0 {
            self.next = factor.min(0.8) * duration;
            return false;
        }
        // A step cut short by an event does not limit longer ones.
        let longer = factor * duration;
        self.next = if factor >= 1.0 && self.next.is_finite() { longer.max(self.next) } else { longer };
        self.last = Some((duration, fraction));
        self.formed = formed;
        true
    }

    /// Refuses steps that shrink without limit.
    ///
    /// # Errors
    /// The next step would have no duration.
    pub(super) fn check(&self, refused: f64, time: f64, tolerance: f64) -> Result<()> {
        if self.next > f64::MIN_POSITIVE && self.next < refused {
            return Ok(());
        }
        let what = "contacts followed through time".to_owned();
        Err(Error::StepTooShort { what, time: Float(time), tolerance: Float(tolerance) })
    }

    /// The previous step, if the next one continues it.
    pub(super) fn last(&self) -> Option<(f64, BrokenFraction)> {
        self.last
    }
}

/// The difference between the breaks of a step and their linear extrapolation from the last breaking
/// rate; after a restart, the change of the breaking rate.
fn extrapolation_error(last: Option<(f64, BrokenFraction)>, duration: f64, fraction: BrokenFraction) -> f64 {
    let Some((before, last)) = last else { return (fraction.end - 2.0 * fraction.middle).abs() };
    let tilt = 4.0 * (last.end - 2.0 * last.middle);
    let between = 0.5 * (1.0 + duration / before);
    (fraction.end - duration / before * (last.end + tilt * between)).abs()
}

/// The length on which lives vary: that of the thresholds, and what temperature adds.
pub(in crate::master) fn scale(contacts: &Contacts) -> f64 {
    blurred_by(contacts, 1.0)
}

/// The stretch over which temperature changes the breaking rate by a factor of e, at the mean threshold; 0 without temperature.
fn thermal_length(contacts: &Contacts) -> f64 {
    let mean = contacts.thresholds.mean();
    contacts.rules.temperature.map_or(0.0, |t| t.energy / (contacts.stiffness.of(mean) * mean))
}

/// The length on which lives are smooth enough for steps. Where thresholds diffuse into the stretch they break without
/// temperature, too, so that temperature smooths lives less.
fn smoothness(contacts: &Contacts) -> f64 {
    /// Part of the length that temperature adds: half of it meets the tolerance with a margin of four.
    const DIFFUSING: f64 = 0.5;
    let diffuses = matches!(contacts.rules.ageing, Some(Ageing::Smoluchowski { .. }));
    blurred_by(contacts, if diffuses { DIFFUSING } else { 1.0 })
}

/// The length on which lives vary, with this part of what temperature adds.
fn blurred_by(contacts: &Contacts, part: f64) -> f64 {
    /// For identical thresholds without temperature, in units of the mean threshold.
    const LEAST: f64 = 0.02;
    let mean = contacts.thresholds.mean();
    let ageing = contacts.rules.ageing.as_ref().and_then(|ageing| ageing.mature());
    let widths = [Some(&contacts.thresholds), ageing].into_iter().flatten().map(|law| width(law.as_ref()));
    let width = widths.fold(mean, f64::min);
    let thermal = part * thermal_length(contacts);
    if width == 0.0 { thermal.clamp(LEAST * mean, mean) } else { width.hypot(thermal).min(mean) }
}

/// The longest stretching of a step for densities with jumps; infinite without jumps.
pub(super) fn coarsest(contacts: &Contacts, tolerance: f64) -> f64 {
    JUMP * tolerance.sqrt() * contacts.thresholds.mean() / jumps(contacts).sqrt()
}

/// The largest jump of the density of thresholds, in units of the inverse mean; a point mass counts as its
/// weight.
fn jumps(contacts: &Contacts) -> f64 {
    let law = &contacts.thresholds;
    let jumps = law.breakpoints().into_iter().filter(|b| b.exponent <= 0.0 && b.position > 0.0);
    let points = law.atoms().into_iter().map(|atom| atom.weight);
    jumps.map(|b| b.amplitude.abs() * law.mean()).chain(points).fold(0.0, f64::max)
}

/// The smallest length on which a density varies; 0 without density.
fn width(law: &dyn Law) -> f64 {
    let zones = law.zones();
    let spread = zones.iter().filter(|zone| zone.high > zone.low);
    let widths = spread.map(|zone| zone.resolution.min(0.5 * (zone.high - zone.low)));
    let least = widths.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}
