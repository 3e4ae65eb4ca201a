//! What distributions, contacts, models and sliders have in common: each is its description in plain values,
//! and so can be compared, printed, copied with changes, and sent to another process.

use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash as _, Hasher as _};

use asperity::scenario::{self, Areas, Contacts, Law, PerCell, Slip, TaskStart};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};
use serde::{Deserialize, Serialize};
use toml::Value;

use crate::pickle::{Reduced, VERSION, check_version};
use crate::surface::{self, Surface};
use crate::{
    block, contacts, distributions, ensemble, equation, interface, lattice, rules, transport, typed,
};

/// The plain values of a description, as in a scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Plain {
    Law(Law),
    Areas(Areas),
    Contacts(Contacts),
    Temperature(scenario::Temperature),
    Ageing(scenario::Ageing),
    MasterEquation(Interface, Solved),
    Transport(Interface, Solved),
    Step(scenario::Step),
    Ensemble(Interface, scenario::Ensemble),
    Slip(Slip),
    Block(Slider),
    Surface(Box<Surface>),
}

/// Contacts and their initial state.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Interface {
    pub contacts: Contacts,
    pub initial: Law,
    pub start: TaskStart,
}

/// The settings of a master equation: tolerance and, for time-dependent contacts or steady sliding, velocity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Solved {
    pub own: scenario::MasterEquation,
    pub velocity: Option<f64>,
}

/// A slider, and the model of the contacts under it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Slider {
    pub model: Box<Plain>,
    /// `None` for a rigid slider.
    pub stiffness: Option<f64>,
    pub slip: Slip,
    pub slip_fraction: f64,
}

impl Plain {
    /// The object with this description.
    pub fn object<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.class(py).call((), Some(&self.arguments(py)?))
    }

    /// The object with this description, of a given class.
    pub fn instance<'py, T: pyo3::PyTypeInfo>(&self, py: Python<'py>) -> PyResult<Bound<'py, T>> {
        Ok(self.object(py)?.cast_into()?)
    }

    fn class<'py>(&self, py: Python<'py>) -> Bound<'py, PyType> {
        match self {
            Self::Law(law) => distributions::class(law, py),
            Self::Areas(_) => py.get_type::<contacts::Areas>(),
            Self::Contacts(_) => py.get_type::<contacts::Contacts>(),
            Self::Temperature(_) => py.get_type::<rules::Temperature>(),
            Self::Ageing(ageing) => rules::class(ageing, py),
            Self::Transport(..) => py.get_type::<transport::Transport>(),
            Self::Step(_) => py.get_type::<transport::Step>(),
            Self::MasterEquation(..) => py.get_type::<equation::MasterEquation>(),
            Self::Ensemble(..) => py.get_type::<ensemble::Ensemble>(),
            Self::Slip(slip) => block::slip_class(*slip, py),
            Self::Block(_) => py.get_type::<block::Block>(),
            Self::Surface(surface) => match surface.own.contacts {
                PerCell::Many => py.get_type::<interface::Interface>(),
                PerCell::One => py.get_type::<lattice::Lattice>(),
            },
        }
    }

    /// The arguments from which Python creates the same object, without those that have their default.
    fn arguments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arguments = PyDict::new(py);
        match self {
            Self::Law(law) => distributions::arguments(law, &arguments),
            Self::Areas(areas) => contacts::areas_arguments(areas, &arguments),
            Self::Contacts(contacts) => contacts::arguments(contacts, &arguments),
            Self::Temperature(temperature) => rules::temperature_arguments(temperature, &arguments),
            Self::Ageing(ageing) => rules::ageing_arguments(ageing, &arguments),
            Self::Transport(interface, own) => transport::arguments(interface, own, &arguments),
            Self::Step(step) => transport::step_arguments(step, &arguments),
            Self::MasterEquation(interface, own) => equation::arguments(interface, own, &arguments),
            Self::Ensemble(interface, own) => ensemble::arguments(interface, own, &arguments),
            Self::Slip(slip) => block::slip_arguments(*slip, &arguments),
            Self::Block(slider) => block::arguments(slider, &arguments),
            Self::Surface(surface) => surface::arguments(surface, &arguments),
        }?;
        Ok(arguments)
    }
}

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

    /// The description as a part of a scenario; `None` if it has no place there.
    pub fn toml(&self) -> Option<Value> {
        let value = match &self.plain {
            Plain::Law(law) => Value::try_from(law),
            Plain::Areas(areas) => Value::try_from(areas),
            Plain::Contacts(contacts) => Value::try_from(contacts),
            Plain::Slip(slip) => Value::try_from(slip),
            Plain::Temperature(temperature) => Value::try_from(temperature),
            Plain::Ageing(ageing) => Value::try_from(ageing),
            Plain::Step(step) => Value::try_from(step),
            Plain::MasterEquation(..)
            | Plain::Transport(..)
            | Plain::Ensemble(..)
            | Plain::Block(_)
            | Plain::Surface(_) => return None,
        };
        value.ok()
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
        self.json()?.hash(&mut hasher);
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
