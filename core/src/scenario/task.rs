//! The task of a scenario: one of the tables that are tasks.

use std::collections::BTreeMap;

use super::Scenario;
use crate::{Error, Result};

macro_rules! declare {
    ($(#[doc = $meaning:literal] $table:ident: $task:ident,)*) => {
        /// The task of a scenario.
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[non_exhaustive]
        pub enum Task<'a> {
            $(#[doc = $meaning] $task(&'a super::$task),)*
        }

        impl Task<'_> {
            /// The names of the tables that are tasks.
            pub const NAMES: &'static [&'static str] = &[$(stringify!($table)),*];
            /// What each of them does: a sentence that begins with its table.
            pub const MEANINGS: &'static [&'static str] = &[$($meaning),*];

            /// The name of its table.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$task(_) => stringify!($table),)*
                }
            }

            pub(super) fn check_values(self) -> Result<()> {
                match self {
                    $(Self::$task(task) => task.check(),)*
                }
                .map_err(|e| e.under(self.name()))
            }
        }

        impl Scenario {
            /// The tasks that the scenario has.
            fn tasks(&self) -> impl Iterator<Item = Task<'_>> {
                [$(self.$table.as_ref().map(Task::$task)),*].into_iter().flatten()
            }
        }
    };
}

each_task!(declare);

/// The table that is a list of steps, and the key in its place that names a file.
const STEPS: [&str; 2] = ["protocol", "protocol_file"];

/// The rule of the schema that a scenario has exactly one task.
pub(super) fn exactly_one() -> Vec<BTreeMap<&'static str, [&'static str; 1]>> {
    let keys = Task::NAMES
        .iter()
        .flat_map(|name| if *name == STEPS[0] { &STEPS[..] } else { std::slice::from_ref(name) });
    keys.map(|key| BTreeMap::from([("required", [*key])])).collect()
}

/// The tables that are tasks, for messages.
fn expected() -> String {
    let written = |name: &&str| if *name == STEPS[0] { format!("[[{name}]]") } else { format!("[{name}]") };
    let mut tables: Vec<String> = Task::NAMES.iter().map(written).collect();
    let last = tables.pop().unwrap_or_default();
    format!("a task: one of the tables {} and {last}", tables.join(", "))
}

impl Scenario {
    /// The one task that the scenario has.
    ///
    /// # Errors
    /// No task, or more than one.
    pub fn task(&self) -> Result<Task<'_>> {
        let mut given = self.tasks();
        let Some(task) = given.next() else {
            return Err(match &self.protocol_file {
                Some(file) => {
                    Error::invalid("protocol_file", "the steps that a file holds", format!("{file}, unread"))
                }
                None => Error::invalid("pull", expected(), "none"),
            });
        };
        if let Some(second) = given.next() {
            let found = format!("{} beside {}", second.name(), task.name());
            return Err(Error::invalid(second.name(), "only one task", found));
        }
        match &self.protocol_file {
            Some(_) => {
                let found = format!("protocol_file beside {}", task.name());
                Err(Error::invalid("protocol_file", "only one task", found))
            }
            None => Ok(task),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_every_task() {
        let tables = "[pull], [drive], [[protocol]], [velocity_curve], [hold_curve], [creep], [spectrum], [stability], [fit]";
        assert_eq!(expected(), format!("a task: one of the tables {tables} and [renormalisation]"));
    }
}
