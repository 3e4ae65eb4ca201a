//! The command line, for `python -m asperity` and the script `asperity`.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the command `asperity` with its arguments, as in a terminal, and gives its exit code.
#[pyfunction(name = "_command")]
pub fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| asperity_cli::main_with(std::iter::once("asperity".into()).chain(arguments)))
}
