//! `covariance`: the correlation coefficient of the force at two positions of a pull, as a map.

use std::sync::Arc;

use asperity::record::Record;
use asperity_runner::output::Outcome;
use kuva::plot::ColorMap;
use kuva::render::layout::Layout;
use kuva::render::render::Scene;

use super::field::{self, Field, bar};
use super::grid::Grid;
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
/// Variances below this, relative to the largest: a scatter of less than a thousandth of it.
const CERTAIN: f64 = style::INVISIBLE * style::INVISIBLE;
/// Colour where the force hardly scatters: white is a coefficient of 0.
const NONE: &str = "#C8C8C8";
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
    let words = match values.iter().any(|value| value.is_nan()) {
        true => "Correlation coefficient of the force (grey: no scatter)",
        false => "Correlation coefficient of the force",
    };
    let (scale, axes) = bar(ENDS, &colours(), words);
    // Cells are square, and the colour scale is as tall as the map.
    let axes = axes.with_force_margins_y(MARGINS.0, MARGINS.1);
    let side = page.height(SIDE);
    let plots: Plots = vec![field.plot(ENDS, &colours(), 1)];
    let grid = Grid::new(1, 2, (side + SIDES.0 + SIDES.1, side + MARGINS.0 + MARGINS.1))
        .with_structure(vec![vec![0], vec![1]])
        .with_title(page.heading(&outcome.summary.title))
        .with_column_width(1, BAR);
    Some(ticks::panels(grid, vec![plots, scale], vec![layout, axes]))
}

/// Blue for −1, white for 0, red for 1, grey for none.
fn colours() -> ColorMap {
    ColorMap::Custom(Arc::new(|part: f64| match part.is_finite() {
        true => ColorMap::RedBlue.map(1.0 - part),
        false => NONE.to_owned(),
    }))
}

fn panel(range: (f64, f64)) -> Layout {
    field::axes(range, range).with_tick_size(11).with_label_size(13)
}

/// The positions, and the correlation coefficients of the force at them, row by row: none where the force hardly scatters.
/// `None` for fewer than two positions at which it does.
fn correlation(record: &Record) -> Option<(Vec<f64>, Vec<f64>)> {
    let (positions, covariance) = (record.values("covariance_position")?, record.values("covariance")?);
    let count = positions.len();
    let variance = |i: usize| covariance[i * (count + 1)];
    let largest = (0..count).map(variance).fold(0.0, f64::max);
    let std: Vec<f64> = (0..count)
        .map(|i| if variance(i) > CERTAIN * largest { variance(i).sqrt() } else { f64::NAN })
        .collect();
    let value = |i: usize, j: usize| covariance[i * count + j] / (std[i] * std[j]);
    let values = (0..count).flat_map(|i| (0..count).map(move |j| (i, j))).map(|(i, j)| value(i, j));
    let known = std.iter().filter(|std| std.is_finite()).count();
    (known > 1).then(|| (positions.to_vec(), values.collect()))
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
