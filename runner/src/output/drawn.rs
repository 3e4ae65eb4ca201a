//! What pictures show of results that may be larger than the memory: of arrays with several dimensions some rows, evenly spaced;
//! what does not fit even so is left out.

use std::collections::BTreeMap;
use std::io;

use asperity::record::{Record, Variable};

use super::columns::StoredColumns;
use super::view::Variables;

/// A variable, and how many values it has.
pub(super) struct Described {
    /// What it is, without values.
    pub variable: Variable,
    /// Number of values.
    pub length: usize,
}

/// What is shown.
pub(super) struct Selection {
    /// The rows of each dimension that comes first in an array with several dimensions: their indices, and how many there are.
    rows: BTreeMap<String, (Vec<usize>, usize)>,
    /// Dimensions that are left out.
    without: Vec<String>,
}

impl Selection {
    /// Rows of these variables that take `most` bytes.
    pub(super) fn of(variables: &[Described], most: u64) -> Self {
        let mut selection = Self { rows: BTreeMap::new(), without: Vec::new() };
        if bytes(variables.iter().map(|v| v.length).sum()) <= most {
            return selection;
        }
        let arrays = variables.iter().filter(|v| v.variable.dimensions.len() > 1);
        let mut lengths: BTreeMap<&str, (usize, u64)> = BTreeMap::new();
        for array in arrays {
            let first = &array.variable.dimensions[0];
            let rows = count(variables, first);
            let row = bytes(array.length) / rows.max(1) as u64;
            lengths.entry(first).or_insert((rows, 0)).1 += row;
        }
        // Half of the bytes for arrays, in equal parts.
        let part = most / 2 / lengths.len().max(1) as u64;
        for (&name, &(rows, row)) in &lengths {
            let shown = usize::try_from(part / row.max(1)).unwrap_or(rows).clamp(1, rows.max(1));
            selection.rows.insert(name.to_owned(), (spaced(rows, shown), rows));
        }
        // The rest for columns, those of short dimensions first.
        let mut columns: BTreeMap<&str, usize> = BTreeMap::new();
        for column in variables.iter().filter(|v| v.variable.dimensions.len() == 1) {
            let name = column.variable.dimensions[0].as_str();
            if !selection.rows.contains_key(name) {
                *columns.entry(name).or_default() += column.length;
            }
        }
        let mut columns: Vec<_> = columns.into_iter().collect();
        columns.sort_by_key(|&(_, values)| values);
        let mut left = most / 2;
        for (name, values) in columns {
            match left.checked_sub(bytes(values)) {
                Some(rest) => left = rest,
                None => selection.without.push(name.to_owned()),
            }
        }
        selection
    }

    /// The variable with what is shown of it, if anything is; `read` gives values from an index on.
    pub(super) fn shown<E>(
        &self,
        described: Described,
        mut read: impl FnMut(usize, usize) -> Result<Vec<f64>, E>,
    ) -> Result<Option<Variable>, E> {
        let Described { variable, length } = described;
        if variable.dimensions.iter().any(|name| self.without.contains(name)) {
            return Ok(None);
        }
        let rows = variable.dimensions.first().and_then(|name| self.rows.get(name));
        let values = match rows {
            None => read(0, length)?,
            Some((rows, all)) => {
                let row = length / (*all).max(1);
                let mut values = Vec::with_capacity(rows.len() * row);
                for index in rows {
                    values.extend(read(index * row, row)?);
                }
                values
            }
        };
        Ok(Some(Variable { values, ..variable }))
    }
}

/// What pictures show of the results of a run, some of whose columns are `stored` in files, in about `most` bytes.
///
/// # Errors
/// The system refuses to read a file.
pub fn drawn(record: &Record, stored: &StoredColumns, most: u64) -> io::Result<Record> {
    of_variables(Variables { record, stored: Some(stored) }, most)
}

fn of_variables(variables: Variables<'_>, most: u64) -> io::Result<Record> {
    let described =
        || variables.all().map(|view| Described { variable: labels(view.variable()), length: view.len() });
    let selection = Selection::of(&described().collect::<Vec<_>>(), most);
    let mut record = Record::default();
    for (view, described) in variables.all().zip(described()) {
        let read = |from, count| view.read(from, count).map(|values| values.into_owned());
        record.variables.extend(selection.shown(described, read)?);
    }
    Ok(record)
}

/// The same variable without values.
fn labels(variable: &Variable) -> Variable {
    let Variable { name, long_name, quantity, dimensions, .. } = variable;
    Variable {
        name: name.clone(),
        long_name: long_name.clone(),
        quantity: *quantity,
        dimensions: dimensions.clone(),
        values: Vec::new(),
    }
}

/// The length of a dimension, from a variable along it alone.
fn count(variables: &[Described], dimension: &str) -> usize {
    variables.iter().find(|v| v.variable.dimensions == [dimension]).map_or(1, |v| v.length)
}

/// So many of the indices from 0 to `all`, evenly spaced, with both ends.
fn spaced(all: usize, shown: usize) -> Vec<usize> {
    (0..shown).map(|i| if shown > 1 { i * (all - 1) / (shown - 1) } else { all.saturating_sub(1) }).collect()
}

fn bytes(values: usize) -> u64 {
    (values * size_of::<f64>()) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity::record::Quantity;

    fn record() -> Record {
        let mut record = Record::default();
        let numbers = |count: usize| (0..count).map(|i| i as f64).collect::<Vec<_>>();
        record.push("map_drive", "", Quantity::Length, &["map_drive"], numbers(101));
        record.push("cell", "", Quantity::Count, &["cell"], numbers(10));
        record.push("cell_force", "", Quantity::Force, &["map_drive", "cell"], numbers(1010));
        record.push("event_drive", "", Quantity::Length, &["event"], numbers(500));
        record
    }

    fn shown(most: u64) -> Record {
        of_variables(Variables { record: &record(), stored: None }, most).unwrap()
    }

    #[test]
    fn what_fits_is_shown_as_it_is() {
        assert_eq!(shown(8 * 2000), record());
    }

    /// Half of 12 000 bytes are 75 rows of 10 values.
    #[test]
    fn of_maps_some_rows_are_shown_and_columns_as_they_are() {
        let found = shown(12_000);
        let drives = found.values("map_drive").unwrap();
        assert_eq!((drives.len(), drives[0], drives[74]), (75, 0.0, 100.0));
        assert_eq!(found.values("cell_force").unwrap().len(), 750);
        for (row, drive) in drives.iter().enumerate() {
            assert_eq!(found.row("cell_force", row).unwrap()[3], 10.0 * drive + 3.0);
        }
        assert_eq!(found.values("event_drive").unwrap().len(), 500);
    }

    #[test]
    fn columns_that_do_not_fit_are_left_out() {
        let found = shown(6_000);
        assert!(found.get("event_drive").is_none());
        assert_eq!(found.values("cell").unwrap().len(), 10);
    }
}
