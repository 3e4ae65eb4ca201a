//! `hold_curve`: static friction against the logarithm of the hold time, with the fitted healing curve.

use asperity::record::Quantity;
use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape};
use kuva::render::render::Scene;

use super::curve::{computed, errors, line};
use super::measured;
use super::smooth::along_logarithm;
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots};

const DOTS: &str = "2 4";

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (hold, force) = (record.values("hold")?, record.values("static_friction")?);
    let (mut plots, mut legend) = (Plots::new(), Vec::new());
    let others = ["ensemble_force", "compared_force"].into_iter().filter_map(|name| record.values(name));
    let kinetic = outcome.summary.numbers.hold_curve().map(|curve| curve.kinetic_friction);
    let (low, high) = style::range(others.chain([force, kinetic.as_slice()]));
    healing(outcome, hold, &mut plots, &mut legend);
    plots.push(line(along_logarithm(hold, force), BLUE, 2.0, None));
    plots.push(computed(hold, force, BLUE));
    legend.insert(0, style::line("master equation", BLUE, None));
    if let Some(force) = record.values("ensemble_force") {
        let error = record.values("ensemble_error").unwrap_or_default();
        plots.extend(errors(hold, force, error, ORANGE));
        legend.push(style::marker(style::sized_ensemble(outcome), ORANGE, MarkerShape::Circle));
    }
    if let Some(points) = measured::measured(outcome, "compared_hold") {
        plots.push(measured::points(points));
        legend.push(measured::entry());
    }
    let range = style::range([hold, record.values("compared_hold").unwrap_or(&[])]);
    let decades = style::decades(&[range.0, range.1]);
    let layout = style::layout(decades, style::heights(low, high)).with_log_x();
    let layout = layout.with_x_tick_format(style::powers(decades));
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Hold time", record.get("hold")?))
        .with_y_label(style::axis(outcome, "Static friction F_s", record.get("static_friction")?));
    Some(measured::placed(outcome, page, (plots, layout), "compared_hold", legend))
}

/// Points of the fitted curve.
const POINTS: u32 = 200;

/// The fitted curve, and the kinetic friction.
fn healing(outcome: &Outcome, hold: &[f64], plots: &mut Plots, legend: &mut Vec<LegendEntry>) {
    let Some(read) = outcome.summary.numbers.hold_curve() else { return };
    let unit = outcome.summary.units.label(Quantity::Force);
    let ends = [hold[0], hold[hold.len() - 1]];
    if let (Some(slope), Some(at_one)) = (read.healing_per_decade, read.at_one) {
        let cutoff = read.healing_cutoff.unwrap_or(0.0);
        let force = |t: f64| at_one + slope * ((t + cutoff) / (1.0 + cutoff)).log10();
        let time = |k: u32| ends[0] * (ends[1] / ends[0]).powf(f64::from(k) / f64::from(POINTS));
        let fitted = (0..=POINTS).map(time).map(|t| (t, force(t))).collect();
        plots.push(line(fitted, GREY, 1.4, Some(style::DASHES)));
        let time = outcome.summary.units.label(Quantity::Time);
        let from =
            read.healing_cutoff.map(|cutoff| format!(", cutoff time {}", style::with_unit(cutoff, &time)));
        let words =
            format!("healing {} per decade{}", style::with_unit(slope, &unit), from.unwrap_or_default());
        legend.push(style::line(words, GREY, Some(style::DASHES)));
    }
    plots.push(line(ends.map(|t| (t, read.kinetic_friction)).to_vec(), GREY, 1.4, Some(DOTS)));
    let words = format!("kinetic {}", style::with_unit(read.kinetic_friction, &unit));
    legend.push(style::line(words, GREY, Some(DOTS)));
}
