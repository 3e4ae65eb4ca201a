//! `distribution`: the stretches of steady sliding, with the distribution of thresholds and the hazard.

use asperity::record::Record;
use asperity_runner::output::Outcome;
use kuva::plot::{LegendEntry, MarkerShape, ScatterPlot};
use kuva::render::plots::Plot;
use kuva::render::render::Scene;

use super::curve::{Point, below, curve, density_line, line};
use super::style::{self, BLACK, BLUE, ORANGE, Page, Plots, RED};
use super::{legend, ticks};

const DOTS: &str = "3 3";
const DASHES: &str = "8 4";

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let record = &outcome.record;
    let stretch = record.values("stretch")?;
    let (steady, thresholds) =
        (record.values("steady_stretch_density")?, record.values("threshold_density")?);
    let left =
        style::headroom(style::range([steady, record.values("steady_ensemble_density").unwrap_or(&[])]).1);
    let (mut plots, mut legend) = (Plots::new(), Vec::new());
    legend.push(style::line("stretches in steady sliding, Q(x)", BLACK, None));
    crosses(outcome, &mut plots, &mut legend);
    plots.extend(density_line(stretch, steady, BLACK, 2.0));
    plots.extend(stems(record, "steady_atom", left, BLACK));
    let axis = second(outcome, thresholds)?;
    legend.extend(axis.legend);
    let farthest = record.values("threshold_atom_stretch").unwrap_or(&[]).iter().copied().fold(0.0, f64::max);
    let end = style::reach(stretch, &[steady, thresholds]).max(1.05 * farthest);
    let layout = page
        .titled(style::layout((0.0, end), (0.0, left)), &outcome.summary.title)
        .with_y2_range(0.0, axis.top)
        .with_y2_axis_min(0.0)
        .with_y2_axis_max(axis.top)
        .with_x_label(style::axis(outcome, "Stretch x", record.get("stretch")?))
        .with_y_label(style::axis(outcome, "Stretch density Q(x)", record.get("steady_stretch_density")?))
        .with_y2_label(axis.label);
    Some(legend::placed(ticks::twin(plots, axis.plots, layout), &legend, &[0]))
}

/// The curves of the right axis.
struct Second {
    plots: Plots,
    legend: Vec<LegendEntry>,
    label: String,
    top: f64,
}

/// The distribution of thresholds and its hazard; fractions only, if all thresholds are point masses.
fn second(outcome: &Outcome, thresholds: &[f64]) -> Option<Second> {
    let record = &outcome.record;
    let stretch = record.values("stretch")?;
    let highest = style::range([thresholds]).1;
    if highest <= 0.0 {
        return Some(Second {
            plots: stems(record, "threshold_atom", 1.0, RED),
            legend: vec![style::marker("thresholds (right axis)", RED, MarkerShape::Circle)],
            label: "Fraction of thresholds".to_owned(),
            top: style::headroom(1.0),
        });
    }
    let top = style::headroom(highest);
    let mut plots = vec![line(curve(stretch, thresholds), RED, 1.8, Some(DOTS))];
    let hazard = curve(stretch, record.values("hazard")?);
    let cut = hazard.iter().any(|point| point.1 > top);
    let hazard = below(&hazard, top);
    plots.extend(hazard.into_iter().map(|piece| line(piece, BLUE, 1.8, Some(DASHES))));
    plots.extend(stems(record, "threshold_atom", top, RED));
    let mut legend = vec![
        style::line("thresholds (right axis)", RED, Some(DOTS)),
        style::line(
            if cut { "hazard P(x) (right axis, up to the frame)" } else { "hazard P(x) (right axis)" },
            BLUE,
            Some(DASHES),
        ),
    ];
    if record.get("threshold_atom_weight").is_some() {
        legend.push(style::marker("point mass, 1 = full height", RED, MarkerShape::Circle));
    }
    let label = style::axis(outcome, "Threshold density, hazard P(x)", record.get("threshold_density")?);
    Some(Second { plots, legend, label, top })
}

/// The ensemble, averaged over the end of a pull if that is steady.
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
    let ends = record
        .values("averaged_position")
        .unwrap_or(&[])
        .iter()
        .map(|&x| style::digits(x))
        .collect::<Vec<_>>();
    let label = format!("{}, X = {}", style::ensemble(outcome), ends.join(" to "));
    legend.push(style::marker(label, ORANGE, MarkerShape::Cross));
}

/// Point masses as stems; `top` is the height of the whole probability.
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
