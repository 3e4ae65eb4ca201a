//! `creep_curve`: slip in time under constant forces; `creep_rate`: its velocity; and `static_fatigue`: time to failure against force.

use asperity::record::{Quantity, Record};
use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, line};
use super::style::{self, BLACK, BLUE, Page, Plots};
use super::{legend, ticks};

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let loaded = outcome.record.values("loaded_position")?;
    let slip = |row: usize, position: f64| position - loaded[row];
    let curves = curves(&outcome.record, "creep_position", slip)?;
    let ends = style::range(curves.iter().map(|curve| curve.1.as_slice()));
    let layout = style::layout((0.0, 1.0), (0.0, style::headroom(ends.1)));
    let layout = layout.with_y_label(style::axis(
        outcome,
        "Slip since loading",
        outcome.record.get("creep_position")?,
    ));
    let layout = in_time(outcome, page, &curves, layout)?;
    Some(legend::placed(ticks::panel(drawn(outcome, &curves), layout), &entries(outcome, &curves)?, &[0]))
}

/// The velocity on logarithmic axes.
pub fn rate(outcome: &Outcome, page: Page) -> Option<Scene> {
    let curves = curves(&outcome.record, "creep_velocity", |_, velocity| velocity)?;
    let (low, high) = style::range(curves.iter().map(|curve| curve.1.as_slice()));
    let ends = style::decades(&[low, high]);
    let layout = style::layout((0.0, 1.0), ends).with_log_y().with_y_tick_format(style::powers(ends));
    let layout =
        layout.with_y_label(style::axis(outcome, "Velocity v", outcome.record.get("creep_velocity")?));
    let layout = in_time(outcome, page, &curves, layout)?;
    Some(legend::placed(ticks::panel(drawn(outcome, &curves), layout), &entries(outcome, &curves)?, &[0]))
}

/// Time to failure against force.
pub fn fatigue(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (force, time) = (record.values("imposed_force")?, record.values("failure_time")?);
    let mut points: Vec<Point> =
        force.iter().copied().zip(time.iter().copied()).filter(|point| point.1 > 0.0).collect();
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let times: Vec<f64> = points.iter().map(|point| point.1).collect();
    let (first, last) = (points.first()?.0, points.last()?.0);
    if points.len() < 2 || first == last {
        return None;
    }
    let (low, high) = style::range([times.as_slice()]);
    let ends = style::decades(&[low, high]);
    let air = 0.05 * (last - first);
    let layout = style::layout((first - air, last + air), ends).with_log_y();
    let layout = page
        .titled(layout.with_y_tick_format(style::powers(ends)), &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Constant force F", record.get("imposed_force")?))
        .with_y_label(style::axis(outcome, "Time to failure", record.get("failure_time")?));
    let markers = ScatterPlot::new().with_data(points.clone()).with_color(BLUE).with_size(4.0);
    Some(ticks::panel(vec![line(points, BLUE, 1.6, None), Plot::Scatter(markers)], layout))
}

/// The times of a curve, its values at them, and the row of its force.
type Curve = (Vec<f64>, Vec<f64>, usize);

/// The curves of the forces under which the slider creeps, from the first point after loading on.
fn curves(record: &Record, name: &str, value: impl Fn(usize, f64) -> f64) -> Option<Vec<Curve>> {
    let forces = record.values("imposed_force")?.len();
    let curve = |row: usize| {
        let points = record.row("creep_time", row)?.iter().zip(record.row(name, row)?).skip(1);
        let points = points.map(|(&time, &at)| (time, value(row, at)));
        // The velocity is infinite at failure.
        let (times, values): (Vec<_>, Vec<_>) =
            points.filter(|point| point.0.is_finite() && point.1.is_finite() && point.1 > 0.0).unzip();
        (times.len() > 1).then_some((times, values, row))
    };
    let found: Vec<Curve> = (0..forces).filter_map(curve).collect();
    (!found.is_empty()).then_some(found)
}

fn drawn(outcome: &Outcome, curves: &[Curve]) -> Plots {
    let mut plots = Plots::new();
    let colours = style::colours(outcome.summary.numbers.creep().len());
    for (times, values, row) in curves {
        let points: Vec<Point> = times.iter().copied().zip(values.iter().copied()).collect();
        let (color, last) = (&colours[*row], points[points.len() - 1]);
        plots.push(line(points, color, 2.0, None));
        if outcome.summary.numbers.creep().get(*row).is_some_and(|at| at.failure_time.is_some()) {
            let failure = ScatterPlot::new().with_data([last]).with_color(color).with_size(5.0);
            plots.push(Plot::Scatter(failure.with_marker(MarkerShape::Cross)));
        }
    }
    plots
}

/// A layout with the axis of time.
fn in_time(outcome: &Outcome, page: Page, curves: &[Curve], layout: Layout) -> Option<Layout> {
    let ends = style::decades(&<[f64; 2]>::from(style::range(curves.iter().map(|curve| curve.0.as_slice()))));
    let layout = layout.with_log_x().with_x_axis_min(ends.0).with_x_axis_max(ends.1);
    let layout = layout.with_x_tick_format(style::powers(ends));
    let words = style::axis(outcome, "Time t", outcome.record.get("creep_time")?);
    Some(page.titled(layout, &outcome.summary.title).with_x_label(words))
}

/// The forces of the curves, and the marker of failure.
fn entries(outcome: &Outcome, curves: &[Curve]) -> Option<Vec<LegendEntry>> {
    let unit = outcome.summary.units.label(Quantity::Force);
    let force = outcome.record.values("imposed_force")?;
    let colours = style::colours(force.len());
    let entry = |row: usize| {
        let words = format!("F = {}", style::with_unit(force[row], &unit));
        style::line(words, &colours[row], None)
    };
    let mut entries: Vec<LegendEntry> = curves.iter().map(|curve| entry(curve.2)).collect();
    let numbers = outcome.summary.numbers.creep();
    if curves.iter().any(|curve| numbers.get(curve.2).is_some_and(|at| at.failure_time.is_some())) {
        entries.push(style::marker("failure", BLACK, MarkerShape::Cross));
    }
    Some(entries)
}
