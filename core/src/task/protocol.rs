//! `[[protocol]]`: the slider moved in time, step by step.

use super::accuracy::ForceAccuracy;
use super::hold_curve::peak;
use super::summary::{BlockNumbers, Comparison, MeasuredRateState, ProtocolNumbers, ProtocolStep, RateState};
use super::{COMPARED, Output, compare, in_time, sliding};
use crate::block::Slide;
use crate::master::{MasterEquation, Trace};
use crate::monitor::{Monitor, Part};
use crate::rate_state::{MeasuredVelocityStep, StepReading, VelocityStep};
use crate::record::{CsvTable, Record};
use crate::scenario::{self, Model, Task};
use crate::{Error, Result};

/// Largest number of velocities for which steady sliding is computed in addition to the trace.
const SPEEDS: usize = 16;

/// Traces have tables of their own kinds.
pub(super) const TABLES: &[CsvTable] = &[];

/// What a result may hold, without values: that of a rigid slider, and that of a block.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    let [motion, slips] = Slide::columns();
    let mut block = sliding::joined(motion, slips);
    let ensemble = block.prefixed("ensemble_");
    block.variables.extend(ensemble.variables);
    block.variables.extend(Record::declared(&[&[in_time::FRICTION_COEFFICIENT]]).variables);
    vec![("protocol", Record::declared(&[&in_time::COLUMNS, &COMPARED])), ("block_protocol", block)]
}

impl scenario::Protocol {
    /// Moves the top of the block of `model`; the base follows.
    ///
    /// # Errors
    /// A model without a block, and those of [`run`](Self::run).
    pub fn run_block(&self, model: &Model, monitor: &mut dyn Monitor) -> Result<Output<BlockNumbers>> {
        Task::Protocol(self).check(model)?;
        let block = model.block.as_ref();
        let block = block.ok_or_else(|| Error::invalid("block", "one, whose top is moved", "none"))?;
        run_block(model, self, block, monitor).map_err(Error::of_scenario)
    }
}

/// Moves a rigid slider as `task` says.
///
/// # Errors
/// Results too large for the memory, errors of the solvers, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &scenario::Protocol,
    monitor: &mut dyn Monitor,
) -> Result<Output<ProtocolNumbers>> {
    if model.block.is_some() {
        return Err(Error::invalid("block", "none: Protocol::run_block moves a block", "one"));
    }
    if model.interface.is_some() {
        return Err(Error::invalid("interface", "none: Protocol::run_interface moves an interface", "one"));
    }
    in_time::check_size(task, model, monitor)?;
    let (trace, mut record) = in_time::rigid(model, task, monitor)?;
    let steps = steps(model, task, &trace, &mut Part::new(monitor, 1.0, 0.0))?;
    let compare = model.compare.as_ref().map(|curve| compared(curve, &trace, &mut record));
    let numbers = ProtocolNumbers { force_error: trace.error, steps, compare };
    let accuracy = ForceAccuracy::in_time(model, trace.error);
    accuracy.of(model, "the force along the protocol", Output::new(model, numbers, record))
}

/// Moves the top of a block as `task` says.
///
/// # Errors
/// Those of [`run`].
pub(super) fn run_block(
    model: &Model,
    task: &scenario::Protocol,
    block: &scenario::Block,
    monitor: &mut dyn Monitor,
) -> Result<Output<BlockNumbers>> {
    in_time::check_size(task, model, monitor)?;
    let (sliding, record, accuracy) = in_time::behind(model, task, block, monitor)?;
    let output = Output::new(model, BlockNumbers { sliding }, record);
    match accuracy {
        Some(accuracy) => accuracy.of(model, "the force on a block in time", output),
        None => Ok(output),
    }
}

/// Adds the measured curve to `record`, and compares it with the trace, interpolated linearly.
fn compared(curve: &scenario::Compare, trace: &Trace, record: &mut Record) -> Comparison {
    let force = |x: f64| {
        let next = trace.position.partition_point(|at| *at < x).clamp(1, trace.position.len() - 1);
        let (a, b) = (trace.position[next - 1], trace.position[next]);
        let fraction = if b > a { (x - a) / (b - a) } else { 1.0 };
        trace.force[next - 1] + fraction * (trace.force[next] - trace.force[next - 1])
    };
    compare(curve, trace.position[trace.position.len() - 1], force, record)
}

/// The numbers of each step.
fn steps(
    model: &Model,
    task: &scenario::Protocol,
    trace: &Trace,
    monitor: &mut dyn Monitor,
) -> Result<Vec<ProtocolStep>> {
    let mut frictions = Vec::new();
    let (mut previous, mut first) = (0, 0);
    let mut steps = Vec::new();
    for (i, step) in task.0.iter().enumerate() {
        let last = first + step.points - 1;
        let (position, force) = (&trace.position[first..=last], &trace.force[first..=last]);
        let velocity = step.velocities().1;
        let before = i.checked_sub(1).map(|i| task.0[i].velocities().1);
        let changed = before.filter(|v| step.velocity_to.is_none() && *v > 0.0 && velocity > 0.0);
        let compared = match (changed, &model.compare) {
            (Some(before), Some(curve)) => {
                let ends = [trace.position[previous], position[0], position[position.len() - 1]];
                compared_step(curve, ends, velocity / before, monitor)?
            }
            _ => None,
        };
        let (measured, not_read) = compared.map_or((None, None), |read| match read {
            Ok(read) => (Some(read), None),
            Err(reason) => (None, Some(reason)),
        });
        steps.push(ProtocolStep {
            velocity,
            position: position[0],
            duration: step.duration(),
            pieces: Some(step.pieces().len()).filter(|&pieces| pieces > 1),
            force: trace.force[last],
            peak: peak(position, force),
            kinetic_friction: match step.velocity_to {
                None if velocity > 0.0 => steady(model, velocity, &mut frictions, monitor)?,
                _ => None,
            },
            rate_state: changed.and_then(|v| read(v, velocity, position, force)),
            measured,
            not_read,
        });
        (previous, first) = (first, last);
    }
    Ok(steps)
}

/// F_k at a velocity, from the cache `known` if it is there; `None` once [`SPEEDS`] velocities are cached.
fn steady(
    model: &Model,
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
    let equation = MasterEquation::reformed(model.contacts.clone(), Some(velocity), monitor)?;
    let friction = equation.steady_state().kinetic_friction() + model.background;
    known.push((velocity, friction));
    Ok(Some(friction))
}

/// The rate-and-state parameters of the compared curve after a step of the velocity by the factor `ratio`, or
/// the reason why there are none; `None` without points after the step. The `ends` are the start of the step
/// before, of this one, and its end. The force before the step is that of the second half of the step before, which has a
/// transient, too.
fn compared_step(
    curve: &scenario::Compare,
    [start, step, end]: [f64; 3],
    ratio: f64,
    monitor: &mut dyn Monitor,
) -> Result<Option<std::result::Result<MeasuredRateState, String>>> {
    let (positions, forces) = curve.points();
    let steady = 0.5 * (start + step);
    let within = positions.iter().zip(forces).filter(|(x, _)| (steady..=end).contains(*x));
    let (position, force): (Vec<f64>, Vec<f64>) = within.map(|(x, force)| (x - step, *force)).unzip();
    if position.iter().all(|x| *x <= 0.0) {
        return Ok(None);
    }
    match MeasuredVelocityStep::read(&position, &force, ratio, &StepReading::default(), monitor) {
        Ok(read) => Ok(Some(Ok(MeasuredRateState::new(&read)))),
        Err(Error::Invalid { expected, found, .. }) => {
            Ok(Some(Err(format!("expected {expected}, got {found}"))))
        }
        Err(error) => Err(error),
    }
}

/// The rate-and-state parameters of a step from velocity `before` to `after`. Its first force is the force
/// before the step.
fn read(before: f64, after: f64, position: &[f64], force: &[f64]) -> Option<RateState> {
    let displacement: Vec<f64> = position.iter().map(|x| x - position[0]).collect();
    VelocityStep::read(&displacement, force, force[0], after / before)
        .map(|step| RateState::new(before, &step))
}
