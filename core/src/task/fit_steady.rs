//! `[fit.steady]`: numbers of the contacts from a record of the force in steady sliding.

use super::Output;
use super::accuracy::ForceAccuracy;
use super::fit_numbers::{correlations, fixed, friction, not_converged, number};
use super::summary::{FitNumbers, FitSummary};
use crate::Result;
use crate::fit::{SteadyEstimates, SteadyFit};
use crate::monitor::{Monitor, Part};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, FitKeys, FitSource, Model};

const WAVE_NUMBER: Column = Column::new(
    "fit_wave_number",
    "wave number q of the record, radians per length",
    Quantity::PerLength,
    &["fit_wave_number"],
);
const PERIODOGRAM: Column = Column::new(
    "fit_periodogram",
    "periodogram of the measured record",
    Quantity::ForceSquaredLength,
    &["fit_wave_number"],
);
const EXPECTED: Column = Column::new(
    "fit_expected_periodogram",
    "expectation of the periodogram of the fitted contacts, with aliasing, leakage and the error of a reading",
    Quantity::ForceSquaredLength,
    &["fit_wave_number"],
);

/// The variables of a fit to a record.
pub(super) const COLUMNS: [Column; 3] = [WAVE_NUMBER, PERIODOGRAM, EXPECTED];

/// Its table in CSV.
pub(super) const TABLE: CsvTable = CsvTable { file: "fit_spectrum.csv", columns: &COLUMNS, needed: EXPECTED };

/// Fits the numbers whose `keys` are given to a record from the file `source`.
///
/// # Errors
/// Those of [`SteadyFit::run`].
pub(super) fn found(
    model: &Model,
    (fit, keys): &(SteadyFit, FitKeys),
    source: Option<FitSource>,
    monitor: &mut dyn Monitor,
) -> Result<(Output<FitNumbers>, SteadyEstimates)> {
    let found = fit.run_with(&mut Part::new(monitor, 0.0, 0.9)).map_err(scenario::Fit::keyed_steady)?;
    let reported = found.friction(&mut Part::new(monitor, 0.9, 0.1))?;
    let mut record = Record::default();
    record.add(WAVE_NUMBER, found.spectrum.wave_numbers.clone());
    record.add(PERIODOGRAM, found.spectrum.periodogram.clone());
    record.add(EXPECTED, found.spectrum.expected.clone());
    let summary = FitSummary {
        converged: found.converged,
        readings: found.record().forces.len(),
        solutions: found.solutions,
        numbers: found.parameters.iter().map(|estimate| number(keys, estimate)).collect(),
        fixed: fixed(keys, found.fixed()),
        reading: found.reading,
        distances: vec![found.record().distance()],
        covariance: found.covariance.chunks(found.parameters.len()).map(<[f64]>::to_vec).collect(),
        misfit: Some(found.misfit),
        correlations: correlations(keys, found.correlations()),
        friction: Some(friction(&reported)),
        laws: None,
        free_form: None,
        sources: source.into_iter().collect(),
        posterior: None,
    };
    let warnings = not_converged(found.converged);
    let steady = found.equation().steady_state();
    let accuracy = ForceAccuracy::new(model, steady.error_estimate(), steady.mean_life());
    let output = Output { warnings, ..Output::new(model, FitNumbers { fit: summary }, record) };
    Ok((accuracy.of(model, "the force of steady sliding", output)?, found))
}
