//! `[drive]` with `[interface]`: cells that elasticity couples, driven from event to event.

mod catalogue;
mod contacts;
mod course;
mod model;

use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::scenario::{self, PerCell};
use asperity::{Error, Result};

use super::Setting;
use crate::checkpoint::Checkpoints;
use crate::output::LARGEST;
use crate::summary::Summary;
use course::Course;
use model::Model;

/// Drives the interface as `task` says, from the last checkpoint if there is one.
///
/// # Errors
/// Results too large for one file, what the models run into, or the monitor's wish to stop.
pub fn run(
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
            let model = interface.lattice(contacts.clone(), initial.clone(), ensemble)?;
            drive(setting, task, interface, model, checkpoints, monitor)
        }
        PerCell::Many => Err(Error::invalid("interface.contacts", "\"one\"", "many")),
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
    fits::<M>(task, interface)?;
    let course = Course::new(model, interface.catalogue_from, checkpoints)?;
    let (events, maps) = course.follow(task, monitor)?;
    let summary = Summary {
        seed: Some(setting.scenario.ensemble.clone().unwrap_or_default().seed),
        sample: None,
        catalogue: Some(catalogue::read::<M>(interface, &events)),
        ..setting.heading()
    };
    Ok((summary, record(interface, task, events, maps)))
}

/// Refuses before any work maps that could not be written after it.
fn fits<M: Model>(task: &scenario::Drive, interface: &scenario::Interface) -> Result<()> {
    let needed = task.maps.len() as u64 * interface.size() as u64 * (M::MAPS.len() * size_of::<f64>()) as u64;
    if needed <= LARGEST {
        return Ok(());
    }
    let expected = format!("maps that fit in a result file of {} MB", LARGEST / 1_000_000);
    let found = format!("{} maps, which take {} MB", task.maps.len(), needed / 1_000_000);
    Err(Error::invalid("drive.maps", expected, found))
}

/// Events as variables `event_…`, cells at the drives of the maps.
fn record(
    interface: &scenario::Interface,
    task: &scenario::Drive,
    events: Record,
    maps: Vec<(model::Map, Vec<f64>)>,
) -> Record {
    let mut record = Record::default();
    for mut variable in events.variables {
        variable.name = format!("event_{}", variable.name);
        record.variables.push(variable);
    }
    if task.maps.is_empty() {
        return record;
    }
    let words = "drive at which cells are shown";
    record.push("map_drive", words, Quantity::Length, &["map_drive"], task.maps.clone());
    let numbers = |size: usize| (0..size).map(|i| i as f64).collect();
    let sides = match interface.cells[..] {
        [rows, columns] => vec![("row", rows), ("column", columns)],
        _ => vec![("cell", interface.size())],
    };
    for &(side, size) in &sides {
        record.push(side, &format!("{side} of cells"), Quantity::Number, &[side], numbers(size));
    }
    let along: Vec<_> = ["map_drive"].into_iter().chain(sides.iter().map(|side| side.0)).collect();
    for (map, values) in maps {
        record.push(map.name, map.long_name, map.quantity, &along, values);
    }
    record
}
