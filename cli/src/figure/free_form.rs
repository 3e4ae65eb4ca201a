//! `free_form`: the density of thresholds of free form, with its interval of 95 %.

use asperity_runner::output::Outcome;
use kuva::plot::BandPlot;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{curve, line};
use super::style::{self, BLUE, Page, Plots};
use super::{legend, ticks};

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (threshold, density) = (record.values("free_form_threshold")?, record.values("free_form_density")?);
    let (low, high) = (record.values("free_form_density_low")?, record.values("free_form_density_high")?);
    // The interval of the tails, where nothing is known, may be higher than the density anywhere.
    let highest = 1.5 * style::range([density]).1;
    let cut: Vec<f64> = high.iter().map(|height| height.min(highest)).collect();
    let top = style::headroom(style::range([cut.as_slice()]).1);
    let band = BandPlot::new(threshold.to_vec(), low.to_vec(), cut).with_color(BLUE).with_opacity(0.22);
    let plots: Plots = vec![Plot::Band(band), line(curve(threshold, density), BLUE, 2.0, None)];
    let legend = vec![style::line("density of free form", BLUE, None), style::area("95 %", "#C7DFEE")];
    let layout = style::layout(style::range([threshold]), (0.0, top));
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Threshold", record.get("free_form_threshold")?))
        .with_y_label(style::axis(outcome, "Density of thresholds", record.get("free_form_density")?));
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}
