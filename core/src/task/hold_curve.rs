//! `[hold_curve]`: a slide–hold–slide test, static friction against hold time.

use super::accuracy::{ForceAccuracy, as_required};
use super::background::coefficient;
use super::settling::Steady;
use super::summary::{HealingCurve, HoldCurveNumbers, Peak};
use super::{COMPARED_FORCE, Output, RESIDUAL, compare_points, ensemble};
use crate::Result;
use crate::contacts::Contacts;
use crate::history::{History, Piece};
use crate::master::Transport;
use crate::monitor::{Monitor, Part, Preparation, report};
use crate::rate_state::Healing;
use crate::record::{Column, CsvTable, Quantity, Record};
use crate::scenario::{self, Model};

/// Fraction of the work for steady sliding.
const LIVES: f64 = 0.1;
/// Distance within which the force peaks after a hold, in units of the largest of the mean threshold at formation, that of mature
/// contacts, and the mean life in steady sliding.
const REACH: f64 = 2.0;
/// Points of the first search for the peak.
const POINTS: usize = 41;
/// Points of each further search, between the neighbours of the highest point.
const CLOSER: usize = 21;
/// Largest number of further searches; each divides the spacing of points by ten.
const ROUNDS: usize = 4;

/// Fraction of the work for the master equation if there is an ensemble.
const MASTER: f64 = 0.5;

const HOLD: Column = Column::new("hold", "time for which the slider was held", Quantity::Time, &["hold"]);
const STATIC_FRICTION: Column =
    Column::new("static_friction", "highest force after the hold", Quantity::Force, &["hold"]);
const PEAK_POSITION: Column = Column::new(
    "peak_position",
    "displacement from the hold to the highest force",
    Quantity::Length,
    &["hold"],
);
const HELD_FORCE: Column =
    Column::new("held_force", "force at the end of the hold", Quantity::Force, &["hold"]);
const ENSEMBLE: [Column; 2] =
    ensemble::force_columns("force of the ensemble where that of the master equation is highest", &["hold"]);

/// That of the highest force.
const FRICTION_COEFFICIENT: Column = coefficient(&["hold"]);

/// The variables of the task.
const COLUMNS: [Column; 7] =
    [HOLD, STATIC_FRICTION, PEAK_POSITION, HELD_FORCE, ENSEMBLE[0], ENSEMBLE[1], FRICTION_COEFFICIENT];

const COMPARED: [Column; 3] = [
    Column::new("compared_hold", "measured hold time", Quantity::Time, &["compared"]),
    COMPARED_FORCE,
    RESIDUAL,
];

/// Forces of contacts, to which the background force is added.
const FORCES: [Column; 3] = [STATIC_FRICTION, HELD_FORCE, ENSEMBLE[0]];

/// Its table in CSV.
pub(super) const TABLES: &[CsvTable] =
    &[CsvTable { file: "hold_curve.csv", columns: &COLUMNS, needed: HOLD }];

/// What a result may hold, without values.
pub(super) fn columns() -> Vec<(&'static str, Record)> {
    vec![("hold_curve", Record::declared(&[&COLUMNS, &COMPARED]))]
}

/// Computes the curve of `task`.
///
/// # Errors
/// Errors of the solvers, a stop by the monitor.
pub(super) fn run(
    model: &Model,
    task: &scenario::HoldCurve,
    monitor: &mut dyn Monitor,
) -> Result<Output<HoldCurveNumbers>> {
    let Model { contacts, initial, .. } = model;
    let steady = Steady::at(contacts, task.velocity, &mut Part::new(monitor, 0.0, LIVES))?;
    let mature =
        contacts.rules.ageing.as_ref().and_then(|ageing| ageing.mature()).map_or(0.0, |law| law.mean());
    let reach = REACH * contacts.thresholds.mean().max(mature).max(steady.life);
    let holds = task.holds();
    let measured = model.compare.as_ref().map_or(&[][..], |curve| curve.points().0);
    let mut all = [&holds, measured].concat();
    all.sort_by(f64::total_cmp);
    all.dedup();
    let monitor = &mut Part::new(monitor, LIVES, 1.0 - LIVES);
    let master = if model.ensemble.is_some() { MASTER } else { 1.0 };
    let on = moving(task.velocity, reach);
    let tolerance = model.master_equation.tolerance_in_time(&contacts.rules);
    let part = &mut Part::new(monitor, 0.0, master);
    let (found, accuracy) = as_required(model, tolerance, part, |tolerance, part| {
        let (columns, force) = held_and_slid(contacts, (&all, task.velocity), (on, tolerance), part)?;
        Ok((columns, ForceAccuracy::in_time(model, force)))
    })?;
    let at = |hold: &f64| all.partition_point(|other| other < hold);
    let mut columns = found.at(holds.iter().map(at));
    if let Some(drawn) = &model.ensemble {
        let slide = moving(task.velocity, steady.distance);
        for (done, &hold) in holds.iter().enumerate() {
            let fraction = (1.0 - master) / holds.len() as f64;
            let part = &mut Part::new(monitor, master + done as f64 * fraction, fraction);
            // Each hold has contacts of its own, so that their errors are independent.
            let first = (done * drawn.size()) as u64;
            let ensemble = drawn.build(contacts.clone(), initial.clone())?.numbered_from(first);
            let time = slide.duration + hold + columns.place[done] / task.velocity;
            let history = History::new(vec![slide, Piece { velocity: 0.0, duration: hold }, on])?;
            let run = ensemble.follow_with(&history, &[time], part)?;
            columns.ensemble_force.push(run.force[0]);
            columns.ensemble_error.push(run.error[0]);
        }
    }
    let peaks: Vec<f64> = columns.peak.iter().map(|force| force + model.background).collect();
    let healing = Healing::read(&holds, &peaks);
    let hold_curve = HealingCurve::new(task.velocity, steady.friction + model.background, healing);
    let mut record = columns.record(holds);
    model.add_background(&FORCES, &mut record);
    let compare = model.compare.as_ref().map(|curve| {
        let computed: Vec<_> =
            measured.iter().map(|hold| Some(found.peak[at(hold)] + model.background)).collect();
        compare_points(curve, COMPARED[0], &computed, &mut record)
    });
    let numbers = HoldCurveNumbers { hold_curve, compare };
    model.add_coefficient(STATIC_FRICTION.name, &mut record);
    accuracy.of(model, "the force after a hold", Output::new(model, numbers, record))
}

/// Holds after sliding at a velocity, each followed by sliding `on`, computed by the master equation. Returns the columns without
/// those of the ensemble, and the estimated error of the forces.
fn held_and_slid(
    contacts: &Contacts,
    (holds, velocity): (&[f64], f64),
    (on, tolerance): (Piece, f64),
    monitor: &mut dyn Monitor,
) -> Result<(Columns, f64)> {
    let mut preparation = Preparation::new(monitor);
    let mut held = Transport::steady_with(contacts, velocity, tolerance, &mut preparation)?;
    let monitor = &mut preparation.rest();
    let mut columns = Columns::default();
    let (mut before, mut error) = (0.0, 0.0_f64);
    for (done, &hold) in holds.iter().enumerate() {
        let fraction = 1.0 / holds.len() as f64;
        let part = &mut Part::new(monitor, done as f64 * fraction, fraction);
        // A longer hold continues from the end of the shorter one.
        let longer = History::new(vec![Piece { velocity: 0.0, duration: hold - before }])?;
        let rest = held.follow_with(&longer, &[longer.duration()], &mut Part::new(part, 0.0, 0.2))?;
        before = hold;
        let (peak, off) = slid(&held, on, &mut Part::new(part, 0.2, 0.8))?;
        error = error.max(rest.error).max(off);
        columns.push(peak, held.force());
        report(part, 1.0)?;
    }
    Ok((columns, error))
}

fn moving(velocity: f64, distance: f64) -> Piece {
    Piece { velocity, duration: distance / velocity }
}

/// The highest force of contacts that were held and then slide `on`, at its displacement since the hold, and its estimated
/// error. The error is that of the forces plus the difference between the peak and the peak of every other point.
fn slid(held: &Transport, on: Piece, monitor: &mut dyn Monitor) -> Result<(Peak, f64)> {
    let moved = |duration: f64| History::new(vec![Piece { duration, ..on }]);
    let times = spread((0.0, on.duration), POINTS);
    let trace = held.clone().follow_with(&moved(on.duration)?, &times, &mut Part::new(monitor, 0.0, 0.5))?;
    let (start, end) = beside(&times, &trace.force);
    // The search repeats on an ever smaller interval around the highest point, from a state kept just before it.
    let mut near = held.clone();
    if start > 0.0 {
        near.follow_with(&moved(start)?, &[], &mut Part::new(monitor, 0.5, 0.3))?;
    }
    let (mut window, mut round) = ((0.0, end - start), 1);
    loop {
        let times = spread(window, CLOSER);
        let aside = &mut Part::new(monitor, 0.8, 0.0);
        let trace = near.clone().follow_with(&moved(window.1)?, &times, aside)?;
        let found = peak(&trace.position, &trace.force);
        // The error of the vertex falls at least with the square of the spacing: the difference
        // from twice the spacing bounds it.
        let coarse = peak(&every_other(&trace.position), &every_other(&trace.force));
        // Beside a cusp both may agree by accident; the vertex then lies high above the highest point.
        let above = found.force - trace.force[highest(&trace.force)];
        let off = (found.force - coarse.force).abs();
        if off.max(above) <= trace.error || round == ROUNDS {
            let peak = Peak { position: found.position - held.position(), ..found };
            return Ok((peak, trace.error + off));
        }
        (window, round) = (beside(&times, &trace.force), round + 1);
    }
}

/// Evenly spaced times, both ends included.
fn spread((from, to): (f64, f64), points: usize) -> Vec<f64> {
    let time = |i: usize| {
        if i + 1 < points { from + (to - from) * (i as f64 / (points - 1) as f64) } else { to }
    };
    (0..points).map(time).collect()
}

/// The times before and after the highest force.
fn beside(times: &[f64], force: &[f64]) -> (f64, f64) {
    let highest = highest(force);
    (times[highest.saturating_sub(1)], times[(highest + 1).min(times.len() - 1)])
}

/// Every other value. The first and the last are included if the number of values is odd.
fn every_other(values: &[f64]) -> Vec<f64> {
    values.iter().copied().step_by(2).collect()
}

/// The place of the highest force, the first of equal ones.
fn highest(force: &[f64]) -> usize {
    (0..force.len()).rev().max_by(|&i, &j| force[i].total_cmp(&force[j])).unwrap_or(0)
}

/// The highest force of a trace: the vertex of the parabola through its highest point and both neighbours.
pub(super) fn peak(position: &[f64], force: &[f64]) -> Peak {
    let highest = highest(force);
    let top = Peak { force: force[highest], position: position[highest] };
    if highest == 0 || highest + 1 == force.len() {
        return top;
    }
    let (before, after) = (position[highest - 1] - top.position, position[highest + 1] - top.position);
    // Points at one position, as of a slip while the load point rests, have no parabola.
    if !(before < 0.0 && after > 0.0) {
        return top;
    }
    // Divided differences (Newton's interpolation) for points that need not be evenly spaced.
    let (left, right) = ((force[highest - 1] - top.force) / before, (force[highest + 1] - top.force) / after);
    let bend = (right - left) / (after - before);
    let slope = left - bend * before;
    if bend.is_nan() || bend >= 0.0 {
        return top;
    }
    let shift = -0.5 * slope / bend;
    Peak { force: top.force + 0.5 * slope * shift, position: top.position + shift }
}

/// The values of the columns, hold by hold.
#[derive(Default)]
struct Columns {
    peak: Vec<f64>,
    place: Vec<f64>,
    held: Vec<f64>,
    ensemble_force: Vec<f64>,
    ensemble_error: Vec<f64>,
}

impl Columns {
    fn push(&mut self, peak: Peak, held: f64) {
        self.peak.push(peak.force);
        self.place.push(peak.position);
        self.held.push(held);
    }

    /// Those of the holds of these numbers, without an ensemble.
    fn at(&self, holds: impl Iterator<Item = usize>) -> Self {
        let mut found = Self::default();
        for i in holds {
            found.push(Peak { force: self.peak[i], position: self.place[i] }, self.held[i]);
        }
        found
    }

    fn record(self, holds: Vec<f64>) -> Record {
        let mut record = Record::default();
        record.add(HOLD, holds);
        record.add(STATIC_FRICTION, self.peak);
        record.add(PEAK_POSITION, self.place);
        record.add(HELD_FORCE, self.held);
        if !self.ensemble_force.is_empty() {
            ensemble::add_force(&mut record, ENSEMBLE, self.ensemble_force, self.ensemble_error);
        }
        record
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_of_a_parabola_is_found_between_its_points() {
        let position = [0.0, 1.0, 1.5, 3.0];
        let force = position.map(|x: f64| 2.0 - (x - 1.3).powi(2));
        let found = peak(&position, &force);
        // rounding of numbers of the size of 1
        assert!((found.position - 1.3).abs() < 1e-14 && (found.force - 2.0).abs() < 1e-14, "{found:?}");
        let rising = peak(&[0.0, 1.0], &[0.0, 1.0]);
        assert_eq!((rising.position, rising.force), (1.0, 1.0));
    }

    #[test]
    fn a_peak_at_which_the_force_drops_is_its_point() {
        for position in [[0.0, 1.0, 1.0, 2.0], [0.0, 0.0, 1.0, 2.0]] {
            let found = peak(&position, &[0.0, 1.0, 0.5, 0.7]);
            assert_eq!((found.position, found.force), (position[1], 1.0));
        }
    }
}
