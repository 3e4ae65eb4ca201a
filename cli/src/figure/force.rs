//! `force`: the friction force along the pull.

use asperity::record::Quantity;
use asperity::task::summary::StaticFriction;
use asperity_runner::output::Outcome;
use kuva::plot::{BandPlot, LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, curve, errors, line, spread};
use super::simplify::bends;
use super::style::{self, BLACK, BLUE, GREY, ORANGE, Page, Plots};
use super::{legend, measured, ticks};

/// Largest number of markers of the force of the ensemble.
const MARKERS: usize = 160;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    record.get("breaking_rate")?;
    let (position, force) = (record.values("position")?, record.values("force")?);
    let (mut plots, mut legend) = (Plots::new(), Vec::new());
    band(outcome, position, force, &mut plots, &mut legend);
    plots.push(line(straight(position, force, force), BLUE, 2.0, None));
    legend.insert(0, style::line("master equation", BLUE, None));
    if let Some(points) = measured::measured(outcome, "compared_position") {
        plots.push(measured::points(points));
        legend.push(measured::entry());
    }
    ensemble(outcome, position, &mut plots, &mut legend);
    let axes = axes(outcome, page, position, force)?;
    frictions(outcome, position, height(&axes), (&mut plots, &mut legend));
    let loaded_by = outcome.summary.numbers.friction().and_then(|friction| friction.friction_coefficients);
    let axes = match loaded_by {
        Some(coefficients) => loaded(axes, coefficients.normal_load),
        None => axes,
    };
    if let Some(residuals) = measured::residuals(outcome, "compared_position") {
        return Some(measured::with_residuals(outcome, page, (plots, axes), residuals, legend));
    }
    let scene = match loaded_by {
        Some(_) => ticks::twin(plots, Vec::new(), axes),
        None => ticks::panel(plots, axes),
    };
    Some(legend::placed(scene, &legend, &[0]))
}

fn axes(outcome: &Outcome, page: Page, position: &[f64], force: &[f64]) -> Option<Layout> {
    let record = &outcome.record;
    let others = ["ensemble_force", "compared_force"].into_iter().filter_map(|name| record.values(name));
    let (low, high) = style::range(others.chain([force]));
    let x = (position[0], *position.last()?);
    Some(
        page.titled(style::layout(x, (low.min(0.0), style::headroom(high))), &outcome.summary.title)
            .with_x_label(style::axis(outcome, "Position X", record.get("position")?))
            .with_y_label(style::axis(outcome, "Friction force F", record.get("force")?)),
    )
}

/// A second axis with friction coefficients.
fn loaded(layout: Layout, normal_load: f64) -> Layout {
    let (low, high) = (layout.y_axis_min.unwrap_or(0.0), layout.y_axis_max.unwrap_or(1.0));
    let (low, high) = (low / normal_load, high / normal_load);
    layout
        .with_y2_range(low, high)
        .with_y2_axis_min(low)
        .with_y2_axis_max(high)
        .with_y2_label("Friction coefficient")
}

fn band(outcome: &Outcome, x: &[f64], force: &[f64], plots: &mut Plots, legend: &mut Vec<LegendEntry>) {
    let (Some(std), Some(sample)) = (outcome.record.values("force_std"), outcome.summary.sample) else {
        return;
    };
    let edge = |side: f64| -> Vec<f64> { force.iter().zip(std).map(|(f, s)| f + side * s).collect() };
    let (lower, upper) = (straight(x, &edge(-2.0), force), straight(x, &edge(2.0), force));
    // The two edges may be thinned at different positions: the outline follows one edge and returns along the other.
    let x: Vec<f64> = merged(&lower, &upper);
    let (lower, upper) = (along(&x, &lower), along(&x, &upper));
    plots.push(Plot::Band(BandPlot::new(x, lower, upper).with_color(BLUE).with_opacity(0.22)));
    legend.push(style::area(format!("±2 std of {} contacts", style::digits(sample)), "#C7DFEE"));
}

/// A curve whose axes go at least as far as the whole force, without points on straight lines between others.
fn straight(x: &[f64], y: &[f64], force: &[f64]) -> Vec<Point> {
    let (low, high) = style::range(std::iter::once(force));
    let width = x.last().zip(x.first()).map_or(0.0, |(end, start)| end - start);
    bends(&curve(x, y), (width, high - low))
}

fn merged(a: &[Point], b: &[Point]) -> Vec<f64> {
    let mut x: Vec<f64> = a.iter().chain(b).map(|p| p.0).collect();
    x.sort_by(f64::total_cmp);
    x.dedup();
    x
}

/// The values of a curve at ascending positions, by linear interpolation.
fn along(x: &[f64], points: &[Point]) -> Vec<f64> {
    let mut next = 1;
    let height = |&x: &f64| {
        while next + 1 < points.len() && points[next].0 < x {
            next += 1;
        }
        let (Some(&a), Some(&b)) = (points.get(next - 1), points.get(next)) else { return points[0].1 };
        a.1 + (b.1 - a.1) * ((x - a.0) / (b.0 - a.0))
    };
    x.iter().map(height).collect()
}

fn ensemble(outcome: &Outcome, position: &[f64], plots: &mut Plots, legend: &mut Vec<LegendEntry>) {
    let record = &outcome.record;
    let Some(force) = record.values("ensemble_force") else { return };
    let error = record.values("ensemble_error").unwrap_or_default();
    let points: Vec<Point> = position.iter().copied().zip(force.iter().copied()).collect();
    let shown = spread(&points, (style::range([position]), style::range([force])), MARKERS);
    let pick = |values: &[f64]| shown.iter().filter_map(|&i| values.get(i).copied()).collect::<Vec<_>>();
    plots.extend(errors(&pick(position), &pick(force), &pick(error), ORANGE));
    legend.push(style::marker(style::sized_ensemble(outcome), ORANGE, MarkerShape::Circle));
}

/// The force from the lower to the upper end of the axis.
fn height(axes: &Layout) -> f64 {
    axes.y_axis_max.unwrap_or(1.0) - axes.y_axis_min.unwrap_or(0.0)
}

/// Lines and markers of kinetic and static friction, on an axis of this height.
fn frictions(
    outcome: &Outcome,
    position: &[f64],
    height: f64,
    (plots, legend): (&mut Plots, &mut Vec<LegendEntry>),
) {
    /// The marker points at the peak from above, by this part of the height.
    const ABOVE: f64 = 0.025;
    let summary = &outcome.summary;
    let unit = summary.units.label(Quantity::Force);
    let Some(friction) = summary.numbers.friction() else { return };
    let ends = [position[0], position[position.len() - 1]];
    let kinetic = ends.map(|x| (x, friction.kinetic_friction)).to_vec();
    plots.push(line(kinetic, GREY, 1.4, Some(style::DASHES)));
    let label = format!("kinetic {}", style::with_unit(friction.kinetic_friction, &unit));
    legend.push(style::line(label, GREY, Some(style::DASHES)));
    if let StaticFriction::Reached { force, position } = friction.static_friction {
        let point = ScatterPlot::new()
            .with_data([(position, force + ABOVE * height)])
            .with_color(BLACK)
            .with_size(5.0);
        plots.push(Plot::Scatter(point.with_marker(MarkerShape::TriangleDown)));
        legend.push(style::marker(
            format!("static {}", style::with_unit(force, &unit)),
            BLACK,
            MarkerShape::TriangleDown,
        ));
    }
}
