//! Contacts on their way, from break to break, and what they leave behind.

use std::ops::Range;

use super::break_batch::BreakBatch;
use super::lives::{ContactLife, Lives};
use super::tally::{HistogramGrid, Ruler, TallyCell};
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

impl<C: TallyCell> Chunk<C> {
    pub(super) fn merge(&mut self, other: &Self) {
        self.cells.iter_mut().zip(&other.cells).for_each(|(cell, more)| cell.merge(more));
        let counts = self.histograms.iter_mut().flatten();
        counts.zip(other.histograms.iter().flatten()).for_each(|(count, more)| *count += more);
        self.breaks += other.breaks;
    }
}

/// A contact between two breaks: its stretch is X − `origin`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    pub(super) origin: f64,
    pub(super) threshold: f64,
}

impl Contact {
    /// Where it breaks, less the rounding of sums.
    #[inline(always)]
    pub(super) fn end(&self) -> f64 {
        (self.origin + self.threshold) * (1.0 - TOGETHER)
    }

    /// Its stretch, and what its stiffness goes with.
    #[inline(always)]
    pub(super) fn at(&self, position: f64) -> (f64, f64) {
        (position - self.origin, self.threshold)
    }
}

/// A pull, seen by its contacts.
pub(super) struct Sweep<'a> {
    pub(super) ensemble: &'a Ensemble,
    pub(super) grid: HistogramGrid<'a>,
    pub(super) ruler: Option<Ruler>,
    pub(super) positions: &'a [f64],
    pub(super) snapshots: &'a Snapshots,
}

impl Sweep<'_> {
    pub(super) fn nothing<C: TallyCell>(&self) -> Chunk<C> {
        let cells = vec![C::ZERO; self.positions.len()];
        Chunk { cells, histograms: self.snapshots.histograms(), breaks: 0 }
    }

    /// Adds contacts to a chunk, each of which is expected to break so many times.
    pub(super) fn add<C: TallyCell>(&self, contacts: Range<usize>, expected: usize, chunk: &mut Chunk<C>) {
        let mut lives = Lives::new(self.ensemble, expected);
        let mut volley = BreakBatch::new();
        for index in contacts {
            let first = lives.first(index as u64);
            self.follow(first, &mut lives, &mut volley, chunk);
        }
    }

    /// One contact from X = 0 to the last position.
    fn follow<C: TallyCell>(
        &self,
        first: ContactLife,
        lives: &mut Lives,
        volley: &mut BreakBatch<C>,
        chunk: &mut Chunk<C>,
    ) {
        let last = self.positions[self.positions.len() - 1];
        let mut life = first;
        // Only a relaxed start has contacts at or above their thresholds: they break where they are.
        if life.stretch >= life.threshold {
            chunk.breaks += 1;
            life = lives.next();
        }
        let mut contact = Contact { origin: -life.stretch, threshold: life.threshold };
        chunk.cells[0].add(self.positions[0] - contact.origin, contact.threshold);
        let Chunk { cells, histograms, breaks } = chunk;
        let mut snapshots = self.snapshots.positions.iter().zip(histograms).peekable();
        loop {
            let until = snapshots.peek().map_or(last, |(position, _)| **position);
            contact = self.rush(contact, until, lives, volley, cells, breaks);
            let end = contact.end();
            while let Some((position, histogram)) = snapshots.next_if(|(position, _)| **position < end) {
                self.snapshots.count(position - contact.origin, histogram);
            }
            if end > last {
                return;
            }
            contact = self.strike(contact, lives.next(), cells);
            *breaks += 1;
        }
    }

    /// As many breaks by `until` as there are lives drawn ahead.
    #[inline(never)]
    fn rush<C: TallyCell>(
        &self,
        contact: Contact,
        until: f64,
        lives: &mut Lives,
        volley: &mut BreakBatch<C>,
        cells: &mut [C],
        breaks: &mut u64,
    ) -> Contact {
        let coming = lives.plain();
        let at_once = volley.fire(contact, until, coming, self.ruler, cells);
        let (contact, taken) = at_once.unwrap_or_else(|| self.one_by_one(contact, until, coming, cells));
        lives.skip(taken);
        *breaks += taken as u64;
        contact
    }

    /// As many of the `coming` lives as begin by `until`; how many they were. The contact stays in
    /// registers, which is what makes this loop worth having.
    #[inline(always)]
    fn one_by_one<C: TallyCell>(
        &self,
        mut contact: Contact,
        until: f64,
        (thresholds, stretch): (&[f64], f64),
        cells: &mut [C],
    ) -> (Contact, usize) {
        for (taken, &threshold) in thresholds.iter().enumerate() {
            if contact.end() > until || threshold <= stretch {
                return (contact, taken);
            }
            contact = self.strike(contact, ContactLife { stretch, threshold }, cells);
        }
        (contact, thresholds.len())
    }

    /// One break, and the life after it.
    #[inline(always)]
    fn strike<C: TallyCell>(&self, contact: Contact, next: ContactLife, cells: &mut [C]) -> Contact {
        let (cell, position) = self.grid.at_or_above(contact.end());
        let origin = contact.origin + (contact.threshold - next.stretch);
        let next = Contact { origin, threshold: next.threshold };
        cells[cell].apply(C::change(contact.at(position), next.at(position)));
        next
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::{Contacts, Initial, Start};
    use crate::ensemble::Disorder;
    use crate::ensemble::tally::{Different, Equal};
    use crate::law::{Gaussian, Law, Point, SharedLaw};
    use crate::random::{Purpose, Stream};

    /// Bits, compiled for any machine and for this one.
    fn volleys_are_breaks_one_by_one<C: TallyCell>(stretch: f64, law: Gaussian) {
        let point = |at| -> SharedLaw { Arc::new(Point::new(at).unwrap()) };
        let contacts = Contacts::new(Arc::new(law), point(stretch));
        let initial = Initial { law: point(0.1), start: Start::Conditional };
        let ensemble = Ensemble::new(contacts, initial, 1, 1, Disorder::Annealed).unwrap();
        let positions: Vec<f64> = (0..=4000).map(|i| 200.0 * (f64::from(i) / 4000.0)).collect();
        let (grid, ruler, last) = (HistogramGrid::new(&positions), Ruler::of(&positions).unwrap(), 200.0);
        let snapshots = &Snapshots::default();
        let sweep = Sweep { ensemble: &ensemble, grid, ruler: Some(ruler), positions: &positions, snapshots };
        let mut thresholds = [0.0; 128];
        law.fill(&mut Stream::new(1, Purpose::Sample, 0), &mut thresholds);
        let start = Contact { origin: -0.1, threshold: 0.93 };
        let mut volley = BreakBatch::new();
        // One by one; at once, compiled for any machine; at once on the widest registers of this one.
        let [one_by_one, anywhere, here] = [0, 1, 2].map(|way| {
            let mut cells = vec![C::ZERO; positions.len()];
            let jobs = [(1, last), (50, last), (64, last), (128, last), (128, 40.0)];
            let ends = jobs.map(|(length, until)| {
                let coming = (&thresholds[..length], stretch);
                let done = match way {
                    0 => None,
                    1 => Some(volley.all(start, until, coming, ruler, &mut cells)),
                    _ => volley.fire(start, until, coming, Some(ruler), &mut cells),
                };
                done.unwrap_or_else(|| sweep.one_by_one(start, until, coming, &mut cells))
            });
            (ends, cells.iter().map(C::sums).collect::<Vec<_>>())
        });
        assert!(one_by_one.0[3].1 > 0);
        assert_eq!(anywhere, one_by_one);
        assert_eq!(here, one_by_one);
    }

    #[test]
    fn volleys_leave_what_breaks_one_by_one_do() {
        let narrow = Gaussian::new(1.0, 0.05).unwrap();
        volleys_are_breaks_one_by_one::<Equal>(0.0, narrow);
        volleys_are_breaks_one_by_one::<Different>(0.2, narrow);
        // A threshold below the stretch ends a batch.
        volleys_are_breaks_one_by_one::<Equal>(0.3, Gaussian::new(1.0, 0.4).unwrap());
    }
}
