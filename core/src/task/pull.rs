//! `[pull]`: force, breaking rate and distributions as the base of the slider is moved.

use super::accuracy::ForceAccuracy;
use super::background::coefficient;
use super::grid::Grid;
use super::summary::{Extended, FrictionDerivative, PullNumbers};
use super::{COMPARED, Output, add_atoms, compare, distribution, ensemble, fits, friction};
use crate::law::Parameter;
use crate::master::{FrictionGradient, MasterEquation, Pull};
use crate::monitor::{Monitor, Part, report};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, Model};
use crate::{Error, Result};

/// Positions evaluated between two reports to the monitor.
const ROUND: usize = 1024;

/// Fraction of the work for the lives of time-dependent contacts.
const LIVES: f64 = 0.5;

const POSITION: Column =
    Column::new("position", "position X of the slider's base", Quantity::Length, &["position"]);
const FORCE: Column = Column::new("force", "friction force", Quantity::Force, &["position"]);
const BREAKING_RATE: Column = Column::new(
    "breaking_rate",
    "fraction of contacts breaking per length, without simultaneous breaks",
    Quantity::PerLength,
    &["position"],
);
const FORCE_STD: Column = Column::new(
    "force_std",
    "standard deviation of the force of a finite number of contacts",
    Quantity::Force,
    &["position"],
);
const BREAKING_ATOM: Column = Column::new(
    "breaking_atom_position",
    "position at which contacts break simultaneously",
    Quantity::Length,
    &["breaking_atom"],
);
const BREAKING_ATOM_WEIGHT: Column =
    Column::new("breaking_atom_weight", "fraction of contacts", Quantity::Number, &["breaking_atom"]);

const COVARIANCE_POSITION: Column =
    Column::new("covariance_position", "position X₁", Quantity::Length, &["covariance_position"]);
const COVARIANCE_OTHER: Column =
    Column::new("covariance_other", "position X₂", Quantity::Length, &["covariance_other"]);
const COVARIANCE: Column = Column::new(
    "covariance",
    "covariance of the force of a finite number of contacts at X₁ and X₂",
    Quantity::ForceSquared,
    &["covariance_position", "covariance_other"],
);

/// The covariance of the force.
const COVARIANCES: [Column; 3] = [COVARIANCE_POSITION, COVARIANCE_OTHER, COVARIANCE];

const FRICTION_COEFFICIENT: Column = coefficient(&["position"]);

/// The variables along the pull.
const COLUMNS: [Column; 7] =
    [POSITION, FORCE, FRICTION_COEFFICIENT, BREAKING_RATE, FORCE_STD, BREAKING_ATOM, BREAKING_ATOM_WEIGHT];

/// Forces of contacts, to which the background force is added.
const FORCES: [Column; 2] = [FORCE, ensemble::COLUMNS[0]];

/// Its table in CSV.
pub(super) const TABLES: &[CsvTable] = &[
    CsvTable {
        file: "force.csv",
        columns: &[
            POSITION,
            FORCE,
            BREAKING_RATE,
            ensemble::COLUMNS[0],
            ensemble::COLUMNS[1],
            FRICTION_COEFFICIENT,
        ],
        needed: BREAKING_RATE,
    },
    CsvTable { file: "covariance.csv", columns: &COVARIANCES, needed: COVARIANCE },
];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    let lists: [&[Column]; 5] =
        [&COLUMNS, &COVARIANCES, &COMPARED, &distribution::COLUMNS, &ensemble::COLUMNS];
    vec![("pull", Record::declared(&lists))]
}

/// Pulls the slider as `task` says.
///
/// # Errors
/// Results too large for the memory, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &scenario::Pull,
    monitor: &mut dyn Monitor,
) -> Result<Output<PullNumbers>> {
    let Model { contacts, initial, .. } = model;
    check_size(model, task, None, monitor)?;
    let solved = if contacts.rules.are_time_dependent() { LIVES } else { 0.0 };
    let part = &mut Part::new(monitor, 0.0, solved);
    let equation = match task.velocity {
        Some(velocity) => MasterEquation::at_with(contacts.clone(), initial, velocity, part)?,
        None => MasterEquation::new_with(contacts.clone(), initial, part)?,
    };
    let monitor = &mut Part::new(monitor, solved, 1.0 - solved);
    let grid = Grid::new(&equation, initial, &task.snapshots);
    check_size(model, task, Some(&grid), monitor)?;
    let master = if model.ensemble.is_some() { 0.5 } else { 1.0 };
    let tolerance = model.master_equation.tolerance();
    let pull = equation.pull_with(task.distance, tolerance, &mut Part::new(monitor, 0.0, 0.6 * master))?;
    let mut record = Record::default();
    let part = &mut Part::new(monitor, 0.6 * master, 0.4 * master);
    record_pull(&pull, task.positions(), model.sample(), &mut record, part)?;
    let aside = &mut Part::new(monitor, master, 0.0);
    record_covariance(&pull, task, model, &mut record, aside)?;
    let force = |x| pull.force(x) + model.background;
    let compare =
        model.compare.as_ref().map(|curve| compare(curve, (0.0, pull.distance()), force, &mut record));
    distribution::evolving(task, &pull, &grid, &mut record, aside)?;
    let (steady, relaxation) = (equation.steady_state(), equation.relaxation_with(aside)?);
    distribution::steady(contacts, &steady, &grid, &mut record, aside)?;
    let derivatives = if task.derivatives { derivatives(&pull, aside)? } else { Vec::new() };
    if let Some(drawn) = &model.ensemble {
        let drawn = drawn.build(contacts.clone(), initial.clone())?;
        let pulled = ensemble::PulledEnsemble {
            task,
            grid: &grid,
            mean: contacts.thresholds.mean(),
            memory: relaxation.length(),
        };
        pulled.record(&drawn, &mut record, &mut Part::new(monitor, master, 1.0 - master))?;
    }
    model.add_background(&FORCES, &mut record);
    model.add_coefficient(FORCE.name, &mut record);
    let friction = friction(model, &steady, &relaxation, &pull);
    let numbers = PullNumbers { friction, derivatives, compare };
    let accuracy = ForceAccuracy::of_pull(model, task.start, &pull, &steady);
    accuracy.of(model, "the force on a pull", Output::new(model, numbers, record))
}

/// Refuses, before any work, results that do not fit in memory. The grid is known once there is an equation.
fn check_size(
    model: &Model,
    pull: &scenario::Pull,
    grid: Option<&Grid>,
    monitor: &dyn Monitor,
) -> Result<()> {
    let densities = (pull.snapshots.len() + 3) * grid.map_or(0, |grid| grid.stretches.len());
    let bins = grid.zip(model.ensemble.as_ref()).map_or(0, |(grid, ensemble)| grid.bins(ensemble.size()));
    let covariances = pull.covariance.len().pow(2) + 2 * pull.covariance.len();
    let histograms = (pull.snapshots.len() + 1) * bins;
    let what = || format!("a pull of {} points and {} snapshots", pull.points, pull.snapshots.len());
    fits("pull.points", pull.points * COLUMNS.len() + densities + histograms + covariances, what, monitor)
}

/// Adds force and breaking rate at `positions` to `record`, the standard deviation of the force of `sample` contacts, and
/// the positions of simultaneous breaks.
///
/// # Errors
/// A stop by the monitor.
pub fn record_pull(
    pull: &Pull,
    positions: Vec<f64>,
    sample: Option<f64>,
    record: &mut Record,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    let aside = &mut Part::new(monitor, 0.0, 0.0);
    let std = sample.map(|size| pull.force_std_with(size, aside)).transpose()?;
    let mut evaluate = |done: f64, function: &dyn Fn(f64) -> f64| -> Result<Vec<f64>> {
        let mut values = Vec::with_capacity(positions.len());
        for round in positions.chunks(ROUND) {
            values.extend(round.iter().map(|&x| function(x)));
            report(monitor, (done + values.len() as f64 / positions.len() as f64) / 3.0)?;
        }
        Ok(values)
    };
    let force = evaluate(0.0, &|x| pull.force(x))?;
    let rate = evaluate(1.0, &|x| pull.breaking_rate(x))?;
    let std = std.map(|std| evaluate(2.0, &std)).transpose()?;
    record.add(POSITION, positions);
    record.add(FORCE, force);
    record.add(BREAKING_RATE, rate);
    if let Some(std) = std {
        record.add(FORCE_STD, std);
    }
    let masses = pull.breaking_atoms().iter().map(|a| ([a.position], a.weight));
    add_atoms(record, ([BREAKING_ATOM], BREAKING_ATOM_WEIGHT), masses);
    Ok(())
}

/// The derivatives of friction by all parameters of the contacts.
///
/// # Errors
/// Contacts without such derivatives; a stop by the monitor.
fn derivatives(pull: &Pull, monitor: &mut dyn Monitor) -> Result<Vec<FrictionDerivative>> {
    if cfg!(not(feature = "fits")) {
        let expected = "false, or a program with fits, such as the command asperity";
        return Err(Error::invalid("pull.derivatives", expected, true));
    }
    let parameters = pull.parameters();
    let names: Vec<&str> = parameters.iter().map(|parameter| parameter.name.as_ref()).collect();
    let found = pull.friction_gradients_with(&names, monitor)?;
    let of = |(parameter, gradient): (&Parameter, FrictionGradient)| FrictionDerivative {
        parameter: parameter.name.to_string(),
        value: parameter.value,
        static_friction: gradient.static_friction,
        kinetic_friction: gradient.kinetic_friction,
        relaxation_length: Extended(gradient.relaxation_length),
        critical_stiffness: Extended(gradient.critical_stiffness),
    };
    Ok(parameters.iter().zip(found).map(of).collect())
}

/// Adds the covariance of the force at the positions that `task` lists, for the contacts of the finite-size band.
fn record_covariance(
    pull: &Pull,
    task: &scenario::Pull,
    model: &Model,
    record: &mut Record,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    if task.covariance.is_empty() {
        return Ok(());
    }
    let size = model.sample().unwrap_or(model.contacts.count);
    let covariance = pull.covariance_with(&task.covariance, size, monitor)?;
    record.add(COVARIANCE_POSITION, task.covariance.clone());
    record.add(COVARIANCE_OTHER, task.covariance.clone());
    record.add(COVARIANCE, covariance.values().to_vec());
    Ok(())
}
