//! `[spectrum]`: the spectrum and the autocovariance of the force of a finite number of contacts in steady sliding.

use super::accuracy::ForceAccuracy;
use super::settling::Steady;
use super::summary::{Noise, SpectrumNumbers};
use super::{Output, fits};
use crate::Result;
use crate::ensemble::{Ensemble, Snapshots};
use crate::master::MasterEquation;
use crate::monitor::{Aside, Monitor, Part};
use crate::numerics::periodogram::{Periodogram, welch};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, Model};

/// Largest wave number by default, in multiples of 2π over the mean displacement between breaks.
const HARMONICS: f64 = 5.0;
/// Largest displacement of the autocovariance by default, in mean displacements between breaks.
const DISPLACEMENT: f64 = 10.0;

/// Positions of the ensemble per π/q at the largest wave number q. The spectrum falls as 1/q² beyond, and what is folded
/// back from there is below 1/(2·8 − 1)² of it.
const SAMPLES: f64 = 8.0;
/// Length of a segment of the periodogram, in dephasing lengths and in mean displacements between breaks: a few of
/// its wave numbers lie in the width of a peak.
const SEGMENT: [f64; 2] = [16.0, 64.0];
/// Largest length of a segment, in mean displacements between breaks.
const LONGEST: f64 = 256.0;
/// Lengths of segments that the ensemble slides; segments overlap by a half.
const SEGMENTS: usize = 16;

const WAVE_NUMBER: Column =
    Column::new("wave_number", "wave number q, radians per length", Quantity::PerLength, &["wave_number"]);
const SPECTRUM: Column = Column::new(
    "spectrum",
    "spectrum of the force of a finite number of contacts in steady sliding",
    Quantity::ForceSquaredLength,
    &["wave_number"],
);
const DISPLACEMENTS: Column =
    Column::new("displacement", "displacement u", Quantity::Length, &["displacement"]);
const AUTOCOVARIANCE: Column = Column::new(
    "autocovariance",
    "autocovariance of the force of a finite number of contacts in steady sliding",
    Quantity::ForceSquared,
    &["displacement"],
);
const ENSEMBLE_WAVE_NUMBER: Column = Column::new(
    "ensemble_wave_number",
    "wave number q of the periodogram, radians per length",
    Quantity::PerLength,
    &["ensemble_wave_number"],
);
const ENSEMBLE_SPECTRUM: Column = Column::new(
    "ensemble_spectrum",
    "averaged periodogram of the force of the ensemble",
    Quantity::ForceSquaredLength,
    &["ensemble_wave_number"],
);
const ENSEMBLE_SPECTRUM_ERROR: Column = Column::new(
    "ensemble_spectrum_error",
    "standard error of the averaged periodogram",
    Quantity::ForceSquaredLength,
    &["ensemble_wave_number"],
);

/// The variables of the task.
const COLUMNS: [Column; 7] = [
    WAVE_NUMBER,
    SPECTRUM,
    DISPLACEMENTS,
    AUTOCOVARIANCE,
    ENSEMBLE_WAVE_NUMBER,
    ENSEMBLE_SPECTRUM,
    ENSEMBLE_SPECTRUM_ERROR,
];

/// Its tables in CSV.
pub(super) const TABLES: &[CsvTable] = &[
    CsvTable { file: "spectrum.csv", columns: &[WAVE_NUMBER, SPECTRUM], needed: SPECTRUM },
    CsvTable {
        file: "autocovariance.csv",
        columns: &[DISPLACEMENTS, AUTOCOVARIANCE],
        needed: AUTOCOVARIANCE,
    },
    CsvTable {
        file: "periodogram.csv",
        columns: &[ENSEMBLE_WAVE_NUMBER, ENSEMBLE_SPECTRUM, ENSEMBLE_SPECTRUM_ERROR],
        needed: ENSEMBLE_SPECTRUM,
    },
];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    vec![("spectrum", Record::declared(&[&COLUMNS]))]
}

/// Computes the noise that `task` describes.
///
/// # Errors
/// Contacts whose noise is not known or consists of lines; errors of the solvers, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &scenario::Spectrum,
    monitor: &mut dyn Monitor,
) -> Result<Output<SpectrumNumbers>> {
    let Model { contacts, initial, .. } = model;
    fits("spectrum.points", 4 * task.points, || format!("a spectrum of {} points", task.points), monitor)?;
    let part = &mut Part::new(monitor, 0.0, 0.1);
    let equation = MasterEquation::reformed(contacts.clone(), task.velocity, part)?;
    let steady = equation.steady_state();
    let size = model.sample().unwrap_or(contacts.count);
    let life = steady.mean_life();
    let highest = task.highest.unwrap_or(HARMONICS * std::f64::consts::TAU / life);
    let wave_numbers = evenly(highest, task.points);
    let displacements = evenly(task.displacement.unwrap_or(DISPLACEMENT * life), task.points);
    let spectrum = steady.spectrum_with(&wave_numbers, size, &mut Part::new(monitor, 0.1, 0.1))?;
    let tolerance = model.master_equation.tolerance();
    let part = &mut Part::new(monitor, 0.2, 0.1);
    let autocovariance = steady.autocovariance_with(&displacements, size, tolerance, part)?;
    let aside = &mut Aside { fraction: 0.3, monitor };
    let noise = Noise {
        size,
        kinetic_friction: steady.kinetic_friction() + model.background,
        force_std: steady.force_std(size),
        mean_life: life,
        at_zero: spectrum[0],
        tail: steady.spectrum_tail_with(size, aside)? / (2.0 * steady.kinetic_friction()),
    };
    let mut record = Record::default();
    record.add(WAVE_NUMBER, wave_numbers);
    record.add(SPECTRUM, spectrum);
    record.add(DISPLACEMENTS, displacements);
    record.add(AUTOCOVARIANCE, autocovariance);
    if let Some(ensemble) = &model.ensemble {
        let ensemble = ensemble.build(contacts.clone(), initial.clone())?;
        let settled = Steady::of(&steady);
        let segment = (SEGMENT[0] * steady.dephasing_length()).max(SEGMENT[1] * life).min(LONGEST * life);
        let part = &mut Part::new(monitor, 0.3, 0.7);
        let found = periodogram(&ensemble, task.velocity, settled.distance, (segment, highest), part)?;
        record_periodogram(&mut record, found, highest);
    }
    let accuracy = ForceAccuracy::new(model, steady.error_estimate(), life);
    accuracy.of(model, "the force of steady sliding", Output::new(model, SpectrumNumbers { noise }, record))
}

/// `points` numbers from 0 to `last`, evenly spaced.
fn evenly(last: f64, points: usize) -> Vec<f64> {
    (0..points).map(|i| last * (i as f64 / (points - 1) as f64)).collect()
}

/// The periodogram of the force of an ensemble that slides on after the distance `settled`, in segments of the length
/// `segment`, up to the wave number `highest`.
fn periodogram(
    ensemble: &Ensemble,
    velocity: Option<f64>,
    settled: f64,
    (segment, highest): (f64, f64),
    monitor: &mut dyn Monitor,
) -> Result<Periodogram> {
    let spacing = std::f64::consts::PI / (SAMPLES * highest);
    let length = 2 * (0.5 * segment / spacing).ceil() as usize;
    let what = || format!("a record of {} forces of the ensemble", SEGMENTS * length);
    fits("spectrum.highest", SEGMENTS * length, what, monitor)?;
    let positions: Vec<f64> = (0..SEGMENTS * length).map(|i| settled + spacing * i as f64).collect();
    let nothing = Snapshots::default();
    let pull = match velocity {
        Some(velocity) => ensemble.pull_at_with(velocity, &positions, &nothing, monitor)?,
        None => ensemble.pull_with(&positions, &nothing, monitor)?,
    };
    Ok(welch(&pull.force, spacing, length))
}

/// Records a periodogram up to the wave number `highest`.
fn record_periodogram(record: &mut Record, found: Periodogram, highest: f64) {
    let Periodogram { mut wave_numbers, mut spectrum, relative_error } = found;
    let within = wave_numbers.partition_point(|&q| q <= highest);
    wave_numbers.truncate(within);
    spectrum.truncate(within);
    let error = spectrum.iter().map(|value| relative_error * value).collect();
    record.add(ENSEMBLE_WAVE_NUMBER, wave_numbers);
    record.add(ENSEMBLE_SPECTRUM, spectrum);
    record.add(ENSEMBLE_SPECTRUM_ERROR, error);
}
