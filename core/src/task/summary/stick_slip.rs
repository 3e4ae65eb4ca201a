//! Summary of the question whether a slider sticks and slips.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Extended;
use crate::block::Regime;

/// Whether a slider sticks and slips behind its spring, and behind which springs it does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StickSlipNumbers {
    /// Velocity of the load point; absent for time-independent contacts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/time"))]
    pub velocity: Option<f64>,
    /// Stiffness K of the spring.
    #[schemars(extend("x-dimension" = "force/length"))]
    pub stiffness: f64,
    /// Stick-slip behind this spring.
    pub stick_slip: StickSlipKind,
    /// The reason for that answer, in words.
    pub reason: String,
    /// Largest stiffness at which stick-slip was found to persist; 0 if at none.
    #[schemars(extend("x-dimension" = "force/length"))]
    pub persistent_stiffness: f64,
    /// Smallest stiffness above it at which it was found not to persist.
    #[schemars(extend("x-dimension" = "force/length"))]
    pub persistent_stiffness_above: Extended,
    /// Critical stiffness −min F' of the first pull.
    #[schemars(extend("x-dimension" = "force/length"))]
    pub critical_stiffness: Extended,
    /// Critical stiffness of steady sliding.
    #[schemars(extend("x-dimension" = "force/length"))]
    pub critical_stiffness_sliding: Extended,
}

/// The answer to the question whether a slider sticks and slips.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum StickSlipKind {
    /// No slips.
    None,
    /// Slips that end.
    Transient,
    /// Slips that do not end.
    Persistent,
    /// Not decided within the longest drive.
    Undecided,
}

impl StickSlipKind {
    /// The word in files and on the terminal.
    pub fn word(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Transient => "transient",
            Self::Persistent => "persistent",
            Self::Undecided => "undecided",
        }
    }
}

impl From<Regime> for StickSlipKind {
    fn from(regime: Regime) -> Self {
        match regime {
            Regime::Smooth { .. } => Self::None,
            Regime::Transient { .. } => Self::Transient,
            Regime::Persistent { .. } => Self::Persistent,
            // A spring cannot impose a force that runs away.
            Regime::Undecided { .. } | Regime::Runaway => Self::Undecided,
        }
    }
}
