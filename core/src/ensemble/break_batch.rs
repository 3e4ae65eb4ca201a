//! The next breaks of one contact, many at once.

use super::sweep::Contact;
use super::tally::{Ruler, TallyCell};
use crate::numerics::wide::wide;

/// Most breaks at once.
const MOST: usize = 128;

/// Fewer breaks are done sooner one by one.
const LEAST: usize = 48;

/// Breaks that go through registers together.
const ROW: usize = 16;

/// Rows between that where origins are written one by one and that where they are read together: what was just written
/// in pieces cannot be read whole before it has left the processor.
const LAG: usize = 2;

/// Breaks in columns, whole rows of them in lines of the cache.
#[repr(C, align(64))]
pub(super) struct BreakBatch<C: TallyCell> {
    changes: [C::Change; MOST],
    cells: [u32; MOST],
    /// Of the contact before each break and after the last one.
    origins: [f64; MOST + 1],
    thresholds: [f64; MOST + 1],
}

impl<C: TallyCell> BreakBatch<C> {
    pub(super) fn new() -> Self {
        Self {
            changes: [C::Change::default(); MOST],
            cells: [0; MOST],
            origins: [0.0; MOST + 1],
            thresholds: [0.0; MOST + 1],
        }
    }

    /// As many of the `coming` lives as begin by `until`, or fewer; how many they were. Nothing where it does not pay.
    #[inline]
    pub(super) fn fire(
        &mut self,
        contact: Contact,
        until: f64,
        coming: (&[f64], f64),
        ruler: Option<Ruler>,
        cells: &mut [C],
    ) -> Option<(Contact, usize)> {
        let ruler = ruler.filter(|_| coming.0.len() >= LEAST)?;
        wide(
            #[inline(always)]
            || self.all(contact, until, coming, ruler, cells),
        )
    }

    /// The same, compiled for where it is called.
    #[inline(always)]
    pub(super) fn all(
        &mut self,
        contact: Contact,
        until: f64,
        (coming, stretch): (&[f64], f64),
        ruler: Ruler,
        cells: &mut [C],
    ) -> (Contact, usize) {
        let coming = &coming[..coming.len().min(MOST)];
        let rows = coming.len().div_ceil(ROW);
        (self.origins[0], self.thresholds[0]) = (contact.origin, contact.threshold);
        self.thresholds[1..=coming.len()].copy_from_slice(coming);
        // No life begins with the threshold 0: breaks that fill the last row do not count.
        self.thresholds[1 + coming.len()..=rows * ROW].fill(0.0);
        let mut taken = coming.len() as u64;
        for row in 0..rows + LAG {
            if row < rows {
                self.follow(row * ROW, stretch);
            }
            if row >= LAG {
                taken = taken.min(self.tell((row - LAG) * ROW, until, stretch, ruler));
            }
        }
        let taken = taken as usize;
        for (&cell, &change) in self.cells[..taken].iter().zip(&self.changes) {
            cells[cell as usize].apply(change);
        }
        (Contact { origin: self.origins[taken], threshold: self.thresholds[taken] }, taken)
    }

    /// The origins of a row, each from the one before.
    #[inline(always)]
    fn follow(&mut self, from: usize, stretch: f64) {
        let mut origin = self.origins[from];
        for (next, threshold) in self.origins[from + 1..][..ROW].iter_mut().zip(&self.thresholds[from..]) {
            origin += threshold - stretch;
            *next = origin;
        }
    }

    /// Where the breaks of a row are and what they change; the first one that does not count, or [`MOST`].
    #[inline(always)]
    fn tell(&mut self, from: usize, until: f64, stretch: f64, ruler: Ruler) -> u64 {
        let (origins, thresholds) = (&self.origins[from..][..ROW + 1], &self.thresholds[from..][..ROW + 1]);
        let (cells, changes) = (&mut self.cells[from..][..ROW], &mut self.changes[from..][..ROW]);
        let mut taken = MOST as u64;
        for i in 0..ROW {
            let contact = Contact { origin: origins[i], threshold: thresholds[i] };
            let next = Contact { origin: origins[i + 1], threshold: thresholds[i + 1] };
            let end = contact.end();
            let (cell, position) = ruler.guess(end);
            cells[i] = cell;
            changes[i] = C::change(contact.at(position), next.at(position));
            let last = end > until || end > position || next.threshold <= stretch;
            taken = taken.min(if last { (from + i) as u64 } else { MOST as u64 });
        }
        taken
    }
}
