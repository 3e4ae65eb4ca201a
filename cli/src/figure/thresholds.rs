//! `thresholds`: the distribution of the drives at which coupled contacts first break, with that of thresholds and mean field.

use std::ops::Range;

use asperity_runner::output::Outcome;
use kuva::plot::MarkerShape;
use kuva::render::render::Scene;

use super::curve::{Point, errors, line};
use super::smooth::smooth;
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots};
use super::{legend, ticks};

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let found = outcome.summary.numbers.renormalisation()?;
    let (drive, measured) = (record.values("drive")?, record.values("measured_density")?);
    let free = record.values("free_density")?;
    let mean_field = record.values("mean_field_density");
    let curve =
        |density: &[f64]| smooth(&drive.iter().copied().zip(density.iter().copied()).collect::<Vec<Point>>());
    let mut plots: Plots = vec![line(curve(free), GREY, 1.8, Some(style::DASHES))];
    let mut legend = vec![style::line("thresholds, P_c", GREY, Some(style::DASHES))];
    if let Some(density) = mean_field {
        plots.push(line(curve(density), BLUE, 2.0, None));
        legend.push(style::line(format!("mean field, κ = {}", style::digits(found.coupling)), BLUE, None));
    }
    let top = style::range([measured, free, mean_field.unwrap_or(&[])]).1;
    let visible = |density: &[f64]| filled(density, style::INVISIBLE * top);
    // Without empty bins, and those that cannot be distinguished from them.
    let bins: Vec<usize> = (0..measured.len()).filter(|&i| measured[i] > style::INVISIBLE * top).collect();
    let pick = |values: &[f64]| -> Vec<f64> { bins.iter().map(|&i| values[i]).collect() };
    plots.extend(errors(&pick(drive), &pick(measured), &pick(record.values("measured_error")?), ORANGE));
    let breaks = format!("first breaks, {} × {}", found.runs, found.size);
    legend.push(style::marker(breaks, ORANGE, MarkerShape::Circle));
    let shown = [Some(visible(measured)), Some(visible(free)), mean_field.map(visible)];
    let shown = shown.into_iter().flatten().reduce(|a, b| a.start.min(b.start)..a.end.max(b.end))?;
    let ends = (drive[shown.start], drive[shown.end.max(shown.start + 2).min(drive.len()) - 1]);
    let layout = page
        .titled(style::layout(ends, (0.0, style::headroom(top))), &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Drive X", record.get("drive")?))
        .with_y_label(style::axis(outcome, "Probability density", record.get("free_density")?));
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}

/// From the first to the last value above `least`.
fn filled(values: &[f64], least: f64) -> Range<usize> {
    let above = |value: &f64| *value > least;
    let first = values.iter().position(above).unwrap_or(0);
    first..values.iter().rposition(above).map_or(first, |last| last + 1)
}
