//! All that changes as cells move, to be kept and restored.

use serde::{Deserialize, Serialize};

use super::{ContactLag, MotionEnergies, SliderMotion, SlidingCell, SlopeTrend};
use crate::monitor::{Monitor, report};
use crate::rate_dependent::{ContactsState, ErrorEstimator};
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
    estimators: Option<Vec<[ContactsState; 2]>>,
    error: f64,
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
        let estimators = self.estimators.as_ref();
        MotionState {
            time: self.time,
            drive: self.drive,
            next: self.control.next,
            energies: self.energies.clone(),
            cells: self.cells.iter().map(CellState::of).collect(),
            estimators: estimators.map(|all| all.iter().map(ErrorEstimator::state).collect()),
            error: self.error,
        }
    }

    /// Restores the state of a motion of the same description.
    ///
    /// # Errors
    /// A state of another number of cells, or of other contacts; stopped by the monitor. Nothing has changed then.
    pub fn restore(&mut self, state: MotionState, monitor: &mut dyn Monitor) -> Result<()> {
        let MotionState { time, drive, next, energies, cells, estimators, error } = state;
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
        let mut copies: Option<Vec<_>> =
            self.estimators.as_ref().map(|all| all.iter().map(ErrorEstimator::copy).collect());
        for (copy, kept) in copies.iter_mut().flatten().zip(estimators.iter().flatten()) {
            copy.restore(kept)?;
        }
        (self.time, self.drive, self.error) = (time, drive, error);
        (self.cells, self.energies, self.estimators) = (restored, energies, copies);
        self.control.next = next;
        Ok(())
    }
}
