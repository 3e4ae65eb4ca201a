//! `[renormalisation]`: the law of the drives at which coupled contacts break first, beside that of their thresholds and
//! what mean field makes of it.

use asperity::Result;
use asperity::first_breaks::FirstBreaks;
use asperity::law::{Law, Renormalised, critical_coupling};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::scenario::{Ensemble, Interface, PerCell, Renormalisation};

use super::part::Part;
use super::{Setting, interface};
use crate::summary::{self, Compared, Fitted, Size, Summary};

/// Share of a law that is not shown at either end.
const TAIL: f64 = 1e-4;

/// Drives the interfaces that `task` asks for.
///
/// # Errors
/// What the interface refuses, or the monitor's wish to stop.
pub fn run(
    setting: &Setting<'_>,
    task: &Renormalisation,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let interface = setting.scenario.interface.as_ref().expect("a scenario of this task has one");
    let shared = interface.thresholds(&setting.contacts)?;
    let thresholds = shared.as_ref();
    let coupling = interface.total_share(&setting.contacts)?;
    let critical = critical_coupling(thresholds);
    let mean_field =
        (coupling < critical).then(|| Renormalised::new(shared.clone(), coupling)).transpose()?;
    let mean_field = mean_field.as_ref().map(|law| law as &dyn Law);
    let runs = measured(setting, task, interface, coupling, monitor)?;
    let all = FirstBreaks::together(&runs);
    let compared = |law: &dyn Law| Compared { mean: law.mean(), std: law.std(), distance: all.distance(law) };
    let laws = summary::Renormalisation {
        coupling,
        critical_coupling: critical,
        size: match interface.contacts {
            PerCell::One => Size::Contacts(interface.size()),
            PerCell::Many => Size::Cells(interface.size()),
        },
        runs: task.runs,
        mean: scatter(runs.iter().map(FirstBreaks::mean)),
        std: scatter(runs.iter().map(FirstBreaks::std)),
        thresholds: compared(thresholds),
        mean_field: mean_field.map(compared),
    };
    let seed = interface::seed(setting.scenario, interface);
    let known: Vec<_> = [thresholds].into_iter().chain(mean_field).collect();
    let record = record(&edges(&known, &all, task.points), thresholds, mean_field, &runs);
    Ok((Summary { seed, sample: None, renormalisation: Some(laws), ..setting.heading() }, record))
}

/// The law of first breaks in each run.
fn measured(
    setting: &Setting<'_>,
    task: &Renormalisation,
    interface: &Interface,
    coupling: f64,
    monitor: &mut dyn Monitor,
) -> Result<Vec<FirstBreaks>> {
    let share = 1.0 / task.runs as f64;
    let run = |run: usize| {
        let mut part = Part::new(monitor, run as f64 * share, share);
        match interface.contacts {
            PerCell::One => of_contacts(setting, interface, run, &mut part),
            PerCell::Many => of_cells(setting, &interface.redrawn(run), coupling, &mut part),
        }
    };
    (0..task.runs).map(run).collect()
}

/// Contacts coupled one by one, drawn from the seed of the ensemble and as many further on as there were runs before.
fn of_contacts(
    setting: &Setting<'_>,
    interface: &Interface,
    run: usize,
    monitor: &mut dyn Monitor,
) -> Result<FirstBreaks> {
    let first = setting.scenario.ensemble.clone().unwrap_or_default();
    let ensemble = Ensemble { seed: first.seed + run as u64, ..first };
    let (contacts, initial) = (setting.contacts.clone(), setting.initial.clone());
    let mut lattice = interface.lattice(contacts, initial, Some(&ensemble))?;
    Ok(FirstBreaks::of_contacts(&lattice.first_breaks(monitor)?))
}

/// Contacts of cells.
fn of_cells(
    setting: &Setting<'_>,
    interface: &Interface,
    coupling: f64,
    monitor: &mut dyn Monitor,
) -> Result<FirstBreaks> {
    let Setting { scenario, contacts, initial } = setting;
    let tolerance = scenario.master_equation.tolerance();
    let mut cells = interface.deformable(contacts.clone(), initial, tolerance, None, monitor)?;
    cells.first_breaks(contacts.thresholds.as_ref(), coupling, monitor)
}

/// The mean of runs, with its standard error.
fn scatter(values: impl ExactSizeIterator<Item = f64> + Clone) -> Fitted {
    let count = values.len() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let square = values.map(|value| (value - mean).powi(2)).sum::<f64>();
    Fitted { value: mean, error: (square / (count * (count - 1.0))).sqrt() }
}

/// Boundaries of so many intervals over all laws, but for their tails.
fn edges(laws: &[&dyn Law], measured: &FirstBreaks, points: usize) -> Vec<f64> {
    let ends = laws.iter().map(|law| (law.quantile(TAIL), law.upper_quantile(TAIL)));
    let (low, high) = ends.fold(measured.range(TAIL), |(low, high), end| (low.min(end.0), high.max(end.1)));
    (0..=points).map(|i| low + (high - low) * (i as f64 / points as f64)).collect()
}

/// Mean densities between neighbouring edges.
fn record(edges: &[f64], thresholds: &dyn Law, mean_field: Option<&dyn Law>, runs: &[FirstBreaks]) -> Record {
    let along = |law: &dyn Law| -> Vec<f64> {
        let density =
            |ends: &[f64]| (law.cumulative(ends[1]) - law.cumulative(ends[0])) / (ends[1] - ends[0]);
        edges.windows(2).map(density).collect()
    };
    let runs: Vec<_> = runs.iter().map(|run| run.densities(edges)).collect();
    let found: Vec<_> = (0..edges.len() - 1).map(|i| scatter(runs.iter().map(|run| run[i]))).collect();
    let mut record = Record::default();
    let mut add = |name, words, quantity, values| record.push(name, words, quantity, &["drive"], values);
    let middles = edges.windows(2).map(|ends| 0.5 * (ends[0] + ends[1])).collect();
    add("drive", "drive, in the middle of an interval", Quantity::Length, middles);
    let density = Quantity::PerLength;
    add("free_density", "density of thresholds", density, along(thresholds));
    if let Some(law) = mean_field {
        add("mean_field_density", "density of thresholds renormalised in mean field", density, along(law));
    }
    add(
        "measured_density",
        "density of first breaks",
        density,
        found.iter().map(|density| density.value).collect(),
    );
    add("measured_error", "its standard error", density, found.iter().map(|density| density.error).collect());
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
}
