//! `[[protocol]]`: the slider moved in time, step by step.

use super::accuracy::ForceAccuracy;
use super::fit::without_fits;
use super::hold_curve::peak;
use super::summary::{
    BlockNumbers, Comparison, MeasuredRateState, ProtocolNumbers, ProtocolStep, RateState, SpringRateState,
};
use super::{COMPARED, Output, compare, in_time, sliding};
use crate::block::Slide;
use crate::master::{MasterEquation, Trace};
use crate::monitor::{Monitor, Part};
use crate::rate_state::{MachineStep, MeasuredVelocityStep, StateLaw, StepReading, VelocityStep};
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
    block.variables.extend(Record::declared(&[&[in_time::FRICTION_COEFFICIENT], &COMPARED]).variables);
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
    let mean = model.contacts.thresholds.mean();
    in_time::check_size((task, task.number_between(mean)), model, monitor)?;
    let between = task.times_between(mean);
    let (task, trace, mut record) = in_time::rigid(model, (task, &between), monitor)?;
    let steps = steps(model, &task, &trace, &mut Part::new(monitor, 1.0, 0.0))?;
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
    in_time::check_size((task, 0), model, monitor)?;
    let (sliding, mut record, accuracy) = in_time::behind(model, task, block, monitor)?;
    let mut numbers = BlockNumbers { sliding, steps: Vec::new(), compare: None };
    if let Some(curve) = &model.compare {
        let curve = from_start(curve, &record);
        let monitor = &mut Part::new(monitor, 1.0, 0.0);
        numbers.steps = steps_behind(task, block.stiffness, &curve, &record, monitor)?;
        numbers.compare = compared_behind(&curve, &mut record);
    }
    let output = Output::new(model, numbers, record);
    match accuracy {
        Some(accuracy) => accuracy.of(model, "the force on a block in time", output),
        None => Ok(output),
    }
}

/// Adds the measured curve to `record`, and compares it with the trace, interpolated linearly.
fn compared(curve: &scenario::Compare, trace: &Trace, record: &mut Record) -> Comparison {
    let force = |x: f64| between(&trace.position, &trace.force, x);
    compare(curve, (0.0, trace.position[trace.position.len() - 1]), force, record)
}

/// The curve with its positions, displacements of the load point since the start, as drives: in balance at the start, the spring
/// is stretched.
fn from_start(curve: &scenario::Compare, record: &Record) -> scenario::Compare {
    let start = record.values("drive").and_then(|drive| drive.first()).copied().unwrap_or(0.0);
    let position = curve.points().0.iter().map(|x| start + x).collect();
    scenario::Compare { position: Some(position), ..curve.clone() }
}

/// The same beside a block: the force of the spring against the displacement of the load point. `None` without a trace.
fn compared_behind(curve: &scenario::Compare, record: &mut Record) -> Option<Comparison> {
    let [drive, force] = ["drive", "spring_force"].map(|name| record.values(name).map(<[f64]>::to_vec));
    let (drive, force) = (drive?, force?);
    Some(compare(curve, (drive[0], *drive.last()?), |x| between(&drive, &force, x), record))
}

/// The force at x, interpolated linearly; positions do not fall.
fn between(position: &[f64], force: &[f64], x: f64) -> f64 {
    let next = position.partition_point(|at| *at < x).clamp(1, position.len() - 1);
    let (a, b) = (position[next - 1], position[next]);
    let fraction = if b > a { (x - a) / (b - a) } else { 1.0 };
    force[next - 1] + fraction * (force[next] - force[next - 1])
}

/// The numbers of each step.
fn steps(
    model: &Model,
    task: &scenario::Protocol,
    trace: &Trace,
    monitor: &mut dyn Monitor,
) -> Result<Vec<ProtocolStep>> {
    let mut frictions = Vec::new();
    let places = places(task, &trace.time);
    let mut steps = Vec::new();
    for (i, step) in task.0.iter().enumerate() {
        // Where the load steps, the step begins with the second of two readings.
        let (first, last) = (places[i] + usize::from(task.steps_load_at(i)), places[i + 1]);
        let (position, force) = (&trace.position[first..=last], &trace.force[first..=last]);
        let velocity = step.velocities().1;
        let changed = changed_from(task, i);
        let compared = match (changed, &model.compare) {
            (Some(before), Some(curve)) => {
                let ends = [trace.position[places[i - 1]], position[0], position[position.len() - 1]];
                compared_step(curve, ends, velocity / before, monitor)?
            }
            _ => ComparedStep::default(),
        };
        let kinetic_friction = match step.velocity_to {
            None if velocity > 0.0 => steady(model, velocity, &mut frictions, monitor)?,
            _ => None,
        };
        let under_load = |friction: f64| step.load() * friction + model.background_at(step.load());
        let kinetic_friction = kinetic_friction.map(under_load);
        steps.push(ProtocolStep {
            kinetic_friction,
            rate_state: changed.and_then(|v| read(v, velocity, position, force)),
            measured: compared.measured,
            measured_spring: compared.spring,
            not_read: compared.not_read,
            ..moved(step, position, force)
        });
    }
    Ok(steps)
}

/// The places in `time` at which the steps begin, and that of the end of the last one.
fn places(task: &scenario::Protocol, time: &[f64]) -> Vec<usize> {
    let place = |knot: &f64| time.partition_point(|at| at < knot).min(time.len().saturating_sub(1));
    task.knots().iter().map(place).collect()
}

/// A step of the protocol with its positions and forces, and nothing read from them but the peak.
fn moved(step: &scenario::Step, position: &[f64], force: &[f64]) -> ProtocolStep {
    let (first, last) = step.velocities();
    ProtocolStep {
        velocity: last,
        velocity_from: step.velocity_to.map(|_| first),
        relative_normal_load: Some(step.load()).filter(|load| *load != 1.0),
        position: position[0],
        duration: step.duration(),
        pieces: Some(step.pieces().len()).filter(|&pieces| pieces > 1),
        force: force[force.len() - 1],
        peak: peak(position, force),
        kinetic_friction: None,
        rate_state: None,
        measured: None,
        rate_state_spring: None,
        measured_spring: None,
        not_read: None,
    }
}

/// The velocity before step `i`, if the velocity steps there from one above 0 to another one, and the normal load does not.
fn changed_from(task: &scenario::Protocol, i: usize) -> Option<f64> {
    let before = task.0[i.checked_sub(1)?].velocities().1;
    let step = &task.0[i];
    (step.velocity_to.is_none() && !task.steps_load_at(i) && before > 0.0 && step.velocities().1 > 0.0)
        .then_some(before)
}

/// The numbers of each step beside a block: the force of its spring against the displacement of the load point. Velocity steps
/// of the computed and of the compared curve are read with the spring.
fn steps_behind(
    task: &scenario::Protocol,
    stiffness: f64,
    curve: &scenario::Compare,
    record: &Record,
    monitor: &mut dyn Monitor,
) -> Result<Vec<ProtocolStep>> {
    let [time, drive, force] =
        ["time", "drive", "spring_force"].map(|name| record.values(name).unwrap_or_default());
    let (rising, there) = once_each(drive, force);
    let places = places(task, time);
    let mut steps = Vec::new();
    for (i, step) in task.0.iter().enumerate() {
        let (first, last) = (places[i], places[i + 1]);
        let velocity = step.velocities().1;
        let (mut computed, mut compared) = (ComparedStep::default(), ComparedStep::default());
        if let Some(before) = changed_from(task, i) {
            let ends = [drive[places[i - 1]], drive[first], drive[last]];
            let spring = MachineSpring { stiffness, states: curve.state_variables() };
            computed = spring.read((&rising, &there), ends, velocity / before, monitor)?;
            compared = spring.read(curve.points(), ends, velocity / before, monitor)?;
        }
        steps.push(ProtocolStep {
            rate_state_spring: computed.spring,
            measured_spring: compared.spring,
            not_read: compared.not_read,
            ..moved(step, &drive[first..=last], &force[first..=last])
        });
    }
    Ok(steps)
}

/// F_k of the contacts at the start at a velocity, from the cache `known` if it is there; `None` once [`SPEEDS`] velocities are cached.
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
    let friction = equation.steady_state().kinetic_friction();
    known.push((velocity, friction));
    Ok(Some(friction))
}

/// What a velocity step of a curve was read as; nothing without points after the step.
#[derive(Default)]
struct ComparedStep {
    measured: Option<MeasuredRateState>,
    spring: Option<SpringRateState>,
    not_read: Option<String>,
}

impl ComparedStep {
    /// Keeps why a curve cannot be read.
    ///
    /// # Errors
    /// Other errors than those of the curve.
    fn unread(error: Error) -> Result<Self> {
        let Error::Invalid { expected, found, .. } = error else { return Err(error) };
        Ok(Self { not_read: Some(format!("expected {expected}, got {found}")), ..Self::default() })
    }
}

/// The points of a curve for the reading of a step, with positions relative to it. The `ends` are the start of the step before,
/// of this one, and its end. The force before the step is that of the second half of the step before, which has a transient,
/// too. `None` without points after the step.
fn near_step(
    (positions, forces): (&[f64], &[f64]),
    [start, step, end]: [f64; 3],
) -> Option<(Vec<f64>, Vec<f64>)> {
    let steady = 0.5 * (start + step);
    let within = positions.iter().zip(forces).filter(|(x, _)| (steady..=end).contains(*x));
    let (position, force): (Vec<f64>, Vec<f64>) = within.map(|(x, force)| (x - step, *force)).unzip();
    position.iter().any(|x| *x > 0.0).then_some((position, force))
}

/// Reads the points of a curve near a step, if this program has fits.
///
/// # Errors
/// Other errors than those of the curve.
fn read_near(
    curve: (&[f64], &[f64]),
    ends: [f64; 3],
    read: impl FnOnce(&[f64], &[f64]) -> Result<ComparedStep>,
) -> Result<ComparedStep> {
    let Some((position, force)) = near_step(curve, ends) else { return Ok(ComparedStep::default()) };
    if cfg!(not(feature = "fits")) {
        return ComparedStep::unread(without_fits());
    }
    read(&position, &force).or_else(ComparedStep::unread)
}

/// The rate-and-state parameters of the compared curve after a step of the velocity by the factor `ratio`, with the spring of the
/// machine if its stiffness is known.
fn compared_step(
    curve: &scenario::Compare,
    ends: [f64; 3],
    ratio: f64,
    monitor: &mut dyn Monitor,
) -> Result<ComparedStep> {
    if let Some(stiffness) = curve.stiffness {
        let spring = MachineSpring { stiffness, states: curve.state_variables() };
        return spring.read(curve.points(), ends, ratio, monitor);
    }
    read_near(curve.points(), ends, |position, force| {
        let read = MeasuredVelocityStep::read(position, force, ratio, &StepReading::default(), monitor)?;
        Ok(ComparedStep { measured: Some(MeasuredRateState::new(&read)), ..ComparedStep::default() })
    })
}

/// The spring of a machine, and the state variables with which steps behind it are read.
struct MachineSpring {
    stiffness: f64,
    states: (StateLaw, usize),
}

impl MachineSpring {
    /// Reads a velocity step of a curve of the force of the spring against the displacement of the load point.
    fn read(
        &self,
        curve: (&[f64], &[f64]),
        ends: [f64; 3],
        ratio: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<ComparedStep> {
        read_near(curve, ends, |position, force| {
            let read = MachineStep::read(position, force, ratio, self.stiffness, self.states, monitor)?;
            Ok(ComparedStep { spring: Some(SpringRateState::new(&read)), ..ComparedStep::default() })
        })
    }
}

/// The first of the points at each position: where a slider slips, the load point hardly moves.
fn once_each(position: &[f64], force: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let rises = |i: &usize| *i == 0 || position[*i] > position[*i - 1];
    (0..position.len()).filter(rises).map(|i| (position[i], force[i])).unzip()
}

/// The rate-and-state parameters of a step from velocity `before` to `after`. Its first force is the force
/// before the step.
fn read(before: f64, after: f64, position: &[f64], force: &[f64]) -> Option<RateState> {
    let displacement: Vec<f64> = position.iter().map(|x| x - position[0]).collect();
    let (displacement, force) = with_extremum(displacement, force.to_vec(), (after - before).signum());
    VelocityStep::read(&displacement, &force, force[0], after / before)
        .map(|step| RateState::new(before, &step))
}

/// The points with one more at the extremum between them, the largest force times `side`.
fn with_extremum(mut position: Vec<f64>, mut force: Vec<f64>, side: f64) -> (Vec<f64>, Vec<f64>) {
    let sided: Vec<f64> = force.iter().map(|force| side * force).collect();
    let top = peak(&position, &sided);
    let next = position.partition_point(|x| *x < top.position);
    if position.get(next).is_some_and(|x| *x > top.position) {
        position.insert(next, top.position);
        force.insert(next, side * top.force);
    }
    (position, force)
}
