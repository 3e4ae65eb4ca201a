//! `stability`: none, transient or persistent stick-slip over the velocity of the load point and the stiffness of the spring,
//! with the stiffness at which persistent stick-slip ends, also over single contacts, and the critical stiffnesses.

use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, errors, line};
use super::style::{self, BLACK, BLUE, GREY, ORANGE, Page, Plots, RED};
use super::{legend, ticks};

const DOTS: &str = "2 4";

/// Values of `stick_slip`, their names and colours.
const KINDS: [(f64, &str, &str); 3] =
    [(0.0, "no stick-slip", "#C8C8C8"), (1.0, "transient", BLUE), (2.0, "persistent", ORANGE)];

/// A picture of two velocities and two stiffnesses or more.
pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let kinds = record.values("stick_slip")?;
    let (velocities, stiffnesses) = (record.values("velocity")?, record.values("stiffness")?);
    if velocities.len() < 2 || stiffnesses.len() < 2 {
        return None;
    }
    let place = |i: usize| (velocities[i / stiffnesses.len()], stiffnesses[i % stiffnesses.len()]);
    let (mut plots, mut legend) = (Plots::new(), Vec::new());
    for (value, words, color) in KINDS {
        let points: Vec<Point> = (0..kinds.len()).filter(|&i| kinds[i] == value).map(place).collect();
        legend.push(style::marker(words, color, MarkerShape::Square));
        let markers = ScatterPlot::new().with_data(points).with_color(color).with_size(7.0);
        plots.push(Plot::Scatter(markers.with_marker(MarkerShape::Square)));
    }
    let undecided: Vec<Point> = (0..kinds.len()).filter(|&i| kinds[i].is_nan()).map(place).collect();
    if !undecided.is_empty() {
        legend.push(style::marker("undecided", BLACK, MarkerShape::Cross));
        let markers = ScatterPlot::new().with_data(undecided).with_color(BLACK).with_size(5.0);
        plots.push(Plot::Scatter(markers.with_marker(MarkerShape::Cross)));
    }
    let (low, high) = style::range([stiffnesses]);
    let air = (high / low).powf(0.06);
    let ends = style::with_labels((low / air, high * air));
    for (name, words, color, dashes) in [
        ("persistent_stiffness", "end of persistent stick-slip", RED, None),
        ("critical_stiffness", "K_c of the first pull", GREY, Some(style::DASHES)),
        ("critical_stiffness_sliding", "K_c of steady sliding", BLACK, Some(DOTS)),
    ] {
        let Some(values) = record.values(name) else { continue };
        let shown = |point: &Point| point.1 > ends.0 && point.1 < ends.1;
        let mut points: Vec<Point> =
            velocities.iter().copied().zip(values.iter().copied()).filter(shown).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        if points.len() > 1 {
            plots.push(line(points, color, 2.0, dashes));
            legend.push(style::line(words, color, dashes));
        }
    }
    simulated(outcome, velocities, ends, &mut plots, &mut legend);
    let mut sorted = velocities.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (first, last) = style::decades(&sorted);
    let layout = style::layout((first, last), ends).with_log_x().with_log_y();
    let layout =
        layout.with_x_tick_format(style::powers((first, last))).with_y_tick_format(style::powers(ends));
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Velocity v", record.get("velocity")?))
        .with_y_label(style::axis(outcome, "Stiffness K", record.get("stiffness")?));
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}

/// The end of persistent stick-slip over single contacts, with its standard deviation over the simulations.
fn simulated(
    outcome: &Outcome,
    velocities: &[f64],
    (low, high): Point,
    plots: &mut Plots,
    legend: &mut Vec<LegendEntry>,
) {
    let values = |name| outcome.record.values(name);
    let Some(means) = values("ensemble_persistent_stiffness") else { return };
    let stds = values("ensemble_persistent_stiffness_std").unwrap_or_default();
    let shown: Vec<usize> = (0..means.len()).filter(|&i| means[i] > low && means[i] < high).collect();
    for &i in &shown {
        let (at, mean) = (velocities[i], means[i]);
        // The lower end of the axis is above 0; that of a bar may not be.
        if let Some(std) = stds.get(i).filter(|std| **std > 0.0) {
            let ends = vec![(at, (mean - std).max(low)), (at, (mean + std).min(high))];
            plots.push(line(ends, RED, 1.4, None));
        }
        plots.extend(errors(&[at], &[mean], &[], RED));
    }
    if !shown.is_empty() {
        let contacts = style::digits(outcome.summary.sample.unwrap_or(f64::NAN));
        let words = format!("end of persistence ± std, N = {contacts}");
        legend.push(style::marker(words, RED, MarkerShape::Circle));
    }
}
