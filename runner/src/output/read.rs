//! Reading of a result folder.

use std::fs::{self, File};
use std::io;
use std::path::Path;
use std::sync::Arc;

use asperity::record::{Quantity, Record, Variable};
use asperity::task::summary::Summary;
use netcdf_reader::{FileStorage, NcFile, NcSliceInfo, NcSliceInfoElem, NcVariable};
use serde_json::{Map, Value};

use super::attributes::FORMAT_ATTRIBUTE;
use super::drawn::{Described, Selection};
use super::{Error, FORMAT, Outcome, Result, without_schema};

/// Reads the files of [`super::write`], with every number unchanged.
///
/// # Errors
/// A file that is missing, cannot be read, or was not written by asperity.
pub fn read(dir: &Path) -> Result<Outcome> {
    read_with(dir, record)
}

/// The same with what pictures show of the results, in about `most` bytes.
///
/// # Errors
/// As [`read`].
pub fn read_drawn(dir: &Path, most: u64) -> Result<Outcome> {
    read_with(dir, |path| shown(path, most))
}

fn read_with(dir: &Path, record: impl FnOnce(&Path) -> Result<Record>) -> Result<Outcome> {
    let scenario = without_schema(text(&dir.join("scenario.toml"))?);
    let [numbers, columns] = ["summary.json", "result.nc"].map(|name| dir.join(name));
    is_written(&numbers)?;
    is_written(&columns)?;
    let summary = summary(&text(&numbers)?).map_err(Error::malformed(&numbers))?;
    Ok(Outcome { scenario, summary, record: record(&columns)? })
}

/// Refuses a file of the results that is not there, as a run may leave it out.
fn is_written(path: &Path) -> Result<()> {
    if path.exists() {
        return Ok(());
    }
    let what = "not in this folder; results that are read again need `--only nc,json`, or all files";
    Err(Error::system(path, "read")(io::Error::new(io::ErrorKind::NotFound, what)))
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

/// The text of a file.
pub(crate) fn text(path: &Path) -> Result<String> {
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

/// Opens a file of which parts are read.
pub(crate) fn open(path: &Path) -> Result<NcFile> {
    let file = File::open(path).map_err(Error::system(path, "read"))?;
    let storage = FileStorage::from_file(file).map_err(Error::malformed(path))?;
    NcFile::from_storage(Arc::new(storage)).map_err(Error::malformed(path))
}

/// What pictures show of a file, of which only that is read.
fn shown(path: &Path, most: u64) -> Result<Record> {
    let file = open(path)?;
    is_known(&file, path)?;
    let decode = || -> netcdf_reader::Result<Record> {
        let numbers = file.variables()?.iter().filter(|v| attribute(v, "quantity").is_some());
        let length = |v: &NcVariable| v.shape().iter().product::<u64>() as usize;
        let described = numbers.map(|v| Ok(Described { variable: labels(v)?, length: length(v) }));
        let described: Vec<Described> = described.collect::<netcdf_reader::Result<_>>()?;
        let selection = Selection::of(&described, most);
        let mut record = Record::default();
        for described in described {
            let (name, length) = (described.variable.name.clone(), described.length);
            let shape = file.variable(&name)?.shape();
            let read = |from, count| part(&file, (&name, &shape), (from, count, length));
            record.variables.extend(selection.shown(described, read)?);
        }
        Ok(record)
    };
    decode().map_err(Error::malformed(path))
}

/// All values of a variable, or a row of its first dimension, from an index on.
fn part(
    file: &NcFile,
    (name, shape): (&str, &[u64]),
    (from, count, length): (usize, usize, usize),
) -> netcdf_reader::Result<Vec<f64>> {
    if count == length {
        return Ok(file.read_variable_as_f64(name)?.into_iter().collect());
    }
    let mut slice = NcSliceInfo::all(shape.len());
    slice.selections[0] = NcSliceInfoElem::Index((from / count) as u64);
    Ok(file.read_variable_slice_as_f64(name, &slice)?.into_iter().collect())
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
    let values = file.read_variable_as_f64(found.name())?.into_iter().collect();
    Ok(Variable { values, ..labels(found)? })
}

/// What a variable is, without its values.
fn labels(found: &NcVariable) -> netcdf_reader::Result<Variable> {
    let name = found.name().to_owned();
    let label = attribute(found, "quantity").unwrap_or_default();
    let quantity = Quantity::ALL.into_iter().find(|q| q.name() == label);
    let unknown = || netcdf_reader::Error::InvalidData(format!("{name}: unknown quantity `{label}`"));
    Ok(Variable {
        quantity: quantity.ok_or_else(unknown)?,
        long_name: attribute(found, "long_name").unwrap_or_default(),
        dimensions: found.dimensions().iter().map(|d| d.name.clone()).collect(),
        values: Vec::new(),
        name,
    })
}

fn attribute(variable: &NcVariable, name: &str) -> Option<String> {
    variable.attribute(name)?.value.as_string()
}
