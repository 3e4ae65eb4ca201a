//! Ticks whose labels do not touch: where they would, ticks are farther apart.

use std::sync::Arc;

use kuva::render::layout::{ComputedLayout, Layout, TickFormat};
use kuva::render::render_utils::{compute_tick_step, generate_ticks_log, generate_ticks_with_step};

use super::letters;

/// Most ticks that the plot library draws.
const MOST: usize = 10;
/// Most steps that are tried.
const STEPS: usize = 12;

/// The side of a panel that an axis is at.
#[derive(Clone, Copy)]
pub enum Side {
    Below,
    Left,
}

impl Side {
    /// A layout with as many ticks on an axis of this length as have room for their labels.
    pub fn with_labels_apart(self, layout: Layout, axis: f64) -> Layout {
        match self.ends(&layout) {
            Some((ends, true)) => self.sparse(layout, ends, axis),
            Some((ends, false)) => self.stepped(layout, ends, axis),
            None => layout,
        }
    }

    /// A linear axis.
    fn stepped(self, layout: Layout, ends: (f64, f64), axis: f64) -> Layout {
        let first =
            self.step(&layout).unwrap_or_else(|| compute_tick_step(ends.0, ends.1, self.ticks(&layout)));
        let place = |value: f64| axis * (value - ends.0) / (ends.1 - ends.0);
        let fits = |step: &f64| {
            let ticks = generate_ticks_with_step(ends.0, ends.1, *step);
            !self.touch(&layout, ticks.into_iter().map(|tick| (place(tick), tick)))
        };
        let step = std::iter::successors(Some(first), |step| Some(wider(*step))).take(STEPS).find(fits);
        match step.filter(|step| *step != first) {
            Some(step) => self.with_step(layout, step),
            None => layout,
        }
    }

    /// A logarithmic axis, on which every second, third … power of ten has a label where there is no room for all.
    fn sparse(self, layout: Layout, ends: (f64, f64), axis: f64) -> Layout {
        let usual = self.format(&layout).clone();
        let place = |value: f64| axis * (value / ends.0).log10() / (ends.1 / ends.0).log10();
        let ticks = generate_ticks_log(ends.0, ends.1);
        let fits = |layout: &Layout| !self.touch(layout, ticks.iter().map(|&tick| (place(tick), tick)));
        let mut layout = layout;
        for every in 1..=MOST {
            if fits(&layout) {
                break;
            }
            layout = self.with_format(layout, every_power(usual.clone(), every));
        }
        layout
    }

    /// The width of the widest label.
    pub fn widest(self, layout: &Layout) -> f64 {
        let labels = self.values(layout).into_iter().map(|value| self.format(layout).format(value));
        labels.map(|label| letters::width(&label, f64::from(layout.tick_size))).fold(0.0, f64::max)
    }

    /// By how much the last label reaches beyond the end of an axis of this length.
    pub fn beyond(self, layout: &Layout, axis: f64) -> f64 {
        let Some(((low, high), is_logarithmic)) = self.ends(layout) else { return 0.0 };
        let values = self.values(layout);
        let mut labels = values.into_iter().map(|value| (value, self.format(layout).format(value)));
        let Some((value, label)) = labels.rfind(|label| !label.1.is_empty()) else { return 0.0 };
        let left = match is_logarithmic {
            true => (high / value).log10() / (high / low).log10(),
            false => (high - value) / (high - low),
        };
        0.5 * self.extent(&label, f64::from(layout.tick_size)) - axis * left
    }

    /// The values of the ticks.
    fn values(self, layout: &Layout) -> Vec<f64> {
        let Some(((low, high), is_logarithmic)) = self.ends(layout) else { return Vec::new() };
        if is_logarithmic {
            return generate_ticks_log(low, high);
        }
        let usual = || compute_tick_step(low, high, self.ticks(layout));
        generate_ticks_with_step(low, high, self.step(layout).unwrap_or_else(usual))
    }

    /// The ends of the axis, and whether it is logarithmic.
    fn ends(self, layout: &Layout) -> Option<((f64, f64), bool)> {
        let (ends, is_logarithmic) = match self {
            Self::Below => (layout.x_axis_min.zip(layout.x_axis_max), layout.log_x),
            Self::Left => (layout.y_axis_min.zip(layout.y_axis_max), layout.log_y),
        };
        Some((ends?, is_logarithmic))
    }

    /// Whether the labels of ticks at these places touch each other.
    fn touch(self, layout: &Layout, ticks: impl Iterator<Item = (f64, f64)>) -> bool {
        let size = f64::from(layout.tick_size);
        let mut end = f64::NEG_INFINITY;
        for (place, value) in ticks {
            let label = self.format(layout).format(value);
            if label.is_empty() {
                continue;
            }
            let half = 0.5 * self.extent(&label, size);
            if place - half < end + self.apart() * size {
                return true;
            }
            end = place + half;
        }
        false
    }

    /// How much of the axis a label takes.
    fn extent(self, label: &str, size: f64) -> f64 {
        /// Height of digits over the font size.
        const DIGITS: f64 = 0.73;
        match self {
            Self::Below => letters::width(label, size),
            Self::Left => DIGITS * size,
        }
    }

    /// Least distance of labels over their font size.
    fn apart(self) -> f64 {
        match self {
            Self::Below => 0.6,
            Self::Left => 0.2,
        }
    }

    fn format(self, layout: &Layout) -> &TickFormat {
        match self {
            Self::Below => &layout.x_tick_format,
            Self::Left => &layout.y_tick_format,
        }
    }

    fn with_format(self, layout: Layout, format: TickFormat) -> Layout {
        match self {
            Self::Below => layout.with_x_tick_format(format),
            Self::Left => layout.with_y_tick_format(format),
        }
    }

    fn step(self, layout: &Layout) -> Option<f64> {
        match self {
            Self::Below => layout.x_tick_step,
            Self::Left => layout.y_tick_step,
        }
    }

    fn with_step(self, layout: Layout, step: f64) -> Layout {
        match self {
            Self::Below => layout.with_x_tick_step(step),
            Self::Left => layout.with_y_tick_step(step),
        }
    }

    /// About how many ticks the axis has.
    fn ticks(self, layout: &Layout) -> usize {
        if layout.ticks > 0 {
            return layout.ticks;
        }
        let drawn = ComputedLayout::from_layout(layout);
        let ticks = match self {
            Self::Below => drawn.x_ticks,
            Self::Left => drawn.y_ticks,
        };
        ticks.min(MOST)
    }
}

/// The next larger step of 1, 2 or 5 times a power of ten.
fn wider(step: f64) -> f64 {
    let power = 10f64.powf((step * (1.0 + 1e-9)).log10().floor());
    let larger = [2.0, 5.0, 10.0].map(|factor| factor * power);
    larger.into_iter().find(|larger| *larger > step * (1.0 + 1e-6)).unwrap_or(10.0 * step)
}

/// The labels of powers of ten whose exponents are multiples of a number.
fn every_power(usual: TickFormat, every: usize) -> TickFormat {
    TickFormat::Custom(Arc::new(move |value: f64| {
        let exponent = value.log10();
        let is_shown = (exponent - exponent.round()).abs() < 1e-6 && exponent.round() % every as f64 == 0.0;
        if is_shown { usual.format(value) } else { String::new() }
    }))
}
