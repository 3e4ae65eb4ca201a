//! `[velocity_curve]`: kinetic friction against velocity, at one temperature or several.

use asperity::contacts::{Contacts, Rules, Temperature};
use asperity::history::{History, Piece};
use asperity::master::{Limits, MasterEquation, creep};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::{Result, scenario};

use super::Setting;
use super::accuracy::Accuracy;
use super::part::{self, Part};
use super::settling::Steady;
use super::stability::stability;
use crate::summary::{CurveLimits, Extended, Stability, Summary};

/// Computes the curve that `task` asks for.
///
/// # Errors
/// What the solvers run into, or the monitor's wish to stop.
pub fn run(
    setting: &Setting<'_>,
    task: &scenario::VelocityCurve,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let velocities = task.velocities();
    let curves = curves(setting, task);
    let (mut friction, mut slow, mut limits) = (Vec::new(), Slow::default(), Vec::new());
    let (mut force, mut error) = (Vec::new(), Vec::new());
    let mut critical = Critical::default();
    let mut accuracy = Accuracy::new(setting, 0.0, setting.contacts.thresholds.mean());
    let points = (curves.len() * velocities.len()) as f64;
    // By the master equation, by the ensemble, and whether sliding is stable.
    let jobs = 1.0 + f64::from(u8::from(setting.scenario.ensemble.is_some()) + u8::from(task.stability));
    for (temperature, contacts) in &curves {
        let limit = Limits::of(contacts, &mut Part::new(monitor, friction.len() as f64 / points, 0.0))?;
        limits.push(CurveLimits::new(*temperature, &limit));
        for &velocity in &velocities {
            let begun = friction.len() as f64;
            let start = |job: f64| (begun + job / jobs) / points;
            let share = 1.0 / (jobs * points);
            let steady =
                Steady::at(contacts, &setting.initial, velocity, &mut Part::new(monitor, start(0.0), share))?;
            friction.push(steady.friction);
            accuracy = accuracy.worse(Accuracy::new(setting, steady.error, steady.life));
            slow.push(contacts, velocity, limit.viscosity);
            if let Some(ensemble) = &setting.scenario.ensemble {
                let first = (force.len() * ensemble.size()) as u64;
                let part = &mut Part::new(monitor, start(1.0), share);
                let slid = slide(setting, contacts, (ensemble, first), velocity, steady.way, part)?;
                force.push(slid.0);
                error.push(slid.1);
            }
            if task.stability {
                let part = &mut Part::new(monitor, start(jobs - 1.0), share);
                let pulled = critical.push(contacts, setting, velocity, part)?;
                accuracy = accuracy.worse(Accuracy::new(setting, pulled, steady.life));
            }
            part::report(monitor, friction.len() as f64 / points)?;
        }
    }
    let mut record = Record::default();
    record.push("velocity", "velocity of the slider", Quantity::Velocity, &["velocity"], velocities);
    let along: &[&str] =
        if task.temperatures.is_empty() { &["velocity"] } else { &["temperature", "velocity"] };
    if !task.temperatures.is_empty() {
        let energies = task.temperatures.clone();
        record.push("temperature", "temperature T, an energy", Quantity::Energy, &["temperature"], energies);
    }
    let mut known = |name, words, quantity, values: Vec<f64>| {
        if values.iter().any(|v| !v.is_nan()) {
            record.push(name, words, quantity, along, values);
        }
    };
    let stability = critical.told();
    let words = ["critical stiffness of the first loading", "critical stiffness of steady sliding"];
    known("critical_stiffness", words[0], Quantity::Stiffness, critical.pulled);
    known("critical_stiffness_sliding", words[1], Quantity::Stiffness, critical.sliding);
    let words = ["rate at which deviations from steady sliding grow", "angular frequency at which they grow"];
    known("growth_rate", words[0], Quantity::PerTime, critical.rate);
    known("growth_frequency", words[1], Quantity::PerTime, critical.frequency);
    let mut add = |name, words, values| known(name, words, Quantity::Force, values);
    add("kinetic_friction", "friction force of steady sliding", friction);
    add("ensemble_force", "friction force of the ensemble in steady sliding", force);
    add("ensemble_error", "its standard error", error);
    add("creep_friction", "friction force by the law of slow creep, where it holds", slow.creep);
    add("viscous_friction", "friction force of viscous flow, the limit of low velocities", slow.viscous);
    let summary = Summary { limits, stability, ..setting.heading() };
    Ok((accuracy.told(setting, "the friction force of steady sliding", summary)?, record))
}

/// The contacts of each curve, with the temperature by which it is known.
fn curves(setting: &Setting<'_>, task: &scenario::VelocityCurve) -> Vec<(Option<f64>, Contacts)> {
    let contacts = &setting.contacts;
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
        setting: &Setting<'_>,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<f64> {
        let block = setting.scenario.block.as_ref();
        if let (false, None, Some(&pulled), Some(&sliding)) =
            (contacts.rules.are_time_dependent(), block, self.pulled.last(), self.sliding.last())
        {
            // The same at all velocities.
            self.pulled.push(pulled);
            self.sliding.push(sliding);
            return Ok(0.0);
        }
        let part = &mut Part::new(monitor, 0.0, 0.05);
        let equation = MasterEquation::at(contacts.clone(), &setting.initial, velocity, part)?;
        let tolerance = setting.scenario.master_equation.tolerance();
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

    /// What is told of all velocities together; nothing where it was not asked for.
    fn told(&self) -> Option<Stability> {
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
    setting: &Setting<'_>,
    contacts: &Contacts,
    (ensemble, first): (&scenario::Ensemble, u64),
    velocity: f64,
    way: f64,
    monitor: &mut dyn Monitor,
) -> Result<(f64, f64)> {
    let model = ensemble.build(contacts.clone(), setting.initial.clone())?.numbered_from(first);
    let history = History::new(vec![Piece { velocity, duration: way / velocity }])?;
    let trace = model.follow(&history, &[history.duration()], monitor)?;
    Ok((trace.force[0], trace.error[0]))
}
