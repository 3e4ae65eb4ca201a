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
    let (mut friction, mut slow, mut limits) = (Vec::new(), Slow::default(), Vec::new());
    let (mut force, mut error) = (Vec::new(), Vec::new());
    let mut critical = Critical::default();
    let mut accuracy = ForceAccuracy::new(model, 0.0, model.contacts.thresholds.mean());
    let points = (curves.len() * velocities.len()) as f64;
    let measured = model.compare.as_ref().map_or(0, |curve| curve.points().0.len()) as f64;
    let share = points / (points + measured);
    let within = &mut Part::new(&mut *monitor, 0.0, share);
    // The master equation, the ensemble, and the stability of steady sliding.
    let jobs = 1.0 + f64::from(u8::from(model.ensemble.is_some()) + u8::from(task.stability));
    for (temperature, contacts) in &curves {
        let limit = Limits::of(contacts, &mut Part::new(within, friction.len() as f64 / points, 0.0))?;
        limits.push(CurveLimits::new(*temperature, &limit, model.background));
        for &velocity in &velocities {
            let begun = friction.len() as f64;
            let start = |job: f64| (begun + job / jobs) / points;
            let fraction = 1.0 / (jobs * points);
            let steady = Steady::at(contacts, velocity, &mut Part::new(within, start(0.0), fraction))?;
            friction.push(steady.friction);
            accuracy = accuracy.worse(ForceAccuracy::new(model, steady.error, steady.life));
            slow.push(contacts, velocity, limit.viscosity);
            if let Some(ensemble) = &model.ensemble {
                // Each point has contacts of its own, so that errors of points are independent.
                let first = (force.len() * ensemble.size()) as u64;
                let part = &mut Part::new(within, start(1.0), fraction);
                let slid = slide(model, contacts, (ensemble, first), velocity, steady.distance, part)?;
                force.push(slid.0);
                error.push(slid.1);
            }
            if task.stability {
                let part = &mut Part::new(within, start(jobs - 1.0), fraction);
                let pulled = critical.push(contacts, model, velocity, part)?;
                accuracy = accuracy.worse(ForceAccuracy::new(model, pulled, steady.life));
            }
            report(within, friction.len() as f64 / points)?;
        }
    }
    let mut record = Record::default();
    record.add(VELOCITY, velocities);
    let along: &'static [&'static str] =
        if task.temperatures.is_empty() { &["velocity"] } else { &["temperature", "velocity"] };
    if !task.temperatures.is_empty() {
        record.add(TEMPERATURE, task.temperatures.clone());
    }
    let stability = critical.stability();
    for (column, values) in [
        (CRITICAL_STIFFNESS, critical.pulled),
        (CRITICAL_STIFFNESS_SLIDING, critical.sliding),
        (GROWTH_RATE, critical.rate),
        (GROWTH_FREQUENCY, critical.frequency),
        (KINETIC_FRICTION, friction),
        (ENSEMBLE[0], force),
        (ENSEMBLE[1], error),
        (CREEP_FRICTION, slow.creep),
        (VISCOUS_FRICTION, slow.viscous),
    ] {
        record.add_known(column.along(along), values);
    }
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
