//! `[compare]`: a measured curve to compare with the computed one.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Task, exactly_one, positive};
use crate::error::all_finite;
use crate::rate_state::StateLaw;
use crate::{Error, Result};

/// A measured curve, plotted with the computed one; the summary states its distance from it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Compare {
    /// Measured curve, CSV with columns `position,force`, plotted with F(X); its path is relative to the scenario. Beside a
    /// `[block]`, and with `stiffness`, positions are displacements of the load point since the start, and forces those of the
    /// spring. With `[velocity_curve]` the columns are `velocity,force`, of steady sliding, and with `[hold_curve]`
    /// `hold,force`, the highest forces after holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The measured positions, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length"))]
    pub position: Option<Vec<f64>>,
    /// The measured velocities of steady sliding, above 0, with `[velocity_curve]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "length/time"))]
    pub velocity: Option<Vec<f64>>,
    /// The measured hold times, above 0, with `[hold_curve]`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "time"))]
    pub hold: Option<Vec<f64>>,
    /// The measured forces, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-dimension" = "force"))]
    pub force: Option<Vec<f64>>,
    /// Stiffness K of the machine in which the curve was measured: velocity steps of a `[[protocol]]` are read with the
    /// equations of rate-and-state friction behind this spring. Beside a `[block]` it is the stiffness of the block.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force/length"))]
    pub stiffness: Option<f64>,
    /// The law of the state variables in these equations: `"ageing"` or `"slip"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "ageing"))]
    pub law: Option<StateLaw>,
    /// Number of the state variables.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1, "maximum" = 2, "default" = 1))]
    pub states: Option<usize>,
}

impl Compare {
    /// The measured points: positions, velocities or hold times, and forces.
    pub fn points(&self) -> (&[f64], &[f64]) {
        let along = [&self.position, &self.velocity, &self.hold].into_iter().flatten().next();
        (along.map_or(&[], Vec::as_slice), self.force.as_deref().unwrap_or_default())
    }

    /// The law and the number of the state variables behind a spring.
    pub fn state_variables(&self) -> (StateLaw, usize) {
        (self.law.unwrap_or_default(), self.states.unwrap_or(1))
    }

    /// Checks every value; `block` is whether the scenario has one.
    pub(super) fn check(&self, task: Task<'_>, block: bool) -> Result<()> {
        let name = abscissa(task)?;
        let columns = [("position", &self.position), ("velocity", &self.velocity), ("hold", &self.hold)];
        if let Some((other, _)) = columns.iter().find(|(other, of)| *other != name && of.is_some()) {
            return Err(Error::invalid(*other, format!("{name} with [{}]", task.name()), *other));
        }
        let force = self.force.as_ref().map(|_| "force");
        let lists = columns.iter().filter(|(_, of)| of.is_some()).map(|(name, _)| *name).chain(force);
        let lists = lists.collect::<Vec<_>>().join(" and ");
        let given = [("file", self.file.is_some()), (lists.as_str(), !lists.is_empty())];
        exactly_one("", &format!("either file or {name} and force"), &given)?;
        self.check_points(name)?;
        self.check_spring(task, block)
    }

    /// Checks the points, whose first coordinate has this name.
    fn check_points(&self, name: &str) -> Result<()> {
        let (along, force) = self.points();
        if along.is_empty() {
            return Err(Error::invalid(name, "at least one point", "none"));
        }
        if along.len() != force.len() {
            let expected = format!("{} forces, one for each {name}", along.len());
            return Err(Error::invalid("force", expected, force.len()));
        }
        all_finite(name, along)?;
        all_finite("force", force)?;
        match along.iter().position(|&value| value <= 0.0) {
            Some(i) if name != "position" => {
                Err(Error::invalid(format!("{name}.{i}"), "a number above 0", along[i]))
            }
            _ => Ok(()),
        }
    }

    /// Checks the spring of the machine, and refuses what has no meaning without one.
    fn check_spring(&self, task: Task<'_>, block: bool) -> Result<()> {
        if let Some(stiffness) = self.stiffness {
            let refused = |expected: &str| Err(Error::invalid("stiffness", expected, stiffness));
            match task {
                Task::Protocol(_) if block => {
                    return refused("none beside [block], whose stiffness is that of the machine");
                }
                Task::Protocol(_) => positive("stiffness", stiffness)?,
                Task::Pull(_) => {
                    return refused("none with [pull]: the spring of a pull is that of fit.compliance");
                }
                _ => return refused("none but with [[protocol]], whose velocity steps are read with it"),
            };
        }
        let given = [
            ("law", self.law.map(|law| format!("{law:?}").to_lowercase())),
            ("states", self.states.map(|states| states.to_string())),
        ];
        if let Some((key, Some(value))) = given.into_iter().find(|(_, value)| value.is_some())
            && self.stiffness.is_none()
            && !(block && matches!(task, Task::Protocol(_)))
        {
            let expected = "none without compare.stiffness or a [block], the spring of the machine";
            return Err(Error::invalid(key, expected, value));
        }
        match self.states {
            Some(states) if !(1..=2).contains(&states) => {
                Err(Error::invalid("states", "1 or 2 state variables", states))
            }
            _ => Ok(()),
        }
    }
}

/// Against what forces are compared with a task.
fn abscissa(task: Task<'_>) -> Result<&'static str> {
    match task {
        Task::Pull(_) | Task::Protocol(_) => Ok("position"),
        Task::VelocityCurve(curve) if !curve.temperatures.is_empty() => {
            let expected = "no compared curve beside velocity_curve.temperatures: it is of one temperature";
            Err(Error::invalid("", expected, "one"))
        }
        Task::VelocityCurve(_) => Ok("velocity"),
        Task::HoldCurve(_) => Ok("hold"),
        _ => {
            let expected = "a compared curve only with the tasks [pull], [[protocol]], [velocity_curve] and [hold_curve]";
            Err(Error::invalid("", expected, format!("one with [{}]", task.name())))
        }
    }
}
