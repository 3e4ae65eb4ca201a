//! Statistics of the distribution of first breaks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Fitted;

/// The distribution of the drives at which coupled contacts first broke, and the distributions for comparison.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FirstBreakStatistics {
    /// Coupling κ, the fraction of its stretch that a breaking contact passes on.
    pub coupling: f64,
    /// Critical coupling κ_c of the thresholds.
    pub critical_coupling: f64,
    /// Size of the interface in each run.
    #[serde(flatten)]
    pub size: InterfaceSize,
    /// Number of runs.
    pub runs: usize,
    /// Mean drive of first breaks.
    pub mean: Fitted,
    /// Standard deviation of the drives of first breaks of all runs together.
    pub std: Fitted,
    /// The distribution of thresholds, which is that of first breaks without coupling.
    pub thresholds: Compared,
    /// The mean-field distribution; absent from κ_c, where a finite fraction of the contacts breaks at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_field: Option<Compared>,
}

/// How large an interface is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum InterfaceSize {
    /// Number of contacts coupled one by one.
    Contacts(usize),
    /// Number of cells of many contacts.
    Cells(usize),
}

impl std::fmt::Display for InterfaceSize {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Contacts(number) => write!(f, "{number} contacts"),
            Self::Cells(number) => write!(f, "{number} cells"),
        }
    }
}

/// A distribution compared with the measured one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Compared {
    /// Mean of the distribution.
    pub mean: f64,
    /// Standard deviation of the distribution.
    pub std: f64,
    /// Kolmogorov–Smirnov distance from the measured distribution.
    pub distance: f64,
}
