//! `[drive]`: the top of the slider is moved, or a force imposed, and the base of the slider follows.

use super::accuracy::ForceAccuracy;
use super::sliding::{self, adopt};
use super::summary::{DriveNumbers, Sliding};
use super::{Output, fits, friction, in_time, interface};
use crate::block::{Block, Curve, Loading, StickSlip};
use crate::contacts::Contacts;
use crate::master::MasterEquation;
use crate::monitor::{Aside, Monitor, Part};
use crate::population::Population;
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, Model};
use crate::{Error, Result};

/// Length of the first loading, in mean thresholds.
const LOADING: f64 = 5.0;
/// Points of the curves of equilibria and of the potential.
const FINE: usize = 2001;
/// Drives at which the potential is given, in units of that of the first slip.
const POTENTIALS: [f64; 3] = [0.9, 1.0, 1.1];
/// Columns of a trace.
const WIDTH: usize = 5;

const BRANCH_POSITION: Column =
    Column::new("branch_position", "position of the slider's base", Quantity::Length, &["branch"]);
const BRANCH_DRIVE: Column =
    Column::new("branch_drive", "drive of the equilibrium at that position", Quantity::Length, &["branch"]);
const BRANCH_FORCE: Column =
    Column::new("branch_force", "friction force at that position", Quantity::Force, &["branch"]);
const BRANCH_STABLE: Column =
    Column::new("branch_stable", "whether the equilibrium is stable", Quantity::Flag, &["branch"]);
const POTENTIAL_DRIVE: Column = Column::new(
    "potential_drive",
    "drive at which the potential is given: before, at and after the first slip",
    Quantity::Length,
    &["potential_drive"],
);
const POTENTIAL: Column =
    Column::new("potential", "potential of the slider", Quantity::Energy, &["potential_drive", "branch"]);

/// The variables of the first loading behind a spring.
const COLUMNS: [Column; 6] =
    [BRANCH_POSITION, BRANCH_DRIVE, BRANCH_FORCE, BRANCH_STABLE, POTENTIAL_DRIVE, POTENTIAL];

/// Traces and slips have tables of their own kinds.
pub(super) const TABLES: &[CsvTable] = &interface::MAIN_SHOCK_TABLES;

/// What a result may hold, without values: that of a slider, and those of an interface.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    let [motion, slips] = StickSlip::columns();
    let mut driven = sliding::joined(motion, slips);
    let ensemble = driven.prefixed("ensemble_");
    driven.variables.extend(
        Record::declared(&[&[in_time::FRICTION_COEFFICIENT], &sliding::COLUMNS[..5], &COLUMNS]).variables,
    );
    driven.variables.extend(ensemble.variables);
    driven.variables.extend(Record::declared(&[&sliding::COLUMNS[5..]]).variables);
    let [cells, contacts, in_time] = interface::columns();
    vec![
        ("drive", driven),
        ("interface_drive", cells),
        ("interface_drive of contacts", contacts),
        ("interface_drive of contacts in time", in_time),
    ]
}

/// Drives the slider as `task` says.
///
/// # Errors
/// Results too large for the memory, errors of the solvers, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &scenario::Drive,
    monitor: &mut dyn Monitor,
) -> Result<Output<DriveNumbers>> {
    if model.interface.is_some() {
        return Err(Error::invalid("interface", "none: Drive::run_interface drives an interface", "one"));
    }
    let Model { contacts, initial, .. } = model;
    if contacts.rules.are_time_dependent() {
        return at_a_velocity(model, &task.forward()?, monitor);
    }
    check_size(task, model.ensemble.is_some(), monitor)?;
    let build = |ensemble: &scenario::Ensemble| ensemble.build(contacts.clone(), initial.clone());
    let ensemble = model.ensemble.as_ref().map(build).transpose()?;
    ensemble.as_ref().map_or(Ok(()), |ensemble| ensemble.population_fits(monitor.memory()))?;
    let equation = MasterEquation::new_with(contacts.clone(), initial, &mut Part::new(monitor, 0.0, 0.0))?;
    let tolerance = model.master_equation.tolerance();
    let loading = first_loading_distance(contacts);
    let reach = task.turns().iter().fold(loading, |far, turn| far.max(*turn));
    let fractions = if model.ensemble.is_some() { [0.05, 0.25] } else { [0.1, 0.9] };
    let pull = equation.pull_with(reach, tolerance, &mut Part::new(monitor, 0.0, fractions[0]))?;
    let mut population = equation.population_with(tolerance, &mut Part::new(monitor, fractions[0], 0.0))?;
    let block = model.block.as_ref();
    let mut record = Record::default();
    // The curve of equilibria is that of the first loading, from the initial state.
    let fresh = population.copy();
    let master = task.slider(block, false)?.with_background(model.background)?;
    let part = &mut Part::new(monitor, fractions[0], fractions[1]);
    let protocol = task.build(master.start(&mut population)?);
    let run = master.pull_with(&mut population, &protocol, part)?;
    // The error of the force has two parts: that of the contacts, and that of the motion. The energy imbalance divided by
    // a mean life, the distance over which contacts are replaced, measures the second one.
    let lives = model.stiffness() * equation.steady_state().mean_life();
    let error = population.error() / model.stiffness() + run.energy.imbalance().abs() / lives;
    adopt(sliding::motion(&run), "", &mut record);
    adopt(sliding::course(&run), "", &mut record);
    if let Loading::Spring(stiffness) = master.loading() {
        let aside = &mut Aside { fraction: fractions[0] + fractions[1], monitor };
        record_equilibria((&run, &master), (fresh.as_ref(), loading), stiffness, &mut record, aside)?;
    }
    let mut sliding = Sliding::new(&run);
    if let Some(ensemble) = ensemble {
        let done = fractions[0] + fractions[1];
        let mut part = Part::new(monitor, done, 1.0 - done);
        let mut contacts = ensemble.population_with(&mut Aside { fraction: 0.0, monitor: &mut part })?;
        let slider = task.slider(block, true)?.with_background(model.background)?;
        let protocol = task.build(slider.start(&mut contacts)?);
        let run = slider.pull_with(&mut contacts, &protocol, &mut part)?;
        adopt(sliding::motion(&run), "ensemble_", &mut record);
        adopt(sliding::sizes(&run, ensemble.size()), "", &mut record);
        sliding.ensemble = Some(Box::new(Sliding::new(&run)));
    }
    model.add_coefficient("force", &mut record);
    let relaxation = equation.relaxation_with(&mut Part::new(monitor, 1.0, 0.0))?;
    let steady = equation.steady_state();
    let friction = friction(model, &steady, &relaxation, &pull);
    let output = Output::new(model, DriveNumbers { friction, sliding: Some(sliding) }, record);
    let mut accuracy = ForceAccuracy::of_pull(model, task.start, &pull, &steady);
    accuracy.error = accuracy.error.max(error);
    accuracy.of(model, "the force on a slider that is driven", output)
}

/// Drives the slider over time-dependent contacts. Friction is that of a pull at the velocity of the drive.
fn at_a_velocity(
    model: &Model,
    protocol: &scenario::Protocol,
    monitor: &mut dyn Monitor,
) -> Result<Output<DriveNumbers>> {
    const PULL: f64 = 0.1;
    let Model { contacts, initial, .. } = model;
    in_time::check_size((protocol, 0), model, monitor)?;
    let velocity = protocol.0[0].velocities().0;
    let equation = MasterEquation::at_with(
        contacts.clone(),
        initial,
        velocity,
        &mut Part::new(monitor, 0.0, 0.5 * PULL),
    )?;
    let tolerance = model.master_equation.tolerance();
    let part = &mut Part::new(monitor, 0.5 * PULL, 0.5 * PULL);
    let pull = equation.pull_with(first_loading_distance(contacts), tolerance, part)?;
    let part = &mut Part::new(monitor, PULL, 1.0 - PULL);
    let (sliding, record, in_time) = match &model.block {
        Some(block) => in_time::behind(model, protocol, block, part)
            .map(|(sliding, record, accuracy)| (Some(sliding), record, accuracy))?,
        None => {
            let (_, trace, record) = in_time::rigid(model, (protocol, &[]), part)?;
            (None, record, Some(ForceAccuracy::in_time(model, trace.error)))
        }
    };
    let relaxation = equation.relaxation_with(&mut Part::new(monitor, 1.0, 0.0))?;
    let steady = equation.steady_state();
    let friction = friction(model, &steady, &relaxation, &pull);
    let output = Output::new(model, DriveNumbers { friction, sliding }, record);
    let accuracy = ForceAccuracy::new(model, pull.error_estimate(), steady.mean_life());
    let accuracy = in_time.into_iter().fold(accuracy, ForceAccuracy::worse);
    accuracy.of(model, "the force on a slider that is driven", output)
}

/// Length of the first loading of a slider: five mean thresholds.
pub fn first_loading_distance(contacts: &Contacts) -> f64 {
    LOADING * contacts.thresholds.mean()
}

/// Refuses, before any work, results that do not fit in memory.
fn check_size(task: &scenario::Drive, ensemble: bool, monitor: &dyn Monitor) -> Result<()> {
    let traces = if ensemble { 2 } else { 1 };
    let what = || format!("a trace of {} points", task.points);
    fits("drive.points", task.points * WIDTH * traces, what, monitor)
}

/// Records the equilibria of the slider on the first loading, and its potential around the first slip.
fn record_equilibria(
    (run, block): (&StickSlip, &Block),
    (fresh, reach): (&dyn Population, f64),
    stiffness: f64,
    record: &mut Record,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    let curve = Curve::new(fresh, reach, FINE, monitor)?.with_background(block.background());
    let stable = curve.stable(stiffness).into_iter().map(f64::from).collect();
    let drive = curve.drive(stiffness);
    record.add(BRANCH_POSITION, curve.position.clone());
    record.add(BRANCH_DRIVE, drive);
    record.add(BRANCH_FORCE, curve.force.clone());
    record.add(BRANCH_STABLE, stable);
    if let Some(first) = run.events.first() {
        let drives = POTENTIALS.map(|part| part * first.before.drive);
        let heights = drives.iter().flat_map(|&drive| curve.potential(stiffness, drive)).collect();
        record.add(POTENTIAL_DRIVE, drives.to_vec());
        record.add(POTENTIAL, heights);
    }
    Ok(())
}
