//! All that changes as cells move, to be kept and restored.

use serde::{Deserialize, Serialize};

use super::{ContactLag, MotionEnergies, SliderMotion, SlidingCell, SlopeTrend};
use crate::monitor::{Monitor, report};
use crate::rate_dependent::ContactsState;
use crate::{Error, Result};

/// The state of cells in motion. A motion of the same description continues from it bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MotionState {
    time: f64,
    drive: f64,
    /// Duration of the next step.
    next: f64,
    energies: MotionEnergies,
    cells: Vec<CellState>,
}

/// The state of a cell and of its contacts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct CellState {
    position: f64,
    force: f64,
    velocity: f64,
    back: f64,
    slope: f64,
    trend: SlopeTrend,
    lag: ContactLag,
    contacts: ContactsState,
}

impl CellState {
    fn of(cell: &SlidingCell) -> Self {
        let &SlidingCell { position, force, velocity, back, slope, trend, lag, ref contacts, .. } = cell;
        Self { position, force, velocity, back, slope, trend, lag, contacts: contacts.state() }
    }

    /// The cell in this state, which was in another one.
    fn restored(self, cell: &SlidingCell) -> Result<SlidingCell> {
        let Self { position, force, velocity, back, slope, trend, lag, contacts: kept } = self;
        let mut contacts = cell.contacts.copy();
        contacts.restore(&kept)?;
        let cell = SlidingCell::new(contacts, position);
        Ok(SlidingCell { force, velocity, back, slope, trend, lag, ..cell })
    }
}

impl SliderMotion {
    /// The present state.
    pub fn state(&self) -> MotionState {
        MotionState {
            time: self.time,
            drive: self.drive,
            next: self.control.next,
            energies: self.energies.clone(),
            cells: self.cells.iter().map(CellState::of).collect(),
        }
    }

    /// Restores the state of a motion of the same description.
    ///
    /// # Errors
    /// A state of another number of cells, or of other contacts; stopped by the monitor. Nothing has changed then.
    pub fn restore(&mut self, state: MotionState, monitor: &mut dyn Monitor) -> Result<()> {
        let MotionState { time, drive, next, energies, cells } = state;
        if cells.len() != self.cells.len() {
            let expected = format!("that of {} cells", self.cells.len());
            return Err(Error::invalid("state", expected, format!("that of {}", cells.len())));
        }
        let mut restored = |(kept, cell): (CellState, &SlidingCell)| {
            report(monitor, 0.0)?;
            kept.restored(cell)
        };
        let restored = cells.into_iter().zip(&self.cells).map(&mut restored);
        let restored: Vec<_> = restored.collect::<Result<_>>()?;
        (self.time, self.drive) = (time, drive);
        (self.cells, self.energies) = (restored, energies);
        self.control.next = next;
        Ok(())
    }
}
