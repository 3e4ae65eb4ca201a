//! A slider moved in time, rigid or driven through a block.

use super::accuracy::{ForceAccuracy, as_required};
use super::background::coefficient;
use super::settling::Steady;
use super::summary::Sliding;
use super::{ensemble, fits, sliding};
use crate::Result;
use crate::block::{Block, Slide};
use crate::contacts::{Contacts, Rules, Stiffness};
use crate::history::{LoadedHistory, Piece};
use crate::master::{Tolerance, Trace, Transport};
use crate::monitor::{Aside, Monitor, Part, Preparation};
use crate::record::{Column, Quantity, Record};
use crate::scenario::{self, Model};

/// Largest number of columns of a trace.
const WIDTH: usize = 12;
/// Fraction of the work for the master equation if there is an ensemble.
const MASTER: f64 = 0.5;
/// Largest error of a step of a block over N contacts, in units of the mean threshold × N^{−2/3}, which is the scatter of
/// the drive at slips. A smaller tolerance would resolve the breaks of single contacts.
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
const LOAD: Column =
    of("relative_normal_load", "normal load relative to that at the start", Quantity::Number);
const ENSEMBLE: [Column; 2] = ensemble::force_columns("friction force of the ensemble", &["point"]);

/// The variables of a rigid slider.
pub(super) const COLUMNS: [Column; 12] = [
    TIME,
    DRIVE,
    POSITION,
    VELOCITY,
    FORCE,
    SPRING_FORCE,
    BREAKING_FREQUENCY,
    FREE,
    LOAD,
    ENSEMBLE[0],
    ENSEMBLE[1],
    FRICTION_COEFFICIENT,
];

/// The friction coefficient of a trace.
pub(super) const FRICTION_COEFFICIENT: Column = coefficient(&["point"]);

/// Forces of contacts, to which the background force is added.
const FORCES: [Column; 3] = [FORCE, SPRING_FORCE, ENSEMBLE[0]];

const fn of(name: &'static str, long_name: &'static str, quantity: Quantity) -> Column {
    Column::new(name, long_name, quantity, &["point"])
}

/// Refuses, before any work, a trace that does not fit in memory, with the number of points `between` those of the protocol.
///
/// # Errors
/// A trace too large for the memory.
pub(super) fn check_size(
    (protocol, between): (&scenario::Protocol, usize),
    model: &Model,
    monitor: &dyn Monitor,
) -> Result<()> {
    let traces = if model.ensemble.is_some() { 2 } else { 1 };
    let points = protocol.points().saturating_add(between);
    fits("protocol", points * WIDTH * traces, || format!("a trace of {points} points"), monitor)
}

/// Moves a rigid slider. Returns the protocol in the pieces that were followed, its trace with readings at the times `between`, too,
/// and the variables of the trace without these and of the force of the ensemble.
///
/// # Errors
/// Errors of the solvers, a stop by the monitor.
pub(super) fn rigid(
    model: &Model,
    motion: (&scenario::Protocol, &[f64]),
    monitor: &mut dyn Monitor,
) -> Result<(scenario::Protocol, Trace, Record)> {
    let Model { contacts, initial, .. } = model;
    let master = if model.ensemble.is_some() { MASTER } else { 1.0 };
    let (protocol, mut trace) = followed(model, motion, &mut Part::new(monitor, 0.0, master))?;
    let times = protocol.times();
    let shown = trace.at(&times);
    let mut record = trace_record(&shown, !contacts.rules.delay.is_none());
    if protocol.has_load_steps() {
        record.add(LOAD, shown.relative_normal_load.clone());
    }
    if let Some(drawn) = &model.ensemble {
        let drawn = drawn.build(contacts.clone(), initial.clone())?;
        let aside = &mut Aside { fraction: master, monitor };
        let (motion, times) = settled(model, (&protocol.build_under_load()?, &times), aside)?;
        let part = &mut Part::new(monitor, master, 1.0 - master);
        let run = if protocol.has_load_steps() {
            drawn.follow_under_load(&motion, &times, part)?
        } else {
            drawn.follow_with(motion.history(), &times, part)?
        };
        ensemble::add_force(&mut record, ENSEMBLE, run.force, run.error);
    }
    // A rigid slider that is held keeps the background force: nothing relaxes it.
    let loads = trace.relative_normal_load.iter();
    trace.force.iter_mut().zip(loads).for_each(|(force, load)| *force += model.background_at(*load));
    model.add_background_under(&FORCES, &shown.relative_normal_load, &mut record);
    model.add_coefficient_under(FORCE.name, &shown.relative_normal_load, &mut record);
    Ok((protocol, trace, record))
}

/// Follows a rigid slider with readings at the times of the protocol and `between` them. Returns the protocol in the pieces that were
/// followed.
///
/// # Errors
/// Errors of the solver; an accuracy that is not reached; stopped by the monitor.
fn followed(
    model: &Model,
    (protocol, between): (&scenario::Protocol, &[f64]),
    monitor: &mut dyn Monitor,
) -> Result<(scenario::Protocol, Trace)> {
    let required = model.master_equation.tolerance;
    let accuracy = (model.master_equation.tolerance_in_time(&model.contacts.rules), required);
    let follow = |protocol: &scenario::Protocol, part: &mut dyn Monitor| {
        let times = merged(protocol.times(), between);
        let trace = if protocol.has_load_steps() {
            let build = |tolerance: f64, part: &mut dyn Monitor| {
                let start = transport(model, tolerance, &mut Part::new(part, 0.0, 0.5))?;
                let fresh = Transport::fresh(&model.contacts, tolerance, &mut Part::new(part, 0.5, 0.5))?;
                Ok([start, fresh])
            };
            let motion = protocol.build_under_load()?;
            Transport::follow_under_load_as_required(build, (&motion, &times), accuracy, part)?
        } else {
            let mut build = |tolerance: f64, part: &mut dyn Monitor| transport(model, tolerance, part);
            Transport::follow_as_required(&mut build, (&protocol.build()?, &times), accuracy, part)?
        };
        let error = trace.error;
        Ok((trace, error))
    };
    let (protocol, trace, error) = over_ramps((model, protocol), monitor, follow, |trace| &trace.force)?;
    Ok((protocol, Trace { error, ..trace }))
}

/// The times and those `between` that are none of them, in increasing order.
fn merged(mut times: Vec<f64>, between: &[f64]) -> Vec<f64> {
    let new = |time: &&f64| times.binary_search_by(|known| known.total_cmp(time)).is_err();
    let new: Vec<f64> = between.iter().filter(new).copied().collect();
    times.extend(new);
    times.sort_by(f64::total_cmp);
    times
}

/// Follows a protocol with an estimate of what the pieces of ramps change. It is of second order in their number: the difference
/// from the motion in half as many, some three times that, is part of the error. Where more accuracy is required than the default
/// number gives, it is doubled. `follow` returns a motion with the error of its forces, and `forces` those at the points of the trace.
/// Returns the protocol in the pieces that were followed, the motion and the error.
///
/// # Errors
/// Those of `follow`; an accuracy that is not reached.
fn over_ramps<T>(
    (model, protocol): (&Model, &scenario::Protocol),
    monitor: &mut dyn Monitor,
    mut follow: impl FnMut(&scenario::Protocol, &mut dyn Monitor) -> Result<(T, f64)>,
    forces: impl Fn(&T) -> &[f64],
) -> Result<(scenario::Protocol, T, f64)> {
    /// Doublings of the default number of pieces: the cost of many pieces rises with its square.
    const DOUBLINGS: u32 = 4;
    let Some(coarse) = protocol.with_pieces(|count| count.div_ceil(2)) else {
        let (motion, error) = follow(protocol, monitor)?;
        return Ok((protocol.clone(), motion, error));
    };
    let (mut rough, _) = follow(&coarse, &mut Part::new(monitor, 0.0, 0.3))?;
    let (mut protocol, mut left) = (protocol.clone(), 0.7);
    let required = model.master_equation.tolerance;
    let mut doublings = if required.is_some() && protocol.has_default_pieces() { DOUBLINGS } else { 0 };
    let unit = model.stiffness() * model.contacts.thresholds.mean();
    loop {
        let share = if doublings == 0 { left } else { 0.5 * left };
        let (fine, own) = follow(&protocol, &mut Part::new(monitor, 1.0 - left, share))?;
        left -= share;
        let differences = forces(&fine).iter().zip(forces(&rough)).map(|(fine, rough)| (fine - rough).abs());
        let error = own + differences.fold(0.0, f64::max);
        if doublings == 0 || required.is_some_and(|required| error / unit <= required) {
            let what = || "the force along ramps in pieces of constant velocity".to_owned();
            required.map_or(Ok(()), |required| Tolerance::from(required).allows(error / unit, what))?;
            return Ok((protocol, fine, error));
        }
        doublings -= 1;
        protocol = protocol.with_pieces(|count| 2 * count).unwrap_or(protocol);
        rough = fine;
    }
}

/// The contacts at the start, solved by transport.
///
/// # Errors
/// Those of [`Transport::new_with`]; stopped by the monitor.
fn transport(model: &Model, tolerance: f64, monitor: &mut dyn Monitor) -> Result<Transport> {
    let Model { contacts, initial, .. } = model;
    match model.steady {
        Some(velocity) => Transport::steady_with(contacts, velocity, tolerance, monitor),
        None => Transport::new_with(contacts.clone(), initial, tolerance, monitor),
    }
}

/// The motion and the times of single contacts. Those that are to start in steady sliding slide until they have forgotten
/// their initial state first; time-independent ones start with the stretches of steady sliding.
fn settled(
    model: &Model,
    (motion, times): (&LoadedHistory, &[f64]),
    monitor: &mut dyn Monitor,
) -> Result<(LoadedHistory, Vec<f64>)> {
    let contacts = &model.contacts;
    let Some(velocity) = model.steady.filter(|_| contacts.rules.are_time_dependent()) else {
        return Ok((motion.clone(), times.to_vec()));
    };
    let steady = Steady::at(contacts, velocity, monitor)?;
    let duration = steady.distance / velocity;
    let whole = motion.after(Piece { velocity, duration })?;
    let later = |&time: &f64| match motion.steps().next() {
        // Times at which the load steps remain such times.
        Some(_) => motion.history().time_in(whole.history(), |piece| piece + 1, time),
        // The last time is the end of the history, whatever the rounding of sums.
        None => (duration + time).min(whole.history().duration()),
    };
    let later = times.iter().map(later).collect();
    Ok((whole, later))
}

/// The variables of a trace. The drive of a rigid slider is its position.
fn trace_record(trace: &Trace, free: bool) -> Record {
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

/// Moves the top of a block, over the master equation and over the ensemble if there is one. The accuracy is estimated only
/// if the scenario requires one.
///
/// # Errors
/// Errors of the solvers, a stop by the monitor.
pub(super) fn behind(
    model: &Model,
    protocol: &scenario::Protocol,
    block: &scenario::Block,
    monitor: &mut dyn Monitor,
) -> Result<(Sliding, Record, Option<ForceAccuracy>)> {
    let Model { contacts, initial, .. } = model;
    let step = model.master_equation.step_of_a_block();
    let mean = contacts.thresholds.mean();
    let master = if model.ensemble.is_some() { MASTER } else { 1.0 };
    let part = &mut Part::new(monitor, 0.0, master);
    let loaded = |block: Block| block.with_background(model.background);
    let (protocol, run, accuracy) = move_block(model, &loaded(block.in_time(false)?)?, protocol, part)?;
    let (history, times) = (protocol.build()?, protocol.times());
    let mut record = Record::default();
    sliding::adopt(used(sliding::motion_in_time(&run), contacts), "", &mut record);
    let mut summary = Sliding::in_time(&run);
    if let Some(drawn) = &model.ensemble {
        let aside = &mut Part::new(monitor, master, 0.0);
        let ensemble = drawn.build(contacts.clone(), initial.clone())?.in_time_with(aside)?;
        // Single contacts break at random: the scatter of slips over N contacts is far above the
        // tolerance of the master equation.
        let length = mean * finite_size_tolerance(drawn.size()).max(step);
        let part = &mut Part::new(monitor, master, 1.0 - master);
        let run = loaded(block.in_time(true)?)?.follow_with(&ensemble, &history, &times, length, part)?;
        sliding::adopt(used(sliding::motion_in_time(&run), contacts), "ensemble_", &mut record);
        summary.ensemble = Some(Box::new(Sliding::in_time(&run)));
    }
    model.add_coefficient(FORCE.name, &mut record);
    Ok((summary, record, accuracy))
}

/// The motion of a block over the master equation, with the protocol in the pieces that were followed. Its error is estimated, by a
/// second motion, and for ramps by motions in other numbers of pieces, only if an accuracy is required.
fn move_block(
    model: &Model,
    block: &Block,
    protocol: &scenario::Protocol,
    monitor: &mut dyn Monitor,
) -> Result<(scenario::Protocol, Slide, Option<ForceAccuracy>)> {
    let mean = model.contacts.thresholds.mean();
    let tolerance = model.master_equation.tolerance_of_a_block();
    if model.master_equation.tolerance.is_none() {
        let mut preparation = Preparation::new(monitor);
        let contacts = transport(model, tolerance, &mut preparation)?;
        let rest = &mut preparation.rest();
        let step = model.master_equation.step_of_a_block() * mean;
        let run = block.follow_with(&contacts, &protocol.build()?, &protocol.times(), step, rest)?;
        return Ok((protocol.clone(), run, None));
    }
    let follow = |protocol: &scenario::Protocol, part: &mut dyn Monitor| {
        let (drive, times) = (protocol.build()?, protocol.times());
        let (slide, _) = as_required(model, tolerance, part, |tolerance, part| {
            let mut preparation = Preparation::new(part);
            let contacts = transport(model, tolerance, &mut preparation)?;
            let (rest, step) = (&mut preparation.rest(), Block::step_for(tolerance) * mean);
            let slide = block.follow_with_error(&contacts, &drive, &times, step, rest)?;
            let accuracy = ForceAccuracy::in_time(model, slide.error.unwrap_or(0.0));
            Ok((slide, accuracy))
        })?;
        let forces: Vec<f64> = slide.forces(&times).collect();
        let error = slide.error.unwrap_or(0.0);
        Ok(((slide, forces), error))
    };
    let (protocol, (slide, _), error) = over_ramps((model, protocol), monitor, follow, |(_, forces)| forces)?;
    Ok((protocol, slide, Some(ForceAccuracy::in_time(model, error))))
}

/// Largest error of a step of a block over `size` contacts followed one by one, per mean threshold.
pub fn finite_size_tolerance(size: usize) -> f64 {
    FINITE * (size as f64).powf(-2.0 / 3.0)
}

/// The variables of a motion without those that have no meaning for these contacts.
fn used(mut motion: Record, contacts: &Contacts) -> Record {
    let Rules { ref ageing, ref delay, .. } = contacts.rules;
    let stiffens = ageing.is_some() && matches!(contacts.stiffness, Stiffness::PerThreshold(_));
    let unused = |name: &str| match name {
        "free" => delay.is_none(),
        "event_strengthening" => !stiffens,
        _ => false,
    };
    motion.variables.retain(|variable| !unused(&variable.name));
    motion
}
