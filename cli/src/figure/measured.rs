//! Measured forces as points, and what is left of them beside the computed curve, in a panel below.

use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, curve, line};
use super::style::{self, GREEN, GREY, Page, Plots};
use super::{legend, ticks};

/// Heights of the panels, and of the label of the lower axis.
const HEIGHT: f64 = 340.0;
pub const RESIDUALS: f64 = 130.0;
const LABEL: f64 = 26.0;
const MARGINS: (f64, f64) = (14.0, 24.0);
const DOTS: &str = "2 4";
/// Size of points where there are few of them, and where there are many.
const SIZES: (f64, f64) = (2.8, 1.6);
const MANY: usize = 200;

/// The measured points against the variable `along`, thinned where they are many.
pub fn measured(outcome: &Outcome, along: &str) -> Option<Vec<Point>> {
    let [x, y] = [along, "compared_force"].map(|name| outcome.record.values(name));
    Some(curve(x?, y?))
}

/// The measured points against the variable `along` of a picture without residuals, and their entry in the legend.
pub fn marked(outcome: &Outcome, along: &str) -> Option<(Plot, LegendEntry)> {
    let [x, y] = [along, "compared_force"].map(|name| outcome.record.values(name));
    let all = x?.iter().copied().zip(y?.iter().copied()).collect();
    Some((points(all), style::marker("measured", GREEN, MarkerShape::Circle)))
}

/// Measured points as they are drawn.
pub fn points(points: Vec<Point>) -> Plot {
    let size = if points.len() > MANY { SIZES.1 } else { SIZES.0 };
    Plot::Scatter(ScatterPlot::new().with_data(points).with_color(GREEN).with_size(size))
}

/// The picture with a panel of what is left of the measured points: their forces less those of the curve.
pub fn with_residuals(
    outcome: &Outcome,
    page: Page,
    (plots, layout): (Plots, Layout),
    (curve, measured): (&[Point], &[Point]),
    legend: Vec<LegendEntry>,
) -> Scene {
    let ends = (layout.x_axis_min.unwrap_or(0.0), layout.x_axis_max.unwrap_or(1.0));
    let label = layout.x_label.clone().unwrap_or_default();
    let (title, size) = page.heading(&outcome.summary.title);
    let [above, below] = [HEIGHT, RESIDUALS].map(|height| page.height(height));
    let sides = if layout.y2_range.is_some() { style::TWO_SIDES } else { style::SIDES };
    let (residuals, lower) = residuals(outcome, ends, (curve, measured));
    let figure = Figure::new(2, 1)
        .with_title(title)
        .with_title_size(size)
        .with_cell_size(page.width, above)
        .with_row_height(1, below + LABEL)
        .with_spacing(4.0);
    let mut upper = panel(layout, sides, 0.0);
    (upper.title, upper.x_label) = (None, None);
    let lower = panel(lower.with_x_label(label), sides, LABEL);
    legend::placed(ticks::panels(figure, vec![plots, residuals], vec![upper, lower]), &legend, &[0])
}

/// What is left of measured points: their forces less those of the curve, between these ends.
pub fn residuals(
    outcome: &Outcome,
    ends: (f64, f64),
    (curve, measured): (&[Point], &[Point]),
) -> (Plots, Layout) {
    let left: Vec<Point> = measured.iter().filter_map(|&(x, y)| Some((x, y - height(curve, x)?))).collect();
    let largest = left.iter().map(|point| point.1.abs()).fold(0.0, f64::max);
    let zero = line(vec![(ends.0, 0.0), (ends.1, 0.0)], GREY, 1.0, Some(DOTS));
    let top = style::headroom(1.1 * largest);
    let words = outcome.record.get("force").map(|force| style::axis(outcome, "Residual", force));
    // As many ticks as above: those of the positions are the same.
    let layout = style::layout(ends, (-top, top)).with_y_label(words.unwrap_or_default());
    (vec![zero, points(left)], layout)
}

/// The height of a curve of ascending points; `None` beyond its ends.
fn height(curve: &[Point], x: f64) -> Option<f64> {
    let next = curve.partition_point(|point| point.0 < x);
    let after = curve.get(next)?;
    if after.0 == x {
        return Some(after.1);
    }
    let before = curve.get(next.checked_sub(1)?)?;
    Some(before.1 + (after.1 - before.1) * ((x - before.0) / (after.0 - before.0)))
}

fn panel(layout: Layout, sides: (f64, f64), label: f64) -> Layout {
    layout
        .with_force_margins_y(MARGINS.0, MARGINS.1 + label)
        .with_force_margins(sides.0, sides.1)
        .with_tick_size(11)
        .with_label_size(13)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_has_heights_between_its_ends() {
        let line = [(0.0, 0.0), (1.0, 2.0), (3.0, 0.0)];
        let heights = [-0.1, 0.0, 0.5, 1.0, 2.0, 3.0, 3.1].map(|x| height(&line, x));
        assert_eq!(heights, [None, Some(0.0), Some(1.0), Some(2.0), Some(1.0), Some(0.0), None]);
    }
}
