//! `spectrum` of a fit to a record in steady sliding: the measured periodogram, averaged over neighbouring wave numbers, with its
//! expectation by the fitted contacts.

use asperity_runner::output::Outcome;
use kuva::plot::{MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{curve, line};
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots};
use super::{legend, ticks};

/// Bins of wave numbers per factor e.
const BINS: f64 = 24.0;
/// Largest number of points of the line.
const POINTS: usize = 3000;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (q, measured, expected) = (
        record.values("fit_wave_number")?,
        record.values("fit_periodogram")?,
        record.values("fit_expected_periodogram")?,
    );
    let means = binned(q, measured);
    let heights: Vec<f64> = means.iter().map(|mean| mean.1).collect();
    let (low, high) = style::range([heights.as_slice(), expected]);
    let fit = &outcome.summary.numbers.fit()?;
    let spacing = std::f64::consts::PI / q[q.len() - 1];
    let floor = fit.reading * fit.reading * spacing;
    let bottom = low / 2.0;
    let mut plots: Plots =
        vec![Plot::Scatter(ScatterPlot::new().with_data(means).with_color(ORANGE).with_size(2.2))];
    let thinned = (0..q.len()).step_by(q.len().div_ceil(POINTS));
    plots.push(line(thinned.map(|k| (q[k], expected[k])).collect(), BLUE, 2.0, None));
    let mut legend = vec![
        style::marker("measured periodogram, averaged", ORANGE, MarkerShape::Circle),
        style::line("expectation of the fit", BLUE, None),
    ];
    let ends = style::decades(q);
    if floor > bottom {
        plots.push(line(curve(&[ends.0, ends.1], &[floor, floor]), GREY, 1.4, Some(style::DASHES)));
        legend.push(style::line("error of a reading", GREY, Some(style::DASHES)));
    }
    let heights = (bottom, 2.0 * high);
    let layout = style::layout(ends, heights).with_log_scale();
    let layout = layout.with_x_tick_format(style::powers(ends)).with_y_tick_format(style::powers(heights));
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Wave number q", record.get("fit_wave_number")?))
        .with_y_label(style::axis(outcome, "Spectrum S", record.get("fit_periodogram")?));
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}

/// Means of wave numbers and of values over bins of equal width in ln q; the first bins hold one each.
fn binned(q: &[f64], values: &[f64]) -> Vec<(f64, f64)> {
    let bin = |q: f64| (BINS * q.ln()).floor();
    let mut means = Vec::new();
    let mut first = 0;
    for next in 1..=q.len() {
        if next == q.len() || bin(q[next]) > bin(q[first]) {
            let mean = |of: &[f64]| of[first..next].iter().sum::<f64>() / (next - first) as f64;
            means.push((mean(q), mean(values)));
            first = next;
        }
    }
    means
}
