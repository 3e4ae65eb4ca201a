//! `[drive]`: the slider's top is moved, or a force imposed, and its bottom follows.

use asperity::block::{Curve, Loading, StickSlip};
use asperity::contacts::Contacts;
use asperity::master::MasterEquation;
use asperity::monitor::{Aside, Monitor};
use asperity::population::Population;
use asperity::record::{Quantity, Record};
use asperity::scenario;
use asperity::{Error, Result};

use super::accuracy::{Accuracy, stiffness};
use super::part::Part;
use super::sliding::{self, adopt};
use super::{Setting, in_time};
use crate::output::LARGEST;
use crate::summary::{Sliding, Summary};

/// Mean thresholds that the first loading is followed for.
const LOADING: f64 = 5.0;
/// Points of the curves of equilibria and of the potential.
const FINE: usize = 2001;
/// Drives at which the potential is given, in units of that of the first slip.
const POTENTIALS: [f64; 3] = [0.9, 1.0, 1.1];
/// Columns of a trace.
const COLUMNS: usize = 4;

/// Drives the slider as `task` says.
///
/// # Errors
/// Results too large for one file, what the solvers run into, or the monitor's wish to stop.
pub fn run(
    setting: &Setting<'_>,
    task: &scenario::Drive,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let Setting { scenario, contacts, initial } = setting;
    if contacts.rules.are_time_dependent() {
        return at_a_velocity(setting, &task.forward()?, monitor);
    }
    fits(task, scenario.ensemble.is_some())?;
    let build = |ensemble: &scenario::Ensemble| ensemble.build(contacts.clone(), initial.clone());
    let ensemble = scenario.ensemble.as_ref().map(build).transpose()?;
    ensemble.as_ref().map_or(Ok(()), |ensemble| ensemble.population_fits(monitor.memory()))?;
    let equation = MasterEquation::new(contacts.clone(), initial, &mut Part::new(monitor, 0.0, 0.0))?;
    let tolerance = scenario.master_equation.tolerance();
    let loading = first_loading(contacts);
    let reach = task.turns().iter().fold(loading, |far, turn| far.max(*turn));
    let shares = if scenario.ensemble.is_some() { [0.05, 0.25] } else { [0.1, 0.9] };
    let pull = equation.pull(reach, tolerance, &mut Part::new(monitor, 0.0, shares[0]))?;
    let mut population = equation.population(tolerance, &mut Part::new(monitor, shares[0], 0.0))?;
    let (block, way) = (scenario.block.as_ref(), task.build());
    let mut record = Record::default();
    let fresh = population.copy();
    let master = task.slider(block, false)?;
    let run = master.pull(&mut population, &way, &mut Part::new(monitor, shares[0], shares[1]));
    let run = run.map_err(|e| e.under("drive"))?;
    // The forces of the contacts; and energies that do not balance, over the way of a life, where motion is off besides.
    let lives = stiffness(contacts) * equation.steady_state().mean_life();
    let off = population.error() / stiffness(contacts) + run.energy.imbalance().abs() / lives;
    adopt(sliding::motion(&run), "", &mut record);
    adopt(sliding::course(&run), "", &mut record);
    if let Loading::Spring(stiffness) = master.loading() {
        balance(&run, fresh.as_ref(), stiffness, loading, &mut record)?;
    }
    let mut sliding = Sliding::new(&run);
    if let Some(ensemble) = ensemble {
        let done = shares[0] + shares[1];
        let mut part = Part::new(monitor, done, 1.0 - done);
        let mut contacts = ensemble.population(&mut Aside { fraction: 0.0, monitor: &mut part })?;
        let run = task.slider(block, true)?.pull(&mut contacts, &way, &mut part)?;
        adopt(sliding::motion(&run), "ensemble_", &mut record);
        adopt(sliding::sizes(&run, ensemble.size()), "", &mut record);
        sliding.ensemble = Some(Box::new(Sliding::new(&run)));
    }
    let relaxation = equation.relaxation(&mut Part::new(monitor, 1.0, 0.0))?;
    let steady = equation.steady_state();
    let summary = Summary { sliding: Some(sliding), ..setting.summary(&steady, &relaxation, &pull) };
    let accuracy = Accuracy::new(setting, pull.error_estimate().max(off), steady.mean_life());
    Ok((accuracy.told(setting, "the force on a slider that is driven", summary)?, record))
}

/// Drives the slider over time-dependent contacts; friction is that of a pull at the velocity of its top.
fn at_a_velocity(
    setting: &Setting<'_>,
    protocol: &scenario::Protocol,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    const PULL: f64 = 0.1;
    let Setting { scenario, contacts, initial } = setting;
    in_time::fits(protocol, setting)?;
    let velocity = protocol.0[0].velocities().0;
    let equation =
        MasterEquation::at(contacts.clone(), initial, velocity, &mut Part::new(monitor, 0.0, 0.5 * PULL))?;
    let tolerance = scenario.master_equation.tolerance();
    let part = &mut Part::new(monitor, 0.5 * PULL, 0.5 * PULL);
    let pull = equation.pull(first_loading(contacts), tolerance, part)?;
    let part = &mut Part::new(monitor, PULL, 1.0 - PULL);
    let (sliding, record, moved) = match &scenario.block {
        Some(block) => in_time::behind(setting, protocol, block, part)
            .map(|(sliding, record, moved)| (Some(sliding), record, moved))?,
        None => {
            let (trace, record) = in_time::rigid(setting, protocol, part)?;
            (None, record, Some(Accuracy::in_time(setting, trace.error)))
        }
    };
    let relaxation = equation.relaxation(&mut Part::new(monitor, 1.0, 0.0))?;
    let steady = equation.steady_state();
    let summary = Summary { sliding, ..setting.summary(&steady, &relaxation, &pull) };
    let accuracy = Accuracy::new(setting, pull.error_estimate(), steady.mean_life());
    let accuracy = moved.into_iter().fold(accuracy, Accuracy::worse);
    Ok((accuracy.told(setting, "the force on a slider that is driven", summary)?, record))
}

/// How far the first loading of a slider is followed: five mean thresholds.
pub fn first_loading(contacts: &Contacts) -> f64 {
    LOADING * contacts.thresholds.mean()
}

/// Refuses before any work what could not be written after it.
fn fits(task: &scenario::Drive, ensemble: bool) -> Result<()> {
    let traces = if ensemble { 2 } else { 1 };
    let needed = (task.points * COLUMNS * traces * size_of::<f64>()) as u64;
    if needed <= LARGEST {
        return Ok(());
    }
    let what = format!("a result file of a trace of {} points", task.points);
    Err(Error::TooLarge { key: "drive.points".into(), what, needed, allowed: LARGEST })
}

/// Where the slider is in balance on the first loading, and the potential at the first slip.
fn balance(
    run: &StickSlip,
    fresh: &dyn Population,
    stiffness: f64,
    reach: f64,
    record: &mut Record,
) -> Result<()> {
    let curve = Curve::new(fresh, reach, FINE, &mut ())?;
    let along = &["branch"];
    let stable = curve.stable(stiffness).into_iter().map(f64::from).collect();
    let drive = curve.drive(stiffness);
    record.push(
        "branch_position",
        "position of the slider's base",
        Quantity::Length,
        along,
        curve.position.clone(),
    );
    record.push("branch_drive", "drive of the equilibrium at that position", Quantity::Length, along, drive);
    record.push(
        "branch_force",
        "friction force at that position",
        Quantity::Force,
        along,
        curve.force.clone(),
    );
    record.push("branch_stable", "whether the equilibrium is stable", Quantity::Number, along, stable);
    if let Some(first) = run.events.first() {
        let drives = POTENTIALS.map(|part| part * first.before.drive);
        let heights = drives.iter().flat_map(|&drive| curve.potential(stiffness, drive)).collect();
        let words = "drive at which the potential is given: before, at and after the first slip";
        record.push("potential_drive", words, Quantity::Length, &["potential_drive"], drives.to_vec());
        let along = &["potential_drive", "branch"];
        record.push("potential", "potential of the slider", Quantity::Energy, along, heights);
    }
    Ok(())
}
