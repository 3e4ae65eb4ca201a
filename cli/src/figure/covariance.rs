//! `covariance`: the correlation coefficient of the force at two positions of a pull, as a map.

use std::sync::Arc;

use asperity::record::Record;
use asperity_runner::output::Outcome;
use kuva::plot::ColorMap;
use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::field::{self, Field, bar};
use super::style::{self, Page, Plots};
use super::ticks;

/// Rows and columns of the map where positions are not evenly spaced.
const FINE: usize = 200;
/// Width of the panel of the colour scale.
const BAR: f64 = 95.0;
/// Side of the map.
const SIDE: f64 = 415.0;
/// Room for labels left and right of the map, and above and below it.
const SIDES: (f64, f64) = (60.0, 13.0);
const MARGINS: (f64, f64) = (10.0, 49.0);
/// Variances below this, relative to the largest, are 0 up to rounding: the force is certain there.
const CERTAIN: f64 = 1e-9;
/// Correlation coefficients.
const ENDS: (f64, f64) = (-1.0, 1.0);

pub fn scene(outcome: &Outcome, page: Page) -> Option<Scene> {
    let (positions, correlation) = correlation(&outcome.record)?;
    let (side, values, range) = map(&positions, &correlation);
    let field = Field { values: &values, sides: [side, side], x: range, y: range };
    let name = |index: char| format!("Displacement X{index} of the slider's base");
    let position = outcome.record.get("covariance_position")?;
    let layout = panel(range)
        .with_x_label(style::axis(outcome, &name('₁'), position))
        .with_y_label(style::axis(outcome, &name('₂'), position))
        .with_force_margins(SIDES.0, SIDES.1)
        .with_force_margins_y(MARGINS.0, MARGINS.1);
    let (scale, axes) = bar(ENDS, &colours(), "Correlation coefficient of the force");
    // Cells are square, and the colour scale is as tall as the map.
    let axes = axes.with_force_margins_y(MARGINS.0, MARGINS.1);
    let side = page.height(SIDE);
    let (title, size) = page.heading(&outcome.summary.title);
    let plots: Plots = vec![field.plot(ENDS, &colours(), 1)];
    let figure = Figure::new(1, 2)
        .with_structure(vec![vec![0], vec![1]])
        .with_title(title)
        .with_title_size(size)
        .with_cell_size(side + SIDES.0 + SIDES.1, side + MARGINS.0 + MARGINS.1)
        .with_col_width(1, BAR)
        .with_spacing(6.0);
    Some(ticks::panels(figure, vec![plots, scale], vec![layout, axes]))
}

/// Blue for −1, white for 0, red for 1.
fn colours() -> ColorMap {
    ColorMap::Custom(Arc::new(|part| ColorMap::RedBlue.map(1.0 - part)))
}

fn panel(range: (f64, f64)) -> Layout {
    field::axes(range, range).with_tick_size(11).with_label_size(13)
}

/// The positions at which the force is not certain, and the correlation coefficients of the force there, row by row.
/// `None` for fewer than two of them.
fn correlation(record: &Record) -> Option<(Vec<f64>, Vec<f64>)> {
    let (positions, covariance) = (record.values("covariance_position")?, record.values("covariance")?);
    let count = positions.len();
    let variance = |i: usize| covariance[i * (count + 1)];
    let largest = (0..count).map(variance).fold(0.0, f64::max);
    let kept: Vec<usize> = (0..count).filter(|&i| variance(i) > CERTAIN * largest).collect();
    let value = |i: usize, j: usize| covariance[i * count + j] / (variance(i) * variance(j)).sqrt();
    let values = kept.iter().flat_map(|&i| kept.iter().map(move |&j| value(i, j)));
    (kept.len() > 1).then(|| (kept.iter().map(|&i| positions[i]).collect(), values.collect()))
}

/// The side of an even grid, the values on it, and the range that it covers. Where positions are not even, they are the
/// values at the nearest ones.
fn map(positions: &[f64], values: &[f64]) -> (usize, Vec<f64>, (f64, f64)) {
    let count = positions.len();
    let (first, last) = (positions[0], positions[count - 1]);
    let step = (last - first) / (count - 1) as f64;
    let even = (0..count).all(|i| (positions[i] - first - i as f64 * step).abs() < 1e-6 * step);
    if even {
        return (count, values.to_vec(), (first - 0.5 * step, last + 0.5 * step));
    }
    let nearest: Vec<usize> = (0..FINE)
        .map(|k| first + (last - first) * (k as f64 + 0.5) / FINE as f64)
        .map(|x| positions.windows(2).take_while(|pair| x > 0.5 * (pair[0] + pair[1])).count())
        .collect();
    let fine = nearest.iter().flat_map(|&i| nearest.iter().map(move |&j| values[i * count + j]));
    (FINE, fine.collect(), (first, last))
}
