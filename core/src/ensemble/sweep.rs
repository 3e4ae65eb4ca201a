//! Contacts on their way, from break to break, and what they leave behind.

use std::ops::Range;

use super::lives::{Life, Lives};
use super::tally::{Cell, Grid};
use super::{Ensemble, Snapshots};

/// Breaks closer to a position than this, relatively, are at it: contacts that break together do so
/// where they should, whatever the rounding of sums of thresholds. Continuous laws do not notice.
pub(super) const TOGETHER: f64 = 1e-12;

/// What one chunk of contacts adds.
pub(super) struct Chunk<C> {
    pub(super) cells: Vec<C>,
    pub(super) histograms: Vec<Vec<u64>>,
    pub(super) breaks: u64,
}

impl<C: Cell> Chunk<C> {
    pub(super) fn merge(&mut self, other: &Self) {
        self.cells.iter_mut().zip(&other.cells).for_each(|(cell, more)| cell.merge(more));
        let counts = self.histograms.iter_mut().flatten();
        counts.zip(other.histograms.iter().flatten()).for_each(|(count, more)| *count += more);
        self.breaks += other.breaks;
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
pub(super) struct Sweep<'a> {
    pub(super) ensemble: &'a Ensemble,
    pub(super) grid: Grid<'a>,
    pub(super) positions: &'a [f64],
    pub(super) snapshots: &'a Snapshots,
}

impl Sweep<'_> {
    pub(super) fn nothing<C: Cell>(&self) -> Chunk<C> {
        let cells = vec![C::ZERO; self.positions.len()];
        Chunk { cells, histograms: self.snapshots.histograms(), breaks: 0 }
    }

    /// Adds contacts to a chunk, each of which is expected to break so many times.
    pub(super) fn add<C: Cell>(&self, contacts: Range<usize>, expected: usize, chunk: &mut Chunk<C>) {
        let mut lives = Lives::new(self.ensemble, expected);
        for index in contacts {
            let first = lives.first(index as u64);
            self.follow(first, &mut lives, chunk);
        }
    }

    /// One contact from X = 0 to the last position.
    fn follow<C: Cell>(&self, first: Life, lives: &mut Lives, chunk: &mut Chunk<C>) {
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
                self.snapshots.count(position - contact.origin, histogram);
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
}
