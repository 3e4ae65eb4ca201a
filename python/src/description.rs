//! What distributions, contacts, models and sliders have in common: each is its description in plain values,
//! and so can be compared, printed, copied with changes, and sent to another process.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash as _, Hasher as _};

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::pickle::{Reduced, VERSION, check_version};
use crate::plain::Plain;
use crate::typed;

/// A description in plain values: immutable, comparable and hashable by its values, and printed as the Python
/// code that creates it.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> asp.Contacts(asp.Gaussian(1.0, 0.1)) == asp.Contacts(asp.Gaussian(1.0, 0.1))
/// True
/// >>> asp.Gaussian(1.0, 0.1)
/// Gaussian(mean=1.0, std=0.1)
#[pyclass(frozen, subclass, module = "asperity")]
pub struct Description {
    plain: Plain,
}

impl Description {
    pub fn new(plain: Plain) -> PyClassInitializer<Self> {
        Self { plain }.into()
    }

    pub fn plain(&self) -> &Plain {
        &self.plain
    }

    pub fn json(&self) -> PyResult<String> {
        serde_json::to_string(&self.plain).map_err(|error| PyValueError::new_err(error.to_string()))
    }
}

#[pymethods]
impl Description {
    /// The arguments that create an equal object, by name, without those that have their default.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<typed::Values<'py>> {
        Ok(typed::Values(self.plain.arguments(py)?.into_any()))
    }

    /// A copy with some of the arguments replaced.
    ///
    /// Parameters
    /// ----------
    /// **changes
    ///     New values of arguments by their names.
    ///
    /// Returns
    /// -------
    /// Description
    ///     One of the same class.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     Or TypeError as the class itself does.
    #[pyo3(signature = (**changes: "Any"))]
    fn replace<'py>(
        slf: &Bound<'py, Self>,
        changes: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<typed::Same<'py>> {
        let arguments = slf.get().plain.arguments(slf.py())?;
        if let Some(changes) = changes {
            arguments.update(changes.as_mapping())?;
        }
        slf.get_type().call((), Some(&arguments)).map(typed::Same)
    }

    #[pyo3(signature = (**changes: "Any"))]
    fn __replace__<'py>(
        slf: &Bound<'py, Self>,
        changes: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<typed::Same<'py>> {
        Self::replace(slf, changes)
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.plain == other.plain
    }

    fn __hash__(&self) -> PyResult<u64> {
        let mut hasher = DefaultHasher::new();
        // 0 and −0 are equal.
        self.json()?.replace("-0.0", "0.0").hash(&mut hasher);
        Ok(hasher.finish())
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        show(slf, "text")
    }

    fn _repr_html_(slf: &Bound<'_, Self>) -> PyResult<String> {
        show(slf, "html")
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[str, str]]")]
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let restore = slf.py().import("asperity._core")?.getattr("_restore")?;
        Ok((restore, (VERSION, slf.get().json()?).into_pyobject(slf.py())?))
    }
}

/// Name and arguments, formatted by a function of the package.
fn show(description: &Bound<'_, Description>, layout: &str) -> PyResult<String> {
    let arguments = description.get().plain.arguments(description.py())?;
    let name = description.get_type().name()?;
    description.py().import("asperity._show")?.call_method1(layout, (name, arguments))?.extract()
}

/// The description that was pickled.
#[pyfunction(name = "_restore")]
#[pyo3(signature = (version, description) -> "Description")]
pub fn restore<'py>(py: Python<'py>, version: &str, description: &str) -> PyResult<Bound<'py, PyAny>> {
    check_version(version)?;
    let plain: Plain = serde_json::from_str(description)
        .map_err(|error| PyValueError::new_err(format!("pickle: expected a description, got {error}")))?;
    plain.object(py)
}
