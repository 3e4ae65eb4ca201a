//! `[fit]`: numbers of the contacts, and of the machine, from a measured curve.

use super::accuracy::ForceAccuracy;
use super::fit_numbers::{correlations, fixed, friction, not_converged, number};
use super::summary::{FitLaw, FitLaws, FitNumbers, FitSummary};
use super::{Output, fit_steady, fit_velocity_curve, free_form, posterior};
use crate::fit::{
    Estimates, Fit, Measurement, Readings, Standardised, SteadyEstimates, VelocityCurveEstimates,
};
use crate::monitor::{Monitor, Part};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, FitKeys, FitThresholds, Model};
use crate::{Error, Result};

const CURVE: Column =
    Column::new("reading_curve", "number of the curve", Quantity::Count, &["reading_position"]);
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
const COLUMNS: [Column; 7] = [CURVE, POSITION, SLIDER, MEASURED, EXPECTED, STD, WHITENED];

/// Its tables in CSV.
pub(super) const TABLES: &[CsvTable] = &[
    CsvTable {
        file: "fit.csv",
        columns: &[CURVE, POSITION, SLIDER, MEASURED, EXPECTED, STD, WHITENED],
        needed: EXPECTED,
    },
    fit_steady::TABLE,
    fit_velocity_curve::READINGS,
    fit_velocity_curve::CURVE,
    free_form::TABLE,
];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    let measured: [&[Column]; 3] = [&COLUMNS, &fit_steady::COLUMNS, &fit_velocity_curve::COLUMNS];
    let others: [&[Column]; 2] = [&free_form::COLUMNS, &posterior::COLUMNS];
    vec![("fit", Record::declared(&[measured.as_slice(), &others].concat()))]
}

/// What the fit of a scenario has found, with the keys of its numbers.
#[derive(Debug)]
pub struct KeyedEstimates {
    estimates: OfMeasurement,
    keys: FitKeys,
}

/// Estimates from a loading curve, from a record of steady sliding, or from forces at several velocities.
#[derive(Debug)]
enum OfMeasurement {
    Curve(Box<Estimates>),
    Steady(Box<SteadyEstimates>),
    VelocityCurve(Box<VelocityCurveEstimates>),
}

impl KeyedEstimates {
    /// The posterior in standardised coordinates.
    ///
    /// # Errors
    /// A measurement that is only planned; no number with an error.
    pub fn standardised(&self) -> Result<Standardised<'_>> {
        match &self.estimates {
            OfMeasurement::Curve(found) => found.standardised(),
            OfMeasurement::Steady(found) => found.standardised(),
            OfMeasurement::VelocityCurve(found) => found.standardised(),
        }
    }

    /// The key in the scenario for the name of a number.
    pub fn key(&self, name: &str) -> String {
        self.keys.key(name)
    }
}

/// Fits the numbers that `task` lists.
///
/// # Errors
/// As [`found`].
pub(super) fn run(
    model: &Model,
    task: &scenario::Fit,
    monitor: &mut dyn Monitor,
) -> Result<Output<FitNumbers>> {
    Ok(found(model, task, monitor)?.0)
}

/// What a program without the feature `fits` says.
pub(super) fn without_fits() -> Error {
    Error::invalid("fit", "a program with fits, such as the command asperity", "one without them")
}

/// The same with the estimates.
///
/// # Errors
/// A key that is no number of the contacts or of the machine; those of [`crate::fit::Fit::run`].
pub(super) fn found(
    model: &Model,
    task: &scenario::Fit,
    monitor: &mut dyn Monitor,
) -> Result<(Output<FitNumbers>, KeyedEstimates)> {
    if cfg!(not(feature = "fits")) {
        return Err(without_fits());
    }
    if let Some(steady) = task.prepare_steady(model, &mut Part::new(monitor, 0.0, 0.05))? {
        let source = task.steady.as_ref().and_then(|steady| steady.source.clone());
        let part = &mut Part::new(monitor, 0.05, 0.95);
        let (output, found) = fit_steady::found(model, &steady, source, part)?;
        return Ok((
            output,
            KeyedEstimates { estimates: OfMeasurement::Steady(Box::new(found)), keys: steady.1 },
        ));
    }
    if let Some((fit, keys)) = task.prepare_velocity_curve(model, &mut Part::new(monitor, 0.0, 0.05))? {
        let source = task.velocity_curve.as_ref().and_then(|curve| curve.source.clone());
        let part = &mut Part::new(monitor, 0.05, 0.95);
        let (output, found) = fit_velocity_curve::found(model, (&fit, &keys), source, part)?;
        let estimates = OfMeasurement::VelocityCurve(Box::new(found));
        return Ok((output, KeyedEstimates { estimates, keys }));
    }
    let (fit, keys) = task.prepare(model, &mut Part::new(monitor, 0.0, 0.05))?;
    let is_free = task.thresholds == FitThresholds::FreeForm;
    let share = 0.85 / (1 + task.laws.len() + if is_free { 10 } else { 0 }) as f64;
    let found = fit.run_with(&mut Part::new(monitor, 0.05, share)).map_err(scenario::Fit::keyed)?;
    let others = share * task.laws.len() as f64;
    let laws = laws(task, (&fit, &keys), &found, &mut Part::new(monitor, 0.05 + share, others))?;
    let part = &mut Part::new(monitor, 0.05 + share + others, 0.85 - share - others);
    let form = is_free.then(|| fit.free_form(&found, task.kernels, part)).transpose();
    let form = form.map_err(scenario::Fit::keyed)?;
    let reported = found.friction(&mut Part::new(monitor, 0.9, 0.1))?;
    let mut record = record(&found);
    let form = form.map(|form| free_form::report(&form, &mut record)).transpose()?;
    let summary = FitSummary {
        converged: found.converged,
        readings: found.readings.iter().map(|curve| curve.positions.len()).sum(),
        solutions: found.solutions,
        numbers: found.parameters.iter().map(|estimate| number(&keys, estimate)).collect(),
        fixed: fixed(&keys, found.fixed()),
        reading: found.reading,
        distances: (0..found.curves().len()).map(|curve| found.pull(curve).distance()).collect(),
        covariance: found.covariance.chunks(found.parameters.len()).map(<[f64]>::to_vec).collect(),
        misfit: found.misfit,
        correlations: correlations(&keys, found.correlations()),
        friction: Some(friction(&reported)),
        laws,
        free_form: form,
        posterior: None,
        sources: task.curves().into_iter().filter_map(|curve| curve.source).collect(),
    };
    let mut warnings = not_converged(found.converged);
    if found.is_sparse() {
        let text = "fit: the readings are farther apart than a third of a mean life: contacts of longer or shorter lives \
                    may have the same forces there";
        warnings.push(text.into());
    }
    let accuracy = ForceAccuracy::new(model, found.pull(0).error_estimate(), found.equation().life().mean());
    let output = Output { warnings, ..Output::new(model, FitNumbers { fit: summary }, record) };
    let output = accuracy.of(model, "the force of the fit", output)?;
    Ok((output, KeyedEstimates { estimates: OfMeasurement::Curve(Box::new(found)), keys }))
}

/// The same fit with each of the distributions of `fit.laws`, from the mean and the standard deviation of the fitted thresholds.
///
/// # Errors
/// Stopped by the monitor. Another error of a distribution is reported in its place.
fn laws(
    task: &scenario::Fit,
    (fit, keys): (&Fit, &FitKeys),
    found: &Estimates,
    monitor: &mut dyn Monitor,
) -> Result<Option<FitLaws>> {
    if task.laws.is_empty() {
        return Ok(None);
    }
    let thresholds = &found.equation().contacts().thresholds;
    let share = 1.0 / task.laws.len() as f64;
    let akaike = |found: &Estimates| found.misfit.map_or(f64::INFINITY, |misfit| misfit.akaike);
    let mut lowest = akaike(found);
    let mut others = Vec::new();
    for (i, name) in task.laws.iter().enumerate() {
        let monitor = &mut Part::new(monitor, i as f64 * share, share);
        let part = &mut Part::new(monitor, 0.0, 0.1);
        let other = scenario::Fit::of_law(fit, keys, (name, thresholds.as_ref()), part);
        let part = &mut Part::new(monitor, 0.1, 0.9);
        let other = other.and_then(|(fit, keys)| Ok((fit.run_with(part)?, keys)));
        others.push(match other {
            Err(Error::Stopped) => return Err(Error::Stopped),
            Err(error) => FitLaw {
                law: name.clone(),
                difference: None,
                converged: false,
                numbers: Vec::new(),
                refused: Some(error.to_string()),
            },
            Ok((found, keys)) => {
                lowest = lowest.min(akaike(&found));
                FitLaw {
                    law: name.clone(),
                    difference: Some(akaike(&found)),
                    converged: found.converged,
                    numbers: found.parameters.iter().map(|estimate| number(&keys, estimate)).collect(),
                    refused: None,
                }
            }
        });
    }
    others.iter_mut().filter_map(|law| law.difference.as_mut()).for_each(|akaike| *akaike -= lowest);
    Ok(Some(FitLaws { difference: akaike(found) - lowest, others }))
}

/// The readings of all curves, one curve after the other.
fn record(found: &Estimates) -> Record {
    let mut record = Record::default();
    let (curves, readings) = (found.curves(), &found.readings);
    if curves.len() > 1 {
        let number = |(c, curve): (usize, &Measurement)| vec![c as f64; curve.positions.len()];
        record.add(CURVE, curves.iter().enumerate().flat_map(number).collect::<Vec<f64>>());
    }
    record.add(POSITION, curves.iter().flat_map(|curve| curve.positions.clone()).collect::<Vec<f64>>());
    let all = |of: fn(&Readings) -> &Vec<f64>| {
        readings.iter().flat_map(|curve| of(curve).clone()).collect::<Vec<f64>>()
    };
    if (0..curves.len()).any(|curve| found.machine(curve).compliance > 0.0) {
        record.add(SLIDER, all(|curve| &curve.positions));
    }
    if found.misfit.is_some() {
        record.add(MEASURED, curves.iter().flat_map(|curve| curve.forces.clone()).collect::<Vec<f64>>());
    }
    record.add(EXPECTED, all(|curve| &curve.expected));
    record.add(STD, all(|curve| &curve.std));
    if found.misfit.is_some() {
        record.add(WHITENED, all(|curve| &curve.whitened));
    }
    record
}
