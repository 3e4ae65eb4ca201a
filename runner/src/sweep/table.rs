//! `sweep.csv`: a row for each case, with its values of the axes, what was kept of it, and why it failed.

use std::io::{self, Write};

use super::dataset::{Dataset, Labelled, Values};
use crate::output::shortest;

/// Writes the table. Curves are in `sweep.nc` alone.
///
/// # Errors
/// The system refuses.
pub(super) fn write(dataset: &Dataset, to: &mut dyn Write) -> io::Result<()> {
    let along = dataset.axes.len();
    let columns: Vec<&Labelled> = dataset.variables.iter().filter(|v| v.dimensions.len() == along).collect();
    let coordinates = || dataset.axes.iter().flat_map(|axis| &axis.coordinates);
    let names: Vec<_> = coordinates().chain(columns.iter().copied()).map(|v| quoted(&v.name)).collect();
    writeln!(to, "{}", names.join(","))?;
    for case in 0..dataset.cases() {
        let mut cells = Vec::new();
        let mut stride = dataset.cases();
        for axis in &dataset.axes {
            stride /= axis.length;
            let index = case / stride % axis.length;
            cells.extend(axis.coordinates.iter().map(|coordinate| cell(&coordinate.values, index)));
        }
        cells.extend(columns.iter().map(|column| cell(&column.values, case)));
        writeln!(to, "{}", cells.join(","))?;
    }
    Ok(())
}

fn cell(values: &Values, place: usize) -> String {
    match values {
        Values::Numbers(numbers) => shortest(numbers[place]),
        Values::Texts(texts) => quoted(&texts[place]),
        // Only curves are in files.
        Values::Stored(_) => String::new(),
    }
}

/// A text in quotes where it has commas, quotes or lines (RFC 4180).
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
