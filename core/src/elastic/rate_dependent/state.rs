//! All that changes as an interface is driven in time, to be kept and taken up again.

use serde::{Deserialize, Serialize};

use super::slips::Slips;
use super::{RateDependentInterface, SlipRates};
use crate::dynamics::{ContactLag, SlopeTrend};
use crate::rate_dependent::{self, ErrorEstimator};
use crate::{Error, Result};

/// The state of an interface in time. An interface of the same description continues from it as if never stopped, bit for
/// bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RateDependentInterfaceState {
    time: f64,
    drive: f64,
    pace: f64,
    work: f64,
    /// Dissipated by cells that came to rest.
    arrest: f64,
    cells: Vec<CellState>,
    slips: Slips,
    rates: Option<SlipRates>,
    estimators: Option<Vec<[rate_dependent::ContactsState; 2]>>,
    error: f64,
}

/// What a cell has come to.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct CellState {
    position: f64,
    force: f64,
    velocity: f64,
    slope: f64,
    trend: SlopeTrend,
    lag: ContactLag,
    viscous: f64,
    contacts: rate_dependent::ContactsState,
}

impl RateDependentInterface {
    /// What it has come to.
    pub fn state(&self) -> RateDependentInterfaceState {
        let cells =
            self.motion.cells.iter().zip(&self.motion.energies.viscous).map(|(cell, &viscous)| CellState {
                position: cell.position,
                force: cell.force,
                velocity: cell.velocity,
                slope: cell.slope,
                trend: cell.trend,
                lag: cell.lag,
                viscous,
                contacts: cell.contacts.state(),
            });
        let estimators = self.motion.estimators.as_ref().map(|all| all.iter().map(ErrorEstimator::state));
        RateDependentInterfaceState {
            time: self.motion.time,
            drive: self.motion.drive,
            pace: self.motion.control.next,
            work: self.motion.energies.work,
            arrest: self.motion.energies.arrest,
            cells: cells.collect(),
            slips: self.slips.clone(),
            rates: self.rates.clone(),
            estimators: estimators.map(|states| states.collect()),
            error: self.motion.error,
        }
    }

    /// Goes to what an interface of the same description has come to.
    ///
    /// # Errors
    /// A state of another number of cells, or of other contacts: the interface is of no use any more then.
    pub fn restore(&mut self, state: RateDependentInterfaceState) -> Result<()> {
        let RateDependentInterfaceState {
            time,
            drive,
            pace,
            work,
            arrest,
            cells,
            slips,
            rates,
            estimators,
            error,
        } = state;
        if cells.len() != self.len() {
            let expected = format!("that of {} cells", self.len());
            return Err(Error::invalid("state", expected, format!("that of {}", cells.len())));
        }
        let motion = &mut self.motion;
        for ((cell, lost), kept) in motion.cells.iter_mut().zip(&mut motion.energies.viscous).zip(cells) {
            let mut contacts = cell.contacts.copy();
            contacts.restore(&kept.contacts)?;
            cell.contacts = contacts.into();
            cell.update_known();
            (cell.position, cell.force, cell.lag) = (kept.position, kept.force, kept.lag);
            (cell.velocity, cell.slope, cell.trend) = (kept.velocity, kept.slope, kept.trend);
            *lost = kept.viscous;
        }
        for (estimator, kept) in motion.estimators.iter_mut().flatten().zip(estimators.iter().flatten()) {
            estimator.restore(kept)?;
        }
        (motion.time, motion.drive, motion.error) = (time, drive, error);
        (motion.control.next, motion.energies.work, motion.energies.arrest) = (pace, work, arrest);
        self.slips.resume(slips);
        let most = self.rates.as_ref().map(SlipRates::most);
        self.rates = rates.zip(most).map(|(rates, most)| rates.with_most(most));
        self.look = self.seen();
        self.update_coupling_energy();
        Ok(())
    }
}
