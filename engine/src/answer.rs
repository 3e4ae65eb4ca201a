//! What the engine answers.

use std::ops::Deref;
use std::sync::Arc;

use asperity::master::Extremum;
use asperity::record::Record;
use asperity::scenario::Scenario;
use asperity::task::summary::{Extended, Summary};
use asperity_runner::input::Diagnostic;
use serde::{Serialize, Serializer};

use crate::shown::Shown;

/// The answer to a request: a part is absent if it was not asked for, or failed.
#[derive(Debug, Default, Serialize)]
pub struct Answer {
    /// The text of the scenario after the changes.
    pub text: String,
    /// The scenario with every default written out; absent if it is invalid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<Box<Scenario>>,
    /// What a page shows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub view: Option<Shown>,
    /// Why the scenario is invalid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub invalid: Option<Invalid>,
    /// Why parts could not be computed, a sentence for each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<String>,
    /// Whether the monitor has stopped the work.
    #[serde(skip)]
    pub stopped: bool,
    /// F(X) and its numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force: Option<ForceCurve>,
    /// Distributions of stretches.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretches: Option<StretchDistributions>,
    /// Friction against the width of the thresholds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub critical_stiffness: Option<WidthCurve>,
    /// The motion of the block.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub block: Option<Computed>,
    /// The task of the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub task: Option<Computed>,
}

impl Answer {
    /// The answer where nothing can be computed.
    pub fn failed(text: String, message: String) -> Self {
        Self { text, failures: vec![message], ..Self::default() }
    }

    /// The answer as JSON.
    pub fn to_json(&self) -> Vec<u8> {
        serde_json::to_vec(self).expect("an answer is plain data")
    }
}

/// An error in a scenario, with its place in the text.
#[derive(Debug, Serialize)]
pub struct Invalid {
    /// The key; empty where the whole text is meant.
    pub key: String,
    /// What was expected and what was found.
    pub message: String,
    /// What might be meant.
    pub help: Option<String>,
    /// The line, from 1 on.
    pub line: Option<usize>,
}

impl From<&Diagnostic> for Invalid {
    fn from(error: &Diagnostic) -> Self {
        let line = error.source.as_ref().and_then(|source| {
            let before = source.text.get(..source.marks.first()?.span.start)?;
            Some(before.matches('\n').count() + 1)
        });
        Self { key: error.key.clone(), message: error.to_string(), help: error.help.clone(), line }
    }
}

/// F(X) of a rigid slider.
#[derive(Debug, Serialize)]
pub struct ForceCurve {
    /// The velocity at which time-dependent contacts are pulled.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub velocity: Option<f64>,
    /// Positions X of the slider's base, a length.
    pub position: Vec<f64>,
    /// Friction force at these positions.
    pub force: Vec<f64>,
    /// Its standard deviation, for the number of contacts of the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_std: Option<Vec<f64>>,
    /// F_s and its position; absent if it is not reached.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub static_friction: Option<Place>,
    /// F_k.
    pub kinetic_friction: f64,
    /// X*, the relaxation length.
    pub relaxation_length: Extended,
    /// K_c, the critical stiffness.
    pub critical_stiffness: Extended,
    /// Estimated error of F/(N_c⟨k⟩), a length.
    pub accuracy: f64,
}

/// A value and where it is.
#[derive(Debug, Serialize)]
pub struct Place {
    /// Position X.
    pub position: f64,
    /// The value.
    pub value: f64,
}

impl From<Extremum> for Place {
    fn from(Extremum { position, value }: Extremum) -> Self {
        Self { position, value }
    }
}

/// Densities of stretches and thresholds, per length, and the point masses beside them.
#[derive(Debug, Serialize)]
pub struct StretchDistributions {
    /// Stretches x, a length.
    pub stretch: Vec<f64>,
    /// Position X of `density`.
    pub position: f64,
    /// Q(x; X).
    pub density: Density,
    /// Q_s(x), in steady sliding.
    pub steady: Density,
    /// Stretches of the distributions that describe the contacts.
    pub law_stretch: Vec<f64>,
    /// P_c(x), of the thresholds.
    pub thresholds: Density,
    /// R(x), of the stretches at which contacts re-form.
    pub reforming: Density,
    /// Q_ini(x), of the stretches at X = 0.
    pub initial: Density,
}

/// A density and point masses.
#[derive(Debug, Serialize)]
pub struct Density {
    /// At each stretch, per length.
    pub values: Vec<f64>,
    /// Stretches of the point masses.
    pub at: Vec<f64>,
    /// Their weights.
    pub weights: Vec<f64>,
}

/// Friction against the standard deviation of the thresholds, all else being equal.
#[derive(Debug, Clone, Default, Serialize)]
pub struct WidthCurve {
    /// Standard deviations σ, a length.
    pub width: Vec<f64>,
    /// K_c, force per length; "infinite" where the force jumps.
    pub critical_stiffness: Vec<Extended>,
    /// F_s; null where it is not reached.
    pub static_friction: Vec<Option<f64>>,
    /// F_k.
    pub kinetic_friction: Vec<f64>,
}

/// The result of a task, which the engine may know, too.
#[derive(Debug, Clone)]
pub struct Computed(Arc<Found>);

impl Computed {
    /// The result of a task.
    pub fn new(summary: Summary, record: Record) -> Self {
        Self(Arc::new(Found { summary, record }))
    }
}

impl Deref for Computed {
    type Target = Found;

    fn deref(&self) -> &Found {
        &self.0
    }
}

impl Serialize for Computed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.0.serialize(serializer)
    }
}

/// Numbers and arrays of a task.
#[derive(Debug, Serialize)]
pub struct Found {
    /// Its numbers.
    pub summary: Summary,
    /// Its arrays.
    pub record: Record,
}
