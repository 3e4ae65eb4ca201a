//! `[velocity_curve]`: kinetic friction against velocity, at one temperature or several.

use super::accuracy::ForceAccuracy;
use super::background::coefficient;
use super::linear_stability::stability;
use super::settling::Steady;
use super::summary::{CurveLimits, Extended, SlidingStability, VelocityCurveNumbers};
use super::{COMPARED_FORCE, Output, RESIDUAL, compare_points, ensemble};
use crate::Result;
use crate::contacts::{Contacts, Rules, Temperature};
use crate::history::{History, Piece};
use crate::master::{Limits, MasterEquation, creep};
use crate::monitor::{Monitor, Part, report};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, Model};

const VELOCITY: Column = Column::new("velocity", "velocity of the slider", Quantity::Velocity, &["velocity"]);
const TEMPERATURE: Column =
    Column::new("temperature", "temperature T, an energy", Quantity::Energy, &["temperature"]);
const CRITICAL_STIFFNESS: Column =
    of("critical_stiffness", "critical stiffness of the first loading", Quantity::Stiffness);
const CRITICAL_STIFFNESS_SLIDING: Column =
    of("critical_stiffness_sliding", "critical stiffness of steady sliding", Quantity::Stiffness);
const GROWTH_RATE: Column =
    of("growth_rate", "rate at which deviations from steady sliding grow", Quantity::PerTime);
const GROWTH_FREQUENCY: Column =
    of("growth_frequency", "angular frequency at which they grow", Quantity::PerTime);
const KINETIC_FRICTION: Column = of("kinetic_friction", "friction force of steady sliding", Quantity::Force);
const ENSEMBLE: [Column; 2] =
    ensemble::force_columns("friction force of the ensemble in steady sliding", &["velocity"]);
const CREEP_FRICTION: Column =
    of("creep_friction", "friction force by the law of slow creep, where it holds", Quantity::Force);
const VISCOUS_FRICTION: Column =
    of("viscous_friction", "friction force of viscous flow, the limit of low velocities", Quantity::Force);

const FRICTION_COEFFICIENT: Column = coefficient(&["velocity"]);

/// The variables of the task. With several temperatures, the temperature is the first dimension of all except the velocity.
const COLUMNS: [Column; 12] = [
    VELOCITY,
    TEMPERATURE,
    CRITICAL_STIFFNESS,
    CRITICAL_STIFFNESS_SLIDING,
    GROWTH_RATE,
    GROWTH_FREQUENCY,
    KINETIC_FRICTION,
    ENSEMBLE[0],
    ENSEMBLE[1],
    CREEP_FRICTION,
    VISCOUS_FRICTION,
    FRICTION_COEFFICIENT,
];

const COMPARED: [Column; 3] = [
    Column::new("compared_velocity", "measured velocity", Quantity::Velocity, &["compared"]),
    COMPARED_FORCE,
    RESIDUAL,
];

/// Forces of contacts, to which the background force is added.
const FORCES: [Column; 4] = [KINETIC_FRICTION, ENSEMBLE[0], CREEP_FRICTION, VISCOUS_FRICTION];

/// Its table in CSV: a row for each velocity, of one temperature after the other where there are several.
pub(super) const TABLES: &[CsvTable] = &[CsvTable {
    file: "velocity_curve.csv",
    columns: &[
        TEMPERATURE,
        VELOCITY,
        KINETIC_FRICTION,
        ENSEMBLE[0],
        ENSEMBLE[1],
        CRITICAL_STIFFNESS,
        CRITICAL_STIFFNESS_SLIDING,
        GROWTH_RATE,
        GROWTH_FREQUENCY,
        FRICTION_COEFFICIENT,
    ],
    needed: KINETIC_FRICTION,
}];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    vec![("velocity_curve", Record::declared(&[&COLUMNS, &COMPARED]))]
}

const fn of(name: &'static str, long_name: &'static str, quantity: Quantity) -> Column {
    Column::new(name, long_name, quantity, &["velocity"])
}

/// Computes the curve, or the curves, of `task`.
///
/// # Errors
/// Errors of the solvers, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &scenario::VelocityCurve,
    monitor: &mut dyn Monitor,
) -> Result<Output<VelocityCurveNumbers>> {
    let velocities = task.velocities();
    let curves = curves(&model.contacts, task);
    let mut points = CurvePoints::new(model, task, curves.len() * velocities.len());
    let measured = model.compare.as_ref().map_or(0, |curve| curve.points().0.len());
    let share = points.count as f64 / (points.count + measured) as f64;
    let within = &mut Part::new(&mut *monitor, 0.0, share);
    let mut limits = Vec::new();
    for (temperature, contacts) in &curves {
        let limit = Limits::of(contacts, &mut Part::new(within, points.done(), 0.0))?;
        limits.push(CurveLimits::new(*temperature, &limit, model.background));
        for &velocity in &velocities {
            points.add(contacts, velocity, limit.viscosity, within)?;
            report(within, points.done())?;
        }
    }
    let mut record = Record::default();
    record.add(VELOCITY, velocities);
    if !task.temperatures.is_empty() {
        record.add(TEMPERATURE, task.temperatures.clone());
    }
    let (stability, mut accuracy) = (points.critical.stability(), points.accuracy);
    points.add_to(&mut record);
    let compare = match &model.compare {
        Some(curve) => {
            let (computed, reached) = at_measured(model, curve, &mut Part::new(monitor, share, 1.0 - share))?;
            accuracy = accuracy.worse(reached);
            Some(compare_points(curve, COMPARED[0], &computed, &mut record))
        }
        None => None,
    };
    let numbers = VelocityCurveNumbers { limits, stability, compare };
    model.add_background(&FORCES, &mut record);
    model.add_coefficient(KINETIC_FRICTION.name, &mut record);
    accuracy.of(model, "the friction force of steady sliding", Output::new(model, numbers, record))
}

/// The points of all curves, one curve after the other.
struct CurvePoints<'a> {
    model: &'a Model,
    task: &'a scenario::VelocityCurve,
    /// Their number in the end.
    count: usize,
    friction: Vec<f64>,
    slow: Slow,
    force: Vec<f64>,
    error: Vec<f64>,
    critical: Critical,
    accuracy: ForceAccuracy,
}

impl<'a> CurvePoints<'a> {
    fn new(model: &'a Model, task: &'a scenario::VelocityCurve, count: usize) -> Self {
        Self {
            model,
            task,
            count,
            friction: Vec::new(),
            slow: Slow::default(),
            force: Vec::new(),
            error: Vec::new(),
            critical: Critical::default(),
            accuracy: ForceAccuracy::new(model, 0.0, model.contacts.thresholds.mean()),
        }
    }

    /// The fraction of the points that has been added.
    fn done(&self) -> f64 {
        self.friction.len() as f64 / self.count as f64
    }

    /// Adds steady sliding at a velocity: the master equation, the ensemble and the stability, as far as they are asked for.
    fn add(
        &mut self,
        contacts: &Contacts,
        velocity: f64,
        viscosity: Option<f64>,
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let model = self.model;
        let jobs = 1 + usize::from(model.ensemble.is_some()) + usize::from(self.task.stability);
        let (begun, share) = (self.done(), 1.0 / (jobs * self.count) as f64);
        let job = |number: usize| (begun + number as f64 * share, share);
        let (start, length) = job(0);
        let steady = Steady::at(contacts, velocity, &mut Part::new(monitor, start, length))?;
        self.friction.push(steady.friction);
        self.accuracy = self.accuracy.worse(ForceAccuracy::new(model, steady.error, steady.life));
        self.slow.push(contacts, velocity, viscosity);
        if let Some(ensemble) = &model.ensemble {
            // Each point has contacts of its own, so that errors of points are independent.
            let first = (self.force.len() * ensemble.size()) as u64;
            let (start, length) = job(1);
            let part = &mut Part::new(monitor, start, length);
            let (force, error) = slide(model, contacts, (ensemble, first), velocity, steady.distance, part)?;
            self.force.push(force);
            self.error.push(error);
        }
        if self.task.stability {
            let (start, length) = job(jobs - 1);
            let part = &mut Part::new(monitor, start, length);
            let pulled = self.critical.push(contacts, model, velocity, part)?;
            self.accuracy = self.accuracy.worse(ForceAccuracy::new(model, pulled, steady.life));
        }
        Ok(())
    }

    fn add_to(self, record: &mut Record) {
        let along: &'static [&'static str] =
            if self.task.temperatures.is_empty() { &["velocity"] } else { &["temperature", "velocity"] };
        for (column, values) in [
            (CRITICAL_STIFFNESS, self.critical.pulled),
            (CRITICAL_STIFFNESS_SLIDING, self.critical.sliding),
            (GROWTH_RATE, self.critical.rate),
            (GROWTH_FREQUENCY, self.critical.frequency),
            (KINETIC_FRICTION, self.friction),
            (ENSEMBLE[0], self.force),
            (ENSEMBLE[1], self.error),
            (CREEP_FRICTION, self.slow.creep),
            (VISCOUS_FRICTION, self.slow.viscous),
        ] {
            record.add_known(column.along(along), values);
        }
    }
}

/// Kinetic friction at the measured velocities, with the background force, and its accuracy.
fn at_measured(
    model: &Model,
    curve: &scenario::Compare,
    monitor: &mut dyn Monitor,
) -> Result<(Vec<Option<f64>>, ForceAccuracy)> {
    let measured = curve.points().0;
    let mut velocities = measured.to_vec();
    velocities.sort_by(f64::total_cmp);
    velocities.dedup();
    let mut accuracy = ForceAccuracy::new(model, 0.0, model.contacts.thresholds.mean());
    let mut forces = Vec::with_capacity(velocities.len());
    let fraction = 1.0 / velocities.len() as f64;
    for (done, &velocity) in velocities.iter().enumerate() {
        let part = &mut Part::new(monitor, done as f64 * fraction, fraction);
        let steady = Steady::at(&model.contacts, velocity, part)?;
        accuracy = accuracy.worse(ForceAccuracy::new(model, steady.error, steady.life));
        forces.push(steady.friction + model.background);
    }
    let at = |velocity: &f64| Some(forces[velocities.partition_point(|other| other < velocity)]);
    Ok((measured.iter().map(at).collect(), accuracy))
}

/// The contacts of each curve, and its temperature if the task lists several.
fn curves(contacts: &Contacts, task: &scenario::VelocityCurve) -> Vec<(Option<f64>, Contacts)> {
    if task.temperatures.is_empty() {
        return vec![(None, contacts.clone())];
    }
    let at = |&energy: &f64| {
        let temperature = contacts.rules.temperature.map(|rule| Temperature { energy, ..rule });
        let rules = Rules { temperature, ..contacts.rules.clone() };
        (Some(energy), Contacts { rules, ..contacts.clone() })
    };
    task.temperatures.iter().map(at).collect()
}

/// Stability at each velocity.
#[derive(Default)]
struct Critical {
    /// Critical stiffness −min F' of a pull from the initial state.
    pulled: Vec<f64>,
    /// Critical stiffness of steady sliding, from its linear response; 0 if it is always stable, infinite if never.
    sliding: Vec<f64>,
    /// Growth rate of deviations from steady sliding of the block, if there is one; 0 if they decay.
    rate: Vec<f64>,
    /// Their angular frequency.
    frequency: Vec<f64>,
}

impl Critical {
    /// Adds the values at a velocity; returns the estimated error of F/(N_c⟨k⟩) of the pull.
    fn push(
        &mut self,
        contacts: &Contacts,
        model: &Model,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<f64> {
        let block = model.block.as_ref();
        if let (false, None, Some(&pulled), Some(&sliding)) =
            (contacts.rules.are_time_dependent(), block, self.pulled.last(), self.sliding.last())
        {
            // Without time dependence and block the values are the same at all velocities.
            self.pulled.push(pulled);
            self.sliding.push(sliding);
            return Ok(0.0);
        }
        let part = &mut Part::new(monitor, 0.0, 0.05);
        let equation = MasterEquation::at_with(contacts.clone(), &model.initial, velocity, part)?;
        let tolerance = model.master_equation.tolerance();
        let pull = equation.pull_with(
            super::first_loading_distance(contacts),
            tolerance,
            &mut Part::new(monitor, 0.05, 0.05),
        )?;
        self.pulled.push(pull.critical_stiffness());
        let found = stability(contacts, velocity, block, &mut Part::new(monitor, 0.1, 0.9))?;
        self.sliding.push(found.critical_stiffness);
        if block.is_some() {
            self.rate.push(found.growth_rate);
            self.frequency.push(found.growth_frequency);
        }
        Ok(pull.error_estimate())
    }

    /// The stability at all velocities together; `None` if it was not computed.
    fn stability(&self) -> Option<SlidingStability> {
        let largest = self.sliding.iter().copied().reduce(f64::max)?;
        let unstable = self.rate.iter().filter(|rate| **rate > 0.0).count();
        Some(SlidingStability {
            critical_stiffness_sliding: Extended(largest),
            velocities: self.sliding.len(),
            unstable: (!self.rate.is_empty()).then_some(unstable),
        })
    }
}

/// The closed forms of slow sliding at each velocity; not a number where they do not hold.
#[derive(Default)]
struct Slow {
    creep: Vec<f64>,
    viscous: Vec<f64>,
}

impl Slow {
    fn push(&mut self, contacts: &Contacts, velocity: f64, viscosity: Option<f64>) {
        self.creep.push(creep(contacts, velocity).unwrap_or(f64::NAN));
        self.viscous.push(viscosity.map_or(f64::NAN, |viscosity| viscosity * velocity));
    }
}

/// Force of the ensemble and its standard error after `distance` at a velocity, with contacts numbered from `first`.
fn slide(
    model: &Model,
    contacts: &Contacts,
    (ensemble, first): (&scenario::Ensemble, u64),
    velocity: f64,
    distance: f64,
    monitor: &mut dyn Monitor,
) -> Result<(f64, f64)> {
    let drawn = ensemble.build(contacts.clone(), model.initial.clone())?.numbered_from(first);
    let history = History::new(vec![Piece { velocity, duration: distance / velocity }])?;
    let trace = drawn.follow_with(&history, &[history.duration()], monitor)?;
    Ok((trace.force[0], trace.error[0]))
}
