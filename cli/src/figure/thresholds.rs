//! `thresholds`: the distribution of the drives at which coupled contacts first break, with that of thresholds and mean field.

use asperity_runner::output::Outcome;
use kuva::plot::MarkerShape;
use kuva::render::render::Scene;

use super::curve::{curve, errors, line};
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots};
use super::ticks;

const DASHES: &str = "8 5";

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let found = outcome.summary.numbers.renormalisation()?;
    let (drive, measured) = (record.values("drive")?, record.values("measured_density")?);
    let free = record.values("free_density")?;
    let mean_field = record.values("mean_field_density");
    let mut plots: Plots = vec![line(curve(drive, free), GREY, 1.8, Some(DASHES))];
    let mut legend = vec![style::line("thresholds, P_c", GREY, Some(DASHES))];
    if let Some(density) = mean_field {
        plots.push(line(curve(drive, density), BLUE, 2.0, None));
        legend.push(style::line(format!("mean field, κ = {}", style::digits(found.coupling)), BLUE, None));
    }
    plots.extend(errors(drive, measured, record.values("measured_error")?, ORANGE));
    let breaks = format!("first breaks, {} × {}", found.runs, found.size);
    legend.push(style::marker(breaks, ORANGE, MarkerShape::Circle));
    let top = style::range([measured, free, mean_field.unwrap_or(&[])]).1;
    let ends = (drive[0], drive[drive.len() - 1]);
    let layout = page
        .titled(style::layout(ends, (0.0, style::headroom(top))), &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Drive X", record.get("drive")?))
        .with_y_label(style::axis(outcome, "Density of contacts that break", record.get("free_density")?));
    Some(ticks::panel(plots, style::legend_below(layout, legend)))
}
