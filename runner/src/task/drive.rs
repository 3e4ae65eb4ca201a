//! `[drive]`: the slider's top is moved, or a force imposed, and its bottom follows.

use asperity::block::{Block, Curve, Drive, Loading, Size, Sizes, Slip, StickSlip};
use asperity::master::MasterEquation;
use asperity::monitor::Monitor;
use asperity::population::Population;
use asperity::record::{Quantity, Record, Variable};
use asperity::scenario;
use asperity::{Error, Result};

use super::Setting;
use super::part::Part;
use crate::output::LARGEST;
use crate::summary::{Sliding, Summary};

/// Mean thresholds that the first loading is followed for, at least.
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
    fits(task, scenario.ensemble.is_some())?;
    let equation = MasterEquation::new(contacts.clone(), initial)?;
    let tolerance = scenario.master_equation.tolerance;
    let reach = task.turns().iter().fold(LOADING * contacts.thresholds.mean(), |far, turn| far.max(*turn));
    let shares = if scenario.ensemble.is_some() { [0.05, 0.25] } else { [0.1, 0.9] };
    let pull = equation.pull(reach, tolerance, &mut Part::new(monitor, 0.0, shares[0]))?;
    let mut population = equation.population(tolerance)?;
    let way = drive(task);
    let mut record = Record::default();
    let fresh = population.copy();
    let master = slider(setting, task, false)?;
    let run = master.pull(&mut population, &way, &mut Part::new(monitor, shares[0], shares[1]));
    let run = run.map_err(|e| e.under("drive"))?;
    trace(&run, "", &mut record);
    course(&run, &mut record);
    if let Loading::Spring(stiffness) = master.loading() {
        balance(&run, fresh.as_ref(), stiffness, LOADING * contacts.thresholds.mean(), &mut record)?;
    }
    let mut sliding = Sliding::new(&run);
    if let Some(ensemble) = &scenario.ensemble {
        let done = shares[0] + shares[1];
        let mut part = Part::new(monitor, done, 1.0 - done);
        let mut contacts = ensemble.build(contacts.clone(), initial.clone())?.population()?;
        let run = slider(setting, task, true)?.pull(&mut contacts, &way, &mut part)?;
        trace(&run, "ensemble_", &mut record);
        sizes(&run, ensemble.size, &mut record);
        sliding.ensemble = Some(Box::new(Sliding::new(&run)));
    }
    let summary = setting.summary(&equation.steady_state(), &equation.relaxation(), &pull);
    Ok((Summary { sliding: Some(sliding), ..summary }, record))
}

/// Refuses before any work what could not be written after it.
fn fits(task: &scenario::Drive, ensemble: bool) -> Result<()> {
    let traces = if ensemble { 2 } else { 1 };
    let needed = (task.points * COLUMNS * traces * size_of::<f64>()) as u64;
    if needed <= LARGEST {
        return Ok(());
    }
    let what = format!("a result file of a trace of {} points", task.points);
    Err(Error::TooLarge { what, needed, allowed: LARGEST })
}

/// The turning points of the drive, or of the force.
fn drive(task: &scenario::Drive) -> Drive {
    let turning_points = task.force_to.map_or_else(|| task.turns(), |force| vec![force]);
    Drive { turning_points, points: task.points }
}

/// The slider over the master equation, or over an `ensemble`, in which small events are no slips.
fn slider(setting: &Setting<'_>, task: &scenario::Drive, ensemble: bool) -> Result<Block> {
    let (loading, slip, fraction) = match (&setting.scenario.block, task.force_to) {
        (Some(block), _) => (Loading::Spring(block.stiffness), block.slip.into(), block.slip_fraction),
        (None, Some(_)) => (Loading::Force, Slip::Overdamped, 1.0),
        (None, None) => (Loading::Rigid, Slip::Overdamped, 1.0),
    };
    Block::new(loading, slip, ensemble.then_some(fraction)).map_err(|e| e.under("block"))
}

/// The trace and the slips, `prefix` before their names and those of their dimensions.
fn trace(run: &StickSlip, prefix: &str, record: &mut Record) {
    adopt(run.trace_record(), prefix, "", record);
    adopt(run.events_record(), prefix, "event_", record);
}

/// Takes over the variables of a `part`.
fn adopt(part: Record, prefix: &str, kind: &str, record: &mut Record) {
    for variable in part.variables.into_iter().filter(|v| !v.values.is_empty()) {
        let name = format!("{prefix}{kind}{}", variable.name);
        let dimensions = variable.dimensions.iter().map(|d| format!("{prefix}{d}")).collect();
        record.variables.push(Variable { name, dimensions, ..variable });
    }
}

/// The time course of the first inertial slip.
fn course(run: &StickSlip, record: &mut Record) {
    let Some(course) = &run.course else { return };
    let mut add = |name, words, quantity, values: &[f64]| {
        record.push(name, words, quantity, &["slip_time"], values.to_vec());
    };
    add("slip_time", "time since the first slip began", Quantity::Time, &course.time);
    add(
        "slip_position",
        "position of the slider's bottom in the first slip",
        Quantity::Length,
        &course.position,
    );
    add("slip_velocity", "velocity of the slider in the first slip", Quantity::Velocity, &course.velocity);
    add("slip_force", "friction force in the first slip", Quantity::Force, &course.force);
    add("slip_spring_force", "force of the spring in the first slip", Quantity::Force, &course.spring_force);
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
        "position of the slider's bottom",
        Quantity::Length,
        along,
        curve.position.clone(),
    );
    record.push("branch_drive", "drive at which it is in balance there", Quantity::Length, along, drive);
    record.push("branch_force", "friction force there", Quantity::Force, along, curve.force.clone());
    record.push("branch_stable", "whether the balance is stable", Quantity::Number, along, stable);
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

/// How many events of each size there were, small ones that are no slips among them.
fn sizes(run: &StickSlip, size: usize, record: &mut Record) {
    let bins = run.sizes.bins.iter().enumerate().filter(|(_, bin)| bin.events > 0);
    let (middles, bins): (Vec<f64>, Vec<Size>) = bins.map(|(i, bin)| (Sizes::middle(i), *bin)).unzip();
    if bins.is_empty() {
        return;
    }
    let along = &["size"];
    let mut add = |name, words, quantity, value: &dyn Fn(&Size) -> f64| {
        record.push(name, words, quantity, along, bins.iter().map(value).collect());
    };
    add("size_events", "number of events", Quantity::Number, &|bin| bin.events as f64);
    add("size_slip", "mean slip of an event", Quantity::Length, &|bin| bin.slip / bin.events as f64);
    add("size_drop", "mean force drop of an event", Quantity::Force, &|bin| bin.drop / bin.events as f64);
    let contacts = middles.iter().map(|share| share * size as f64).collect();
    record.push("size", "number of contacts broken in an event", Quantity::Number, along, contacts);
}
