//! `[renormalisation]`: the distribution of the drives at which coupled contacts first break, compared with that of their
//! thresholds and with its mean-field renormalisation.

use super::summary::{Compared, FirstBreakStatistics, Fitted, InterfaceSize, RenormalisationNumbers};
use super::{Output, interface};
use crate::Result;
use crate::first_breaks::FirstBreaks;
use crate::law::{Law, Renormalised, critical_coupling};
use crate::monitor::{Aside, Monitor, Part};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{Ensemble, Interface, Model, PerCell, Renormalisation};

/// Probability of each tail that is not shown.
const TAIL: f64 = 1e-4;

const DRIVE: Column =
    Column::new("drive", "drive, in the middle of an interval", Quantity::Length, &["drive"]);
const FREE_DENSITY: Column = of("free_density", "density of thresholds");
const MEAN_FIELD_DENSITY: Column =
    of("mean_field_density", "density of thresholds renormalised in mean field");
const MEASURED_DENSITY: Column = of("measured_density", "density of first breaks");
const MEASURED_ERROR: Column = of("measured_error", "its standard error");

/// The variables of the task.
const COLUMNS: [Column; 5] = [DRIVE, FREE_DENSITY, MEAN_FIELD_DENSITY, MEASURED_DENSITY, MEASURED_ERROR];

/// Its table in CSV.
pub(super) const TABLES: &[CsvTable] = &[CsvTable {
    file: "thresholds.csv",
    columns: &[DRIVE, FREE_DENSITY, MEASURED_DENSITY, MEASURED_ERROR, MEAN_FIELD_DENSITY],
    needed: MEASURED_DENSITY,
}];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    vec![("renormalisation", Record::declared(&[&COLUMNS]))]
}

const fn of(name: &'static str, long_name: &'static str) -> Column {
    Column::new(name, long_name, Quantity::PerLength, &["drive"])
}

/// Drives the interfaces of `task`.
///
/// # Errors
/// Values that the interface refuses, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &Renormalisation,
    monitor: &mut dyn Monitor,
) -> Result<Output<RenormalisationNumbers>> {
    let interface = model.interface.as_ref().expect("the check of this task requires one");
    let shared = interface.thresholds(&model.contacts)?;
    let thresholds = shared.as_ref();
    let coupling = interface.mean_field_coupling(&model.contacts)?;
    let critical = critical_coupling(thresholds);
    let mean_field =
        (coupling < critical).then(|| Renormalised::new(shared.clone(), coupling)).transpose()?;
    let mean_field = mean_field.as_ref().map(|law| law as &dyn Law);
    let runs = measured(model, task, interface, coupling, monitor)?;
    let all = FirstBreaks::together(&runs);
    let compared = |law: &dyn Law| Compared { mean: law.mean(), std: law.std(), distance: all.distance(law) };
    let renormalisation = FirstBreakStatistics {
        coupling,
        critical_coupling: critical,
        size: match interface.contacts {
            PerCell::One => InterfaceSize::Contacts(interface.size()),
            PerCell::Many => InterfaceSize::Cells(interface.size()),
        },
        runs: task.runs,
        mean: scatter(runs.iter().map(FirstBreaks::mean)),
        std: pooled_std(&runs),
        thresholds: compared(thresholds),
        mean_field: mean_field.map(compared),
    };
    let seed = interface::seed(model, interface);
    let known: Vec<_> = [thresholds].into_iter().chain(mean_field).collect();
    let record = record(&edges(&known, &all, task.points), thresholds, mean_field, &runs);
    let numbers = RenormalisationNumbers { renormalisation };
    Ok(Output { seed, sample: None, ..Output::new(model, numbers, record) })
}

/// The distribution of first breaks in each run.
fn measured(
    model: &Model,
    task: &Renormalisation,
    interface: &Interface,
    coupling: f64,
    monitor: &mut dyn Monitor,
) -> Result<Vec<FirstBreaks>> {
    let fraction = 1.0 / task.runs as f64;
    let run = |run: usize| {
        let mut part = Part::new(monitor, run as f64 * fraction, fraction);
        match interface.contacts {
            PerCell::One => of_contacts(model, interface, run, &mut part),
            PerCell::Many => of_cells(model, &interface.redrawn(run), coupling, &mut part),
        }
    };
    (0..task.runs).map(run).collect()
}

/// First breaks of contacts coupled one by one. The seed is that of the ensemble plus the number of the run.
fn of_contacts(
    model: &Model,
    interface: &Interface,
    run: usize,
    monitor: &mut dyn Monitor,
) -> Result<FirstBreaks> {
    let first = model.ensemble.clone().unwrap_or_default();
    let ensemble = Ensemble { seed: first.seed + run as u64, ..first };
    let (contacts, initial) = (model.contacts.clone(), model.initial.clone());
    let mut lattice =
        interface.lattice(contacts, initial, Some(&ensemble), None, &mut Aside { fraction: 0.0, monitor })?;
    Ok(FirstBreaks::of_contacts(&lattice.first_breaks(monitor)?))
}

/// First breaks of the contacts of cells.
fn of_cells(
    model: &Model,
    interface: &Interface,
    coupling: f64,
    monitor: &mut dyn Monitor,
) -> Result<FirstBreaks> {
    let Model { contacts, initial, .. } = model;
    let tolerance = model.master_equation.tolerance();
    let mut cells = interface.deformable(contacts.clone(), initial, tolerance, None, monitor)?;
    cells.first_breaks(contacts.thresholds.as_ref(), coupling, monitor)
}

/// The mean of independent values, with its standard error.
fn scatter(values: impl ExactSizeIterator<Item = f64> + Clone) -> Fitted {
    let count = values.len() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let square = values.map(|value| (value - mean).powi(2)).sum::<f64>();
    Fitted { value: mean, error: (square / (count * (count - 1.0))).sqrt() }
}

/// The standard deviation of the first breaks of all runs together, with its standard error: the root of the mean of E[(x − m)²] over
/// the runs, with the mean m of all.
fn pooled_std(runs: &[FirstBreaks]) -> Fitted {
    let mean = runs.iter().map(FirstBreaks::mean).sum::<f64>() / runs.len() as f64;
    let variance = scatter(runs.iter().map(|run| run.std().powi(2) + (run.mean() - mean).powi(2)));
    let std = variance.value.sqrt();
    Fitted { value: std, error: variance.error / (2.0 * std) }
}

/// Edges of `points` intervals that cover all laws except for their tails.
fn edges(laws: &[&dyn Law], measured: &FirstBreaks, points: usize) -> Vec<f64> {
    let ends = laws.iter().map(|law| (law.quantile(TAIL), law.upper_quantile(TAIL)));
    let (low, high) = ends.fold(measured.range(TAIL), |(low, high), end| (low.min(end.0), high.max(end.1)));
    (0..=points).map(|i| low + (high - low) * (i as f64 / points as f64)).collect()
}

/// The variables of the task: mean densities between neighbouring edges.
fn record(edges: &[f64], thresholds: &dyn Law, mean_field: Option<&dyn Law>, runs: &[FirstBreaks]) -> Record {
    let along = |law: &dyn Law| -> Vec<f64> {
        let density =
            |ends: &[f64]| (law.cumulative(ends[1]) - law.cumulative(ends[0])) / (ends[1] - ends[0]);
        edges.windows(2).map(density).collect()
    };
    let runs: Vec<_> = runs.iter().map(|run| run.densities(edges)).collect();
    let found: Vec<_> = (0..edges.len() - 1).map(|i| scatter(runs.iter().map(|run| run[i]))).collect();
    let mut record = Record::default();
    let middles = edges.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect();
    record.add(DRIVE, middles);
    record.add(FREE_DENSITY, along(thresholds));
    if let Some(law) = mean_field {
        record.add(MEAN_FIELD_DENSITY, along(law));
    }
    record.add(MEASURED_DENSITY, found.iter().map(|density| density.value).collect());
    record.add(MEASURED_ERROR, found.iter().map(|density| density.error).collect());
    record
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_of_means() {
        let found = scatter([1.0, 2.0, 3.0, 6.0].into_iter());
        // Variance 14/3 of four.
        assert_eq!((found.value, found.error), (3.0, (14.0_f64 / 12.0).sqrt()));
    }

    #[test]
    fn the_scatter_between_runs_counts() {
        // Runs of two contacts each, whose means are 1, 2 and 4.5, and the standard deviation of all six drives by hand.
        let drives = [[0.5, 1.5], [1.0, 3.0], [4.0, 5.0]];
        let runs: Vec<FirstBreaks> = drives.iter().map(|run| FirstBreaks::of_contacts(run)).collect();
        let squares: f64 = drives.iter().flatten().map(|drive| (drive - 2.5_f64).powi(2)).sum();
        let found = pooled_std(&runs);
        assert!((found.value - (squares / 6.0).sqrt()).abs() < 1e-14, "{found:?}");
        // Mean squares about 2.5 of the runs: 5/2, 5/4 and 17/4, with the mean 8/3 and the sum of squares 654/144 about it.
        let error = (654.0_f64 / 144.0 / 6.0).sqrt() / (2.0 * (8.0_f64 / 3.0).sqrt());
        assert!((found.error - error).abs() < 1e-14, "{found:?}");
    }
}
