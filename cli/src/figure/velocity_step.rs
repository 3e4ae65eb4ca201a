//! `velocity_step`: the force after each velocity step, with the fitted rate-and-state curve.

use asperity::task::summary::{MeasuredRateState, ProtocolStep, RateState};
use asperity_runner::output::Outcome;
use kuva::plot::LegendEntry;
use kuva::render::figure::{Figure, FigureLegendPosition};
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::curve::{Point, line, thinned};
use super::style::{self, BLUE, GREEN, Page, Plots, RED};
use super::ticks;

/// Largest number of panels.
const PANELS: usize = 4;
/// Height of a panel, and of the label of the lowest axis.
const HEIGHT: f64 = 240.0;
const LABEL: f64 = 26.0;
const MARGINS: (f64, f64) = (30.0, 24.0);
const DASHES: &str = "8 5";
/// Displacement shown before a step, as a fraction of that after it.
const BEFORE: f64 = 0.1;

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let read =
        outcome.summary.numbers.steps().iter().filter_map(|step| Some((step, step.rate_state.as_ref()?)));
    let panels: Option<Vec<_>> = read.take(PANELS).map(|(step, read)| panel(outcome, step, read)).collect();
    let (plots, mut layouts): (Vec<_>, Vec<_>) = panels?.into_iter().unzip();
    let label = style::axis(outcome, "Displacement since the step", outcome.record.get("position")?);
    let lowest = layouts.pop()?.with_x_label(label).with_force_margins_y(MARGINS.0, MARGINS.1 + LABEL);
    layouts.push(lowest);
    let rows = layouts.len();
    let (title, size) = page.heading(&outcome.summary.title);
    let figure = Figure::new(rows, 1)
        .with_title(title)
        .with_title_size(size)
        .with_cell_size(page.width, page.height(HEIGHT))
        .with_row_height(rows - 1, page.height(HEIGHT) + LABEL)
        .with_spacing(6.0)
        .with_shared_legend_entries(legend(outcome))
        .with_shared_legend_position(FigureLegendPosition::BottomCenter);
    Some(ticks::panels(figure, plots, layouts))
}

fn legend(outcome: &Outcome) -> Vec<LegendEntry> {
    let mut entries = vec![
        style::line("master equation", BLUE, None),
        style::line("rate-and-state fit", RED, Some(DASHES)),
    ];
    if outcome.record.get("compared_force").is_some() {
        entries.push(style::line("compared curve", GREEN, None));
    }
    if outcome.summary.numbers.steps().iter().any(|step| step.measured.is_some()) {
        entries.push(style::line("its fit", GREEN, Some(DASHES)));
    }
    entries
}

fn panel(outcome: &Outcome, step: &ProtocolStep, read: &RateState) -> Option<(Plots, Layout)> {
    let end = step.velocity * step.duration;
    let shown = (-BEFORE * end)..=end;
    let since = |names: (&str, &str)| -> Option<Vec<Point>> {
        let (x, y) = (outcome.record.values(names.0)?, outcome.record.values(names.1)?);
        let points = x.iter().zip(y).map(|(x, &y)| (x - step.position, y));
        Some(thinned(points.filter(|point| shown.contains(&point.0)).collect()))
    };
    let computed = since(("position", "force"))?;
    let compared = since(("compared_position", "compared_force")).unwrap_or_default();
    let fitted: Vec<Point> =
        computed.iter().filter(|p| p.0 >= read.peak).map(|p| (p.0, fit(step, read, p.0))).collect();
    let size = (step.velocity / read.velocity_before).ln();
    let compared_fit: Vec<Point> =
        step.measured.iter().flat_map(|found| fit_of(found, size, &compared)).collect();
    let heights: Vec<f64> =
        [&computed, &compared, &fitted, &compared_fit].into_iter().flatten().map(|p| p.1).collect();
    let (low, high) = style::range([heights.as_slice()]);
    let air = 0.1 * (high - low);
    let plots = vec![
        line(compared, GREEN, 1.0, None),
        line(compared_fit, GREEN, 1.6, Some(DASHES)),
        line(computed, BLUE, 2.0, None),
        line(fitted, RED, 1.6, Some(DASHES)),
    ];
    let speed =
        |v: f64| style::with_unit(v, &outcome.summary.units.label(asperity::record::Quantity::Velocity));
    let layout = style::layout((*shown.start(), end), (low - air, high + air))
        .with_title(format!("v = {} → {}", speed(read.velocity_before), speed(step.velocity)))
        .with_title_size(12)
        .with_y_label(style::axis(outcome, "Friction force F", outcome.record.get("force")?))
        .with_ticks(4)
        .with_force_margins_y(MARGINS.0, MARGINS.1)
        .with_force_margins(style::SIDES.0, style::SIDES.1)
        .with_tick_size(11)
        .with_label_size(13);
    Some((plots, layout))
}

/// The fitted force at a displacement from the peak.
fn fit(step: &ProtocolStep, read: &RateState, displacement: f64) -> f64 {
    let fallen = -(-(displacement - read.peak) / read.distance).exp_m1();
    let size = (step.velocity / read.velocity_before).ln();
    read.force_before + size * (read.a - read.b * fallen)
}

/// The fit of the compared curve at its points from the peak on.
fn fit_of(found: &MeasuredRateState, size: f64, points: &[Point]) -> Vec<Point> {
    let force = |x: f64| {
        let fallen = -(-(x - found.peak) / found.distance.value).exp_m1();
        found.force_before.value + size * (found.a.value - found.b.value * fallen)
    };
    points.iter().filter(|point| point.0 >= found.peak).map(|point| (point.0, force(point.0))).collect()
}
