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
    /// Mean force drop of a slip; absent unless stick-slip persists.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub mean_drop: Option<f64>,
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
    /// The same over single contacts; absent without an ensemble.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ensemble: Option<SimulatedStickSlip>,
}

/// What a slider does over the single contacts of an ensemble, in simulations with different contacts. Standard deviations are
/// those of one simulation about the mean of all.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SimulatedStickSlip {
    /// Number of simulations.
    pub simulations: usize,
    /// Number of simulations without slips behind the spring of the block.
    pub none: usize,
    /// Number of those with slips that end.
    pub transient: usize,
    /// Number of those with slips that do not end.
    pub persistent: usize,
    /// Number of those that did not decide within the longest drive.
    pub undecided: usize,
    /// Mean force drop of a slip, over the simulations in which stick-slip persists; absent if there are none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub mean_drop: Option<f64>,
    /// Standard deviation of the mean force drop over these simulations; absent if there are fewer than two.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub drop_std: Option<f64>,
    /// Coefficient of variation of the advances of the load point from slip to slip within a simulation, mean over these
    /// simulations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "1"))]
    pub period_scatter: Option<f64>,
    /// Largest stiffness at which stick-slip was found to persist, mean over all simulations; infinite if it persisted at all
    /// stiffnesses that were tried, in one of them or more.
    #[schemars(extend("x-dimension" = "force/length"))]
    pub persistent_stiffness: Extended,
    /// Its standard deviation over the simulations; absent for a single simulation, or if the mean is infinite.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force/length"))]
    pub persistent_stiffness_std: Option<f64>,
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
