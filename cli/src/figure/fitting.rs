//! Labels that fit: one that is longer than its axis has two lines, and ticks whose labels would touch are farther apart.

use std::sync::Arc;

use kuva::render::layout::{ComputedLayout, Layout, TickFormat};
use kuva::render::render_utils::{compute_tick_step, generate_ticks_log, generate_ticks_with_step};

use super::letters;

/// Greatest length of a label over that of its axis.
const BEYOND: f64 = 1.2;
/// Least distance of the labels of ticks over their font size.
const APART: f64 = 0.6;
/// Height of a line over its font size.
const LINE: f64 = 1.17;
/// As many letters in a line as its own breaks leave.
const UNBROKEN: usize = usize::MAX;
/// Most ticks that the plot library draws.
const MOST: usize = 10;

/// A layout of known size whose labels fit.
pub fn fitted(layout: Layout) -> Layout {
    level(upright(layout))
}

/// A layout of known size with labels of two lines beside vertical axes that are shorter.
pub fn upright(mut layout: Layout) -> Layout {
    let drawn = ComputedLayout::from_layout(&layout);
    let room = room(drawn.plot_height(), [drawn.margin_top, drawn.margin_bottom]);
    let size = f64::from(layout.label_size);
    if let Some(lines) = broken(layout.y_label.as_deref(), size, room) {
        layout = layout.with_y_label(lines).with_y_label_wrap(UNBROKEN);
    }
    // A margin on the right that is given has room for one line.
    let second = layout.y2_label.as_deref().filter(|_| layout.force_margin_right.is_none());
    match broken(second, size, room) {
        Some(lines) => layout.with_y2_label(lines).with_y2_label_wrap(UNBROKEN),
        None => layout,
    }
}

/// A layout of known size with a label of two lines below a horizontal axis that is shorter, and ticks whose labels do not touch.
pub fn level(layout: Layout) -> Layout {
    let drawn = ComputedLayout::from_layout(&layout);
    let axis = drawn.plot_width();
    let room = room(axis, [drawn.margin_left, drawn.margin_right]);
    let layout = match broken(layout.x_label.as_deref(), f64::from(layout.label_size), room) {
        Some(lines) => layout.with_x_label(lines).with_x_label_wrap(UNBROKEN),
        None => layout,
    };
    let Some(ends) = layout.x_axis_min.zip(layout.x_axis_max) else { return layout };
    if layout.log_x { sparse(layout, ends, axis) } else { stepped(layout, ends, axis) }
}

/// Whether a label has two lines.
pub fn has_two_lines(label: Option<&str>) -> bool {
    label.is_some_and(|label| label.contains('\n'))
}

/// The left margin that a label of two lines needs; none where the label has one.
pub fn needed_on_the_left(layout: &Layout) -> Option<f64> {
    /// What the plot library leaves between the axis, its ticks, their labels and that of the axis, and at the edge.
    const BETWEEN: f64 = 16.0;
    if !has_two_lines(layout.y_label.as_deref()) {
        return None;
    }
    let drawn = ComputedLayout::from_layout(layout);
    Some(BETWEEN + drawn.y_tick_label_px + 2.0 * line(layout.label_size))
}

/// The height of a line of letters of this size.
pub fn line(size: u32) -> f64 {
    LINE * f64::from(size)
}

/// The step of ticks at whole numbers from 0 to a length, about so many.
pub fn whole_step(length: f64, ticks: usize) -> f64 {
    let step = compute_tick_step(0.0, length, ticks).max(1.0);
    if step.fract() == 0.0 { step } else { 2.0 * step }
}

/// The room for a label along an axis of this length between these margins: it may be a little longer than the axis.
fn room(axis: f64, [before, after]: [f64; 2]) -> f64 {
    (BEYOND * axis).min(axis + 2.0 * before.min(after))
}

/// A label that is longer than the room for it in two lines, the longer of which is as short as possible.
fn broken(label: Option<&str>, size: f64, room: f64) -> Option<String> {
    let label = label.filter(|label| letters::width(label, size) > room)?;
    let halves = label.match_indices(' ').map(|(at, _)| (&label[..at], &label[at + 1..]));
    // What is in parentheses, such as the arguments of a function, stays together.
    let is_whole = |(first, _): &(&str, &str)| first.matches('(').count() == first.matches(')').count();
    let longer =
        |(first, second): &(&str, &str)| letters::width(first, size).max(letters::width(second, size));
    let (first, second) = halves.filter(is_whole).min_by(|a, b| longer(a).total_cmp(&longer(b)))?;
    Some(format!("{first}\n{second}"))
}

/// A linear axis with as many ticks as have room for their labels.
fn stepped(layout: Layout, ends: (f64, f64), axis: f64) -> Layout {
    let usual = match layout.ticks {
        0 => ComputedLayout::from_layout(&layout).x_ticks.min(MOST),
        ticks => ticks,
    };
    let first = layout.x_tick_step.unwrap_or_else(|| compute_tick_step(ends.0, ends.1, usual));
    let place = |value: f64| axis * (value - ends.0) / (ends.1 - ends.0);
    let fits = |step: &f64| {
        let ticks = generate_ticks_with_step(ends.0, ends.1, *step);
        !touch(&layout, ticks.into_iter().map(|tick| (place(tick), tick)))
    };
    let step = std::iter::successors(Some(first), |step| Some(wider(*step))).take(STEPS).find(fits);
    match step.filter(|step| *step != first) {
        Some(step) => layout.with_x_tick_step(step),
        None => layout,
    }
}

/// Most steps that are tried.
const STEPS: usize = 12;

/// The next larger step of 1, 2 or 5 times a power of ten.
fn wider(step: f64) -> f64 {
    let power = 10f64.powf((step * (1.0 + 1e-9)).log10().floor());
    let larger = [2.0, 5.0, 10.0].map(|factor| factor * power);
    larger.into_iter().find(|larger| *larger > step * (1.0 + 1e-6)).unwrap_or(10.0 * step)
}

/// A logarithmic axis on which every second, third … power of ten has a label, so that they have room.
fn sparse(layout: Layout, ends: (f64, f64), axis: f64) -> Layout {
    let usual = layout.x_tick_format.clone();
    let place = |value: f64| axis * (value / ends.0).log10() / (ends.1 / ends.0).log10();
    let ticks = generate_ticks_log(ends.0, ends.1);
    let fits = |layout: &Layout| !touch(layout, ticks.iter().map(|&tick| (place(tick), tick)));
    if fits(&layout) {
        return layout;
    }
    let mut layout = layout;
    for every in 1..=MOST {
        layout = layout.with_x_tick_format(every_power(usual.clone(), every));
        if fits(&layout) {
            break;
        }
    }
    layout
}

/// The labels of powers of ten whose exponents are multiples of a number.
fn every_power(usual: TickFormat, every: usize) -> TickFormat {
    TickFormat::Custom(Arc::new(move |value: f64| {
        let exponent = value.log10();
        let is_shown = (exponent - exponent.round()).abs() < 1e-6 && exponent.round() % every as f64 == 0.0;
        if is_shown { usual.format(value) } else { String::new() }
    }))
}

/// Whether the labels of ticks at these places touch each other.
fn touch(layout: &Layout, ticks: impl Iterator<Item = (f64, f64)>) -> bool {
    let size = f64::from(layout.tick_size);
    let mut end = f64::NEG_INFINITY;
    for (place, value) in ticks {
        let label = layout.x_tick_format.format(value);
        if label.is_empty() {
            continue;
        }
        let half = 0.5 * letters::width(&label, size);
        if place - half < end + APART * size {
            return true;
        }
        end = place + half;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(ends: (f64, f64), width: f64) -> Layout {
        super::super::style::layout(ends, (0.0, 1.0))
            .with_width(width)
            .with_height(200.0)
            .with_force_margins(50.0, 10.0)
    }

    #[test]
    fn a_label_that_is_longer_than_its_axis_has_two_lines() {
        let words = "Interval to the next event / mean interval";
        let drawn = |width: f64| fitted(axis((0.0, 1.0), width).with_x_label(words)).x_label.unwrap();
        assert_eq!(drawn(600.0), words);
        assert_eq!(drawn(260.0), "Interval to the next\nevent / mean interval");
        let upright = fitted(axis((0.0, 1.0), 600.0).with_height(110.0).with_y_label("Density Q(x; X)"));
        assert_eq!(upright.y_label.as_deref(), Some("Density\nQ(x; X)"));
        // A word has no place to break.
        let word = fitted(axis((0.0, 1.0), 65.0).with_x_label("Displacement")).x_label;
        assert_eq!(word.as_deref(), Some("Displacement"));
        let upright = fitted(axis((0.0, 1.0), 600.0).with_y_label("Wider than it is high (MPa)"));
        assert_eq!(upright.y_label.as_deref(), Some("Wider than it\nis high (MPa)"));
    }

    #[test]
    fn ticks_have_room_for_their_labels() {
        let step = |layout: Layout| fitted(layout).x_tick_step;
        assert_eq!(step(axis((0.0, 80.0), 660.0)), None);
        // 60 units of the canvas have room for two numbers of two digits, not for four.
        assert_eq!(step(axis((0.0, 80.0), 120.0).with_ticks(4)), Some(50.0));
        assert_eq!(step(axis((0.0, 80.0), 120.0).with_x_tick_step(10.0)), Some(50.0));
    }

    #[test]
    fn powers_of_ten_have_room_for_their_labels() {
        let ends = (1e-6, 1.0);
        let narrow = axis(ends, 160.0).with_log_scale().with_x_tick_format(super::super::style::powers(ends));
        let format = fitted(narrow).x_tick_format;
        let shown = (-6..=0).filter(|n| !format.format(10f64.powi(*n)).is_empty()).collect::<Vec<_>>();
        assert_eq!(shown, [-6, -3, 0]);
    }

    #[test]
    fn whole_numbers_have_ticks_at_whole_numbers() {
        assert_eq!([3.0, 10.0, 20.0, 90.0].map(|length| whole_step(length, 4)), [1.0, 5.0, 5.0, 25.0]);
    }
}
