//! `velocity_curve`: kinetic friction against velocity, with its known limits.

use asperity::record::{Quantity, Record};
use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape};
use kuva::render::render::Scene;

use super::curve::{Point, below, computed, errors, line};
use super::measured;
use super::smooth::along_logarithm;
use super::style::{self, GREY, ORANGE, Page, Plots};

const DOTS: &str = "2 4";

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let friction = record.values("kinetic_friction")?;
    let velocity = record.values("velocity")?;
    let others = ["ensemble_force", "compared_force"].into_iter().filter_map(|name| record.values(name));
    let (low, high) = style::range(others.chain([friction]));
    let (low, high) = style::heights(low, high);
    let (mut plots, mut legend) = (Plots::new(), Vec::new());
    let mut forms = Vec::new();
    for row in 0..outcome.summary.numbers.limits().len() {
        forms.extend(draw(outcome, velocity, row, (low, high), &mut plots, &mut legend));
    }
    if record.get("ensemble_force").is_some() {
        let color = if outcome.summary.numbers.limits().len() > 1 { GREY } else { ORANGE };
        legend.push(style::marker(style::sized_ensemble(outcome), color, MarkerShape::Circle));
    }
    if let Some(points) = measured::measured(outcome, "compared_velocity") {
        plots.push(measured::points(points));
        legend.push(measured::entry());
    }
    plateaus(outcome, velocity, (low, high), &mut plots, &mut legend);
    for (name, dashes, words) in [
        ("creep_friction", style::DASHES, "slow creep, closed form"),
        ("viscous_friction", DOTS, "viscous flow, closed form"),
    ] {
        if forms.contains(&name) {
            legend.push(style::line(words, GREY, Some(dashes)));
        }
    }
    let range = style::range([velocity, record.values("compared_velocity").unwrap_or(&[])]);
    let decades = style::decades(&[range.0, range.1]);
    let layout = style::layout(decades, (low, high)).with_log_x();
    let layout = layout.with_x_tick_format(style::powers(decades));
    let layout = page
        .titled(layout, &outcome.summary.title)
        .with_x_label(style::axis(outcome, "Velocity v", record.get("velocity")?))
        .with_y_label(style::axis(outcome, "Kinetic friction F_k", record.get("kinetic_friction")?));
    Some(measured::placed(outcome, page, (plots, layout), "compared_velocity", legend))
}

/// The curve of one temperature, with its ensemble and closed forms; the names of those that are in the picture.
fn draw(
    outcome: &Outcome,
    velocity: &[f64],
    row: usize,
    (bottom, top): (f64, f64),
    plots: &mut Plots,
    legend: &mut Vec<LegendEntry>,
) -> Vec<&'static str> {
    let record = &outcome.record;
    let mut forms = Vec::new();
    let color: &str = &style::colours(outcome.summary.numbers.limits().len())[row];
    for (name, dashes) in [("creep_friction", style::DASHES), ("viscous_friction", DOTS)] {
        let Some(values) = part(record, name, velocity.len(), row) else { continue };
        for piece in below(&along_logarithm(velocity, values), top) {
            if piece.iter().any(|point| point.1 > bottom) {
                plots.push(line(piece, color, 1.4, Some(dashes)));
                forms.push(name);
            }
        }
    }
    let Some(friction) = part(record, "kinetic_friction", velocity.len(), row) else { return forms };
    plots.push(line(along_logarithm(velocity, friction), color, 2.0, None));
    // An ensemble has its markers at the same velocities.
    if record.get("ensemble_force").is_none() {
        plots.push(computed(velocity, friction, color));
    }
    legend.push(style::line(called(outcome, row), color, None));
    let ensemble = ["ensemble_force", "ensemble_error"].map(|name| part(record, name, velocity.len(), row));
    if let [Some(force), error] = ensemble {
        let error = error.unwrap_or_default();
        let color = if outcome.summary.numbers.limits().len() > 1 { color } else { ORANGE };
        plots.extend(errors(velocity, force, error, color));
    }
    forms
}

/// The label of the curve of a row.
fn called(outcome: &Outcome, row: usize) -> String {
    let unit = outcome.summary.units.label(Quantity::Energy);
    match outcome.summary.numbers.limits()[row].temperature {
        Some(temperature) => format!("T = {}", style::with_unit(temperature, &unit)),
        None => "master equation".to_owned(),
    }
}

/// The forces of very fast and very slow sliding, if the curve reaches them.
fn plateaus(
    outcome: &Outcome,
    velocity: &[f64],
    (low, high): (f64, f64),
    plots: &mut Plots,
    legend: &mut Vec<LegendEntry>,
) {
    let Some(limits) = outcome.summary.numbers.limits().first() else { return };
    let ends: [Point; 2] = [(velocity[0], 1.0), (velocity[velocity.len() - 1], 1.0)];
    let unit = outcome.summary.units.label(Quantity::Force);
    for (level, words, dashes) in [(Some(limits.fast), "v → ∞", "4 4"), (limits.slow, "v → 0", "1 4")] {
        let Some(level) = level.filter(|level| *level > low && *level < high) else { continue };
        plots.push(line(ends.map(|end| (end.0, level)).to_vec(), GREY, 1.4, Some(dashes)));
        legend.push(style::line(format!("{words}: {}", style::with_unit(level, &unit)), GREY, Some(dashes)));
    }
}

/// The values of one temperature.
fn part<'a>(record: &'a Record, name: &str, length: usize, row: usize) -> Option<&'a [f64]> {
    record.values(name)?.chunks_exact(length).nth(row)
}
