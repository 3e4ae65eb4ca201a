//! What is to be computed: one of the tables that are tasks.

use super::{Drive, Pull, Scenario};
use crate::{Error, Result};

/// The task of a scenario.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Task<'a> {
    /// `[pull]`: the bottom of the slider is moved.
    Pull(&'a Pull),
    /// `[drive]`: the top of the slider is moved, or a force imposed.
    Drive(&'a Drive),
}

/// The tables that are tasks, for messages.
const TASKS: &str = "a task: one of the tables [pull] and [drive]";

impl Scenario {
    /// The one task that the scenario has.
    ///
    /// # Errors
    /// No task, or more than one.
    pub fn task(&self) -> Result<Task<'_>> {
        let pull = self.pull.as_ref().map(Task::Pull);
        let drive = self.drive.as_ref().map(Task::Drive);
        let mut given = pull.into_iter().chain(drive);
        let task = given.next().ok_or_else(|| Error::invalid("pull", TASKS, "none"))?;
        match given.next() {
            None => Ok(task),
            Some(second) => {
                let found = format!("{} beside {}", second.name(), task.name());
                Err(Error::invalid(second.name(), "only one task", found))
            }
        }
    }
}

impl Task<'_> {
    /// The name of its table.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Pull(_) => "pull",
            Self::Drive(_) => "drive",
        }
    }

    pub(super) fn start(&self) -> super::Start {
        match self {
            Self::Pull(pull) => pull.start,
            Self::Drive(drive) => drive.start,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        match self {
            Self::Pull(pull) => pull.check(),
            Self::Drive(drive) => drive.check(),
        }
        .map_err(|e| e.under(self.name()))
    }
}
