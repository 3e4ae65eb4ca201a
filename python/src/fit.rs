//! Fits of contacts to measured curves of force.

use std::collections::BTreeMap;

use asperity::Error;
use asperity::contacts::Stiffness;
use asperity::fit::{ErrorModel, Fit, Machine, Measurement, Prior, Readings};
use asperity::law::Parameter;
use asperity::master;
use asperity::monitor::{Monitor, Part};
use asperity::record::{self, Quantity};
use asperity::scenario::{self, Units};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyDict;

use crate::contacts::Contacts;
use crate::convert::{self, Domain, Seed, Whole};
use crate::description::{Interface, Plain, Solved};
use crate::equation::MasterEquation;
use crate::found::{Arguments, FittedNumbers, Search};
use crate::law::{AnyLaw, set_parameter};
use crate::measured::{self, Compliance};
use crate::model::{built, interface};
use crate::pickle::{self, Reduced};
use crate::posterior::Posterior;
use crate::pull::Pull;
use crate::record::Record;
use crate::watch::watched;
use crate::{error, typed, values};

/// Fits numbers of contacts, and of the machine, to one or more measured curves of force.
///
/// A reading of the force at the position y is F(X) + B + offset + trend y + an error, where y = origin + X + compliance
/// (F(X) + B), F(X) is the force of the contacts on a pull, and B their background force. The most probable values are
/// found by Fisher scoring, and their errors follow from the expected information.
///
/// Parameters
/// ----------
/// contacts, initial, start, velocity
///     As for MasterEquation; their free numbers are first values.
/// position
///     Positions y of the n readings, rising: of the slider, or of the drive if compliance is not 0. A list of such
///     lists for several curves, whose noise is that of different contacts.
/// force
///     The n measured forces, or a list of such lists; or None for a planned measurement, for which the result has
///     the errors that the free numbers would have, at their first values.
/// free
///     The names of the numbers to vary: those of Pull.parameters, such as "thresholds.mean", "reforming.std",
///     "count" and "stiffness", and "background", "compliance", "offset", "trend" and "origin". Each is common to all
///     curves; a name after "curve.0.", "curve.1.", ... is that of a number of one curve, such as "curve.1.offset".
/// noise
///     "contacts" if errors contain the noise of the N_c contacts, whose covariance is known: count is then their
///     number, not 1 for forces per contact; "white" if they are independent. With "white", count and stiffness
///     cannot both be free.
/// reading
///     The standard deviation of the independent error of a reading, after averaging; estimated if None.
/// drift
///     The longest correlation length of a slow drift of the force, below a quarter of the range of positions; its
///     size and its length are then estimated. No drift if None.
/// compliance
///     Displacement of the drive against the slider per force, of slider and machine together; "free" if it is to be
///     found, from a first value that follows from the steepest slope of the curve.
/// offset
///     The reading of the force where there is none.
/// trend
///     The change of that reading per length.
/// origin
///     The reading of the position at X = 0.
/// prior
///     For some of the free numbers what is known beforehand, {name: (value, error)}: a normal distribution, of the
///     logarithm for numbers above 0.
/// average
///     The number of neighbouring readings to replace by their mean; with noise "contacts" or a drift at most 4000
///     may remain.
/// laws
///     Names of distributions of thresholds, such as "gamma" and "lognormal", for each of which the same fit is made
///     with all its numbers free instead of those of contacts.thresholds: Estimates.laws.
/// progress
///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
///
/// Returns
/// -------
/// Estimates
///
/// Raises
/// ------
/// ValueError
///     For invalid values, and for numbers that the curve does not determine. A search that does not converge is no
///     error: see Estimates.converged.
///
/// Examples
/// --------
/// >>> import numpy as np
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), count=1000, stiffness=0.001)
/// >>> position = np.linspace(0.05, 3.0, 60)
/// >>> force = asp.MasterEquation(contacts).pull(3.0).sample_paths(position, 1, size=1000, seed=1)[0]
/// >>> found = asp.fit(contacts, position, force, free=['thresholds.mean', 'thresholds.std'], reading=1e-4)
/// >>> found.converged
/// True
/// >>> bool(abs(found.params['thresholds.mean'].value - 1.0) < 4 * found.params['thresholds.mean'].error)
/// True
#[pyfunction(name = "fit")]
#[pyo3(
    signature = (
        contacts, position: "ArrayLike", force: "ArrayLike | None", *, free: "Sequence[str]", initial = None,
        start: "Literal['conditional', 'relaxed']" = "conditional", velocity = None,
        noise: "Literal['contacts', 'white']" = "contacts", reading = None, drift = None,
        compliance = Compliance::Known(0.0), offset = 0.0, trend = 0.0, origin = 0.0, prior: "Mapping[str, tuple[float, float]] | None" = None, average = Whole::new(1),
        laws: "Sequence[str]" = Vec::new(), progress: "_Progress" = None
    ),
    text_signature = "(contacts, position, force, *, free, initial=None, start='conditional', velocity=None, noise='contacts', reading=None, drift=None, compliance=0.0, offset=0.0, trend=0.0, origin=0.0, prior=None, average=1, laws=(), progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub fn fit(
    py: Python<'_>,
    contacts: &Bound<'_, Contacts>,
    position: &Bound<'_, PyAny>,
    force: Option<&Bound<'_, PyAny>>,
    free: Vec<String>,
    initial: Option<AnyLaw>,
    start: &str,
    velocity: Option<f64>,
    noise: &str,
    reading: Option<f64>,
    drift: Option<f64>,
    compliance: Compliance,
    offset: f64,
    trend: f64,
    origin: f64,
    prior: Option<BTreeMap<String, (f64, f64)>>,
    average: Whole,
    laws: Vec<String>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Estimates> {
    let given = Given {
        contacts: contacts.clone(),
        start: start.to_owned(),
        compliance: compliance.to_object(py)?,
        free: free.clone(),
        prior: prior.clone().unwrap_or_default(),
        laws: laws.clone(),
        noise: noise.to_owned(),
        numbers: [("velocity", velocity), ("reading", reading), ("drift", drift)],
        machine: [("offset", offset), ("trend", trend), ("origin", origin)],
    };
    let interface = interface(contacts, initial, start)?;
    let known = if let Compliance::Known(compliance) = compliance { compliance } else { 0.0 };
    let background = interface.contacts.background().map_err(error::core)?;
    let machine = Machine { compliance: known, background, offset, trend, origin };
    let measured =
        measured::curves(position, force, (machine, &compliance), (average, together(&interface)?))?;
    let mut names = free;
    if matches!(compliance, Compliance::Free) && !names.iter().any(|name| name == "compliance") {
        names.push("compliance".to_owned());
    }
    let errors = ErrorModel { contacts: noise_of_contacts(noise)?, reading, drift };
    let prior = prior.unwrap_or_default();
    let families: Vec<_> = laws
        .iter()
        .enumerate()
        .map(|(i, name)| scenario::threshold_family(&format!("laws.{i}"), name).map_err(error::core))
        .collect::<PyResult<_>>()?;
    let (found, others) = watched(progress, py, |monitor| {
        let first = MasterEquation::build(&interface, velocity, &mut Part::new(monitor, 0.0, 0.05))?;
        let mut measured = measured.into_iter();
        let fit = Fit::new(first.equation, measured.next().expect("a list has at least one curve"));
        let fit = measured.fold(fit, Fit::curve).free(names).errors(errors);
        let fit = prior
            .into_iter()
            .fold(fit, |fit, (name, (value, error))| fit.prior(&name, Prior { value, error }));
        let share = 0.95 / (1 + families.len()) as f64;
        let found = fit.run_with(&mut Part::new(monitor, 0.05, share)).map_err(of_argument)?;
        let others = families.iter().enumerate().map(|(i, family)| {
            let start = 0.05 + (i + 1) as f64 * share;
            of_family(&fit, &found, family, &mut Part::new(monitor, start, share))
        });
        let others = others.collect::<asperity::Result<Vec<_>>>()?;
        Ok((found, others))
    })?;
    let compared = PyDict::new(py);
    let arguments = given.arguments(py, &interface, &found)?;
    for (name, (law, found)) in laws.iter().zip(others) {
        let mut interface = interface.clone();
        interface.contacts.thresholds = Some(law);
        let arguments = arguments.of_law(py, name)?;
        let of_law = Estimates::new(py, found, (interface, velocity), PyDict::new(py), arguments)?;
        compared.set_item(name, of_law)?;
    }
    Estimates::new(py, found, (interface, velocity), compared, arguments)
}

/// The arguments of a fit but for its curves.
struct Given<'py> {
    contacts: Bound<'py, Contacts>,
    start: String,
    compliance: Py<PyAny>,
    free: Vec<String>,
    prior: BTreeMap<String, (f64, f64)>,
    laws: Vec<String>,
    noise: String,
    numbers: [(&'static str, Option<f64>); 3],
    machine: [(&'static str, f64); 3],
}

impl Given<'_> {
    /// All arguments by name, with the curves as they were averaged.
    fn arguments(
        &self,
        py: Python<'_>,
        interface: &Interface,
        found: &asperity::fit::Estimates,
    ) -> PyResult<Arguments> {
        let named = PyDict::new(py);
        let curves = |of: fn(&Measurement) -> &Vec<f64>| {
            found
                .curves()
                .iter()
                .map(|curve| convert::row(py, of(curve).clone()))
                .collect::<PyResult<Vec<_>>>()
        };
        named.set_item("contacts", &self.contacts)?;
        named.set_item("position", curves(|curve| &curve.positions)?)?;
        let forces = found.misfit.map(|_| curves(|curve| &curve.forces)).transpose()?;
        named.set_item("force", forces)?;
        named.set_item("initial", Plain::Law(interface.initial.clone()).instance::<crate::law::Law>(py)?)?;
        for (name, value) in self.numbers {
            named.set_item(name, value)?;
        }
        for (name, value) in self.machine {
            named.set_item(name, value)?;
        }
        named.set_item("start", &self.start)?;
        named.set_item("noise", &self.noise)?;
        named.set_item("compliance", &self.compliance)?;
        named.set_item("free", &self.free)?;
        named.set_item("prior", &self.prior)?;
        named.set_item("laws", &self.laws)?;
        Ok(Arguments { function: "fit", named: named.unbind(), law: None })
    }
}

/// The fit with thresholds of another family, from the mean and the standard deviation of the fitted ones.
fn of_family(
    fit: &Fit,
    found: &asperity::fit::Estimates,
    family: &scenario::ParametricFamily,
    monitor: &mut dyn Monitor,
) -> asperity::Result<(scenario::Law, asperity::fit::Estimates)> {
    let thresholds = &found.equation().contacts().thresholds;
    let law = (family.member)(thresholds.mean(), thresholds.std() / thresholds.mean());
    let fit = fit.with_thresholds(law.build()?, &mut Part::new(monitor, 0.0, 0.1))?;
    Ok((law, fit.run_with(&mut Part::new(monitor, 0.1, 0.9))?))
}

/// N⟨k⟩ of the first contacts.
fn together(interface: &Interface) -> PyResult<f64> {
    let (contacts, _) = built(interface).map_err(error::core)?;
    Ok(contacts.count * contacts.stiffness.of(contacts.thresholds.mean()))
}

/// Whether errors contain the noise of contacts.
fn noise_of_contacts(noise: &str) -> PyResult<bool> {
    match noise {
        "contacts" => Ok(true),
        "white" => Ok(false),
        other => Err(error::invalid("noise", "contacts or white", other)),
    }
}

/// An error about the argument that Python gave.
fn of_argument(mut error: Error) -> Error {
    if let Error::Invalid { key, .. } = &mut error
        && key == "drift.longest"
    {
        "drift".clone_into(key);
    }
    error
}

/// What a fit has found: values of the free numbers with their errors, and how well they describe the curve.
///
/// Printed, or by `summary()`, it is a table. `readings` has the measured curve as the fit describes it.
#[pyclass(frozen, module = "asperity")]
pub struct Estimates {
    told: FittedNumbers,
    search: Search<Self, asperity::fit::Estimates>,
    arguments: Arguments,
    model: Py<MasterEquation>,
    pull: Py<Pull>,
    readings: Py<Record>,
    laws: Py<PyDict>,
}

impl Estimates {
    fn new(
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
        let pull = Pull::computed(model.clone(), found.pull(0).clone())?;
        let readings = Py::new(py, Record::new(py, columns(&found), Units::default())?)?;
        let (told, laws) = (FittedNumbers::of(&found), laws.unbind());
        Ok(Self {
            told,
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
        let (told, search) = (FittedNumbers::read(content)?, Search::Again(PyOnceLock::new()));
        Ok(Self { told, search, arguments, model, pull, readings, laws })
    }
}

#[pymethods]
impl Estimates {
    /// The free numbers by name, and after them the sizes of errors that were estimated: each an Estimate.
    #[getter]
    fn params<'py>(&self, py: Python<'py>) -> PyResult<typed::Estimates<'py>> {
        values::estimates(py, &self.told.parameters())
    }

    /// The covariance of the estimates in the order of `params`, shape (n, n).
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        convert::square(py, self.told.covariance.clone()).map(typed::Array)
    }

    /// The correlations above 0.5, without sign, between the errors of two estimates: a list of Correlation.
    #[getter]
    fn correlations<'py>(&self, py: Python<'py>) -> PyResult<typed::Correlations<'py>> {
        values::correlations(py, self.told.correlations.clone())
    }

    /// Whether the search has converged; otherwise the estimates are its last values.
    #[getter]
    fn converged(&self) -> bool {
        self.told.converged
    }

    /// The number of solutions of the master equation that the search took.
    #[getter]
    fn solutions(&self) -> usize {
        self.told.solutions
    }

    /// How well the curve is described, a Misfit; None for a planned measurement.
    #[getter]
    fn misfit<'py>(&self, py: Python<'py>) -> PyResult<Option<typed::Misfit<'py>>> {
        self.told.misfit.as_ref().map(|misfit| values::misfit(py, misfit)).transpose()
    }

    /// The standard deviation of the independent error of a reading, given or estimated, a force.
    #[getter]
    fn reading(&self) -> f64 {
        self.told.reading
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
        values::prediction(py, predicted)
    }

    /// The thresholds of free form that fit the curve: a density without a name, as smooth as the curve allows.
    ///
    /// The logarithm of the density is a sum of Gaussian kernels over eight standard deviations of the fitted thresholds to
    /// either side of their mean. Third differences of its coefficients are held small, by as much as is most probable, so
    /// that what the curve does not tell is continued like a Gaussian. The other free numbers are found again.
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
    ///     If no number of the thresholds was free.
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

    /// The profile of the likelihood of a free number: by how much -2 ln L, lowest in all other free numbers, is above
    /// its minimum.
    ///
    /// Parameters
    /// ----------
    /// name
    ///     A name of `params`.
    /// values
    ///     A list of values, or None for 13 from three standard errors below the estimate to three above it; of the
    ///     logarithm for numbers above 0.
    /// progress
    ///     As for MasterEquation.pull.
    ///
    /// Returns
    /// -------
    /// Profile
    #[pyo3(signature = (name, values: "ArrayLike | None" = None, *, progress: "_Progress" = None))]
    fn profile<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        values: Option<&Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<typed::Profile<'py>> {
        /// As many as show whether a profile is a parabola.
        const VALUES: usize = 13;
        let found = self.found(py)?;
        let values = match values {
            Some(values) => convert::list_within("values", values, &Domain::NUMBERS)?,
            None => found.profile_values(name, VALUES).map_err(error::core)?,
        };
        let rise = watched(progress, py, |monitor| {
            let share = 1.0 / values.len() as f64;
            let one = |(i, &value): (usize, &f64)| {
                found.profile(name, value, &mut Part::new(monitor, i as f64 * share, share))
            };
            values.iter().enumerate().map(one).collect()
        })?;
        values::profile(py, values, rise)
    }

    /// The interval of 95 % of a free number by the profile of the likelihood: where -2 ln L, lowest in all other free
    /// numbers, has risen by 3.84.
    ///
    /// Parameters
    /// ----------
    /// name
    ///     A name of `params`.
    /// progress
    ///     As for MasterEquation.pull.
    ///
    /// Returns
    /// -------
    /// (float, float)
    #[pyo3(signature = (name, *, progress: "_Progress" = None))]
    fn interval_by_profile(
        &self,
        py: Python<'_>,
        name: &str,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<(f64, f64)> {
        let found = self.found(py)?;
        let [low, high] = watched(progress, py, |monitor| found.interval_by_profile(name, monitor))?;
        Ok((low, high))
    }

    /// ln L at values of the free numbers, and its gradient, for samplers and other searches.
    ///
    /// Parameters
    /// ----------
    /// values
    ///     A list of n numbers in the order of `params`.
    ///
    /// Returns
    /// -------
    /// (float, numpy.ndarray)
    ///     ln L, with the logarithm of the priors, and an array of shape (n,); -inf and nan where there is no curve.
    ///     The covariance of the noise of contacts is that of the estimates, scaled by N_c⟨k⟩². With independent
    ///     errors whose size is estimated, ln L is the highest for any size.
    #[pyo3(signature = (values: "ArrayLike"))]
    fn log_likelihood<'py>(
        &self,
        py: Python<'py>,
        values: &Bound<'py, PyAny>,
    ) -> PyResult<(f64, typed::Array<'py>)> {
        let values = convert::list("values", values)?;
        let found = self.found(py)?;
        let (value, gradient) = watched(None, py, |monitor| found.log_likelihood(&values, monitor))?;
        Ok((value, typed::Array(convert::row(py, gradient)?)))
    }

    /// Draws from the posterior by the No-U-turn sampler (NUTS), where errors from the information are not enough.
    ///
    /// The priors are those of the fit; without one the prior of a number is flat, or flat in the logarithm of one above 0.
    /// The covariance of the noise of contacts is that of the estimates, scaled by N_c⟨k⟩². Each chain makes 300 draws
    /// before, which are left out.
    ///
    /// Parameters
    /// ----------
    /// draws
    ///     The number of draws of each chain, 4 or more.
    /// chains
    ///     Their number, 1 or more; as many are made at a time as there are threads.
    /// seed
    ///     A whole number below 2^63, which always gives the same draws, on any number of threads, or a
    ///     numpy.random.Generator, from which one is drawn.
    /// progress
    ///     As for MasterEquation.pull.
    /// threads
    ///     The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default those of
    ///     the process, one per core or RAYON_NUM_THREADS.
    ///
    /// Returns
    /// -------
    /// Posterior
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a planned measurement, and if no number is known to better than a limit.
    #[pyo3(
        signature = (draws = Whole::new(1000), chains = Whole::new(4), seed = Seed(1), *, progress: "_Progress" = None, threads = None),
        text_signature = "(self, draws=1000, chains=4, seed=1, *, progress=None, threads=None)"
    )]
    fn sample(
        &self,
        py: Python<'_>,
        draws: Whole,
        chains: Whole,
        seed: Seed,
        progress: Option<Bound<'_, PyAny>>,
        threads: Option<Whole>,
    ) -> PyResult<Posterior> {
        let found = self.found(py)?;
        Posterior::sample(py, || found.standardised(), (draws, chains, seed), (progress, threads))
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
        pickle::reduced_fit(py, &this.arguments, this.told.written()?, parts)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("text", (slf,))?.extract()
    }

    fn _repr_html_(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._fit")?.call_method1("html", (slf,))?.extract()
    }
}

/// The equation of the estimated numbers, with the description of its contacts.
pub fn fitted_model<'py>(
    py: Python<'py>,
    equation: &master::MasterEquation,
    first: (Interface, Option<f64>),
    free: &[String],
) -> PyResult<Bound<'py, MasterEquation>> {
    let (interface, velocity) = fitted(first, equation, &equation.parameters(), free);
    let (_, initial) = built(&interface).map_err(error::core)?;
    let model = MasterEquation { equation: equation.clone(), initial };
    let solved = Solved { own: scenario::MasterEquation::default(), velocity };
    Bound::new(py, model.described(interface, solved))
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

/// The description of the fitted contacts: the first one with the estimates in the place of free numbers.
fn fitted(
    (mut interface, mut velocity): (Interface, Option<f64>),
    equation: &master::MasterEquation,
    parameters: &[Parameter],
    free: &[String],
) -> (Interface, Option<f64>) {
    // The description is that of the first curve.
    let free: Vec<&str> = free.iter().map(|name| name.strip_prefix("curve.0.").unwrap_or(name)).collect();
    let owner = |name: &str| LAWS.into_iter().find(|owner| is_of(name, owner));
    for Parameter { name, value } in parameters {
        let owner = owner(name);
        // The weights of a mixture change together.
        let changed = free.iter().any(|free| *free == name || owner.is_some_and(|owner| is_of(free, owner)));
        match owner {
            _ if !changed => {}
            Some(owner) => set_of_law(&mut interface, owner, &name[owner.len() + 1..], *value),
            None => set_number(&mut interface.contacts, &mut velocity, name, *value),
        }
    }
    if let Some(areas) = &mut interface.contacts.areas
        && free.iter().any(|free| ["thresholds.factor", "stiffness_per_threshold"].contains(free))
    {
        set_areas(areas, equation);
    }
    (interface, velocity)
}

/// The distributions by name.
const LAWS: [&str; 4] = ["thresholds", "reforming", "initial", "ageing.mature"];

/// Whether a number is a parameter of the distribution `owner`.
fn is_of(name: &str, owner: &str) -> bool {
    name.strip_prefix(owner).is_some_and(|rest| rest.starts_with('.'))
}

fn set_of_law(interface: &mut Interface, owner: &str, name: &str, to: f64) {
    let Interface { contacts, initial, .. } = interface;
    if let ("delay", Some(scenario::Delay::Law(law))) = (owner, &mut contacts.delay) {
        return set_parameter(law, name, to);
    }
    let law = match (owner, &mut contacts.areas, &mut contacts.ageing) {
        ("thresholds", Some(_), _) if name == "factor" => return,
        ("thresholds", Some(areas), _) => Some(&mut areas.law),
        ("thresholds", None, _) => contacts.thresholds.as_mut(),
        ("reforming", ..) => Some(&mut contacts.reforming),
        ("initial", ..) => Some(initial),
        (
            _,
            _,
            Some(
                scenario::Ageing::Smoluchowski { mature, .. }
                | scenario::Ageing::FrozenRank { mature, .. }
                | scenario::Ageing::MeanField { mature, .. },
            ),
        ) => Some(mature),
        _ => None,
    };
    set_parameter(law.expect("a distribution that was fitted"), name, to);
}

fn set_number(contacts: &mut scenario::Contacts, velocity: &mut Option<f64>, name: &str, to: f64) {
    let (temperature, ageing) = (&mut contacts.temperature, &mut contacts.ageing);
    match (name, temperature, ageing) {
        ("count", ..) => contacts.count = to,
        ("stiffness", ..) => contacts.stiffness = Some(to),
        ("stiffness_per_threshold", ..) if contacts.areas.is_some() => {}
        ("stiffness_per_threshold", ..) => contacts.stiffness_per_threshold = Some(to),
        ("temperature.energy", Some(heat), _) => heat.energy = to,
        ("temperature.attempt_rate", Some(heat), _) => heat.attempt_rate = to,
        ("ageing.growth", _, Some(scenario::Ageing::Logarithmic { growth, .. })) => *growth = to,
        (
            "ageing.time",
            _,
            Some(scenario::Ageing::Logarithmic { time, .. } | scenario::Ageing::FrozenRank { time, .. }),
        ) => *time = to,
        (
            "ageing.diffusion",
            _,
            Some(
                scenario::Ageing::Smoluchowski { diffusion, .. }
                | scenario::Ageing::MeanField { diffusion, .. },
            ),
        ) => *diffusion = to,
        ("delay", ..) => contacts.delay = Some(scenario::Delay::Time(to)),
        ("velocity", ..) => *velocity = Some(to),
        _ => unreachable!("a number without a place"),
    }
}

/// The modulus m and the strength s of areas, from κ = m²/s and the factor s/m of the thresholds.
fn set_areas(areas: &mut scenario::Areas, equation: &master::MasterEquation) {
    let contacts = equation.contacts();
    let known = contacts.thresholds.parameters().into_iter().find(|parameter| parameter.name == "factor");
    if let (Stiffness::PerThreshold(kappa), Some(Parameter { value: factor, .. })) =
        (&contacts.stiffness, known)
    {
        (areas.modulus, areas.strength) = (kappa * factor, kappa * factor * factor);
    }
}
