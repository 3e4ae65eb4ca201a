//! Parts of a scenario from tables, lists and values of Python.

use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use toml::Value;

use crate::convert::{DEPTH, deeper, unmasked};
use crate::description::Description;
use crate::error::{invalid, wrong_type};

/// A part of a scenario from dictionaries, lists, numbers, texts, arrays and descriptions.
pub fn toml(key: &str, value: &Bound<'_, PyAny>) -> PyResult<Value> {
    within(key, value, DEPTH)
}

/// The same, with a nesting depth of at most `depth`.
fn within(key: &str, value: &Bound<'_, PyAny>, depth: usize) -> PyResult<Value> {
    if let Some(plain) = plain(key, value)? {
        return Ok(plain);
    }
    let depth = deeper(key, depth)?;
    let child = |name: &str| if key.is_empty() { name.to_owned() } else { format!("{key}.{name}") };
    if let Ok(table) = value.cast::<PyDict>() {
        let entry = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
            let text: String = name.extract().map_err(|_| wrong_type(key, "keys that are texts", &name))?;
            let value = within(&child(&text), &value, depth)?;
            Ok((text, value))
        };
        return table.iter().map(entry).collect::<PyResult<toml::Table>>().map(Value::Table);
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let item =
            |(i, item): (usize, PyResult<Bound<'_, PyAny>>)| within(&child(&i.to_string()), &item?, depth);
        return value.try_iter()?.enumerate().map(item).collect::<PyResult<_>>().map(Value::Array);
    }
    unmasked(key, value, depth)?;
    if value.hasattr("tolist")? {
        return within(key, &value.call_method0("tolist")?, depth);
    }
    Err(wrong_type(key, "a table, a list, a number or a text", value))
}

/// A value that contains no others, or that is already a description.
fn plain(key: &str, value: &Bound<'_, PyAny>) -> PyResult<Option<Value>> {
    if let Ok(described) = value.cast::<Description>() {
        let toml = described.get().plain().toml();
        let refused = || wrong_type(key, "a distribution, areas, contacts or a slip rule", value);
        return toml.ok_or_else(refused).map(Some);
    }
    if value.is_instance_of::<PyBool>() {
        return value.extract().map(Value::Boolean).map(Some);
    }
    if value.is_instance_of::<PyInt>() {
        let whole = value.extract().map(Value::Integer);
        return whole.map(Some).map_err(|_| invalid(key, "a whole number below 2^63", value));
    }
    if value.is_instance_of::<PyFloat>() {
        return value.extract().map(Value::Float).map(Some);
    }
    if value.is_instance_of::<PyString>() {
        return value.extract().map(Value::String).map(Some);
    }
    Ok(None)
}
