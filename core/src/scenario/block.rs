//! `[block]`: the slider is pulled through its own stiffness.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::block::{self, Loading, Slip};

/// A slider whose top, moved by the drive or the protocol, pulls its base through a stiffness.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Block {
    /// Shear stiffness K of the slider between its top and its base, force per length, above 0; without `[block]` the slider
    /// is rigid.
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force/length"))]
    pub stiffness: f64,
    /// Slip rule: `"reset"`, `"overdamped"`, `"arrest"`, `damped = { damping }` or `inertial = { mass, damping }`, whose
    /// `damping` is 0 if not given. Where time passes (time-dependent contacts, `[[protocol]]`) it is `damped` or `inertial`, or
    /// not given: the spring is then in balance at every time, and a slip ends the run with an error.
    #[serde(default)]
    pub slip: Slip,
    /// An event of the ensemble is a slip if more than this fraction of the contacts break at one position of the drive.
    #[serde(default = "slip_fraction")]
    #[schemars(extend("exclusiveMinimum" = 0, "maximum" = 1, "x-dimension" = "1"))]
    pub slip_fraction: f64,
}

impl Block {
    /// Default of `slip_fraction`.
    pub const SLIP_FRACTION: f64 = 0.05;

    /// The slider for motion in time. Over an `ensemble`, an event that breaks few contacts is not a slip.
    ///
    /// # Errors
    /// An invalid stiffness, mass or damping; a slip rule that has no meaning in time.
    pub fn in_time(&self, ensemble: bool) -> Result<block::Block> {
        let slip = self.slip;
        let fraction = ensemble.then_some(self.slip_fraction);
        let spring = Loading::Spring(self.stiffness);
        let built = slip.inertia_and_drag().and_then(|_| block::Block::new(spring, slip, fraction));
        built.map_err(|e| e.under("block"))
    }

    /// Mass and damping of the slider, one of them above 0.
    ///
    /// # Errors
    /// An invalid stiffness, mass or damping; a slip rule without a limit on the velocity.
    pub fn inertia_and_drag(&self) -> Result<(f64, f64)> {
        self.in_time(false)?;
        self.slip.limits().map_err(|e| e.under("block"))
    }
}

fn slip_fraction() -> f64 {
    Block::SLIP_FRACTION
}
