//! `stick_slip`, `hysteresis`, `creep`: force or position of a driven slider against the drive.
//!
//! The ensemble has points without error bars: it is one trajectory of its contacts, and each of its values is exact. Under a
//! spring other ensembles slip at other drives, so that a scatter at one drive would say nothing of the curve between slips.

use asperity::record::{Quantity, Record};
use asperity_runner::output::Outcome;
use kuva::plot::{MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, curve, line, spread};
use super::style::{self, BLUE, GREY, ORANGE, Page, Plots};
use super::{legend, ticks};

/// Largest number of markers of the ensemble.
const MARKERS: usize = 300;

/// The name of the picture, by the kind of drive.
pub fn name(record: &Record) -> &'static str {
    let Some(drive) = record.get("drive") else { return "stick_slip" };
    let turns = drive.values.windows(2).any(|pair| pair[1] < pair[0]);
    match drive.quantity {
        Quantity::Force => "creep",
        _ if turns => "hysteresis",
        _ => "stick_slip",
    }
}

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let drive = record.get("drive")?;
    if record.get("velocity").is_some() && record.get("event_drive").is_none() {
        return None;
    }
    if drive.quantity == Quantity::Force {
        return traces(outcome, page, ("position", "drive"), ("Position X", "Imposed force"));
    }
    let words = if ["branch_drive", "event_time"].iter().any(|name| record.get(name).is_some()) {
        ("Load-point displacement X_T", "Spring force")
    } else {
        ("Position X", "Friction force F")
    };
    traces(outcome, page, ("drive", "spring_force"), words)
}

/// The traces of both models as curves in two of their variables.
fn traces(outcome: &Outcome, page: Page, names: (&str, &str), words: (&str, &str)) -> Option<Scene> {
    let record = &outcome.record;
    let (mut plots, mut legend) = (Plots::new(), Vec::new());
    let (x, y) = columns(record, "", names)?;
    plots.push(line(curve(x, y), BLUE, 1.6, None));
    legend.push(style::line("master equation", BLUE, None));
    let others = columns(record, "ensemble_", names);
    let (left, right) = style::range(others.map(|o| o.0).into_iter().chain([x]));
    let (low, high) = style::range(others.map(|o| o.1).into_iter().chain([y]));
    if let Some((x, y)) = others {
        let points: Vec<Point> = x.iter().copied().zip(y.iter().copied()).collect();
        let shown = spread(&points, ((left, right), (low, high)), MARKERS);
        let markers = ScatterPlot::new().with_data(shown.into_iter().map(|i| points[i]));
        plots.push(Plot::Scatter(markers.with_color(ORANGE).with_size(2.2)));
        legend.push(style::marker(style::sized_ensemble(outcome), ORANGE, MarkerShape::Circle));
    }
    if let Some(kinetic) =
        outcome.summary.numbers.friction().map(|f| f.kinetic_friction).filter(|k| *k < high)
    {
        let unit = outcome.summary.units.label(Quantity::Force);
        plots.push(line(vec![(left, kinetic), (right, kinetic)], GREY, 1.4, Some(style::DASHES)));
        legend.push(style::line(
            format!("kinetic {}", style::with_unit(kinetic, &unit)),
            GREY,
            Some(style::DASHES),
        ));
    }
    let layout = page
        .titled(style::layout((left, right), style::heights(low, high)), &outcome.summary.title)
        .with_x_label(style::axis(outcome, words.0, record.get(names.0)?))
        .with_y_label(style::axis(outcome, words.1, record.get(names.1)?));
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}

fn columns<'a>(record: &'a Record, prefix: &str, names: (&str, &str)) -> Option<(&'a [f64], &'a [f64])> {
    let column = |name: &str| record.values(&format!("{prefix}{name}"));
    Some((column(names.0)?, column(names.1)?))
}
