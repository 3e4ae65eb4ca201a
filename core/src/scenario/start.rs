//! `start`: the contacts at the start of a task.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Law;
use crate::contacts::{Contacts, Initial, Start};
use crate::master::MasterEquation;
use crate::monitor::Monitor;
use crate::{Error, Result};

/// The contacts at the start of a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TaskStart {
    /// Stretches of the initial distribution, thresholds above them: [`Start::Conditional`].
    #[default]
    Conditional,
    /// Stretches of the initial distribution, independent of the thresholds: [`Start::Relaxed`].
    Relaxed,
    /// Steady sliding, at the velocity of the task if contacts are time-dependent: the stationary distribution of stretches,
    /// thresholds and ages.
    Steady,
}

impl From<Start> for TaskStart {
    fn from(start: Start) -> Self {
        match start {
            Start::Conditional => Self::Conditional,
            Start::Relaxed => Self::Relaxed,
        }
    }
}

impl TaskStart {
    /// The contacts at X = 0. In steady sliding, time-independent contacts have the stretches Q_s; the state of time-dependent
    /// ones is not determined by their stretches, and [`crate::master::Transport::steady`] computes it.
    ///
    /// # Errors
    /// An initial distribution beside steady sliding; stopped by the monitor; those of [`MasterEquation::new`] and
    /// [`crate::master::SteadyState::stretch_law`].
    pub fn build(self, contacts: &Contacts, initial: &Law, monitor: &mut dyn Monitor) -> Result<Initial> {
        let start = match self {
            Self::Conditional => Start::Conditional,
            Self::Relaxed => Start::Relaxed,
            Self::Steady => return steady(contacts, initial),
        };
        Ok(Initial { law: initial.build_with(monitor)?, start })
    }
}

/// The contacts in steady sliding.
fn steady(contacts: &Contacts, initial: &Law) -> Result<Initial> {
    if *initial != Law::zero() {
        let expected = "no initial stretches beside start = \"steady\", which has those of steady sliding";
        return Err(Error::invalid("", expected, "a distribution"));
    }
    if contacts.rules.are_time_dependent() {
        return Ok(Initial::default());
    }
    let equation = MasterEquation::new(contacts.clone(), &Initial::default()).map_err(Error::of_scenario)?;
    equation.steady_state().stretch_law().map(Initial::new)
}
