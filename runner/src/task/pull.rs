//! `[pull]`: force, breaking rate and distributions as the bottom of the slider is moved.

use asperity::master::{MasterEquation, Pull};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::scenario::{self, Scenario};
use asperity::{Error, Result};

use super::accuracy::Accuracy;
use super::grid::Grid;
use super::part::{self, Part};
use super::{Setting, atoms, chance, compare, distribution, sample};
use crate::output::LARGEST;
use crate::summary::Summary;

/// Positions evaluated between two reports to the monitor.
const ROUND: usize = 1024;
/// Variables along the positions, at most.
const COLUMNS: usize = 6;

/// The part of the work that the lives of contacts at a velocity take.
const LIVES: f64 = 0.5;

/// Pulls the slider as `task` says.
///
/// # Errors
/// Results too large for one file, or the monitor's wish to stop.
pub fn run(
    setting: &Setting<'_>,
    task: &scenario::Pull,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let Setting { scenario, contacts, initial, .. } = setting;
    fits(scenario, task, None)?;
    let solved = if contacts.rules.are_time_dependent() { LIVES } else { 0.0 };
    let part = &mut Part::new(monitor, 0.0, solved);
    let equation = match task.velocity {
        Some(velocity) => MasterEquation::at(contacts.clone(), initial, velocity, part)?,
        None => MasterEquation::new(contacts.clone(), initial, part)?,
    };
    let monitor = &mut Part::new(monitor, solved, 1.0 - solved);
    let grid = Grid::new(&equation, initial, &task.snapshots);
    fits(scenario, task, Some(&grid))?;
    let master = if scenario.ensemble.is_some() { 0.5 } else { 1.0 };
    let tolerance = scenario.master_equation.tolerance();
    let pull = equation.pull(task.distance, tolerance, &mut Part::new(monitor, 0.0, 0.6 * master))?;
    let mut record = Record::default();
    let part = &mut Part::new(monitor, 0.6 * master, 0.4 * master);
    along_the_pull(&pull, task.positions(), sample(scenario), &mut record, part)?;
    let compare = compare(scenario, pull.distance(), |x| pull.force(x), &mut record);
    let aside = &mut Part::new(monitor, master, 0.0);
    distribution::evolving(task, &pull, &grid, &mut record, aside)?;
    let (steady, relaxation) = (equation.steady_state(), equation.relaxation(aside)?);
    distribution::steady(contacts, &steady, &grid, &mut record, aside)?;
    if let Some(ensemble) = &scenario.ensemble {
        let model = ensemble.build(contacts.clone(), initial.clone())?;
        let pulled = chance::Pulled {
            task,
            grid: &grid,
            mean: contacts.thresholds.mean(),
            memory: relaxation.length(),
        };
        pulled.record(&model, &mut record, &mut Part::new(monitor, master, 1.0 - master))?;
    }
    let summary = Summary { compare, ..setting.summary(&steady, &relaxation, &pull) };
    let accuracy = Accuracy::new(setting, pull.error_estimate(), steady.mean_life());
    Ok((accuracy.told(setting, "the force on a pull", summary)?, record))
}

/// Refuses before any work what could not be written after it; the grid is known once there is an equation.
fn fits(scenario: &Scenario, pull: &scenario::Pull, grid: Option<&Grid>) -> Result<()> {
    let densities = (pull.snapshots.len() + 3) * grid.map_or(0, |grid| grid.stretches.len());
    let bins = grid.zip(scenario.ensemble.as_ref()).map_or(0, |(grid, ensemble)| grid.bins(ensemble.size()));
    let histograms = (pull.snapshots.len() + 1) * bins;
    let needed = ((pull.points * COLUMNS + densities + histograms) * size_of::<f64>()) as u64;
    if needed <= LARGEST {
        return Ok(());
    }
    let what = format!("a result file of {} points and {} snapshots", pull.points, pull.snapshots.len());
    Err(Error::TooLarge { key: "pull.points".into(), what, needed, allowed: LARGEST })
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
    let aside = &mut Part::new(monitor, 0.0, 0.0);
    let std = sample.map(|size| pull.force_std(size, aside)).transpose()?;
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
    let std = std.map(|std| evaluate(2.0, &std)).transpose()?;
    let along = &["position"];
    record.push("position", "position X of the slider's base", Quantity::Length, along, positions);
    record.push("force", "friction force", Quantity::Force, along, force);
    let words = "fraction of contacts breaking per length, without simultaneous breaks";
    record.push("breaking_rate", words, Quantity::PerLength, along, rate);
    if let Some(std) = std {
        let words = "standard deviation of the force of a finite number of contacts";
        record.push("force_std", words, Quantity::Force, along, std);
    }
    let places = [("position", "position at which contacts break simultaneously")];
    atoms(record, "breaking_atom", places, pull.breaking_atoms().iter().map(|a| ([a.position], a.weight)));
    Ok(())
}
