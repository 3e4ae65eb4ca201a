//! `[block]`: the slider is pulled through its own stiffness.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::block::{self, Loading, Slip};

/// A slider whose top, moved by the drive or the protocol, pulls its bottom through a stiffness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Shear stiffness K of the slider, force per length.
    pub stiffness: f64,
    /// What happens when the slider has lost its balance.
    #[serde(default)]
    pub slip: Slip,
    /// Share of the contacts that must break at once, at one position of the drive, for an event of the ensemble
    /// to count as a slip.
    #[serde(default = "slip_fraction")]
    pub slip_fraction: f64,
}

impl Block {
    /// The share that must break where nothing is said.
    pub const SLIP_FRACTION: f64 = 0.05;

    /// The slider, to be moved in time; over an `ensemble`, events that break few of its contacts are no slips.
    ///
    /// # Errors
    /// A stiffness, mass or damping that makes no sense; a rule of slip that limits no velocity.
    pub fn in_time(&self, ensemble: bool) -> Result<block::Block> {
        let slip = self.slip;
        let fraction = ensemble.then_some(self.slip_fraction);
        let built =
            slip.limits().and_then(|_| block::Block::new(Loading::Spring(self.stiffness), slip, fraction));
        built.map_err(|e| e.under("block"))
    }
}

fn slip_fraction() -> f64 {
    Block::SLIP_FRACTION
}
