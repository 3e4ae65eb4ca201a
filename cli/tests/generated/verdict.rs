//! What must hold however a scenario is drawn.

use std::path::Path;

use serde_json::Value as Json;

use super::agreement;
use super::child::{self, Ended, Limits};

/// Nulls in `summary.json` that are documented: nothing was drawn at random; a length that is not known.
const NULLS: [&str; 4] = ["seed", "relaxation_length", "critical_stiffness", "derivatives.relaxation_length"];
/// Columns in which a cell may be no number: of point masses, what they are of, and what that has no place along.
const WORDS: [(&str, &str); 3] =
    [("atoms.csv", "distribution"), ("atoms.csv", "stretch"), ("atoms.csv", "position")];

/// Columns that may be infinite: where contacts break at one stretch, a pull is unstable behind any spring.
const INFINITE: [&str; 2] = ["critical_stiffness", "critical_stiffness_sliding"];

/// Columns that may be NaN: a slider that fails while the force is raised does not creep, and has no time to failure where it does
/// not fail.
const UNREACHED: [(&str, &str); 8] = [
    ("creep_curve.csv", "creep_time"),
    ("creep_curve.csv", "creep_position"),
    ("creep_curve.csv", "creep_velocity"),
    ("static_fatigue.csv", "failure_time"),
    ("static_fatigue.csv", "failure_time_error"),
    ("static_fatigue.csv", "final_velocity"),
    ("static_fatigue.csv", "slowest_velocity"),
    ("static_fatigue.csv", "slowest_time"),
];

/// What came of a command.
pub struct Verdict {
    /// Whether the scenario was accepted.
    pub accepted: bool,
    /// How the program ended.
    pub ended: Ended,
    /// What should not have happened.
    pub failures: Vec<String>,
    /// How far the master equation is from an ensemble, in standard errors.
    pub deviation: Option<f64>,
}

/// Checks the scenario in a folder.
pub fn check(folder: &Path, aside: &Path, limits: Limits) -> Verdict {
    let ended = child::run(&["check", "scenario.toml"], folder, aside, limits);
    let mut failures = ending(&ended, &[0, 2]);
    failures.extend(nothing_written(folder));
    Verdict { accepted: ended.code() == Some(0), failures, ended, deviation: None }
}

/// Runs the scenario in a folder, into the folder `out` beside it, with an option.
pub fn run(folder: &Path, aside: &Path, limits: Limits, option: &str) -> Verdict {
    let arguments = ["run", "scenario.toml", "-o", "out", "--threads", "2", option];
    let ended = child::run(&arguments, folder, aside, limits);
    let mut failures = ending(&ended, &[0, 1, 2, 130]);
    let accepted = ended.code() == Some(0);
    failures.extend(match ended.code() {
        Some(0) => no_numbers(&folder.join("out")),
        // An interface that is stopped when its time is over leaves where it was.
        Some(130) => {
            written(folder).filter(|name| !name.starts_with("out.checkpoint.")).map(was_written).collect()
        }
        _ => nothing_written(folder),
    });
    Verdict { accepted, failures, ended, deviation: agreement::deviation(&folder.join("out")) }
}

/// What is wrong with the end itself.
fn ending(ended: &Ended, codes: &[i32]) -> Vec<String> {
    let mut failures = Vec::new();
    match (ended.status, ended.code(), ended.signal()) {
        (None, ..) => failures.push("it waits for ever".to_owned()),
        (_, Some(code), _) if !codes.contains(&code) => failures.push(format!("exit code {code}")),
        // SIGXCPU
        (.., Some(24)) => failures.push(format!("no end after {} s", ended.seconds)),
        (.., Some(signal)) => failures.push(format!("ended by signal {signal}")),
        _ => {}
    }
    let said = ["panicked", "overflowed its stack", "memory allocation"];
    failures.extend(said.into_iter().filter(|words| ended.errors.contains(words)).map(|words| {
        let line = ended.errors.lines().find(|line| line.contains(words)).unwrap_or_default();
        format!("it says: {line}")
    }));
    if matches!(ended.code(), Some(1 | 2)) && ended.errors.trim().is_empty() {
        failures.push("no message".to_owned());
    }
    failures
}

/// What is in the folder beside the scenario.
fn written(folder: &Path) -> impl Iterator<Item = String> {
    let entries = std::fs::read_dir(folder).expect("the folder");
    let names = entries.map(|entry| entry.expect("an entry").file_name().display().to_string());
    names.filter(|name| name != "scenario.toml")
}

fn was_written(name: String) -> String {
    format!("{name} was written")
}

fn nothing_written(folder: &Path) -> Vec<String> {
    written(folder).map(was_written).collect()
}

/// Places in the results where a number is reported that is none.
fn no_numbers(results: &Path) -> Vec<String> {
    let mut failures = Vec::new();
    let text = std::fs::read_to_string(results.join("summary.json")).unwrap_or_default();
    match serde_json::from_str(&text) {
        Ok(summary) => nulls(&summary, "", &mut failures),
        Err(error) => failures.push(format!("summary.json: {error}")),
    }
    let names =
        std::fs::read_dir(results).into_iter().flatten().filter_map(Result::ok).map(|entry| entry.path());
    for path in names.filter(|path| path.extension().is_some_and(|extension| extension == "csv")) {
        cells(&path, &mut failures);
    }
    failures
}

fn nulls(value: &Json, path: &str, failures: &mut Vec<String>) {
    match value {
        Json::Null if !NULLS.contains(&path) => failures.push(format!("summary.json: {path} is null")),
        Json::Object(table) => {
            for (key, value) in table {
                nulls(value, &if path.is_empty() { key.clone() } else { format!("{path}.{key}") }, failures);
            }
        }
        Json::Array(items) => items.iter().for_each(|item| nulls(item, path, failures)),
        _ => {}
    }
}

fn cells(path: &Path, failures: &mut Vec<String>) {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let name = path.file_name().unwrap_or_default().display().to_string();
    let mut rows = text.lines();
    let header: Vec<_> = rows.next().unwrap_or_default().split(',').collect();
    for (number, row) in rows.enumerate() {
        for (column, cell) in header.iter().zip(row.split(',')) {
            let infinite = cell == "inf" && INFINITE.contains(column);
            let unreached = cell == "NaN" && UNREACHED.contains(&(&name, column));
            let allowed = WORDS.contains(&(&name, column)) || infinite || unreached;
            if !allowed && !cell.parse().is_ok_and(f64::is_finite) {
                failures.push(format!("{name}: {column} is {cell:?} in row {}", number + 1));
                return;
            }
        }
    }
}
