//! Reading of a result folder.

use std::fs;
use std::path::Path;

use asperity::record::{Quantity, Record, Variable};
use asperity::task::summary::Summary;
use netcdf_reader::{NcFile, NcVariable};
use serde_json::{Map, Value};

use super::attributes::FORMAT_ATTRIBUTE;
use super::{Error, FORMAT, Outcome, Result};

/// Reads the files of [`super::write`], with every number unchanged.
///
/// # Errors
/// A file that is missing, cannot be read, or was not written by asperity.
pub fn read(dir: &Path) -> Result<Outcome> {
    let path = dir.join("summary.json");
    let scenario = text(&dir.join("scenario.toml"))?;
    let summary = summary(&text(&path)?).map_err(Error::malformed(&path))?;
    Ok(Outcome { scenario, summary, record: record(&dir.join("result.nc"))? })
}

/// The key that identifies each task in a summary without `task`, as written by earlier versions.
const TASKS: [(&str, &str); 7] = [
    ("catalogue", "interface_drive"),
    ("renormalisation", "renormalisation"),
    ("hold_curve", "hold_curve"),
    ("limits", "velocity_curve"),
    ("steps", "protocol"),
    ("regime", "drive"),
    ("static_friction", "pull"),
];

fn summary(text: &str) -> serde_json::Result<Summary> {
    let mut summary: Map<String, Value> = serde_json::from_str(text)?;
    if !summary.contains_key("task") {
        let (_, task) = TASKS.into_iter().find(|(key, _)| summary.contains_key(*key)).unwrap_or_default();
        // Only a block that is moved in time has no static friction.
        let task =
            if task == "drive" && !summary.contains_key("static_friction") { "block_protocol" } else { task };
        summary.insert("task".into(), task.into());
    }
    serde_json::from_value(Value::Object(summary))
}

fn text(path: &Path) -> Result<String> {
    fs::read_to_string(path).map_err(Error::system(path, "read"))
}

fn record(path: &Path) -> Result<Record> {
    let bytes = fs::read(path).map_err(Error::system(path, "read"))?;
    let file = NcFile::from_vec(bytes).map_err(Error::malformed(path))?;
    is_known(&file, path)?;
    let decode = || -> netcdf_reader::Result<Record> {
        let numbers = file.variables()?.iter().filter(|v| attribute(v, "quantity").is_some());
        let variables = numbers.map(|v| variable(&file, v)).collect::<netcdf_reader::Result<_>>()?;
        Ok(Record { variables })
    };
    decode().map_err(Error::malformed(path))
}

/// Refuses a file of a later form. One that states none was written before forms had numbers, and is read as the first.
fn is_known(file: &NcFile, path: &Path) -> Result<()> {
    let stated = |name: &str| file.global_attribute(name).ok().map(|attribute| &attribute.value);
    let found = stated(FORMAT_ATTRIBUTE).and_then(|value| value.as_f64()).unwrap_or(0.0);
    if found <= FORMAT as f64 {
        return Ok(());
    }
    let version = stated("version").and_then(|value| value.as_string()).unwrap_or_default();
    Err(Error::Newer { path: path.to_owned(), found, version })
}

fn variable(file: &NcFile, found: &NcVariable) -> netcdf_reader::Result<Variable> {
    let name = found.name().to_owned();
    let label = attribute(found, "quantity").unwrap_or_default();
    let quantity = Quantity::ALL.into_iter().find(|q| q.name() == label);
    let unknown = || netcdf_reader::Error::InvalidData(format!("{name}: unknown quantity `{label}`"));
    Ok(Variable {
        quantity: quantity.ok_or_else(unknown)?,
        long_name: attribute(found, "long_name").unwrap_or_default(),
        dimensions: found.dimensions().iter().map(|d| d.name.clone()).collect(),
        values: file.read_variable_as_f64(&name)?.into_iter().collect(),
        name,
    })
}

fn attribute(variable: &NcVariable, name: &str) -> Option<String> {
    variable.attribute(name)?.value.as_string()
}
