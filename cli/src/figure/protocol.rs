//! `protocol`: velocity (top) and force (bottom) against time. A velocity that spans decades has a logarithmic axis.

use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape};
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::advance::is_in_time;
use super::curve::{Point, curve, errors, line, spread, thinned};
use super::grid::Grid;
use super::style::{self, BLUE, GREEN, ORANGE, Page, Plots};
use super::{legend, ticks};

/// Heights of the panels of velocity and force.
const HEIGHTS: (f64, f64) = (150.0, 330.0);
const MARGINS: (f64, f64) = (12.0, 24.0);
/// Largest number of markers of the force of the ensemble.
const MARKERS: usize = 160;
/// Ratio of the highest velocity to the lowest one above 0 from which on the axis is logarithmic, and the most that is shown.
const DECADES: (f64, f64) = (1e2, 1e10);
/// Velocities against the motion over the highest one that rounding may leave at rest.
const BACKWARD: f64 = 1e-6;
/// Most labels of an axis of velocities.
const LABELS: usize = 4;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    // A driven interface has pictures of its own.
    if outcome.summary.numbers.catalogue().is_some() && !is_in_time(&outcome.record) {
        return None;
    }
    let (above, below) = (velocity(outcome)?, force(outcome)?);
    let grid = Grid::new(2, 1, (page.width, page.height(HEIGHTS.0)))
        .with_title(page.heading(&outcome.summary.title))
        .with_row_height(1, page.height(HEIGHTS.1) + style::LABEL_HEIGHT);
    let scene = ticks::panels(grid, vec![above.0, below.0], vec![above.1, below.1]);
    Some(legend::placed(scene, &entries(outcome), &[1]))
}

fn entries(outcome: &Outcome) -> Vec<LegendEntry> {
    // The contacts of cells are of one kind; a rigid slider and a block have both.
    if outcome.summary.numbers.catalogue().is_some() && outcome.summary.disorder.is_some() {
        return vec![style::line(style::sized_ensemble(outcome), BLUE, None)];
    }
    let mut entries = vec![style::line("master equation", BLUE, None)];
    if outcome.record.get("ensemble_force").is_some() && outcome.record.get("ensemble_drive").is_none() {
        entries.push(style::marker(style::sized_ensemble(outcome), ORANGE, MarkerShape::Circle));
    }
    entries
}

fn velocity(outcome: &Outcome) -> Option<(Plots, Layout)> {
    let record = &outcome.record;
    let (time, velocity) = (record.values("time")?, record.values("velocity")?);
    let axis = decades(velocity);
    let shown = |v: &f64| axis.map_or(*v, |(low, _)| v.max(UNSEEN * low));
    let velocity: Vec<f64> = velocity.iter().map(shown).collect();
    let plots = vec![line(thinned(steps(time, &velocity)), GREEN, 1.8, None)];
    let (low, high) = style::range([velocity.as_slice()]);
    let heights = axis.unwrap_or_else(|| style::from_zero(low, high));
    let layout = style::layout((0.0, *time.last()?), heights);
    let layout = match axis {
        Some(ends) => layout.with_log_y().with_y_tick_format(style::some_powers(ends, LABELS)),
        None => layout.with_ticks(4),
    };
    let layout = layout.with_y_label(style::axis(outcome, "Velocity v", record.get("velocity")?));
    Some((plots, style::stacked(layout, MARGINS, style::SIDES)))
}

/// The ends of a logarithmic axis, if velocities span decades. A slider at rest is below the lower one.
fn decades(velocity: &[f64]) -> Option<(f64, f64)> {
    let (lowest, highest) = style::range([velocity]);
    let slowest = velocity.iter().copied().filter(|v| *v > 0.0).fold(f64::INFINITY, f64::min);
    let spans = highest > DECADES.0 * slowest && lowest >= -BACKWARD * highest;
    spans.then(|| style::decades(&[slowest.max(highest / DECADES.1), highest]))
}

/// A velocity below the axis, over its lower end: a line leaves the frame where the slider comes to rest.
const UNSEEN: f64 = 0.1;

/// The velocity as a curve that jumps at the beginning of a step: a point of the trace has the velocity after it.
fn steps(time: &[f64], velocity: &[f64]) -> Vec<Point> {
    let before = std::iter::once(velocity[0]).chain(velocity.iter().copied());
    let points = time.iter().zip(before.zip(velocity));
    points.flat_map(|(&t, (before, &after))| [(t, before), (t, after)]).collect()
}

fn force(outcome: &Outcome) -> Option<(Plots, Layout)> {
    let record = &outcome.record;
    let (time, force) = (record.values("time")?, record.values("force")?);
    // An ensemble under a block has its own points.
    let others = record.values("ensemble_force").filter(|_| record.get("ensemble_drive").is_none());
    let (low, high) = style::range([force, others.unwrap_or_default()]);
    let mut plots = vec![line(curve(time, force), BLUE, 2.0, None)];
    if let Some(force) = others {
        let error = record.values("ensemble_error").unwrap_or_default();
        let points: Vec<Point> = time.iter().copied().zip(force.iter().copied()).collect();
        let shown = spread(&points, (style::range([time]), style::range([force])), MARKERS);
        let pick = |values: &[f64]| shown.iter().filter_map(|&i| values.get(i).copied()).collect::<Vec<_>>();
        plots.extend(errors(&pick(time), &pick(force), &pick(error), ORANGE));
    }
    let layout = style::layout((0.0, *time.last()?), style::heights(low, high))
        .with_x_label(style::axis(outcome, "Time t", record.get("time")?))
        .with_y_label(style::axis(outcome, "Friction force F", record.get("force")?));
    Some((plots, style::stacked(layout, (MARGINS.0, MARGINS.1 + style::LABEL_HEIGHT), style::SIDES)))
}
