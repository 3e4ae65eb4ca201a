//! `sweep.nc`: the data set of a sweep as NetCDF-4, with labels, units, failures and the scenario that reproduces it.

use netcdf_writer::{DimensionId, NcAttrValue, NcFileBuilder, NcWriteFormat, NcWriteOptions};

use super::dataset::{Dataset, Labelled, Values};
use super::error::Result;
use crate::output::{Attribute, common};

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

/// The bytes of `sweep.nc`; the same data set gives the same bytes.
///
/// # Errors
/// None is expected: the names and lengths of a sweep are valid.
pub fn encode(dataset: &Dataset) -> Result<Vec<u8>> {
    let mut file = NcFileBuilder::new();
    for (name, attribute) in attributes(dataset) {
        let value = match attribute {
            Attribute::Text(text) => NcAttrValue::Chars(text),
            Attribute::Whole(number) => NcAttrValue::Int64s(vec![number]),
            Attribute::Seed(number) => NcAttrValue::UInt64s(vec![number]),
            Attribute::Number(number) => NcAttrValue::Doubles(vec![number]),
        };
        file.add_attribute(name, value)?;
    }
    let scenario = file.add_string_variable("scenario", &[])?;
    file.write_string_variable(scenario, &[&dataset.scenario])?;
    file.add_variable_attribute(scenario, "long_name", text("scenario, TOML"))?;
    let mut dimensions = Vec::new();
    for axis in dataset.axes.iter().chain(&dataset.grids) {
        dimensions.push((axis.name.clone(), file.add_dimension(axis.name.clone(), axis.length as u64)?));
    }
    let coordinates = dataset.axes.iter().chain(&dataset.grids).flat_map(|axis| &axis.coordinates);
    for variable in coordinates.chain(&dataset.variables) {
        let places = others(dataset, variable);
        add(&mut file, variable, &dimensions, &places)?;
    }
    Ok(file.to_vec(NcWriteOptions { format: NcWriteFormat::Nc4 })?.1)
}

/// The coordinates at which a variable is given, beside those named like its dimensions.
fn others(dataset: &Dataset, variable: &Labelled) -> String {
    if !dataset.variables.iter().any(|other| other.name == variable.name) {
        return String::new();
    }
    let further = dataset.axes.iter().flat_map(|axis| &axis.coordinates[1..]);
    further.map(|coordinate| coordinate.name.as_str()).collect::<Vec<_>>().join(" ")
}

fn add(
    file: &mut NcFileBuilder,
    variable: &Labelled,
    dimensions: &[(String, DimensionId)],
    places: &str,
) -> Result<()> {
    let of = |name: &String| dimensions.iter().find(|(other, _)| other == name).map(|&(_, id)| id);
    let along: Vec<DimensionId> = variable.dimensions.iter().filter_map(of).collect();
    let id = match &variable.values {
        Values::Numbers(values) => {
            let id = file.add_variable::<f64>(&variable.name, &along)?;
            file.write_variable(id, values)?;
            id
        }
        Values::Texts(values) => {
            let id = file.add_string_variable(&variable.name, &along)?;
            file.write_string_variable(id, values)?;
            id
        }
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
    Ok(())
}

fn text(value: &str) -> NcAttrValue {
    NcAttrValue::Chars(value.to_owned())
}
