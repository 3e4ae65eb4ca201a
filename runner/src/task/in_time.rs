//! A slider moved in time: rigid, or behind its block.

use asperity::block::{Block, Slide};
use asperity::contacts::{Contacts, Rules, Stiffness};
use asperity::history::History;
use asperity::master::{Trace, Transport};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::{Error, Result, scenario};

use super::accuracy::{Accuracy, as_required};
use super::part::Part;
use super::{Setting, chance, sliding};
use crate::output::LARGEST;
use crate::summary::Sliding;

/// Columns of a trace, at most.
const COLUMNS: usize = 11;
/// Share of the work that the master equation is, beside an ensemble.
const MASTER: f64 = 0.5;
/// What a step of a block may be off over N contacts, in units of the mean threshold × N^{−2/3}, by which drives at slips
/// scatter: less would follow single contacts.
const FINITE: f64 = 0.1;

/// Refuses before any work what could not be written after it.
///
/// # Errors
/// A trace too large for one file.
pub fn fits(protocol: &scenario::Protocol, setting: &Setting<'_>) -> Result<()> {
    let traces = if setting.scenario.ensemble.is_some() { 2 } else { 1 };
    let needed = (protocol.points() * COLUMNS * traces * size_of::<f64>()) as u64;
    if needed <= LARGEST {
        return Ok(());
    }
    let what = format!("a result file of a trace of {} points", protocol.points());
    Err(Error::TooLarge { key: "protocol".into(), what, needed, allowed: LARGEST })
}

/// Moves a rigid slider: its trace, and that as variables, with the force of the ensemble beside.
///
/// # Errors
/// What the solvers run into, or the monitor's wish to stop.
pub fn rigid(
    setting: &Setting<'_>,
    protocol: &scenario::Protocol,
    monitor: &mut dyn Monitor,
) -> Result<(Trace, Record)> {
    let Setting { scenario, contacts, initial } = setting;
    let (history, times) = (protocol.build()?, protocol.times());
    let master = if scenario.ensemble.is_some() { MASTER } else { 1.0 };
    let tolerance = scenario.master_equation.tolerance_in_time(&contacts.rules);
    let aside = &mut Part::new(monitor, 0.0, 0.0);
    let mut transport = Transport::new(contacts.clone(), initial, tolerance, aside)?;
    let trace = transport.follow(&history, &times, &mut Part::new(monitor, 0.0, master))?;
    trace.check(transport.unit(), scenario.master_equation.tolerance)?;
    let mut record = traced(&trace, contacts.rules.delay > 0.0);
    if let Some(ensemble) = &scenario.ensemble {
        let model = ensemble.build(contacts.clone(), initial.clone())?;
        let run = model.follow(&history, &times, &mut Part::new(monitor, master, 1.0 - master))?;
        chance::force(&mut record, "friction force of the ensemble", "point", run.force, run.error);
    }
    Ok((trace, record))
}

/// The trace; of a rigid slider the drive is its position.
fn traced(trace: &Trace, free: bool) -> Record {
    let mut record = Record::default();
    let mut add = |name, words, quantity, values: &[f64]| {
        record.push(name, words, quantity, &["point"], values.to_vec())
    };
    add("time", "time", Quantity::Time, &trace.time);
    add("drive", "drive", Quantity::Length, &trace.position);
    add("position", "position of the slider's base", Quantity::Length, &trace.position);
    add("velocity", "velocity of the slider", Quantity::Velocity, &trace.velocity);
    add("force", "friction force", Quantity::Force, &trace.force);
    add("spring_force", "force that pulls the slider", Quantity::Force, &trace.force);
    add(
        "breaking_frequency",
        "fraction of contacts breaking per time",
        Quantity::PerTime,
        &trace.breaking_rate,
    );
    if free {
        add("free", "fraction of contacts that are detached", Quantity::Number, &trace.free);
    }
    record
}

/// Moves the top of a block, and its bottom follows: over the master equation, with its accuracy where that is required, and over
/// the ensemble.
///
/// # Errors
/// What the solvers run into, or the monitor's wish to stop.
pub fn behind(
    setting: &Setting<'_>,
    protocol: &scenario::Protocol,
    block: &scenario::Block,
    monitor: &mut dyn Monitor,
) -> Result<(Sliding, Record, Option<Accuracy>)> {
    let Setting { scenario, contacts, initial } = setting;
    let (history, times) = (protocol.build()?, protocol.times());
    let tolerance = scenario.master_equation.tolerance_of_a_block();
    let mean = contacts.thresholds.mean();
    let master = if scenario.ensemble.is_some() { MASTER } else { 1.0 };
    let part = &mut Part::new(monitor, 0.0, master);
    let (run, accuracy) = moved(setting, &block.in_time(false)?, (&history, &times), part)?;
    let mut record = Record::default();
    sliding::adopt(known(sliding::motion_in_time(&run), contacts), "", &mut record);
    let mut told = Sliding::in_time(&run);
    if let Some(ensemble) = &scenario.ensemble {
        let aside = &mut Part::new(monitor, master, 0.0);
        let model = ensemble.build(contacts.clone(), initial.clone())?.in_time(aside)?;
        let length = mean * tolerance_over(ensemble.size()).max(tolerance);
        let part = &mut Part::new(monitor, master, 1.0 - master);
        let run = block.in_time(true)?.follow(&model, &history, &times, length, part)?;
        sliding::adopt(known(sliding::motion_in_time(&run), contacts), "ensemble_", &mut record);
        told.ensemble = Some(Box::new(Sliding::in_time(&run)));
    }
    Ok((told, record, accuracy))
}

/// The motion of a block over the master equation. What its accuracy takes is for those who require one.
fn moved(
    setting: &Setting<'_>,
    block: &Block,
    (drive, times): (&History, &[f64]),
    monitor: &mut dyn Monitor,
) -> Result<(Slide, Option<Accuracy>)> {
    let Setting { scenario, contacts, initial } = setting;
    let (tolerance, mean) = (scenario.master_equation.tolerance_of_a_block(), contacts.thresholds.mean());
    let transport = |tolerance: f64, part: &mut Part<'_>| {
        Transport::new(contacts.clone(), initial, tolerance, &mut Part::new(part, 0.0, 0.0))
    };
    if scenario.master_equation.tolerance.is_none() {
        let part = &mut Part::new(monitor, 0.0, 1.0);
        let contacts = transport(tolerance, part)?;
        return Ok((block.follow(&contacts, drive, times, tolerance * mean, part)?, None));
    }
    let (run, accuracy) = as_required(setting, tolerance, monitor, |tolerance, part| {
        let contacts = transport(tolerance, part)?;
        let run = block.follow_with_error(&contacts, drive, times, tolerance * mean, part)?;
        let accuracy = Accuracy::in_time(setting, run.error.unwrap_or(0.0));
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
