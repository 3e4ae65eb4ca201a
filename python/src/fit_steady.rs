//! Fits of contacts to a record of the force in steady sliding.

use asperity::fit::{Prior, SteadyFit, SteadyRecord};
use asperity::monitor::Part;
use asperity::record::{self, Quantity};
use asperity::scenario::Units;
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
use crate::law::AnyLaw;
use crate::model::interface;
use crate::pickle::{self, Reduced};
use crate::plain::{Interface, Plain, Solved};
use crate::posterior::Posterior;
use crate::record::Record;
use crate::solver::EquationSolver;
use crate::watch::watched;
use crate::{error, typed, values};

/// Fits numbers of contacts to a record of the force in steady sliding: to its mean and to its noise.
///
/// The force of the N_c contacts is a stationary process with the mean F_k and a known autocovariance, to which
/// independent errors of readings are added. The likelihood is the debiased one of Whittle: the components of the
/// discrete Fourier transform count as independent, with their exact variances, aliasing and leakage included.
///
/// Parameters
/// ----------
/// contacts, velocity
///     As for MasterEquation; their free numbers are first values.
/// spacing
///     The displacement of the slider from one reading to the next, above 0.
/// force
///     The n measured forces, 16 or more for each free number; none of them before sliding is steady.
/// free
///     The names of the numbers to vary: those of Pull.parameters, such as "thresholds.mean", "reforming.std",
///     "count" and "stiffness", but not of initial stretches, of which steady sliding is independent; and "offset".
///     Thresholds and re-forming stretches cannot all be shifted together with count and stiffness free; with
///     "offset", count and stiffness cannot both be free, unless one has a prior.
/// initial, start
///     As for MasterEquation; only the static friction and the critical stiffness of the result depend on them.
/// reading
///     The standard deviation of the independent error of a reading; estimated if None.
/// offset
///     The reading of the force where there is none.
/// prior
///     As for fit.
/// progress
///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
///
/// Returns
/// -------
/// SteadyEstimates
///
/// Raises
/// ------
/// ValueError
///     For a spacing that is not above 0, an unknown or repeated name in free, none in it, a prior of a number that is
///     not free or whose error is not above 0, fewer than 16 forces for each free number, forces that are not finite
///     or do not scatter, a reading below 0, contacts with a background force or whose spectrum has lines, and numbers
///     that the record does not determine. A search that does not converge is no error: see SteadyEstimates.converged.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=2000, stiffness=0.0005)
/// >>> pull = asp.Ensemble(contacts, size=2000, seed=1).pull(60.0, 2401)
/// >>> force = pull.force[400:]
/// >>> found = asp.fit_steady(contacts, 0.025, force, free=['thresholds.mean'], reading=1e-5)
/// >>> bool(abs(found.params['thresholds.mean'].value - 1.0) < 0.05)
/// True
#[pyfunction(name = "fit_steady")]
#[pyo3(
    signature = (
        contacts, spacing, force: "ArrayLike", *, free: "Sequence[str]", initial = None,
        start: "Literal['conditional', 'relaxed']" = Argument::text("conditional"), velocity = None, reading = None, offset = Real::new(0.0),
        prior: "Mapping[str, tuple[float, float]] | None" = None, progress: "_Progress" = None
    ),
    text_signature = "(contacts, spacing, force, *, free, initial=None, start='conditional', velocity=None, reading=None, offset=0.0, prior=None, progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub fn fit_steady(
    py: Python<'_>,
    contacts: Argument<Bound<'_, Contacts>>,
    spacing: Real,
    force: &Bound<'_, PyAny>,
    free: Argument<Vec<String>>,
    initial: Option<Argument<AnyLaw>>,
    start: Argument<String>,
    velocity: Option<Real>,
    reading: Option<Real>,
    offset: Real,
    prior: Option<Argument<GivenPriors>>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<SteadyEstimates> {
    let contacts = &contacts.get("contacts")?;
    let spacing = spacing.get("spacing")?;
    let free = free.get("free")?;
    let start = start.get("start")?;
    let velocity = velocity.get("velocity")?;
    let reading = reading.get("reading")?;
    let offset = offset.get("offset")?;
    let prior = argument::priors(prior)?;
    let interface = interface(contacts, initial.get("initial")?, &start)?;
    let background = interface.contacts.background().map_err(error::core)?;
    if background > 0.0 {
        let expected = "none: offset is the constant part of a measured force";
        return Err(error::invalid("contacts.background_force", expected, background));
    }
    let measured = SteadyRecord { spacing, forces: convert::list("force", force)? };
    let prior = prior.unwrap_or_default();
    let known = prior.clone();
    let solved = Solved { own: asperity::scenario::MasterEquation::default(), velocity };
    let found = watched(progress, py, |monitor| {
        let first = EquationSolver::new(&interface, &solved, &mut Part::new(monitor, 0.0, 0.05))?;
        let mut fit = SteadyFit::new(first.equation, measured).free(free.iter().cloned()).offset(offset);
        if let Some(reading) = reading {
            fit = fit.reading(reading);
        }
        let fit = prior
            .into_iter()
            .fold(fit, |fit, (name, (value, error))| fit.prior(&name, Prior { value, error }));
        fit.run_with(&mut Part::new(monitor, 0.05, 0.95))
    })?;
    let named = PyDict::new(py);
    named.set_item("contacts", contacts)?;
    named.set_item("spacing", spacing)?;
    named.set_item("force", convert::row(py, found.record().forces.clone())?)?;
    named.set_item("free", &free)?;
    named.set_item("initial", Plain::Law(interface.initial.clone()).instance::<crate::law::Law>(py)?)?;
    named.set_item("start", start)?;
    named.set_item("velocity", velocity)?;
    named.set_item("reading", reading)?;
    named.set_item("offset", offset)?;
    named.set_item("prior", known)?;
    let arguments = Arguments { function: "fit_steady", named: named.unbind(), law: None };
    SteadyEstimates::new(py, found, (interface, velocity), &free, arguments)
}

/// What a fit to a record of steady sliding has found: values of the free numbers with their errors, and how well they
/// describe the record.
///
/// Printed, or by `summary()`, it is a table. `spectrum` has the periodogram of the record with its expectation.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=2000, stiffness=0.0005)
/// >>> force = asp.Ensemble(contacts, size=2000, seed=1).pull(60.0, 2401).force[400:]
/// >>> found = asp.fit_steady(contacts, 0.025, force, free=["thresholds.mean"], reading=1e-5)
/// >>> bool(abs(found.params["thresholds.mean"].value - 1.0) < 0.05)
/// True
#[pyclass(frozen, module = "asperity")]
pub struct SteadyEstimates {
    reported: FittedNumbers,
    search: Search<Self, asperity::fit::SteadyEstimates>,
    arguments: Arguments,
    model: Py<MasterEquation>,
    spectrum: Py<Record>,
}

impl SteadyEstimates {
    fn new(
        py: Python<'_>,
        found: asperity::fit::SteadyEstimates,
        first: (Interface, Option<f64>),
        free: &[String],
        arguments: Arguments,
    ) -> PyResult<Self> {
        let model = fitted_model(py, found.equation(), first, free)?;
        let spectrum = Py::new(py, Record::new(py, columns(&found), Units::default())?)?;
        let (reported, search) = (FittedNumbers::of_steady(&found), Search::Own(Box::new(found)));
        Ok(Self { reported, search, arguments, model: model.unbind(), spectrum })
    }

    /// The end of the search, which an object from a pickle makes again.
    fn found(&self, py: Python<'_>) -> PyResult<&asperity::fit::SteadyEstimates> {
        self.search.get(py, &self.arguments, |same| same.get().search.own())
    }

    /// The object that was pickled.
    pub fn restored(
        arguments: Arguments,
        content: &[u8],
        (model, spectrum): (Py<MasterEquation>, Py<Record>),
    ) -> PyResult<Self> {
        let (reported, search) = (FittedNumbers::read(content)?, Search::Again(PyOnceLock::new()));
        Ok(Self { reported, search, arguments, model, spectrum })
    }
}

methods_of_estimates!(SteadyEstimates);

#[pymethods]
impl SteadyEstimates {
    /// The free numbers by name, and after them "reading" if it was estimated: each an Estimate.
    #[getter]
    fn params<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimates<'py>> {
        values::estimates(py, &self.reported.parameters())
    }

    /// The numbers that were not free: those of the contacts, and the offset if it is not 0.
    #[getter]
    fn fixed<'py>(&self, py: Python<'py>) -> PyResult<typed::Fixed<'py>> {
        Ok(typed::Fixed(self.reported.fixed.clone().into_py_dict(py)?.into_any()))
    }

    /// The number of solutions of the master equation that the search took, without those for derivatives.
    #[getter]
    fn solutions(&self) -> usize {
        self.reported.solutions
    }

    /// The number of readings of the record.
    #[getter]
    fn readings(&self) -> usize {
        self.reported.readings
    }

    /// How well the record is described, a Misfit: of its Fourier components, each divided by its expected size.
    #[getter]
    fn misfit<'py>(&self, py: Python<'py>) -> PyResult<typed::Misfit<'py>> {
        let misfit = self.reported.misfit.as_ref().ok_or_else(|| pickle::damaged("a planned measurement"))?;
        values::misfit(py, misfit)
    }

    /// The standard deviation of the independent error of a reading, given or estimated, a force.
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

    /// The master equation of the estimated numbers.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<MasterEquation> {
        self.model.clone_ref(py)
    }

    /// The periodogram of the record of n readings, a Record of arrays of shape (n // 2,).
    ///
    /// `wave_number` is q = 2πk/(n spacing), k = 1, 2, ..., `periodogram` the squared modulus of the discrete Fourier
    /// transform times spacing/n, and `expected` its expectation by the estimated contacts, with aliasing, leakage and the
    /// error of a reading.
    #[getter]
    fn spectrum(&self, py: Python<'_>) -> Py<Record> {
        self.spectrum.clone_ref(py)
    }

    /// F_s, F_k, X* and K_c of the estimated contacts, each with its standard error. F_s and K_c are those of a pull from
    /// the initial stretches, of which the record contains nothing.
    ///
    /// Returns
    /// -------
    /// FrictionEstimates
    fn friction<'py>(&self, py: Python<'py>) -> PyResult<typed::FrictionEstimates<'py>> {
        let found = self.found(py)?;
        values::friction(py, &watched(None, py, |monitor| found.friction(monitor))?)
    }

    /// A table in plain English: values with errors and intervals, correlations, and how well the record is described.
    ///
    /// Returns
    /// -------
    /// str
    fn summary(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("steady_summary", (slf,))?.extract()
    }

    /// Plots the periodogram as dots and its expectation as a line, on logarithmic axes. Returns the axes. It needs
    /// matplotlib.
    ///
    /// Parameters
    /// ----------
    /// ax
    ///     Axes to plot on; new ones if None. Other arguments are passed to the plot() of the expectation.
    /// **style
    ///     Arguments of the plot() of the expectation.
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
        slf.py().import("asperity._pictures")?.call_method("steady_fit", (slf, ax), style)
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, this) = (slf.py(), slf.get());
        let parts = (&this.model, &this.spectrum).into_pyobject(py)?;
        this.arguments.reduced(py, &this.reported.written()?, parts)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("steady_text", (slf,))?.extract()
    }

    fn _repr_html_(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("steady_html", (slf,))?.extract()
    }
}

/// The periodogram as columns.
fn columns(found: &asperity::fit::SteadyEstimates) -> record::Record {
    let spectrum = &found.spectrum;
    let mut record = record::Record::default();
    let mut add = |name, words, quantity, values: &[f64]| {
        record.push(name, words, quantity, &["wave_number"], values.to_vec());
    };
    add("wave_number", "wave number q, radians per length", Quantity::PerLength, &spectrum.wave_numbers);
    add("periodogram", "measured periodogram", Quantity::ForceSquaredLength, &spectrum.periodogram);
    add("expected", "expected periodogram", Quantity::ForceSquaredLength, &spectrum.expected);
    record
}
