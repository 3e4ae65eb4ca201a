//! Very small values, multiplied by powers of ten. The plot library draws a linear axis shorter than 2e-16 as a point, takes values
//! below 1e-10 on a logarithmic axis for 1e-10, and gives a field whose values differ by less than 2e-16 one colour.

use std::sync::Arc;

use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;

use super::style::Plots;

/// The shortest linear axis, and the smallest value on a logarithmic one, that are drawn as they are.
const SHORTEST: f64 = 1e-12;
const SMALLEST: f64 = 1e-9;

/// The power of ten by which the largest value of a linear axis with these ends becomes one from 1 to 10; 1 for an axis that is
/// long enough.
pub fn linear((low, high): (f64, f64)) -> f64 {
    let largest = low.abs().max(high.abs());
    if high - low < SHORTEST { power(-largest.log10()) } else { 1.0 }
}

/// The power of ten by which the lower end of a logarithmic axis becomes large enough; 1 where it is.
fn logarithmic(low: f64) -> f64 {
    power(SMALLEST.log10() - low.log10())
}

/// The next power of ten for a positive exponent, 1 for others.
fn power(exponent: f64) -> f64 {
    /// Larger ones are infinite.
    const LARGEST: f64 = 308.0;
    if exponent > 0.0 && exponent.is_finite() { 10f64.powi(exponent.ceil().min(LARGEST) as i32) } else { 1.0 }
}

/// The factors of the axes of a layout: below, on the left and on the right.
struct Factors {
    x: f64,
    y: f64,
    y2: f64,
}

impl Factors {
    fn of(layout: &Layout) -> Self {
        let factor = |ends: (Option<f64>, Option<f64>), is_logarithmic: bool| match ends {
            (Some(low), Some(_)) if is_logarithmic => logarithmic(low),
            (Some(low), Some(high)) => linear((low, high)),
            _ => 1.0,
        };
        Self {
            x: factor((layout.x_axis_min, layout.x_axis_max), layout.log_x),
            y: factor((layout.y_axis_min, layout.y_axis_max), layout.log_y),
            y2: factor((layout.y2_axis_min, layout.y2_axis_max), layout.log_y2),
        }
    }
}

/// Plots of one vertical axis and their layout as the plot library draws them.
pub fn drawable(mut plots: Plots, layout: Layout) -> (Plots, Layout) {
    let Factors { x, y, .. } = Factors::of(&layout);
    multiply_all(&mut plots, [x, y]);
    (plots, multiplied(layout))
}

/// Plots of the left and of the right axis and their layout as the plot library draws them.
pub fn drawable_twin(mut left: Plots, mut right: Plots, layout: Layout) -> (Plots, Plots, Layout) {
    let Factors { x, y, y2 } = Factors::of(&layout);
    multiply_all(&mut left, [x, y]);
    multiply_all(&mut right, [x, y2]);
    (left, right, multiplied(layout))
}

/// A layout with multiplied axes, whose ticks have the labels of their true values.
fn multiplied(mut layout: Layout) -> Layout {
    let Factors { x, y, y2 } = Factors::of(&layout);
    if x > 1.0 {
        scale(&mut layout.x_range, x);
        let numbers = [&mut layout.x_axis_min, &mut layout.x_axis_max, &mut layout.x_tick_step];
        numbers.into_iter().flatten().for_each(|number| *number = times(*number, x));
        layout.x_tick_format = divided(layout.x_tick_format, x);
    }
    if y > 1.0 {
        scale(&mut layout.y_range, y);
        let numbers = [&mut layout.y_axis_min, &mut layout.y_axis_max, &mut layout.y_tick_step];
        numbers.into_iter().flatten().for_each(|number| *number = times(*number, y));
        layout.y_tick_format = divided(layout.y_tick_format, y);
    }
    if y2 > 1.0 {
        layout.y2_range.iter_mut().for_each(|range| scale(range, y2));
        let numbers = [&mut layout.y2_axis_min, &mut layout.y2_axis_max];
        numbers.into_iter().flatten().for_each(|number| *number = times(*number, y2));
        layout.y2_tick_format = divided(layout.y2_tick_format, y2);
    }
    layout
}

/// The labels of values that are multiplied by a factor.
fn divided(format: TickFormat, factor: f64) -> TickFormat {
    TickFormat::Custom(Arc::new(move |value| format.format(value / factor)))
}

fn multiply_all(plots: &mut [Plot], by: [f64; 2]) {
    if by != [1.0; 2] {
        plots.iter_mut().for_each(|plot| multiply(plot, by));
    }
}

/// Multiplies the coordinates of a plot of one of the kinds that pictures have.
fn multiply(plot: &mut Plot, [x, y]: [f64; 2]) {
    match plot {
        Plot::Line(line) => {
            line.data.iter_mut().for_each(|point| (point.x, point.y) = (x * point.x, y * point.y));
        }
        Plot::Scatter(points) => {
            points.data.iter_mut().for_each(|point| (point.x, point.y) = (x * point.x, y * point.y));
        }
        Plot::Band(band) => {
            band.x.iter_mut().for_each(|value| *value *= x);
            band.y_lower.iter_mut().chain(&mut band.y_upper).for_each(|value| *value *= y);
        }
        Plot::Heatmap(map) => {
            map.x_range.iter_mut().for_each(|range| scale(range, x));
            map.y_range.iter_mut().for_each(|range| scale(range, y));
        }
        Plot::Histogram(bars) => {
            if let Some((edges, counts)) = &mut bars.precomputed {
                edges.iter_mut().for_each(|value| *value *= x);
                counts.iter_mut().for_each(|value| *value *= y);
            }
        }
        _ => {}
    }
}

fn scale(range: &mut (f64, f64), by: f64) {
    *range = (times(range.0, by), times(range.1, by));
}

/// A product without the rounding of its last digits, so that a tick at the end of an axis stays there.
fn times(value: f64, factor: f64) -> f64 {
    let product = value * factor;
    format!("{product:.14e}").parse().unwrap_or(product)
}

#[cfg(test)]
mod tests {
    use super::super::style;
    use super::*;

    #[test]
    fn only_very_small_values_are_multiplied() {
        assert_eq!([(0.0, 1.0), (0.0, 2e-12), (1.0, 1.0), (0.0, 0.0), (-1e5, 1e5)].map(linear), [1.0; 5]);
        assert_eq!(linear((0.0, 3e-18)), 1e18);
        assert_eq!(linear((-3e-18, -1e-18)), 1e18);
        assert_eq!([1e-9, 1.0, 0.0, f64::NAN].map(logarithmic), [1.0; 4]);
        assert_eq!(logarithmic(3e-13), 1e4);
        assert!([linear((0.0, 1e-320)), logarithmic(1e-320)].into_iter().all(f64::is_finite));
    }

    /// 8e-21 times 1e21 is less than 8 by rounding.
    #[test]
    fn ticks_at_the_ends_of_an_axis_stay_there() {
        let (_, layout) = drawable(Plots::new(), style::layout((2e-21, 8e-21), (0.0, 1.0)));
        assert_eq!((layout.x_axis_min, layout.x_axis_max), (Some(2.0), Some(8.0)));
    }

    #[test]
    fn ticks_have_the_labels_of_their_true_values() {
        let ends = (1e-14, 1e-2);
        let layout = style::layout(ends, (0.0, 4e-18)).with_log_x().with_x_tick_format(style::powers(ends));
        let plots = vec![super::super::curve::line(vec![(1e-14, 2e-18)], style::BLUE, 1.0, None)];
        let (plots, layout) = drawable(plots, layout);
        let ends = [layout.x_axis_min.unwrap() / 1e-9, layout.y_axis_max.unwrap() / 4.0];
        assert!(ends.into_iter().all(|end| (end - 1.0).abs() < 1e-12), "{ends:?}");
        assert_eq!([1e-9, 1e3].map(|tick| layout.x_tick_format.format(tick)), ["10⁻¹⁴", "10⁻²"]);
        assert_eq!([0.0, 2.0].map(|tick| layout.y_tick_format.format(tick)), ["0", "2 × 10⁻¹⁸"]);
        let Plot::Line(line) = &plots[0] else { panic!("a line") };
        assert!((line.data[0].x / 1e-9 - 1.0).abs() + (line.data[0].y / 2.0 - 1.0).abs() < 1e-12);
    }
}
