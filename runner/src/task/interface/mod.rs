//! `[drive]` with `[interface]`: cells that elasticity couples, driven from event to event.

mod catalogue;
mod cells;
mod contacts;
mod course;
mod in_time;
mod model;
mod stops;

use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::scenario::{self, PerCell, Scenario};
use asperity::{Error, Result};

use super::Setting;
use super::accuracy::Accuracy;
use super::part::Part;
use crate::checkpoint::Checkpoints;
use crate::output::LARGEST;
use crate::summary::Summary;
pub use cells::Cells;
pub use contacts::Contacts;
use course::{Course, Found};
pub use in_time::{CellsInTime, cells_in_time};
pub use model::{Column, Model};
use stops::{Stop, stops};

/// Drives the interface as `task` says, from the last checkpoint if there is one.
///
/// # Errors
/// Results too large for one file, what the models run into, or the monitor's wish to stop.
pub(super) fn run(
    setting: &Setting<'_>,
    task: &scenario::Drive,
    interface: &scenario::Interface,
    checkpoints: Option<&mut Checkpoints>,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let Setting { scenario, contacts, initial } = setting;
    match interface.contacts {
        PerCell::One => {
            let ensemble = scenario.ensemble.as_ref();
            let lattice = interface.lattice(contacts.clone(), initial.clone(), ensemble)?;
            let model = Contacts { lattice, chain: chain(interface) };
            drive(setting, task, interface, model, checkpoints, monitor)
        }
        PerCell::Many if contacts.rules.are_time_dependent() => {
            let model = CellsInTime::new(setting, task, interface, &mut Part::new(monitor, 0.0, 0.0))?;
            drive(setting, task, interface, model, checkpoints, monitor)
        }
        PerCell::Many => {
            let tolerance = scenario.master_equation.tolerance();
            let ensemble = scenario.ensemble.as_ref();
            let built = interface.deformable(contacts.clone(), initial, tolerance, ensemble, monitor)?;
            let (timed, solved) = (interface.viscosity.is_some(), ensemble.is_none());
            let model = Cells { interface: built, timed, solved };
            drive(setting, task, interface, model, checkpoints, monitor)
        }
    }
}

fn drive<M: Model>(
    setting: &Setting<'_>,
    task: &scenario::Drive,
    interface: &scenario::Interface,
    model: M,
    checkpoints: Option<&mut Checkpoints>,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let stops = stops(task, interface);
    fits::<M>(&stops, interface)?;
    let course = Course::new(model, interface.catalogue_from, chain(interface), checkpoints, monitor)?;
    let found = course.follow(&stops, monitor)?;
    let summary = Summary {
        seed: seed(setting.scenario, interface),
        sample: None,
        catalogue: Some(catalogue::read::<M>(interface, &setting.scenario.units, &found.events)),
        ..setting.heading()
    };
    let summary = match found.error {
        Some(force) => accuracy(setting, force).told(setting, "the force of a cell", summary)?,
        None => summary,
    };
    Ok((summary, record::<M>(interface, &stops, found)))
}

/// How accurate the forces of cells are, `force` being the estimated error of one.
fn accuracy(setting: &Setting<'_>, force: f64) -> Accuracy {
    let in_time = Accuracy::in_time(setting, force);
    if setting.contacts.rules.are_time_dependent() {
        return in_time;
    }
    Accuracy::new(setting, in_time.error, in_time.life)
}

/// The seed of what is drawn at random, if anything is.
pub fn seed(scenario: &Scenario, interface: &scenario::Interface) -> Option<u64> {
    match (interface.contacts, &interface.disorder) {
        (PerCell::One, _) => Some(scenario.ensemble.clone().unwrap_or_default().seed),
        (PerCell::Many, _) if scenario.ensemble.is_some() => scenario.ensemble.as_ref().map(|e| e.seed),
        (PerCell::Many, Some(scales)) => scales.std.map(|_| scales.seed()),
        (PerCell::Many, None) => None,
    }
}

fn chain(interface: &scenario::Interface) -> bool {
    interface.cells.len() == 1
}

/// Refuses before any work looks at cells that could not be written after it.
fn fits<M: Model>(stops: &[Stop], interface: &scenario::Interface) -> Result<()> {
    let maps = stops.iter().filter(|stop| stop.map).count();
    let each = (interface.size() * M::MAPS.len() * size_of::<f64>()) as u64;
    let needed = maps as u64 * each;
    if needed <= LARGEST {
        return Ok(());
    }
    // Of a chain every point of the trace is a look at its cells.
    let key = if chain(interface) { "drive.points" } else { "drive.maps" };
    let expected = format!(
        "looks at the cells that fit in a result file of {} MB: {}",
        LARGEST / 1_000_000,
        LARGEST / each
    );
    Err(Error::invalid(key, expected, format!("{maps}, which take {} MB", needed / 1_000_000)))
}

/// Events as variables `event_…`, the trace, and cells at the drives of the maps.
fn record<M: Model>(interface: &scenario::Interface, stops: &[Stop], found: Found) -> Record {
    let mut record = Record::default();
    for mut variable in found.events.variables {
        variable.name = format!("event_{}", variable.name);
        record.variables.push(variable);
    }
    record.variables.extend(found.slipped.variables.into_iter().filter(|listed| !listed.values.is_empty()));
    let drives =
        |kind: fn(&Stop) -> bool| stops.iter().filter(|stop| kind(stop)).map(|stop| stop.drive).collect();
    record.push("drive", "drive", Quantity::Length, &["point"], drives(|stop| stop.point));
    for (column, values) in M::TRACE.iter().zip(found.trace) {
        record.push(column.name, column.long_name, column.quantity, &["point"], values);
    }
    let maps: Vec<f64> = drives(|stop| stop.map);
    if maps.is_empty() {
        return record;
    }
    record.push("map_drive", "drive at which cells are shown", Quantity::Length, &["map_drive"], maps);
    let sides = match interface.cells[..] {
        [rows, columns] => vec![("row", rows), ("column", columns)],
        _ => vec![("cell", interface.size())],
    };
    for &(side, size) in &sides {
        let numbers = (0..size).map(|i| i as f64).collect();
        record.push(side, &format!("{side}, counted from 0"), Quantity::Number, &[side], numbers);
    }
    let along: Vec<_> = ["map_drive"].into_iter().chain(sides.iter().map(|side| side.0)).collect();
    for (column, values) in M::MAPS.iter().zip(found.maps) {
        record.push(column.name, column.long_name, column.quantity, &along, values);
    }
    record
}
