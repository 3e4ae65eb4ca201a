//! `velocity_step`: the force after each velocity step, with the fitted rate-and-state curve, and the residuals of a measured one
//! below.

use asperity::task::summary::{MeasuredRateState, ProtocolStep, RateState, SpringRateState};
use asperity_runner::output::Outcome;
use kuva::plot::LegendEntry;
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::curve::{Point, line, thinned};
use super::grid::Grid;
use super::style::{self, BLACK, BLUE, Page, Plots, RED};
use super::{legend, measured, ticks};

/// Largest number of steps.
const STEPS: usize = 4;
/// Height of a panel.
const HEIGHT: f64 = 240.0;
const MARGINS: (f64, f64) = (30.0, 24.0);
/// Upper margin of a panel without a title.
const UNTITLED: f64 = 10.0;
/// Displacement shown before a step, as a fraction of that after it.
const BEFORE: f64 = 0.1;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let read =
        outcome.summary.numbers.steps().iter().filter_map(|step| Some((step, step.rate_state.as_ref()?)));
    let panels: Option<Vec<_>> = read.take(STEPS).map(|(step, read)| panels(outcome, step, read)).collect();
    let (plots, mut layouts): (Vec<_>, Vec<_>) = panels?.into_iter().flatten().unzip();
    let label = style::axis(outcome, "Displacement since the step", outcome.record.get("position")?);
    let lowest = layouts.pop()?;
    let (top, bottom) = (lowest.force_margin_top?, lowest.force_margin_bottom?);
    layouts.push(lowest.with_x_label(label).with_force_margins_y(top, bottom + style::LABEL_HEIGHT));
    let mut heights: Vec<f64> = layouts.iter().map(|layout| page.height(height(layout))).collect();
    *heights.last_mut()? += style::LABEL_HEIGHT;
    let forces: Vec<usize> = (0..layouts.len()).filter(|&panel| layouts[panel].title.is_some()).collect();
    let grid = Grid::new(layouts.len(), 1, (page.width, page.height(HEIGHT)))
        .with_title(page.heading(&outcome.summary.title));
    let rows = heights.into_iter().enumerate();
    let grid = rows.fold(grid, |grid, (row, height)| grid.with_row_height(row, height));
    Some(legend::placed(ticks::panels(grid, plots, layouts), &entries(outcome), &forces))
}

/// The height of a panel: those of forces alone have a title.
fn height(layout: &Layout) -> f64 {
    if layout.title.is_some() { HEIGHT } else { measured::RESIDUALS }
}

fn entries(outcome: &Outcome) -> Vec<LegendEntry> {
    let mut entries = vec![
        style::line("master equation", BLUE, None),
        style::line("rate-and-state fit", RED, Some(style::DASHES)),
    ];
    if outcome.record.get("compared_force").is_some() {
        entries.push(measured::entry());
    }
    if outcome.summary.numbers.steps().iter().any(ProtocolStep::is_measured) {
        entries.push(style::line("fit of measured", BLACK, Some(style::DASHES)));
    }
    entries
}

/// The panel of a step, and that of the residuals of measured points.
fn panels(outcome: &Outcome, step: &ProtocolStep, read: &RateState) -> Option<Vec<(Plots, Layout)>> {
    let end = step.velocity * step.duration;
    let shown = (-BEFORE * end)..=end;
    let since = |names: (&str, &str)| -> Option<Vec<Point>> {
        let (x, y) = (outcome.record.values(names.0)?, outcome.record.values(names.1)?);
        let points = x.iter().zip(y).map(|(x, &y)| (x - step.position, y));
        Some(points.filter(|point| shown.contains(&point.0) && point.1.is_finite()).collect())
    };
    let computed = since(("position", "force"))?;
    let compared = since(("compared_position", "compared_force")).unwrap_or_default();
    let ends = (*shown.start(), end);
    let residuals = since(("compared_position", "compared_residual")).unwrap_or_default();
    let residuals = (!residuals.is_empty()).then(|| panel_of_residuals(outcome, ends, residuals));
    let computed = thinned(computed);
    let compared = thinned(compared);
    let fitted: Vec<Point> =
        computed.iter().filter(|p| p.0 >= read.peak).map(|p| (p.0, fit(step, read, p.0))).collect();
    let size = (step.velocity / read.velocity_before).ln();
    let compared_fit: Vec<Point> = match &step.measured_spring {
        Some(found) => fit_behind(found, &compared),
        None => step.measured.iter().flat_map(|found| fit_of(found, size, &compared)).collect(),
    };
    let heights: Vec<f64> =
        [&computed, &compared, &fitted, &compared_fit].into_iter().flatten().map(|p| p.1).collect();
    let (low, high) = style::range([heights.as_slice()]);
    let air = 0.1 * (high - low);
    let plots = vec![
        measured::points(compared),
        line(compared_fit, BLACK, 1.6, Some(style::DASHES)),
        line(computed, BLUE, 2.0, None),
        line(fitted, RED, 1.6, Some(style::DASHES)),
    ];
    let speed =
        |v: f64| style::with_unit(v, &outcome.summary.units.label(asperity::record::Quantity::Velocity));
    let layout = style::layout(ends, (low - air, high + air))
        .with_title(format!("v = {} → {}", speed(read.velocity_before), speed(step.velocity)))
        .with_title_size(12)
        .with_y_label(style::axis(outcome, "Friction force F", outcome.record.get("force")?))
        .with_ticks(4);
    Some([(plots, style::stacked(layout, MARGINS, style::SIDES))].into_iter().chain(residuals).collect())
}

fn panel_of_residuals(outcome: &Outcome, ends: (f64, f64), residuals: Vec<Point>) -> (Plots, Layout) {
    let (plots, layout) = measured::panel_of_residuals(outcome, ends, thinned(residuals));
    (plots, style::stacked(layout.with_ticks(4), (UNTITLED, MARGINS.1), style::SIDES))
}

/// The fitted force at a displacement from the peak.
fn fit(step: &ProtocolStep, read: &RateState, displacement: f64) -> f64 {
    let fallen = -(-(displacement - read.peak) / read.distance).exp_m1();
    let size = (step.velocity / read.velocity_before).ln();
    read.force_before + size * (read.a - read.b * fallen)
}

/// The fit with the spring of a machine at points after the step.
pub fn fit_behind(found: &SpringRateState, points: &[Point]) -> Vec<Point> {
    let at: Vec<f64> = points.iter().map(|point| point.0).collect();
    let forces = found.forces(&at);
    at.into_iter().zip(forces).collect()
}

/// The fit of the compared curve at its points from the peak on.
fn fit_of(found: &MeasuredRateState, size: f64, points: &[Point]) -> Vec<Point> {
    let force = |x: f64| {
        let fallen = -(-(x - found.peak) / found.distance.value).exp_m1();
        found.force_before.value + size * (found.a.value - found.b.value * fallen)
    };
    points.iter().filter(|point| point.0 >= found.peak).map(|point| (point.0, force(point.0))).collect()
}
