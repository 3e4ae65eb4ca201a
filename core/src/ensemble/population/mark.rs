//! What it takes to come back to where a population was: its energies, and the contacts that have broken since.

use super::EnsemblePopulation;
use crate::Result;
use crate::ensemble::queue::{Queue, QueuedContact, SLICE};
use crate::ensemble::sums::Sums;
use crate::monitor::{Monitor, report};
use crate::numerics::compensated::Compensated;
use crate::population::Direction;

/// A state to come back to, at a cost of memory in proportion to the breaks since.
#[derive(Clone)]
pub(super) struct ReturnMark {
    facing: Direction,
    moved: Direction,
    position: f64,
    back: f64,
    held: bool,
    sums: Sums,
    lost: Compensated,
    breaks: u64,
    free: Vec<QueuedContact>,
    /// What has broken since, as it was before, again for each time that it did.
    broken: Vec<QueuedContact>,
}

impl ReturnMark {
    /// The present state of a population, in the memory of the mark before.
    pub(super) fn of(population: &EnsemblePopulation, before: Option<Self>) -> Self {
        let mut broken = before.map(|mark| mark.broken).unwrap_or_default();
        broken.clear();
        let EnsemblePopulation {
            facing, moved, position, back, held, ref sums, lost, breaks, ref free, ..
        } = *population;
        Self {
            facing,
            moved,
            position,
            back,
            held,
            sums: sums.clone(),
            lost,
            breaks,
            free: free.clone(),
            broken,
        }
    }

    /// Hears of a break, seen in a direction.
    #[inline]
    pub(super) fn hear(&mut self, contact: &QueuedContact, facing: Direction) {
        self.broken.push(if facing == self.facing { *contact } else { contact.mirrored() });
    }

    /// Brings the population back.
    pub(super) fn restore(
        self,
        population: &mut EnsemblePopulation,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let turned = population.facing != self.facing;
        let attached = population.queue.drain(monitor)?;
        let mut changed = vec![false; population.size];
        self.free.iter().for_each(|contact| changed[contact.index as usize] = true);
        // What was free and has broken since was not attached.
        let first = |contact: &QueuedContact| !std::mem::replace(&mut changed[contact.index as usize], true);
        let mut contacts = self.broken;
        contacts.retain(first);
        contacts.reserve(population.size - contacts.len());
        for slice in attached.chunks(SLICE) {
            report(monitor, 0.0)?;
            let same = slice.iter().filter(|contact| !changed[contact.index as usize]);
            contacts.extend(same.map(|contact| if turned { contact.mirrored() } else { *contact }));
        }
        (population.facing, population.moved, population.held) = (self.facing, self.moved, self.held);
        (population.position, population.back) = (self.position, self.back);
        (population.sums, population.lost, population.breaks) = (self.sums, self.lost, self.breaks);
        (population.queue, population.free) = (Queue::of(contacts), self.free);
        Ok(())
    }
}
