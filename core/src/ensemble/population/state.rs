//! All that changes as the contacts of an ensemble are moved, to be kept and restored.

use serde::{Deserialize, Serialize};

use super::EnsemblePopulation;
use crate::Result;
use crate::ensemble::queue::{Queue, QueuedContact};
use crate::ensemble::sums::Sums;
use crate::numerics::compensated::Compensated;
use crate::population::Direction;
use crate::rate_dependent::ContactsState;

/// The state of contacts. The queue is kept as it is: sums over contacts are made in its order.
#[derive(Serialize, Deserialize)]
struct EnsemblePopulationState<Queue, Free, Sums> {
    facing: Direction,
    moved: Direction,
    position: f64,
    queue: Queue,
    back: f64,
    free: Free,
    held: bool,
    sums: Sums,
    lost: Compensated,
    breaks: u64,
}

impl EnsemblePopulation {
    /// The state of the contacts.
    pub(super) fn kept(&self) -> ContactsState {
        let Self { facing, moved, position, queue, back, free, held, sums, lost, breaks, .. } = self;
        let (facing, moved, position, back) = (*facing, *moved, *position, *back);
        let (held, lost, breaks) = (*held, *lost, *breaks);
        ContactsState::of(&EnsemblePopulationState {
            facing,
            moved,
            position,
            queue,
            back,
            free,
            held,
            sums,
            lost,
            breaks,
        })
    }

    /// Restores the state of other contacts of the same description.
    pub(super) fn take_up(&mut self, state: &ContactsState) -> Result<()> {
        let kept: EnsemblePopulationState<Queue, Vec<QueuedContact>, Sums> = state.read()?;
        let size = kept.queue.len() + kept.free.len();
        if size != self.size {
            return Err(ContactsState::another(&format!(
                "that of {size} contacts in place of {}",
                self.size
            )));
        }
        let EnsemblePopulationState { facing, moved, position, queue, back, free, held, sums, lost, breaks } =
            kept;
        (self.facing, self.moved, self.position, self.back) = (facing, moved, position, back);
        (self.queue, self.free, self.held) = (queue, free, held);
        (self.sums, self.lost, self.breaks, self.marked) = (sums, lost, breaks, None);
        Ok(())
    }
}
