//! `[drive]` and `[[protocol]]` with `[interface]`: cells coupled by elasticity, driven from event to event.

mod catalogue;
mod cells;
mod contacts;
mod contacts_in_time;
mod found;
mod in_time;
mod main_shocks;
mod model;
mod output_points;
mod run;

use super::accuracy::ForceAccuracy;
use super::background::coefficient;
use super::fits;
use super::summary::{Catalogue, InterfaceNumbers};
use super::{Output, Storage};
use crate::elastic::{Event, SlipRates};
use crate::ensemble::lattice::record_in_time;
use crate::monitor::{Monitor, Preparation, Rising};
use crate::record::{Column, Quantity, Record};
use crate::scenario::{self, Drive, Model, PerCell, Protocol, Task, Units};
use crate::{Error, Result};
pub use cells::DrivenCells;
pub use contacts::DrivenContacts;
pub use contacts_in_time::DrivenContactsInTime;
use found::{CellColumns, Found};
pub use in_time::{DrivenRateDependentCells, LoadPointMotion, cells_in_time};
pub(super) use main_shocks::TABLES as MAIN_SHOCK_TABLES;
pub use model::DrivenInterface;
use output_points::{OutputPoint, output_points, points_in_time};
use run::InterfaceRun;

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
/// Of the slip rates of cells in time.
const SLIP_RATE_TIME: Column = Column::new(
    "slip_rate_time",
    "time of the steps at which the slip rate of the cells is given",
    Quantity::Time,
    &["slip_rate_time"],
);
const SLIP_RATE_STEP: Column =
    Column::new("slip_rate_step", "number of the step", Quantity::Number, &["slip_rate_time"]);
const SLIP_RATE_DRIVE: Column =
    Column::new("slip_rate_drive", "drive at the step", Quantity::Length, &["slip_rate_time"]);
const SLIP_RATE: Column =
    Column::new("slip_rate", "velocity of a cell", Quantity::Velocity, &["slip_rate_time", "cell"]);
const MAP_TIME: Column =
    Column::new("map_time", "time at which the state of the cells is given", Quantity::Time, &["map_drive"]);

/// Columns of cells over time-dependent contacts alone.
const IN_TIME: [Column; 5] = [MAP_TIME, SLIP_RATE_TIME, SLIP_RATE_STEP, SLIP_RATE_DRIVE, SLIP_RATE];

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
        let monitor = &mut Rising::new(monitor);
        run(model, self, (interface, &Units::default()), Storage::default(), monitor)
            .map_err(Error::of_scenario)
    }
}

impl Protocol {
    /// Moves the load point of the interface of `model`, whose contacts are time-dependent.
    ///
    /// # Errors
    /// A model without an interface, and those of [`run`](Self::run).
    pub fn run_interface(
        &self,
        model: &Model,
        monitor: &mut dyn Monitor,
    ) -> Result<Output<InterfaceNumbers>> {
        Task::Protocol(self).check(model)?;
        let interface = model.interface.as_ref();
        let interface =
            interface.ok_or_else(|| Error::invalid("interface", "one, whose load point is moved", "none"))?;
        let monitor = &mut Rising::new(monitor);
        run_protocol(model, self, (interface, &Units::default()), Storage::default(), monitor)
            .map_err(Error::of_scenario)
    }
}

/// Moves the load point of the interface as `task` says, from the last checkpoint if there is one.
///
/// # Errors
/// As [`run`].
pub(super) fn run_protocol(
    model: &Model,
    task: &Protocol,
    (interface, units): (&scenario::Interface, &Units),
    storage: Storage<'_>,
    monitor: &mut dyn Monitor,
) -> Result<Output<InterfaceNumbers>> {
    let motion = task.build()?;
    fit_into_memory(model, interface, monitor)?;
    if interface.contacts == PerCell::One {
        let velocity = motion.pieces()[0].velocity;
        let contacts = contacts_at(model, interface, Some(velocity), monitor)?;
        let driven = DrivenContactsInTime::new(contacts, LoadPointMotion::History(motion.clone()));
        let points = points_in_time(task, &motion, interface, driven.origin());
        return drive(model, &points, (interface, units), driven, storage, monitor);
    }
    let mut preparation = Preparation::new(monitor);
    let history = LoadPointMotion::History(motion.clone());
    // What the pieces of ramps change falls with the square of their number.
    let coarse = task.with_pieces(|count| count.div_ceil(2)).map(|coarse| coarse.build()).transpose()?;
    let motions = (history, coarse.map(LoadPointMotion::History));
    let driven = DrivenRateDependentCells::of(model, interface, motions, &mut preparation)?;
    let points = points_in_time(task, &motion, interface, driven.origin());
    drive(model, &points, (interface, units), driven, storage, &mut preparation.rest())
}

/// Drives the interface as `task` says, from the last checkpoint if there is one.
///
/// # Errors
/// An interface or results too large for the memory, errors of the interface, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &Drive,
    (interface, units): (&scenario::Interface, &Units),
    storage: Storage<'_>,
    monitor: &mut dyn Monitor,
) -> Result<Output<InterfaceNumbers>> {
    let Model { contacts, initial, ensemble, .. } = model;
    fit_into_memory(model, interface, monitor)?;
    match interface.contacts {
        PerCell::One if contacts.rules.are_time_dependent() => {
            let contacts = contacts_at(model, interface, task.velocity, monitor)?;
            let driven = DrivenContactsInTime::new(contacts, LoadPointMotion::of(task)?);
            let points = output_points(task, interface, driven.origin());
            drive(model, &points, (interface, units), driven, storage, monitor)
        }
        PerCell::One => {
            let driven = contacts_at(model, interface, None, monitor)?;
            let points = output_points(task, interface, driven.origin());
            drive(model, &points, (interface, units), driven, storage, monitor)
        }
        PerCell::Many if interface.moves_in_time(contacts) => {
            let mut preparation = Preparation::new(monitor);
            let motion = LoadPointMotion::of(task)?;
            let driven = DrivenRateDependentCells::of(model, interface, (motion, None), &mut preparation)?;
            let points = output_points(task, interface, driven.origin());
            drive(model, &points, (interface, units), driven, storage, &mut preparation.rest())
        }
        PerCell::Many => {
            let tolerance = model.master_equation.tolerance();
            let built =
                interface.deformable(contacts.clone(), initial, tolerance, ensemble.as_ref(), monitor)?;
            let (timed, solved) = (interface.viscosity.is_some(), ensemble.is_none());
            let driven = DrivenCells::new(built, timed, solved);
            let points = output_points(task, interface, driven.origin());
            drive(model, &points, (interface, units), driven, storage, monitor)
        }
    }
}

/// Contacts coupled one by one, at the velocity at which they begin if they are time-dependent.
fn contacts_at(
    model: &Model,
    interface: &scenario::Interface,
    velocity: Option<f64>,
    monitor: &mut dyn Monitor,
) -> Result<DrivenContacts> {
    let Model { contacts, initial, ensemble, .. } = model;
    let lattice =
        interface.lattice(contacts.clone(), initial.clone(), ensemble.as_ref(), velocity, monitor)?;
    Ok(DrivenContacts { lattice, chain: chain(interface) })
}

fn drive<D: DrivenInterface>(
    model: &Model,
    output_points: &[OutputPoint],
    (interface, units): (&scenario::Interface, &Units),
    driven: D,
    mut storage: Storage<'_>,
    monitor: &mut dyn Monitor,
) -> Result<Output<InterfaceNumbers>> {
    check_size::<D>(output_points, (interface, storage.columns.is_some()), monitor)?;
    let from = driven.origin() + interface.catalogue_from;
    let columns = CellColumns::of(model, interface);
    let mut run = InterfaceRun::new(driven, (from, chain(interface)), columns, storage.borrowed(), monitor)?;
    run.follow(output_points, monitor)?;
    let mut found = run.finish()?;
    let error = found.error;
    let mut rates = Record::default();
    let catalogue = Catalogue {
        from: if interface.catalogue_from > 0.0 { from } else { 0.0 },
        main_shocks: main_shocks::read(interface, D::CLOCK, &mut found, &mut rates, monitor)?,
        ..catalogue::read::<D>(interface, units, &mut found)?
    };
    let numbers = InterfaceNumbers { catalogue };
    let mut record = record::<D>(interface, output_points, found);
    record.variables.extend(rates.variables);
    let areas = interface.relative_areas();
    model.add_background_of_cells(contacts_of_all(interface), areas.as_deref(), &mut record);
    let output = Output { seed: seed(model, interface), sample: None, ..Output::new(model, numbers, record) };
    match error {
        Some(force) => accuracy(model, force).of(model, "the force of a cell", output),
        None => Ok(output),
    }
}

/// The accuracy of the forces of cells, from the estimated error `force` of one cell.
fn accuracy(model: &Model, force: f64) -> ForceAccuracy {
    let in_time = ForceAccuracy::in_time(model, force);
    if model.interface.as_ref().is_some_and(|own| own.moves_in_time(&model.contacts)) {
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

/// Refuses, before any work, cells that do not fit in memory.
fn fit_into_memory(model: &Model, interface: &scenario::Interface, monitor: &dyn Monitor) -> Result<()> {
    let ensemble = model.ensemble.as_ref();
    interface.fits(&model.contacts, ensemble, model.estimates_error_of_cells(), monitor.memory())
}

/// Number of populations of contacts: one for each cell, or one in all where every cell is a contact.
fn contacts_of_all(interface: &scenario::Interface) -> usize {
    if interface.contacts == PerCell::One { 1 } else { interface.size() }
}

/// Refuses, before any work, maps of the cells that do not fit in memory. What is `stored` need not.
fn check_size<D: DrivenInterface>(
    output_points: &[OutputPoint],
    (interface, stored): (&scenario::Interface, bool),
    monitor: &dyn Monitor,
) -> Result<()> {
    let maps = output_points.iter().filter(|at| at.map).count();
    let kept = if stored { maps.min(1) } else { maps };
    let numbers = kept.saturating_mul(interface.size() * D::MAPS.len());
    // The cells of a chain are recorded at every point of the trace.
    let key = match (output_points.iter().any(|at| at.time.is_some()), chain(interface)) {
        (true, _) => "protocol",
        (false, true) => "drive.points",
        (false, false) => "drive.maps",
    };
    fits(key, numbers, || format!("{maps} maps of the cells"), monitor)
}

/// The variables that the drive of an interface may record, without values: for cells, for contacts coupled one by one, and for
/// these in time.
/// On a lattice the dimensions of the cells are `row` and `column`.
pub(super) fn columns() -> [Record; 3] {
    let lattice_columns = || contacts::event_columns(&[], 1);
    let mut in_time = lattice_columns();
    in_time.variables.extend(record_in_time(&[]).variables);
    [
        columns_of::<DrivenRateDependentCells>(Event::columns(), cells::slipped(&[], 1, true)),
        of_contacts::<DrivenContacts>(lattice_columns(), main_shocks::SHOCK_DRIVE),
        of_contacts::<DrivenContactsInTime>(in_time, main_shocks::COLUMNS[0]),
    ]
}

/// The variables of contacts coupled one by one, with the rates around main shocks along `along`.
fn of_contacts<D: DrivenInterface>(events: Record, along: Column) -> Record {
    let mut record = columns_of::<D>(events, contacts::broken_columns(&[], 1));
    record.add(along, Vec::new());
    for Column { name, long_name, quantity, .. } in &main_shocks::COLUMNS[1..] {
        record.push(name, long_name, *quantity, &[along.name], Vec::new());
    }
    record
}

fn columns_of<D: DrivenInterface>(events: Record, slipped: Record) -> Record {
    let mut record = events;
    record.variables.iter_mut().for_each(|variable| variable.name.insert_str(0, "event_"));
    record.variables.extend(slipped.variables);
    let cells = [coefficient(&["point"]), MAP_DRIVE, CELL, ROW, COLUMN];
    let is_in_time = D::TRACE.iter().any(|column| column.name == "time");
    let in_time: &[Column] = match D::TRACE.iter().any(|column| column.name == "velocity") {
        true => &IN_TIME,
        false if is_in_time => &IN_TIME[..1],
        false => &[],
    };
    for column in [DRIVE].iter().chain(D::TRACE).chain(&cells).chain(D::MAPS).chain(in_time) {
        record.add(*column, Vec::new());
    }
    record
}

/// The columns that number the cells: those of a lattice lie along two dimensions, those of a chain along one.
fn sides_of(interface: &scenario::Interface) -> Vec<Column> {
    if chain(interface) { vec![CELL] } else { vec![ROW, COLUMN] }
}

/// Events as variables `event_…`, the trace, and the maps of the cells.
fn record<D: DrivenInterface>(
    interface: &scenario::Interface,
    output_points: &[OutputPoint],
    found: Found,
) -> Record {
    let mut record =
        if found.stored { Record::default() } else { found::events(found.events, found.slipped) };
    let drives = |kind: fn(&OutputPoint) -> bool| {
        output_points.iter().filter(|at| kind(at)).map(|at| at.drive).collect()
    };
    record.add(DRIVE, drives(|at| at.point));
    for (column, values) in D::TRACE.iter().zip(found.trace) {
        record.add(*column, values);
    }
    let sides: Vec<_> = sides_of(interface).into_iter().zip(&interface.cells).collect();
    let maps: Vec<f64> = drives(|at| at.map);
    if !maps.is_empty() || found.slip_rates.is_some() {
        for &(side, size) in &sides {
            record.add(side, (0..*size).map(|i| i as f64).collect());
        }
    }
    let along = |first: &'static str| -> Vec<&str> {
        [first].into_iter().chain(sides.iter().map(|(side, _)| side.name)).collect()
    };
    if !maps.is_empty() {
        record.add(MAP_DRIVE, maps);
        // Along a protocol drives do not determine when: the load point may be at rest.
        let times: Vec<f64> = output_points.iter().filter(|at| at.map).filter_map(|at| at.time).collect();
        if !times.is_empty() {
            record.add(MAP_TIME, times);
        }
        if !found.stored {
            found::add_maps(D::MAPS, found.maps, &sides_of(interface), &mut record);
        }
    }
    if let Some(rates) = &found.slip_rates {
        add_slip_rates(rates, &along(SLIP_RATE_TIME.name), &mut record);
    }
    record
}

/// Adds the velocities of all cells at steps in time, along these dimensions.
fn add_slip_rates(rates: &SlipRates, along: &[&str], record: &mut Record) {
    record.add(SLIP_RATE_TIME, rates.time().to_vec());
    record.add(SLIP_RATE_STEP, rates.steps().map(|step| step as f64).collect());
    record.add(SLIP_RATE_DRIVE, rates.drive().to_vec());
    let Column { name, long_name, quantity, .. } = SLIP_RATE;
    record.push(name, long_name, quantity, along, rates.velocity().to_vec());
}
