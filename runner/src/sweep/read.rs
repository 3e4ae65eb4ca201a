//! Reading of the folder of a finished sweep, for its pictures.

use std::path::Path;

use netcdf_reader::{NcFile, NcSliceInfo, NcSliceInfoElem, NcType, NcVariable};

use super::dataset::{Axis, Dataset, Labelled, Values};
use super::drawn::{is_drawn, replicas, rows, step};
use crate::output::{Error, Result, open, text_of, without_schema};

/// What pictures show of the sweep in a folder; the whole of it is never in memory.
///
/// # Errors
/// A file that is missing, cannot be read, or was not written by asperity.
pub fn read_drawn(folder: &Path) -> Result<Dataset> {
    let scenario = without_schema(text_of(&folder.join("scenario.toml"))?);
    let path = folder.join("sweep.nc");
    drawn(&open(&path)?, scenario).map_err(|error| Error::Malformed { path, what: error.to_string() })
}

fn drawn(file: &NcFile, scenario: String) -> netcdf_reader::Result<Dataset> {
    let all: Vec<&NcVariable> = file.variables()?.iter().filter(|v| text(v, "key").is_some()).collect();
    let further: Vec<String> = all.iter().filter_map(|v| text(v, "coordinates")).collect();
    let is_coordinate = |v: &NcVariable| {
        let among = |names: &String| names.split(' ').any(|name| name == v.name());
        names(v) == [v.name()] || further.iter().any(among)
    };
    let kept: Vec<&NcVariable> = all.into_iter().filter(|v| !is_coordinate(v)).collect();
    let mut dimensions = Vec::new();
    for dimension in file.dimensions()? {
        dimensions.push(axis(file, &dimension.name, dimension.size as usize, &further)?);
    }
    let count = replicas(dimensions.iter());
    let along = |v: &NcVariable| -> Vec<(usize, usize)> {
        let axis = |name: String| dimensions.iter().find(|axis| axis.name == name);
        names(v).into_iter().filter_map(axis).map(|axis| (axis.length, step(axis, count))).collect()
    };
    let shown = kept.iter().filter(|v| is_drawn(&names(v)));
    let variables = shown.map(|v| Ok(labelled(v, thinned(file, v, &along(v))?)));
    let variables = variables.collect::<netcdf_reader::Result<_>>()?;
    // Numbers of a case are along the axes alone, curves also along a grid.
    let axes = kept.iter().map(|v| names(v)).min_by_key(Vec::len).unwrap_or_default();
    let shorter = dimensions.iter().map(|axis| axis.thinned(step(axis, count)));
    let (axes, grids) = shorter.partition(|axis| axes.contains(&axis.name));
    let stated = |name: &str| file.global_attribute(name).ok().map(|attribute| &attribute.value);
    let words = |name: &str| stated(name).and_then(|value| value.as_string()).unwrap_or_default();
    let failed = stated("failed").and_then(|value| value.as_f64()).unwrap_or(0.0) as usize;
    Ok(Dataset { title: words("title"), hash: words("sweep"), scenario, axes, grids, variables, failed })
}

/// A dimension, with the coordinate of its name, and those among `further` that lie along it.
fn axis(file: &NcFile, name: &str, length: usize, further: &[String]) -> netcdf_reader::Result<Axis> {
    let mut variables = vec![file.variable(name)?];
    for other in further.iter().flat_map(|names| names.split(' ')) {
        let variable = file.variable(other)?;
        if names(variable) == [name] && variables.iter().all(|known| known.name() != other) {
            variables.push(variable);
        }
    }
    let coordinate = |v: &&NcVariable| Ok(labelled(v, thinned(file, v, &[(length, 1)])?));
    let coordinates = variables.iter().map(coordinate).collect::<netcdf_reader::Result<_>>()?;
    Ok(Axis { name: name.to_owned(), length, coordinates })
}

/// The values at every so many places along dimensions with these lengths and steps, read row by row.
fn thinned(file: &NcFile, v: &NcVariable, along: &[(usize, usize)]) -> netcdf_reader::Result<Values> {
    let (length, step) = along.last().copied().unwrap_or((1, 1));
    if *v.dtype() == NcType::String {
        let texts = file.read_variable_as_strings(v.name())?;
        let row = |row: usize| texts[row * length..][..length].iter().step_by(step).cloned();
        return Ok(Values::Texts(rows(along).into_iter().flat_map(row).collect()));
    }
    let mut found = Vec::new();
    for row in rows(along) {
        let mut rest = row;
        let mut selections = vec![NcSliceInfoElem::Slice { start: 0, end: length as u64, step: 1 }];
        for &(length, _) in along.iter().rev().skip(1) {
            selections.insert(0, NcSliceInfoElem::Index((rest % length) as u64));
            rest /= length;
        }
        let values = file.read_variable_slice_as_f64(v.name(), &NcSliceInfo { selections })?;
        found.extend(values.into_iter().step_by(step));
    }
    Ok(Values::Numbers(found))
}

fn labelled(v: &NcVariable, values: Values) -> Labelled {
    let of = |name: &str| text(v, name).unwrap_or_default();
    let (name, dimensions) = (v.name().to_owned(), names(v));
    Labelled { name, long_name: of("long_name"), key: of("key"), units: of("units"), dimensions, values }
}

fn names(v: &NcVariable) -> Vec<String> {
    v.dimensions().iter().map(|dimension| dimension.name.clone()).collect()
}

fn text(v: &NcVariable, name: &str) -> Option<String> {
    v.attribute(name)?.value.as_string()
}
