//! How a life in time ends: the stretch meets the present threshold, or heat breaks the contact before.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::Ensemble;
use super::diffusion::ThresholdDiffusion;
use super::sweep::TOGETHER;
use crate::Result;
use crate::contacts::{Ageing, Stiffness, Temperature, ThresholdEvolution};
use crate::history::History;
use crate::monitor::Monitor;
use crate::numerics::accumulation::integral_reaches;
use crate::numerics::legendre::RULE;
use crate::numerics::roots::brent_root;

/// Parts into which e^{−t/τ} is cut where the thresholds of `frozen_rank` may fall and rise again.
const PARTS: u32 = 32;

/// A contact that holds: its stretch is X − `origin`.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct AttachedContact {
    /// When it formed.
    pub(super) birth: f64,
    pub(super) origin: f64,
    /// The threshold that it had then.
    pub(super) newborn: f64,
}

/// A part of a history, at one velocity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    pub(super) start: f64,
    pub(super) end: f64,
    /// X at the start.
    pub(super) position: f64,
    pub(super) velocity: f64,
}

impl Segment {
    #[inline]
    pub(super) fn position(&self, time: f64) -> f64 {
        self.position + self.velocity * (time - self.start)
    }
}

impl Segment {
    /// The rest of it from a time on.
    #[inline]
    pub(super) fn from(self, time: f64) -> Self {
        Self { start: time, position: self.position(time), ..self }
    }
}

/// The legs of a history that overlap with a range of times, the first one from its start.
pub(super) fn legs(history: &History, range: Range<f64>) -> impl Iterator<Item = Segment> {
    let (pieces, knots) = (history.pieces(), history.knots());
    let leg = move |i: usize| {
        let ((begin, position), velocity) = (knots[i], pieces[i].velocity);
        let start = begin.max(range.start);
        Segment { start, end: knots[i + 1].0, position: position + velocity * (start - begin), velocity }
    };
    let last = history.piece_at(range.end);
    (history.piece_at(range.start)..=last).map(leg)
}

/// Stiffness of a contact of this threshold.
pub(super) fn stiffness(stiffness: Stiffness, threshold: f64) -> f64 {
    match stiffness {
        Stiffness::Equal(k) => k,
        Stiffness::PerThreshold(factor) => factor * threshold,
    }
}

/// How contacts break.
#[derive(Debug, Clone)]
pub(super) enum Passage {
    /// Their thresholds follow from their ages.
    KnownThreshold(KnownThreshold),
    /// Their thresholds diffuse.
    Diffusing(ThresholdDiffusion),
}

impl Passage {
    /// Whether heat breaks contacts.
    pub(super) fn is_hot(&self) -> bool {
        match self {
            Self::KnownThreshold(known) => known.temperature.is_some(),
            Self::Diffusing(diffusion) => diffusion.is_hot(),
        }
    }

    /// # Errors
    /// Ageing by a rule that single contacts cannot follow; stopped by the monitor.
    pub(super) fn of(ensemble: &Ensemble, monitor: &mut dyn Monitor) -> Result<Self> {
        let contacts = &ensemble.contacts;
        if let Some(Ageing::Smoluchowski { mature, diffusion }) = &contacts.rules.ageing {
            return Ok(Self::Diffusing(ThresholdDiffusion::new(contacts, mature.as_ref(), *diffusion)));
        }
        let strength = ThresholdEvolution::of(contacts, monitor)?;
        Ok(Self::KnownThreshold(KnownThreshold {
            turns: turns(contacts.rules.ageing.as_ref(), &strength),
            strength,
            temperature: contacts.rules.temperature,
            stiffness: contacts.stiffness,
        }))
    }
}

/// Ages between which the rate at which a threshold changes does so once at most, rising.
fn turns(ageing: Option<&Ageing>, strength: &ThresholdEvolution) -> Vec<f64> {
    let Some(&Ageing::FrozenRank { time, .. }) = ageing else { return Vec::new() };
    let parts = (1..PARTS).map(|part| -time * (-f64::from(part) / f64::from(PARTS)).ln_1p());
    // Beside an edge of the newborn law they turn soon after contacts form.
    let soon = strength.octaves().into_iter().take_while(|age| *age < time / f64::from(PARTS));
    soon.chain(parts).collect()
}

/// The end of lives whose thresholds follow from their ages.
#[derive(Debug, Clone)]
pub(super) struct KnownThreshold {
    strength: ThresholdEvolution,
    temperature: Option<Temperature>,
    stiffness: Stiffness,
    turns: Vec<f64>,
}

impl KnownThreshold {
    /// The present threshold.
    pub(super) fn threshold(&self, held: &AttachedContact, time: f64) -> f64 {
        self.strength.threshold(held.newborn, time - held.birth)
    }

    /// When a contact breaks that survives `endurance` = ∫w dt, if before the last of the `marks`, which rise; infinite if
    /// not.
    pub(super) fn end(
        &self,
        held: &AttachedContact,
        history: &History,
        marks: &[f64],
        mut remaining_hazard: f64,
    ) -> f64 {
        let mut legs = legs(history, held.birth..marks[marks.len() - 1]);
        legs.find_map(|leg| self.on(held, &leg, &mut remaining_hazard)).unwrap_or(f64::INFINITY)
    }

    /// When it breaks on a leg, if it does.
    pub(super) fn on(
        &self,
        held: &AttachedContact,
        leg: &Segment,
        remaining_hazard: &mut f64,
    ) -> Option<f64> {
        let meeting = self.meeting(held, leg);
        self.fires(held, leg, meeting, remaining_hazard).or((meeting <= leg.end).then_some(meeting))
    }

    /// What ageing brings to a contact from the start of a leg to a time by making it stiffer, ∫½x² dk, which is
    /// ½[kx²] − ∫kx dX.
    pub(super) fn gained(&self, held: &AttachedContact, leg: &Segment, end: f64) -> f64 {
        if self.strength.is_constant() || matches!(self.stiffness, Stiffness::Equal(_)) {
            return 0.0;
        }
        let stretch = |time| leg.position(time) - held.origin;
        let force = |time| stiffness(self.stiffness, self.threshold(held, time)) * stretch(time);
        let stored = |time| 0.5 * force(time) * stretch(time);
        stored(end) - stored(leg.start) - leg.velocity * RULE.integrate(leg.start, end, force)
    }

    /// When the stretch meets the threshold, if the leg goes on for so long; infinite, or for a constant threshold after
    /// the end of the leg, if not.
    fn meeting(&self, held: &AttachedContact, leg: &Segment) -> f64 {
        let gap = |time| held.origin + self.threshold(held, time) - leg.position(time);
        let mut from = leg.start;
        if gap(from) <= 0.0 {
            return from;
        }
        if self.strength.is_constant() {
            let meeting = from + gap(from) / leg.velocity;
            // What breaks together does so before a hold, too, whatever the rounding.
            let late = gap(leg.end) > TOGETHER * leg.position(leg.end);
            return if late { meeting } else { meeting.min(leg.end) };
        }
        let closing = |time: f64| self.strength.at(time - held.birth).drift(held.newborn) - leg.velocity;
        let turns = self.turns.iter().map(|age| held.birth + age);
        let turns = turns.filter(|turn| (leg.start..leg.end).contains(turn));
        for until in turns.chain([leg.end]) {
            // Where the gap falls and grows again it may close in between.
            let lowest = if closing(from) < 0.0 && closing(until) > 0.0 {
                brent_root(closing, from, until, 0.0).filter(|&lowest| gap(lowest) <= 0.0)
            } else {
                None
            };
            let until = lowest.unwrap_or(until);
            if gap(until) <= 0.0 {
                return brent_root(gap, from, until, 0.0).unwrap_or(until);
            }
            from = until;
        }
        f64::INFINITY
    }

    /// When heat breaks the contact, if on this leg and before the meeting.
    ///
    /// Near the meeting barriers are powers of √(time left), which is why that is the variable of integration.
    fn fires(
        &self,
        held: &AttachedContact,
        leg: &Segment,
        meeting: f64,
        remaining_hazard: &mut f64,
    ) -> Option<f64> {
        let temperature = self.temperature?;
        let constant = self.strength.is_constant().then_some(held.newborn);
        let stretch = leg.position - held.origin;
        let rate = |elapsed: f64| {
            let threshold = constant.unwrap_or_else(|| self.threshold(held, leg.start + elapsed));
            let own = stiffness(self.stiffness, threshold);
            temperature.rate(stretch + leg.velocity * elapsed, threshold, own)
        };
        let span = meeting.min(leg.end) - leg.start;
        if meeting.is_infinite() {
            return integral_reaches(rate, span, remaining_hazard).map(|elapsed| leg.start + elapsed);
        }
        let root = (meeting - leg.start).sqrt();
        let length = span / (root + (meeting - leg.start - span).sqrt());
        let elapsed = |y: f64| y * (2.0 * root - y);
        let end = integral_reaches(|y| 2.0 * (root - y) * rate(elapsed(y)), length, remaining_hazard);
        end.map(|y| leg.start + elapsed(y))
    }
}
