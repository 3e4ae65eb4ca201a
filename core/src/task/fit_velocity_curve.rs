//! `[fit.velocity_curve]`: numbers of the contacts from forces of steady sliding at several velocities.

use super::Output;
use super::accuracy::ForceAccuracy;
use super::fit_numbers::{correlations, fixed, not_converged, number};
use super::summary::{FitNumbers, FitSummary};
use crate::Result;
use crate::fit::{VelocityCurveEstimates, VelocityCurveFit};
use crate::monitor::Monitor;
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, FitKeys, FitSource, Model};

const READING_VELOCITY: Column = Column::new(
    "reading_velocity",
    "velocity at which the force was measured",
    Quantity::Velocity,
    &["reading_velocity"],
);
const MEASURED: Column = Column::new(
    "reading_friction",
    "measured force of steady sliding",
    Quantity::Force,
    &["reading_velocity"],
);
const EXPECTED: Column = Column::new(
    "reading_expected_friction",
    "force of the fit at this velocity",
    Quantity::Force,
    &["reading_velocity"],
);
const STD: Column = Column::new(
    "reading_friction_std",
    "standard deviation of the measured force about the fit",
    Quantity::Force,
    &["reading_velocity"],
);
const RESIDUAL: Column = Column::new(
    "reading_friction_residual",
    "measured force less that of the fit, in standard deviations",
    Quantity::Number,
    &["reading_velocity"],
);
const VELOCITY: Column = Column::new("fit_velocity", "velocity v", Quantity::Velocity, &["fit_velocity"]);
const FRICTION: Column =
    Column::new("fit_friction", "force of the fit against velocity", Quantity::Force, &["fit_velocity"]);
const ERROR: Column = Column::new(
    "fit_friction_error",
    "standard error of the force of the fit, from the covariance of the estimates",
    Quantity::Force,
    &["fit_velocity"],
);

/// The variables of a fit to forces at several velocities.
pub(super) const COLUMNS: [Column; 8] =
    [READING_VELOCITY, MEASURED, EXPECTED, STD, RESIDUAL, VELOCITY, FRICTION, ERROR];

/// Its tables in CSV.
pub(super) const READINGS: CsvTable = CsvTable {
    file: "fit_readings.csv",
    columns: &[READING_VELOCITY, MEASURED, EXPECTED, STD, RESIDUAL],
    needed: EXPECTED,
};
pub(super) const CURVE: CsvTable =
    CsvTable { file: "fit_velocity_curve.csv", columns: &[VELOCITY, FRICTION, ERROR], needed: FRICTION };

/// Fits the numbers whose `keys` are given to forces from the file `source`.
///
/// # Errors
/// Those of [`VelocityCurveFit::run`].
pub(super) fn found(
    model: &Model,
    (fit, keys): (&VelocityCurveFit, &FitKeys),
    source: Option<FitSource>,
    monitor: &mut dyn Monitor,
) -> Result<(Output<FitNumbers>, VelocityCurveEstimates)> {
    let found = fit.run_with(monitor).map_err(scenario::Fit::keyed_velocity_curve)?;
    let summary = FitSummary {
        converged: found.converged,
        readings: found.curve().forces.len(),
        solutions: found.solutions,
        numbers: found.parameters.iter().map(|estimate| number(keys, estimate)).collect(),
        fixed: fixed(keys, found.fixed()),
        reading: found.reading,
        distances: Vec::new(),
        covariance: found.covariance.chunks(found.parameters.len()).map(<[f64]>::to_vec).collect(),
        misfit: Some(found.misfit),
        correlations: correlations(keys, found.correlations()),
        friction: None,
        laws: None,
        free_form: None,
        sources: source.into_iter().collect(),
        posterior: None,
    };
    let life = found.equation().steady_state().mean_life();
    let accuracy = ForceAccuracy::new(model, found.error_estimate(), life);
    let warnings = not_converged(found.converged);
    let output =
        Output { warnings, ..Output::new(model, FitNumbers { fit: summary }, velocity_curve_of_fit(&found)) };
    Ok((accuracy.of(model, "the force of steady sliding", output)?, found))
}

/// The readings and the smooth curve of a fit to forces at several velocities, as a record.
pub fn velocity_curve_of_fit(found: &VelocityCurveEstimates) -> Record {
    let (measured, fitted) = (found.curve(), &found.fitted);
    let residuals = measured.forces.iter().zip(&found.expected).zip(&found.std);
    let residuals = residuals.map(|((force, expected), std)| (force - expected) / std);
    let mut record = Record::default();
    record.add(READING_VELOCITY, measured.velocities.clone());
    record.add(MEASURED, measured.forces.clone());
    record.add(EXPECTED, found.expected.clone());
    record.add(STD, found.std.clone());
    record.add(RESIDUAL, residuals.collect::<Vec<f64>>());
    record.add(VELOCITY, fitted.velocities.clone());
    record.add(FRICTION, fitted.forces.clone());
    record.add(ERROR, fitted.errors.clone());
    record
}
