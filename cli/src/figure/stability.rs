//! `stability`: none, transient or persistent stick-slip over the velocity of the load point and the stiffness of the spring,
//! with the stiffness at which persistent stick-slip ends and the critical stiffnesses.

use asperity_runner::output::Outcome;
use kuva::plot::{MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, line};
use super::style::{self, BLACK, BLUE, GREY, ORANGE, Page, Plots, RED};
use super::{legend, ticks};

const DASHES: &str = "8 5";
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
    let ends = (low / air, high * air);
    for (name, words, color, dashes) in [
        ("persistent_stiffness", "end of persistent stick-slip", RED, None),
        ("critical_stiffness", "K_c of the first pull", GREY, Some(DASHES)),
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
