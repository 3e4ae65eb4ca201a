//! `result.nc`: the record as NetCDF-4, with labels, units and the scenario that reproduces it.

use asperity::record::{LARGEST, Quantity, Record, Variable};
use asperity::scenario::Units;
use asperity::task::is_coordinate;
use netcdf_writer::{NcAttrValue, NcFileBuilder, NcWriteFormat, NcWriteOptions};

use super::{Attribute, Error, Outcome, Result, attributes};

/// Refuses results that are too large for one file.
///
/// # Errors
/// `needed` bytes are more than [`LARGEST`].
pub fn check_size(needed: u64) -> Result<()> {
    if needed > LARGEST { Err(Error::TooLarge { needed, allowed: LARGEST }) } else { Ok(()) }
}

/// The bytes of `result.nc`; the same outcome gives the same bytes.
pub(super) fn encode(outcome: &Outcome) -> Result<Vec<u8>> {
    check_size(outcome.record.bytes())?;
    let mut file = NcFileBuilder::new();
    describe(&mut file, outcome)?;
    let mut dimensions = Vec::new();
    for (name, length) in outcome.record.dimensions() {
        // Only an unlimited dimension may have length 0.
        let id = match length {
            0 => file.add_unlimited_dimension(name)?,
            length => file.add_dimension(name, length as u64)?,
        };
        dimensions.push((name, id));
    }
    for variable in &outcome.record.variables {
        let along: Vec<_> = variable
            .dimensions
            .iter()
            .filter_map(|d| dimensions.iter().find(|(name, _)| name == d).map(|&(_, id)| id))
            .collect();
        let places = places(&outcome.record, variable);
        add(&mut file, variable, &along, (&outcome.summary.units, &places))?;
    }
    Ok(file.to_vec(NcWriteOptions { format: NcWriteFormat::Nc4 })?.1)
}

/// Title, version, seed, the numbers of the summary, and the scenario. The scenario is a variable, because attributes are
/// limited in length.
fn describe(file: &mut NcFileBuilder, outcome: &Outcome) -> Result<()> {
    for (name, attribute) in attributes(&outcome.summary) {
        file.add_attribute(name, value(attribute))?;
    }
    let scenario = file.add_string_variable("scenario", &[])?;
    file.write_string_variable(scenario, &[&outcome.scenario])?;
    file.add_variable_attribute(scenario, "long_name", text("scenario, TOML"))?;
    Ok(())
}

/// The coordinates at which a variable is given, beside those named like its dimensions; none for a coordinate.
fn places(record: &Record, variable: &Variable) -> String {
    if is_coordinate(&variable.name, &variable.dimensions) {
        return String::new();
    }
    let there = |place: &&Variable| {
        is_coordinate(&place.name, &place.dimensions)
            && place.dimensions[0] != place.name
            && variable.dimensions.contains(&place.dimensions[0])
    };
    let names: Vec<&str> = record.variables.iter().filter(there).map(|place| place.name.as_str()).collect();
    names.join(" ")
}

fn add(
    file: &mut NcFileBuilder,
    variable: &Variable,
    along: &[netcdf_writer::DimensionId],
    (units, places): (&Units, &str),
) -> Result<()> {
    let id = match variable.quantity {
        Quantity::Count => {
            let id = file.add_variable::<i64>(&variable.name, along)?;
            let values: Vec<i64> = variable.values.iter().map(|value| *value as i64).collect();
            file.write_variable(id, &values)?;
            id
        }
        Quantity::Flag => {
            let id = file.add_variable::<i8>(&variable.name, along)?;
            let values: Vec<i8> = variable.values.iter().map(|value| i8::from(*value != 0.0)).collect();
            file.write_variable(id, &values)?;
            file.add_variable_attribute(id, "flag_values", NcAttrValue::Bytes(vec![0, 1]))?;
            file.add_variable_attribute(id, "flag_meanings", text("false true"))?;
            // What xarray writes beside bytes that are truth values, and reads.
            file.add_variable_attribute(id, "dtype", text("bool"))?;
            id
        }
        _ => {
            let id = file.add_variable::<f64>(&variable.name, along)?;
            file.write_variable(id, &variable.values)?;
            id
        }
    };
    if !places.is_empty() {
        file.add_variable_attribute(id, "coordinates", text(places))?;
    }
    file.add_variable_attribute(id, "long_name", text(&variable.long_name))?;
    file.add_variable_attribute(id, "units", text(&units.label(variable.quantity)))?;
    file.add_variable_attribute(id, "quantity", text(variable.quantity.name()))?;
    Ok(())
}

fn value(attribute: Attribute) -> NcAttrValue {
    match attribute {
        Attribute::Text(text) => NcAttrValue::Chars(text),
        Attribute::Whole(number) => NcAttrValue::Int64s(vec![number]),
        Attribute::Seed(number) => NcAttrValue::UInt64s(vec![number]),
        Attribute::Number(number) => NcAttrValue::Doubles(vec![number]),
    }
}

fn text(value: &str) -> NcAttrValue {
    NcAttrValue::Chars(value.to_owned())
}
