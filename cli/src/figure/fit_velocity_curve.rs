//! `velocity_curve` of a fit to forces of steady sliding at several velocities: the measured forces with the fitted curve and the
//! band of its error, and the residuals below.

use asperity_runner::output::Outcome;
use kuva::plot::{BandPlot, MarkerShape};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{errors, line};
use super::fit::{below, panel, stacked};
use super::smooth::along_logarithm;
use super::style::{self, BLUE, ORANGE, Page, Plots};

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let (velocity, measured, std) = (
        record.values("reading_velocity")?,
        record.values("reading_friction")?,
        record.values("reading_friction_std")?,
    );
    let (fitted, friction, error) = (
        record.values("fit_velocity")?,
        record.values("fit_friction")?,
        record.values("fit_friction_error")?,
    );
    let edge = |side: f64| -> Vec<f64> { friction.iter().zip(error).map(|(f, s)| f + side * s).collect() };
    let (low_edge, high_edge) = (along_logarithm(fitted, &edge(-2.0)), along_logarithm(fitted, &edge(2.0)));
    let (x, low): (Vec<f64>, Vec<f64>) = low_edge.into_iter().unzip();
    let high: Vec<f64> = high_edge.into_iter().map(|point| point.1).collect();
    let bar = |side: f64| -> Vec<f64> { measured.iter().zip(std).map(|(f, s)| f + side * s).collect() };
    let heights = style::range([low.as_slice(), high.as_slice(), &bar(-1.0), &bar(1.0)]);
    let mut forces: Plots = Vec::new();
    if x.len() > 1 {
        forces.push(Plot::Band(BandPlot::new(x, low, high).with_color(BLUE).with_opacity(0.22)));
    }
    forces.push(line(along_logarithm(fitted, friction), BLUE, 1.6, None));
    forces.extend(errors(velocity, measured, std, ORANGE));
    let legend = vec![
        style::marker("measured, ±1 std", ORANGE, MarkerShape::Circle),
        style::line("fit", BLUE, None),
        style::area("±2 standard errors of the fit", "#C7DFEE"),
    ];
    let ends = style::decades(velocity);
    let logarithmic = |layout: Layout| layout.with_log_x().with_x_tick_format(style::powers(ends));
    let heights = style::heights(heights.0, heights.1);
    let above = panel(ends, heights).with_y_label(style::axis(
        outcome,
        "Kinetic friction F_k",
        record.get("reading_friction")?,
    ));
    let (points, residuals) = below(ends, velocity, record.values("reading_friction_residual")?);
    let residuals = residuals.with_y_label("Residual / std");
    let label = style::axis(outcome, "Velocity v", record.get("reading_velocity")?);
    let panels = vec![(forces, logarithmic(above)), (points, logarithmic(residuals))];
    stacked(outcome, page, (panels, label), legend)
}
