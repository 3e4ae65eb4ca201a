//! `[compare]`: a measured curve to compare with the computed one.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Task, exactly_one};
use crate::{Error, Result};

/// A measured curve, plotted with F(X); the summary states its distance from F(X).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Compare {
    /// Measured curve, CSV with columns `position,force`, plotted with F(X); its path is relative to the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The measured positions, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub position: Option<Vec<f64>>,
    /// The measured forces, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub force: Option<Vec<f64>>,
}

impl Compare {
    /// The measured points: positions and forces.
    pub fn points(&self) -> (&[f64], &[f64]) {
        (self.position.as_deref().unwrap_or_default(), self.force.as_deref().unwrap_or_default())
    }

    pub(super) fn check(&self, task: Task<'_>) -> Result<()> {
        if !matches!(task, Task::Pull(_) | Task::Protocol(_)) {
            let expected = "a compared curve only with the tasks [pull] and [[protocol]]";
            return Err(Error::invalid("", expected, format!("one with [{}]", task.name())));
        }
        let given = [
            ("file", self.file.is_some()),
            ("position and force", self.position.is_some() || self.force.is_some()),
        ];
        exactly_one("", "either file or position and force", &given)?;
        let (position, force) = self.points();
        if position.is_empty() {
            return Err(Error::invalid("position", "at least one point", "none"));
        }
        if position.len() != force.len() {
            let expected = format!("{} forces, one for each position", position.len());
            return Err(Error::invalid("force", expected, force.len()));
        }
        finite("position", position)?;
        finite("force", force)
    }
}

fn finite(key: &str, values: &[f64]) -> Result<()> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(i) => Err(Error::invalid(format!("{key}.{i}"), "a finite number", values[i])),
        None => Ok(()),
    }
}
