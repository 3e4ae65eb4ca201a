//! `[[protocol]]`: the slider moved in time, step by step.

use asperity::master::{MasterEquation, Trace, Transport};
use asperity::monitor::Monitor;
use asperity::rate_state::VelocityStep;
use asperity::record::{Quantity, Record};
use asperity::scenario::{self, Scenario};
use asperity::{Error, Result};

use super::hold_curve::peak;
use super::part::Part;
use super::{Setting, compare, sliding};
use crate::output::LARGEST;
use crate::summary::{Comparison, RateState, Sliding, Step, Summary};

/// Columns of a trace, at most.
const COLUMNS: usize = 11;
/// Most velocities at which steady sliding is computed beside the trace.
const SPEEDS: usize = 16;

/// Moves the slider as `task` says.
///
/// # Errors
/// Results too large for one file, what the solvers run into, or the monitor's wish to stop.
pub fn run(
    setting: &Setting<'_>,
    task: &scenario::Protocol,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let Setting { scenario, contacts, initial } = setting;
    fits(task)?;
    if let Some(block) = &scenario.block {
        return slide(setting, task, block, monitor);
    }
    let (history, times) = (task.build()?, task.times());
    let master = if scenario.ensemble.is_some() { 0.5 } else { 1.0 };
    let mut transport = Transport::new(
        contacts.clone(),
        initial,
        scenario.master_equation.tolerance_in_time(&contacts.rules),
    )?;
    let trace = transport.follow(&history, &times, &mut Part::new(monitor, 0.0, master))?;
    let mut record = traced(&trace, contacts.rules.delay > 0.0);
    if let Some(ensemble) = &scenario.ensemble {
        let model = ensemble.build(contacts.clone(), initial.clone())?;
        let run = model.follow(&history, &times, &mut Part::new(monitor, master, 1.0 - master))?;
        let along = &["point"];
        record.push("ensemble_force", "friction force of the ensemble", Quantity::Force, along, run.force);
        record.push("ensemble_error", "its standard error", Quantity::Force, along, run.error);
    }
    let steps = told(setting, task, &trace)?;
    let compare = compared(scenario, &trace, &mut record);
    Ok((Summary { steps, compare, ..setting.heading() }, record))
}

/// Moves the top of a block; its bottom follows.
fn slide(
    setting: &Setting<'_>,
    task: &scenario::Protocol,
    block: &scenario::Block,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let Setting { scenario, contacts, initial } = setting;
    let tolerance = scenario.master_equation.tolerance_of_a_block();
    let transport = Transport::new(contacts.clone(), initial, tolerance)?;
    let length = tolerance * contacts.thresholds.mean();
    let run = block.in_time()?.follow(&transport, &task.build()?, &task.times(), length, monitor)?;
    let mut record = sliding::motion_in_time(&run);
    let unused = |name: &str| name == "free" && contacts.rules.delay == 0.0;
    record.variables.retain(|variable| !variable.values.is_empty() && !unused(&variable.name));
    Ok((Summary { sliding: Some(Sliding::in_time(&run)), ..setting.heading() }, record))
}

/// Refuses before any work what could not be written after it.
fn fits(task: &scenario::Protocol) -> Result<()> {
    let needed = (task.points() * COLUMNS * size_of::<f64>()) as u64;
    if needed <= LARGEST {
        return Ok(());
    }
    let what = format!("a result file of a trace of {} points", task.points());
    Err(Error::TooLarge { what, needed, allowed: LARGEST })
}

/// The trace; of a rigid slider the drive is its position.
fn traced(trace: &Trace, free: bool) -> Record {
    let mut record = Record::default();
    let mut add = |name, words, quantity, values: &[f64]| {
        record.push(name, words, quantity, &["point"], values.to_vec())
    };
    add("time", "time", Quantity::Time, &trace.time);
    add("drive", "drive", Quantity::Length, &trace.position);
    add("position", "position of the slider's bottom", Quantity::Length, &trace.position);
    add("velocity", "velocity of the slider", Quantity::Velocity, &trace.velocity);
    add("force", "friction force", Quantity::Force, &trace.force);
    add("spring_force", "force that pulls", Quantity::Force, &trace.force);
    add(
        "breaking_frequency",
        "fraction of contacts breaking per time",
        Quantity::PerTime,
        &trace.breaking_rate,
    );
    if free {
        add("free", "fraction of contacts that are free", Quantity::Number, &trace.free);
    }
    record
}

/// The measured curve, and how far it is from the trace, linear between its points.
fn compared(scenario: &Scenario, trace: &Trace, record: &mut Record) -> Option<Comparison> {
    let force = |x: f64| {
        let next = trace.position.partition_point(|at| *at < x).clamp(1, trace.position.len() - 1);
        let (a, b) = (trace.position[next - 1], trace.position[next]);
        let share = if b > a { (x - a) / (b - a) } else { 1.0 };
        trace.force[next - 1] + share * (trace.force[next] - trace.force[next - 1])
    };
    compare(scenario, trace.position[trace.position.len() - 1], force, record)
}

/// What is quoted of each step.
fn told(setting: &Setting<'_>, task: &scenario::Protocol, trace: &Trace) -> Result<Vec<Step>> {
    let mut frictions = Vec::new();
    let mut first = 0;
    let mut steps = Vec::new();
    for (i, step) in task.0.iter().enumerate() {
        let last = first + step.points - 1;
        let (position, force) = (&trace.position[first..=last], &trace.force[first..=last]);
        let velocity = step.velocities().1;
        let before = i.checked_sub(1).map(|i| task.0[i].velocities().1);
        steps.push(Step {
            velocity,
            position: position[0],
            duration: step.duration(),
            pieces: Some(step.pieces().len()).filter(|&pieces| pieces > 1),
            force: trace.force[last],
            peak: peak(position, force),
            kinetic_friction: match step.velocity_to {
                None if velocity > 0.0 => steady(setting, velocity, &mut frictions)?,
                _ => None,
            },
            rate_state: before
                .filter(|_| step.velocity_to.is_none())
                .and_then(|v| read(v, velocity, position, force)),
        });
        first = last;
    }
    Ok(steps)
}

/// F_k at a velocity, remembered; `None` when there are too many of them.
fn steady(setting: &Setting<'_>, velocity: f64, known: &mut Vec<(f64, f64)>) -> Result<Option<f64>> {
    if let Some(&(_, friction)) = known.iter().find(|(v, _)| *v == velocity) {
        return Ok(Some(friction));
    }
    if known.len() == SPEEDS {
        return Ok(None);
    }
    let equation = MasterEquation::at(setting.contacts.clone(), &setting.initial, velocity)?;
    let friction = equation.steady_state().kinetic_friction();
    known.push((velocity, friction));
    Ok(Some(friction))
}

/// The step from one velocity to another in the words of rate and state, the force before it being that at its start.
fn read(before: f64, after: f64, position: &[f64], force: &[f64]) -> Option<RateState> {
    if !(before > 0.0 && after > 0.0) {
        return None;
    }
    let way: Vec<f64> = position.iter().map(|x| x - position[0]).collect();
    VelocityStep::read(&way, force, force[0], after / before).map(|step| RateState::new(before, &step))
}
