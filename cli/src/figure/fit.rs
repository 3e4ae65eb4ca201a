//! `fit`: the measured forces with the fitted curve and its band, and the whitened residuals below.

use std::ops::Range;

use asperity_runner::output::Outcome;
use kuva::plot::{BandPlot, LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{curve, line};
use super::grid::Grid;
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots};
use super::{legend, ticks};

/// Heights of the panels.
const HEIGHT: f64 = 340.0;
const RESIDUALS: f64 = 150.0;
const MARGINS: (f64, f64) = (14.0, 24.0);
/// Largest number of edges of the band.
const EDGES: usize = 600;
const DOTS: &str = "2 4";

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (position, expected, std) =
        (record.values("reading_position")?, record.values("expected_force")?, record.values("reading_std")?);
    let measured = record.values("measured_force");
    let edge = |side: f64| -> Vec<f64> { expected.iter().zip(std).map(|(f, s)| f + side * s).collect() };
    let (low_edge, high_edge) = (edge(-2.0), edge(2.0));
    let curves = curves(record.values("reading_curve"), position.len());
    let mut forces: Plots = Vec::new();
    let mut legend = vec![style::line("fit", BLUE, None), style::area("±2 std of a reading", "#C7DFEE")];
    for shown in &curves {
        let picked = shown.clone().step_by(shown.len().div_ceil(EDGES).max(1));
        let pick = |values: &[f64]| -> Vec<f64> { picked.clone().map(|i| values[i]).collect() };
        let band = BandPlot::new(pick(position), pick(&low_edge), pick(&high_edge));
        forces.push(Plot::Band(band.with_color(BLUE).with_opacity(0.22)));
    }
    if let Some(measured) = measured {
        let points =
            ScatterPlot::new().with_data(curve(position, measured)).with_color(ORANGE).with_size(1.8);
        forces.push(Plot::Scatter(points));
        legend.insert(0, style::marker("measured", ORANGE, MarkerShape::Circle));
    }
    for shown in &curves {
        let shown = shown.clone();
        forces.push(line(curve(&position[shown.clone()], &expected[shown]), BLUE, 1.6, None));
    }
    let ends = style::range([position]);
    let heights = [low_edge.as_slice(), high_edge.as_slice()].into_iter().chain(measured);
    let (low, high) = style::range(heights);
    let heights = style::heights(low, high);
    let above = panel(ends, heights).with_y_label(style::axis(
        outcome,
        "Friction force F",
        record.get("expected_force")?,
    ));
    let residuals = record.values("whitened_residual").map(|whitened| below(ends, position, whitened));
    let mut panels = vec![(forces, above)];
    panels.extend(residuals);
    let driven = record.get("slider_position").is_some();
    let words = if driven { "Load-point displacement X_T" } else { "Position X" };
    let label = style::axis(outcome, words, record.get("reading_position")?);
    stacked(outcome, page, (panels, label), legend)
}

/// The readings of each curve: where the number of the curve stays the same.
fn curves(numbers: Option<&[f64]>, count: usize) -> Vec<Range<usize>> {
    let changes = |i: &usize| numbers.is_some_and(|numbers| numbers[*i] != numbers[*i - 1]);
    let mut ends: Vec<usize> = (1..count).filter(changes).collect();
    ends.push(count);
    let starts = std::iter::once(0).chain(ends.clone());
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

/// The panels, one above the other, with the label of their common axis below the last.
pub fn stacked(
    outcome: &Outcome,
    page: Page,
    (mut panels, label): (Vec<(Plots, Layout)>, String),
    legend: Vec<LegendEntry>,
) -> Option<Scene> {
    let (plots, lowest) = panels.pop()?;
    panels.push((
        plots,
        lowest.with_x_label(label).with_force_margins_y(MARGINS.0, MARGINS.1 + style::LABEL_HEIGHT),
    ));
    let rows = panels.len();
    let (plots, layouts): (Vec<_>, Vec<_>) = panels.into_iter().unzip();
    let heights = [HEIGHT, RESIDUALS].map(|height| page.height(height));
    let grid = Grid::new(rows, 1, (page.width, heights[0]))
        .with_title(page.heading(&outcome.summary.title))
        .with_row_height(rows - 1, heights[rows - 1] + style::LABEL_HEIGHT)
        .with_spacing(4.0);
    Some(legend::placed(ticks::panels(grid, plots, layouts), &legend, &[0]))
}

/// The whitened residuals between lines at ±2.
pub fn below(ends: (f64, f64), position: &[f64], whitened: &[f64]) -> (Plots, Layout) {
    let largest = whitened.iter().fold(3.0, |most: f64, residual| most.max(residual.abs()));
    let mut plots: Plots = [-2.0, 0.0, 2.0]
        .into_iter()
        .map(|height| line(vec![(ends.0, height), (ends.1, height)], GREY, 1.0, Some(DOTS)))
        .collect();
    let points = ScatterPlot::new().with_data(curve(position, whitened)).with_color(ORANGE).with_size(1.8);
    plots.push(Plot::Scatter(points));
    let layout = panel(ends, (-1.1 * largest, 1.1 * largest)).with_y_label("Whitened residual").with_ticks(4);
    (plots, layout)
}

/// One of the panels, between these ends.
pub fn panel(x: (f64, f64), y: (f64, f64)) -> Layout {
    style::stacked(style::layout(x, y), MARGINS, style::SIDES)
}
