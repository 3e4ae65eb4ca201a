//! `[stability]`: whether a slider sticks and slips, at each velocity of the load point and behind each spring.

use super::accuracy::ForceAccuracy;
use super::stick_slip::Springs;
use super::stick_slip_scatter::{StickSlipScatter, deviation, drops, each_simulation, mean};
use super::summary::{SimulatedStickSlip, StabilityNumbers, StickSlipKind, StickSlipNumbers};
use super::{Output, fits};
use crate::Result;
use crate::block::{PersistenceLimit, Regime};
use crate::monitor::{Monitor, Part, report};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, Model};

/// Fraction of the work at a velocity for the solution of the contacts, and for the stiffness at which stick-slip ends.
const SHARES: [f64; 2] = [0.1, 0.4];
/// Fraction of the work at a velocity for the master equation if there is an ensemble.
const MASTER: f64 = 0.2;

const VELOCITY: Column =
    Column::new("velocity", "velocity of the load point", Quantity::Velocity, &["velocity"]);
const STIFFNESS: Column =
    Column::new("stiffness", "stiffness of the spring", Quantity::Stiffness, &["stiffness"]);
const STICK_SLIP: Column = Column::new(
    "stick_slip",
    "stick-slip: 0 none, 1 transient, 2 persistent",
    Quantity::Number,
    &["velocity", "stiffness"],
);
const PERSISTENT_STIFFNESS: Column =
    of("persistent_stiffness", "largest stiffness at which stick-slip was found to persist");
const PERSISTENT_STIFFNESS_ABOVE: Column =
    of("persistent_stiffness_above", "smallest stiffness above it at which it was found not to persist");
const CRITICAL_STIFFNESS: Column = of("critical_stiffness", "critical stiffness of the first pull");
const CRITICAL_STIFFNESS_SLIDING: Column =
    of("critical_stiffness_sliding", "critical stiffness of steady sliding");

const ENSEMBLE_NONE: Column = at("ensemble_none", "fraction of the simulations without stick-slip");
const ENSEMBLE_TRANSIENT: Column =
    at("ensemble_transient", "fraction of the simulations with transient stick-slip");
const ENSEMBLE_PERSISTENT: Column =
    at("ensemble_persistent", "fraction of the simulations with persistent stick-slip");
const ENSEMBLE_DROP: Column = Column::new(
    "ensemble_drop",
    "mean force drop in the simulations with persistent stick-slip",
    Quantity::Force,
    &["velocity", "stiffness"],
);
const ENSEMBLE_DROP_STD: Column = Column::new(
    "ensemble_drop_std",
    "standard deviation of the mean force drop over these simulations",
    Quantity::Force,
    &["velocity", "stiffness"],
);
const ENSEMBLE_PERSISTENT_STIFFNESS: Column = of(
    "ensemble_persistent_stiffness",
    "largest stiffness at which stick-slip was found to persist, mean over the simulations",
);
const ENSEMBLE_PERSISTENT_STIFFNESS_STD: Column =
    of("ensemble_persistent_stiffness_std", "its standard deviation over the simulations");

/// The variables of the task. Over time-independent contacts there is no velocity, and what is found at a velocity is in the
/// summary alone.
const COLUMNS: [Column; 14] = [
    VELOCITY,
    STIFFNESS,
    STICK_SLIP,
    PERSISTENT_STIFFNESS,
    PERSISTENT_STIFFNESS_ABOVE,
    CRITICAL_STIFFNESS,
    CRITICAL_STIFFNESS_SLIDING,
    ENSEMBLE_NONE,
    ENSEMBLE_TRANSIENT,
    ENSEMBLE_PERSISTENT,
    ENSEMBLE_DROP,
    ENSEMBLE_DROP_STD,
    ENSEMBLE_PERSISTENT_STIFFNESS,
    ENSEMBLE_PERSISTENT_STIFFNESS_STD,
];

/// Its table in CSV: a row for each stiffness, of one velocity after the other.
pub(super) const TABLES: &[CsvTable] =
    &[CsvTable { file: "stability.csv", columns: &COLUMNS, needed: STICK_SLIP }];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    vec![("stability", Record::declared(&[&COLUMNS]))]
}

const fn of(name: &'static str, long_name: &'static str) -> Column {
    Column::new(name, long_name, Quantity::Stiffness, &["velocity"])
}

const fn at(name: &'static str, long_name: &'static str) -> Column {
    Column::new(name, long_name, Quantity::Number, &["velocity", "stiffness"])
}

/// Answers for every velocity and stiffness of `task`.
///
/// # Errors
/// Those of [`super::stick_slip_stability`]; results too large for the memory.
pub(super) fn run(
    model: &Model,
    task: &scenario::Stability,
    monitor: &mut dyn Monitor,
) -> Result<Output<StabilityNumbers>> {
    let velocities: Vec<Option<f64>> = if model.contacts.rules.are_time_dependent() {
        task.velocities.iter().copied().map(Some).collect()
    } else {
        vec![None]
    };
    let own = model.block.as_ref().map(|block| block.stiffness);
    let stiffnesses =
        if task.stiffnesses.is_empty() { Vec::from_iter(own) } else { task.stiffnesses.clone() };
    let columns = if model.ensemble.is_some() { 2 + task.simulations() } else { 2 };
    let what = || "a map".into();
    fits("stability.stiffnesses", columns * velocities.len() * stiffnesses.len(), what, monitor)?;
    let mut accuracy = ForceAccuracy::new(model, 0.0, model.contacts.thresholds.mean());
    let (mut numbers, mut map, mut scatter) = (Vec::new(), Vec::new(), Vec::new());
    for (i, &velocity) in velocities.iter().enumerate() {
        let share = 1.0 / velocities.len() as f64;
        let part = &mut Part::new(monitor, i as f64 * share, share);
        let found = at_velocity(model, task, (velocity, &stiffnesses), part)?;
        accuracy = accuracy.worse(found.accuracy);
        map.extend(found.map.into_iter().map(number));
        scatter.extend(found.scatter);
        numbers.push(found.numbers);
    }
    let mut record = Record::default();
    let timed: Vec<f64> = velocities.into_iter().flatten().collect();
    let at_each: &'static [&'static str] =
        if timed.is_empty() { &["stiffness"] } else { &["velocity", "stiffness"] };
    if !timed.is_empty() {
        record_velocities(timed, &numbers, &mut record);
    }
    record.add(STIFFNESS, stiffnesses);
    record.add(STICK_SLIP.along(at_each), map);
    if !scatter.is_empty() {
        record_scatter(&scatter, at_each, &mut record);
    }
    let output = Output::new(model, StabilityNumbers { stick_slip: numbers }, record);
    accuracy.of(model, "the force of a first pull", output)
}

/// What is found at a velocity.
struct AtVelocity {
    numbers: StickSlipNumbers,
    /// The regime behind each of the springs.
    map: Vec<Regime>,
    /// The regimes of the simulations behind each of the springs; none without an ensemble.
    scatter: Vec<Vec<Regime>>,
    accuracy: ForceAccuracy,
}

/// Solves for a velocity.
fn at_velocity(
    model: &Model,
    task: &scenario::Stability,
    (velocity, stiffnesses): (Option<f64>, &[f64]),
    monitor: &mut dyn Monitor,
) -> Result<AtVelocity> {
    let master = if model.ensemble.is_some() { MASTER } else { 1.0 };
    let part = &mut Part::new(monitor, 0.0, master);
    let springs = Springs::new(model, velocity, &mut Part::new(part, 0.0, SHARES[0]))?;
    let limit = springs.limit(task.resolution, &mut Part::new(part, SHARES[0], SHARES[1]))?;
    let done = SHARES[0] + SHARES[1];
    let (regime, map) = regimes(&springs, stiffnesses, &mut Part::new(part, done, 1.0 - done))?;
    let limit = stiffnesses.iter().zip(&map).fold(limit, |limit, (&at, regime)| limit.with(at, regime));
    let mut numbers = springs.answer(regime, limit).numbers(velocity);
    let mut scatter = Vec::new();
    if model.ensemble.is_some() {
        let part = &mut Part::new(monitor, master, 1.0 - master);
        let (simulated, found) = simulated(model, task, (&springs, stiffnesses, limit), part)?;
        numbers.ensemble = Some(simulated);
        scatter = found;
    }
    report(monitor, 1.0)?;
    let accuracy = ForceAccuracy::new(model, springs.error, springs.life);
    Ok(AtVelocity { numbers, map, scatter, accuracy })
}

/// Records what was found at each velocity.
fn record_velocities(velocities: Vec<f64>, numbers: &[StickSlipNumbers], record: &mut Record) {
    let column = |value: fn(&StickSlipNumbers) -> f64| numbers.iter().map(value).collect();
    record.add(VELOCITY, velocities);
    record.add(PERSISTENT_STIFFNESS, column(|n| n.persistent_stiffness));
    record.add(PERSISTENT_STIFFNESS_ABOVE, column(|n| n.persistent_stiffness_above.0));
    record.add(CRITICAL_STIFFNESS, column(|n| n.critical_stiffness.0));
    record.add(CRITICAL_STIFFNESS_SLIDING, column(|n| n.critical_stiffness_sliding.0));
    let simulated: Vec<&SimulatedStickSlip> = numbers.iter().filter_map(|n| n.ensemble.as_ref()).collect();
    if simulated.is_empty() {
        return;
    }
    let column = |value: fn(&SimulatedStickSlip) -> f64| simulated.iter().map(|s| value(s)).collect();
    record.add(ENSEMBLE_PERSISTENT_STIFFNESS, column(|s| s.persistent_stiffness.0));
    let unknown = |s: &SimulatedStickSlip| s.persistent_stiffness_std.unwrap_or(f64::NAN);
    record.add(ENSEMBLE_PERSISTENT_STIFFNESS_STD, column(unknown));
}

/// Records what the simulations found behind each spring.
fn record_scatter(scatter: &[Vec<Regime>], at_each: &'static [&'static str], record: &mut Record) {
    let fraction = |kind| {
        let of = |regimes: &Vec<Regime>| {
            let counted = regimes.iter().filter(|regime| StickSlipKind::from(**regime) == kind).count();
            counted as f64 / regimes.len() as f64
        };
        scatter.iter().map(of).collect()
    };
    for (column, kind) in [
        (ENSEMBLE_NONE, StickSlipKind::None),
        (ENSEMBLE_TRANSIENT, StickSlipKind::Transient),
        (ENSEMBLE_PERSISTENT, StickSlipKind::Persistent),
    ] {
        record.add(column.along(at_each), fraction(kind));
    }
    let of_drops = |value: fn(&[f64]) -> Option<f64>| {
        scatter.iter().map(|regimes| value(&drops(regimes)).unwrap_or(f64::NAN)).collect()
    };
    record.add(ENSEMBLE_DROP.along(at_each), of_drops(mean));
    record.add(ENSEMBLE_DROP_STD.along(at_each), of_drops(deviation));
}

/// The numbers of the simulations of single contacts, and their regimes behind each of the springs.
fn simulated(
    model: &Model,
    task: &scenario::Stability,
    (springs, stiffnesses, expected): (&Springs, &[f64], PersistenceLimit),
    monitor: &mut dyn Monitor,
) -> Result<(SimulatedStickSlip, Vec<Vec<Regime>>)> {
    let found = each_simulation(model, springs, task.simulations(), monitor, |springs, part| {
        let limit = springs.limit_near(expected, task.resolution, &mut Part::new(part, 0.0, 0.5))?;
        let (regime, map) = regimes(springs, stiffnesses, &mut Part::new(part, 0.5, 0.5))?;
        Ok((limit.with(springs.stiffness(), &regime), (regime, map)))
    })?;
    let behind = |i: usize| found.iter().map(|(_, (_, map))| map[i]).collect();
    let map = (0..stiffnesses.len()).map(behind).collect();
    let (limits, regimes) = found.iter().map(|(limit, (regime, _))| (*limit, *regime)).unzip();
    Ok((StickSlipScatter { regimes, limits }.numbers(), map))
}

/// The regime of the block, and those behind each of the springs.
fn regimes(
    springs: &Springs,
    stiffnesses: &[f64],
    monitor: &mut dyn Monitor,
) -> Result<(Regime, Vec<Regime>)> {
    let share = 1.0 / (stiffnesses.len() + 1) as f64;
    let mut regime = |i: usize, stiffness: f64| {
        springs.regime(stiffness, &mut Part::new(monitor, i as f64 * share, share))
    };
    let map: Vec<Regime> =
        stiffnesses.iter().enumerate().map(|(i, &stiffness)| regime(i, stiffness)).collect::<Result<_>>()?;
    let own = springs.stiffness();
    let known = stiffnesses.iter().position(|&stiffness| stiffness == own);
    let regime = known.map_or_else(|| regime(stiffnesses.len(), own), |i| Ok(map[i]))?;
    Ok((regime, map))
}

/// Stick-slip as a number in files; not a number where it is undecided.
fn number(regime: Regime) -> f64 {
    match StickSlipKind::from(regime) {
        StickSlipKind::None => 0.0,
        StickSlipKind::Transient => 1.0,
        StickSlipKind::Persistent => 2.0,
        StickSlipKind::Undecided => f64::NAN,
    }
}
