//! `[hold_curve]`: slide until that is steady, hold, slide on; static friction against how long it was held.

use asperity::history::{History, Piece};
use asperity::master::{Trace, Transport};
use asperity::monitor::Monitor;
use asperity::rate_state::Healing;
use asperity::record::{Quantity, Record};
use asperity::{Result, scenario};

use super::Setting;
use super::part::{self, Part};
use super::settling::Steady;
use crate::summary::{HoldCurve, Peak, Summary};

/// Mean thresholds, of newborn or mature contacts, within which the force peaks after a hold.
const REACH: f64 = 2.0;
/// Points between which the peak is looked for.
const POINTS: usize = 401;

/// Computes the curve that `task` asks for.
///
/// # Errors
/// What the solvers run into, or the monitor's wish to stop.
pub fn run(
    setting: &Setting<'_>,
    task: &scenario::HoldCurve,
    monitor: &mut dyn Monitor,
) -> Result<(Summary, Record)> {
    let Setting { scenario, contacts, initial } = setting;
    let steady = Steady::at(contacts, initial, task.velocity)?;
    let mature =
        contacts.rules.ageing.as_ref().and_then(|ageing| ageing.mature()).map_or(0.0, |law| law.mean());
    let reach = REACH * contacts.thresholds.mean().max(mature).max(steady.life);
    let holds = task.holds();
    let tolerance = scenario.master_equation.tolerance_in_time(&contacts.rules);
    let sliding = Transport::steady(contacts, task.velocity, tolerance)?;
    let slide = moving(task.velocity, steady.way);
    let mut columns = Columns::default();
    for (done, &hold) in holds.iter().enumerate() {
        let share = 1.0 / holds.len() as f64;
        let part = &mut Part::new(monitor, done as f64 * share, share);
        let held = Piece { velocity: 0.0, duration: hold };
        let on = moving(task.velocity, reach);
        let history = History::new(vec![held, on])?;
        let times = times(&history);
        let master = if scenario.ensemble.is_some() { 0.5 } else { 1.0 };
        let trace = sliding.clone().follow(&history, &times, &mut Part::new(part, 0.0, master))?;
        let peak = columns.push(&trace);
        if let Some(ensemble) = &scenario.ensemble {
            let first = (done * ensemble.size()) as u64;
            let model = ensemble.build(contacts.clone(), initial.clone())?.numbered_from(first);
            let moment = slide.duration + hold + (peak.position - trace.position[0]) / task.velocity;
            let history = History::new(vec![slide, held, on])?;
            let run = model.follow(&history, &[moment], &mut Part::new(part, master, 1.0 - master))?;
            columns.ensemble_force.push(run.force[0]);
            columns.ensemble_error.push(run.error[0]);
        }
        part::report(part, 1.0)?;
    }
    let healing = Healing::read(&holds, &columns.peak);
    let curve = HoldCurve::new(task.velocity, steady.friction, healing);
    Ok((Summary { hold_curve: Some(curve), ..setting.heading() }, columns.record(holds)))
}

fn moving(velocity: f64, way: f64) -> Piece {
    Piece { velocity, duration: way / velocity }
}

/// Times from the end of the hold, with which the history begins, to the end of the motion after it.
fn times(history: &History) -> Vec<f64> {
    let (start, end) = (history.knots()[1].0, history.duration());
    (0..POINTS).map(|i| start + (end - start) * (i as f64 / (POINTS - 1) as f64)).collect()
}

/// The highest force of a trace: the vertex of the parabola through its highest point and both neighbours.
pub fn peak(position: &[f64], force: &[f64]) -> Peak {
    let highest = (0..force.len()).max_by(|&i, &j| force[i].total_cmp(&force[j])).unwrap_or(0);
    let top = Peak { force: force[highest], position: position[highest] };
    if highest == 0 || highest + 1 == force.len() {
        return top;
    }
    let (before, after) = (position[highest - 1] - top.position, position[highest + 1] - top.position);
    let (left, right) = ((force[highest - 1] - top.force) / before, (force[highest + 1] - top.force) / after);
    let bend = (right - left) / (after - before);
    let slope = left - bend * before;
    if bend.is_nan() || bend >= 0.0 {
        return top;
    }
    let shift = -0.5 * slope / bend;
    Peak { force: top.force + 0.5 * slope * shift, position: top.position + shift }
}

/// What is known of each hold.
#[derive(Default)]
struct Columns {
    peak: Vec<f64>,
    place: Vec<f64>,
    held: Vec<f64>,
    ensemble_force: Vec<f64>,
    ensemble_error: Vec<f64>,
}

impl Columns {
    fn push(&mut self, trace: &Trace) -> Peak {
        let peak = peak(&trace.position, &trace.force);
        self.peak.push(peak.force);
        self.place.push(peak.position - trace.position[0]);
        self.held.push(trace.force[0]);
        peak
    }

    fn record(self, holds: Vec<f64>) -> Record {
        let mut record = Record::default();
        let mut add = |name, words, quantity, values: Vec<f64>| {
            if !values.is_empty() {
                record.push(name, words, quantity, &["hold"], values);
            }
        };
        add("hold", "time for which the slider was held", Quantity::Time, holds);
        add("static_friction", "highest force after the hold", Quantity::Force, self.peak);
        add("peak_position", "way from the hold to the highest force", Quantity::Length, self.place);
        add("held_force", "force at the end of the hold", Quantity::Force, self.held);
        let words = "force of the ensemble where that of the master equation is highest";
        add("ensemble_force", words, Quantity::Force, self.ensemble_force);
        add("ensemble_error", "its standard error", Quantity::Force, self.ensemble_error);
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
}
