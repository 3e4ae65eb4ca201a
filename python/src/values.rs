//! Small results: named tuples and tables of the package.

use asperity::block::Curve;
use asperity::energy::EnergyBalance;
use asperity::fit;
use asperity::law::Atom;
use asperity::master::Stretches;
use asperity::rate_state::{self, MeasuredValue};
use asperity::record::{Quantity, Record};
use asperity::task::LinearStability;
use asperity::task::summary::{PosteriorSummary, SimulatedStickSlip, SliderState, StickSlipNumbers};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::convert::{Import, array, row};
use crate::typed::{
    Atoms, BlockEnergy, Correlations, Course, Equilibria, Estimate, Estimates, Events, FreeForm,
    FrictionEstimates, InterfaceEnergy, MachineHealing, MachineStep, MeasuredNoise, Misfit, PosteriorNumbers,
    Potential, Prediction, Profile, Sizes, Stability, State, StaticFriction, StickSlipStability,
    StretchDensity,
};

static STATIC_FRICTION: Import = Import::new("asperity._values", "StaticFriction");
static ATOMS: Import = Import::new("asperity._values", "Atoms");
static STRETCH_DENSITY: Import = Import::new("asperity._values", "StretchDensity");
static LABEL: Import = Import::new("asperity._values", "Label");
static STATE: Import = Import::new("asperity._slider_values", "State");
static ENERGY: Import = Import::new("asperity._slider_values", "Energy");
static INTERFACE_ENERGY: Import = Import::new("asperity._slider_values", "InterfaceEnergy");
static ROW: Import = Import::new("asperity._events", "row");
static EQUILIBRIA: Import = Import::new("asperity._slider_values", "Equilibria");
static POTENTIAL: Import = Import::new("asperity._slider_values", "Potential");
static EVENTS: Import = Import::new("asperity._events", "Events");
static ESTIMATE: Import = Import::new("asperity._fit_values", "Estimate");
static DRIFT: Import = Import::new("asperity._fit_values", "Drift");
static MEASURED_NOISE: Import = Import::new("asperity._fit_values", "MeasuredNoise");
static STABILITY: Import = Import::new("asperity._slider_values", "Stability");
static SIMULATED_STICK_SLIP: Import = Import::new("asperity._slider_values", "SimulatedStickSlip");
static STICK_SLIP_STABILITY: Import = Import::new("asperity._slider_values", "StickSlipStability");
static MACHINE_HEALING: Import = Import::new("asperity._fit_values", "MachineHealing");
static MACHINE_STEP: Import = Import::new("asperity._fit_values", "MachineStep");
static SIZES: Import = Import::new("asperity._slider_values", "Sizes");
static COURSE: Import = Import::new("asperity._slider_values", "Course");
static CORRELATION: Import = Import::new("asperity._fit_values", "Correlation");
static MISFIT: Import = Import::new("asperity._fit_values", "Misfit");
static WITH_ERROR: Import = Import::new("asperity._fit_values", "WithError");
static FREE_FORM: Import = Import::new("asperity._fit_values", "FreeForm");
static FRICTION_ESTIMATES: Import = Import::new("asperity._fit_values", "FrictionEstimates");
static PREDICTION: Import = Import::new("asperity._fit_values", "Prediction");
static PROFILE: Import = Import::new("asperity._fit_values", "Profile");
static POSTERIOR_NUMBER: Import = Import::new("asperity._fit_values", "PosteriorNumber");

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
pub fn evolution(
    py: Python<'_>,
    at: Vec<f64>,
    found: Vec<Stretches>,
    positions: Vec<f64>,
) -> PyResult<StretchDensity<'_>> {
    let masses = found.iter().map(|one| atoms(py, &one.atoms)).collect::<PyResult<Vec<_>>>()?;
    let shape = [found.len(), at.len()];
    let density = found.into_iter().flat_map(|one| one.density).collect();
    let columns = (row(py, at)?, array(py, &shape, density)?, masses, row(py, positions)?);
    STRETCH_DENSITY.get(py)?.call1(columns).map(StretchDensity)
}

/// A parameter of a measured curve.
pub fn estimate(py: Python<'_>, found: MeasuredValue) -> PyResult<Estimate<'_>> {
    let interval = (found.low.unwrap_or(f64::NEG_INFINITY), found.high.unwrap_or(f64::INFINITY));
    ESTIMATE.get(py)?.call1((found.value, found.error, interval)).map(Estimate)
}

/// White noise and drift.
pub fn measured_noise<'py>(
    py: Python<'py>,
    noise: &rate_state::MeasuredNoise,
) -> PyResult<MeasuredNoise<'py>> {
    let drift = noise.drift.iter().map(|process| DRIFT.get(py)?.call1((process.std, process.length)));
    let drift = drift.collect::<PyResult<Vec<_>>>()?;
    MEASURED_NOISE.get(py)?.call1((noise.white, drift)).map(MeasuredNoise)
}

/// Linear stability of steady sliding.
pub fn stability(py: Python<'_>, found: LinearStability) -> PyResult<Stability<'_>> {
    let LinearStability { critical_stiffness, frequency, growth_rate, growth_frequency } = found;
    STABILITY.get(py)?.call1((critical_stiffness, frequency, growth_rate, growth_frequency)).map(Stability)
}

/// A velocity step behind the spring of a machine.
pub fn machine_step<'py>(
    py: Python<'py>,
    found: &rate_state::MachineStep,
    fitted: Vec<f64>,
) -> PyResult<MachineStep<'py>> {
    let misfit = (found.residual, found.residual_relative);
    let column =
        |value: fn(&rate_state::StateVariable) -> f64| PyTuple::new(py, found.states.iter().map(value));
    let (b, distance) = (column(|state| state.evolution)?, column(|state| state.distance)?);
    let values = (misfit.0, misfit.1, found.direct, b, distance, found.before, row(py, fitted)?);
    MACHINE_STEP.get(py)?.call1(values).map(MachineStep)
}

/// Slide–hold–slide tests behind the spring of a machine.
pub fn machine_healing<'py>(
    py: Python<'py>,
    found: &rate_state::MachineHealing,
    hold: &[f64],
) -> PyResult<MachineHealing<'py>> {
    let (peaks, held): (Vec<f64>, Vec<f64>) = found.forces(hold).into_iter().unzip();
    let (misfit, state) = ((found.residual, found.residual_relative), found.state);
    let fitted = (row(py, peaks)?, row(py, held)?);
    let values =
        (misfit.0, misfit.1, found.direct, state.evolution, state.distance, found.before, fitted.0, fitted.1);
    MACHINE_HEALING.get(py)?.call1(values).map(MachineHealing)
}

/// Whether a slider sticks and slips.
pub fn stick_slip_stability<'py>(
    py: Python<'py>,
    found: &StickSlipNumbers,
) -> PyResult<StickSlipStability<'py>> {
    let ends = (found.persistent_stiffness, found.persistent_stiffness_above.0);
    let critical = (found.critical_stiffness.0, found.critical_stiffness_sliding.0);
    let ensemble = found.ensemble.as_ref().map(|ensemble| simulated_stick_slip(py, ensemble)).transpose()?;
    let (word, reason) = (found.stick_slip.word(), &found.reason);
    let values = (word, reason, ends.0, ends.1, critical.0, critical.1, found.mean_drop, ensemble);
    STICK_SLIP_STABILITY.get(py)?.call1(values).map(StickSlipStability)
}

/// Whether a slider sticks and slips over single contacts.
fn simulated_stick_slip<'py>(py: Python<'py>, found: &SimulatedStickSlip) -> PyResult<Bound<'py, PyAny>> {
    let end = (found.persistent_stiffness.0, found.persistent_stiffness_std);
    let values = (
        found.simulations,
        found.none,
        found.transient,
        found.persistent,
        found.undecided,
        found.mean_drop,
        found.drop_std,
        found.period_scatter,
        end.0,
        end.1,
    );
    SIMULATED_STICK_SLIP.get(py)?.call1(values)
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
    let EnergyBalance {
        work,
        spring,
        elastic,
        kinetic,
        strengthening,
        breaks,
        slip,
        viscous,
        background,
        ..
    } = *energy;
    let imbalance = energy.imbalance();
    ENERGY
        .get(py)?
        .call1((work, spring, elastic, kinetic, strengthening, breaks, slip, viscous, background, imbalance))
        .map(BlockEnergy)
}

/// The energy balance of an interface.
pub fn interface_energy<'py>(py: Python<'py>, energy: &EnergyBalance) -> PyResult<InterfaceEnergy<'py>> {
    let EnergyBalance { work, spring, coupling, elastic, kinetic, strengthening, breaks, slip, .. } = *energy;
    let parts = (work, spring, coupling, elastic, kinetic, strengthening, breaks, slip, energy.imbalance());
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
    drives: Option<Vec<f64>>,
) -> PyResult<Potential<'py>> {
    let drives = drives.map(|drives| row(py, drives)).transpose()?;
    POTENTIAL.get(py)?.call1((row(py, position)?, energy, drives)).map(Potential)
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

/// Estimates by name.
pub fn estimates<'py>(py: Python<'py>, found: &[fit::Estimate]) -> PyResult<Estimates<'py>> {
    let estimates = PyDict::new(py);
    for one in found {
        let [low, high] = one.interval;
        estimates
            .set_item(&one.name, ESTIMATE.get(py)?.call1((one.value, one.error, (low, high), one.limit))?)?;
    }
    Ok(Estimates(estimates.into_any()))
}

/// Correlations between the errors of two estimates.
pub fn correlations(py: Python<'_>, found: Vec<fit::Correlation>) -> PyResult<Correlations<'_>> {
    let class = CORRELATION.get(py)?;
    let one = |fit::Correlation { between: [first, second], coefficient }| {
        class.call1(((first, second), coefficient))
    };
    let all = found.into_iter().map(one).collect::<PyResult<Vec<_>>>()?;
    Ok(Correlations(PyList::new(py, all)?.into_any()))
}

/// How well a curve is described.
pub fn misfit<'py>(py: Python<'py>, found: &fit::Misfit) -> PyResult<Misfit<'py>> {
    let fit::Misfit { chi_squared, degrees_of_freedom, probability, whiteness, deviance, akaike } = *found;
    let numbers =
        (chi_squared, degrees_of_freedom, probability, whiteness, deviance, akaike, found.is_unlikely());
    MISFIT.get(py)?.call1(numbers).map(Misfit)
}

/// Friction with standard errors.
pub fn friction<'py>(py: Python<'py>, found: &fit::FrictionEstimates) -> PyResult<FrictionEstimates<'py>> {
    let class = WITH_ERROR.get(py)?;
    let with_error = |one: fit::WithError| class.call1((one.value, one.error));
    let numbers = (
        found.static_friction.map(with_error).transpose()?,
        with_error(found.kinetic_friction)?,
        with_error(found.relaxation_length)?,
        with_error(found.critical_stiffness)?,
    );
    FRICTION_ESTIMATES.get(py)?.call1(numbers).map(FrictionEstimates)
}

/// Thresholds of free form; `law` is their distribution.
pub fn free_form<'py>(
    py: Python<'py>,
    found: &fit::FreeForm,
    law: Bound<'py, PyAny>,
) -> PyResult<FreeForm<'py>> {
    let class = WITH_ERROR.get(py)?;
    let with_error = |one: fit::WithError| class.call1((one.value, one.error));
    let table = found.table().map_err(crate::error::core)?;
    let fit::ThresholdBand { thresholds, density, low, high, cumulative, cumulative_error } = table;
    FREE_FORM
        .get(py)?
        .call1((
            law,
            with_error(found.mean)?,
            with_error(found.std)?,
            found.effective,
            found.estimates.converged,
            row(py, thresholds)?,
            row(py, density)?,
            row(py, low)?,
            row(py, high)?,
            row(py, cumulative)?,
            row(py, cumulative_error)?,
        ))
        .map(FreeForm)
}

/// Expected readings.
pub fn prediction(py: Python<'_>, positions: Vec<f64>, found: fit::Prediction) -> PyResult<Prediction<'_>> {
    let fit::Prediction { forces, std, error } = found;
    let columns = (row(py, forces)?, row(py, std)?, row(py, error)?, row(py, positions)?);
    PREDICTION.get(py)?.call1(columns).map(Prediction)
}

/// The numbers that were drawn from a posterior.
pub fn posterior<'py>(py: Python<'py>, reported: &PosteriorSummary) -> PyResult<PosteriorNumbers<'py>> {
    let numbers = PyDict::new(py);
    for one in &reported.numbers {
        let [low, median, high] = one.quantiles;
        let arguments = (one.mean, one.std, median, (low, high), one.r_hat.0, one.effective_size.0);
        numbers.set_item(&one.key, POSTERIOR_NUMBER.get(py)?.call1(arguments)?)?;
    }
    Ok(PosteriorNumbers(numbers.into_any()))
}

/// The profile of −2 ln L of a number.
pub fn profile<'py>(py: Python<'py>, name: &str, values: Vec<f64>, rise: Vec<f64>) -> PyResult<Profile<'py>> {
    PROFILE.get(py)?.call1((row(py, values)?, row(py, rise)?, name)).map(Profile)
}
