//! All that changes as the contacts of an ensemble are moved, to be kept and taken up again.

use serde::{Deserialize, Serialize};

use super::EnsemblePopulation;
use crate::Result;
use crate::ensemble::queue::{Queue, QueuedContact};
use crate::ensemble::sums::Sums;
use crate::numerics::compensated::Compensated;
use crate::population::Direction;
use crate::rate_dependent::State;

/// What contacts have come to. The queue is kept as it is: sums over contacts are made in its order.
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
    /// What the contacts have come to.
    pub(super) fn kept(&self) -> State {
        let Self { facing, moved, position, queue, back, free, held, sums, lost, breaks, .. } = self;
        let (facing, moved, position, back) = (*facing, *moved, *position, *back);
        let (held, lost, breaks) = (*held, *lost, *breaks);
        State::of(&EnsemblePopulationState {
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

    /// Goes to what other contacts of the same description have come to.
    pub(super) fn take_up(&mut self, state: &State) -> Result<()> {
        let kept: EnsemblePopulationState<Queue, Vec<QueuedContact>, Sums> = state.read()?;
        let size = kept.queue.len() + kept.free.len();
        if size != self.size {
            return Err(State::another(&format!("that of {size} contacts in place of {}", self.size)));
        }
        let EnsemblePopulationState { facing, moved, position, queue, back, free, held, sums, lost, breaks } =
            kept;
        (self.facing, self.moved, self.position, self.back) = (facing, moved, position, back);
        (self.queue, self.free, self.held) = (queue, free, held);
        (self.sums, self.lost, self.breaks, self.marked) = (sums, lost, breaks, None);
        Ok(())
    }
}
