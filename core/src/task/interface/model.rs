//! An interface that is driven from event to event, whatever its cells are.

use crate::Result;
use crate::energy::EnergyBalance;
use crate::monitor::Monitor;
use crate::record::{Column, Record};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// An interface that goes from event to event.
pub trait DrivenInterface {
    /// An event.
    type Event;
    /// All that changes as it is driven.
    type State: Serialize + DeserializeOwned;

    /// The name of the column that tells how large an event is.
    const MAGNITUDE: &'static str;
    /// Whether magnitudes are whole numbers.
    const WHOLE: bool;
    /// What is known of the whole interface.
    const TRACE: &'static [Column];
    /// What is known of every cell.
    const MAPS: &'static [Column];

    /// The drive so far.
    fn drive(&self) -> f64;

    /// Goes on to the drive `to`, or for `most` events, whichever comes first; whether it got there.
    ///
    /// # Errors
    /// The monitor says stop; it is then between two events.
    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(Self::Event),
    ) -> Result<bool>;

    /// Events as columns, the drive among them, under the names that they have in `events.csv`.
    fn columns(&self, events: &[Self::Event]) -> Record;

    /// The cells that took part in events of a chain, event after event, the first one being number `first`.
    fn slipped(&self, events: &[Self::Event], first: usize) -> Record;

    /// Estimated error of the force of a cell, the largest so far; `None` where contacts are followed one by one.
    fn error(&self) -> Option<f64>;

    /// Time t since the beginning; 0 where contacts do not depend on it and slides take none.
    fn time(&self) -> f64;

    /// Friction force of all cells.
    fn force(&self) -> f64;

    /// Friction force F_j of each cell, along rows.
    fn forces(&self) -> Vec<f64>;

    /// Position X_j of each cell, along rows; `None` for contacts coupled one by one, which have stretches only.
    fn positions(&self) -> Option<Vec<f64>>;

    /// Energy balance since the beginning; `None` where it is not computed.
    fn energy(&self) -> Option<EnergyBalance>;

    /// What is known of the whole now, in the order of [`DrivenInterface::TRACE`].
    fn trace(&self) -> Vec<f64>;

    /// What is known of every cell now, in the order of [`DrivenInterface::MAPS`].
    fn maps(&self) -> Vec<Vec<f64>>;

    /// All of it that changes.
    fn state(&self) -> Self::State;

    /// Goes to where another one of the same description was.
    ///
    /// # Errors
    /// A state of something else; stopped by the monitor.
    fn restore(&mut self, state: Self::State, monitor: &mut dyn Monitor) -> Result<()>;
}
