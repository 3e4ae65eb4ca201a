//! Many successive breaks of one contact at once, vectorised.

use super::contact::Contact;
use super::tally::{TallyCell, UniformGrid};
use crate::numerics::wide::wide;

/// Largest number of breaks in a batch.
const MOST: usize = 128;

/// Fewer breaks are faster one by one.
const LEAST: usize = 48;

/// Breaks in a row of registers.
const ROW: usize = 16;

/// Rows between writing origins one by one and reading them together: values just written in pieces cannot be
/// read as a whole before the store has completed.
const LAG: usize = 2;

/// Breaks in columns, aligned to cache lines.
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

    /// Processes those of the `upcoming` lives that begin by `until`, at most one batch; returns their
    /// number. `None` if that is not worthwhile.
    #[inline]
    pub(super) fn advance_batch(
        &mut self,
        contact: Contact,
        until: f64,
        upcoming: (&[f64], f64),
        grid: Option<UniformGrid>,
        cells: &mut [C],
    ) -> Option<(Contact, usize)> {
        let grid = grid.filter(|_| upcoming.0.len() >= LEAST)?;
        wide(
            #[inline(always)]
            || self.process(contact, until, upcoming, grid, cells),
        )
    }

    /// The same, compiled for the features of the caller.
    #[inline(always)]
    pub(super) fn process(
        &mut self,
        contact: Contact,
        until: f64,
        (upcoming, stretch): (&[f64], f64),
        grid: UniformGrid,
        cells: &mut [C],
    ) -> (Contact, usize) {
        let upcoming = &upcoming[..upcoming.len().min(MOST)];
        let rows = upcoming.len().div_ceil(ROW);
        (self.origins[0], self.thresholds[0]) = (contact.origin, contact.threshold);
        self.thresholds[1..=upcoming.len()].copy_from_slice(upcoming);
        // No life begins with the threshold 0: breaks that fill the last row do not count.
        self.thresholds[1 + upcoming.len()..=rows * ROW].fill(0.0);
        // Every break of a row is computed, without branches; `taken` is the first one that does not count.
        let mut taken = upcoming.len() as u64;
        for row in 0..rows + LAG {
            if row < rows {
                self.advance_origins(row * ROW, stretch);
            }
            if row >= LAG {
                taken = taken.min(self.tally_row((row - LAG) * ROW, until, stretch, grid));
            }
        }
        let taken = taken as usize;
        // In the order of breaks, as one by one: the sums have the same bits.
        for (&cell, &change) in self.cells[..taken].iter().zip(&self.changes) {
            cells[cell as usize].apply(change);
        }
        (Contact { origin: self.origins[taken], threshold: self.thresholds[taken] }, taken)
    }

    /// The origins of a row, each from the one before.
    #[inline(always)]
    fn advance_origins(&mut self, from: usize, stretch: f64) {
        let mut origin = self.origins[from];
        for (next, threshold) in self.origins[from + 1..][..ROW].iter_mut().zip(&self.thresholds[from..]) {
            // The only serial dependence of the batch, one addition per break; everything else is
            // done in whole registers.
            origin += threshold - stretch;
            *next = origin;
        }
    }

    /// The positions of the breaks of a row and their changes; returns the index of the first one that does
    /// not count, or [`MOST`].
    #[inline(always)]
    fn tally_row(&mut self, from: usize, until: f64, stretch: f64, grid: UniformGrid) -> u64 {
        let (origins, thresholds) = (&self.origins[from..][..ROW + 1], &self.thresholds[from..][..ROW + 1]);
        let (cells, changes) = (&mut self.cells[from..][..ROW], &mut self.changes[from..][..ROW]);
        let mut taken = MOST as u64;
        for i in 0..ROW {
            let contact = Contact { origin: origins[i], threshold: thresholds[i] };
            let next = Contact { origin: origins[i + 1], threshold: thresholds[i + 1] };
            let end = contact.end();
            let (cell, position) = grid.guess(end);
            cells[i] = cell;
            changes[i] = C::change(contact.at(position), next.at(position));
            // A break ends the batch if it is beyond `until`, if the guessed grid value is below it, or if
            // the next threshold has to be redrawn above the stretch.
            let last = end > until || end > position || next.threshold <= stretch;
            taken = taken.min(if last { (from + i) as u64 } else { MOST as u64 });
        }
        taken
    }
}
