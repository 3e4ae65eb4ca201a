//! A scenario computed: the master equation, the ensemble if asked for, and what both say.

mod chance;
mod distribution;
mod grid;
mod part;

use asperity::law::Atom;
use asperity::master::{MasterEquation, Pull, Relaxation, SteadyState};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::scenario::Scenario;
use asperity::{Error, Result};

use crate::input;
use crate::output::{LARGEST, Outcome};
use crate::summary::{Coefficients, Comparison, Extended, StaticFriction, Summary};
use part::Part;

pub use grid::Grid;

/// Positions evaluated between two reports to the monitor.
const ROUND: usize = 1024;
/// Variables along the positions, at most.
const COLUMNS: usize = 6;

/// Computes `scenario`.
///
/// # Errors
/// A value that makes no sense, results too large for one file, or the monitor's wish to stop.
pub fn run(scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<Outcome> {
    let (contacts, initial) = scenario.build()?;
    let grid = Grid::new(&contacts, &initial, &scenario.pull.snapshots);
    fits(scenario, &grid)?;
    let equation = MasterEquation::new(contacts.clone(), &initial)?;
    let master = if scenario.ensemble.is_some() { 0.5 } else { 1.0 };
    let tolerance = scenario.master_equation.tolerance;
    let pull =
        equation.pull(scenario.pull.distance, tolerance, &mut Part::new(monitor, 0.0, 0.6 * master))?;
    let mut record = Record::default();
    let part = &mut Part::new(monitor, 0.6 * master, 0.4 * master);
    along_the_pull(&pull, scenario.pull.positions(), sample(scenario), &mut record, part)?;
    let compare = compared(scenario, &pull, &mut record);
    distribution::evolving(scenario, &pull, &grid, &mut record);
    let (steady, relaxation) = (equation.steady_state(), equation.relaxation());
    distribution::steady(&contacts, &steady, &grid, &mut record);
    if let Some(ensemble) = &scenario.ensemble {
        let model = chance::model(ensemble, contacts.clone(), initial)?;
        let pulled = chance::Pulled {
            scenario,
            grid: &grid,
            mean: contacts.thresholds.mean(),
            memory: relaxation.length(),
        };
        pulled.record(&model, &mut record, &mut Part::new(monitor, master, 1.0 - master))?;
    }
    let summary = summary(scenario, &steady, &relaxation, &pull, compare);
    Ok(Outcome { scenario: input::to_text(scenario), summary, record })
}

/// Refuses before any work what could not be written after it.
fn fits(scenario: &Scenario, grid: &Grid) -> Result<()> {
    let pull = &scenario.pull;
    let densities = (pull.snapshots.len() + 3) * grid.stretches.len();
    let bins = scenario.ensemble.as_ref().map_or(0, |ensemble| grid.bins(ensemble.size));
    let histograms = (pull.snapshots.len() + 1) * bins;
    let needed = ((pull.points * COLUMNS + densities + histograms) * size_of::<f64>()) as u64;
    if needed <= LARGEST {
        return Ok(());
    }
    let what = format!("a result file of {} points and {} snapshots", pull.points, pull.snapshots.len());
    Err(Error::TooLarge { what, needed, allowed: LARGEST })
}

/// Number of contacts that the force's scatter is shown for.
fn sample(scenario: &Scenario) -> Option<f64> {
    let counted = Some(scenario.contacts.count).filter(|&count| count > 1.0);
    scenario.ensemble.as_ref().map(|ensemble| ensemble.size as f64).or(counted)
}

/// Adds force and breaking rate at `positions` to `record`, the scatter of the force of `sample` contacts, and the
/// positions at which contacts break together.
///
/// # Errors
/// The monitor's wish to stop.
pub fn along_the_pull(
    pull: &Pull,
    positions: Vec<f64>,
    sample: Option<f64>,
    record: &mut Record,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    let mut evaluate = |done: f64, function: &dyn Fn(f64) -> f64| -> Result<Vec<f64>> {
        let mut values = Vec::with_capacity(positions.len());
        for round in positions.chunks(ROUND) {
            values.extend(round.iter().map(|&x| function(x)));
            part::report(monitor, (done + values.len() as f64 / positions.len() as f64) / 3.0)?;
        }
        Ok(values)
    };
    let force = evaluate(0.0, &|x| pull.force(x))?;
    let rate = evaluate(1.0, &|x| pull.breaking_rate(x))?;
    let std = sample.map(|size| evaluate(2.0, &|x| pull.force_std(x, size))).transpose()?;
    let along = &["position"];
    record.push("position", "position X of the slider's bottom", Quantity::Length, along, positions);
    record.push("force", "friction force", Quantity::Force, along, force);
    let words = "fraction of contacts breaking per length, without those that break together";
    record.push("breaking_rate", words, Quantity::PerLength, along, rate);
    if let Some(std) = std {
        let words = "standard deviation of the force of a finite number of contacts";
        record.push("force_std", words, Quantity::Force, along, std);
    }
    let places = [("position", "position at which contacts break together")];
    atoms(record, "breaking_atom", places, pull.breaking_atoms().iter().map(|a| ([a.position], a.weight)));
    Ok(())
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

fn compared(scenario: &Scenario, pull: &Pull, record: &mut Record) -> Option<Comparison> {
    let (positions, forces) = scenario.compare.as_ref()?.points();
    let within = |x: &f64| (0.0..=scenario.pull.distance).contains(x);
    let residuals = positions.iter().zip(forces).filter(|(x, _)| within(x)).map(|(&x, f)| f - pull.force(x));
    let (points, squares) = residuals.fold((0, 0.0), |(n, sum), r| (n + 1, sum + r * r));
    let along = &["compared"];
    record.push("compared_position", "measured position", Quantity::Length, along, positions.to_vec());
    record.push("compared_force", "measured force", Quantity::Force, along, forces.to_vec());
    Some(Comparison { points, residual_rms: (points > 0).then(|| (squares / points as f64).sqrt()) })
}

fn summary(
    scenario: &Scenario,
    steady: &SteadyState,
    relaxation: &Relaxation,
    pull: &Pull,
    compare: Option<Comparison>,
) -> Summary {
    let kinetic_friction = steady.kinetic_friction();
    let peak = pull.static_friction();
    let coefficients = |normal_load: f64| Coefficients {
        normal_load,
        at_rest: peak.map(|peak| peak.value / normal_load),
        kinetic: kinetic_friction / normal_load,
    };
    Summary {
        title: scenario.title.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        units: scenario.units.clone(),
        static_friction: peak.map_or(StaticFriction::NotReached, |peak| StaticFriction::Reached {
            force: peak.value,
            position: peak.position,
        }),
        kinetic_friction,
        relaxation_length: Extended(relaxation.length()),
        relaxation_length_paper: Extended(relaxation.paper_estimate()),
        critical_stiffness: Extended(pull.critical_stiffness()),
        accuracy: pull.error_estimate(),
        contacts: scenario.contacts.count,
        sample: sample(scenario),
        seed: scenario.ensemble.as_ref().map(|ensemble| ensemble.seed),
        disorder: scenario.ensemble.as_ref().map(|ensemble| ensemble.disorder),
        friction_coefficients: scenario.contacts.normal_load.map(coefficients),
        compare,
    }
}
