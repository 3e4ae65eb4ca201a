//! Fits of contacts to measured curves of force.

use asperity::Error;
use asperity::fit::{ErrorModel, Fit, Machine, Measurement, Prior};
use asperity::monitor::{Monitor, Part};
use asperity::scenario;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::{self, Argument, GivenPriors, Optional as _, Priors, Real, Whole};
use crate::contacts::Contacts;
use crate::convert;
use crate::error;
use crate::estimates::Estimates;
use crate::found::Arguments;
use crate::law::AnyLaw;
use crate::measured::{self, Compliance};
use crate::model::interface;
use crate::plain::{Interface, Plain, Solved};
use crate::solver::{EquationSolver, built};
use crate::watch::watched;

/// Fits numbers of contacts, and of the machine, to one or more measured curves of force.
///
/// A reading of the force at the position y is F(X) + B + offset + trend y + an error, where y = origin + X + compliance
/// (F(X) + B), F(X) is the force of the contacts on a pull, and B their background force. The most probable values are
/// found by Fisher scoring, and their errors follow from the expected information; sizes of errors are those of the highest
/// restricted likelihood.
///
/// Parameters
/// ----------
/// contacts, initial, velocity
///     As for MasterEquation; their free numbers are first values.
/// start
///     "conditional" or "relaxed", as for MasterEquation; the pull of a fit does not begin in steady sliding.
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
/// position_error
///     The standard deviation of the independent error of a position, a length, with noise "white": the error of a force
///     is then larger by it times the slope of the curve. Exact positions if None.
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
///     logarithm for numbers above 0 but a compliance.
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
///     For an unknown or repeated name in free, none in it, a prior of a number that is not free or whose error is not
///     above 0, an unknown name in laws, a first value that is not above 0 where it has to be, lists of different
///     lengths or with numbers that are not finite, positions that do not rise, fewer readings than free numbers and
///     two, a constant force, forces of the other sign, positions in another unit than lengths of the contacts, an
///     average of 0, a reading, a position_error or a drift that is not above 0, a drift of a quarter of the range of positions or more, a position_error with the noise of contacts,
///     another word as noise, and numbers that the curve does not determine. A search that does not converge is no
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
        start: "Literal['conditional', 'relaxed']" = Argument::text("conditional"), velocity = None,
        noise: "Literal['contacts', 'white']" = Argument::text("contacts"), reading = None,
        position_error = None, drift = None,
        compliance = Compliance::Known(0.0), offset = Real::new(0.0), trend = Real::new(0.0), origin = Real::new(0.0), prior: "Mapping[str, tuple[float, float]] | None" = None, average = Whole::new(1),
        laws: "Sequence[str]" = Argument::new(Vec::new()), progress: "_Progress" = None
    ),
    text_signature = "(contacts, position, force, *, free, initial=None, start='conditional', velocity=None, noise='contacts', reading=None, position_error=None, drift=None, compliance=0.0, offset=0.0, trend=0.0, origin=0.0, prior=None, average=1, laws=(), progress=None)"
)]
#[expect(clippy::too_many_arguments, reason = "they are named in Python")]
pub fn fit(
    py: Python<'_>,
    contacts: Argument<Bound<'_, Contacts>>,
    position: &Bound<'_, PyAny>,
    force: Option<&Bound<'_, PyAny>>,
    free: Argument<Vec<String>>,
    initial: Option<Argument<AnyLaw>>,
    start: Argument<String>,
    velocity: Option<Real>,
    noise: Argument<String>,
    reading: Option<Real>,
    position_error: Option<Real>,
    drift: Option<Real>,
    compliance: Compliance,
    offset: Real,
    trend: Real,
    origin: Real,
    prior: Option<Argument<GivenPriors>>,
    average: Whole,
    laws: Argument<Vec<String>>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Estimates> {
    let contacts = &contacts.get("contacts")?;
    let free = free.get("free")?;
    let start = start.get("start")?;
    let velocity = velocity.get("velocity")?;
    let noise = noise.get("noise")?;
    let reading = reading.get("reading")?;
    let position_error = position_error.get("position_error")?;
    let drift = drift.get("drift")?;
    let offset = offset.get("offset")?;
    let trend = trend.get("trend")?;
    let origin = origin.get("origin")?;
    let prior = argument::priors(prior)?;
    let laws = laws.get("laws")?;
    let given = Given {
        contacts: contacts.clone(),
        start: start.clone(),
        compliance: compliance.to_object(py)?,
        free: free.clone(),
        prior: prior.clone().unwrap_or_default(),
        laws: laws.clone(),
        noise: noise.clone(),
        numbers: [
            ("velocity", velocity),
            ("reading", reading),
            ("position_error", position_error),
            ("drift", drift),
        ],
        machine: [("offset", offset), ("trend", trend), ("origin", origin)],
    };
    let interface = interface(contacts, initial.get("initial")?, &start)?;
    let known = if let Compliance::Known(compliance) = compliance { compliance } else { 0.0 };
    let background = interface.contacts.background().map_err(error::core)?;
    let machine = Machine { compliance: known, background, offset, trend, origin };
    let measured =
        measured::curves(position, force, (machine, &compliance), (average, together(py, &interface)?))?;
    let mut names = free;
    if matches!(compliance, Compliance::Free) && !names.iter().any(|name| name == "compliance") {
        names.push("compliance".to_owned());
    }
    let errors =
        ErrorModel { contacts: noise_of_contacts(&noise)?, reading, drift, position: position_error };
    let prior = prior.unwrap_or_default();
    let families: Vec<_> = laws
        .iter()
        .enumerate()
        .map(|(i, name)| scenario::threshold_family(&format!("laws.{i}"), name).map_err(error::core))
        .collect::<PyResult<_>>()?;
    let solved = Solved { own: scenario::MasterEquation::default(), velocity };
    let (found, others) = watched(progress, py, |monitor| {
        let first = EquationSolver::new(&interface, &solved, &mut Part::new(monitor, 0.0, 0.05))?;
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
    prior: Priors,
    laws: Vec<String>,
    noise: String,
    numbers: [(&'static str, Option<f64>); 4],
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
fn together(py: Python<'_>, interface: &Interface) -> PyResult<f64> {
    let (contacts, _) = watched(None, py, |monitor| built(interface, monitor))?;
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
