//! `spectrum`: the spectrum of the force in steady sliding, with multiples of the wave number of breaks, its value at 0 and
//! its tail; and `correlation`: the autocovariance relative to the variance.

use asperity_runner::output::Outcome;
use kuva::plot::{MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{curve, line};
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots};
use super::{legend, ticks};

const DOTS: &str = "2 4";
/// Most multiples of the wave number of breaks that are marked: of more none is, for they would cover all else.
const MARKS: f64 = 100.0;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let (record, noise) = (&outcome.record, outcome.summary.numbers.noise()?);
    let (q, spectrum) = (record.values("wave_number")?, record.values("spectrum")?);
    let last = q[q.len() - 1];
    let tail = |q: f64| 2.0 * noise.kinetic_friction * noise.tail / (q * q);
    let (low, high) = style::range([spectrum]);
    let (bottom, top) = (low.min(tail(last)) / 2.0, high * 2.0);
    let mut plots = Plots::new();
    let breaks = std::f64::consts::TAU / noise.mean_life;
    let are_marked = last / breaks < MARKS;
    if are_marked {
        for mark in (1..).map(f64::from).map(|k| k * breaks).take_while(|&mark| mark < last) {
            plots.push(line(vec![(mark, bottom), (mark, top)], GREY, 1.0, Some(DOTS)));
        }
    }
    let mut legend = vec![style::line(format!("{} contacts, exact", style::digits(noise.size)), BLUE, None)];
    if let (Some(q), Some(found)) =
        (record.values("ensemble_wave_number"), record.values("ensemble_spectrum"))
    {
        let points = curve(q, found).into_iter().filter(|point| point.1 >= bottom && point.1 <= top);
        plots.push(Plot::Scatter(ScatterPlot::new().with_data(points).with_color(ORANGE).with_size(1.6)));
        legend.push(style::marker("ensemble, averaged periodogram", ORANGE, MarkerShape::Circle));
    }
    plots.push(line(curve(q, spectrum), BLUE, 2.0, None));
    let at_zero = ScatterPlot::new().with_data([(0.0, spectrum[0])]).with_color(BLUE).with_size(4.0);
    plots.push(Plot::Scatter(at_zero.with_marker(MarkerShape::Diamond)));
    legend.push(style::marker(format!("S(0) = {}", style::digits(spectrum[0])), BLUE, MarkerShape::Diamond));
    let falling: Vec<_> = q.iter().map(|&q| (q, tail(q))).filter(|point| point.1 <= top).collect();
    plots.push(line(falling, GREY, 1.4, Some(style::DASHES)));
    legend.push(style::line("breaks of single contacts, 1/q²", GREY, Some(style::DASHES)));
    if are_marked {
        legend.push(style::line("multiples of 2π per life of a contact", GREY, Some(DOTS)));
    }
    let layout = style::layout((0.0, last), (bottom, top))
        .with_log_y()
        .with_y_tick_format(style::powers((bottom, top)));
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Wave number q", record.get("wave_number")?))
        .with_y_label(style::axis(outcome, "Spectrum S", record.get("spectrum")?));
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}

/// The autocovariance relative to the variance.
pub fn correlation(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (u, covariance) = (record.values("displacement")?, record.values("autocovariance")?);
    let relative: Vec<f64> = covariance.iter().map(|c| c / covariance[0]).collect();
    let last = u[u.len() - 1];
    let mut plots: Plots = vec![line(vec![(0.0, 0.0), (last, 0.0)], GREY, 1.0, Some(DOTS))];
    plots.push(line(curve(u, &relative), BLUE, 2.0, None));
    let low = style::range([relative.as_slice()]).0;
    let layout = style::layout((0.0, last), (low.min(0.0) - 0.05, 1.05));
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Displacement u", record.get("displacement")?))
        .with_y_label("Autocorrelation of the force");
    Some(ticks::panel(plots, layout))
}
