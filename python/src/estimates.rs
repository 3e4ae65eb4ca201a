//! What a fit to curves has found, as a class of Python.

use asperity::fit::{Measurement, Readings};
use asperity::record::{self, Quantity};
use asperity::scenario::{self, Units};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{IntoPyDict, PyDict};

use crate::argument::{Argument, Whole};
use crate::contacts::Contacts;
use crate::convert::{self, Seed};
use crate::equation::MasterEquation;
use crate::estimate_methods::methods_of_estimates;
use crate::fitted_model::fitted_model;
use crate::found::{Arguments, FittedNumbers, Search};
use crate::pickle::Reduced;
use crate::plain::{Interface, Plain};
use crate::posterior::Posterior;
use crate::pull::Pull;
use crate::record::Record;
use crate::watch::watched;
use crate::{typed, values};

/// What a fit has found: values of the free numbers with their errors, and how well they describe the curve.
///
/// Printed, or by `summary()`, it is a table. `readings` has the measured curve as the fit describes it.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.2), count=1000)
/// >>> x = [0.2 * i for i in range(20)]
/// >>> force = asp.MasterEquation(contacts).pull(4.0)(x)
/// >>> fitted = asp.fit(contacts, x, force, free=["thresholds.mean"])
/// >>> round(fitted.params["thresholds.mean"].value, 3)
/// 1.0
#[pyclass(frozen, module = "asperity")]
pub struct Estimates {
    reported: FittedNumbers,
    search: Search<Self, asperity::fit::Estimates>,
    arguments: Arguments,
    model: Py<MasterEquation>,
    pull: Py<Pull>,
    readings: Py<Record>,
    laws: Py<PyDict>,
}

impl Estimates {
    pub fn new(
        py: Python<'_>,
        found: asperity::fit::Estimates,
        (mut first, velocity): (Interface, Option<f64>),
        laws: Bound<'_, PyDict>,
        arguments: Arguments,
    ) -> PyResult<Self> {
        let names: Vec<String> = found.parameters.iter().map(|estimate| estimate.name.clone()).collect();
        if names.iter().any(|name| name == "background" || name == "curve.0.background") {
            first.contacts.background_force = Some(found.machine(0).background);
            first.contacts.background_coefficient = None;
        }
        let model = fitted_model(py, found.equation(), (first, velocity), &names)?;
        let pull = Pull::computed(model.as_super().clone(), found.pull(0).clone())?;
        let readings = Py::new(py, Record::new(py, columns(&found), Units::default())?)?;
        let (reported, laws) = (FittedNumbers::of(&found), laws.unbind());
        Ok(Self {
            reported,
            search: Search::Own(Box::new(found)),
            arguments,
            model: model.unbind(),
            pull,
            readings,
            laws,
        })
    }
}

impl Estimates {
    /// The end of the search, which an object from a pickle makes again.
    fn found(&self, py: Python<'_>) -> PyResult<&asperity::fit::Estimates> {
        self.search.get(py, &self.arguments, |same| same.get().search.own())
    }

    /// The object that was pickled.
    pub fn restored(
        arguments: Arguments,
        content: &[u8],
        (model, pull): (Py<MasterEquation>, Py<Pull>),
        (readings, laws): (Py<Record>, Py<PyDict>),
    ) -> PyResult<Self> {
        let (reported, search) = (FittedNumbers::read(content)?, Search::Again(PyOnceLock::new()));
        Ok(Self { reported, search, arguments, model, pull, readings, laws })
    }
}

methods_of_estimates!(Estimates);

#[pymethods]
impl Estimates {
    /// The free numbers by name, and after them the sizes of errors that were estimated: each an Estimate.
    #[getter]
    fn params<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimates<'py>> {
        values::estimates(py, &self.reported.parameters())
    }

    /// The numbers that were not free: those of the contacts, and those of the machine that are not 0.
    #[getter]
    fn fixed<'py>(&self, py: Python<'py>) -> PyResult<typed::Fixed<'py>> {
        Ok(typed::Fixed(self.reported.fixed.clone().into_py_dict(py)?.into_any()))
    }

    /// Whether the readings are farther apart than a third of the mean life of the fitted contacts. Contacts whose lives are
    /// longer or shorter by a factor may then have the same forces there, and the search may have found them.
    #[getter]
    fn sparse(&self) -> bool {
        self.reported.sparse
    }

    /// The number of solutions of the master equation that the search took.
    #[getter]
    fn solutions(&self) -> usize {
        self.reported.solutions
    }

    /// How well the curve is described, a Misfit; None for a planned measurement.
    #[getter]
    fn misfit<'py>(&self, py: Python<'py>) -> PyResult<Option<typed::Misfit<'py>>> {
        self.reported.misfit.as_ref().map(|misfit| values::misfit(py, misfit)).transpose()
    }

    /// The standard deviation of the independent error of a reading, given or estimated, a force.
    #[getter]
    fn reading(&self) -> f64 {
        self.reported.reading
    }

    /// The same fit with other distributions of thresholds, by their names: a dict of Estimates. Misfit.akaike compares them:
    /// a distribution is hardly the one that made the curve where it is more than 10 above the lowest.
    #[getter]
    fn laws<'py>(&self, py: Python<'py>) -> typed::Laws<'py> {
        typed::Laws(self.laws.bind(py).clone().into_any())
    }

    /// The contacts of the estimated numbers; of the first curve where curves differ.
    #[getter]
    fn contacts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, Contacts>> {
        self.model.bind(py).getattr("contacts")?.cast_into().map_err(PyErr::from)
    }

    /// The master equation of the estimated numbers.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<MasterEquation> {
        self.model.clone_ref(py)
    }

    /// The pull of the estimated contacts, up to the last reading; of the first curve where curves differ.
    #[getter]
    fn pull(&self, py: Python<'_>) -> Py<Pull> {
        self.pull.clone_ref(py)
    }

    /// The readings as the fit describes them, a Record of arrays of shape (n,).
    ///
    /// `position` and `force` are the measured ones, after averaging; `slider_position` is X; `expected` is the expected
    /// force and `std` the standard deviation of a reading about it; `residual` is the measured minus the expected
    /// force, and `whitened` the whitened residuals, which are independent and of variance 1 if the description
    /// holds. A planned measurement has no `force`, `residual` and `whitened`. Several curves follow one another; `curve` is
    /// the number of the curve then.
    #[getter]
    fn readings(&self, py: Python<'_>) -> Py<Record> {
        self.readings.clone_ref(py)
    }

    /// The readings that are expected at positions, as they are measured, with their scatter and their errors.
    ///
    /// Parameters
    /// ----------
    /// position
    ///     A list of positions in any order, within the range of the measured ones or beyond it.
    /// curve
    ///     The number of the curve.
    ///
    /// Returns
    /// -------
    /// Prediction
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    /// ValueError
    ///     For a position that is not finite or before which the machine slips, and a curve that does not exist.
    #[pyo3(signature = (position: "ArrayLike", curve = Whole::new(0)), text_signature = "(self, position, curve=0)")]
    fn predict<'py>(
        &self,
        py: Python<'py>,
        position: &Bound<'py, PyAny>,
        curve: Whole,
    ) -> PyResult<typed::Prediction<'py>> {
        let (positions, curve) = (convert::list("position", position)?, curve.get("curve")?);
        let found = self.found(py)?;
        let predicted = watched(None, py, |monitor| found.predict(curve, &positions, monitor))?;
        values::prediction(py, positions, predicted)
    }

    /// The thresholds of free form that fit the curve: a density without a name, as smooth as the curve allows.
    ///
    /// The logarithm of the density is a sum of Gaussian kernels over eight standard deviations of the fitted thresholds to
    /// either side of their mean. Third differences of its coefficients are held small, by as much as is most probable, so
    /// that what the curve does not determine is continued like a Gaussian. The other free numbers are found again.
    ///
    /// Parameters
    /// ----------
    /// kernels
    ///     Their number, 12 or more.
    /// progress
    ///     As for MasterEquation.pull.
    ///
    /// Returns
    /// -------
    /// FreeForm
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     If no number of the thresholds was free, and for a planned measurement.
    #[pyo3(
        signature = (kernels = Whole::new(36), *, progress: "_Progress" = None),
        text_signature = "(self, kernels=36, *, progress=None)"
    )]
    fn free_form<'py>(
        &self,
        py: Python<'py>,
        kernels: Whole,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<typed::FreeForm<'py>> {
        let kernels = kernels.get("kernels")?;
        let found = self.found(py)?;
        let form = watched(progress, py, |monitor| found.free_form(kernels, monitor))?;
        let series = form.thresholds.series();
        let law = scenario::Law::Series {
            boundaries: series.boundaries().to_vec(),
            coefficients: series.coefficients().iter().map(|cell| cell.to_vec()).collect(),
            cut: 0.0,
        };
        let law = Plain::Law(law).instance::<crate::law::Law>(py)?;
        values::free_form(py, &form, law.into_any())
    }

    /// F_s, F_k, X* and K_c of the estimated contacts, each with its standard error.
    ///
    /// Returns
    /// -------
    /// FrictionEstimates
    fn friction<'py>(&self, py: Python<'py>) -> PyResult<typed::FrictionEstimates<'py>> {
        let found = self.found(py)?;
        values::friction(py, &watched(None, py, |monitor| found.friction(monitor))?)
    }

    /// A table in plain English: values with errors and intervals, correlations, and how well the curve is described.
    ///
    /// Returns
    /// -------
    /// str
    fn summary(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("summary", (slf,))?.extract()
    }

    /// Plots the readings with the expected force and a band of two standard deviations of a reading to either side, and
    /// below them the whitened residuals. Returns the axes. It needs matplotlib.
    ///
    /// Parameters
    /// ----------
    /// axes
    ///     Two axes to plot on, one below the other; new ones if None. Other arguments are passed to the plot() of
    ///     the expected force. A planned measurement is plotted on the first of them only.
    /// **style
    ///     Arguments of the plot() of the expected force.
    ///
    /// Returns
    /// -------
    /// (matplotlib.axes.Axes, ...)
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(signature = (axes: "Sequence[Axes] | None" = None, **style: "Any") -> "tuple[Axes, ...]")]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        axes: Option<&Bound<'py, PyAny>>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._plot")?.call_method("fit", (slf, axes), style)
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, this) = (slf.py(), slf.get());
        let parts = (&this.model, &this.pull, &this.readings, &this.laws).into_pyobject(py)?;
        this.arguments.reduced(py, &this.reported.written()?, parts)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("text", (slf,))?.extract()
    }

    fn _repr_html_(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("html", (slf,))?.extract()
    }
}

/// The readings as columns, one curve after the other.
fn columns(found: &asperity::fit::Estimates) -> record::Record {
    let (curves, described) = (found.curves(), &found.readings);
    let mut record = record::Record::default();
    let mut add = |name, words, quantity, values: Vec<f64>| {
        record.push(name, words, quantity, &["reading"], values);
    };
    let measured = |of: fn(&Measurement) -> &Vec<f64>| curves.iter().flat_map(of).copied().collect();
    let all = |of: fn(&Readings) -> &Vec<f64>| described.iter().flat_map(of).copied().collect();
    if curves.len() > 1 {
        let number = |(c, curve): (usize, &Measurement)| vec![c as f64; curve.positions.len()];
        let numbers = curves.iter().enumerate().flat_map(number).collect();
        add("curve", "number of the curve", Quantity::Count, numbers);
    }
    add("position", "measured position", Quantity::Length, measured(|curve| &curve.positions));
    let known = found.misfit.is_some();
    if known {
        add("force", "measured force", Quantity::Force, measured(|curve| &curve.forces));
    }
    add(
        "slider_position",
        "position X of the slider's base",
        Quantity::Length,
        all(|curve| &curve.positions),
    );
    add("expected", "expected force", Quantity::Force, all(|curve| &curve.expected));
    add("std", "standard deviation of a reading", Quantity::Force, all(|curve| &curve.std));
    if known {
        add("residual", "measured minus expected force", Quantity::Force, all(|curve| &curve.residuals));
        add("whitened", "whitened residual", Quantity::Number, all(|curve| &curve.whitened));
    }
    record
}
