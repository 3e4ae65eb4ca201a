//! The contacts of an ensemble that move together in time, step by step.

use std::sync::{Arc, Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::attached::{AttachedContact, Segment};
use super::diffusion::DiffusingThreshold;
use super::lives::{ContactLife, Drawn, Lives};
use super::passage::Passage;
use super::{ASK, Ensemble};
use crate::contacts::{FreeFriction, FreeTime, Stiffness};
use crate::energy::ContactEnergies;
use crate::monitor::{Monitor, Watch, fits, report};
use crate::random::{Purpose, Stream};
use crate::rate_dependent::{ContactsState, RateDependentContacts, StretchInterval};
use crate::{Error, Result};

/// Bytes of a contact, and of the copies on which a step of a block is tried.
const BYTES: u64 = 5 * size_of::<ContactInTime>() as u64;

/// Contacts that a thread processes at once; sums are made in their order.
const CHUNK: usize = 256;

/// The contacts of an ensemble that move together in time.
///
/// Under a slider that follows a history they have the lives of [`Ensemble::follow`]; diffusing thresholds
/// have other random numbers, as these are drawn step by step. A step visits every contact, which takes 112
/// bytes; a copy shares contacts until either takes a step.
#[derive(Debug, Clone)]
pub struct EnsembleInTime {
    lives: Arc<Lives>,
    passage: Arc<Passage>,
    stiffness: Stiffness,
    mean_threshold: f64,
    delay: FreeTime,
    friction: FreeFriction,
    /// All of them, [`CHUNK`] at a time, shared with copies until either takes a step.
    contacts: Vec<Arc<Vec<ContactInTime>>>,
    size: usize,
    time: f64,
    position: f64,
    now: SumsInTime,
    past: SegmentTotals,
    /// From sums over the ensemble to the real contacts.
    scale: f64,
}

impl Ensemble {
    /// The contacts at t = 0 and X = 0, to be moved in time. Contacts at their threshold in a relaxed start
    /// have broken.
    ///
    /// # Errors
    /// Ageing by a rule that single contacts cannot follow; more contacts than can be numbered, or fit in
    /// memory with the copies of a step of a block.
    pub fn in_time(&self) -> Result<EnsembleInTime> {
        self.in_time_with(&mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::in_time`]; stopped by the monitor.
    pub fn in_time_with(&self, monitor: &mut dyn Monitor) -> Result<EnsembleInTime> {
        let what = format!("{} contacts in time", self.size);
        fits("size", what, (self.size as u64).saturating_mul(BYTES), monitor.memory())?;
        let Ok(size) = u32::try_from(self.size) else {
            return Err(Error::invalid("size", format!("up to {} contacts in time", u32::MAX), self.size));
        };
        let mut ensemble = EnsembleInTime {
            lives: Arc::new(Lives::in_any_order(self)),
            passage: Arc::new(Passage::of(self, monitor)?),
            stiffness: self.contacts.stiffness.clone(),
            mean_threshold: self.contacts.thresholds.mean(),
            delay: self.contacts.rules.delay.clone(),
            friction: self.contacts.rules.free_friction,
            contacts: Vec::with_capacity(self.size.div_ceil(CHUNK)),
            size: self.size,
            time: 0.0,
            position: 0.0,
            now: SumsInTime::default(),
            past: SegmentTotals::default(),
            scale: self.contacts.count / self.size as f64,
        };
        let mut streams = ensemble.streams();
        for first in (0..size).step_by(CHUNK) {
            report(monitor, 0.0)?;
            let end = size.min(first.saturating_add(CHUNK as u32));
            let chunk = (first..end).map(|index| ensemble.drawn(index, &mut streams)).collect();
            ensemble.contacts.push(Arc::new(chunk));
        }
        ensemble.advance(&Segment { start: 0.0, end: 0.0, position: 0.0, velocity: 0.0 }, monitor)?;
        // Nothing has been lost before the beginning.
        ensemble.past = SegmentTotals { lost: 0.0, slid: 0.0, ..ensemble.past };
        Ok(ensemble)
    }
}

/// A contact: its life, and its position in its random streams.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct ContactInTime {
    index: u32,
    drawn: Drawn,
    /// Words taken for breaking, for diffusion and for free times.
    words: [u64; 3],
    /// Whether it is attached; if not, it will form at the birth of `held`.
    holds: bool,
    /// The stretch at which it formed, or will form.
    formed: f64,
    held: AttachedContact,
    /// The hazard ∫w dt left before it breaks thermally.
    remaining_hazard: f64,
    wandering: DiffusingThreshold,
}

/// Sums over the attached contacts.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct SumsInTime {
    count: f64,
    stiffness: f64,
    force: f64,
    /// Σ ½k x².
    energy: f64,
}

/// Breaks and energies on a segment.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct SegmentTotals {
    broken: f64,
    lost: f64,
    strengthening: f64,
    /// Σ of the slip distances of free contacts.
    slid: f64,
}

/// The state of the contacts.
#[derive(Serialize, Deserialize)]
struct EnsembleSnapshot {
    time: f64,
    position: f64,
    contacts: Vec<ContactInTime>,
    now: SumsInTime,
    past: SegmentTotals,
}

/// Random streams of a thread.
struct RandomStreams {
    lives: Lives,
    breaking: Stream,
    diffusion: Stream,
    free: Stream,
}

impl ContactInTime {
    fn stretch(&self, position: f64) -> f64 {
        position - self.held.origin
    }

    /// Begins another life, at a future time.
    fn live(&mut self, life: ContactLife, birth: f64) {
        self.holds = false;
        self.formed = life.stretch;
        self.held = AttachedContact { birth, origin: 0.0, fresh: life.threshold };
        self.wandering = DiffusingThreshold::fresh(life.threshold);
    }
}

impl RandomStreams {
    /// Goes to the position of a contact in its streams.
    fn take(&mut self, contact: &ContactInTime) {
        let number = self.lives.number(contact.index.into());
        self.breaking.seek(number, contact.words[0]);
        self.diffusion.seek(number, contact.words[1]);
        self.free.seek(number, contact.words[2]);
    }

    /// An exponentially distributed hazard, or ∞ without temperature: inverse-transform sampling of the time
    /// of breaking.
    fn remaining_hazard(&mut self, contact: &mut ContactInTime, thermal: bool) -> f64 {
        if !thermal {
            return f64::INFINITY;
        }
        let remaining_hazard = self.breaking.exponential();
        contact.words[0] = self.breaking.taken();
        remaining_hazard
    }
}

impl EnsembleInTime {
    fn streams(&self) -> RandomStreams {
        let lives = (*self.lives).clone();
        let stream = |purpose| Stream::new(lives.seed(), purpose, 0);
        RandomStreams {
            breaking: stream(Purpose::Breaking),
            diffusion: stream(Purpose::Diffusion),
            free: stream(Purpose::FreeTimes),
            lives,
        }
    }

    /// All contacts in their order.
    fn contacts(&self) -> impl Iterator<Item = &ContactInTime> {
        self.contacts.iter().flat_map(|chunk| chunk.iter())
    }

    /// A contact as it is at t = 0, before anything breaks.
    fn drawn(&self, index: u32, streams: &mut RandomStreams) -> ContactInTime {
        let life = streams.lives.first(index.into());
        let mut contact = ContactInTime {
            index,
            drawn: streams.lives.drawn(),
            words: [0; 3],
            holds: false,
            formed: 0.0,
            held: AttachedContact { birth: 0.0, origin: 0.0, fresh: 0.0 },
            remaining_hazard: 0.0,
            wandering: DiffusingThreshold::fresh(0.0),
        };
        contact.live(life, 0.0);
        contact
    }

    /// Advances all contacts by a segment, unless the monitor stops it: then some have advanced, and sums are
    /// not updated.
    fn advance(&mut self, segment: &Segment, monitor: &mut dyn Monitor) -> Result<()> {
        let mut contacts = std::mem::take(&mut self.contacts);
        // A chunk is locked once, by the thread that advances it, which copies it first where it is shared.
        let chunks: Vec<Mutex<&mut Arc<Vec<ContactInTime>>>> = contacts.iter_mut().map(Mutex::new).collect();
        let watch = Watch::new(monitor);
        let chunk = |streams: &mut RandomStreams, number: usize| {
            let mut contacts = chunks[number].lock().unwrap_or_else(PoisonError::into_inner);
            Arc::make_mut(&mut contacts).iter_mut().fold(
                (SegmentTotals::default(), SumsInTime::default()),
                |(totals, sums), contact| {
                    (
                        totals.plus(self.live(contact, *segment, streams, &watch)),
                        sums.plus(self.contribution(contact, segment)),
                    )
                },
            )
        };
        let gone = watch.share(chunks.len(), || self.streams(), chunk);
        self.contacts = contacts;
        let gone = gone?;
        watch.check()?;
        // Chunks have a fixed size and are summed in order: the same bits on any number of threads.
        self.now = gone.iter().fold(SumsInTime::default(), |sum, chunk| sum.plus(chunk.1));
        self.past = gone.iter().fold(self.past, |sum, chunk| sum.plus(chunk.0));
        Ok(())
    }

    /// Advances a contact by a segment, in as many lives as needed. Once the monitor has stopped it, the contact is of no use.
    fn live(
        &self,
        contact: &mut ContactInTime,
        mut segment: Segment,
        streams: &mut RandomStreams,
        watch: &Watch<'_>,
    ) -> SegmentTotals {
        let (mut totals, mut freed, mut lives) = (SegmentTotals::default(), segment.start, 0_u32);
        streams.take(contact);
        loop {
            lives = lives.wrapping_add(1);
            if lives.is_multiple_of(ASK) && watch.stops() {
                return totals;
            }
            if !contact.holds {
                let formed = contact.held.birth.min(segment.end);
                totals.slid += segment.velocity * (formed - freed).max(0.0);
                if contact.held.birth > segment.end {
                    return totals;
                }
                segment = segment.from(contact.held.birth);
                self.form(contact, segment.position, streams);
                totals.lost -= self.energy(contact, &segment, segment.start);
            }
            let end = self.end(contact, &segment, streams, (&mut totals.strengthening, watch));
            // The position in the stream belongs to the contact, so that copies draw the same numbers.
            contact.words[1] = streams.diffusion.taken();
            let Some(end) = end else { return totals };
            totals.lost += self.energy(contact, &segment, end);
            totals.broken += 1.0;
            // Streams are counter-based (Philox), so that going to any position of any contact
            // costs one block.
            streams.lives.resume(contact.index.into(), contact.drawn, contact.held.fresh);
            let next = streams.lives.next();
            contact.drawn = streams.lives.drawn();
            contact.live(next, end + self.delay.draw(&mut streams.free));
            contact.words[2] = streams.free.taken();
            freed = end;
        }
    }

    fn form(&self, contact: &mut ContactInTime, position: f64, streams: &mut RandomStreams) {
        contact.held.origin = position - contact.formed;
        // Contacts at or above their thresholds, of a relaxed start, break at once, and draw nothing.
        let thermal = self.passage.is_thermal() && contact.formed < contact.held.fresh;
        contact.remaining_hazard = streams.remaining_hazard(contact, thermal);
        contact.holds = true;
    }

    /// The time at which a contact breaks on a segment, if it does; the work of ageing is added to `strengthening`.
    fn end(
        &self,
        contact: &mut ContactInTime,
        segment: &Segment,
        streams: &mut RandomStreams,
        (strengthening, watch): (&mut f64, &Watch<'_>),
    ) -> Option<f64> {
        // In a relaxed start some are above their thresholds.
        if contact.formed >= contact.held.fresh {
            return Some(segment.start);
        }
        let ContactInTime { held, remaining_hazard, wandering, .. } = contact;
        match self.passage.as_ref() {
            Passage::KnownThreshold(known) => {
                let end = known.on(held, segment, remaining_hazard);
                *strengthening += known.strengthening(held, segment, end.unwrap_or(segment.end));
                end
            }
            Passage::Diffusing(diffusion) => {
                let drawn = (remaining_hazard, &mut streams.diffusion);
                diffusion.on(held, wandering, segment, drawn, strengthening, watch)
            }
        }
    }

    /// Stiffness at a time.
    fn stiffness(&self, contact: &ContactInTime, time: f64) -> f64 {
        let threshold = match (self.stiffness.is_equal(), self.passage.as_ref()) {
            (true, _) => 0.0,
            (_, Passage::KnownThreshold(known)) => known.threshold(&contact.held, time),
            (_, Passage::Diffusing(_)) => contact.wandering.threshold(),
        };
        self.stiffness.of(threshold)
    }

    /// ½k x² at a time of a segment.
    fn energy(&self, contact: &ContactInTime, segment: &Segment, time: f64) -> f64 {
        let stretch = contact.stretch(segment.position(time));
        0.5 * self.stiffness(contact, time) * stretch * stretch
    }

    /// Contribution of a contact to the sums at the end of a segment.
    fn contribution(&self, contact: &ContactInTime, segment: &Segment) -> SumsInTime {
        if !contact.holds {
            return SumsInTime::default();
        }
        let (stiffness, stretch) =
            (self.stiffness(contact, segment.end), contact.stretch(segment.position(segment.end)));
        let force = stiffness * stretch;
        SumsInTime { count: 1.0, stiffness, force, energy: 0.5 * force * stretch }
    }
}

impl SumsInTime {
    fn plus(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            stiffness: self.stiffness + other.stiffness,
            force: self.force + other.force,
            energy: self.energy + other.energy,
        }
    }
}

impl SegmentTotals {
    fn plus(self, other: Self) -> Self {
        Self {
            broken: self.broken + other.broken,
            lost: self.lost + other.lost,
            strengthening: self.strengthening + other.strengthening,
            slid: self.slid + other.slid,
        }
    }
}

impl RateDependentContacts for EnsembleInTime {
    fn position(&self) -> f64 {
        self.position
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn force(&self) -> f64 {
        self.scale * self.now.force + self.free_friction().force
    }

    fn tangent(&self) -> f64 {
        self.scale * self.now.stiffness
    }

    fn free_friction(&self) -> FreeFriction {
        self.friction.scaled(self.scale * self.size as f64 * self.free())
    }

    fn energies(&self) -> ContactEnergies {
        let SegmentTotals { broken, lost, strengthening, slid } = self.past;
        let sliding = self.scale * self.friction.force * slid;
        let [elastic, lost, strengthening] =
            [self.now.energy, lost, strengthening].map(|energy| self.scale * energy);
        ContactEnergies { elastic, lost, strengthening, sliding, broken: broken / self.size as f64 }
    }

    fn free(&self) -> f64 {
        1.0 - self.now.count / self.size as f64
    }

    fn mean_threshold(&self) -> Option<f64> {
        Some(self.mean_threshold)
    }

    fn stretches(&self) -> Vec<StretchInterval> {
        let fraction = 1.0 / self.size as f64;
        let portion = |contact: &ContactInTime| {
            // Those just re-formed may lie below 0 by rounding.
            let stretch = contact.stretch(self.position).max(0.0);
            StretchInterval { low: stretch, high: stretch, fraction }
        };
        self.contacts().filter(|contact| contact.holds).map(portion).collect()
    }

    fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()> {
        if !(during > 0.0 && during.is_finite()) {
            return Err(Error::invalid("during", "a finite number above 0", during));
        }
        if !(by >= 0.0 && by.is_finite()) {
            return Err(Error::invalid("by", "a finite length, 0 or above", by));
        }
        let end = self.time + during;
        let segment = Segment { start: self.time, end, position: self.position, velocity: by / during };
        self.advance(&segment, monitor)?;
        (self.time, self.position) = (end, self.position + by);
        Ok(())
    }

    fn copy(&self) -> Box<dyn RateDependentContacts> {
        Box::new(self.clone())
    }

    fn state(&self) -> ContactsState {
        let &Self { time, position, now, past, .. } = self;
        let contacts = self.contacts().copied().collect();
        ContactsState::of(&EnsembleSnapshot { time, position, contacts, now, past })
    }

    fn restore(&mut self, state: &ContactsState) -> Result<()> {
        let EnsembleSnapshot { time, position, contacts, now, past } = state.read()?;
        if contacts.len() != self.size {
            return Err(ContactsState::another(&format!("that of {} contacts", contacts.len())));
        }
        self.contacts = contacts.chunks(CHUNK).map(|chunk| Arc::new(chunk.to_vec())).collect();
        (self.time, self.position, self.now, self.past) = (time, position, now, past);
        Ok(())
    }
}
