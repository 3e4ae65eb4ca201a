//! `pull.start`: how the law `[initial]` of stretches is read.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contacts;

/// How the stretches at X = 0 and the thresholds go together.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// `[initial]` describes contacts that hold: thresholds lie above stretches, nothing breaks at X = 0.
    #[default]
    Conditional,
    /// Stretches and thresholds are independent: contacts above their threshold break at once and re-form.
    Relaxed,
}

impl From<Start> for contacts::Start {
    fn from(start: Start) -> Self {
        match start {
            Start::Conditional => Self::Conditional,
            Start::Relaxed => Self::Relaxed,
        }
    }
}
