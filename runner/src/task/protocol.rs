//! `[[protocol]]`: the slider moved in time, step by step.

use asperity::Result;
use asperity::master::{MasterEquation, Trace};
use asperity::monitor::Monitor;
use asperity::rate_state::VelocityStep;
use asperity::record::Record;
use asperity::scenario::{self, Scenario};

use super::accuracy::Accuracy;
use super::hold_curve::peak;
use super::part::Part;
use super::{Setting, compare, in_time};
use crate::summary::{Comparison, RateState, Step, Summary};

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
    in_time::fits(task, setting)?;
    if let Some(block) = &setting.scenario.block {
        let (sliding, record, accuracy) = in_time::behind(setting, task, block, monitor)?;
        let summary = Summary { sliding: Some(sliding), ..setting.heading() };
        let summary = match accuracy {
            Some(accuracy) => accuracy.told(setting, "the force on a block in time", summary)?,
            None => summary,
        };
        return Ok((summary, record));
    }
    let (trace, mut record) = in_time::rigid(setting, task, monitor)?;
    let steps = told(setting, task, &trace, &mut Part::new(monitor, 1.0, 0.0))?;
    let compare = compared(setting.scenario, &trace, &mut record);
    let summary = Summary { force_error: Some(trace.error), steps, compare, ..setting.heading() };
    let accuracy = Accuracy::in_time(setting, trace.error);
    Ok((accuracy.told(setting, "the force along the protocol", summary)?, record))
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
fn told(
    setting: &Setting<'_>,
    task: &scenario::Protocol,
    trace: &Trace,
    monitor: &mut dyn Monitor,
) -> Result<Vec<Step>> {
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
                None if velocity > 0.0 => steady(setting, velocity, &mut frictions, monitor)?,
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
fn steady(
    setting: &Setting<'_>,
    velocity: f64,
    known: &mut Vec<(f64, f64)>,
    monitor: &mut dyn Monitor,
) -> Result<Option<f64>> {
    if let Some(&(_, friction)) = known.iter().find(|(v, _)| *v == velocity) {
        return Ok(Some(friction));
    }
    if known.len() == SPEEDS {
        return Ok(None);
    }
    let equation = MasterEquation::at(setting.contacts.clone(), &setting.initial, velocity, monitor)?;
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
