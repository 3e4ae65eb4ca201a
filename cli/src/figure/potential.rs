//! `potential`: the energy of slider and contacts against the position, before, at and after the first slip, from that at
//! the position X_1 at which the slip begins.
//!
//! The forces are those of the first loading, on which contacts re-form as they break. Slips by `reset` and `arrest` leave it.

use asperity_runner::output::Outcome;
use kuva::plot::{MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{curve, line};
use super::equilibrium::{end, first_slip};
use super::style::{self, BLACK, BLUE, GREEN, GREY, Page, Plots, RED};
use super::{legend, ticks};

const COLORS: [&str; 3] = [GREY, BLUE, GREEN];

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (end, slip) = (end(record)?, first_slip(record)?);
    let (drives, position) = (record.values("potential_drive")?, record.values("branch_position")?);
    let shown = position.partition_point(|&x| x <= end);
    let (mut plots, mut legend) = (Plots::new(), Vec::new());
    let mut heights: Vec<Vec<f64>> = Vec::new();
    let row_at = |x: f64| position[..shown].partition_point(|&p| p < x).min(shown - 1);
    let origin = row_at(slip.from);
    for ((row, drive), color) in drives.iter().enumerate().zip(COLORS) {
        let energy = &record.row("potential", row)?[..shown];
        let height: Vec<f64> = energy.iter().map(|v| v - energy[origin]).collect();
        plots.push(line(curve(&position[..shown], &height), color, 2.0, None));
        legend.push(style::line(format!("X_T = {}", style::digits(*drive)), color, None));
        heights.push(height);
    }
    let at_slip = heights.get(1)?;
    let place = |x: f64| (x, at_slip[row_at(x)]);
    for (x, color, shape, words) in [
        (slip.from, BLACK, MarkerShape::Circle, "loss of stability"),
        (slip.to, RED, MarkerShape::TriangleDown, "first rest"),
    ] {
        let marker = ScatterPlot::new().with_data([place(x)]).with_color(color).with_size(5.0);
        plots.push(Plot::Scatter(marker.with_marker(shape)));
        legend.push(style::marker(words, color, shape));
    }
    let (low, high) = style::range(heights.iter().map(Vec::as_slice));
    let air = 0.05 * (high - low);
    let layout = page
        .titled(style::layout((0.0, end), (low - air, high + air)), &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Position X", record.get("branch_position")?))
        .with_y_label(style::axis(
            outcome,
            "Potential V(X) − V(X_1), first loading",
            record.get("potential")?,
        ));
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}
