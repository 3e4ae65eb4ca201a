//! CSV tables: a header, then numbers in the shortest form that reads back exactly.

use asperity::record::{CsvTable, Record, Variable};
use asperity::task;

/// `value` in the shortest form that reads back exactly.
pub fn shortest(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-5..1e16).contains(&size) { value.to_string() } else { format!("{value:e}") }
}

/// Names of the columns of slips.
const SLIP: [&str; 11] = [
    "drive",
    "position_before",
    "position_after",
    "position_turn",
    "force_before",
    "force_after",
    "drop",
    "slip",
    "broken_fraction",
    "dissipated_breaks",
    "dissipated_slip",
];

/// Names of the columns of events of an interface.
const EVENT: [&str; 20] = [
    "drive",
    "position_before",
    "position_after",
    "force_before",
    "force_after",
    "drop",
    "slip",
    "broken_fraction",
    "dissipated_breaks",
    "dissipated_slip",
    "time",
    "epicentre",
    "cells",
    "size",
    "area",
    "moment",
    "released",
    "duration",
    "front_speed_left",
    "front_speed_right",
];

/// Names of further columns of slips in time.
const IN_TIME: [&str; 4] = ["time", "duration", "velocity", "strengthening"];

/// The tables of a record that have any rows: name and text.
pub(super) fn tables(record: &Record) -> impl Iterator<Item = (&'static str, String)> {
    let others = [
        ("atoms.csv", atoms(record)),
        ("trace.csv", trace(record, "")),
        ("events.csv", catalogue(record).or_else(|| events(record, ""))),
        ("ensemble_trace.csv", trace(record, "ensemble_")),
        ("ensemble_events.csv", events(record, "ensemble_")),
        ("sizes.csv", sizes(record)),
    ];
    let declared = task::tables().map(|table| (table.file, declared(record, table)));
    declared.chain(others).filter_map(|(name, text)| text.map(|text| (name, text)))
}

/// A table that a task declares.
fn declared(record: &Record, table: &CsvTable) -> Option<String> {
    let needed = record.get(table.needed.name)?;
    let columns: Vec<_> = table.columns.iter().filter_map(|column| record.get(column.name)).collect();
    let header: Vec<_> = columns.iter().map(|column| column.name.as_str()).collect();
    let mut text = header.join(",") + "\n";
    for row in 0..needed.values.len() {
        let value = |column: &&Variable| shortest(column.values[place(record, needed, row, column)]);
        text += &columns.iter().map(value).collect::<Vec<_>>().join(",");
        text.push('\n');
    }
    Some(text)
}

/// The index in `column`, which may have fewer dimensions, of the value in the same row as the value `row` of `needed`.
fn place(record: &Record, needed: &Variable, row: usize, column: &Variable) -> usize {
    let (mut rest, mut stride, mut place) = (row, 1, 0);
    for dimension in needed.dimensions.iter().rev() {
        let length = record.length(dimension).unwrap_or(1).max(1);
        if column.dimensions.contains(dimension) {
            place += rest % length * stride;
            stride *= length;
        }
        rest /= length;
    }
    place
}

/// A column under the name of its variable.
fn same(name: &str) -> (String, String) {
    (name.to_owned(), name.to_owned())
}

fn trace(record: &Record, prefix: &str) -> Option<String> {
    if prefix.is_empty() && record.get("spring_force").is_none() {
        // An interface has several springs, single contacts have no positions, and only some tasks have a time.
        let optional = ["position", "time", "velocity", "friction_coefficient"].map(same);
        return table(record, &["drive", "force"].map(same), &optional);
    }
    let column = |name: &str| (name.to_owned(), format!("{prefix}{name}"));
    let timed = ["time", "velocity", "free", "friction_coefficient"].map(column);
    let ensemble = ["ensemble_force", "ensemble_error"].map(same);
    // An ensemble at the same points is added to the table; one with its own points gets a table of its own.
    let beside = record.get("ensemble_drive").map_or(&ensemble[..], |_| &[]);
    let optional = [&timed[..], beside].concat();
    table(record, &["drive", "position", "force", "spring_force"].map(column), &optional)
}

fn events(record: &Record, prefix: &str) -> Option<String> {
    record.get(&format!("{prefix}spring_force"))?;
    let column = |name: &str| record.get(&format!("{prefix}{name}"));
    if column("velocity").is_some() && column("event_drive").is_none() {
        return None;
    }
    let named = |name: &str| (name.to_owned(), format!("{prefix}event_{name}"));
    let text = table(record, &SLIP.map(named), &IN_TIME.map(named)).unwrap_or_else(|| SLIP.join(",") + "\n");
    Some(numbered(&text))
}

/// The events of an interface.
fn catalogue(record: &Record) -> Option<String> {
    let named = |name: &str| (name.to_owned(), format!("event_{name}"));
    record.get("event_epicentre")?;
    table(record, &[], &EVENT.map(named)).map(|text| numbered(&text))
}

/// The rows of a table, numbered from 1.
fn numbered(text: &str) -> String {
    let row = |(row, line): (usize, &str)| match row {
        0 => format!("event,{line}\n"),
        event => format!("{event},{line}\n"),
    };
    text.lines().enumerate().map(row).collect()
}

fn sizes(record: &Record) -> Option<String> {
    let column = |name: &str| (name.to_owned(), format!("size_{name}"));
    let contacts = [("contacts".to_owned(), "size".to_owned())];
    table(record, &[&contacts[..], &["events", "slip", "drop"].map(column)].concat(), &[])
}

/// The columns `required`, and those of `optional` that exist: their headers and their variables.
fn table(record: &Record, required: &[(String, String)], optional: &[(String, String)]) -> Option<String> {
    let get = |(header, name): &(String, String)| record.get(name).map(|variable| (header.clone(), variable));
    let needed: Option<Vec<_>> = required.iter().map(get).collect();
    let columns: Vec<_> = needed?.into_iter().chain(optional.iter().filter_map(get)).collect();
    let header: Vec<_> = columns.iter().map(|(header, _)| header.as_str()).collect();
    let mut text = header.join(",") + "\n";
    for row in 0..columns[0].1.values.len() {
        let cells: Vec<_> = columns.iter().map(|(_, column)| shortest(column.values[row])).collect();
        text += &cells.join(",");
        text.push('\n');
    }
    Some(text)
}

/// Point masses: the density to which they belong, and the dimension along which they are listed.
const ATOMS: [(&str, &str); 4] = [
    ("breaking_rate", "breaking_atom"),
    ("stretch_density", "stretch_atom"),
    ("steady_stretch_density", "steady_atom"),
    ("threshold_density", "threshold_atom"),
];

/// The point masses of all distributions: position of the pull and stretch, if they have these, and weight.
fn atoms(record: &Record) -> Option<String> {
    let mut rows = String::new();
    for (density, dimension) in ATOMS {
        let column = |name| record.values(&format!("{dimension}_{name}"));
        let cell = |name, row: usize| column(name).map_or(String::new(), |values| shortest(values[row]));
        for row in 0..record.length(dimension).unwrap_or(0) {
            let (position, stretch, weight) =
                (cell("position", row), cell("stretch", row), cell("weight", row));
            rows += &format!("{density},{position},{stretch},{weight}\n");
        }
    }
    (!rows.is_empty()).then(|| "distribution,position,stretch,weight\n".to_owned() + &rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_exactly_and_stay_short() {
        for value in [0.0, -0.0, 0.1, 1.0, 1e-5, 9.9e-6, 1e300, -5e-324, 123456.789, 1e16, f64::MAX] {
            let text = shortest(value);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
            assert!(text.len() <= 24, "{text}");
        }
    }
}
