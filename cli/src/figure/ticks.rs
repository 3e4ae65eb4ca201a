//! Pictures with minor ticks: 2 to 9 on logarithmic axes, four or five parts of a step on linear ones.
//!
//! The plot library divides the steps of both axes into the same number of equal parts, which fits neither axes of two kinds
//! nor short logarithmic ones.

use std::ops::Range;

use kuva::render::figure::Figure;
use kuva::render::layout::Layout;
use kuva::render::render::{Primitive, Scene, render_multiple, render_twin_y};

use super::fitting::fitted;
use super::grid::Grid;
use super::magnitude::{drawable, drawable_twin};
use super::style::Plots;

/// Length of minor ticks over that of the others.
const SHORT: f64 = 0.6;
/// Longest tick, in units of the canvas: a longer line is none.
const LONGEST: f64 = 8.0;
/// Smallest distance of minor ticks.
const CLOSEST: f64 = 4.0;
/// Least length of a decade with minor ticks.
const DECADE: f64 = 20.0;
/// Largest distance of a point from a line that it lies on.
const NEAR: f64 = 0.05;

/// A picture of one panel.
pub fn panel(plots: Plots, layout: Layout) -> Scene {
    panel_of_exponents(plots, layout, [false; 2])
}

/// The same where the coordinates along x or y may be decimal logarithms.
pub fn panel_of_exponents(plots: Plots, layout: Layout, exponents: [bool; 2]) -> Scene {
    let (plots, layout) = drawable(plots, layout);
    let layout = fitted(layout);
    let axes = [Axes::of(&layout).raised(exponents)];
    divided(render_multiple(plots, layout), &axes)
}

/// A picture of one panel with two vertical axes.
pub fn twin(left: Plots, right: Plots, layout: Layout) -> Scene {
    let (left, right, layout) = drawable_twin(left, right, layout);
    let layout = fitted(layout);
    let axes = [Axes::of(&layout)];
    divided(render_twin_y(left, right, layout), &axes)
}

/// A picture of several panels, of one or two vertical axes. One without plots is empty.
pub fn panels(grid: Grid, plots: Vec<Plots>, layouts: Vec<Layout>) -> Scene {
    let exponents = vec![[false; 2]; layouts.len()];
    panels_of_exponents(grid, plots, layouts, &exponents)
}

/// The same where the coordinates along x or y may be decimal logarithms.
pub fn panels_of_exponents(
    grid: Grid,
    plots: Vec<Plots>,
    layouts: Vec<Layout>,
    exponents: &[[bool; 2]],
) -> Scene {
    let (plots, layouts): (Vec<Plots>, Vec<Layout>) =
        plots.into_iter().zip(layouts).map(|(plots, layout)| drawable(plots, layout)).unzip();
    let (figure, layouts) = grid.fitted(layouts);
    let drawn = plots.iter().zip(layouts.iter().zip(exponents)).filter(|(plots, _)| !plots.is_empty());
    let axes: Vec<Axes> = drawn.map(|(_, (layout, exponents))| Axes::of(layout).raised(*exponents)).collect();
    let (figure, plots) = twins(figure, plots, &layouts);
    divided(figure.with_plots(plots).with_layouts(layouts).render(), &axes)
}

/// Hands the plots of panels with two vertical axes to the figure, and returns the others.
fn twins(mut figure: Figure, mut plots: Vec<Plots>, layouts: &[Layout]) -> (Figure, Vec<Plots>) {
    let two_axes = layouts.iter().enumerate().filter(|(_, layout)| layout.y2_range.is_some());
    for (panel, _) in two_axes {
        figure = figure.with_twin_y_plots(panel, std::mem::take(&mut plots[panel]), Vec::new());
    }
    (figure, plots)
}

/// The values at the ends of an axis.
#[derive(Debug, Clone, Copy)]
struct Axis {
    ends: (f64, f64),
    logarithmic: bool,
}

/// The axes of a panel: below, on the left and on the right.
struct Axes([Option<Axis>; 3]);

impl Axes {
    fn of(layout: &Layout) -> Self {
        let axis = |ends: (Option<f64>, Option<f64>), logarithmic| {
            ends.0.zip(ends.1).map(|ends| Axis { ends, logarithmic })
        };
        Self([
            axis((layout.x_axis_min, layout.x_axis_max), layout.log_x),
            axis((layout.y_axis_min, layout.y_axis_max), layout.log_y),
            axis((layout.y2_axis_min, layout.y2_axis_max), layout.log_y2)
                .filter(|_| layout.y2_range.is_some()),
        ])
    }

    /// The axes where the coordinates along x or y may be decimal logarithms.
    fn raised(self, [x, y]: [bool; 2]) -> Self {
        let [below, left, right] = self.0;
        let raised = |axis: Option<Axis>, exponents: bool| match exponents {
            true => axis.map(Axis::raised),
            false => axis,
        };
        Self([raised(below, x), raised(left, y), right])
    }
}

impl Axis {
    /// The axis of the powers of ten whose exponents are drawn.
    fn raised(self) -> Self {
        Self { ends: (10f64.powf(self.ends.0), 10f64.powf(self.ends.1)), logarithmic: true }
    }
}

/// The picture with minor ticks in the panels of these axes, below what is plotted, as the other ticks.
fn divided(mut scene: Scene, axes: &[Axes]) -> Scene {
    let mut elements: Vec<Primitive> = Vec::with_capacity(scene.elements.len());
    let (mut start, mut axes) = (0, axes.iter());
    for element in scene.elements {
        match element {
            Primitive::ClipStart { x, y, width, height, .. } => {
                let frame = Frame { across: (x, x + width), up: (y + height, y) };
                let minor = axes.next().map(|axes| frame.minor(&elements[start..], axes));
                elements.extend(minor.into_iter().flatten());
            }
            Primitive::ClipEnd => start = elements.len(),
            _ => {}
        }
        elements.push(element);
    }
    scene.elements = elements;
    scene
}

/// The frame of a panel: its left and right, its lower and upper ends.
struct Frame {
    across: (f64, f64),
    up: (f64, f64),
}

impl Frame {
    /// The minor ticks of the panel whose axes these elements draw.
    fn minor(&self, drawn: &[Primitive], axes: &Axes) -> Vec<Primitive> {
        let edges = [(self.up.0, self.across), (self.across.0, self.up), (self.across.1, self.up)];
        let mut minor = Vec::new();
        for (side, (axis, (edge, ends))) in axes.0.iter().zip(edges).enumerate() {
            let Some(axis) = axis else { continue };
            let ticks: Vec<Tick> = drawn.iter().filter_map(|line| Tick::of(line, side == 0, edge)).collect();
            let Some(first) = ticks.first() else { continue };
            let known: Vec<f64> = ticks.iter().map(|tick| tick.at).collect();
            minor.extend(axis.minor(ends, &known).into_iter().map(|at| first.short(at, edge)));
        }
        minor
    }
}

/// A tick across an edge of a frame.
struct Tick {
    /// Its place along the edge.
    at: f64,
    /// Its ends, from the edge.
    reach: Range<f64>,
    /// Whether the edge is horizontal.
    below: bool,
    line: Primitive,
}

impl Tick {
    fn of(element: &Primitive, below: bool, edge: f64) -> Option<Self> {
        let Primitive::Line { x1, y1, x2, y2, .. } = element else { return None };
        let (along, across) = if below { ((x1, x2), (y1, y2)) } else { ((y1, y2), (x1, x2)) };
        let reach = across.0.min(*across.1) - edge..across.0.max(*across.1) - edge;
        let touches = reach.start.abs() < NEAR || reach.end.abs() < NEAR;
        let is_tick = along.0 == along.1 && touches && reach.end - reach.start <= LONGEST;
        (is_tick && reach.end > reach.start).then(|| Self {
            at: *along.0,
            reach,
            below,
            line: element.clone(),
        })
    }

    /// A shorter tick at another place.
    fn short(&self, at: f64, edge: f64) -> Primitive {
        let mut line = self.line.clone();
        let ends = [edge + SHORT * self.reach.start, edge + SHORT * self.reach.end];
        if let Primitive::Line { x1, y1, x2, y2, .. } = &mut line {
            ([*x1, *x2], [*y1, *y2]) = if self.below { ([at; 2], ends) } else { (ends, [at; 2]) };
        }
        line
    }
}

impl Axis {
    /// The places of minor ticks between these ends of an axis, with ticks at known places.
    fn minor(&self, ends: (f64, f64), known: &[f64]) -> Vec<f64> {
        let places = if self.logarithmic { self.multiples(ends) } else { self.parts(ends, known) };
        let free = |at: &f64| known.iter().all(|tick| (tick - at).abs() > 0.25 * CLOSEST);
        let (low, high) = (ends.0.min(ends.1), ends.0.max(ends.1));
        places.into_iter().filter(|at| (low..=high).contains(at)).filter(free).collect()
    }

    /// The places of 2 to 9 times powers of ten.
    fn multiples(&self, (start, end): (f64, f64)) -> Vec<f64> {
        let (low, high) = (self.ends.0.log10(), self.ends.1.log10());
        let decade = (end - start) / (high - low);
        if !decade.is_finite() || decade.abs() < DECADE {
            return Vec::new();
        }
        let decades = low.floor() as i32..=high.floor() as i32;
        let place = |exponent: f64| start + decade * (exponent - low);
        decades.flat_map(|n| (2..10).map(move |k| f64::from(n) + f64::from(k).log10())).map(place).collect()
    }

    /// The places that divide the steps between known ticks.
    fn parts(&self, (start, end): (f64, f64), known: &[f64]) -> Vec<f64> {
        let [first, second, ..] = known else { return Vec::new() };
        let step = (second - first).abs();
        let parts = parts_of(step * ((self.ends.1 - self.ends.0) / (end - start)).abs());
        let parts = if step < CLOSEST * f64::from(parts) { 2 } else { parts };
        let part = step / f64::from(parts);
        if part.is_nan() || part < CLOSEST {
            return Vec::new();
        }
        let most = ((end - start).abs() / part).ceil() as i32;
        (-most..=most).map(|i| first + f64::from(i) * part).collect()
    }
}

/// The number of parts into which a step is divided: round numbers lie between 0, 2 and 4 and between 0, 1 and 2.
fn parts_of(step: f64) -> u32 {
    let leading = step / 10f64.powf(step.log10().floor());
    if [1.0, 2.5, 5.0, 10.0].iter().any(|round| (leading / round - 1.0).abs() < 1e-3) { 5 } else { 4 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(ends: (f64, f64), logarithmic: bool, frame: (f64, f64), known: &[f64]) -> Vec<f64> {
        let at = Axis { ends, logarithmic }.minor(frame, known);
        let share = |at: f64| (at - frame.0) / (frame.1 - frame.0);
        let value = |at: f64| {
            if logarithmic {
                ends.0 * (ends.1 / ends.0).powf(share(at))
            } else {
                ends.0 + (ends.1 - ends.0) * share(at)
            }
        };
        at.into_iter().map(|at| (1e6 * value(at)).round() / 1e6).collect()
    }

    #[test]
    fn decades_have_ticks_from_2_to_9() {
        let expected = [0.8, 0.9, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 20.0];
        let place = |value: f64| 400.0 - 300.0 * (value / 0.8).log10() / (30.0_f64 / 0.8).log10();
        // The vertical axis goes up, to smaller ordinates.
        assert_eq!(
            places(
                (0.8, 25.0),
                true,
                (400.0, 400.0 - 300.0 * (25.0_f64 / 0.8).log10() / (30.0_f64 / 0.8).log10()),
                &[place(1.0), place(10.0)]
            ),
            expected
        );
        assert_eq!(places((1e-30, 1.0), true, (0.0, 400.0), &[0.0, 400.0]), [0.0; 0]);
    }

    #[test]
    fn steps_are_divided_into_round_parts_beyond_the_last_tick_too() {
        assert_eq!(
            places((0.0, 1.3), false, (0.0, 260.0), &[0.0, 100.0, 200.0]),
            [0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 1.1, 1.2, 1.3]
        );
        assert_eq!(places((0.0, 2.0), false, (0.0, 200.0), &[0.0, 200.0]), [0.5, 1.0, 1.5]);
        assert_eq!(places((0.0, 2.0), false, (0.0, 10.0), &[0.0, 10.0]), [1.0]);
    }
}
