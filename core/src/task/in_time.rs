//! A slider moved in time: rigid, or behind its block.

use super::accuracy::{ForceAccuracy, as_required};
use super::summary::Sliding;
use super::{ensemble, fits, sliding};
use crate::Result;
use crate::block::{Block, Slide};
use crate::contacts::{Contacts, Rules, Stiffness};
use crate::history::History;
use crate::master::{Trace, Transport};
use crate::monitor::{Monitor, Part};
use crate::record::{Column, Quantity, Record};
use crate::scenario::{self, Model};

/// Columns of a trace, at most.
const WIDTH: usize = 11;
/// Share of the work that the master equation is, beside an ensemble.
const MASTER: f64 = 0.5;
/// What a step of a block may be off over N contacts, in units of the mean threshold × N^{−2/3}, by which drives at slips
/// scatter: less would follow single contacts.
const FINITE: f64 = 0.1;

const TIME: Column = of("time", "time", Quantity::Time);
const DRIVE: Column = of("drive", "drive", Quantity::Length);
const POSITION: Column = of("position", "position of the slider's base", Quantity::Length);
const VELOCITY: Column = of("velocity", "velocity of the slider", Quantity::Velocity);
const FORCE: Column = of("force", "friction force", Quantity::Force);
const SPRING_FORCE: Column = of("spring_force", "force that pulls the slider", Quantity::Force);
const BREAKING_FREQUENCY: Column =
    of("breaking_frequency", "fraction of contacts breaking per time", Quantity::PerTime);
const FREE: Column = of("free", "fraction of contacts that are detached", Quantity::Number);
const ENSEMBLE: [Column; 2] = ensemble::force_columns("friction force of the ensemble", &["point"]);

/// The variables of a rigid slider.
pub(super) const COLUMNS: [Column; 10] = [
    TIME,
    DRIVE,
    POSITION,
    VELOCITY,
    FORCE,
    SPRING_FORCE,
    BREAKING_FREQUENCY,
    FREE,
    ENSEMBLE[0],
    ENSEMBLE[1],
];

const fn of(name: &'static str, long_name: &'static str, quantity: Quantity) -> Column {
    Column::new(name, long_name, quantity, &["point"])
}

/// Refuses before any work a trace that could not be written after it.
///
/// # Errors
/// A trace too large for one file.
pub(super) fn check_size(protocol: &scenario::Protocol, model: &Model) -> Result<()> {
    let traces = if model.ensemble.is_some() { 2 } else { 1 };
    let points = protocol.points();
    fits("protocol", points * WIDTH * traces, || format!("a result file of a trace of {points} points"))
}

/// Moves a rigid slider: its trace, and that as variables, with the force of the ensemble beside.
///
/// # Errors
/// What the solvers run into, or the monitor's wish to stop.
pub(super) fn rigid(
    model: &Model,
    protocol: &scenario::Protocol,
    monitor: &mut dyn Monitor,
) -> Result<(Trace, Record)> {
    let Model { contacts, initial, .. } = model;
    let (history, times) = (protocol.build()?, protocol.times());
    let master = if model.ensemble.is_some() { MASTER } else { 1.0 };
    let tolerance = model.master_equation.tolerance_in_time(&contacts.rules);
    let aside = &mut Part::new(monitor, 0.0, 0.0);
    let mut transport = Transport::new_with(contacts.clone(), initial, tolerance, aside)?;
    let trace = transport.follow_with(&history, &times, &mut Part::new(monitor, 0.0, master))?;
    trace.check(transport.unit(), model.master_equation.tolerance)?;
    let mut record = traced(&trace, contacts.rules.delay > 0.0);
    if let Some(drawn) = &model.ensemble {
        let drawn = drawn.build(contacts.clone(), initial.clone())?;
        let run = drawn.follow_with(&history, &times, &mut Part::new(monitor, master, 1.0 - master))?;
        ensemble::add_force(&mut record, ENSEMBLE, run.force, run.error);
    }
    Ok((trace, record))
}

/// The trace; of a rigid slider the drive is its position.
fn traced(trace: &Trace, free: bool) -> Record {
    let mut record = Record::default();
    for (column, values) in [
        (TIME, &trace.time),
        (DRIVE, &trace.position),
        (POSITION, &trace.position),
        (VELOCITY, &trace.velocity),
        (FORCE, &trace.force),
        (SPRING_FORCE, &trace.force),
        (BREAKING_FREQUENCY, &trace.breaking_rate),
    ] {
        record.add(column, values.clone());
    }
    if free {
        record.add(FREE, trace.free.clone());
    }
    record
}

/// Moves the top of a block, and its bottom follows: over the master equation, with its accuracy where that is required, and over
/// the ensemble.
///
/// # Errors
/// What the solvers run into, or the monitor's wish to stop.
pub(super) fn behind(
    model: &Model,
    protocol: &scenario::Protocol,
    block: &scenario::Block,
    monitor: &mut dyn Monitor,
) -> Result<(Sliding, Record, Option<ForceAccuracy>)> {
    let Model { contacts, initial, .. } = model;
    let (history, times) = (protocol.build()?, protocol.times());
    let tolerance = model.master_equation.tolerance_of_a_block();
    let mean = contacts.thresholds.mean();
    let master = if model.ensemble.is_some() { MASTER } else { 1.0 };
    let part = &mut Part::new(monitor, 0.0, master);
    let (run, accuracy) = moved(model, &block.in_time(false)?, (&history, &times), part)?;
    let mut record = Record::default();
    sliding::adopt(known(sliding::motion_in_time(&run), contacts), "", &mut record);
    let mut summary = Sliding::in_time(&run);
    if let Some(drawn) = &model.ensemble {
        let aside = &mut Part::new(monitor, master, 0.0);
        let followed = drawn.build(contacts.clone(), initial.clone())?.in_time_with(aside)?;
        let length = mean * tolerance_over(drawn.size()).max(tolerance);
        let part = &mut Part::new(monitor, master, 1.0 - master);
        let run = block.in_time(true)?.follow_with(&followed, &history, &times, length, part)?;
        sliding::adopt(known(sliding::motion_in_time(&run), contacts), "ensemble_", &mut record);
        summary.ensemble = Some(Box::new(Sliding::in_time(&run)));
    }
    Ok((summary, record, accuracy))
}

/// The motion of a block over the master equation. What its accuracy takes is for those who require one.
fn moved(
    model: &Model,
    block: &Block,
    (drive, times): (&History, &[f64]),
    monitor: &mut dyn Monitor,
) -> Result<(Slide, Option<ForceAccuracy>)> {
    let Model { contacts, initial, .. } = model;
    let (tolerance, mean) = (model.master_equation.tolerance_of_a_block(), contacts.thresholds.mean());
    let transport = |tolerance: f64, part: &mut Part<'_>| {
        Transport::new_with(contacts.clone(), initial, tolerance, &mut Part::new(part, 0.0, 0.0))
    };
    if model.master_equation.tolerance.is_none() {
        let part = &mut Part::new(monitor, 0.0, 1.0);
        let contacts = transport(tolerance, part)?;
        return Ok((block.follow_with(&contacts, drive, times, tolerance * mean, part)?, None));
    }
    let (run, accuracy) = as_required(model, tolerance, monitor, |tolerance, part| {
        let contacts = transport(tolerance, part)?;
        let run = block.follow_with_error(&contacts, drive, times, tolerance * mean, part)?;
        let accuracy = ForceAccuracy::in_time(model, run.error.unwrap_or(0.0));
        Ok((run, accuracy))
    })?;
    Ok((run, Some(accuracy)))
}

/// What a step of a block may be off over so many contacts followed one by one, per mean threshold.
pub fn tolerance_over(size: usize) -> f64 {
    FINITE * (size as f64).powf(-2.0 / 3.0)
}

/// A motion without what these contacts do not know.
fn known(mut motion: Record, contacts: &Contacts) -> Record {
    let Rules { ref ageing, delay, .. } = contacts.rules;
    let stiffens = ageing.is_some() && matches!(contacts.stiffness, Stiffness::PerThreshold(_));
    let unused = |name: &str| match name {
        "free" => delay == 0.0,
        "event_strengthening" => !stiffens,
        _ => false,
    };
    motion.variables.retain(|variable| !unused(&variable.name));
    motion
}
