//! `[creep]`: slip under a constant force, and the time to failure.

use super::Output;
use super::accuracy::{ForceAccuracy, as_required};
use super::background::coefficient;
use super::summary::{CreepAtForce, CreepNumbers};
use crate::block::{CreepAccuracy, CreepLoad, CreepPath};
use crate::contacts::{Ageing, Contacts};
use crate::master::Transport;
use crate::monitor::{Monitor, Part};
use crate::rate_dependent::{ROUGH, RateDependentContacts as _};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, Model};
use crate::{Error, Result};

/// Time of loading at once, in times in which contacts change: fewer than one contact in 1e9 breaks by temperature.
const AT_ONCE: f64 = 1e-9;
/// Fraction of the work of the solution with a larger tolerance.
const ASIDE: f64 = 0.2;
/// Largest error of the slip, relative to it, of which nothing is said.
const SLIP_ERROR: f64 = 0.05;

const FORCES: &[&str] = &["imposed_force"];
const CURVE: &[&str] = &["imposed_force", "creep_fraction"];

const FORCE: Column = Column::new("imposed_force", "constant force on the slider", Quantity::Force, FORCES);
const FAILURE_TIME: Column =
    Column::new("failure_time", "time to failure, if it is within the duration", Quantity::Time, FORCES);
const FAILURE_ERROR: Column =
    Column::new("failure_time_error", "estimated error of the time to failure", Quantity::Time, FORCES);
const LOADED: Column =
    Column::new("loaded_position", "position at the end of loading", Quantity::Length, FORCES);
const FINAL: Column =
    Column::new("final_position", "position at failure, or at the end", Quantity::Length, FORCES);
const FINAL_VELOCITY: Column = Column::new(
    "final_velocity",
    "velocity at the end, if the slider does not fail",
    Quantity::Velocity,
    FORCES,
);
const SLOWEST: Column = Column::new(
    "slowest_velocity",
    "lowest velocity after loading, that of secondary creep if failure follows",
    Quantity::Velocity,
    FORCES,
);
const SLOWEST_TIME: Column =
    Column::new("slowest_time", "time of the lowest velocity after loading", Quantity::Time, FORCES);
const FRACTION: Column = Column::new(
    "creep_fraction",
    "slip since the end of loading as a fraction of that at the end",
    Quantity::Number,
    &["creep_fraction"],
);
const TIME: Column = Column::new("creep_time", "time since the start", Quantity::Time, CURVE);
const POSITION: Column = Column::new("creep_position", "position of the slider", Quantity::Length, CURVE);
const VELOCITY: Column = Column::new("creep_velocity", "velocity of the slider", Quantity::Velocity, CURVE);
const FRICTION_COEFFICIENT: Column = coefficient(FORCES);

/// The variables of the task.
const COLUMNS: [Column; 13] = [
    FORCE,
    FAILURE_TIME,
    FAILURE_ERROR,
    LOADED,
    FINAL,
    FINAL_VELOCITY,
    SLOWEST,
    SLOWEST_TIME,
    FRACTION,
    TIME,
    POSITION,
    VELOCITY,
    FRICTION_COEFFICIENT,
];

/// Its tables in CSV.
pub(super) const TABLES: &[CsvTable] = &[
    CsvTable {
        file: "static_fatigue.csv",
        columns: &[
            FORCE,
            FAILURE_TIME,
            FAILURE_ERROR,
            LOADED,
            FINAL,
            FINAL_VELOCITY,
            SLOWEST,
            SLOWEST_TIME,
            FRICTION_COEFFICIENT,
        ],
        needed: FINAL,
    },
    CsvTable { file: "creep_curve.csv", columns: &[FORCE, FRACTION, TIME, POSITION, VELOCITY], needed: TIME },
];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    vec![("creep", Record::declared(&[&COLUMNS]))]
}

/// Computes the creep that `task` describes.
///
/// # Errors
/// Forces below that of the contacts at the start; errors of the solvers, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &scenario::Creep,
    monitor: &mut dyn Monitor,
) -> Result<Output<CreepNumbers>> {
    let default = Transport::default_tolerance(&model.contacts.rules).max(CreepAccuracy::LARGEST_TOLERANCE);
    let tolerance = model.master_equation.tolerance.unwrap_or(default).min(Transport::LARGEST_TOLERANCE);
    let (found, accuracy) = as_required(model, tolerance, monitor, |tolerance, monitor| {
        let found = crept(model, task, tolerance, monitor)?;
        let error = found.iter().map(|found| found.error).fold(0.0, f64::max);
        Ok((found, ForceAccuracy { error, life: model.contacts.thresholds.mean(), aim: None }))
    })?;
    let creep: Vec<CreepAtForce> =
        task.forces.iter().zip(&found).map(|(&force, at)| at.numbers(force)).collect();
    let mut record = Record::default();
    add_failures(&creep, &mut record);
    add_curves(&found, task.points, &mut record);
    model.add_coefficient(FORCE.name, &mut record);
    let mut output =
        accuracy.of(model, "the creep curve", Output::new(model, CreepNumbers { creep }, record))?;
    output.warnings.extend(found.iter().zip(&task.forces).filter_map(|(found, &force)| found.warning(force)));
    Ok(output)
}

/// The motion of the slider under each force.
fn crept(
    model: &Model,
    task: &scenario::Creep,
    tolerance: f64,
    monitor: &mut dyn Monitor,
) -> Result<Vec<CreepFound>> {
    let aside = &mut Part::new(monitor, 0.0, 0.0);
    let contacts = Transport::new_with(model.contacts.clone(), &model.initial, tolerance, aside)?;
    let least = contacts.force() + model.background;
    let share = 1.0 / task.forces.len() as f64;
    let each = task.forces.iter().enumerate().map(|(i, &force)| {
        // Friction at the start is known to the tolerance only.
        if force < least - tolerance * contacts.unit() {
            let expected = format!("a force of at least {least}, that of friction at the start");
            return Err(Error::invalid(format!("creep.forces.{i}"), expected, force));
        }
        let gain = (force - least).max(0.0);
        let at_once = gain / (AT_ONCE * fastest(&model.contacts, task.duration));
        // A force that friction carries from the start has nothing to be raised by.
        let rate = task.loading_rate.unwrap_or(if gain > 0.0 { at_once } else { 1.0 });
        let load = CreepLoad { force: contacts.force() + gain, rate, duration: task.duration };
        let part = &mut Part::new(monitor, i as f64 * share, share);
        CreepFound::of(&contacts, load, tolerance, part)
            .map(|found| found.raised(task.loading_rate.is_none()))
    });
    each.collect()
}

/// The shortest time in which contacts change, or that of the motion.
fn fastest(contacts: &Contacts, duration: f64) -> f64 {
    let mean = contacts.thresholds.mean();
    let activated = contacts.rules.temperature.map(|rule| 1.0 / rule.attempt_rate);
    let aged = contacts.rules.ageing.as_ref().map(|rule| match rule {
        Ageing::Smoluchowski { diffusion, .. } | Ageing::MeanField { diffusion, .. } => {
            mean * mean / diffusion
        }
        Ageing::FrozenRank { time, .. } | Ageing::Logarithmic { time, .. } => *time,
    });
    [activated, aged].into_iter().flatten().fold(duration, f64::min)
}

/// The motion of the slider under a force.
struct CreepFound {
    path: CreepPath,
    /// Whether it fails at once.
    fails_at_once: bool,
    /// Estimated error as a length.
    error: f64,
    /// Estimated error of the time to failure.
    failure_error: Option<f64>,
}

impl CreepFound {
    /// The motion by two tolerances, and the error by their difference.
    fn of(contacts: &Transport, load: CreepLoad, tolerance: f64, monitor: &mut dyn Monitor) -> Result<Self> {
        let unit = contacts.unit() / contacts.stiffness();
        let accuracy = CreepAccuracy { unit, tolerance: tolerance.min(CreepAccuracy::LARGEST_TOLERANCE) };
        let rough = match contacts.rough() {
            Some(rough) => {
                let accuracy = CreepAccuracy { tolerance: ROUGH * accuracy.tolerance, ..accuracy };
                // The force that it has at the start is less accurate, too.
                let load = CreepLoad { force: load.force.max(rough.force()), ..load };
                Some(load.follow(rough.as_ref(), accuracy, &mut Part::new(monitor, 0.0, ASIDE))?)
            }
            None => None,
        };
        let path = load.follow(contacts, accuracy, &mut Part::new(monitor, ASIDE, 1.0 - ASIDE))?;
        let error = rough.as_ref().map_or(0.0, |rough| path.difference(rough, unit));
        let error = error.max(accuracy.of_short_slips());
        let failures = path.failure_time().zip(rough.and_then(|rough| rough.failure_time()));
        let failure_error = failures.map(|(fine, rough)| (fine - rough).abs());
        Ok(Self { path, fails_at_once: false, error, failure_error })
    }

    /// The same with a force that was raised `at_once` or at a rate.
    fn raised(mut self, at_once: bool) -> Self {
        self.fails_at_once = at_once && self.path.fails_in_loading();
        self
    }

    /// A warning if the slip is not known well, which a smaller tolerance would mend.
    fn warning(&self, force: f64) -> Option<String> {
        let path = &self.path;
        let slip = path.last().position - path.states[path.loaded].position;
        (!path.fails && self.error > SLIP_ERROR * slip).then(|| {
            format!(
                "the slip under F = {force} is {slip:.1e}, and its estimated error {:.0e}: a smaller \
                 master_equation.tolerance makes slip and velocity more accurate",
                self.error
            )
        })
    }

    fn numbers(&self, force: f64) -> CreepAtForce {
        let path = &self.path;
        let slowest = (!path.fails_in_loading()).then(|| path.slowest());
        let at_once = self.fails_at_once.then_some(0.0);
        CreepAtForce {
            force,
            failure_time: at_once.or_else(|| path.failure_time()),
            failure_time_error: at_once.or(self.failure_error),
            loaded_position: path.states[path.loaded].position,
            final_position: path.last().position,
            final_velocity: (!path.fails).then(|| path.last().velocity()),
            slowest_velocity: slowest.map(|state| state.velocity()),
            slowest_time: slowest.map(|state| state.time),
        }
    }
}

fn add_failures(creep: &[CreepAtForce], record: &mut Record) {
    let column = |of: &dyn Fn(&CreepAtForce) -> Option<f64>| -> Vec<f64> {
        creep.iter().map(|at| of(at).unwrap_or(f64::NAN)).collect()
    };
    record.add(FORCE, column(&|at| Some(at.force)));
    record.add_known(FAILURE_TIME, column(&|at| at.failure_time));
    record.add_known(FAILURE_ERROR, column(&|at| at.failure_time_error));
    record.add(LOADED, column(&|at| Some(at.loaded_position)));
    record.add(FINAL, column(&|at| Some(at.final_position)));
    record.add_known(FINAL_VELOCITY, column(&|at| at.final_velocity));
    record.add_known(SLOWEST, column(&|at| at.slowest_velocity));
    record.add_known(SLOWEST_TIME, column(&|at| at.slowest_time));
}

/// Adds the creep curves; a slider that fails during loading has none.
fn add_curves(found: &[CreepFound], points: usize, record: &mut Record) {
    let fractions: Vec<f64> = (0..points).map(|i| i as f64 / (points - 1) as f64).collect();
    let mut curves: [Vec<f64>; 3] = Default::default();
    for at in found {
        for &fraction in &fractions {
            let state = at.path.at_fraction(fraction);
            let values = state.map_or([f64::NAN; 3], |state| [state.time, state.position, state.velocity()]);
            curves.iter_mut().zip(values).for_each(|(curve, value)| curve.push(value));
        }
    }
    record.add(FRACTION, fractions);
    for (column, curve) in [TIME, POSITION, VELOCITY].into_iter().zip(curves) {
        record.add_known(column, curve);
    }
}
