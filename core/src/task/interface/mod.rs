//! `[drive]` with `[interface]`: cells coupled by elasticity, driven from event to event.

mod catalogue;
mod cells;
mod contacts;
mod in_time;
mod model;
mod output_points;
mod run;

use super::accuracy::ForceAccuracy;
use super::background::coefficient;
use super::summary::InterfaceNumbers;
use super::{Checkpoints, Output};
use crate::elastic::Event;
use crate::monitor::{Monitor, Part};
use crate::record::{Column, LARGEST, Quantity, Record};
use crate::scenario::{self, Drive, Model, PerCell, Task, Units};
use crate::{Error, Result};
pub use cells::DrivenCells;
pub use contacts::DrivenContacts;
pub use in_time::{DrivenRateDependentCells, cells_in_time};
pub use model::DrivenInterface;
use output_points::{OutputPoint, output_points};
use run::{Found, InterfaceRun};

const DRIVE: Column = Column::new("drive", "drive", Quantity::Length, &["point"]);
const CELL: Column = Column::new("cell", "cell, counted from 0", Quantity::Count, &["cell"]);
const ROW: Column = Column::new("row", "row, counted from 0", Quantity::Count, &["row"]);
const COLUMN: Column = Column::new("column", "column, counted from 0", Quantity::Count, &["column"]);
const MAP_DRIVE: Column = Column::new(
    "map_drive",
    "drive at which the state of the cells is given",
    Quantity::Length,
    &["map_drive"],
);

impl Drive {
    /// Drives the interface of `model`.
    ///
    /// # Errors
    /// A model without an interface, and those of [`run`](Self::run).
    pub fn run_interface(
        &self,
        model: &Model,
        monitor: &mut dyn Monitor,
    ) -> Result<Output<InterfaceNumbers>> {
        Task::Drive(self).check(model)?;
        let interface = model.interface.as_ref();
        let interface =
            interface.ok_or_else(|| Error::invalid("interface", "one, which is driven", "none"))?;
        run(model, self, (interface, &Units::default()), None, monitor).map_err(Error::of_scenario)
    }
}

/// Drives the interface as `task` says, from the last checkpoint if there is one.
///
/// # Errors
/// Results too large for one file, errors of the interface, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &Drive,
    (interface, units): (&scenario::Interface, &Units),
    checkpoints: Option<&mut dyn Checkpoints>,
    monitor: &mut dyn Monitor,
) -> Result<Output<InterfaceNumbers>> {
    let Model { contacts, initial, ensemble, .. } = model;
    match interface.contacts {
        PerCell::One => {
            let lattice = interface.lattice(contacts.clone(), initial.clone(), ensemble.as_ref())?;
            let driven = DrivenContacts { lattice, chain: chain(interface) };
            drive(model, task, (interface, units), driven, checkpoints, monitor)
        }
        PerCell::Many if contacts.rules.are_time_dependent() => {
            let driven =
                DrivenRateDependentCells::new(model, task, interface, &mut Part::new(monitor, 0.0, 0.0))?;
            drive(model, task, (interface, units), driven, checkpoints, monitor)
        }
        PerCell::Many => {
            let tolerance = model.master_equation.tolerance();
            let built =
                interface.deformable(contacts.clone(), initial, tolerance, ensemble.as_ref(), monitor)?;
            let (timed, solved) = (interface.viscosity.is_some(), ensemble.is_none());
            let driven = DrivenCells { interface: built, timed, solved };
            drive(model, task, (interface, units), driven, checkpoints, monitor)
        }
    }
}

fn drive<D: DrivenInterface>(
    model: &Model,
    task: &Drive,
    (interface, units): (&scenario::Interface, &Units),
    driven: D,
    checkpoints: Option<&mut dyn Checkpoints>,
    monitor: &mut dyn Monitor,
) -> Result<Output<InterfaceNumbers>> {
    let output_points = output_points(task, interface);
    check_size::<D>(&output_points, interface)?;
    let run = InterfaceRun::new(driven, interface.catalogue_from, chain(interface), checkpoints, monitor)?;
    let found = run.follow(&output_points, monitor)?;
    let error = found.error;
    let numbers = InterfaceNumbers { catalogue: catalogue::read::<D>(interface, units, &found.events) };
    let mut record = record::<D>(interface, &output_points, found);
    let cells = if interface.contacts == PerCell::One { 1 } else { interface.size() };
    model.add_background_of_cells(cells, &mut record);
    let output = Output { seed: seed(model, interface), sample: None, ..Output::new(model, numbers, record) };
    match error {
        Some(force) => accuracy(model, force).of(model, "the force of a cell", output),
        None => Ok(output),
    }
}

/// The accuracy of the forces of cells, from the estimated error `force` of one cell.
fn accuracy(model: &Model, force: f64) -> ForceAccuracy {
    let in_time = ForceAccuracy::in_time(model, force);
    if model.contacts.rules.are_time_dependent() {
        return in_time;
    }
    ForceAccuracy::new(model, in_time.error, in_time.life)
}

/// The seed of the random numbers; `None` if none are drawn.
pub(super) fn seed(model: &Model, interface: &scenario::Interface) -> Option<u64> {
    match (interface.contacts, &interface.disorder) {
        (PerCell::One, _) => Some(model.ensemble.clone().unwrap_or_default().seed),
        (PerCell::Many, _) if model.ensemble.is_some() => model.ensemble.as_ref().map(|e| e.seed),
        (PerCell::Many, Some(scales)) => scales.std.map(|_| scales.seed()),
        (PerCell::Many, None) => None,
    }
}

fn chain(interface: &scenario::Interface) -> bool {
    interface.cells.len() == 1
}

/// Refuses, before any work, maps of the cells that are too large for one file.
fn check_size<D: DrivenInterface>(
    output_points: &[OutputPoint],
    interface: &scenario::Interface,
) -> Result<()> {
    let maps = output_points.iter().filter(|at| at.map).count();
    let each = (interface.size() * D::MAPS.len() * size_of::<f64>()) as u64;
    let needed = maps as u64 * each;
    if needed <= LARGEST {
        return Ok(());
    }
    // The cells of a chain are recorded at every point of the trace.
    let key = if chain(interface) { "drive.points" } else { "drive.maps" };
    let expected = format!(
        "maps of the cells that fit in a result file of {} MB: {}",
        LARGEST / 1_000_000,
        LARGEST / each
    );
    Err(Error::invalid(key, expected, format!("{maps}, which take {} MB", needed / 1_000_000)))
}

/// The variables that the drive of an interface may record, without values: for cells, and for contacts coupled one by one.
/// On a lattice the dimensions of the cells are `row` and `column`.
pub(super) fn columns() -> [Record; 2] {
    [
        columns_of::<DrivenRateDependentCells>(Event::columns(), cells::slipped(&[], 1, true)),
        columns_of::<DrivenContacts>(contacts::event_columns(&[], 1), contacts::broken_columns(&[], 1)),
    ]
}

fn columns_of<D: DrivenInterface>(events: Record, slipped: Record) -> Record {
    let mut record = events;
    record.variables.iter_mut().for_each(|variable| variable.name.insert_str(0, "event_"));
    record.variables.extend(slipped.variables);
    let cells = [coefficient(&["point"]), MAP_DRIVE, CELL, ROW, COLUMN];
    for column in [DRIVE].iter().chain(D::TRACE).chain(&cells).chain(D::MAPS) {
        record.add(*column, Vec::new());
    }
    record
}

/// Events as variables `event_…`, the trace, and the maps of the cells.
fn record<D: DrivenInterface>(
    interface: &scenario::Interface,
    output_points: &[OutputPoint],
    found: Found,
) -> Record {
    let mut record = Record::default();
    for mut variable in found.events.variables {
        variable.name = format!("event_{}", variable.name);
        record.variables.push(variable);
    }
    record.variables.extend(found.slipped.variables.into_iter().filter(|listed| !listed.values.is_empty()));
    let drives = |kind: fn(&OutputPoint) -> bool| {
        output_points.iter().filter(|at| kind(at)).map(|at| at.drive).collect()
    };
    record.add(DRIVE, drives(|at| at.point));
    for (column, values) in D::TRACE.iter().zip(found.trace) {
        record.add(*column, values);
    }
    let maps: Vec<f64> = drives(|at| at.map);
    if maps.is_empty() {
        return record;
    }
    record.add(MAP_DRIVE, maps);
    let sides = match interface.cells[..] {
        [rows, columns] => vec![(ROW, rows), (COLUMN, columns)],
        _ => vec![(CELL, interface.size())],
    };
    for &(side, size) in &sides {
        record.add(side, (0..size).map(|i| i as f64).collect());
    }
    // The cells of a lattice lie along two dimensions, those of a chain along one.
    let along: Vec<_> = ["map_drive"].into_iter().chain(sides.iter().map(|(side, _)| side.name)).collect();
    for (column, values) in D::MAPS.iter().zip(found.maps) {
        record.push(column.name, column.long_name, column.quantity, &along, values);
    }
    record
}
