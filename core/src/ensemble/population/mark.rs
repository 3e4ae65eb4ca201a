//! A mark to which a population can return: its energies, and the contacts that have broken since.

use super::EnsemblePopulation;
use crate::Result;
use crate::ensemble::queue::{Queue, QueuedContact, SLICE};
use crate::ensemble::sums::Sums;
use crate::monitor::{Monitor, report};
use crate::numerics::compensated::Compensated;
use crate::population::Direction;

/// A state to return to; memory grows with the number of breaks since.
#[derive(Debug, Clone)]
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
    /// The contacts broken since, as they were before, once per break.
    broken: Vec<QueuedContact>,
}

impl ReturnMark {
    /// The present state of a population, reusing the memory of the previous mark.
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

    /// Records a break, seen in a direction.
    #[inline]
    pub(super) fn record(&mut self, contact: &QueuedContact, facing: Direction) {
        self.broken.push(if facing == self.facing { *contact } else { contact.mirrored() });
    }

    /// Restores the population.
    pub(super) fn restore(
        self,
        population: &mut EnsemblePopulation,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let turned = population.facing != self.facing;
        let attached = population.queue.drain(monitor)?;
        let mut changed = vec![false; population.size];
        self.free.iter().for_each(|contact| changed[contact.index as usize] = true);
        // Contacts that were free and have broken since were not attached.
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
