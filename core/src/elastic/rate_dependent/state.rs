//! All that changes as an interface is driven in time, to be kept and restored.

use serde::{Deserialize, Serialize};

use super::slips::Slips;
use super::{RateDependentInterface, SlipRates};
use crate::Result;
use crate::dynamics::MotionState;
use crate::monitor::Monitor;

/// The state of an interface in time. An interface of the same description continues from it bit for bit.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct RateDependentInterfaceState {
    motion: MotionState,
    slips: Slips,
    rates: Option<SlipRates>,
}

impl RateDependentInterface {
    /// The present state.
    pub fn state(&self) -> RateDependentInterfaceState {
        let Self { motion, slips, rates, .. } = self;
        RateDependentInterfaceState { motion: motion.state(), slips: slips.clone(), rates: rates.clone() }
    }

    /// Restores the state of an interface of the same description.
    ///
    /// # Errors
    /// A state of another number of cells, or of other contacts, after which nothing has changed.
    pub fn restore(&mut self, state: RateDependentInterfaceState) -> Result<()> {
        self.restore_with(state, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::restore`]; stopped by the monitor, after which the interface is of no use until a state is restored.
    pub fn restore_with(
        &mut self,
        state: RateDependentInterfaceState,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let RateDependentInterfaceState { motion, slips, rates } = state;
        self.motion.restore(motion, monitor)?;
        self.slips.resume(slips);
        let most = self.rates.as_ref().map(SlipRates::most);
        self.rates = rates.zip(most).map(|(rates, most)| rates.with_most(most));
        self.update_coupling(monitor)?;
        self.look = self.seen();
        Ok(())
    }
}
