//! What a sweep keeps: names that are checked against the summary and the variables of the task.

use asperity::record::{Quantity, Record};
use asperity::scenario::{Scenario, SweepKept, Task};
use asperity::task;
use asperity::task::summary::Summary;
use serde_json::Value;

use super::schema::{self, Entry};

/// The estimated error of forces, which is kept of every case that has one.
pub const ACCURACY: &str = "accuracy";

/// Entries of summaries that are the same for all cases.
const LABELS: [&str; 4] = ["task", "title", "units", "version"];

/// What is kept of a case.
#[derive(Debug, Clone, PartialEq)]
pub enum Keep {
    /// An entry of the summary, by its path.
    Entry(String),
    /// A variable at places along its coordinate.
    Curve {
        /// Its name.
        variable: String,
        /// Its name for people.
        long_name: String,
        /// What it measures.
        quantity: Quantity,
        /// The name of its coordinate, and what that measures.
        along: (String, Quantity),
        /// The places.
        places: Vec<f64>,
    },
}

/// The schema of the summaries of a scenario.
#[derive(Debug)]
pub struct Summaries(Value);

impl Summaries {
    /// That of its task.
    ///
    /// # Errors
    /// A scenario without a task.
    pub fn new(scenario: &Scenario) -> asperity::Result<Self> {
        let mut schema = schemars::schema_for!(Summary).to_value();
        let name = summary_name(scenario)?;
        for choices in ["oneOf", "anyOf"] {
            if let Some(choices) = schema[choices].as_array_mut() {
                choices.retain(|choice| choice["properties"]["task"]["const"] == name);
            }
        }
        Ok(Self(schema))
    }

    /// The entry at a path.
    pub fn find(&self, path: &str) -> Option<Entry> {
        schema::find(&self.0, path)
    }
}

/// The name of the task in a summary.
fn summary_name(scenario: &Scenario) -> asperity::Result<&'static str> {
    let task = scenario.task()?;
    Ok(match (task, &scenario.interface, &scenario.block) {
        (Task::Drive(_) | Task::Protocol(_), Some(_), _) => "interface_drive",
        (Task::Protocol(_), None, Some(_)) => "block_protocol",
        _ => task.name(),
    })
}

/// Checks what a scenario keeps.
///
/// # Errors
/// A name that the task does not have.
pub fn keep(scenario: &Scenario, kept: &[SweepKept], summaries: &Summaries) -> asperity::Result<Vec<Keep>> {
    let mut found = Vec::new();
    for (i, kept) in kept.iter().enumerate() {
        let refused = |expected: String, name: &str| {
            Err(asperity::Error::invalid(format!("sweep.keep.{i}"), expected, format!("\"{name}\"")))
        };
        match kept {
            SweepKept::Entry(path) => {
                if summaries.find(path).is_none() {
                    let mut names = schema::names(&summaries.0, &summaries.0);
                    names.retain(|name| !LABELS.contains(&name.as_str()));
                    return refused(format!("one of {}", names.join(", ")), path);
                }
                found.push(Keep::Entry(path.clone()));
            }
            SweepKept::Curve(curve) => {
                let declared = declared(scenario)?;
                let Some(variable) = declared.get(&curve.variable) else {
                    let names: Vec<_> = curves(&declared).map(|variable| variable.name.as_str()).collect();
                    return refused(format!("one of {}", names.join(", ")), &curve.variable);
                };
                let along = coordinate(&declared, variable).filter(|along| rises(scenario, &along.0));
                let Some(along) = along else {
                    return refused("a variable along one rising coordinate".to_owned(), &curve.variable);
                };
                found.push(Keep::Curve {
                    variable: variable.name.clone(),
                    long_name: variable.long_name.clone(),
                    quantity: variable.quantity,
                    along,
                    places: curve.at.numbers().unwrap_or_default(),
                });
            }
        }
    }
    if !found.iter().any(|kept| matches!(kept, Keep::Entry(path) if path == ACCURACY)) {
        found.push(Keep::Entry(ACCURACY.to_owned()));
    }
    Ok(found)
}

/// Whether curves along a coordinate are kept: neither along a drive that turns nor of several temperatures.
fn rises(scenario: &Scenario, along: &str) -> bool {
    let turns = scenario.drive.as_ref().is_some_and(|drive| drive.turning_points.is_some());
    let several = scenario.velocity_curve.as_ref().is_some_and(|curve| !curve.temperatures.is_empty());
    !(turns && along == "drive" || several && along == "velocity")
}

/// The variables of the task.
fn declared(scenario: &Scenario) -> asperity::Result<Record> {
    let name = summary_name(scenario)?;
    let all = task::columns()
        .into_iter()
        .filter(|(task, _)| *task == name || task.starts_with("interface") && name == "interface_drive");
    Ok(Record { variables: all.flat_map(|(_, record)| record.variables).collect() })
}

/// The variables that have one coordinate.
fn curves(declared: &Record) -> impl Iterator<Item = &asperity::record::Variable> {
    declared.variables.iter().filter(|variable| coordinate(declared, variable).is_some())
}

/// The coordinate of a variable along one dimension.
fn coordinate(declared: &Record, variable: &asperity::record::Variable) -> Option<(String, Quantity)> {
    task::coordinate(declared, variable).map(|found| (found.name.clone(), found.quantity))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input;
    use std::path::Path;

    const CONTACTS: &str = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\n";
    const TASKS: [&str; 7] = [
        "pull = { distance = 3.0, points = 31, derivatives = true }\nensemble = { size = 100 }\ncontacts.normal_load = 2.0",
        "drive.distance = 12.0\nblock = { stiffness = 0.6, slip = 'reset' }\nensemble = { size = 100 }",
        "drive.force_to = 2.0",
        "velocity_curve = { from = 0.1, to = 1.0, points = 2 }\ncontacts.temperature = { energy = 0.01, attempt_rate = 1.0 }",
        "[[protocol]]\nvelocity = 1.0\ndistance = 3.0\n[[protocol]]\nvelocity = 2.0\ndistance = 1.0",
        "[spectrum]",
        "block = { stiffness = 1.0, slip = 'overdamped' }\n[stability]",
    ];

    /// The paths of all entries that are neither tables nor lists.
    fn leaves(path: &str, value: &Value, found: &mut Vec<String>) {
        let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") };
        match value {
            Value::Object(entries) => {
                entries.iter().for_each(|(key, entry)| leaves(&below(key), entry, found))
            }
            Value::Array(items) => {
                items.iter().enumerate().for_each(|(i, item)| leaves(&below(&i.to_string()), item, found));
            }
            _ => found.push(path.to_owned()),
        }
    }

    #[test]
    fn every_entry_of_a_summary_is_known_before_it_is_computed() {
        for task in TASKS {
            let input = input::parse(&format!("{CONTACTS}{task}"), "text", Path::new(""), &[]);
            let scenario = input.unwrap_or_else(|error| panic!("{task}: {error}")).scenario;
            let summaries = Summaries::new(&scenario).unwrap();
            let summary = serde_json::to_value(crate::run(&scenario, &mut ()).unwrap().summary).unwrap();
            let mut found = Vec::new();
            leaves("", &summary, &mut found);
            assert!(found.len() > 5, "{task}: {found:?}");
            for path in found.into_iter().filter(|path| !LABELS.contains(&path.as_str())) {
                assert!(summaries.find(&path).is_some(), "{task}: {path}");
            }
            for wrong in ["nothing", "kinetic_friction.of", "title.0"] {
                assert!(summaries.find(wrong).is_none(), "{task}: {wrong}");
            }
        }
    }

    #[test]
    fn entries_have_their_dimension() {
        let input = input::parse(&format!("{CONTACTS}{}", TASKS[1]), "text", Path::new(""), &[]).unwrap();
        let summaries = Summaries::new(&input.scenario).unwrap();
        let quantity = |path: &str| summaries.find(path).unwrap().quantity;
        assert_eq!(quantity("period"), Some(Quantity::Length));
        assert_eq!(quantity("static_friction.force"), Some(Quantity::Force));
        assert_eq!(quantity("critical_stiffness"), Some(Quantity::Stiffness));
        assert_eq!(quantity("first_instability.position"), Some(Quantity::Length));
        assert!(summaries.find("stick_slip.0.persistent_stiffness").is_none(), "of another task");
    }
}
