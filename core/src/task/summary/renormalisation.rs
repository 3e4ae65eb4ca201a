//! What is quoted of the law of first breaks.

use serde::{Deserialize, Serialize};

use super::Fitted;

/// The law of the drives at which coupled contacts first broke, and what it is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FirstBreakStatistics {
    /// κ, the share of its stretch that a contact passes on.
    pub coupling: f64,
    /// κ_c of the thresholds.
    pub critical_coupling: f64,
    /// What was driven in each run.
    #[serde(flatten)]
    pub size: InterfaceSize,
    /// Number of runs.
    pub runs: usize,
    /// Mean drive of first breaks.
    pub mean: Fitted,
    /// Their standard deviation.
    pub std: Fitted,
    /// The law of the thresholds, those of contacts that are not coupled.
    pub thresholds: Compared,
    /// The renormalised law; absent at κ_c and above, where a share of all contacts breaks at once.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_field: Option<Compared>,
}

/// How large an interface is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InterfaceSize {
    /// So many contacts, coupled one by one.
    Contacts(usize),
    /// So many cells of many contacts.
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

/// A law beside the measured one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Compared {
    /// Its mean.
    pub mean: f64,
    /// Its standard deviation.
    pub std: f64,
    /// Kolmogorov's distance from what was measured.
    pub distance: f64,
}
