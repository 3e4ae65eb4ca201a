//! CSV tables: a header, then numbers in the shortest form that reads back exactly.

use std::borrow::Cow;
use std::io::{self, Write};

use asperity::record::{CsvTable, Record, Variable};
use asperity::task;

use super::view::{Variables, View};

/// `value` in the shortest form that reads back exactly.
pub fn shortest(value: f64) -> String {
    let mut text = Vec::new();
    write_shortest(value, &mut text).expect("memory does not refuse it");
    String::from_utf8(text).expect("digits are text")
}

/// Numbers below 1e-5 and from 1e16 on have an exponent, in the form of the standard library; whole numbers have no decimal point.
fn write_shortest(value: f64, to: &mut Vec<u8>) -> io::Result<()> {
    if !(1e-5..1e16).contains(&value.abs()) && value != 0.0 {
        return write!(to, "{value:e}");
    }
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format_finite(value);
    to.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
    Ok(())
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
const EVENT: [&str; 21] = [
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
    "age",
];

/// Names of further columns of slips in time.
const IN_TIME: [&str; 4] = ["time", "duration", "velocity", "strengthening"];

/// A table of a result.
pub(super) struct Table<'a> {
    /// Name of the file.
    pub file: &'static str,
    content: Content<'a>,
}

enum Content<'a> {
    Text(String),
    /// Columns, each with its header; rows numbered from 1 if there is a header for the number.
    Columns(Option<&'static str>, Vec<(String, Column<'a>)>),
}

/// A column of a table.
enum Column<'a> {
    /// Row by row.
    Variable(View<'a>),
    /// Repeated along the dimensions of another variable.
    Repeated(&'a Record, &'a Variable, &'a Variable),
}

/// Rows that are written at once.
const ROWS: usize = 1 << 12;

/// The tables of a result that have any rows.
pub(super) fn tables(variables: Variables<'_>) -> impl Iterator<Item = Table<'_>> {
    let record = variables.record;
    let others = [
        ("atoms.csv", atoms(record).map(Content::Text)),
        ("trace.csv", trace(variables, "")),
        ("events.csv", catalogue(variables).or_else(|| events(variables, ""))),
        ("ensemble_trace.csv", trace(variables, "ensemble_")),
        ("ensemble_events.csv", events(variables, "ensemble_")),
        ("sizes.csv", sizes(variables)),
    ];
    let declared = task::tables().map(move |table| (table.file, declared(record, table)));
    declared.chain(others).filter_map(|(file, content)| content.map(|content| Table { file, content }))
}

impl Table<'_> {
    /// Writes the table.
    ///
    /// # Errors
    /// The system refuses to write it, or to read values.
    pub(super) fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        let (number, columns) = match &self.content {
            Content::Text(text) => return to.write_all(text.as_bytes()),
            Content::Columns(number, columns) => (number, columns),
        };
        let header = number.iter().copied().chain(columns.iter().map(|(header, _)| header.as_str()));
        writeln!(to, "{}", header.collect::<Vec<_>>().join(","))?;
        let rows = columns.first().map_or(0, |(_, column)| column.len());
        let mut text = Vec::new();
        for from in (0..rows).step_by(ROWS) {
            let block = columns.iter().map(|(_, column)| column.read(from, ROWS));
            let block: Vec<Cow<'_, [f64]>> = block.collect::<io::Result<_>>()?;
            text.clear();
            for row in 0..block[0].len() {
                if number.is_some() {
                    write!(text, "{},", from + row + 1)?;
                }
                for (place, column) in block.iter().enumerate() {
                    if place > 0 {
                        text.push(b',');
                    }
                    write_shortest(column[row], &mut text)?;
                }
                text.push(b'\n');
            }
            to.write_all(&text)?;
        }
        Ok(())
    }
}

impl<'a> Column<'a> {
    fn len(&self) -> usize {
        match self {
            Self::Variable(view) => view.len(),
            Self::Repeated(_, needed, _) => needed.values.len(),
        }
    }

    fn read(&self, from: usize, count: usize) -> io::Result<Cow<'a, [f64]>> {
        match self {
            Self::Variable(view) => view.read(from, count),
            Self::Repeated(record, needed, column) => {
                let rows = from..needed.values.len().min(from + count);
                Ok(rows.map(|row| column.values[place(record, needed, row, column)]).collect())
            }
        }
    }
}

/// A table that a task declares.
fn declared<'a>(record: &'a Record, table: &CsvTable) -> Option<Content<'a>> {
    let needed = record.get(table.needed.name)?;
    let columns = table.columns.iter().filter_map(|column| record.get(column.name));
    let columns = columns.map(|column| {
        let like = column.dimensions == needed.dimensions;
        let values = if like {
            Column::Variable(View::Kept(column))
        } else {
            Column::Repeated(record, needed, column)
        };
        (column.name.clone(), values)
    });
    Some(Content::Columns(None, columns.collect()))
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

fn trace<'a>(variables: Variables<'a>, prefix: &str) -> Option<Content<'a>> {
    if prefix.is_empty() && variables.get("spring_force").is_none() {
        // An interface has several springs, single contacts have no positions, and only some tasks have a time.
        let optional = ["position", "time", "velocity", "friction_coefficient"].map(same);
        return table(variables, None, &["drive", "force"].map(same), &optional);
    }
    let column = |name: &str| (name.to_owned(), format!("{prefix}{name}"));
    let timed = ["time", "velocity", "free", "friction_coefficient"].map(column);
    let ensemble = ["ensemble_force", "ensemble_error"].map(same);
    // An ensemble at the same points is added to the table; one with its own points gets a table of its own.
    let beside = variables.get("ensemble_drive").map_or(&ensemble[..], |_| &[]);
    let optional = [&timed[..], beside].concat();
    table(variables, None, &["drive", "position", "force", "spring_force"].map(column), &optional)
}

/// The header of the numbers of events.
const NUMBER: Option<&str> = Some("event");

fn events<'a>(variables: Variables<'a>, prefix: &str) -> Option<Content<'a>> {
    variables.get(&format!("{prefix}spring_force"))?;
    let column = |name: &str| variables.get(&format!("{prefix}{name}"));
    if column("velocity").is_some() && column("event_drive").is_none() {
        return None;
    }
    let named = |name: &str| (name.to_owned(), format!("{prefix}event_{name}"));
    let none = || Content::Text(format!("event,{}\n", SLIP.join(",")));
    Some(table(variables, NUMBER, &SLIP.map(named), &IN_TIME.map(named)).unwrap_or_else(none))
}

/// The events of an interface.
fn catalogue(variables: Variables<'_>) -> Option<Content<'_>> {
    let named = |name: &str| (name.to_owned(), format!("event_{name}"));
    variables.get("event_epicentre")?;
    table(variables, NUMBER, &[], &EVENT.map(named))
}

fn sizes(variables: Variables<'_>) -> Option<Content<'_>> {
    let column = |name: &str| (name.to_owned(), format!("size_{name}"));
    let contacts = [("contacts".to_owned(), "size".to_owned())];
    table(variables, None, &[&contacts[..], &["events", "slip", "drop"].map(column)].concat(), &[])
}

/// The columns `required`, and those of `optional` that exist, under their headers.
fn table<'a>(
    variables: Variables<'a>,
    number: Option<&'static str>,
    required: &[(String, String)],
    optional: &[(String, String)],
) -> Option<Content<'a>> {
    let get = |(header, name): &(String, String)| {
        variables.get(name).map(|view| (header.clone(), Column::Variable(view)))
    };
    let needed: Option<Vec<_>> = required.iter().map(get).collect();
    Some(Content::Columns(number, needed?.into_iter().chain(optional.iter().filter_map(get)).collect()))
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

    /// There are as many digits as the standard library writes; where two decimal numbers are equally close, it may choose the other.
    #[test]
    fn numbers_read_back_exactly_and_stay_short() {
        let few = [0.0, -0.0, 0.1, 1.0, 1e-5, 9.9e-6, 1e300, -5e-324, 123456.789, 1e15, 1e16, f64::MAX];
        // Multiples of an odd number run through all bit patterns.
        let many = (0..100_000_u64).map(|i| f64::from_bits(i.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        let ordinary = (0..100_000_u32).map(|i| f64::from(i) * 0.025 - 7.0);
        for value in few.into_iter().chain(many).chain(ordinary) {
            let text = shortest(value);
            let fixed = value == 0.0 || (1e-5..1e16).contains(&value.abs());
            let standard = if fixed { format!("{value}") } else { format!("{value:e}") };
            assert_eq!(text.len(), standard.len(), "{text} {standard}");
            assert!(value.is_nan() || text.parse::<f64>().unwrap().to_bits() == value.to_bits(), "{text}");
            assert!(text.len() <= 24, "{text}");
        }
    }
}
