//! Small results: named tuples and tables of the package.

use asperity::block::Curve;
use asperity::energy::EnergyBalance;
use asperity::law::Atom;
use asperity::master::Stretches;
use asperity::record::{Quantity, Record};
use asperity::task::LinearStability;
use asperity::task::summary::SliderState;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::convert::{Import, array, row};
use crate::typed::{
    Atoms, BlockEnergy, Course, Equilibria, Events, InterfaceEnergy, Potential, Sizes, Stability, State,
    StaticFriction, StretchDensity,
};

static STATIC_FRICTION: Import = Import::new("asperity._values", "StaticFriction");
static ATOMS: Import = Import::new("asperity._values", "Atoms");
static STRETCH_DENSITY: Import = Import::new("asperity._values", "StretchDensity");
static LABEL: Import = Import::new("asperity._values", "Label");
static STATE: Import = Import::new("asperity._values", "State");
static ENERGY: Import = Import::new("asperity._values", "Energy");
static INTERFACE_ENERGY: Import = Import::new("asperity._values", "InterfaceEnergy");
static ROW: Import = Import::new("asperity._events", "row");
static EQUILIBRIA: Import = Import::new("asperity._values", "Equilibria");
static POTENTIAL: Import = Import::new("asperity._values", "Potential");
static EVENTS: Import = Import::new("asperity._events", "Events");
static STABILITY: Import = Import::new("asperity._values", "Stability");
static SIZES: Import = Import::new("asperity._values", "Sizes");
static COURSE: Import = Import::new("asperity._values", "Course");

/// F_s with X_s.
pub fn static_friction(py: Python<'_>, force: f64, position: f64) -> PyResult<StaticFriction<'_>> {
    STATIC_FRICTION.get(py)?.call1((force, position)).map(StaticFriction)
}

/// Point masses: positions and weights.
pub fn atoms<'py>(py: Python<'py>, atoms: &[Atom]) -> PyResult<Atoms<'py>> {
    let column = |part: fn(&Atom) -> f64| row(py, atoms.iter().map(part).collect());
    ATOMS.get(py)?.call1((column(|a| a.position)?, column(|a| a.weight)?)).map(Atoms)
}

/// A distribution of stretches.
pub fn stretches(py: Python<'_>, at: Vec<f64>, found: Stretches) -> PyResult<StretchDensity<'_>> {
    let masses = atoms(py, &found.atoms)?;
    STRETCH_DENSITY.get(py)?.call1((row(py, at)?, row(py, found.density)?, masses)).map(StretchDensity)
}

/// Distributions of stretches at several positions.
pub fn evolution(py: Python<'_>, at: Vec<f64>, found: Vec<Stretches>) -> PyResult<StretchDensity<'_>> {
    let masses = found.iter().map(|one| atoms(py, &one.atoms)).collect::<PyResult<Vec<_>>>()?;
    let shape = [found.len(), at.len()];
    let density = found.into_iter().flat_map(|one| one.density).collect();
    STRETCH_DENSITY.get(py)?.call1((row(py, at)?, array(py, &shape, density)?, masses)).map(StretchDensity)
}

/// Linear stability of steady sliding.
pub fn stability(py: Python<'_>, found: LinearStability) -> PyResult<Stability<'_>> {
    let LinearStability { critical_stiffness, frequency, growth_rate, growth_frequency } = found;
    STABILITY.get(py)?.call1((critical_stiffness, frequency, growth_rate, growth_frequency)).map(Stability)
}

/// Dimensions, name and unit of a variable of a record.
pub fn label<'py>(
    py: Python<'py>,
    dimensions: &[String],
    words: &str,
    unit: &str,
    quantity: Quantity,
) -> PyResult<Bound<'py, PyAny>> {
    LABEL.get(py)?.call1((PyTuple::new(py, dimensions)?, words, unit, quantity.name()))
}

/// A state of a slider.
pub fn state<'py>(py: Python<'py>, place: &SliderState) -> PyResult<State<'py>> {
    STATE.get(py)?.call1((place.drive, place.position, place.force)).map(State)
}

/// The energy balance of a drive.
pub fn energy<'py>(py: Python<'py>, energy: &EnergyBalance) -> PyResult<BlockEnergy<'py>> {
    let EnergyBalance { work, spring, elastic, kinetic, strengthening, breaks, slip, viscous, .. } = *energy;
    let imbalance = energy.imbalance();
    ENERGY
        .get(py)?
        .call1((work, spring, elastic, kinetic, strengthening, breaks, slip, viscous, imbalance))
        .map(BlockEnergy)
}

/// The energy balance of an interface.
pub fn interface_energy<'py>(py: Python<'py>, energy: &EnergyBalance) -> PyResult<InterfaceEnergy<'py>> {
    let EnergyBalance { work, spring, coupling, elastic, strengthening, breaks, slip, .. } = *energy;
    let parts = (work, spring, coupling, elastic, strengthening, breaks, slip, energy.imbalance());
    INTERFACE_ENERGY.get(py)?.call1(parts).map(InterfaceEnergy)
}

/// An event, from a row of columns.
pub fn event<'py>(py: Python<'py>, columns: &Record, row: usize) -> PyResult<Bound<'py, PyAny>> {
    let names = PyTuple::new(py, columns.variables.iter().map(|column| column.name.as_str()))?;
    let values = PyTuple::new(py, columns.variables.iter().map(|column| column.values[row]))?;
    ROW.get(py)?.call1((names,))?.call1(values)
}

/// The equilibria of a slider of a given stiffness.
pub fn equilibria<'py>(py: Python<'py>, curve: Curve, stiffness: f64) -> PyResult<Equilibria<'py>> {
    let (drive, stable) = (curve.drive(stiffness), curve.stable(stiffness));
    let Curve { position, force, .. } = curve;
    EQUILIBRIA
        .get(py)?
        .call1((row(py, drive)?, row(py, position)?, row(py, force)?, row(py, stable)?))
        .map(Equilibria)
}

/// Potentials at the positions of a curve.
pub fn potential<'py>(
    py: Python<'py>,
    position: Vec<f64>,
    energy: Bound<'py, PyAny>,
) -> PyResult<Potential<'py>> {
    POTENTIAL.get(py)?.call1((row(py, position)?, energy)).map(Potential)
}

/// Slips, from columns by name.
pub fn events<'py>(py: Python<'py>, columns: Bound<'py, PyDict>) -> PyResult<Events<'py>> {
    EVENTS.get(py)?.call1((columns,)).map(Events)
}

/// The number of events of each size, from columns.
pub fn sizes<'py>(py: Python<'py>, columns: [Bound<'py, PyAny>; 4]) -> PyResult<Sizes<'py>> {
    SIZES.get(py)?.call1(PyTuple::new(py, columns)?).map(Sizes)
}

/// The time course of a slip, from columns.
pub fn course<'py>(py: Python<'py>, columns: [Bound<'py, PyAny>; 5]) -> PyResult<Course<'py>> {
    COURSE.get(py)?.call1(PyTuple::new(py, columns)?).map(Course)
}
