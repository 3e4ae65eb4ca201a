//! Pickles of results: plain values and columns as bytes that end with a checksum. Only the version that wrote them reads
//! them, as for descriptions.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::convert::Import;

/// The version that writes pickles; only this version reads them.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What `__reduce__` returns: a function and its arguments, which make the object anew.
pub type Reduced<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// Refuses a pickle that another version wrote.
pub fn check_version(version: &str) -> PyResult<()> {
    if version == VERSION {
        return Ok(());
    }
    let text = format!("pickle: expected one written by asperity {VERSION}, got one of asperity {version}");
    Err(PyValueError::new_err(text))
}

/// A pickle that is not what its object wrote.
pub fn damaged(found: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(format!("pickle: expected the bytes that asperity wrote, got {found}"))
}

/// `head` as CBOR after its length, `values`, and a checksum of all before it.
pub fn pack(head: &impl Serialize, values: &[&[f64]]) -> PyResult<Vec<u8>> {
    let mut text = Vec::new();
    ciborium::into_writer(head, &mut text).map_err(|error| PyValueError::new_err(error.to_string()))?;
    let count: usize = values.iter().map(|column| column.len()).sum();
    let mut bytes = Vec::with_capacity(LENGTH + text.len() + VALUE * count + CHECKSUM);
    bytes.extend((text.len() as u64).to_le_bytes());
    bytes.extend(text);
    for column in values {
        column.iter().for_each(|value| bytes.extend(value.to_le_bytes()));
    }
    let checksum = crc32fast::hash(&bytes);
    bytes.extend(checksum.to_le_bytes());
    Ok(bytes)
}

/// Bytes of the length of a head, of a value and of a checksum.
const LENGTH: usize = 8;
const VALUE: usize = 8;
const CHECKSUM: usize = 4;

/// The head and the values that [`pack`] was given.
pub fn unpack<T: DeserializeOwned>(bytes: &[u8]) -> PyResult<(T, Vec<f64>)> {
    let short = || damaged("fewer");
    let (content, checksum) = bytes.split_last_chunk::<CHECKSUM>().ok_or_else(short)?;
    if crc32fast::hash(content) != u32::from_le_bytes(*checksum) {
        return Err(damaged("others: the checksum differs"));
    }
    let (length, rest) = content.split_first_chunk::<LENGTH>().ok_or_else(short)?;
    let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| short())?;
    let (head, values) = rest.split_at_checked(length).ok_or_else(short)?;
    let head = ciborium::from_reader(head).map_err(|error| damaged(format!("others: {error}")))?;
    let (values, left) = values.as_chunks::<VALUE>();
    if !left.is_empty() {
        return Err(short());
    }
    Ok((head, values.iter().map(|value| f64::from_le_bytes(*value)).collect()))
}

/// What restores an object of `class` from its bytes, and from the model of which it is a result, if there is one.
pub fn reduced<'py>(
    py: Python<'py>,
    class: &str,
    bytes: &[u8],
    model: Option<Bound<'py, PyAny>>,
) -> PyResult<Reduced<'py>> {
    static RESTORE: Import = Import::new("asperity._core", "_restore_result");
    let arguments = (VERSION, class, PyBytes::new(py, bytes), model).into_pyobject(py)?;
    Ok((RESTORE.get(py)?.clone(), arguments))
}

/// A method of an object and its arguments, for a result that is fast to compute from the object.
pub fn again<'py, T>(
    owner: &Bound<'py, T>,
    method: &str,
    arguments: Bound<'py, PyTuple>,
) -> PyResult<Reduced<'py>> {
    Ok((owner.as_any().getattr(method)?, arguments))
}

/// The model of a result, if it is one of which there are such results.
pub fn of_model<'py, T: pyo3::PyTypeInfo>(
    model: Option<Bound<'py, PyAny>>,
    has_such: impl Fn(&Bound<'py, T>) -> bool,
) -> PyResult<Bound<'py, T>> {
    let model = model.ok_or_else(|| damaged("a result without its model"))?;
    let model = model.cast_into::<T>().ok().filter(has_such);
    model.ok_or_else(|| damaged("a result with another model"))
}
