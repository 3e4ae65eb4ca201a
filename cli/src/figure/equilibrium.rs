//! `equilibrium`: the equilibrium drive of the slider against its position, and the first slip.
//!
//! The curve is that of the first loading, on which contacts re-form as they break. Slips by `reset` and `arrest` leave it.

use asperity::record::Record;
use asperity_runner::output::Outcome;
use kuva::plot::BandPlot;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{curve, line};
use super::style::{self, BLUE, GREY, Page, Plots, RED};
use super::{legend, ticks};

const DASHES: &str = "5 4";
/// Range of the picture, in units of the position at the end of the first slip.
const BEYOND: f64 = 1.6;

/// The first slip.
#[derive(Debug, Clone, Copy)]
pub struct Jump {
    /// Position X_1 at its beginning.
    pub from: f64,
    /// Position at which the slider came to rest or turned.
    pub to: f64,
    /// Drive X_T.
    pub drive: f64,
}

/// The first slip of the master equation.
pub fn first_slip(record: &Record) -> Option<Jump> {
    let first = |name| record.values(name)?.first().copied();
    Some(Jump {
        from: first("event_position_before")?,
        to: first("event_position_turn")?,
        drive: first("event_drive")?,
    })
}

/// Upper end of pictures of the first loading.
pub fn end(record: &Record) -> Option<f64> {
    let last = *record.values("branch_position")?.last()?;
    Some(first_slip(record).map_or(last, |slip| (BEYOND * slip.to).min(last)))
}

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let end = end(record)?;
    let position = record.values("branch_position")?;
    let shown = position.partition_point(|&x| x <= end);
    let column = |name| record.values(name).map(|values| &values[..shown]);
    let (position, drive, stable) = (&position[..shown], column("branch_drive")?, column("branch_stable")?);
    let (mut plots, mut legend) = (Plots::new(), vec![style::line("stable equilibrium", BLUE, None)]);
    if stable.contains(&0.0) {
        legend.push(style::line("unstable equilibrium", GREY, Some(DASHES)));
    }
    if let Some(slip) = first_slip(record) {
        plots.extend(excess(position, drive, slip));
        plots.push(line(vec![(slip.from, slip.drive), (slip.to, slip.drive)], RED, 2.0, None));
        legend.push(style::line("first slip", RED, None));
        legend.push(style::area("(spring force − friction)/K", "#F6D5C4"));
    }
    for run in stable.chunk_by(|a, b| a == b).scan(0, |from, run| {
        *from += run.len();
        Some((*from - run.len())..*from)
    }) {
        // Each piece extends to the first point of the next one.
        let points =
            curve(&position[run.start..shown.min(run.end + 1)], &drive[run.start..shown.min(run.end + 1)]);
        let is_stable = stable[run.start] > 0.0;
        plots.push(line(points, if is_stable { BLUE } else { GREY }, 2.0, (!is_stable).then_some(DASHES)));
    }
    let (low, high) = style::range([drive]);
    let (low, high) = style::heights(low, high);
    let layout = page
        .titled(style::layout((0.0, end), (low, high)), &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Position X", record.get("branch_position")?))
        .with_y_label(style::axis(
            outcome,
            "Load-point displacement X_T, first loading",
            record.get("branch_drive")?,
        ));
    Some(legend::placed(ticks::panel(plots, layout), &legend, &[0]))
}

/// The area between the drive of a slip and the equilibrium drive.
fn excess(position: &[f64], drive: &[f64], slip: Jump) -> Option<Plot> {
    let rows =
        position.iter().zip(drive).filter(|(x, d)| (slip.from..=slip.to).contains(*x) && **d <= slip.drive);
    let (x, lower): (Vec<f64>, Vec<f64>) = rows.map(|(&x, &d)| (x, d)).unzip();
    let upper = vec![slip.drive; x.len()];
    (!x.is_empty()).then(|| Plot::Band(BandPlot::new(x, lower, upper).with_color(RED).with_opacity(0.2)))
}
