//! When contacts on a lattice break in time: their births, the hazards that they have left, and the next breaks.

use serde::{Deserialize, Serialize};

use super::thermal::ThermalActivation;
use crate::contacts::{Ageing, Contacts, ThresholdEvolution};
use crate::ensemble::Ensemble;
use crate::ensemble::attached::{AttachedContact, Segment};
use crate::ensemble::passage::{KnownThreshold, Passage};
use crate::monitor::Monitor;
use crate::random::{Purpose, Stream};
use crate::{Error, Result};

/// A hazard so small that it is not subtracted.
const NEGLIGIBLE: f64 = 1e-12;

/// What an avalanche says of the contacts that it changes.
pub(super) trait Timekeeping {
    /// A contact whose stretch is about to jump: `number` and fresh threshold are computed only if needed. Returns by
    /// how much its present threshold exceeds the fresh one.
    fn jump(&mut self, place: usize, end: f64, drive: f64, contact: impl FnOnce() -> (usize, f64)) -> f64;

    /// A contact that has broken and re-formed.
    fn form(&mut self, place: usize, number: impl FnOnce() -> usize);
}

/// Contacts without time dependence.
#[derive(Debug)]
pub(super) struct Athermal;

impl Timekeeping for Athermal {
    #[inline(always)]
    fn jump(&mut self, _: usize, _: f64, _: f64, _: impl FnOnce() -> (usize, f64)) -> f64 {
        0.0
    }

    #[inline(always)]
    fn form(&mut self, _: usize, _: impl FnOnce() -> usize) {}
}

/// A contact in time. Times are relative to that of the base of the drive.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct ContactClock {
    /// When it formed.
    birth: f64,
    /// The time up to which its hazard is counted.
    counted: f64,
    /// The hazard ∫w dt left then, before it breaks thermally: an exponentially distributed number at birth.
    left: f64,
    /// The closed form of the hazard then.
    before: f64,
    /// Numbers taken from its stream.
    drawn: u32,
    /// Whether it has changed since its next break was computed.
    changed: bool,
    /// Whether the next break is a lower bound.
    bound: bool,
}

/// A site, for the next break of its contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Site {
    pub(super) place: usize,
    pub(super) number: usize,
    /// The fresh threshold.
    pub(super) fresh: f64,
    /// The drive at which the contact would break if its threshold stayed as at birth.
    pub(super) end: f64,
}

/// The times of contacts that move at a velocity: the *next reaction method* of M. A. Gibson and J. Bruck (J. Phys. Chem. A
/// 104, 1876 (2000)). A contact has drawn the hazard that it survives; the time at which this is used up is computed
/// again only if its stretch jumps.
///
/// Where thresholds age, the next break is a lower bound at first, in closed form for the lowest threshold from now on, and is
/// computed once it comes first.
#[derive(Debug, Clone)]
pub(super) struct Clocks {
    known: KnownThreshold,
    evolution: ThresholdEvolution,
    thermal: Option<ThermalActivation>,
    breaking: Stream,
    velocity: f64,
    /// Time at the base of the drive.
    pub(super) base: f64,
    /// The present time, relative to `base`.
    pub(super) now: f64,
    /// The drive and the time, relative to their bases, at which the motion at this velocity began.
    since: [f64; 2],
    contacts: Vec<ContactClock>,
    /// Where contacts break next: the drive since its base, at rest the time since `base`; infinite on the rim.
    pub(super) due: Vec<f64>,
    /// The places of the contacts that have changed.
    changed: Vec<u32>,
}

/// The clocks of a lattice as a state.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ClocksState {
    velocity: f64,
    base: f64,
    now: f64,
    since: [f64; 2],
    contacts: Vec<ContactClock>,
    /// Along rows.
    due: Vec<f64>,
    /// Places that have changed, along rows.
    changed: Vec<usize>,
}

impl Clocks {
    /// Clocks of `size` contacts at `places` sites, none of which has a next break yet.
    ///
    /// # Errors
    /// Thresholds that do not follow from age; contacts that are free for a time; stopped by the monitor.
    pub(super) fn new(
        ensemble: &Ensemble,
        velocity: f64,
        stiffness: f64,
        (size, places): (usize, usize),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let contacts = &ensemble.contacts;
        Self::check(contacts)?;
        let Passage::KnownThreshold(known) = Passage::of(ensemble, monitor)? else {
            return Err(no_diffusion());
        };
        let thermal = contacts.rules.temperature;
        Ok(Self {
            evolution: ThresholdEvolution::of_with(contacts, monitor)?,
            known,
            thermal: thermal.map(|temperature| ThermalActivation { temperature, stiffness }),
            breaking: Stream::new(ensemble.seed, Purpose::Breaking, 0),
            velocity,
            base: 0.0,
            now: 0.0,
            since: [0.0; 2],
            contacts: vec![ContactClock::default(); size],
            due: vec![f64::INFINITY; places],
            changed: Vec::new(),
        })
    }

    /// Refuses rules that contacts coupled one by one cannot follow in time.
    ///
    /// # Errors
    /// The first rule refused.
    pub(super) fn check(contacts: &Contacts) -> Result<()> {
        if !contacts.rules.delay.is_none() {
            let expected =
                "no delay where contacts are coupled one by one: these re-form when the slide is over";
            return Err(Error::invalid("delay", expected, "one"));
        }
        contacts.break_by_own_threshold()?;
        match &contacts.rules.ageing {
            Some(Ageing::Smoluchowski { .. }) => Err(no_diffusion()),
            Some(Ageing::MeanField { .. }) => {
                let expected = "ageing by a rule for single contacts where they are coupled one by one";
                Err(Error::invalid("ageing.mean_field", expected, "a closure"))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn velocity(&self) -> f64 {
        self.velocity
    }

    /// The present time.
    pub(super) fn time(&self) -> f64 {
        self.base + self.now
    }

    /// The variable along which contacts break: the drive since its base, or at rest the time since `base`.
    pub(super) fn progress(&self, drive: f64) -> f64 {
        if self.velocity > 0.0 { drive } else { self.now }
    }

    /// The time since `base` at a value of that variable.
    pub(super) fn time_at(&self, progress: f64) -> f64 {
        if self.velocity > 0.0 {
            self.since[1] + (progress - self.since[0]) / self.velocity
        } else {
            progress
        }
    }

    /// That variable at a time since `base`.
    pub(super) fn progress_at(&self, time: f64) -> f64 {
        if self.velocity > 0.0 { self.since[0] + self.velocity * (time - self.since[1]) } else { time }
    }

    /// Whether next breaks may be lower bounds.
    pub(super) fn has_bounds(&self) -> bool {
        !self.evolution.is_constant()
    }

    /// The age of a contact.
    pub(super) fn age(&self, number: usize) -> f64 {
        self.now - self.contacts[number].birth
    }

    /// By how much the threshold of a contact exceeds the fresh one.
    #[inline]
    pub(super) fn strengthening(&self, number: usize, fresh: f64) -> f64 {
        if self.evolution.is_constant() {
            return 0.0;
        }
        self.evolution.threshold(fresh, self.age(number)) - fresh
    }

    /// Draws the hazard that a contact will survive. `number` selects its stream.
    #[inline]
    pub(super) fn draw(&mut self, number: usize) {
        let contact = &mut self.contacts[number];
        if self.thermal.is_none() {
            contact.left = f64::INFINITY;
            return;
        }
        self.breaking.seek(number as u64, contact.drawn.into());
        contact.left = self.breaking.exponential();
        contact.drawn = self.breaking.taken() as u32;
    }

    /// Subtracts the hazard since it was counted from what a contact has left.
    fn settle(&mut self, site: Site, drive: f64) {
        let Site { number, fresh, end, .. } = site;
        let span = self.now - self.contacts[number].counted;
        let Some(thermal) = self.thermal.filter(|_| span > 0.0) else { return };
        let stretch = fresh + (drive - end);
        if !self.evolution.is_constant() {
            return self.settle_aged(site, stretch, drive);
        }
        let contact = &mut self.contacts[number];
        let hazard = if self.velocity > 0.0 {
            thermal.at(fresh, self.velocity).value(stretch) - contact.before
        } else {
            thermal.rate(stretch, fresh) * span
        };
        contact.left = (contact.left - hazard).max(0.0);
    }

    /// The same for a threshold that ages.
    fn settle_aged(&mut self, site: Site, stretch: f64, drive: f64) {
        let Some(thermal) = self.thermal else { return };
        let mut contact = self.contacts[site.number];
        // With the lowest threshold the hazard is larger.
        let lowest = self.evolution.lowest_from(site.fresh, contact.counted - contact.birth);
        let most = if self.velocity > 0.0 {
            thermal.at(lowest, self.velocity).value(stretch) - contact.before
        } else {
            thermal.rate(stretch, lowest) * (self.now - contact.counted)
        };
        if stretch < lowest && most < NEGLIGIBLE {
            return;
        }
        let (held, segment) = self.held(site, drive, self.now);
        if !self.known.survives(&held, &segment, &mut contact.left) {
            contact.left = 0.0;
        }
        self.contacts[site.number].left = contact.left;
    }

    /// A contact and its motion from the time up to which its hazard is counted.
    fn held(&self, site: Site, drive: f64, end: f64) -> (AttachedContact, Segment) {
        let ContactClock { birth, counted, .. } = self.contacts[site.number];
        let held = AttachedContact { birth, origin: site.end - site.fresh, fresh: site.fresh };
        let position = drive - self.velocity * (self.now - counted);
        (held, Segment { start: counted, end, position, velocity: self.velocity })
    }

    /// Computes where a contact breaks next, from its present stretch.
    #[inline]
    pub(super) fn schedule(&mut self, site: Site, drive: f64) {
        let Site { place, number, fresh, end } = site;
        let stretch = fresh + (drive - end);
        let lowest = if self.evolution.is_constant() {
            fresh
        } else {
            self.evolution.lowest_from(fresh, self.age(number))
        };
        let contact = &mut self.contacts[number];
        (contact.counted, contact.changed) = (self.now, false);
        // The drive at which it breaks at the latest, if that is its threshold.
        let passage = end + (lowest - fresh);
        let due = next_break(self.thermal, contact, (stretch, lowest), (drive, passage), self.velocity);
        contact.bound = !self.evolution.is_constant() && due.is_finite();
        self.due[place] = if self.velocity > 0.0 { due } else { self.now + due };
    }

    /// Computes where a contact breaks next, if that is only a lower bound; returns whether it was.
    pub(super) fn refine(&mut self, site: Site, drive: f64) -> bool {
        let contact = self.contacts[site.number];
        if !contact.bound {
            return false;
        }
        let bound = self.time_at(self.due[site.place]);
        let until = (2.0 * bound - contact.counted).max(self.now + self.likely(site, drive));
        let (held, segment) = self.held(site, drive, until);
        let found = self.known.on(&held, &segment, &mut contact.left.clone());
        let goes_on = until.is_finite() && (self.velocity > 0.0 || self.thermal.is_some());
        let due = found.unwrap_or(if goes_on { until } else { f64::INFINITY });
        self.contacts[site.number].bound = found.is_none() && goes_on;
        self.due[site.place] = self.progress_at(due.max(self.now)).max(self.progress(drive));
        true
    }

    /// The time after which a contact would break if its threshold stayed as it is, long enough to be resolved; at rest without a
    /// temperature that in which its threshold may fall.
    fn likely(&self, site: Site, drive: f64) -> f64 {
        /// Part of the time in which the contact crosses its threshold, or breaks at its rate.
        const RESOLVED: f64 = 1e-9;
        let stretch = site.fresh + (drive - site.end);
        let threshold = site.fresh + self.strengthening(site.number, site.fresh);
        let rate = self.thermal.map_or(0.0, |thermal| thermal.rate(stretch, threshold));
        if self.velocity == 0.0 && rate == 0.0 {
            return self.evolution.settled();
        }
        let crossing = threshold / self.velocity;
        let passage = (threshold - stretch).max(0.0) / self.velocity.max(f64::MIN_POSITIVE);
        let left = self.contacts[site.number].left;
        (left / rate).min(passage).max(RESOLVED * crossing.min(rate.recip()))
    }

    /// Counts the hazard of a contact up to now, unless that has been done since its next break was computed.
    #[inline]
    fn change(&mut self, site: Site, drive: f64) {
        if !self.contacts[site.number].changed {
            self.settle(site, drive);
            self.contacts[site.number].changed = true;
            self.changed.push(site.place as u32);
        }
    }

    /// The places of contacts that have changed, of which the next breaks are to be computed.
    pub(super) fn take_changed(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.changed)
    }

    /// Keeps the memory of the list that [`Self::take_changed`] returned.
    pub(super) fn keep(&mut self, mut list: Vec<u32>) {
        list.clear();
        self.changed = list;
    }

    /// Counts the hazard of a contact up to now, at the end of the motion at this velocity.
    pub(super) fn count(&mut self, site: Site, drive: f64) {
        self.settle(site, drive);
        self.contacts[site.number].counted = self.now;
    }

    /// Goes on at another velocity. The next breaks of all contacts are to be computed.
    pub(super) fn set_velocity(&mut self, velocity: f64, drive: f64) {
        (self.velocity, self.since) = (velocity, [drive, self.now]);
    }

    /// Advances to a value of the variable along which contacts break.
    pub(super) fn advance(&mut self, progress: f64) {
        self.now = self.time_at(progress);
    }

    /// Moves the origin of time to the present one, and that of the drive by `drive`.
    pub(super) fn rebase(&mut self, drive: f64) {
        let now = self.now;
        self.base += now;
        let by = if self.velocity > 0.0 { drive } else { now };
        self.due.iter_mut().for_each(|due| *due -= by);
        for contact in &mut self.contacts {
            contact.birth -= now;
            contact.counted -= now;
        }
        (self.now, self.since) = (0.0, [self.since[0] - drive, self.since[1] - now]);
    }

    /// The state, with places in the order `of` contacts along rows, and the number of a place.
    pub(super) fn state(
        &self,
        place: impl Fn(usize) -> usize,
        number: impl Fn(usize) -> usize,
    ) -> ClocksState {
        ClocksState {
            velocity: self.velocity,
            base: self.base,
            now: self.now,
            since: self.since,
            contacts: self.contacts.clone(),
            due: (0..self.contacts.len()).map(|i| self.due[place(i)]).collect(),
            changed: self.changed.iter().map(|&at| number(at as usize)).collect(),
        }
    }

    /// Restores a state of as many contacts.
    pub(super) fn restore(&mut self, state: ClocksState, place: impl Fn(usize) -> usize) {
        let ClocksState { velocity, base, now, since, contacts, due, changed } = state;
        (self.velocity, self.base, self.now, self.since) = (velocity, base, now, since);
        due.into_iter().enumerate().for_each(|(i, due)| self.due[place(i)] = due);
        self.contacts = contacts;
        self.changed = changed.into_iter().map(|i| place(i) as u32).collect();
    }
}

impl ClocksState {
    /// Whether it is one of so many contacts.
    pub(super) fn fits(&self, size: usize) -> bool {
        let Self { contacts, due, changed, .. } = self;
        contacts.len() == size && due.len() == size && changed.iter().all(|&number| number < size)
    }
}

impl Timekeeping for Clocks {
    #[inline]
    fn jump(&mut self, place: usize, end: f64, drive: f64, contact: impl FnOnce() -> (usize, f64)) -> f64 {
        let (number, fresh) = contact();
        self.change(Site { place, number, fresh, end }, drive);
        self.strengthening(number, fresh)
    }

    #[inline]
    fn form(&mut self, place: usize, number: impl FnOnce() -> usize) {
        let number = number();
        let now = self.now;
        let contact = &mut self.contacts[number];
        contact.birth = now;
        if !contact.changed {
            contact.changed = true;
            self.changed.push(place as u32);
        }
        self.draw(number);
    }
}

/// Where a contact of the given stretch and threshold breaks next: the drive, or at rest the time from now. `passage` is the
/// drive at which it reaches its threshold.
#[inline]
fn next_break(
    thermal: Option<ThermalActivation>,
    contact: &mut ContactClock,
    (stretch, threshold): (f64, f64),
    (drive, passage): (f64, f64),
    velocity: f64,
) -> f64 {
    let moves = velocity > 0.0;
    if stretch >= threshold {
        return if moves { passage.min(drive) } else { 0.0 };
    }
    let Some(thermal) = thermal else { return if moves { passage } else { f64::INFINITY } };
    if !moves {
        return contact.left / thermal.rate(stretch, threshold);
    }
    let hazard = thermal.at(threshold, velocity);
    contact.before = hazard.value(stretch);
    let broken = hazard.stretch(contact.before + contact.left);
    (drive + (broken - stretch).max(0.0)).min(passage)
}

fn no_diffusion() -> Error {
    let expected = "thresholds that follow from the age of a contact where contacts are coupled one by one: ageing.frozen_rank or ageing.logarithmic";
    Error::invalid("ageing.smoluchowski", expected, "thresholds that diffuse")
}
