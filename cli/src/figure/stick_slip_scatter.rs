//! `stick_slip_scatter`: in how many simulations of single contacts a slider sticks and slips, over the stiffness of its spring.

use asperity::task::summary::StickSlipNumbers;
use asperity_runner::output::Outcome;
use kuva::plot::{BandPlot, LegendEntry, MarkerShape};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, computed, line};
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots, RED};
use super::{legend, ticks};

/// The answers, their names and colours.
const ANSWERS: [(&str, &str, &str); 3] = [
    ("ensemble_none", "no stick-slip", GREY),
    ("ensemble_transient", "transient", BLUE),
    ("ensemble_persistent", "persistent", ORANGE),
];

/// A picture of one velocity, or none, and of two stiffnesses or more.
pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let persistent = record.get("ensemble_persistent")?;
    let mut order: Vec<usize> = (0..persistent.values.len()).collect();
    let stiffnesses = record.values("stiffness")?;
    let [found] = outcome.summary.numbers.stick_slip() else { return None };
    if stiffnesses.len() < 2 {
        return None;
    }
    order.sort_by(|&i, &j| stiffnesses[i].total_cmp(&stiffnesses[j]));
    let ascending = |values: &[f64]| order.iter().map(|&i| values[i]).collect::<Vec<_>>();
    let x = ascending(stiffnesses);
    let ends = style::decades(&x);
    let (mut plots, mut legend) = (Plots::new(), Vec::new());
    limits(outcome, found, ends, &mut plots, &mut legend);
    for (name, words, color) in ANSWERS {
        let fractions = ascending(record.values(name)?);
        plots.push(line(x.iter().copied().zip(fractions.iter().copied()).collect(), color, 2.0, None));
        plots.push(computed(&x, &fractions, color));
        legend.push(style::marker(words, color, MarkerShape::Circle));
    }
    let layout = style::layout(ends, (0.0, style::headroom(1.0))).with_log_x();
    let layout = layout.with_x_tick_format(style::powers(ends));
    let words = match found.ensemble.as_ref()?.simulations {
        1 => "Fraction of 1 simulation".to_owned(),
        simulations => format!("Fraction of {simulations} simulations"),
    };
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Stiffness K", record.get("stiffness")?))
        .with_y_label(words);
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}

/// Where persistent stick-slip ends: for infinitely many contacts, and over the single contacts with its standard deviation,
/// which one simulation does not have.
fn limits(
    outcome: &Outcome,
    found: &StickSlipNumbers,
    (first, last): Point,
    plots: &mut Plots,
    legend: &mut Vec<LegendEntry>,
) {
    let is_inside = |stiffness: f64| stiffness > first && stiffness < last;
    if let Some(ensemble) = &found.ensemble {
        let (mean, std) = (ensemble.persistent_stiffness.0, ensemble.persistent_stiffness_std.unwrap_or(0.0));
        let edges = vec![(mean - std).max(first), (mean + std).min(last)];
        let contacts = style::digits(outcome.summary.sample.unwrap_or(f64::NAN));
        if is_inside(mean) && edges[0] < edges[1] {
            let band = BandPlot::new(edges, vec![0.0; 2], vec![1.0; 2]);
            plots.push(Plot::Band(band.with_color(RED).with_opacity(0.2)));
            legend.push(style::area(format!("end of persistence ± std, N = {contacts}"), "#F7DFCC"));
        } else if is_inside(mean) {
            plots.push(line(vec![(mean, 0.0), (mean, 1.0)], RED, 1.4, None));
            legend.push(style::line(format!("end of persistence, N = {contacts}"), RED, None));
        }
    }
    if is_inside(found.persistent_stiffness) {
        let points = vec![(found.persistent_stiffness, 0.0), (found.persistent_stiffness, 1.0)];
        plots.push(line(points, RED, 1.4, Some(style::DASHES)));
        legend.push(style::line("end of persistence, N → ∞", RED, Some(style::DASHES)));
    }
}
