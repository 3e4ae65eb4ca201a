//! Measured forces as points, and their residuals, the measured less the computed forces, in a panel below.

use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, curve, line};
use super::grid::Grid;
use super::style::{self, GREEN, GREY, Page, Plots};
use super::{legend, ticks};

/// Heights of the panels.
const HEIGHT: f64 = 340.0;
pub const RESIDUALS: f64 = 130.0;
const MARGINS: (f64, f64) = (14.0, 24.0);
const DOTS: &str = "2 4";
/// Size of points where there are few of them, and where there are many.
const SIZES: (f64, f64) = (2.8, 1.6);
const MANY: usize = 200;

/// The measured points against the variable `along`, thinned where they are many.
pub fn measured(outcome: &Outcome, along: &str) -> Option<Vec<Point>> {
    against(outcome, along, "compared_force")
}

/// The measured less the computed forces against the variable `along`, where a force is computed, thinned where they are many.
pub fn residuals(outcome: &Outcome, along: &str) -> Option<Vec<Point>> {
    against(outcome, along, "compared_residual")
}

fn against(outcome: &Outcome, along: &str, name: &str) -> Option<Vec<Point>> {
    let [x, y] = [along, name].map(|name| outcome.record.values(name));
    Some(curve(x?, y?))
}

/// The entry of measured points in a legend.
pub fn entry() -> LegendEntry {
    style::marker("measured", GREEN, MarkerShape::Circle)
}

/// Measured points as they are drawn.
pub fn points(points: Vec<Point>) -> Plot {
    let size = if points.len() > MANY { SIZES.1 } else { SIZES.0 };
    Plot::Scatter(ScatterPlot::new().with_data(points).with_color(GREEN).with_size(size))
}

/// A picture of one panel, above one of the residuals where there are measured points along this variable.
pub fn placed(
    outcome: &Outcome,
    page: Page,
    (plots, layout): (Plots, Layout),
    along: &str,
    legend: Vec<LegendEntry>,
) -> Scene {
    match residuals(outcome, along) {
        Some(residuals) => with_residuals(outcome, page, (plots, layout), residuals, legend),
        None => legend::placed(ticks::panel(plots, layout), &legend, &[0]),
    }
}

/// The picture with a panel of the residuals of the measured points.
pub fn with_residuals(
    outcome: &Outcome,
    page: Page,
    (plots, layout): (Plots, Layout),
    residuals: Vec<Point>,
    legend: Vec<LegendEntry>,
) -> Scene {
    let ends = (layout.x_axis_min.unwrap_or(0.0), layout.x_axis_max.unwrap_or(1.0));
    let label = layout.x_label.clone().unwrap_or_default();
    let [above, below] = [HEIGHT, RESIDUALS].map(|height| page.height(height));
    let sides = if layout.y2_range.is_some() { style::TWO_SIDES } else { style::SIDES };
    let (residuals, mut lower) = panel_of_residuals(outcome, ends, residuals);
    (lower.log_x, lower.x_tick_format) = (layout.log_x, layout.x_tick_format.clone());
    let grid = Grid::new(2, 1, (page.width, above))
        .with_title(page.heading(&outcome.summary.title))
        .with_row_height(1, below + style::LABEL_HEIGHT)
        .with_spacing(4.0);
    let mut upper = style::stacked(layout, MARGINS, sides);
    (upper.title, upper.x_label) = (None, None);
    let lower =
        style::stacked(lower.with_x_label(label), (MARGINS.0, MARGINS.1 + style::LABEL_HEIGHT), sides);
    legend::placed(ticks::panels(grid, vec![plots, residuals], vec![upper, lower]), &legend, &[0])
}

/// The panel of residuals between these ends.
pub fn panel_of_residuals(outcome: &Outcome, ends: (f64, f64), residuals: Vec<Point>) -> (Plots, Layout) {
    let largest = residuals.iter().map(|point| point.1.abs()).fold(0.0, f64::max);
    let zero = line(vec![(ends.0, 0.0), (ends.1, 0.0)], GREY, 1.0, Some(DOTS));
    let top = style::headroom(1.1 * largest);
    let words = outcome.record.get("compared_residual").map(|left| style::axis(outcome, "Residual", left));
    // As many ticks as above: those of the positions are the same.
    let layout = style::layout(ends, (-top, top)).with_y_label(words.unwrap_or_default());
    (vec![zero, points(residuals)], layout)
}
