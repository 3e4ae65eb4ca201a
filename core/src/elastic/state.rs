//! All that changes as an interface is driven, to be kept and taken up again.

use serde::{Deserialize, Serialize};

use super::creep::CreepPace;
use super::differences::Differences;
use super::energy::StoredEnergy;
use super::{Energy, Interface, cells};
use crate::monitor::Monitor;
use crate::{Error, Result};

/// What an interface has come to. One of the same description goes on from it as if it had never stopped, bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State {
    drive: f64,
    time: f64,
    positions: Vec<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    differences: Option<Differences>,
    cells: cells::CellsState,
    pace: CreepPace,
    energy: Energy,
    closed: StoredEnergy,
}

impl Interface {
    /// What it has come to.
    pub fn state(&self) -> State {
        State {
            drive: self.drive,
            time: self.time,
            positions: self.positions.clone(),
            differences: self.differences.clone(),
            cells: self.cells.state(),
            pace: self.pace,
            energy: self.energy,
            closed: self.closed,
        }
    }

    /// Goes to what an interface of the same description has come to.
    ///
    /// # Errors
    /// A state of another number of cells; those of the cells.
    pub fn restore(&mut self, state: State, monitor: &mut dyn Monitor) -> Result<()> {
        let State { drive, time, positions, differences, cells, pace, energy, closed } = state;
        if positions.len() != self.len() {
            let expected = format!("that of {} cells", self.len());
            return Err(Error::invalid("state", expected, format!("that of {}", positions.len())));
        }
        self.cells.restore(cells, monitor)?;
        (self.drive, self.time, self.positions) = (drive, time, positions);
        self.differences = differences;
        (self.pace, self.energy, self.closed) = (pace, energy, closed);
        self.by.fill(0.0);
        Ok(())
    }
}
