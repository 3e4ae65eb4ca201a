//! The end of a life in time: the stretch reaches the present threshold (first passage), or the contact
//! breaks thermally before.

use std::sync::Arc;

use super::Ensemble;
use super::attached::{AttachedContact, Segment, segments};
use super::contact::TOGETHER;
use super::diffusion::ThresholdDiffusion;
use crate::Result;
use crate::contacts::{
    Ageing, AveragedRate, Contacts, Stiffness, Temperature, ThresholdEvolution, ThresholdTrajectory,
};
use crate::history::History;
use crate::monitor::{Monitor, Watch};
use crate::numerics::accumulation::integral_reaches;
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::roots::brent_root;
use crate::numerics::wide::vectorised;

/// Parts into which e^{−t/τ} is divided where the thresholds of `frozen_rank` may be non-monotonic.
const PARTS: u32 = 32;

/// How contacts break.
#[derive(Debug, Clone)]
pub(super) enum Passage {
    /// Thresholds follow from age.
    KnownThreshold(KnownThreshold),
    /// Thresholds diffuse.
    Diffusing(ThresholdDiffusion),
}

impl Passage {
    /// Whether contacts break thermally.
    pub(super) fn is_thermal(&self) -> bool {
        match self {
            Self::KnownThreshold(known) => known.temperature.is_some(),
            Self::Diffusing(diffusion) => diffusion.is_thermal(),
        }
    }

    /// # Errors
    /// Ageing by a rule that single contacts cannot follow; stopped by the monitor.
    pub(super) fn of(ensemble: &Ensemble, monitor: &mut dyn Monitor) -> Result<Self> {
        let contacts = &ensemble.contacts;
        if let Some(Ageing::Smoluchowski { mature, diffusion }) = &contacts.rules.ageing {
            return Ok(Self::Diffusing(ThresholdDiffusion::new(contacts, mature.as_ref(), *diffusion)));
        }
        let evolution = ThresholdEvolution::of_with(contacts, monitor)?;
        Ok(Self::KnownThreshold(KnownThreshold {
            extrema: extrema(contacts.rules.ageing.as_ref(), &evolution),
            evolution,
            temperature: contacts.rules.temperature,
            averaged: averaged(contacts, monitor)?,
            stiffness: contacts.stiffness.clone(),
        }))
    }
}

/// The rate of the average contact, where that is the rate at which contacts break.
///
/// # Errors
/// Stopped by the monitor.
fn averaged(contacts: &Contacts, monitor: &mut dyn Monitor) -> Result<Option<Arc<AveragedRate>>> {
    let watch = Watch::new(monitor);
    let additive = contacts.rules.temperature.filter(Temperature::is_additive);
    let rate = additive.map(|temperature| Arc::new(AveragedRate::new(contacts, temperature, &watch)));
    watch.check().map(|()| rate)
}

/// Ages between which the rate of change of a threshold changes sign at most once, from falling to rising.
fn extrema(ageing: Option<&Ageing>, evolution: &ThresholdEvolution) -> Vec<f64> {
    let Some(&Ageing::FrozenRank { time, .. }) = ageing else { return Vec::new() };
    let parts = (1..PARTS).map(|part| -time * (-f64::from(part) / f64::from(PARTS)).ln_1p());
    // Beside an edge of the fresh law they turn soon after contacts form.
    let soon = evolution.octaves().into_iter().take_while(|age| *age < time / f64::from(PARTS));
    soon.chain(parts).collect()
}

/// Simulates contacts whose thresholds follow from age.
#[derive(Debug, Clone)]
pub(super) struct KnownThreshold {
    evolution: ThresholdEvolution,
    temperature: Option<Temperature>,
    /// The rate that takes the place of that of the contact's own threshold.
    averaged: Option<Arc<AveragedRate>>,
    stiffness: Stiffness,
    extrema: Vec<f64>,
}

impl KnownThreshold {
    /// The present threshold.
    pub(super) fn threshold(&self, held: &AttachedContact, time: f64) -> f64 {
        self.evolution.threshold(held.fresh, time - held.birth)
    }

    /// The time at which a contact with the hazard `remaining_hazard` left breaks, if before the last of the
    /// `marks`, which rise; else infinite.
    pub(super) fn end(
        &self,
        held: &AttachedContact,
        history: &History,
        marks: &[f64],
        mut remaining_hazard: f64,
    ) -> f64 {
        let mut segments = segments(history, held.birth..marks[marks.len() - 1]);
        segments.find_map(|segment| self.on(held, &segment, &mut remaining_hazard)).unwrap_or(f64::INFINITY)
    }

    /// The time at which it breaks on a segment, if it does.
    pub(super) fn on(
        &self,
        held: &AttachedContact,
        segment: &Segment,
        remaining_hazard: &mut f64,
    ) -> Option<f64> {
        let contact = self.evolution.followed(held.fresh);
        let time_of_passage = self.time_of_passage(&contact, held, segment);
        self.thermal_break(&contact, held, segment, time_of_passage, remaining_hazard)
            .or((time_of_passage <= segment.end).then_some(time_of_passage))
    }

    /// The work ∫½x² dk of ageing on a contact from the start of a segment to `end`, computed as ½[kx²] − ∫kx
    /// dX.
    pub(super) fn strengthening(&self, held: &AttachedContact, segment: &Segment, end: f64) -> f64 {
        if self.evolution.is_constant() || self.stiffness.is_equal() {
            return 0.0;
        }
        let stretch = |time| segment.position(time) - held.origin;
        let force = |time| self.stiffness.of(self.threshold(held, time)) * stretch(time);
        let stored = |time| 0.5 * force(time) * stretch(time);
        // By parts, so that no derivative of the threshold by age is needed, which is large just
        // after birth.
        stored(end) - stored(segment.start) - segment.velocity * RULE.integrate(segment.start, end, force)
    }

    /// When the stretch reaches the threshold, if the segment is long enough; if not, infinite, or for a
    /// constant threshold a time after its end.
    fn time_of_passage(
        &self,
        contact: &ThresholdTrajectory<'_>,
        held: &AttachedContact,
        segment: &Segment,
    ) -> f64 {
        let gap = |time: f64| held.origin + contact.threshold(time - held.birth) - segment.position(time);
        let mut from = segment.start;
        if gap(from) <= 0.0 {
            return from;
        }
        if self.evolution.is_constant() {
            let time_of_passage = from + gap(from) / segment.velocity;
            // Simultaneous breaks also happen before a hold, whatever the rounding.
            let late = gap(segment.end) > TOGETHER * segment.position(segment.end);
            return if late { time_of_passage } else { time_of_passage.min(segment.end) };
        }
        // Below the lowest threshold that it ever has no contact breaks.
        let below = |time: f64| segment.position(time) - held.origin < contact.lowest();
        if below(segment.start) && below(segment.end) {
            return f64::INFINITY;
        }
        // Between two extrema of the threshold the rate at which the gap closes changes sign at
        // most once. Each interval then holds at most one minimum of the gap, and no passage is
        // missed.
        let extrema = self.extrema.iter().map(|age| held.birth + age);
        let extrema = extrema.filter(|turn| (segment.start..segment.end).contains(turn));
        let mut ends = extrema.chain([segment.end]).peekable();
        while let Some(early) = ends.next_if(|&end| below(from) && below(end)) {
            from = early;
        }
        let closing = |time: f64| contact.drift(time - held.birth) - segment.velocity;
        let mut closing_from = closing(from);
        for until in ends {
            // If the gap shrinks and grows again it may close in between.
            let closing_until = closing(until);
            let lowest = if closing_from < 0.0 && closing_until > 0.0 {
                brent_root(closing, from, until, 0.0).filter(|&lowest| gap(lowest) <= 0.0)
            } else {
                None
            };
            let until = lowest.unwrap_or(until);
            if lowest.is_some() || gap(until) <= 0.0 {
                return brent_root(gap, from, until, 0.0).unwrap_or(until);
            }
            (from, closing_from) = (until, closing_until);
        }
        f64::INFINITY
    }

    /// Whether a contact that does not reach its threshold on a segment does not break thermally either; what it has left of its
    /// hazard is then reduced.
    pub(super) fn survives(
        &self,
        held: &AttachedContact,
        segment: &Segment,
        remaining_hazard: &mut f64,
    ) -> bool {
        let contact = self.evolution.followed(held.fresh);
        self.thermal_break(&contact, held, segment, f64::INFINITY, remaining_hazard).is_none()
    }

    /// When the contact breaks thermally, if on this segment and before its stretch reaches the threshold.
    ///
    /// Close to that time barriers are powers of √(time left), which is therefore the variable of
    /// integration.
    fn thermal_break(
        &self,
        contact: &ThresholdTrajectory<'_>,
        held: &AttachedContact,
        segment: &Segment,
        time_of_passage: f64,
        remaining_hazard: &mut f64,
    ) -> Option<f64> {
        if let Some(averaged) = &self.averaged {
            let end = time_of_passage.min(segment.end);
            return averaged_break(averaged, segment, held, end, remaining_hazard);
        }
        let temperature = self.temperature?;
        let stretch = segment.position - held.origin;
        let rates = |elapsed: &Nodal| {
            let (mut ages, mut stretches) = (*elapsed, *elapsed);
            for i in 0..NODES {
                ages[i] = segment.start + elapsed[i] - held.birth;
                stretches[i] = stretch + segment.velocity * elapsed[i];
            }
            temperature.rates(&stretches, &contact.thresholds(&ages), &self.stiffness)
        };
        let span = time_of_passage.min(segment.end) - segment.start;
        if time_of_passage.is_infinite() {
            let end = integral_reaches(|elapsed| vectorised(|| rates(elapsed)), span, remaining_hazard);
            return end.map(|elapsed| segment.start + elapsed);
        }
        // Substitution y = √T − √(T − t), T the time of passage, which removes the singularity of the rate at
        // T.
        let root = (time_of_passage - segment.start).sqrt();
        let length = span / (root + (time_of_passage - segment.start - span).sqrt());
        let elapsed = |y: f64| y * (2.0 * root - y);
        let substituted = |y: &Nodal| {
            let mut out = rates(&y.map(elapsed));
            for i in 0..NODES {
                out[i] *= 2.0 * (root - y[i]);
            }
            out
        };
        let end = integral_reaches(|y| vectorised(|| substituted(y)), length, remaining_hazard);
        end.map(|y| segment.start + elapsed(y))
    }
}

/// When a contact breaks that does so at the rate of the average contact of its stretch, if before `end`: by inversion of the
/// integral of the rate over the stretch.
fn averaged_break(
    rate: &AveragedRate,
    segment: &Segment,
    held: &AttachedContact,
    end: f64,
    remaining_hazard: &mut f64,
) -> Option<f64> {
    let (stretch, span) = (segment.position - held.origin, end - segment.start);
    let passed = |time: f64| match segment.velocity {
        0.0 => rate.at(stretch) * time,
        velocity => rate.integral(stretch, velocity * time) / velocity,
    };
    let whole = passed(span);
    if whole < *remaining_hazard {
        *remaining_hazard -= whole;
        return None;
    }
    let left = *remaining_hazard;
    let elapsed = brent_root(|time| passed(time) - left, 0.0, span, 0.0).unwrap_or(span);
    Some(segment.start + elapsed)
}
