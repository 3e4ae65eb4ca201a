//! `main_shocks`: the rate of events before and after main shocks, with the fitted Omori laws.

use asperity::task::summary::OmoriLaw;
use asperity_runner::output::Outcome;
use kuva::plot::MarkerShape;
use kuva::render::render::Scene;

use super::curve::{Point, computed, line};
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots};
use super::{legend, ticks};

/// Points of a fitted law.
const POINTS: u32 = 200;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let shocks = outcome.summary.numbers.catalogue()?.main_shocks.as_ref()?;
    let along = record.get("shock_time").or_else(|| record.get("shock_drive"))?;
    let sides = [
        ("aftershock_rate", "after main shocks", ORANGE, &shocks.aftershock_law),
        ("foreshock_rate", "before main shocks", BLUE, &shocks.foreshock_law),
    ];
    let (mut plots, mut labels, mut all) = (Plots::new(), Vec::new(), Vec::new());
    for (name, words, color, law) in sides {
        let rates = record.values(name)?;
        let points: Vec<Point> =
            along.values.iter().copied().zip(rates.iter().copied()).filter(|point| point.1 > 0.0).collect();
        if points.is_empty() {
            continue;
        }
        let (x, y): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        plots.push(computed(&x, &y, color));
        let exponent = law.map_or(String::new(), |law| exponent(&law));
        labels.push(style::marker(format!("{words}{exponent}"), color, MarkerShape::Circle));
        if let Some(law) = law {
            plots.push(line(fitted(law, &points), color, 1.4, None));
        }
        all.extend(points);
    }
    let ends = |of: fn(&Point) -> f64| {
        let (low, high) = style::range([all.iter().map(of).collect::<Vec<_>>().as_slice()]);
        (0.7 * low, 1.5 * high)
    };
    if all.is_empty() {
        return None;
    }
    let (x, y) = (ends(|point| point.0), ends(|point| point.1));
    plots.push(line(vec![(x.0, 1.0), (x.1, 1.0)], GREY, 1.4, Some(style::DASHES)));
    labels.push(style::line("mean rate", GREY, Some(style::DASHES)));
    let layout = style::layout(x, y)
        .with_log_scale()
        .with_x_tick_format(style::powers(x))
        .with_y_tick_format(style::powers(y));
    let words =
        if along.name == "shock_time" { "Time from the main shock" } else { "Drive from the main shock" };
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label(style::axis(outcome, words, along))
        .with_y_label("Rate of events / mean rate");
    Some(legend::placed(ticks::panel(plots, layout), &labels, &[0]))
}

/// The exponent of a law in words.
fn exponent(law: &OmoriLaw) -> String {
    format!(", p = {:.2} ± {:.2}", law.exponent.value, law.exponent.error)
}

/// A fitted law through the rates, of which it has the sum over the bins.
fn fitted(law: &OmoriLaw, points: &[Point]) -> Vec<Point> {
    let (first, last) = (points[0].0, points[points.len() - 1].0);
    let omori = |t: f64| (t + law.delay).powf(-law.exponent.value);
    // Bins are equally wide on the logarithmic axis: events in a bin are in proportion to rate times time.
    let sum = |rate: &dyn Fn(&Point) -> f64| points.iter().map(|point| rate(point) * point.0).sum::<f64>();
    let events = sum(&|point| point.1);
    let scale = (1.0 - law.background) * events / sum(&|point| omori(point.0));
    let background = law.background * events / sum(&|_| 1.0);
    let at = |k: u32| first * (last / first).powf(f64::from(k) / f64::from(POINTS));
    (0..=POINTS).map(|k| (at(k), scale * omori(at(k)) + background)).collect()
}
