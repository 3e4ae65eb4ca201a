//! What is asked of the engine.

use serde::{Deserialize, Serialize};

use crate::law_change::LawChange;

/// A scenario, and what to compute of it.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Request {
    /// The text of the scenario, TOML.
    pub text: String,
    /// Values to replace in it before anything is computed.
    #[serde(default)]
    pub changes: Vec<Change>,
    /// What to compute.
    #[serde(default)]
    pub parts: Vec<Part>,
    /// Position X of the slider's base at which the distribution of stretches is given.
    #[serde(default)]
    pub position: f64,
    /// Whether a preview is enough: F to 1e-4 of N_c⟨k⟩ instead of 1e-10.
    #[serde(default)]
    pub preview: bool,
    /// The page that shows the answer; without one there are neither pictures nor controls.
    #[serde(default)]
    pub view: Option<View>,
}

/// How a page shows an answer.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct View {
    /// Width of a picture in pixels.
    pub width: f64,
    /// Width of one that is as wide as all of them.
    pub whole: f64,
    /// Whether readings are shown with the force.
    pub readings: bool,
}

/// A value to replace in the text of a scenario.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Change {
    /// Its key, as `contacts.thresholds.gaussian.std`.
    pub key: String,
    /// The value as TOML; without one, the key is removed.
    #[serde(default)]
    pub value: Option<String>,
    /// Instead of a value, the name of a rule of slip, which gets ordinary numbers.
    #[serde(default)]
    pub slip: Option<String>,
    /// Instead of a value, what changes in the distribution that is there.
    #[serde(default)]
    pub law: Option<LawChange>,
}

/// A part of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// F(X) of a rigid slider, with F_s, F_k, X* and K_c.
    Force,
    /// Q(x; X) at a position, in steady sliding, and the distributions that describe the contacts.
    Stretches,
    /// K_c, F_s and F_k against the standard deviation of the thresholds.
    CriticalStiffness,
    /// The motion of the slider of `[block]`.
    Block,
    /// The task of the scenario, whatever it is.
    Task,
}

impl Part {
    /// Whether it takes longer than a preview.
    pub(crate) fn is_long(self) -> bool {
        matches!(self, Self::CriticalStiffness | Self::Block | Self::Task)
    }
}
