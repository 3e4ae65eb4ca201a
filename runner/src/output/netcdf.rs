//! `result.nc`: the variables as NetCDF-4, with labels, units and the scenario that reproduces them.
//!
//! `netcdf-writer` assembles a file in memory. It is given one value of each array, and [`super::hdf5`] makes places for the
//! others behind what it assembled; values are written there a piece at a time.

use std::borrow::Cow;
use std::io::{self, Write};

use asperity::record::{Quantity, Variable};
use asperity::scenario::Units;
use asperity::task::is_coordinate;
use netcdf_writer::{DimensionId, NcAttrValue, NcFileBuilder, NcWriteFormat, NcWriteOptions};

use super::hdf5::{Array, Values, padding, place};
use super::view::{Variables, View};
use super::{Attribute, Error, Outcome, Result, attributes};

/// Values that are written at once.
const PIECE: usize = 1 << 13;

/// The file `result.nc` without the values of its arrays, and the variables whose values follow.
pub(super) struct Assembled<'a> {
    bytes: Vec<u8>,
    arrays: Vec<View<'a>>,
}

/// Assembles the file; the same variables give the same bytes.
pub(super) fn assemble<'a>(outcome: &Outcome, variables: Variables<'a>) -> Result<Assembled<'a>> {
    let mut file = NcFileBuilder::new();
    describe(&mut file, outcome)?;
    let lengths = variables.dimensions();
    let mut dimensions = Vec::new();
    for &(name, length) in &lengths {
        // Only an unlimited dimension may have length 0.
        let id = if length == 0 { file.add_unlimited_dimension(name)? } else { file.add_dimension(name, 1)? };
        dimensions.push((name, id));
    }
    let mut arrays = Vec::new();
    for view in variables.all() {
        let variable = view.variable();
        let along: Vec<_> = variable
            .dimensions
            .iter()
            .filter_map(|d| dimensions.iter().find(|(name, _)| name == d).map(|&(_, id)| id))
            .collect();
        let first = view.read(0, 1).map_err(Error::system("result.nc".as_ref(), "read the values of"))?;
        let places = places(variables, variable);
        add(&mut file, (variable, &first), &along, (&outcome.summary.units, &places))?;
        if !variable.dimensions.is_empty() {
            arrays.push(view);
        }
    }
    let mut bytes = file.to_vec(NcWriteOptions { format: NcWriteFormat::Nc4 })?.1;
    let shape = |variable: &Variable| {
        variable.dimensions.iter().map(|name| variables.length(name) as u64).collect::<Vec<_>>()
    };
    let array = |view: &View<'a>| {
        let (variable, values) =
            (view.variable(), if view.len() == 0 { Values::None } else { Values::Behind });
        Array { name: &variable.name, shape: shape(variable), size: size(variable.quantity), values }
    };
    let is_coordinate = |name: &str| variables.get(name).is_some_and(|v| v.variable().dimensions == [name]);
    // A dimension without a coordinate has an array of its own, without values.
    let bare = lengths.iter().filter(|(name, length)| *length > 0 && !is_coordinate(name));
    let bare = bare.map(|&(name, length)| Array {
        name,
        shape: vec![length as u64],
        size: size_of::<i32>() as u64,
        values: Values::Zero,
    });
    let all: Vec<Array<'_>> = arrays.iter().map(array).chain(bare).collect();
    place(&mut bytes, &all).ok_or(Error::Unplaced)?;
    Ok(Assembled { bytes, arrays })
}

impl Assembled<'_> {
    /// Writes the file.
    ///
    /// # Errors
    /// The system refuses to write it, or to read values.
    pub(super) fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        to.write_all(&self.bytes)?;
        self.arrays.iter().try_for_each(|array| {
            let values = |from, count| array.read(from, count);
            write_values(to, (array.variable().quantity, array.len()), values)
        })
    }
}

/// Writes `count` numbers where an array has its place, a piece at a time; `values` gives some from an index on.
///
/// # Errors
/// The system refuses to write them, or to read values.
pub(crate) fn write_numbers<'a>(
    to: &mut dyn Write,
    count: usize,
    values: impl Fn(usize, usize) -> io::Result<Cow<'a, [f64]>>,
) -> io::Result<()> {
    write_values(to, (Quantity::Number, count), values)
}

fn write_values<'a>(
    to: &mut dyn Write,
    (quantity, count): (Quantity, usize),
    values: impl Fn(usize, usize) -> io::Result<Cow<'a, [f64]>>,
) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(PIECE.min(count) * size_of::<f64>());
    for from in (0..count).step_by(PIECE) {
        bytes.clear();
        encode(quantity, &values(from, PIECE)?, &mut bytes);
        to.write_all(&bytes)?;
    }
    to.write_all(&[0; 8][..padding(count as u64 * size(quantity))])
}

/// Bytes of a value.
fn size(quantity: Quantity) -> u64 {
    if quantity == Quantity::Flag { 1 } else { 8 }
}

/// Appends values as they are in the file: counts are integers, flags bytes.
fn encode(quantity: Quantity, values: &[f64], bytes: &mut Vec<u8>) {
    match quantity {
        Quantity::Count => bytes.extend(values.iter().flat_map(|&value| (value as i64).to_ne_bytes())),
        Quantity::Flag => bytes.extend(values.iter().map(|&value| u8::from(value != 0.0))),
        _ => bytes.extend(values.iter().flat_map(|value| value.to_ne_bytes())),
    }
}

/// Title, version, seed, the numbers of the summary, and the scenario. The scenario is a variable, because attributes are
/// limited in length.
fn describe(file: &mut NcFileBuilder, outcome: &Outcome) -> Result<()> {
    for (name, attribute) in attributes(&outcome.summary) {
        file.add_attribute(name, attribute.into())?;
    }
    let scenario = file.add_string_variable("scenario", &[])?;
    file.write_string_variable(scenario, &[&outcome.scenario])?;
    file.add_variable_attribute(scenario, "long_name", text("scenario, TOML"))?;
    Ok(())
}

/// The coordinates at which a variable is given, beside those named like its dimensions; none for a coordinate.
fn places(variables: Variables<'_>, variable: &Variable) -> String {
    if is_coordinate(&variable.name, &variable.dimensions) {
        return String::new();
    }
    let there = |place: &&Variable| {
        is_coordinate(&place.name, &place.dimensions)
            && place.dimensions[0] != place.name
            && variable.dimensions.contains(&place.dimensions[0])
    };
    let all = variables.all().map(View::variable).filter(there);
    all.map(|place| place.name.as_str()).collect::<Vec<_>>().join(" ")
}

/// Adds a variable with its `first` value, or with none.
fn add(
    file: &mut NcFileBuilder,
    (variable, first): (&Variable, &[f64]),
    along: &[DimensionId],
    (units, places): (&Units, &str),
) -> Result<()> {
    let id = match variable.quantity {
        Quantity::Count => {
            let id = file.add_variable::<i64>(&variable.name, along)?;
            file.write_variable(id, &first.iter().map(|&value| value as i64).collect::<Vec<_>>())?;
            id
        }
        Quantity::Flag => {
            let id = file.add_variable::<i8>(&variable.name, along)?;
            file.write_variable(id, &first.iter().map(|&value| i8::from(value != 0.0)).collect::<Vec<_>>())?;
            file.add_variable_attribute(id, "flag_values", NcAttrValue::Bytes(vec![0, 1]))?;
            file.add_variable_attribute(id, "flag_meanings", text("false true"))?;
            // What xarray writes beside bytes that are truth values, and reads.
            file.add_variable_attribute(id, "dtype", text("bool"))?;
            id
        }
        _ => {
            let id = file.add_variable::<f64>(&variable.name, along)?;
            file.write_variable(id, first)?;
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

impl From<Attribute> for NcAttrValue {
    fn from(attribute: Attribute) -> Self {
        match attribute {
            Attribute::Text(text) => Self::Chars(text),
            Attribute::Whole(number) => Self::Int64s(vec![number]),
            Attribute::Seed(number) => Self::UInt64s(vec![number]),
            Attribute::Number(number) => Self::Doubles(vec![number]),
        }
    }
}

/// A text as an attribute.
pub(crate) fn text(value: &str) -> NcAttrValue {
    NcAttrValue::Chars(value.to_owned())
}
