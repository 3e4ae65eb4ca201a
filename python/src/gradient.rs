//! Derivatives of the force on a pull, and of the numbers of friction.

use asperity::master;
use asperity::monitor::Monitor;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::convert::{self, Domain, evaluate};
use crate::pickle::{self, Reduced, again};
use crate::record::Record;
use crate::typed;
use crate::watch::watched;

/// The pull on which a derivative was computed.
pub struct Source {
    /// The columns of the pull, whose method computes the derivative again.
    pub pull: Py<Record>,
    pub distance: f64,
}

impl Source {
    fn positions(&self) -> Domain {
        Domain::positions(self.distance)
    }
}

/// The derivative of the force on a pull by a parameter, called with positions: `gradient(5.0)`.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0)
/// >>> gradient = pull.gradient("thresholds.mean")
/// >>> gradient.parameter
/// 'thresholds.mean'
/// >>> gradient([0.5, 1.0]).shape
/// (2,)
#[pyclass(frozen, module = "asperity")]
pub struct Gradient {
    gradient: master::Gradient,
    parameter: String,
    from: Source,
}

impl Gradient {
    /// A derivative on a pull.
    pub const fn new(gradient: master::Gradient, parameter: String, from: Source) -> Self {
        Self { gradient, parameter, from }
    }
}

#[pymethods]
impl Gradient {
    /// The parameter, such as `thresholds.mean`.
    #[getter]
    fn parameter(&self) -> &str {
        &self.parameter
    }

    /// The derivative at positions from 0 to the distance of the pull: force per unit of the parameter.
    #[pyo3(signature = (position: "float; ArrayLike") -> "float; _Array")]
    fn __call__<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        evaluate("position", position, &self.from.positions(), |x| self.gradient.at(x))
    }

    /// Plots the derivative at the positions of the pull; it needs matplotlib, whose styles it follows.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Axes to plot on; new ones by default.
    /// **style
    ///     Arguments of the plot() of the axes.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///     The axes.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(signature = (ax: "Axes | None" = None, **style: "Any") -> "Axes")]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let position = slf.get().from.pull.bind(slf.py()).get_item("position")?;
        slf.py().import("asperity._plot")?.call_method("gradient", (slf, position, ax), style)
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        again(self.from.pull.bind(py), "gradient", PyTuple::new(py, [&self.parameter])?)
    }

    fn __repr__(&self) -> String {
        format!("<derivative of the force by {}>", self.parameter)
    }
}

/// The response of the force on a pull to the probability of n single thresholds, a force per unit of probability.
///
/// Called with a position it is an array of shape (n,), with a list of m positions one of shape (n, m).
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0)
/// >>> response = pull.threshold_response([0.9, 1.1])
/// >>> response(1.5).shape
/// (2,)
#[pyclass(frozen, module = "asperity")]
pub struct ThresholdResponse {
    response: master::ThresholdResponse,
    from: Source,
}

impl ThresholdResponse {
    /// The response on a pull.
    pub const fn new(response: master::ThresholdResponse, from: Source) -> Self {
        Self { response, from }
    }
}

#[pymethods]
impl ThresholdResponse {
    /// The thresholds, shape (n,).
    #[getter]
    fn thresholds<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        convert::row(py, self.response.thresholds().collect()).map(typed::Array)
    }

    #[pyo3(signature = (position: "ArrayLike"))]
    fn __call__<'py>(&self, position: &Bound<'py, PyAny>) -> PyResult<typed::Array<'py>> {
        let count = self.response.thresholds().len();
        let rows = |positions: &[f64], monitor: &mut dyn Monitor| self.response.rows_with(positions, monitor);
        convert::evaluate_rows(("position", position), &self.from.positions(), count, rows).map(typed::Array)
    }

    /// The derivatives of a scalar by the probability of each threshold, shape (n,).
    ///
    /// Parameters
    /// ----------
    /// position
    ///     A list of m positions from 0 to the distance of the pull.
    /// weights
    ///     The derivatives of the scalar by the forces at these positions.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a position below 0 or beyond the distance, and another number of weights than of positions.
    #[pyo3(signature = (position: "ArrayLike", weights: "ArrayLike"))]
    fn adjoint<'py>(
        &self,
        py: Python<'py>,
        position: &Bound<'py, PyAny>,
        weights: &Bound<'py, PyAny>,
    ) -> PyResult<typed::Array<'py>> {
        let positions = convert::list_within("position", position, &self.from.positions())?;
        let weights = convert::list("weights", weights)?;
        let found = watched(None, py, |monitor| self.response.adjoint_with(&positions, &weights, monitor))?;
        convert::row(py, found).map(typed::Array)
    }

    /// Plots the response to some of the thresholds, seven at most, at the positions of the pull; it needs matplotlib, whose
    /// styles it follows.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Axes to plot on; new ones by default.
    /// **style
    ///     Arguments of the plot() of the axes.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///     The axes.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(signature = (ax: "Axes | None" = None, **style: "Any") -> "Axes")]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let position = slf.get().from.pull.bind(slf.py()).get_item("position")?;
        slf.py().import("asperity._plot")?.call_method("threshold_response", (slf, position, ax), style)
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let thresholds: Vec<f64> = self.response.thresholds().collect();
        again(self.from.pull.bind(py), "threshold_response", PyTuple::new(py, [thresholds])?)
    }

    fn __repr__(&self) -> String {
        format!(
            "<response of the force to the probability of {} thresholds>",
            self.response.thresholds().len()
        )
    }
}

/// The derivatives of static and kinetic friction, relaxation length and critical stiffness by a parameter.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0)
/// >>> change = pull.friction_gradient("thresholds.mean")
/// >>> round(change.kinetic_friction, 3)
/// 0.495
#[pyclass(frozen, module = "asperity")]
pub struct FrictionGradient {
    gradient: master::FrictionGradient,
}

impl FrictionGradient {
    pub const fn new(gradient: master::FrictionGradient) -> Self {
        Self { gradient }
    }
}

#[pymethods]
impl FrictionGradient {
    /// ∂F_s/∂θ, force per unit of the parameter; None if the static friction is not reached.
    #[getter]
    fn static_friction(&self) -> Option<f64> {
        self.gradient.static_friction
    }

    /// ∂F_k/∂θ, force per unit of the parameter.
    #[getter]
    fn kinetic_friction(&self) -> f64 {
        self.gradient.kinetic_friction
    }

    /// ∂X*/∂θ, length per unit of the parameter; nan if X* is not finite.
    #[getter]
    fn relaxation_length(&self) -> f64 {
        self.gradient.relaxation_length
    }

    /// ∂K_c/∂θ, force per length and unit of the parameter; nan if K_c is not finite, 0 if it is 0.
    #[getter]
    fn critical_stiffness(&self) -> f64 {
        self.gradient.critical_stiffness
    }

    /// Plots the derivatives as bars, each in units of its own; it needs matplotlib, whose styles it follows.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Axes to plot on; new ones by default.
    /// **style
    ///     Arguments of the bar() of the axes.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///     The axes.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(signature = (ax: "Axes | None" = None, **style: "Any") -> "Axes")]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._plot")?.call_method("friction_gradient", (slf, ax), style)
    }

    fn __repr__(&self) -> String {
        let Self { gradient } = self;
        let peak = gradient.static_friction.map_or_else(|| "not reached".into(), |force| force.to_string());
        format!(
            "<derivatives of friction: F_s {peak}, F_k {}, X* {}, K_c {}>",
            gradient.kinetic_friction, gradient.relaxation_length, gradient.critical_stiffness
        )
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        pickle::reduced(py, "FrictionGradient", &pickle::pack(&self.gradient, &[])?, None)
    }
}

impl FrictionGradient {
    /// The derivatives of a pickle.
    pub fn restored(py: Python<'_>, bytes: &[u8]) -> PyResult<Py<PyAny>> {
        let (gradient, _) = pickle::unpack(bytes)?;
        Ok(Py::new(py, Self { gradient })?.into_any())
    }
}
