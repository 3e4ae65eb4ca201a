//! `force` of a motion in time with a measured curve beside it: the force against the position, behind the spring of a block that
//! of the spring against the displacement of the load point, with the rate-and-state fits of velocity steps. After velocity
//! steps of a rigid slider, `velocity_step` shows it.

use asperity::task::summary::{ProtocolStep, SpringRateState};
use asperity_runner::output::Outcome;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, curve, line};
use super::style::{self, BLACK, BLUE, Page, RED};
use super::{measured, velocity_step};

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    record.get("time")?;
    let measured = measured::measured(outcome, "compared_position")?;
    let steps = outcome.summary.numbers.steps();
    if steps.iter().any(|step| step.rate_state.is_some()) {
        return None;
    }
    let (names, words) = if outcome.summary.numbers.sliding().is_some() {
        (("drive", "spring_force"), ("Load-point displacement X_T", "Spring force"))
    } else {
        (("position", "force"), ("Position X", "Friction force F"))
    };
    let (position, force) = (record.values(names.0)?, record.values(names.1)?);
    let computed: Vec<Point> = position.iter().copied().zip(force.iter().copied()).collect();
    let (low, high) = style::range([force, record.values("compared_force")?]);
    let ends = style::range([position]);
    let layout = style::layout(ends, style::heights(low, high))
        .with_x_label(style::axis(outcome, words.0, record.get(names.0)?))
        .with_y_label(style::axis(outcome, words.1, record.get(names.1)?));
    let mut plots = vec![line(curve(position, force), BLUE, 2.0, None), measured::points(measured.clone())];
    let mut legend = vec![style::line("master equation", BLUE, None), measured::entry()];
    let fits = [
        (fits(steps, &computed, |step| step.rate_state_spring.as_ref()), RED, "rate-and-state fit"),
        (fits(steps, &measured, |step| step.measured_spring.as_ref()), BLACK, "fit of measured"),
    ];
    for (lines, color, words) in fits {
        if !lines.is_empty() {
            legend.push(style::line(words, color, Some(style::DASHES)));
        }
        plots.extend(
            lines.into_iter().map(|points| -> Plot { line(points, color, 1.6, Some(style::DASHES)) }),
        );
    }
    Some(measured::placed(outcome, page, (plots, layout), "compared_position", legend))
}

/// The fits of the velocity steps of a curve, each at its points up to the next step.
fn fits(
    steps: &[ProtocolStep],
    points: &[Point],
    of: impl Fn(&ProtocolStep) -> Option<&SpringRateState>,
) -> Vec<Vec<Point>> {
    let found = |(i, step): (usize, &ProtocolStep)| {
        let read = of(step)?;
        let end = steps.get(i + 1).map_or(f64::INFINITY, |next| next.position);
        let within = points.iter().filter(|point| (step.position..=end).contains(&point.0));
        let since: Vec<Point> = within.map(|point| (point.0 - step.position, point.1)).collect();
        let fitted = velocity_step::fit_behind(read, &since);
        Some(fitted.into_iter().map(|point| (point.0 + step.position, point.1)).collect())
    };
    steps.iter().enumerate().filter_map(found).collect()
}
