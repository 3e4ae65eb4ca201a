//! `[stability]`: whether a slider sticks and slips, at each velocity of the load point and behind each spring.

use super::accuracy::ForceAccuracy;
use super::stick_slip::Springs;
use super::summary::{StabilityNumbers, StickSlipKind, StickSlipNumbers};
use super::{Output, fits};
use crate::Result;
use crate::block::Regime;
use crate::monitor::{Monitor, Part, report};
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, Model};

/// Fraction of the work at a velocity for the solution of the contacts, and for the stiffness at which stick-slip ends.
const SHARES: [f64; 2] = [0.1, 0.4];

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

/// The variables of the task. Over time-independent contacts there is no velocity, and what is found at a velocity is in the
/// summary alone.
const COLUMNS: [Column; 7] = [
    VELOCITY,
    STIFFNESS,
    STICK_SLIP,
    PERSISTENT_STIFFNESS,
    PERSISTENT_STIFFNESS_ABOVE,
    CRITICAL_STIFFNESS,
    CRITICAL_STIFFNESS_SLIDING,
];

/// Its table in CSV: a row for each stiffness, of one velocity after the other.
pub(super) const TABLES: &[CsvTable] = &[CsvTable {
    file: "stability.csv",
    columns: &[
        VELOCITY,
        STIFFNESS,
        STICK_SLIP,
        PERSISTENT_STIFFNESS,
        PERSISTENT_STIFFNESS_ABOVE,
        CRITICAL_STIFFNESS,
        CRITICAL_STIFFNESS_SLIDING,
    ],
    needed: STICK_SLIP,
}];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    vec![("stability", Record::declared(&[&COLUMNS]))]
}

const fn of(name: &'static str, long_name: &'static str) -> Column {
    Column::new(name, long_name, Quantity::Stiffness, &["velocity"])
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
    fits("stability.stiffnesses", 2 * velocities.len() * stiffnesses.len(), || "a map".into(), monitor)?;
    let mut accuracy = ForceAccuracy::new(model, 0.0, model.contacts.thresholds.mean());
    let (mut numbers, mut map) = (Vec::new(), Vec::new());
    for (i, &velocity) in velocities.iter().enumerate() {
        let share = 1.0 / velocities.len() as f64;
        let whole = &mut Part::new(monitor, i as f64 * share, share);
        let springs = Springs::new(model, velocity, &mut Part::new(whole, 0.0, SHARES[0]))?;
        accuracy = accuracy.worse(ForceAccuracy::new(model, springs.error, springs.life));
        let limit = springs.limit(task.resolution, &mut Part::new(whole, SHARES[0], SHARES[1]))?;
        let done = SHARES[0] + SHARES[1];
        let (regime, found) = regimes(&springs, &stiffnesses, &mut Part::new(whole, done, 1.0 - done))?;
        map.extend(found);
        numbers.push(springs.answer(regime, limit).numbers(velocity));
        report(whole, 1.0)?;
    }
    let mut record = Record::default();
    let timed: Vec<f64> = velocities.into_iter().flatten().collect();
    let at_each: &'static [&'static str] =
        if timed.is_empty() { &["stiffness"] } else { &["velocity", "stiffness"] };
    if !timed.is_empty() {
        let column = |value: fn(&StickSlipNumbers) -> f64| numbers.iter().map(value).collect();
        record.add(VELOCITY, timed);
        record.add(PERSISTENT_STIFFNESS, column(|n| n.persistent_stiffness));
        record.add(PERSISTENT_STIFFNESS_ABOVE, column(|n| n.persistent_stiffness_above.0));
        record.add(CRITICAL_STIFFNESS, column(|n| n.critical_stiffness.0));
        record.add(CRITICAL_STIFFNESS_SLIDING, column(|n| n.critical_stiffness_sliding.0));
    }
    record.add(STIFFNESS, stiffnesses);
    record.add(STICK_SLIP.along(at_each), map);
    let output = Output::new(model, StabilityNumbers { stick_slip: numbers }, record);
    accuracy.of(model, "the force of a first pull", output)
}

/// The regime of the block, and stick-slip behind each of the springs as a number.
fn regimes(springs: &Springs, stiffnesses: &[f64], monitor: &mut dyn Monitor) -> Result<(Regime, Vec<f64>)> {
    let share = 1.0 / (stiffnesses.len() + 1) as f64;
    let mut regime = |i: usize, stiffness: f64| {
        springs.regime(stiffness, &mut Part::new(monitor, i as f64 * share, share))
    };
    let map: Vec<Regime> =
        stiffnesses.iter().enumerate().map(|(i, &stiffness)| regime(i, stiffness)).collect::<Result<_>>()?;
    let own = springs.stiffness();
    let known = stiffnesses.iter().position(|&stiffness| stiffness == own);
    let regime = known.map_or_else(|| regime(stiffnesses.len(), own), |i| Ok(map[i]))?;
    Ok((regime, map.into_iter().map(number).collect()))
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
