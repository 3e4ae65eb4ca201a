//! `slip`: the time course of the first inertial slip.

use asperity_runner::output::Outcome;
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::curve::{curve, line};
use super::grid::Grid;
use super::style::{self, BLUE, GREEN, Page, Plots, RED};
use super::{legend, ticks};

const HEIGHT: f64 = 190.0;
/// Height of the label of the lowest axis.
const MARGINS: (f64, f64) = (12.0, 24.0);

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let rows = [
        panel(outcome, &[("slip_position", BLUE)], "Position X")?,
        panel(outcome, &[("slip_velocity", GREEN)], "Velocity v")?,
        panel(outcome, &[("slip_force", BLUE), ("slip_spring_force", RED)], "Force")?,
    ];
    let (plots, mut layouts): (Vec<_>, Vec<_>) = rows.into_iter().unzip();
    let time = style::axis(outcome, "Time t", outcome.record.get("slip_time")?);
    let lowest =
        layouts.pop()?.with_x_label(time).with_force_margins_y(MARGINS.0, MARGINS.1 + style::LABEL_HEIGHT);
    layouts.push(lowest);
    let legend =
        vec![style::line("friction force F", BLUE, None), style::line("spring force K(X_T − X)", RED, None)];
    let grid = Grid::new(3, 1, (page.width, page.height(HEIGHT)))
        .with_title(page.heading(&outcome.summary.title))
        .with_row_height(2, page.height(HEIGHT) + style::LABEL_HEIGHT);
    Some(legend::placed(ticks::panels(grid, plots, layouts), &legend, &[2]))
}

/// The least height of an axis of values up to this one: the difference of two of them that is no rounding.
fn least_height(largest: f64) -> f64 {
    if largest > 0.0 { 1e-12 * largest } else { 1.0 }
}

fn panel(outcome: &Outcome, columns: &[(&str, &str)], words: &str) -> Option<(Plots, Layout)> {
    let record = &outcome.record;
    let time = record.values("slip_time")?;
    let values: Option<Vec<_>> = columns.iter().map(|(name, _)| record.values(name)).collect();
    let values = values?;
    let (low, high) = style::range(values.iter().copied());
    let air = 0.06 * (high - low).max(least_height(low.abs().max(high.abs())));
    let plots =
        values.iter().zip(columns).map(|(y, (_, color))| line(curve(time, y), color, 1.8, None)).collect();
    let layout = style::layout((0.0, *time.last()?), (low - air, high + air))
        .with_y_label(style::axis(outcome, words, record.get(columns[0].0)?))
        .with_ticks(4);
    Some((plots, style::stacked(layout, MARGINS, style::SIDES)))
}
