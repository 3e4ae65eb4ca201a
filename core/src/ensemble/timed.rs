//! An ensemble followed in time, one contact after another, in parallel and yet the same bits on any number of threads.

use std::ops::Range;

use rayon::prelude::*;

use super::Ensemble;
use super::lives::{Life, Lives};
use super::passage::{Held, Passage};
use super::pull::rising;
use super::sweep::TOGETHER;

use crate::contacts::Stiffness;
use crate::history::History;
use crate::monitor::{Monitor, report};
use crate::random::{Purpose, Stream};
use crate::{Error, Result};

/// Chunks into which a large ensemble is cut, and the fewest contacts in one: nothing of it depends on the machine.
const CHUNKS: usize = 256;
const FEWEST: usize = 16;

/// Draws made ahead for a contact.
const AHEAD: usize = 8;

/// The outcome of following an ensemble in time; a breaking contact counts as broken at the time at which it breaks.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsembleTrace {
    /// The times t.
    pub time: Vec<f64>,
    /// Position X of the slider.
    pub position: Vec<f64>,
    /// Force, scaled to the number of real contacts.
    pub force: Vec<f64>,
    /// Its standard error, from the scatter of single contacts; not finite for an ensemble of one.
    pub error: Vec<f64>,
    /// Fraction of the contacts that are broken and have not yet re-formed.
    pub free: Vec<f64>,
    /// Breaks up to the last time, those of a relaxed start included.
    pub breaks: u64,
}

impl Ensemble {
    /// Follows the contacts under a slider that moves as `history` says, and tells of them at `times`, which rise from 0 or
    /// above and do not go beyond its end.
    ///
    /// A contact breaks when its stretch meets its present threshold, or when heat breaks it before; it is then free for the
    /// delay, and re-forms at age 0.
    ///
    /// # Errors
    /// Times that do not rise, or lie outside the history; ageing by a rule that single contacts cannot follow; stopped by
    /// `monitor`.
    pub fn follow(
        &self,
        history: &History,
        times: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<EnsembleTrace> {
        rising("times", times)?;
        let last = *times.last().ok_or_else(|| Error::invalid("times", "at least one", "none"))?;
        if last > history.duration() {
            let expected = format!("times up to the end of the protocol at {}", history.duration());
            return Err(Error::invalid("times", expected, last));
        }
        let positions = times.iter().map(|&time| history.position(time)).collect();
        let follow = Follow { ensemble: self, passage: Passage::of(self)?, history, times, positions, last };
        let mut total = follow.nothing();
        let size = self.size.div_ceil(CHUNKS).max(FEWEST);
        let starts: Vec<usize> = (0..self.size).step_by(size).collect();
        for round in starts.chunks(rayon::current_num_threads()) {
            let end = |start: usize| self.size.min(start + size);
            // Summed in the order of contacts, whichever thread was first.
            let chunks: Vec<Chunk> = round.par_iter().map(|&start| follow.chunk(start..end(start))).collect();
            chunks.iter().for_each(|chunk| total.merge(chunk));
            report(monitor, end(round[round.len() - 1]) as f64 / self.size as f64)?;
        }
        Ok(follow.trace(total))
    }
}

/// Sums over contacts at one time.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    force: f64,
    square: f64,
    free: f64,
}

/// What one chunk of contacts adds.
struct Chunk {
    sums: Vec<Sums>,
    breaks: u64,
}

impl Chunk {
    fn merge(&mut self, other: &Self) {
        for (sums, more) in self.sums.iter_mut().zip(&other.sums) {
            sums.force += more.force;
            sums.square += more.square;
            sums.free += more.free;
        }
        self.breaks += other.breaks;
    }
}

/// The random streams of a contact beside those of its lives.
struct Draws {
    breaking: Stream,
    diffusion: Stream,
}

/// A history, seen by its contacts.
struct Follow<'a> {
    ensemble: &'a Ensemble,
    passage: Passage,
    history: &'a History,
    times: &'a [f64],
    positions: Vec<f64>,
    last: f64,
}

impl Follow<'_> {
    fn nothing(&self) -> Chunk {
        Chunk { sums: vec![Sums::default(); self.times.len()], breaks: 0 }
    }

    fn chunk(&self, contacts: Range<usize>) -> Chunk {
        let mut chunk = self.nothing();
        let mut lives = Lives::new(self.ensemble, AHEAD);
        for index in contacts {
            self.contact(index as u64, &mut lives, &mut chunk);
        }
        chunk
    }

    /// One contact from t = 0 to the last time.
    fn contact(&self, index: u64, lives: &mut Lives, chunk: &mut Chunk) {
        let draws = |purpose| Stream::new(self.ensemble.seed, purpose, index);
        let mut draws = Draws { breaking: draws(Purpose::Breaking), diffusion: draws(Purpose::Diffusion) };
        let (mut life, mut birth, mut next) = (lives.first(index), 0.0, 0);
        // Only a relaxed start has contacts at or above their thresholds: they break where they are.
        if life.stretch >= life.threshold {
            (birth, next) = self.wait(0.0, 0, chunk);
            life = lives.next();
        }
        while next < self.times.len() {
            let end;
            (end, next) = self.hold(birth, life, next, &mut draws, &mut chunk.sums);
            if end > self.last {
                return;
            }
            (birth, next) = self.wait(end, next, chunk);
            life = lives.next();
        }
    }

    /// A broken contact: when it re-forms, and the next time to tell of.
    fn wait(&self, broken: f64, mut next: usize, chunk: &mut Chunk) -> (f64, usize) {
        chunk.breaks += 1;
        let birth = broken + self.ensemble.contacts.rules.delay;
        while self.times.get(next).is_some_and(|time| *time < birth * (1.0 - TOGETHER)) {
            chunk.sums[next].free += 1.0;
            next += 1;
        }
        (birth, next)
    }

    /// A contact that holds: when it breaks, and the next time to tell of.
    fn hold(
        &self,
        birth: f64,
        life: Life,
        mut next: usize,
        draws: &mut Draws,
        sums: &mut [Sums],
    ) -> (f64, usize) {
        let held =
            Held { birth, origin: self.history.position(birth) - life.stretch, newborn: life.threshold };
        let endurance = match self.ensemble.contacts.rules.temperature {
            Some(_) => -draws.breaking.uniform().ln(),
            None => f64::INFINITY,
        };
        // Stiffnesses, in the unit of `Stiffness`, matter where they differ.
        let differ = matches!(self.ensemble.contacts.stiffness, Stiffness::PerThreshold(_));
        let mut diffused = Vec::new();
        let end = match &self.passage {
            Passage::Known(known) => known.end(&held, self.history, self.last, endurance),
            Passage::Diffusing(diffusion) => {
                let marks = if differ { &self.times[next..] } else { &[] };
                let until = self.last;
                let stream = &mut draws.diffusion;
                diffusion.end(&held, self.history, until, endurance, stream, marks, |h| diffused.push(h))
            }
        };
        let first = next;
        while self.times.get(next).is_some_and(|time| *time < end * (1.0 - TOGETHER)) {
            let stiffness = match &self.passage {
                _ if !differ => 1.0,
                Passage::Known(known) => known.threshold(&held, self.times[next]),
                Passage::Diffusing(_) => diffused[next - first],
            };
            let force = stiffness * (self.positions[next] - held.origin);
            sums[next].force += force;
            sums[next].square += force * force;
            next += 1;
        }
        (end, next)
    }

    fn trace(self, total: Chunk) -> EnsembleTrace {
        let contacts = &self.ensemble.contacts;
        let (Stiffness::Equal(unit) | Stiffness::PerThreshold(unit)) = contacts.stiffness;
        let (scale, size) = (unit * contacts.count, self.ensemble.size as f64);
        let mean = |sums: &Sums| scale * sums.force / size;
        let error = |sums: &Sums| {
            let variance = sums.square / size - (sums.force / size).powi(2);
            scale * (variance.max(0.0) / (size - 1.0)).sqrt()
        };
        EnsembleTrace {
            time: self.times.to_vec(),
            force: total.sums.iter().map(mean).collect(),
            error: total.sums.iter().map(error).collect(),
            free: total.sums.iter().map(|sums| sums.free / size).collect(),
            position: self.positions,
            breaks: total.breaks,
        }
    }
}
