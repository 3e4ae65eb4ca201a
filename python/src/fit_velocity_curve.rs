//! Fits of contacts to forces of steady sliding at several velocities.

use asperity::fit::{self, MeasuredVelocityCurve, Prior, VelocityCurveFit};
use asperity::monitor::Part;
use asperity::scenario::{TaskStart, Units};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{IntoPyDict, PyDict};

use crate::argument::{self, Argument, GivenPriors, Optional as _, Real, Whole};
use crate::contacts::Contacts;
use crate::convert::{self, Seed};
use crate::equation::MasterEquation;
use crate::estimate_methods::methods_of_estimates;
use crate::fitted_model::fitted_model;
use crate::found::{Arguments, FittedNumbers, Search};
use crate::model::interface;
use crate::pickle::{self, Reduced};
use crate::plain::Interface;
use crate::posterior::Posterior;
use crate::record::Record;
use crate::solver::built;
use crate::watch::watched;
use crate::{error, typed, values};

/// Fits numbers of contacts to forces of steady sliding at several velocities.
///
/// The readings are F_k(v) + B + offset + errors, with the kinetic friction F_k of the stationary renewal process at the
/// velocity v, and the background force B of the contacts. Errors are independent and normal: each of its own standard
/// deviation (error), or all of one size, which is given (reading) or estimated. The most probable values are found by the
/// method of Levenberg and Marquardt with derivatives by central differences. If all times of the contacts are free, the
/// search begins also with those multiplied by one factor, from 1e-4 to 1e4, that are most like the curve.
///
/// Parameters
/// ----------
/// contacts
///     As for MasterEquation; their free numbers are first values.
/// velocity
///     The n velocities, above 0, in any order; a velocity may occur several times.
/// force
///     The n measured forces, each the mean over a distance of steady sliding.
/// free
///     The names of the numbers to vary: those of Pull.parameters, such as "thresholds.mean", "count", "ageing.growth",
///     "temperature.energy" and "delay", but not of initial stretches nor the velocity; "background" and "offset". The
///     curve does not determine both count and stiffness unless the contacts have a temperature, nor both background and
///     offset.
/// error
///     The n standard deviations of the errors of the forces, above 0.
/// reading
///     The standard deviation of every force, instead of error; estimated if both are None.
/// offset
///     The reading of the force where there is none.
/// prior
///     As for fit.
/// progress
///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
///
/// Returns
/// -------
/// VelocityCurveEstimates
///
/// Raises
/// ------
/// ValueError
///     For velocities or errors that are not above 0, forces that are not finite, lists of different lengths, an unknown or
///     repeated name in free, none in it, a prior of a number that is not free or whose error is not above 0, fewer forces
///     than free numbers, or no more where the size of errors is estimated, error beside reading, and numbers that the curve
///     does not determine. A search that does not converge is no error: see VelocityCurveEstimates.converged.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), ageing=asp.Logarithmic(growth=0.1, time=3.0))
/// >>> velocity, force = [0.01, 0.1, 1.0, 10.0], [0.7515, 0.6460, 0.5497, 0.5227]
/// >>> free = ["ageing.growth", "ageing.time"]
/// >>> found = asp.fit_velocity_curve(contacts, velocity, force, free=free, reading=0.002)
/// >>> bool(found.converged and not found.misfit.unlikely)
/// True
#[pyfunction(name = "fit_velocity_curve")]
#[pyo3(
    signature = (
        contacts, velocity: "ArrayLike", force: "ArrayLike", *, free: "Sequence[str]", error: "ArrayLike | None" = None,
        reading = None, offset = Real::new(0.0), prior: "Mapping[str, tuple[float, float]] | None" = None,
        progress: "_Progress" = None
    ),
    text_signature = "(contacts, velocity, force, *, free, error=None, reading=None, offset=0.0, prior=None, progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub fn fit_velocity_curve(
    py: Python<'_>,
    contacts: Argument<Bound<'_, Contacts>>,
    velocity: &Bound<'_, PyAny>,
    force: &Bound<'_, PyAny>,
    free: Argument<Vec<String>>,
    error: Option<Bound<'_, PyAny>>,
    reading: Option<Real>,
    offset: Real,
    prior: Option<Argument<GivenPriors>>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<VelocityCurveEstimates> {
    let contacts = &contacts.get("contacts")?;
    let free = free.get("free")?;
    let reading = reading.get("reading")?;
    let offset = offset.get("offset")?;
    let prior = argument::priors(prior)?.unwrap_or_default();
    let interface = interface(contacts, None, "conditional")?;
    let background = interface.contacts.background().map_err(error::core)?;
    let curve = MeasuredVelocityCurve {
        velocities: convert::list("velocity", velocity)?,
        forces: convert::list("force", force)?,
        errors: error.as_ref().map(|error| convert::list("error", error)).transpose()?,
    };
    let found = watched(progress, py, |monitor| {
        let (own, _) = built(&interface, &mut Part::new(monitor, 0.0, 0.01))?;
        let fit = VelocityCurveFit::new(own, curve).free(free.iter().cloned());
        let mut fit = fit.background(background).offset(offset);
        if let Some(reading) = reading {
            fit = fit.reading(reading);
        }
        let known = prior.iter();
        let fit = known.fold(fit, |fit, (name, &(value, error))| fit.prior(name, Prior { value, error }));
        fit.run_with(&mut Part::new(monitor, 0.01, 0.99))
    })?;
    let named = PyDict::new(py);
    named.set_item("contacts", contacts)?;
    named.set_item("velocity", convert::row(py, found.curve().velocities.clone())?)?;
    named.set_item("force", convert::row(py, found.curve().forces.clone())?)?;
    named.set_item("free", &free)?;
    let errors = found.curve().errors.clone();
    named.set_item("error", errors.map(|errors| convert::row(py, errors)).transpose()?)?;
    named.set_item("reading", reading)?;
    named.set_item("offset", offset)?;
    named.set_item("prior", prior)?;
    let arguments = Arguments { function: "fit_velocity_curve", named: named.unbind(), law: None };
    VelocityCurveEstimates::new(py, found, interface, &free, arguments)
}

/// What a fit to forces of steady sliding at several velocities has found: values of the free numbers with their errors, and
/// how well they describe the forces.
///
/// Printed, or by `summary()`, it is a table. `curve` has the readings and the fitted curve with its error.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), delay=0.5)
/// >>> velocity, force = [0.1, 1.0, 10.0], [0.488, 0.349, 0.092]
/// >>> found = asp.fit_velocity_curve(contacts, velocity, force, free=["delay"], reading=0.002)
/// >>> bool(abs(found.params["delay"].value - 0.47) < 0.02)
/// True
#[pyclass(frozen, module = "asperity")]
pub struct VelocityCurveEstimates {
    reported: FittedNumbers,
    search: Search<Self, fit::VelocityCurveEstimates>,
    arguments: Arguments,
    model: Py<MasterEquation>,
    curve: Py<Record>,
}

impl VelocityCurveEstimates {
    fn new(
        py: Python<'_>,
        found: fit::VelocityCurveEstimates,
        mut first: Interface,
        free: &[String],
        arguments: Arguments,
    ) -> PyResult<Self> {
        if free.iter().any(|name| name == "background") {
            first.contacts.background_force = Some(found.background);
            first.contacts.background_coefficient = None;
        }
        first.start = TaskStart::Conditional;
        let slowest = found.curve().velocities.iter().copied().fold(f64::INFINITY, f64::min);
        let model = fitted_model(py, found.equation(), (first, Some(slowest)), free)?;
        let curve =
            Py::new(py, Record::new(py, asperity::task::velocity_curve_of_fit(&found), Units::default())?)?;
        let (reported, search) = (FittedNumbers::of_velocity_curve(&found), Search::Own(Box::new(found)));
        Ok(Self { reported, search, arguments, model: model.unbind(), curve })
    }

    /// The end of the search, which an object from a pickle makes again.
    fn found(&self, py: Python<'_>) -> PyResult<&fit::VelocityCurveEstimates> {
        self.search.get(py, &self.arguments, |same| same.get().search.own())
    }

    /// The object that was pickled.
    pub fn restored(
        arguments: Arguments,
        content: &[u8],
        (model, curve): (Py<MasterEquation>, Py<Record>),
    ) -> PyResult<Self> {
        let (reported, search) = (FittedNumbers::read(content)?, Search::Again(PyOnceLock::new()));
        Ok(Self { reported, search, arguments, model, curve })
    }
}

methods_of_estimates!(VelocityCurveEstimates);

#[pymethods]
impl VelocityCurveEstimates {
    /// The free numbers by name: each an Estimate.
    #[getter]
    fn params<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimates<'py>> {
        values::estimates(py, &self.reported.parameters())
    }

    /// The numbers that were not free: those of the contacts, and background and offset if they are not 0.
    #[getter]
    fn fixed<'py>(&self, py: Python<'py>) -> PyResult<typed::Fixed<'py>> {
        Ok(typed::Fixed(self.reported.fixed.clone().into_py_dict(py)?.into_any()))
    }

    /// The number of curves that the search computed, without those for derivatives.
    #[getter]
    fn solutions(&self) -> usize {
        self.reported.solutions
    }

    /// The number of measured forces.
    #[getter]
    fn readings(&self) -> usize {
        self.reported.readings
    }

    /// How well the forces are described, a Misfit. The test of whiteness is that of residuals in the order of velocities.
    #[getter]
    fn misfit<'py>(&self, py: Python<'py>) -> PyResult<typed::Misfit<'py>> {
        let misfit = self.reported.misfit.as_ref().ok_or_else(|| pickle::damaged("a planned measurement"))?;
        values::misfit(py, misfit)
    }

    /// The standard deviation of a reading, given or estimated, a force; the root mean square of errors that differ.
    #[getter]
    fn reading(&self) -> f64 {
        self.reported.reading
    }

    /// The reading of the force where there is none, given or estimated, a force.
    #[getter]
    fn offset(&self) -> f64 {
        self.reported.offset
    }

    /// The contacts of the estimated numbers.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, Contacts>> {
        self.model.bind(py).getattr("contacts")?.cast_into().map_err(PyErr::from)
    }

    /// The master equation of the estimated numbers, at the lowest velocity.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<MasterEquation> {
        self.model.clone_ref(py)
    }

    /// The readings and the fitted curve, a Record.
    ///
    /// `reading_velocity`, `reading_friction`, `reading_expected_friction`, `reading_friction_std` and
    /// `reading_friction_residual` are of shape (n,): velocities, measured and expected forces, the standard deviations of the
    /// measured ones, and the residuals divided by them. `fit_velocity`, `fit_friction` and `fit_friction_error` are of shape
    /// (33,): velocities at equal ratios, the expected force with background and offset, and its standard error, which
    /// follows from the covariance of the estimates.
    #[getter]
    fn curve(&self, py: Python<'_>) -> Py<Record> {
        self.curve.clone_ref(py)
    }

    /// A table in plain English: values with errors and intervals, correlations, and how well the forces are described.
    ///
    /// Returns
    /// -------
    /// str
    fn summary(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("velocity_curve_summary", (slf,))?.extract()
    }

    /// Plots the measured forces with their errors and the fitted curve with twice its standard error, against the logarithm
    /// of the velocity. Returns the axes. It needs matplotlib.
    ///
    /// Parameters
    /// ----------
    /// ax
    ///     Axes to plot on; new ones if None.
    /// **style
    ///     Arguments of the plot() of the fitted curve.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
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
        slf.py().import("asperity._pictures")?.call_method("velocity_curve_fit", (slf, ax), style)
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, this) = (slf.py(), slf.get());
        let parts = (&this.model, &this.curve).into_pyobject(py)?;
        this.arguments.reduced(py, &this.reported.written()?, parts)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("velocity_curve_text", (slf,))?.extract()
    }

    fn _repr_html_(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("velocity_curve_html", (slf,))?.extract()
    }
}
