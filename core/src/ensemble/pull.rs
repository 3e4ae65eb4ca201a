//! The pull of an ensemble by a rigid slider, in parallel and yet the same bits on any number of threads.

use std::ops::Range;

use rayon::prelude::*;

use super::Ensemble;
use super::lives::{Life, Lives};
use super::tally::{Cell, Different, Equal, Grid, forces};
use crate::contacts::Stiffness;
use crate::monitor::{Monitor, report};
use crate::{Error, Result};

/// Breaks closer to a position than this, relatively, are at it: contacts that break together do so
/// where they should, whatever the rounding of sums of thresholds. Continuous laws do not notice.
const TOGETHER: f64 = 1e-12;

/// Most chunks of contacts between two reports to the monitor.
const ROUND: usize = 64;

/// Bytes that a round of chunks may take, if it is more than one chunk.
const ROUND_BYTES: usize = 512 << 20;

/// Bytes that one chunk may take.
const CHUNK_BYTES: usize = 4 << 30;

/// Where to record the distribution of stretches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Snapshots {
    /// Positions X, rising, none above the last position of the pull.
    pub positions: Vec<f64>,
    /// Edges of the bins of stretch, rising; a stretch at an edge counts below it, at the first above it.
    pub edges: Vec<f64>,
}

/// The outcome of a pull.
#[derive(Debug, Clone, PartialEq)]
pub struct EnsemblePull {
    /// Force at each position, scaled to the number of real contacts; after the breaks at the position.
    pub force: Vec<f64>,
    /// Its standard error, from the scatter of single contacts; NaN for an ensemble of one.
    ///
    /// That of the ensemble: N_c real contacts scatter by √(size/N_c) of it.
    pub error: Vec<f64>,
    /// Breaks up to the last position, those of a relaxed start included.
    pub breaks: u64,
    /// Contacts in each bin at each snapshot.
    pub histograms: Vec<Vec<u64>>,
    edges: Vec<f64>,
    size: usize,
}

impl EnsemblePull {
    /// Stretch density in each bin, per length, averaged over a range of snapshots.
    ///
    /// # Panics
    /// If the range reaches past the last snapshot.
    #[must_use]
    pub fn stretch_density(&self, snapshots: Range<usize>) -> Vec<f64> {
        let contacts = (self.size * snapshots.len()) as f64;
        let histograms = &self.histograms[snapshots];
        let density = |(bin, edges): (usize, &[f64])| {
            let count: u64 = histograms.iter().map(|h| h[bin]).sum();
            count as f64 / (contacts * (edges[1] - edges[0]))
        };
        self.edges.windows(2).enumerate().map(density).collect()
    }
}

impl Ensemble {
    /// Pulls the slider through `positions` X ≥ 0, rising, and takes `snapshots` on the way.
    ///
    /// # Errors
    /// Positions or edges that do not rise, or are not finite; a job too big; stopped by `monitor`.
    pub fn pull(
        &self,
        positions: &[f64],
        snapshots: &Snapshots,
        monitor: &mut dyn Monitor,
    ) -> Result<EnsemblePull> {
        rising("positions", positions)?;
        let last = *positions.last().ok_or_else(|| Error::invalid("positions", "at least one", "none"))?;
        rising("snapshots", &snapshots.positions)?;
        rising("edges", &snapshots.edges)?;
        if let Some(beyond) = snapshots.positions.last().filter(|&&x| x > last) {
            return Err(Error::invalid("snapshots", format!("positions up to {last}"), beyond));
        }
        match self.contacts.stiffness {
            Stiffness::Equal(stiffness) => self.run::<Equal>(stiffness, positions, snapshots, monitor),
            Stiffness::PerThreshold(factor) => self.run::<Different>(factor, positions, snapshots, monitor),
        }
    }

    fn run<C: Cell>(
        &self,
        stiffness: f64,
        positions: &[f64],
        snapshots: &Snapshots,
        monitor: &mut dyn Monitor,
    ) -> Result<EnsemblePull> {
        let sweep = Sweep { ensemble: self, grid: Grid::new(positions), positions, snapshots };
        let plan = sweep.plan::<C>()?;
        let mut total = sweep.nothing::<C>();
        let mut done = 0;
        while done < self.size {
            let end = self.size.min(done.saturating_add(plan.chunk * plan.round));
            let starts: Vec<usize> = (done..end).step_by(plan.chunk).collect();
            let chunk = |&start: &usize| sweep.chunk::<C>(start..end.min(start + plan.chunk), plan.expected);
            // Summed in the order of contacts, whichever thread was first.
            let chunks: Vec<Chunk<C>> = starts.par_iter().map(chunk).collect();
            chunks.iter().for_each(|chunk| total.merge(chunk));
            done = end;
            report(monitor, done as f64 / self.size as f64)?;
        }
        Ok(total.finish(self, stiffness, positions, snapshots))
    }

    /// Rough number of breaks of a contact on the way to `distance`, by which the work is cut up.
    fn expected_breaks(&self, distance: f64) -> f64 {
        let mean = self.contacts.thresholds.mean();
        let rise = (mean - self.contacts.reforming.mean()).max(0.1 * mean);
        1.0 + distance / rise
    }
}

/// How the work is cut up: nothing of it depends on the machine or on threads.
struct Plan {
    /// Contacts in a chunk.
    chunk: usize,
    /// Chunks in a round.
    round: usize,
    /// Draws that a contact is expected to need.
    expected: usize,
}

/// What one chunk of contacts adds.
struct Chunk<C> {
    cells: Vec<C>,
    histograms: Vec<Vec<u64>>,
    breaks: u64,
}

impl<C: Cell> Chunk<C> {
    fn merge(&mut self, other: &Self) {
        self.cells.iter_mut().zip(&other.cells).for_each(|(cell, more)| cell.merge(more));
        let counts = self.histograms.iter_mut().flatten();
        counts.zip(other.histograms.iter().flatten()).for_each(|(count, more)| *count += more);
        self.breaks += other.breaks;
    }

    fn finish(
        self,
        ensemble: &Ensemble,
        stiffness: f64,
        positions: &[f64],
        snapshots: &Snapshots,
    ) -> EnsemblePull {
        let scale = stiffness * ensemble.contacts.count;
        let (mut force, mut error) = forces(&self.cells, positions, ensemble.size);
        force.iter_mut().chain(&mut error).for_each(|f| *f *= scale);
        let Self { histograms, breaks, .. } = self;
        EnsemblePull { force, error, breaks, histograms, edges: snapshots.edges.clone(), size: ensemble.size }
    }
}

/// A contact between two breaks: its stretch is X − `origin`.
#[derive(Clone, Copy)]
struct Contact {
    origin: f64,
    threshold: f64,
}

impl Contact {
    /// Where it breaks, less the rounding of sums.
    #[inline]
    fn end(&self) -> f64 {
        (self.origin + self.threshold) * (1.0 - TOGETHER)
    }
}

/// A pull, seen by its contacts.
struct Sweep<'a> {
    ensemble: &'a Ensemble,
    grid: Grid<'a>,
    positions: &'a [f64],
    snapshots: &'a Snapshots,
}

impl Sweep<'_> {
    fn nothing<C: Cell>(&self) -> Chunk<C> {
        let bins = self.snapshots.edges.len().saturating_sub(1);
        Chunk {
            cells: vec![C::ZERO; self.positions.len()],
            histograms: vec![vec![0; bins]; self.snapshots.positions.len()],
            breaks: 0,
        }
    }

    /// Chunks with so many breaks that merging them costs little, so few that there is one for each core.
    fn plan<C: Cell>(&self) -> Result<Plan> {
        let bins = self.snapshots.edges.len() * self.snapshots.positions.len();
        let bytes = self.positions.len() * size_of::<C>() + bins * size_of::<u64>();
        if bytes > CHUNK_BYTES {
            let what = format!("an ensemble at {} positions", self.positions.len());
            return Err(Error::TooLarge { what, needed: bytes as u64, allowed: CHUNK_BYTES as u64 });
        }
        let expected = self.ensemble.expected_breaks(self.positions[self.positions.len() - 1]);
        let least = (bytes as f64).max(20_000.0);
        let breaks = (expected * self.ensemble.size as f64 / ROUND as f64).clamp(least, least.max(1e6));
        let chunk = (breaks / expected).ceil() as usize;
        let round = (ROUND_BYTES / bytes).clamp(1, ROUND);
        Ok(Plan { chunk, round, expected: expected as usize })
    }

    fn chunk<C: Cell>(&self, contacts: Range<usize>, expected: usize) -> Chunk<C> {
        let mut chunk = self.nothing();
        let mut lives = Lives::new(self.ensemble, expected);
        for index in contacts {
            let first = lives.first(index as u64);
            self.follow(first, &mut lives, &mut chunk);
        }
        chunk
    }

    /// One contact from X = 0 to the last position.
    fn follow<C: Cell>(&self, first: Life, lives: &mut Lives<'_>, chunk: &mut Chunk<C>) {
        let last = self.positions[self.positions.len() - 1];
        let mut life = first;
        // Only a relaxed start has contacts at or above their thresholds: they break where they are.
        if life.stretch >= life.threshold {
            chunk.breaks += 1;
            life = lives.next();
        }
        let mut contact = Contact { origin: -life.stretch, threshold: life.threshold };
        chunk.cells[0].add(self.positions[0] - contact.origin, contact.threshold);
        let mut snapshots = self.snapshots.positions.iter().zip(&mut chunk.histograms).peekable();
        loop {
            let until = snapshots.peek().map_or(last, |(position, _)| **position);
            let taken;
            (contact, taken) = self.rush(contact, until, lives.plain(), &mut chunk.cells);
            lives.skip(taken);
            chunk.breaks += taken as u64;
            let end = contact.end();
            while let Some((position, histogram)) = snapshots.next_if(|(position, _)| **position < end) {
                self.record(position - contact.origin, histogram);
            }
            if end > last {
                return;
            }
            contact = self.strike(contact, lives.next(), &mut chunk.cells);
            chunk.breaks += 1;
        }
    }

    /// As many of the `coming` lives as begin by `until`; how many they were. The contact stays in
    /// registers, which is what makes this loop worth having.
    #[inline(never)]
    fn rush<C: Cell>(
        &self,
        mut contact: Contact,
        until: f64,
        coming: (&[f64], f64),
        cells: &mut [C],
    ) -> (Contact, usize) {
        let (thresholds, stretch) = coming;
        for (taken, &threshold) in thresholds.iter().enumerate() {
            if contact.end() > until || threshold <= stretch {
                return (contact, taken);
            }
            contact = self.strike(contact, Life { stretch, threshold }, cells);
        }
        (contact, thresholds.len())
    }

    /// One break, and the life after it.
    #[inline(always)]
    fn strike<C: Cell>(&self, contact: Contact, next: Life, cells: &mut [C]) -> Contact {
        let (cell, position) = self.grid.at_or_above(contact.end());
        let origin = contact.origin + (contact.threshold - next.stretch);
        let (before, after) = (position - contact.origin, position - origin);
        cells[cell].replace((before, contact.threshold), (after, next.threshold));
        Contact { origin, threshold: next.threshold }
    }

    fn record(&self, stretch: f64, histogram: &mut [u64]) {
        let edges = &self.snapshots.edges;
        // Just re-formed contacts may lie below 0 by rounding.
        let stretch = stretch.max(0.0);
        let above = edges.partition_point(|&edge| edge < stretch);
        if let Some(bin) = histogram.get_mut(above.max(1) - 1)
            && stretch >= edges[0]
        {
            *bin += 1;
        }
    }
}

/// Whether values are finite, not negative and never fall.
fn rising(key: &str, values: &[f64]) -> Result<()> {
    let expected = "finite values that rise from 0 or above";
    if let Some(bad) = values.iter().find(|x| !x.is_finite() || **x < 0.0) {
        return Err(Error::invalid(key, expected, bad));
    }
    match values.windows(2).find(|pair| pair[0] > pair[1]) {
        Some(pair) => Err(Error::invalid(key, expected, format!("{} before {}", pair[0], pair[1]))),
        None => Ok(()),
    }
}
