//! `force` of a motion in time with a measured curve beside it: the force against the position. After velocity steps,
//! `velocity_step` shows it.

use asperity_runner::output::Outcome;
use kuva::plot::MarkerShape;
use kuva::render::render::Scene;

use super::curve::{Point, curve, line};
use super::measured;
use super::style::{self, BLUE, GREEN, Page};

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    record.get("time")?;
    let measured = measured::measured(outcome)?;
    if outcome.summary.numbers.steps().iter().any(|step| step.rate_state.is_some()) {
        return None;
    }
    let (position, force) = (record.values("position")?, record.values("force")?);
    let computed: Vec<Point> = position.iter().copied().zip(force.iter().copied()).collect();
    let (low, high) = style::range([force, record.values("compared_force")?]);
    let ends = style::range([position]);
    let layout = style::layout(ends, style::heights(low, high))
        .with_x_label(style::axis(outcome, "Position X", record.get("position")?))
        .with_y_label(style::axis(outcome, "Friction force F", record.get("force")?));
    let plots = vec![line(curve(position, force), BLUE, 2.0, None), measured::points(measured.clone())];
    let legend = vec![
        style::line("master equation", BLUE, None),
        style::marker("measured", GREEN, MarkerShape::Circle),
    ];
    let curves = (computed.as_slice(), measured.as_slice());
    Some(measured::with_residuals(outcome, page, (plots, layout), curves, legend))
}
