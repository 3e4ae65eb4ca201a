//! `sweep.nc`: the data set of a sweep as NetCDF-4, with labels, units, failures and the scenario that reproduces it.
//!
//! The file is assembled without the numbers that were kept, for which places are made behind it; they are written there a piece
//! at a time, as those of `result.nc`.

use std::io::{self, Write};

use netcdf_writer::{DimensionId, NcFileBuilder, NcWriteFormat, NcWriteOptions, VariableId};

use super::dataset::{Axis, Dataset, Labelled, Values};
use super::error::Result;
use crate::output::{self, Array, Attribute, Place, common, place, text, write_numbers};

/// The attributes of the whole.
pub fn attributes(dataset: &Dataset) -> Vec<(String, Attribute)> {
    let mut found = common();
    let text = |text: &str| Attribute::Text(text.to_owned());
    found.push(("title".into(), text(&dataset.title)));
    found.push(("version".into(), text(env!("CARGO_PKG_VERSION"))));
    found.push(("sweep".into(), text(&dataset.hash)));
    found.push(("cases".into(), Attribute::Whole(dataset.cases() as i64)));
    found.push(("failed".into(), Attribute::Whole(dataset.failed as i64)));
    found
}

/// The file `sweep.nc` without the numbers that were kept, and these numbers.
pub(super) struct Assembled<'a> {
    bytes: Vec<u8>,
    numbers: Vec<&'a Values>,
}

/// Assembles the file; the same data set gives the same bytes.
///
/// # Errors
/// None is expected: the names and lengths of a sweep are valid.
pub(super) fn assemble(dataset: &Dataset) -> Result<Assembled<'_>> {
    let mut file = NcFileBuilder::new();
    for (name, attribute) in attributes(dataset) {
        file.add_attribute(name, attribute.into())?;
    }
    let scenario = file.add_string_variable("scenario", &[])?;
    file.write_string_variable(scenario, &[&dataset.scenario])?;
    file.add_variable_attribute(scenario, "long_name", text("scenario, TOML"))?;
    let mut dimensions = Vec::new();
    for axis in dataset.dimensions() {
        dimensions.push((axis, file.add_dimension(&axis.name, axis.length as u64)?));
    }
    for variable in dataset.dimensions().flat_map(|axis| &axis.coordinates) {
        let id = add(&mut file, (variable, ""), &dimensions)?;
        if let Values::Numbers(values) = &variable.values {
            file.write_variable(id, values)?;
        }
    }
    let further = dataset.axes.iter().flat_map(|axis| &axis.coordinates[1..]);
    let further: Vec<&str> = further.map(|coordinate| coordinate.name.as_str()).collect();
    let further = further.join(" ");
    let (mut arrays, mut numbers) = (Vec::new(), Vec::new());
    for variable in &dataset.variables {
        let id = add(&mut file, (variable, &further), &dimensions)?;
        if !matches!(variable.values, Values::Texts(_)) {
            // An array without values, which are NaN until they are placed.
            file.set_variable_fill_value(id, f64::NAN)?;
            arrays.push(array(variable, &dimensions));
            numbers.push(&variable.values);
        }
    }
    let mut bytes = file.to_vec(NcWriteOptions { format: NcWriteFormat::Nc4 })?.1;
    place(&mut bytes, &arrays).ok_or(output::Error::Unplaced)?;
    Ok(Assembled { bytes, numbers })
}

impl Assembled<'_> {
    /// Writes the file.
    ///
    /// # Errors
    /// The system refuses to write it, or to read numbers.
    pub(super) fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        to.write_all(&self.bytes)?;
        self.numbers
            .iter()
            .try_for_each(|values| write_numbers(to, values.count(), |from, count| values.read(from, count)))
    }
}

/// The place of a variable in the file.
fn array<'a>(variable: &'a Labelled, dimensions: &[(&Axis, DimensionId)]) -> Array<'a> {
    let length = |name: &String| {
        dimensions.iter().find(|(axis, _)| axis.name == *name).map_or(0, |found| found.0.length)
    };
    let shape = variable.dimensions.iter().map(|name| length(name) as u64).collect();
    Array { name: &variable.name, shape, size: size_of::<f64>() as u64, values: Place::Behind }
}

/// Adds a variable with its labels, and with its words if it has any; `places` are the coordinates at which it is given, beside
/// those named like its dimensions.
fn add(
    file: &mut NcFileBuilder,
    (variable, places): (&Labelled, &str),
    dimensions: &[(&Axis, DimensionId)],
) -> Result<VariableId> {
    let of = |name: &String| dimensions.iter().find(|(axis, _)| axis.name == *name).map(|&(_, id)| id);
    let along: Vec<DimensionId> = variable.dimensions.iter().filter_map(of).collect();
    let id = match &variable.values {
        Values::Texts(values) => {
            let id = file.add_string_variable(&variable.name, &along)?;
            file.write_string_variable(id, values)?;
            id
        }
        _ => file.add_variable::<f64>(&variable.name, &along)?,
    };
    let labels = [
        ("coordinates", places),
        ("long_name", &variable.long_name),
        ("units", &variable.units),
        ("key", &variable.key),
    ];
    for (name, label) in labels.into_iter().filter(|(_, label)| !label.is_empty()) {
        file.add_variable_attribute(id, name, text(label))?;
    }
    Ok(id)
}
