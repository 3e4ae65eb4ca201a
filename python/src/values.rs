//! Small results: named tuples of the package.

use asperity::law::Atom;
use asperity::master::Stretches;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::convert::{Import, array, row};

static STATIC_FRICTION: Import = Import::new("asperity._values", "StaticFriction");
static ATOMS: Import = Import::new("asperity._values", "Atoms");
static STRETCH_DENSITY: Import = Import::new("asperity._values", "StretchDensity");
static LABEL: Import = Import::new("asperity._values", "Label");

/// F_s with X_s.
pub fn static_friction(py: Python<'_>, force: f64, position: f64) -> PyResult<Bound<'_, PyAny>> {
    STATIC_FRICTION.get(py)?.call1((force, position))
}

/// Point masses: positions and weights.
pub fn atoms<'py>(py: Python<'py>, atoms: &[Atom]) -> PyResult<Bound<'py, PyAny>> {
    let column = |part: fn(&Atom) -> f64| row(py, atoms.iter().map(part).collect());
    ATOMS.get(py)?.call1((column(|a| a.position)?, column(|a| a.weight)?))
}

/// A distribution of stretches.
pub fn stretches(py: Python<'_>, at: Vec<f64>, found: Stretches) -> PyResult<Bound<'_, PyAny>> {
    let masses = atoms(py, &found.atoms)?;
    STRETCH_DENSITY.get(py)?.call1((row(py, at)?, row(py, found.density)?, masses))
}

/// Distributions of stretches at several positions.
pub fn evolution(py: Python<'_>, at: Vec<f64>, found: Vec<Stretches>) -> PyResult<Bound<'_, PyAny>> {
    let masses = found.iter().map(|one| atoms(py, &one.atoms)).collect::<PyResult<Vec<_>>>()?;
    let shape = [found.len(), at.len()];
    let density = found.into_iter().flat_map(|one| one.density).collect();
    STRETCH_DENSITY.get(py)?.call1((row(py, at)?, array(py, &shape, density)?, masses))
}

/// What a variable of a record is.
pub fn label<'py>(
    py: Python<'py>,
    dimensions: &[String],
    words: &str,
    unit: &str,
) -> PyResult<Bound<'py, PyAny>> {
    LABEL.get(py)?.call1((PyTuple::new(py, dimensions)?, words, unit))
}
