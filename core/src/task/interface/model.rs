//! The trait of interfaces that are driven from event to event.

use crate::Result;
use crate::elastic::SlipRates;
use crate::energy::EnergyBalance;
use crate::monitor::Monitor;
use crate::record::{Column, Record};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// An interface that is driven from event to event.
pub trait DrivenInterface {
    /// An event.
    type Event;
    /// The state, which changes as the interface is driven.
    type State: Serialize + DeserializeOwned;

    /// Name of the column of the magnitude of an event.
    const MAGNITUDE: &'static str;
    /// Whether magnitudes are whole numbers.
    const WHOLE: bool;
    /// Whether events at the same drive are parts of one slide.
    const CLUSTERED: bool = false;
    /// The column of events along which they follow each other, drive or time.
    const CLOCK: &'static str = "drive";
    /// Columns of the whole interface.
    const TRACE: &'static [Column];
    /// Columns of every cell.
    const MAPS: &'static [Column];

    /// The present drive X_T, a length.
    fn drive(&self) -> f64;

    /// The present value of the variable by which it advances: the drive, or the time of a protocol.
    fn progress(&self) -> f64 {
        self.drive()
    }

    /// The drive from which displacements are counted, the balance with the forces that contacts have from the start: 0 where
    /// they are relaxed, and for contacts coupled one by one, whose drive is counted from their initial stretches.
    fn origin(&self) -> f64 {
        0.0
    }

    /// Advances to `to`, a drive or a time ([`Self::progress`]), or by `most` events, whichever comes first. Returns whether it
    /// reached `to`.
    ///
    /// # Errors
    /// A stop by the monitor; the interface goes on from there.
    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(Self::Event),
    ) -> Result<bool>;

    /// Events that have ended, but not been passed on because an earlier one has not: the last ones of a run.
    fn last_events(&mut self) -> Vec<Self::Event> {
        Vec::new()
    }

    /// Events that have not ended.
    fn unfinished_events(&self) -> usize {
        0
    }

    /// Events as columns, including the drive, with the names of `events.csv`.
    fn columns(&self, events: &[Self::Event]) -> Record;

    /// The cells that took part in events of a chain, event by event; the first event has the number `first`.
    fn slipped(&self, events: &[Self::Event], first: usize) -> Record;

    /// Largest estimated error of the force of a cell at the output points so far; `None` if it is not estimated.
    fn error(&self) -> Option<f64>;

    /// Time t since the beginning; 0 for athermal contacts whose slides take no time.
    fn time(&self) -> f64;

    /// Friction force of all cells.
    fn force(&self) -> f64;

    /// Friction force F_j of each cell, along rows.
    fn forces(&self) -> Vec<f64>;

    /// Position X_j of each cell, along rows; `None` for contacts coupled one by one, which have stretches only.
    fn positions(&self) -> Option<Vec<f64>>;

    /// Energy balance since the beginning; `None` where it is not computed.
    fn energy(&self) -> Option<EnergyBalance>;

    /// The velocities of all cells at steps in time; `None` where they are not recorded.
    fn slip_rates(&self) -> Option<&SlipRates> {
        None
    }

    /// Present values of the columns [`DrivenInterface::TRACE`], in their order.
    fn trace(&self) -> Vec<f64>;

    /// Present values of the columns [`DrivenInterface::MAPS`], in their order, one value per cell.
    fn maps(&self) -> Vec<Vec<f64>>;

    /// The present state.
    fn state(&self) -> Self::State;

    /// Restores the state of another interface with the same description.
    ///
    /// # Errors
    /// A state of a different description; a stop by the monitor.
    fn restore(&mut self, state: Self::State, monitor: &mut dyn Monitor) -> Result<()>;
}
