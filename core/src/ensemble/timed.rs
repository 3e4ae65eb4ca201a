//! An ensemble followed in time, one contact after another, in parallel, with the same bits on any number of
//! threads.

use std::ops::Range;

use super::Ensemble;
use super::attached::AttachedContact;
use super::contact::TOGETHER;
use super::lives::{ContactLife, Lives};
use super::passage::Passage;
use super::pull::EnsemblePull;
use super::snapshots::{Snapshots, rising};
use crate::contacts::{Contacts, Rules};
use crate::error::positive;
use crate::history::{History, LoadStep, LoadedHistory, Piece};
use crate::monitor::{Aside, Monitor, Watch, fits, report};
use crate::numerics::order::sort_by_number;
use crate::random::{Purpose, Stream};
use crate::{Error, Result};

/// Number of chunks of a large ensemble, and the smallest number of contacts in one; independent of the
/// machine.
const CHUNKS: usize = 256;
const FEWEST: usize = 16;

/// Contacts, and breaks, between two checks whether the monitor has stopped.
const PER_CHECK: usize = 16;

/// Values drawn ahead for a contact.
const AHEAD: usize = 8;

/// Results of an ensemble followed in time; contacts that break at a given time have broken.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct EnsembleTrace {
    /// The times t.
    pub time: Vec<f64>,
    /// Position X of the slider.
    pub position: Vec<f64>,
    /// Force, scaled to the number of real contacts.
    pub force: Vec<f64>,
    /// Its standard error, from the variance over contacts; not finite for an ensemble of one.
    pub error: Vec<f64>,
    /// Fraction of free contacts.
    pub free: Vec<f64>,
    /// Normal load relative to that at the start. Where it steps there are two results at one time, before and after the step.
    pub relative_normal_load: Vec<f64>,
    /// Breaks up to the last time, those of a relaxed start included.
    pub breaks: u64,
}

impl Ensemble {
    /// Follows the contacts under a slider that moves as in `history`, with results at `times`, which rise
    /// from 0 or above and do not exceed its end.
    ///
    /// A contact breaks when its stretch reaches its present threshold, or thermally before; it is then free
    /// for the delay, and re-forms at age 0.
    ///
    /// # Errors
    /// Times that do not rise, or lie outside the history; ageing by a rule that single contacts cannot
    /// follow.
    pub fn follow(&self, history: &History, times: &[f64]) -> Result<EnsembleTrace> {
        self.follow_with(history, times, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::follow`]; stopped by the monitor.
    pub fn follow_with(
        &self,
        history: &History,
        times: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<EnsembleTrace> {
        check_times(history, times)?;
        let nothing = Snapshots::default();
        let follow = Follow::new(self, history, times, (&nothing, &[]), monitor)?;
        let total = follow.run(monitor)?;
        Ok(follow.trace(&total))
    }

    /// The same under a normal load that steps. The number of contacts is proportional to the load. Where the load rises by a factor
    /// f, each contact, attached or free, is replaced with the probability 1 − 1/f by one that has just formed. Where it falls
    /// contacts are lost at random: those that are simulated stand for fewer. At a time at which the load steps there are two results,
    /// before and after the step. Breaks are those of the contacts that are simulated, up to the last of the times before each is
    /// replaced.
    ///
    /// # Errors
    /// As [`Self::follow`]; stopped by the monitor.
    pub fn follow_under_load(
        &self,
        motion: &LoadedHistory,
        times: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<EnsembleTrace> {
        check_times(motion.history(), times)?;
        let nothing = Snapshots::default();
        let (times, loads): (Vec<f64>, Vec<f64>) = motion.readings(times).into_iter().unzip();
        let follow = Follow::new(self, motion.history(), &times, (&nothing, &[]), monitor)?;
        let follow = follow.under(motion, loads);
        let total = follow.run(monitor)?;
        Ok(follow.trace(&total))
    }

    /// The pull of [`Ensemble::pull`] at a velocity, for time-dependent contacts.
    ///
    /// # Errors
    /// A velocity that is not a finite number above 0; positions or edges that do not rise, or are not finite; ageing by a
    /// rule that single contacts cannot follow.
    pub fn pull_at(&self, velocity: f64, positions: &[f64]) -> Result<EnsemblePull> {
        self.pull_at_with(velocity, positions, &Snapshots::default(), &mut ())
    }

    /// The same with `snapshots` on the way, watched by a monitor.
    ///
    /// # Errors
    /// As [`Self::pull_at`]; stopped by the monitor.
    pub fn pull_at_with(
        &self,
        velocity: f64,
        positions: &[f64],
        snapshots: &Snapshots,
        monitor: &mut dyn Monitor,
    ) -> Result<EnsemblePull> {
        positive("velocity", velocity)?;
        let last = snapshots.check(positions)?;
        let duration = if last > 0.0 { last / velocity } else { 1.0 };
        let history = History::new(vec![Piece { velocity, duration }])?;
        let times = |positions: &[f64]| positions.iter().map(|x| x / velocity).collect::<Vec<_>>();
        let shots = times(&snapshots.positions);
        let follow = Follow::new(self, &history, &times(positions), (snapshots, &shots), monitor)?;
        let total = follow.run(monitor)?;
        let (force, error) = follow.forces(&total);
        let TimedChunk { histograms, breaks, .. } = total;
        Ok(EnsemblePull { force, error, breaks, histograms, edges: snapshots.edges.clone(), size: self.size })
    }
}

/// Refuses times that do not rise, and those outside a history.
fn check_times(history: &History, times: &[f64]) -> Result<()> {
    rising("times", times)?;
    let last = *times.last().ok_or_else(|| Error::invalid("times", "at least one", "none"))?;
    if last > history.duration() {
        let expected = format!("times up to the end of the history at {}", history.duration());
        return Err(Error::invalid("times", expected, last));
    }
    Ok(())
}

/// A rise of the normal load, at which contacts form.
#[derive(Debug, Clone, Copy)]
struct Rise {
    time: f64,
    /// The first mark after it.
    mark: usize,
    /// The fraction of contacts that have just formed after it.
    fresh: f64,
}

/// A time at which contacts are observed.
#[derive(Debug, Clone, Copy)]
struct ObservationTime {
    time: f64,
    position: f64,
    observed: Observation,
}

/// What is observed of a contact, and the index of the result.
#[derive(Debug, Clone, Copy)]
enum Observation {
    Force(usize),
    Stretch(usize),
}

/// Sums over contacts at one time.
#[derive(Debug, Clone, Copy, Default)]
struct TimedSums {
    force: f64,
    square: f64,
    free: f64,
}

/// Contribution of one chunk of contacts.
struct TimedChunk {
    sums: Vec<TimedSums>,
    histograms: Vec<Vec<u64>>,
    breaks: u64,
}

impl TimedChunk {
    fn merge(&mut self, other: &Self) {
        for (sums, more) in self.sums.iter_mut().zip(&other.sums) {
            sums.force += more.force;
            sums.square += more.square;
            sums.free += more.free;
        }
        let counts = self.histograms.iter_mut().flatten();
        counts.zip(other.histograms.iter().flatten()).for_each(|(count, more)| *count += more);
        self.breaks += other.breaks;
    }
}

/// The random streams of a contact beside those of its lives.
struct TimedDraws {
    breaking: Stream,
    diffusion: Stream,
    free: Stream,
}

/// A history, as seen by its contacts.
struct Follow<'a> {
    ensemble: &'a Ensemble,
    passage: Passage,
    history: &'a History,
    snapshots: &'a Snapshots,
    marks: Vec<ObservationTime>,
    /// Their times.
    times: Vec<f64>,
    /// The normal load at each result, relative to that at the start; empty where it is constant.
    loads: Vec<f64>,
    rises: Vec<Rise>,
}

impl<'a> Follow<'a> {
    /// Forces at `times`, the stretches of `snapshots` at the times `shots`.
    fn new(
        ensemble: &'a Ensemble,
        history: &'a History,
        times: &[f64],
        (snapshots, shots): (&'a Snapshots, &[f64]),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let mark = |time, observed| ObservationTime { time, position: history.position(time), observed };
        let forces = times.iter().enumerate().map(|(i, &time)| mark(time, Observation::Force(i)));
        let stretches = shots.iter().enumerate().map(|(i, &time)| mark(time, Observation::Stretch(i)));
        let mut marks: Vec<ObservationTime> = forces.chain(stretches).collect();
        sort_by_number(&mut marks, |item| item.time);
        let times = marks.iter().map(|mark| mark.time).collect();
        let passage = Passage::of(ensemble, monitor)?;
        let (loads, rises) = (Vec::new(), Vec::new());
        Ok(Self { ensemble, passage, history, snapshots, marks, times, loads, rises })
    }

    /// The same with the loads at the results, of which there are two at a time at which the load steps.
    fn under(self, motion: &LoadedHistory, loads: Vec<f64>) -> Self {
        let rise = |step: LoadStep| {
            let first = self.times.partition_point(|time| *time < step.time);
            // If there are two, the first one is before the step.
            let is_read = self.times.get(first) == Some(&step.time);
            Rise {
                time: step.time,
                mark: first + usize::from(is_read),
                fresh: 1.0 - step.before / step.after,
            }
        };
        let rises = motion.steps().filter(|step| step.after > step.before).map(rise).collect();
        Self { loads, rises, ..self }
    }

    fn run(&self, monitor: &mut dyn Monitor) -> Result<TimedChunk> {
        self.fits(monitor.memory())?;
        let all = self.ensemble.size;
        let mut total = self.nothing();
        let size = all.div_ceil(CHUNKS).max(FEWEST);
        let starts: Vec<usize> = (0..all).step_by(size).collect();
        // The number of threads decides on the rounds only, not on the chunks, so that it changes
        // no sum.
        for round in starts.chunks(crate::parallel::current_num_threads()) {
            let mut aside = Aside { fraction: round[0] as f64 / all as f64, monitor };
            let watch = Watch::new(&mut aside);
            let chunk = |(): &mut (), number: usize| {
                let start = round[number];
                self.chunk(start..all.min(start + size), &watch)
            };
            // Summed in the order of contacts, for any number of threads.
            let chunks = watch.share(round.len(), || (), chunk)?;
            watch.check()?;
            chunks.iter().for_each(|chunk| total.merge(chunk));
            report(monitor, all.min(round[round.len() - 1] + size) as f64 / all as f64)?;
        }
        Ok(total)
    }

    /// Refuses sums of all threads that take more than `memory` bytes.
    fn fits(&self, memory: u64) -> Result<()> {
        let Snapshots { positions, edges, .. } = self.snapshots;
        let (times, threads) = (self.marks.len() - positions.len(), crate::parallel::current_num_threads());
        let bytes = times * size_of::<TimedSums>() + edges.len() * positions.len() * size_of::<u64>();
        // Each thread, and the total.
        let needed = (bytes as u64).saturating_mul(threads as u64 + 1);
        fits("times", format!("an ensemble at {times} times on {threads} threads"), needed, memory)
    }

    fn nothing(&self) -> TimedChunk {
        let forces = self.marks.len() - self.snapshots.positions.len();
        TimedChunk {
            sums: vec![TimedSums::default(); forces],
            histograms: self.snapshots.histograms(),
            breaks: 0,
        }
    }

    /// Some contacts, or fewer once the monitor has stopped it.
    fn chunk(&self, contacts: Range<usize>, watch: &Watch<'_>) -> TimedChunk {
        let mut chunk = self.nothing();
        let mut lives = Lives::new(self.ensemble, AHEAD);
        for index in contacts {
            if index.is_multiple_of(PER_CHECK) && watch.stops() {
                break;
            }
            self.contact(index as u64, &mut lives, &mut chunk, watch);
        }
        chunk
    }

    /// One contact from t = 0 to the last mark, and those that replace it as the load rises, unless the monitor asks to stop.
    fn contact(&self, index: u64, lives: &mut Lives, chunk: &mut TimedChunk, watch: &Watch<'_>) {
        let draws = |purpose| Stream::new(self.ensemble.seed, purpose, lives.number(index));
        let mut draws = TimedDraws {
            breaking: draws(Purpose::Breaking),
            diffusion: draws(Purpose::Diffusion),
            free: draws(Purpose::FreeTimes),
        };
        let mut replaced = Stream::new(self.ensemble.seed, Purpose::Replacement, lives.number(index));
        let mut rises = self.rises.iter().filter(|rise| replaced.uniform() < rise.fresh);
        let mut rise = rises.next();
        let end = |rise: Option<&Rise>| rise.map_or(self.marks.len(), |rise| rise.mark);
        let (mut life, mut birth, mut next) = (lives.first(index), 0.0, 0..end(rise));
        // Only a relaxed start has contacts at or above their thresholds: they break where they are.
        if life.stretch >= life.threshold {
            (birth, next.start) = self.wait(0.0, next.clone(), &mut draws, chunk);
            life = lives.next();
        }
        while self.renewing((birth, life), next, lives, &mut draws, chunk, watch)
            && let Some(now) = rise
        {
            rise = rises.next();
            (life, birth, next) = (lives.next(), now.time, now.mark..end(rise));
        }
    }

    /// One contact and its re-formations over the marks `next`; returns whether the monitor lets it go on.
    fn renewing(
        &self,
        (mut birth, mut life): (f64, ContactLife),
        mut next: Range<usize>,
        lives: &mut Lives,
        draws: &mut TimedDraws,
        chunk: &mut TimedChunk,
        watch: &Watch<'_>,
    ) -> bool {
        // Alternating renewal process: attached until the break, free for the delay.
        while !next.is_empty() {
            let end;
            (end, next.start) = self.hold(birth, life, next.clone(), draws, chunk, watch);
            if next.is_empty() {
                break;
            }
            if chunk.breaks.is_multiple_of(PER_CHECK as u64) && watch.stops() {
                return false;
            }
            (birth, next.start) = self.wait(end, next.clone(), draws, chunk);
            life = lives.next();
        }
        true
    }

    /// Those of the marks `next` that are before an event, up to rounding.
    fn before(&self, event: f64, next: Range<usize>) -> Range<usize> {
        let reached = |time: &&f64| **time < event * (1.0 - TOGETHER);
        next.start..next.start + self.times[next].iter().take_while(reached).count()
    }

    /// A free contact, observed at the marks `next`: returns when it re-forms, and the next mark.
    fn wait(
        &self,
        broken: f64,
        next: Range<usize>,
        draws: &mut TimedDraws,
        chunk: &mut TimedChunk,
    ) -> (f64, usize) {
        chunk.breaks += 1;
        let Rules { ref delay, free_friction, .. } = self.ensemble.contacts.rules;
        let unit = self.ensemble.contacts.stiffness.unit();
        let birth = broken + delay.draw(&mut draws.free);
        let passed = self.before(birth, next);
        for mark in &self.marks[passed.clone()] {
            if let Observation::Force(i) = mark.observed {
                chunk.sums[i].free += 1.0;
                if !free_friction.is_none() {
                    let velocity = self.history.pieces()[self.history.piece_at(mark.time)].velocity;
                    chunk.sums[i].add(free_friction.at(velocity) / unit);
                }
            }
        }
        (birth, passed.end)
    }

    /// An attached contact, observed at the marks `next`: returns when it breaks, and the next mark.
    fn hold(
        &self,
        birth: f64,
        life: ContactLife,
        next: Range<usize>,
        draws: &mut TimedDraws,
        chunk: &mut TimedChunk,
        watch: &Watch<'_>,
    ) -> (f64, usize) {
        let Contacts { stiffness, rules, .. } = &self.ensemble.contacts;
        let held = AttachedContact {
            birth,
            origin: self.history.position(birth) - life.stretch,
            fresh: life.threshold,
        };
        // Inversion: the cumulative hazard at which a contact breaks is exponentially distributed,
        // whatever its history.
        let remaining_hazard = match rules.temperature {
            Some(_) => draws.breaking.exponential(),
            None => f64::INFINITY,
        };
        let marks = &self.times[next.clone()];
        let mut thresholds = Vec::new();
        let end = match &self.passage {
            Passage::KnownThreshold(known) => known.end(&held, self.history, marks, remaining_hazard),
            Passage::Diffusing(diffusion) => {
                let drawn = (remaining_hazard, &mut draws.diffusion);
                diffusion.end(&held, self.history, marks, drawn, &mut thresholds, watch)
            }
        };
        let passed = self.before(end, next);
        for (place, mark) in self.marks[passed.clone()].iter().enumerate() {
            let stretch = mark.position - held.origin;
            match (mark.observed, stiffness.is_equal()) {
                (Observation::Stretch(i), _) => self.snapshots.count(stretch, &mut chunk.histograms[i]),
                (Observation::Force(i), true) => chunk.sums[i].add(stretch),
                (Observation::Force(i), false) => {
                    let threshold = match &self.passage {
                        Passage::KnownThreshold(known) => known.threshold(&held, mark.time),
                        Passage::Diffusing(_) => thresholds[place],
                    };
                    chunk.sums[i].add(stiffness.weight(threshold) * stretch);
                }
            }
        }
        (end, passed.end)
    }

    /// The results at all times.
    fn trace(&self, total: &TimedChunk) -> EnsembleTrace {
        let (mut force, mut error) = self.forces(total);
        let loads = match self.loads.is_empty() {
            true => vec![1.0; self.times.len()],
            false => self.loads.clone(),
        };
        // The contacts that are simulated stand for more or fewer.
        for values in [&mut force, &mut error] {
            values.iter_mut().zip(&loads).for_each(|(value, load)| *value *= load);
        }
        let size = self.ensemble.size as f64;
        EnsembleTrace {
            time: self.times.clone(),
            position: self.marks.iter().map(|mark| mark.position).collect(),
            force,
            error,
            free: total.sums.iter().map(|sums| sums.free / size).collect(),
            relative_normal_load: loads,
            breaks: total.breaks,
        }
    }

    /// Mean forces and their standard errors.
    fn forces(&self, total: &TimedChunk) -> (Vec<f64>, Vec<f64>) {
        let contacts = &self.ensemble.contacts;
        let (scale, size) = (contacts.stiffness.unit() * contacts.count, self.ensemble.size as f64);
        let force = |sums: &TimedSums| {
            let mean = sums.force / size;
            let variance = (sums.square / size - mean * mean).max(0.0);
            (scale * mean, scale * (variance / (size - 1.0)).sqrt())
        };
        total.sums.iter().map(force).unzip()
    }
}

impl TimedSums {
    /// Adds the force of a contact, in the unit of its stiffness.
    fn add(&mut self, force: f64) {
        self.force += force;
        self.square += force * force;
    }
}
