//! `result.nc`: the record as NetCDF-4, with labels, units and the scenario that reproduces it.

use asperity::record::{LARGEST, Variable};
use asperity::scenario::Units;
use netcdf_writer::{NcAttrValue, NcFileBuilder, NcWriteFormat, NcWriteOptions};

use super::{Error, Outcome, Result};

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
        add(&mut file, variable, &along, &outcome.summary.units)?;
    }
    Ok(file.to_vec(NcWriteOptions { format: NcWriteFormat::Nc4 })?.1)
}

/// Title, version, seed, and the scenario. The scenario is a variable, because attributes are limited in length.
fn describe(file: &mut NcFileBuilder, outcome: &Outcome) -> Result<()> {
    let summary = &outcome.summary;
    file.add_attribute("title", text(&summary.title))?;
    file.add_attribute("source", text("asperity"))?;
    file.add_attribute("version", text(&summary.version))?;
    if let Some(seed) = summary.seed {
        file.add_attribute("seed", NcAttrValue::UInt64s(vec![seed]))?;
    }
    let scenario = file.add_string_variable("scenario", &[])?;
    file.write_string_variable(scenario, &[&outcome.scenario])?;
    file.add_variable_attribute(scenario, "long_name", text("scenario, TOML"))?;
    Ok(())
}

fn add(
    file: &mut NcFileBuilder,
    variable: &Variable,
    along: &[netcdf_writer::DimensionId],
    units: &Units,
) -> Result<()> {
    let id = file.add_variable::<f64>(&variable.name, along)?;
    file.write_variable(id, &variable.values)?;
    file.add_variable_attribute(id, "long_name", text(&variable.long_name))?;
    file.add_variable_attribute(id, "units", text(&units.label(variable.quantity)))?;
    file.add_variable_attribute(id, "quantity", text(variable.quantity.name()))?;
    Ok(())
}

fn text(value: &str) -> NcAttrValue {
    NcAttrValue::Chars(value.to_owned())
}
