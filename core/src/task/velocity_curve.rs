//! `[velocity_curve]`: kinetic friction against velocity, at one temperature or several.

use super::accuracy::ForceAccuracy;
use super::settling::Steady;
use super::stability::stability;
use super::summary::{CurveLimits, Extended, Stability, VelocityCurveNumbers};
use super::{Output, ensemble};
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

/// The variables of the task. Where several temperatures are asked for, all but the velocity have the temperature as their first
/// dimension.
const COLUMNS: [Column; 11] = [
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
];

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
    ],
    needed: KINETIC_FRICTION,
}];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    vec![("velocity_curve", Record::declared(&[&COLUMNS]))]
}

const fn of(name: &'static str, long_name: &'static str, quantity: Quantity) -> Column {
    Column::new(name, long_name, quantity, &["velocity"])
}

/// Computes the curve that `task` asks for.
///
/// # Errors
/// What the solvers run into, or the monitor's wish to stop.
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
    // By the master equation, by the ensemble, and whether sliding is stable.
    let jobs = 1.0 + f64::from(u8::from(model.ensemble.is_some()) + u8::from(task.stability));
    for (temperature, contacts) in &curves {
        let limit = Limits::of(contacts, &mut Part::new(monitor, friction.len() as f64 / points, 0.0))?;
        limits.push(CurveLimits::new(*temperature, &limit));
        for &velocity in &velocities {
            let begun = friction.len() as f64;
            let start = |job: f64| (begun + job / jobs) / points;
            let share = 1.0 / (jobs * points);
            let steady =
                Steady::at(contacts, &model.initial, velocity, &mut Part::new(monitor, start(0.0), share))?;
            friction.push(steady.friction);
            accuracy = accuracy.worse(ForceAccuracy::new(model, steady.error, steady.life));
            slow.push(contacts, velocity, limit.viscosity);
            if let Some(ensemble) = &model.ensemble {
                let first = (force.len() * ensemble.size()) as u64;
                let part = &mut Part::new(monitor, start(1.0), share);
                let slid = slide(model, contacts, (ensemble, first), velocity, steady.way, part)?;
                force.push(slid.0);
                error.push(slid.1);
            }
            if task.stability {
                let part = &mut Part::new(monitor, start(jobs - 1.0), share);
                let pulled = critical.push(contacts, model, velocity, part)?;
                accuracy = accuracy.worse(ForceAccuracy::new(model, pulled, steady.life));
            }
            report(monitor, friction.len() as f64 / points)?;
        }
    }
    let numbers = VelocityCurveNumbers { limits, stability: critical.stability() };
    let mut record = Record::default();
    record.add(VELOCITY, velocities);
    let along: &'static [&'static str] =
        if task.temperatures.is_empty() { &["velocity"] } else { &["temperature", "velocity"] };
    if !task.temperatures.is_empty() {
        record.add(TEMPERATURE, task.temperatures.clone());
    }
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
    accuracy.of(model, "the friction force of steady sliding", Output::new(model, numbers, record))
}

/// The contacts of each curve, with the temperature by which it is known.
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

/// The stiffnesses of a slider below which it is unstable.
#[derive(Default)]
struct Critical {
    /// −min F' of a pull from the start.
    pulled: Vec<f64>,
    /// That of steady sliding, by its linear response; 0 where every slider slides steadily, infinite where none does.
    sliding: Vec<f64>,
    /// How fast deviations from steady sliding grow behind a block, if there is one; 0 where they die out.
    rate: Vec<f64>,
    /// Their angular frequency.
    frequency: Vec<f64>,
}

impl Critical {
    /// Adds those at a velocity; the estimated error of the pull, F/(N_c⟨k⟩).
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
            // The same at all velocities.
            self.pulled.push(pulled);
            self.sliding.push(sliding);
            return Ok(0.0);
        }
        let part = &mut Part::new(monitor, 0.0, 0.05);
        let equation = MasterEquation::at(contacts.clone(), &model.initial, velocity, part)?;
        let tolerance = model.master_equation.tolerance();
        let pull =
            equation.pull(super::first_loading(contacts), tolerance, &mut Part::new(monitor, 0.05, 0.05))?;
        self.pulled.push(pull.critical_stiffness());
        let found = stability(contacts, velocity, block, &mut Part::new(monitor, 0.1, 0.9))?;
        self.sliding.push(found.critical_stiffness);
        if block.is_some() {
            self.rate.push(found.growth_rate);
            self.frequency.push(found.growth_frequency);
        }
        Ok(pull.error_estimate())
    }

    /// The stability at all velocities together; `None` where it was not asked for.
    fn stability(&self) -> Option<Stability> {
        let largest = self.sliding.iter().copied().reduce(f64::max)?;
        let unstable = self.rate.iter().filter(|rate| **rate > 0.0).count();
        Some(Stability {
            critical_stiffness_sliding: Extended(largest),
            velocities: self.sliding.len(),
            unstable: (!self.rate.is_empty()).then_some(unstable),
        })
    }
}

/// The closed forms of slow sliding along the velocities; not a number where there are none.
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

/// Force of the ensemble, its contacts numbered from `first` on, and its standard error after a `way` at a velocity.
fn slide(
    model: &Model,
    contacts: &Contacts,
    (ensemble, first): (&scenario::Ensemble, u64),
    velocity: f64,
    way: f64,
    monitor: &mut dyn Monitor,
) -> Result<(f64, f64)> {
    let drawn = ensemble.build(contacts.clone(), model.initial.clone())?.numbered_from(first);
    let history = History::new(vec![Piece { velocity, duration: way / velocity }])?;
    let trace = drawn.follow(&history, &[history.duration()], monitor)?;
    Ok((trace.force[0], trace.error[0]))
}
