//! `distribution`: the stretches of steady sliding, with the law of thresholds and the hazard.

use asperity::record::Record;
use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::{Scene, render_twin_y};

use super::curve::{Point, below, curve, line};
use super::style::{self, BLACK, BLUE, ORANGE, Plots, RED};

const DOTS: &str = "3 3";
const DASHES: &str = "8 4";

pub fn scene(outcome: &Outcome) -> Option<Scene> {
    let record = &outcome.record;
    let stretch = record.values("stretch")?;
    let (steady, thresholds) =
        (record.values("steady_stretch_density")?, record.values("threshold_density")?);
    let x = (0.0, *stretch.last()?);
    let (left, right) =
        (top(&[steady, record.values("steady_ensemble_density").unwrap_or(&[])]), top(&[thresholds]));
    let (mut plots, mut second, mut legend) = (Plots::new(), Plots::new(), Vec::new());
    crosses(outcome, &mut plots, &mut legend);
    plots.push(line(curve(stretch, steady), BLACK, 2.0, None));
    legend.insert(0, style::line("stretches in steady sliding, Q(x)", BLACK, None));
    second.push(line(curve(stretch, thresholds), RED, 1.8, Some(DOTS)));
    legend.push(style::line("thresholds (right axis)", RED, Some(DOTS)));
    let hazard = below(&curve(stretch, record.values("hazard")?), right);
    second.extend(hazard.into_iter().map(|piece| line(piece, BLUE, 1.8, Some(DASHES))));
    legend.push(style::line("hazard P(x) (right axis)", BLUE, Some(DASHES)));
    plots.extend(stems(record, "steady_atom", left, BLACK));
    second.extend(stems(record, "threshold_atom", right, RED));
    if record.length("steady_atom").or(record.length("threshold_atom")).is_some() {
        legend.push(style::marker("point mass, 1 = full height", BLACK, MarkerShape::Circle));
    }
    let density = record.get("threshold_density")?;
    let layout = style::layout(x, (0.0, left))
        .with_y2_range(0.0, right)
        .with_y2_axis_min(0.0)
        .with_y2_axis_max(right)
        .with_title(&outcome.summary.title)
        .with_x_label(style::axis(outcome, "Stretch x", record.get("stretch")?))
        .with_y_label(style::axis(outcome, "Stretch density Q(x)", density))
        .with_y2_label(style::axis(outcome, "Threshold density, hazard P(x)", density));
    Some(render_twin_y(plots, second, style::legend_below(layout, legend)))
}

fn top(curves: &[&[f64]]) -> f64 {
    style::headroom(style::range(curves.iter().copied()).1)
}

/// The ensemble, averaged over the end of a pull that was long enough to forget its start.
fn crosses(outcome: &Outcome, plots: &mut Plots, legend: &mut Vec<LegendEntry>) {
    let record = &outcome.record;
    let (Some(bin), Some(density)) = (record.values("bin"), record.values("steady_ensemble_density")) else {
        return;
    };
    plots.push(Plot::Scatter(
        ScatterPlot::new()
            .with_data(bin.iter().copied().zip(density.iter().copied()))
            .with_color(ORANGE)
            .with_marker(MarkerShape::Cross)
            .with_size(3.2),
    ));
    let size = style::digits(outcome.summary.sample.unwrap_or(f64::NAN));
    legend.push(style::marker(format!("ensemble, N = {size}, averaged"), ORANGE, MarkerShape::Cross));
}

/// Point masses as stems, `top` high where all contacts are there.
pub fn stems(record: &Record, dimension: &str, top: f64, color: &str) -> Plots {
    let column = |name| record.values(&format!("{dimension}_{name}")).unwrap_or(&[]);
    let tips = column("stretch").iter().zip(column("weight")).map(|(&x, &weight)| (x, weight * top));
    tips.flat_map(|tip| stem(tip, color)).collect()
}

/// A stem from the axis to `tip`.
pub fn stem(tip: Point, color: &str) -> [Plot; 2] {
    let head = ScatterPlot::new().with_data([tip]).with_color(color).with_size(3.5);
    [line(vec![(tip.0, 0.0), tip], color, 2.0, None), Plot::Scatter(head)]
}
