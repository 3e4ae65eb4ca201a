//! `sizes`: the number of events of the ensemble by the number of contacts that broke, with the standard errors of counts.

use asperity_runner::output::Outcome;
use kuva::plot::MarkerShape;
use kuva::render::render::Scene;

use super::curve::{Counted, counted, line};
use super::style::{self, GREY, ORANGE, Page, Plots};
use super::{legend, ticks};

/// Fewest bins with events that are drawn.
const FEWEST: usize = 3;
/// Bins per decade.
const PER_DECADE: f64 = 10.0;
/// Exponent of sizes of a mean-field model swept to its instability (P. C. Hemmer and A. Hansen, 1992).
const SWEPT: f64 = -2.5;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (sizes, events) = (record.values("size")?, record.values("size_events")?);
    let contacts = outcome.summary.sample?;
    let bin = |(&size, &count): (&f64, &f64)| (size, count / whole_numbers(size, contacts), count);
    let points: Vec<Counted> = sizes.iter().zip(events).map(bin).collect();
    // Of two sizes nothing can be seen.
    if points.len() < FEWEST {
        return None;
    }
    let first = *points.first()?;
    let last = points.last()?.0;
    let (low, high) = (points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min), first.1);
    let guide = vec![(first.0, first.1), (last, first.1 * (last / first.0).powf(SWEPT))];
    let guide = clipped(guide, 0.5 * low);
    let mut plots: Plots = vec![line(guide, GREY, 1.4, Some(style::DASHES))];
    plots.extend(counted(&points, 0.5 * low, ORANGE));
    let legend = vec![
        style::marker(style::sized_ensemble(outcome), ORANGE, MarkerShape::Circle),
        style::line("slope −5/2: mean field, integrated up to instability", GREY, Some(style::DASHES)),
    ];
    let (widths, heights) = ((0.8 * first.0, 2.0 * last), (0.5 * low, 2.0 * high));
    let layout = style::layout(widths, heights).with_log_scale();
    let layout = layout.with_x_tick_format(style::powers(widths)).with_y_tick_format(style::powers(heights));
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label("Contacts broken in an event")
        .with_y_label("Events per number of contacts");
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}

/// Number of integers in the bin that holds `size`: bins are a tenth of a decade wide in the fraction of contacts that break.
fn whole_numbers(size: f64, contacts: f64) -> f64 {
    let middle = contacts * 10f64.powf((PER_DECADE * (size / contacts).log10()).round() / PER_DECADE);
    let half = 10f64.powf(0.5 / PER_DECADE);
    ((middle * half).floor() - (middle / half).ceil() + 1.0).max(1.0)
}

/// A line on logarithmic axes, down to the value `low`.
fn clipped(line: Vec<(f64, f64)>, low: f64) -> Vec<(f64, f64)> {
    let (first, last) = (line[0], line[1]);
    let steepness = (last.1 / first.1).ln() / (last.0 / first.0).ln();
    let end = first.0 * ((low / first.1).ln() / steepness).exp();
    if last.1 < low { vec![first, (end, low)] } else { line }
}
