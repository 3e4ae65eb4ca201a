//! One case: from its scenario to what is kept of it.

use asperity::scenario::Scenario;
use asperity::{monitor::Monitor, task};
use serde_json::Value as Json;

use super::keep::Keep;
use crate::input::Diagnostic;

/// A kept value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A number; NaN where there is none.
    Number(f64),
    /// A word, such as the regime.
    Word(String),
}

/// What is kept of a case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Kept {
    /// Entries of the summary by their paths.
    pub entries: Vec<(String, Value)>,
    /// The variables on their grids, in the order of the scenario.
    pub curves: Vec<Vec<f64>>,
}

/// A computed case.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// Its number.
    pub number: usize,
    /// What is kept of it, or why it failed.
    pub kept: Result<Kept, String>,
}

/// Computes a scenario, of which the monitor allows a part of the `memory` of all.
///
/// # Errors
/// A stop by the monitor, and a job that needs more than that part, but not more than the whole: other failures are what is kept
/// of the case.
pub fn compute(
    number: usize,
    scenario: Result<Scenario, Box<Diagnostic>>,
    keep: &[Keep],
    memory: u64,
    monitor: &mut dyn Monitor,
) -> asperity::Result<Case> {
    let kept = match scenario {
        Err(diagnostic) => Err(diagnostic.to_string()),
        Ok(scenario) => match crate::run(&scenario, monitor) {
            Ok(outcome) => {
                let summary = serde_json::to_value(&outcome.summary).expect("a summary is plain data");
                kept(keep, &summary, &outcome.record)
            }
            Err(asperity::Error::Stopped) => return Err(asperity::Error::Stopped),
            Err(error) if monitor.memory() < memory && fits_alone(&error, memory) => return Err(error),
            Err(error) => Err(error.to_string()),
        },
    };
    Ok(Case { number, kept })
}

/// Whether a job was refused that would fit into this memory.
fn fits_alone(error: &asperity::Error, memory: u64) -> bool {
    matches!(error, asperity::Error::TooLarge { needed, allowed, .. } if needed <= &memory && allowed < &memory)
}

/// What is kept of a result.
fn kept(keep: &[Keep], summary: &Json, record: &asperity::record::Record) -> Result<Kept, String> {
    let mut found = Kept::default();
    for kept in keep {
        match kept {
            Keep::Entry(path) => {
                let entry = path.split('.').try_fold(summary, |value, name| match value {
                    Json::Array(items) => items.get(name.parse::<usize>().ok()?),
                    other => other.get(name),
                });
                if let Some(entry) = entry {
                    flatten(path, entry, &mut found.entries);
                }
            }
            Keep::Curve { variable, places, .. } => {
                let values =
                    task::interpolated(record, variable, places).map_err(|error| error.to_string())?;
                found.curves.push(values);
            }
        }
    }
    Ok(found)
}

/// The numbers and words of an entry, by their paths.
fn flatten(path: &str, entry: &Json, into: &mut Vec<(String, Value)>) {
    let value = match entry {
        Json::Null => Value::Number(f64::NAN),
        Json::Bool(holds) => Value::Number(f64::from(u8::from(*holds))),
        Json::Number(number) => Value::Number(number.as_f64().unwrap_or(f64::NAN)),
        Json::String(word) if word == "infinite" => Value::Number(f64::INFINITY),
        Json::String(word) => Value::Word(word.clone()),
        Json::Array(items) => {
            return items
                .iter()
                .enumerate()
                .for_each(|(i, item)| flatten(&format!("{path}.{i}"), item, into));
        }
        Json::Object(entries) => {
            return entries.iter().for_each(|(key, entry)| flatten(&format!("{path}.{key}"), entry, into));
        }
    };
    into.push((path.to_owned(), value));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_kept_with_all_that_is_below_it() {
        let summary = serde_json::json!({ "a": { "b": [1.5, "infinite", null], "c": "smooth" }, "d": true });
        let entries = |path: &str| {
            let keep = [Keep::Entry(path.to_owned())];
            kept(&keep, &summary, &asperity::record::Record::default()).unwrap().entries
        };
        let number = |path: &str, value| (path.to_owned(), Value::Number(value));
        assert_eq!(entries("a.b.0"), [number("a.b.0", 1.5)]);
        assert_eq!(entries("d"), [number("d", 1.0)]);
        assert_eq!(entries("nothing.at.all"), []);
        let all = entries("a");
        assert_eq!(all[..2], [number("a.b.0", 1.5), number("a.b.1", f64::INFINITY)]);
        assert!(matches!(all[2].1, Value::Number(value) if value.is_nan()));
        assert_eq!(all[3], ("a.c".to_owned(), Value::Word("smooth".to_owned())));
    }
}
