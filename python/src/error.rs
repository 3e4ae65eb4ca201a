//! Conversion of Rust errors to Python exceptions.

use std::io::Error as IoError;

use asperity::Error;
use asperity_runner::{checkpoint, input, output};
use pyo3::exceptions::{
    PyFileExistsError, PyKeyboardInterrupt, PyMemoryError, PyRuntimeError, PyTypeError, PyValueError,
};
use pyo3::prelude::*;

/// Wrong values are `ValueError`, results that would not fit `MemoryError` (as in NumPy), an accuracy that was not
/// reached `RuntimeError` (as in SciPy), a stop `KeyboardInterrupt`; the text is that of the core, with the most similar of the
/// names that were expected.
pub fn core(error: Error) -> PyErr {
    let text = error.to_string();
    match error {
        Error::Invalid { expected, found, .. } => {
            let name = found.trim_matches('"');
            let nearest = input::nearest_expected(&expected, name).filter(|nearest| *nearest != name);
            let help = nearest.map_or(String::new(), |nearest| format!(" (did you mean {nearest}?)"));
            PyValueError::new_err(text + &help)
        }
        Error::TooLarge { .. } => PyMemoryError::new_err(text),
        Error::Stopped => PyKeyboardInterrupt::new_err(text),
        _ => PyRuntimeError::new_err(text),
    }
}

/// An invalid scenario, `ValueError`.
pub fn scenario(diagnostic: &input::Diagnostic) -> PyErr {
    let help = diagnostic.help.as_ref().map_or(String::new(), |help| format!(" ({help})"));
    PyValueError::new_err(format!("{diagnostic}{help}"))
}

/// Files that cannot be read or written: `OSError` of the right kind; those of others, `FileExistsError`.
pub fn files(error: output::Error) -> PyErr {
    let text = error.to_string();
    match error {
        output::Error::System { source, .. } => IoError::new(source.kind(), text).into(),
        output::Error::Foreign { .. } => PyFileExistsError::new_err(text),
        _ => PyValueError::new_err(text),
    }
}

/// Checkpoints: those of another scenario and damaged ones are `ValueError`, those of an unfinished or running
/// run `FileExistsError`, others `OSError` of the right kind.
pub fn checkpoint(error: checkpoint::Error) -> PyErr {
    let text = error.to_string();
    match error {
        checkpoint::Error::System { source, .. } => IoError::new(source.kind(), text).into(),
        checkpoint::Error::Unfinished { .. } | checkpoint::Error::Busy { .. } => {
            PyFileExistsError::new_err(text)
        }
        _ => PyValueError::new_err(text),
    }
}

/// What was expected under `key`, and what was found.
pub fn invalid(key: &str, expected: impl Into<String>, found: impl ToString) -> PyErr {
    core(Error::invalid(key, expected, found))
}

/// `TypeError` with what was expected under `key`, and what was found.
pub fn wrong_type(key: &str, expected: &str, found: &Bound<'_, PyAny>) -> PyErr {
    let name = found.get_type().name().map_or_else(|_| "something else".into(), |name| name.to_string());
    PyTypeError::new_err(format!("{key}: expected {expected}, got {name}"))
}
