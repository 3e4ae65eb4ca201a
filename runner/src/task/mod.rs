//! A scenario computed: the master equation, the ensemble if asked for, and what both say.

mod accuracy;
mod chance;
mod distribution;
mod drive;
mod grid;
mod hold_curve;
mod in_time;
pub mod interface;
mod part;
mod protocol;
mod pull;
mod renormalisation;
mod settling;
pub mod sliding;
mod stability;
mod velocity_curve;

use asperity::Result;
use asperity::contacts::{Contacts, Initial};
use asperity::law::Atom;
use asperity::master::{Pull, Relaxation, SteadyState};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::scenario::{Scenario, Task};

use crate::checkpoint::Checkpoints;
use crate::input;
use crate::output::Outcome;
use crate::summary::{Coefficients, Comparison, Extended, Friction, StaticFriction, Summary};

pub use drive::first_loading;
pub use grid::Grid;
pub use in_time::tolerance_over;
pub use interface::cells_in_time;
pub use pull::along_the_pull;
pub use stability::{LinearStability, stability};

/// Computes `scenario`.
///
/// # Errors
/// A value that makes no sense, results too large for one file, or the monitor's wish to stop.
pub fn run(scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<Outcome> {
    run_with(scenario, None, monitor)
}

/// The same, going on from the last of `checkpoints` and keeping new ones. Only `[drive]` of an `[interface]` has any.
///
/// # Errors
/// As [`run`]; a stop, too, where a checkpoint could not be written or taken up ([`Checkpoints::failure`]).
pub fn run_with(
    scenario: &Scenario,
    checkpoints: Option<&mut Checkpoints>,
    monitor: &mut dyn Monitor,
) -> Result<Outcome> {
    let (contacts, initial) = scenario.build()?;
    if let Some(interface) = &scenario.interface {
        let with_error = scenario.master_equation.tolerance.is_some();
        interface.fits(&contacts, scenario.ensemble.as_ref(), with_error, monitor.memory())?;
    }
    let setting = Setting { scenario, contacts, initial };
    let (summary, record) = match scenario.task()? {
        Task::Pull(task) => pull::run(&setting, task, monitor)?,
        Task::Drive(task) => match &scenario.interface {
            Some(interface) => interface::run(&setting, task, interface, checkpoints, monitor)?,
            None => drive::run(&setting, task, monitor)?,
        },
        Task::Protocol(task) => protocol::run(&setting, task, monitor)?,
        Task::VelocityCurve(task) => velocity_curve::run(&setting, task, monitor)?,
        Task::HoldCurve(task) => hold_curve::run(&setting, task, monitor)?,
        Task::Renormalisation(task) => renormalisation::run(&setting, task, monitor)?,
    };
    Ok(Outcome { scenario: input::to_text(scenario), summary, record })
}

/// What a task is computed for.
struct Setting<'a> {
    scenario: &'a Scenario,
    contacts: Contacts,
    initial: Initial,
}

impl Setting<'_> {
    /// What a pull and steady sliding say of the interface.
    fn summary(&self, steady: &SteadyState, relaxation: &Relaxation, pull: &Pull) -> Summary {
        let kinetic_friction = steady.kinetic_friction();
        let peak = pull.static_friction();
        let coefficients = |normal_load: f64| Coefficients {
            normal_load,
            at_rest: peak.map(|peak| peak.value / normal_load),
            kinetic: kinetic_friction / normal_load,
        };
        let friction = Friction {
            static_friction: peak.map_or(StaticFriction::NotReached, |peak| StaticFriction::Reached {
                force: peak.value,
                position: peak.position,
            }),
            kinetic_friction,
            relaxation_length: Extended(relaxation.length()),
            relaxation_length_paper: Extended(relaxation.paper_estimate()),
            critical_stiffness: Extended(pull.critical_stiffness()),
        };
        let friction_coefficients = self.scenario.contacts.normal_load.map(coefficients);
        Summary { friction: Some(friction), friction_coefficients, ..self.heading() }
    }

    /// What is said whatever the task.
    fn heading(&self) -> Summary {
        let scenario = self.scenario;
        Summary {
            title: scenario.title.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            units: scenario.units.clone(),
            friction: None,
            accuracy: None,
            contacts: scenario.contacts.count,
            sample: sample(scenario),
            seed: scenario.ensemble.as_ref().map(|ensemble| ensemble.seed),
            disorder: scenario.ensemble.as_ref().map(|ensemble| ensemble.disorder),
            friction_coefficients: None,
            sliding: None,
            steps: Vec::new(),
            force_error: None,
            limits: Vec::new(),
            stability: None,
            hold_curve: None,
            renormalisation: None,
            catalogue: None,
            compare: None,
            warnings: scenario.warnings(),
        }
    }
}

/// Number of contacts that the force's scatter is shown for.
fn sample(scenario: &Scenario) -> Option<f64> {
    let counted = Some(scenario.contacts.count).filter(|&count| count > 1.0);
    scenario.ensemble.as_ref().map(|ensemble| ensemble.size() as f64).or(counted)
}

/// Adds the measured curve, if there is one, and says how far it is from the computed `force`, known up to X = `end`.
fn compare(
    scenario: &Scenario,
    end: f64,
    force: impl Fn(f64) -> f64,
    record: &mut Record,
) -> Option<Comparison> {
    let (positions, forces) = scenario.compare.as_ref()?.points();
    let within = |x: &f64| (0.0..=end).contains(x);
    let residuals = positions.iter().zip(forces).filter(|(x, _)| within(x)).map(|(&x, f)| f - force(x));
    let (points, squares) = residuals.fold((0, 0.0), |(n, sum), r| (n + 1, sum + r * r));
    let along = &["compared"];
    record.push("compared_position", "measured position", Quantity::Length, along, positions.to_vec());
    record.push("compared_force", "measured force", Quantity::Force, along, forces.to_vec());
    Some(Comparison { points, residual_rms: (points > 0).then(|| (squares / points as f64).sqrt()) })
}

/// Lists point masses along `dimension`: what places them, and their weights. Nothing where there are none.
fn atoms<const N: usize>(
    record: &mut Record,
    dimension: &str,
    places: [(&str, &str); N],
    masses: impl Iterator<Item = ([f64; N], f64)>,
) {
    let (at, weights): (Vec<[f64; N]>, Vec<f64>) = masses.unzip();
    if weights.is_empty() {
        return;
    }
    for (i, (name, words)) in places.into_iter().enumerate() {
        let values = at.iter().map(|place| place[i]).collect();
        record.push(&format!("{dimension}_{name}"), words, Quantity::Length, &[dimension], values);
    }
    record.push(
        &format!("{dimension}_weight"),
        "fraction of contacts",
        Quantity::Number,
        &[dimension],
        weights,
    );
}

/// A point mass as [`atoms`] takes it.
fn placed(atom: &Atom) -> ([f64; 1], f64) {
    ([atom.position], atom.weight)
}
