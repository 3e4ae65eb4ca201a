//! All that changes as an interface is driven, as plain data that can be kept and restored.

use serde::{Deserialize, Serialize};

use super::Interface;
use super::cells::CellsState;
use super::configuration::Configuration;
use super::creep::CreepPace;
use super::energy::EnergyBudget;
use crate::monitor::Monitor;
use crate::{Error, Result};

/// The state of an interface. Another one of the same description continues from it bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    configuration: Configuration,
    cells: CellsState,
    pace: CreepPace,
    energy: EnergyBudget,
}

impl Interface {
    /// The state now.
    pub fn state(&self) -> State {
        State {
            configuration: self.configuration.clone(),
            cells: self.model.cells.state(),
            pace: self.pace,
            energy: self.energy,
        }
    }

    /// Restores the state of an interface of the same description.
    ///
    /// # Errors
    /// A state of another number of cells; those of the cells.
    pub fn restore(&mut self, state: State, monitor: &mut dyn Monitor) -> Result<()> {
        let State { configuration, cells, pace, energy } = state;
        let number = configuration.positions.len();
        if number != self.len() {
            let expected = format!("that of {} cells", self.len());
            return Err(Error::invalid("state", expected, format!("that of {number}")));
        }
        self.model.cells.restore(cells, monitor)?;
        (self.configuration, self.pace, self.energy) = (configuration, pace, energy);
        Ok(())
    }
}
