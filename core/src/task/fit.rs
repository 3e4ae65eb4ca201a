//! `[fit]`: numbers of the contacts, and of the machine, from a measured curve.

use super::accuracy::ForceAccuracy;
use super::summary::{Extended, FitFriction, FitNumber, FitNumbers, FitSummary, Uncertain};
use super::{Output, fit_steady};
use crate::Result;
use crate::fit::{Correlation, Estimate, FrictionEstimates, WithError};
use crate::monitor::{Monitor, Part};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, FitKeys, Model};

const POSITION: Column =
    Column::new("reading_position", "measured position", Quantity::Length, &["reading_position"]);
const SLIDER: Column =
    Column::new("slider_position", "position X of the slider", Quantity::Length, &["reading_position"]);
const MEASURED: Column =
    Column::new("measured_force", "measured force", Quantity::Force, &["reading_position"]);
const EXPECTED: Column =
    Column::new("expected_force", "force of the fit", Quantity::Force, &["reading_position"]);
const STD: Column = Column::new(
    "reading_std",
    "standard deviation of a reading about the fit",
    Quantity::Force,
    &["reading_position"],
);
const WHITENED: Column = Column::new(
    "whitened_residual",
    "whitened residual, independent and of variance 1 where the fit holds",
    Quantity::Number,
    &["reading_position"],
);

/// The variables of the task.
const COLUMNS: [Column; 6] = [POSITION, SLIDER, MEASURED, EXPECTED, STD, WHITENED];

/// Its tables in CSV.
pub(super) const TABLES: &[CsvTable] = &[
    CsvTable {
        file: "fit.csv",
        columns: &[POSITION, SLIDER, MEASURED, EXPECTED, STD, WHITENED],
        needed: EXPECTED,
    },
    fit_steady::TABLE,
];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    vec![("fit", Record::declared(&[&COLUMNS, &fit_steady::COLUMNS]))]
}

/// Fits the numbers that `task` lists.
///
/// # Errors
/// A key that is no number of the contacts or of the machine; those of [`crate::fit::Fit::run`].
pub(super) fn run(
    model: &Model,
    task: &scenario::Fit,
    monitor: &mut dyn Monitor,
) -> Result<Output<FitNumbers>> {
    if let Some(steady) = task.prepare_steady(model, &mut Part::new(monitor, 0.0, 0.05))? {
        return fit_steady::run(model, &steady, &mut Part::new(monitor, 0.05, 0.95));
    }
    let (fit, keys) = task.prepare(model, &mut Part::new(monitor, 0.0, 0.05))?;
    let measurement = fit.measurement().clone();
    let found = fit.run_with(&mut Part::new(monitor, 0.05, 0.85)).map_err(scenario::Fit::keyed)?;
    let told = found.friction(&mut Part::new(monitor, 0.9, 0.1))?;
    let mut record = Record::default();
    record.add(POSITION, measurement.positions);
    if measurement.machine.compliance > 0.0 {
        record.add(SLIDER, found.readings.positions.clone());
    }
    if !measurement.forces.is_empty() {
        record.add(MEASURED, measurement.forces);
    }
    record.add(EXPECTED, found.readings.expected.clone());
    record.add(STD, found.readings.std.clone());
    if found.misfit.is_some() {
        record.add(WHITENED, found.readings.whitened.clone());
    }
    let summary = FitSummary {
        converged: found.converged,
        readings: found.readings.positions.len(),
        solutions: found.solutions,
        numbers: found.parameters.iter().map(|estimate| number(&keys, estimate)).collect(),
        reading: found.reading,
        distance: found.pull().distance(),
        covariance: found.covariance.chunks(found.parameters.len()).map(<[f64]>::to_vec).collect(),
        misfit: found.misfit,
        correlations: correlations(&keys, found.correlations()),
        friction: friction(&told),
    };
    let warnings = not_converged(found.converged);
    let accuracy = ForceAccuracy::new(model, found.pull().error_estimate(), found.equation().life().mean());
    let output = Output { warnings, ..Output::new(model, FitNumbers { fit: summary }, record) };
    accuracy.of(model, "the force of the fit", output)
}

/// The warning of a search that has not converged.
pub(super) fn not_converged(converged: bool) -> Vec<String> {
    let text = "fit: the search has not converged; the values are the last ones, without meaningful errors";
    if converged { Vec::new() } else { vec![text.into()] }
}

/// Friction with its errors.
pub(super) fn friction(found: &FrictionEstimates) -> FitFriction {
    let error = |of: WithError| Uncertain { value: Extended(of.value), error: Extended(of.error) };
    FitFriction {
        static_friction: found.static_friction.map(error),
        kinetic_friction: error(found.kinetic_friction),
        relaxation_length: error(found.relaxation_length),
        critical_stiffness: error(found.critical_stiffness),
    }
}

pub(super) fn number(keys: &FitKeys, estimate: &Estimate) -> FitNumber {
    let Estimate { name, value, error, interval, limit } = estimate;
    FitNumber {
        key: keys.key(name),
        value: *value,
        error: *error,
        interval: interval.map(Extended),
        limit: limit.map(Extended),
    }
}

pub(super) fn correlations(keys: &FitKeys, told: Vec<Correlation>) -> Vec<Correlation> {
    let named = |correlation: Correlation| Correlation {
        between: correlation.between.map(|name| keys.key(&name)),
        coefficient: correlation.coefficient,
    };
    told.into_iter().map(named).collect()
}
