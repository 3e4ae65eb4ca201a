//! Contacts through a pull, from break to break, and their contributions to the results.

use std::ops::Range;

use super::Ensemble;
use super::break_batch::BreakBatch;
use super::contact::Contact;
use super::lives::{ContactLife, Lives};
use super::snapshots::Snapshots;
use super::tally::{PositionGrid, TallyCell, UniformGrid};
use crate::contacts::StiffnessTable;

/// Contribution of one chunk of contacts.
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

/// A pull, as seen by its contacts.
pub(super) struct ContactPull<'a> {
    pub(super) ensemble: &'a Ensemble,
    pub(super) grid: PositionGrid<'a>,
    pub(super) uniform: Option<UniformGrid>,
    pub(super) positions: &'a [f64],
    pub(super) snapshots: &'a Snapshots,
    /// Stiffness against threshold, where it is neither equal nor proportional. Breaks are then not processed in batches.
    pub(super) table: Option<&'a StiffnessTable>,
}

impl ContactPull<'_> {
    /// Stretch and stiffness of a contact of this stretch and threshold.
    #[inline(always)]
    fn weighed<C: TallyCell>(&self, (stretch, threshold): (f64, f64)) -> (f64, f64) {
        match self.table {
            Some(table) if !C::EQUAL => (stretch, table.at(threshold)),
            _ => (stretch, threshold),
        }
    }

    pub(super) fn nothing<C: TallyCell>(&self) -> Chunk<C> {
        let cells = vec![C::ZERO; self.positions.len()];
        Chunk { cells, histograms: self.snapshots.histograms(), breaks: 0 }
    }

    /// Adds contacts to a chunk, each expected to break `expected` times.
    pub(super) fn add<C: TallyCell>(&self, contacts: Range<usize>, expected: usize, chunk: &mut Chunk<C>) {
        let mut lives = Lives::new(self.ensemble, expected);
        let mut batch = BreakBatch::new();
        for index in contacts {
            let first = lives.first(index as u64);
            self.follow(first, &mut lives, &mut batch, chunk);
        }
    }

    /// One contact from X = 0 to the last position.
    fn follow<C: TallyCell>(
        &self,
        first: ContactLife,
        lives: &mut Lives,
        batch: &mut BreakBatch<C>,
        chunk: &mut Chunk<C>,
    ) {
        let last = self.positions[self.positions.len() - 1];
        let mut life = first;
        // Only in a relaxed start contacts are at or above their thresholds: they break at once.
        if life.stretch >= life.threshold {
            chunk.breaks += 1;
            life = lives.next();
        }
        let mut contact = Contact { origin: -life.stretch, threshold: life.threshold };
        let (stretch, stiffness) = self.weighed::<C>(contact.at(self.positions[0]));
        chunk.cells[0].add(stretch, stiffness);
        let Chunk { cells, histograms, breaks } = chunk;
        let mut snapshots = self.snapshots.positions.iter().zip(histograms).peekable();
        loop {
            let until = snapshots.peek().map_or(last, |(position, _)| **position);
            // Batches of lives drawn ahead, then one break through the general path when they are used up.
            contact = self.advance_drawn(contact, until, lives, batch, cells, breaks);
            let end = contact.end();
            while let Some((position, histogram)) = snapshots.next_if(|(position, _)| **position < end) {
                self.snapshots.count(position - contact.origin, histogram);
            }
            if end > last {
                return;
            }
            contact = self.break_contact(contact, lives.next(), cells);
            *breaks += 1;
        }
    }

    /// The breaks by `until`, for the lives drawn ahead.
    #[inline(never)]
    fn advance_drawn<C: TallyCell>(
        &self,
        contact: Contact,
        until: f64,
        lives: &mut Lives,
        batch: &mut BreakBatch<C>,
        cells: &mut [C],
        breaks: &mut u64,
    ) -> Contact {
        let upcoming = lives.drawn_ahead();
        let uniform = self.uniform.filter(|_| self.table.is_none());
        let at_once = batch.advance_batch(contact, until, upcoming, uniform, cells);
        let (contact, taken) = at_once.unwrap_or_else(|| self.one_by_one(contact, until, upcoming, cells));
        lives.skip(taken);
        *breaks += taken as u64;
        contact
    }

    /// Processes those of the `upcoming` lives that begin by `until`; returns their number. The contact stays
    /// in registers, which makes this loop fast.
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
            contact = self.break_contact(contact, ContactLife { stretch, threshold }, cells);
        }
        (contact, thresholds.len())
    }

    /// One break, and the life after it.
    #[inline(always)]
    fn break_contact<C: TallyCell>(&self, contact: Contact, next: ContactLife, cells: &mut [C]) -> Contact {
        let (cell, position) = self.grid.at_or_above(contact.end());
        let origin = contact.origin + (contact.threshold - next.stretch);
        let next = Contact { origin, threshold: next.threshold };
        let [before, after] = [contact, next].map(|one| self.weighed::<C>(one.at(position)));
        cells[cell].apply(C::change(before, after));
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
        let (grid, uniform, last) =
            (PositionGrid::new(&positions), UniformGrid::of(&positions).unwrap(), 200.0);
        let snapshots = &Snapshots::default();
        let sweep = ContactPull {
            ensemble: &ensemble,
            grid,
            uniform: Some(uniform),
            positions: &positions,
            snapshots,
            table: None,
        };
        let mut thresholds = [0.0; 128];
        law.fill(&mut Stream::new(1, Purpose::Sample, 0), &mut thresholds);
        let start = Contact { origin: -0.1, threshold: 0.93 };
        let mut batch = BreakBatch::new();
        // One by one; at once, compiled for any machine; at once on the widest registers of this one.
        let [one_by_one, anywhere, here] = [0, 1, 2].map(|way| {
            let mut cells = vec![C::ZERO; positions.len()];
            let jobs = [(1, last), (50, last), (64, last), (128, last), (128, 40.0)];
            let ends = jobs.map(|(length, until)| {
                let upcoming = (&thresholds[..length], stretch);
                let done = match way {
                    0 => None,
                    1 => Some(batch.process(start, until, upcoming, uniform, &mut cells)),
                    _ => batch.advance_batch(start, until, upcoming, Some(uniform), &mut cells),
                };
                done.unwrap_or_else(|| sweep.one_by_one(start, until, upcoming, &mut cells))
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
