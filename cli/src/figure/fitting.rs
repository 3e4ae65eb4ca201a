//! Labels of axes that fit: one that is longer than its axis has two lines, and smaller letters where these do not fit either.

use kuva::render::layout::{ComputedLayout, Layout};
use kuva::render::render_utils::compute_tick_step;

use super::letters;
use super::tick_labels::Side;

/// Greatest length of a label over that of its axis.
const BEYOND: f64 = 1.2;
/// Height of a line over its font size.
const LINE: f64 = 1.17;
/// The smallest font size of labels.
const SMALLEST: f64 = 8.0;
/// What the plot library leaves free at the edge of a picture of several panels.
const EDGE: f64 = 10.0;
/// As many letters in a line as its own breaks leave.
const UNBROKEN: usize = usize::MAX;

/// A layout of known size whose labels fit.
pub fn fitted(layout: Layout) -> Layout {
    level(upright(layout))
}

/// A layout of known size with labels of two lines beside vertical axes that are shorter, and ticks on the left whose labels do
/// not touch.
pub fn upright(mut layout: Layout) -> Layout {
    let drawn = ComputedLayout::from_layout(&layout);
    let (axis, margins) = (drawn.plot_height(), [drawn.margin_top, drawn.margin_bottom]);
    let room = room(axis, margins);
    let size = f64::from(layout.label_size);
    if let Some(lines) = broken(layout.y_label.as_deref(), size, room) {
        layout = layout.with_y_label(lines).with_y_label_wrap(UNBROKEN);
    }
    // A margin on the right that is given has room for one line.
    let second = layout.y2_label.as_deref().filter(|_| layout.force_margin_right.is_none());
    if let Some(lines) = broken(second, size, room) {
        layout = layout.with_y2_label(lines).with_y2_label_wrap(UNBROKEN);
    }
    let labels = [layout.y_label.as_deref(), layout.y2_label.as_deref()];
    layout.label_size = smaller(layout.label_size, labels, within(axis, margins));
    beside(Side::Left.with_labels_apart(layout, axis))
}

/// A layout whose label on the left is beside those of the ticks: the plot library leaves room for those of about five ticks, which
/// may be shorter than others.
fn beside(mut layout: Layout) -> Layout {
    /// What the room for the labels of ticks may lack.
    const LACKING: f64 = 8.0;
    let drawn = ComputedLayout::from_layout(&layout);
    let lacking = Side::Left.widest(&layout) - drawn.y_tick_label_px;
    if lacking > LACKING && layout.force_margin_left.is_none() && layout.y_label.is_some() {
        layout.force_margin_left = Some(drawn.margin_left + lacking);
        layout.y_label_offset.0 -= lacking;
    }
    layout
}

/// A layout of known size with a label of two lines below a horizontal axis that is shorter, and ticks whose labels do not touch.
pub fn level(layout: Layout) -> Layout {
    let drawn = ComputedLayout::from_layout(&layout);
    let (axis, margins) = (drawn.plot_width(), [drawn.margin_left, drawn.margin_right]);
    let room = room(axis, margins);
    let mut layout = match broken(layout.x_label.as_deref(), f64::from(layout.label_size), room) {
        Some(lines) => layout.with_x_label(lines).with_x_label_wrap(UNBROKEN),
        None => layout,
    };
    layout.label_size = smaller(layout.label_size, [layout.x_label.as_deref(), None], within(axis, margins));
    Side::Below.with_labels_apart(layout, axis)
}

/// Whether a label has two lines.
pub fn has_two_lines(label: Option<&str>) -> bool {
    label.is_some_and(|label| label.contains('\n'))
}

/// The left margin that the label of the axis and those of its ticks need; none where there is room for one line, or no label.
pub fn needed_on_the_left(layout: &Layout) -> Option<f64> {
    /// What the plot library leaves between the axis, its ticks, their labels and that of the axis, and at the edge.
    const BETWEEN: f64 = 16.0;
    /// What it leaves at the edge at least, and the part of a line of letters that reaches from there to the axis.
    const LEAST: f64 = 8.0;
    const LETTERS: f64 = 0.74;
    /// Least distance of the letters of both, and a better one.
    const APART: (f64, f64) = (1.0, 4.0);
    let label = layout.y_label.as_deref().filter(|label| !label.is_empty())?;
    let drawn = ComputedLayout::from_layout(layout);
    if has_two_lines(Some(label)) {
        return Some(BETWEEN + drawn.y_tick_label_px + 2.0 * line(layout.label_size));
    }
    let letters = LEAST + LETTERS * f64::from(layout.label_size) + Side::Left.widest(layout);
    let taken = letters + drawn.tick_label_margin;
    (taken + APART.0 > drawn.margin_left).then_some(taken + APART.1)
}

/// The right margin that the last label below the axis needs; none where it ends within the margin.
pub fn needed_on_the_right(layout: &Layout) -> Option<f64> {
    let drawn = ComputedLayout::from_layout(layout);
    let beyond = Side::Below.beyond(layout, drawn.plot_width());
    (beyond > drawn.margin_right + EDGE).then_some(beyond)
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
fn room(axis: f64, margins: [f64; 2]) -> f64 {
    (BEYOND * axis).min(within(axis, margins))
}

/// The room for a label in the middle of an axis between the edges of its panel.
fn within(axis: f64, [before, after]: [f64; 2]) -> f64 {
    axis + 2.0 * before.min(after)
}

/// The font size with which these labels fit into a room, the usual one or a smaller one.
fn smaller(usual: u32, labels: [Option<&str>; 2], room: f64) -> u32 {
    let lines = labels.into_iter().flatten().flat_map(str::lines);
    let longest = lines.map(|line| letters::width(line, f64::from(usual))).fold(0.0, f64::max);
    let fitting = f64::from(usual) * room / longest;
    if longest > room { fitting.floor().max(SMALLEST) as u32 } else { usual }
}

/// A label that is longer than the room for it in two lines, the longer of which is as short as possible.
fn broken(label: Option<&str>, size: f64, room: f64) -> Option<String> {
    let label = label.filter(|label| !has_two_lines(Some(label)) && letters::width(label, size) > room)?;
    // A key of a scenario has no spaces: its first line ends with a dot.
    let has_spaces = label.contains(' ');
    let halves = label.match_indices(if has_spaces { ' ' } else { '.' });
    let halves = halves.map(|(at, _)| (&label[..at + usize::from(!has_spaces)], &label[at + 1..]));
    // What is in parentheses, such as the arguments of a function, stays together.
    let is_whole = |(first, _): &(&str, &str)| first.matches('(').count() == first.matches(')').count();
    let longer =
        |(first, second): &(&str, &str)| letters::width(first, size).max(letters::width(second, size));
    let (first, second) = halves.filter(is_whole).min_by(|a, b| longer(a).total_cmp(&longer(b)))?;
    Some(format!("{first}\n{second}"))
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
        let key = fitted(axis((0.0, 1.0), 130.0).with_x_label("gaussian.mean")).x_label;
        assert_eq!(key.as_deref(), Some("gaussian.\nmean"));
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
        // 100 units have room for eleven lines of letters of 8 units, not of 20.
        let upright =
            |size| fitted(axis((0.0, 1.0), 660.0).with_y_tick_step(0.1).with_tick_size(size)).y_tick_step;
        assert_eq!([8, 20].map(upright), [Some(0.1), Some(0.2)]);
    }

    #[test]
    fn margins_are_wider_where_labels_are_long() {
        let upright = |ends: (f64, f64)| {
            let layout =
                super::super::style::layout((0.0, 1.0), ends).with_y_label("Velocity").with_height(200.0);
            needed_on_the_left(&layout.with_width(660.0).with_force_margins(82.0, 16.0))
        };
        assert_eq!(upright((0.0, 1.0)), None);
        assert!(upright((0.0, 8e-13)).is_some_and(|margin| margin > 90.0));
        let level = |end: f64| needed_on_the_right(&axis((0.0, end), 660.0).with_force_margins(82.0, 16.0));
        assert_eq!(level(1.0), None);
        // The last label is centred at the end of the axis.
        let half = 0.5 * letters::width("2.5 × 10⁻¹⁰", 13.0);
        assert!(level(2.5e-10).is_some_and(|margin| (margin - half).abs() < 1e-6));
    }

    #[test]
    fn the_label_of_an_axis_is_beside_all_labels_of_ticks() {
        let single = |ends: (f64, f64)| {
            let layout = super::super::style::layout((0.0, 1.0), ends).with_y_label("Force");
            let layout = fitted(layout.with_width(660.0).with_height(480.0));
            let drawn = ComputedLayout::from_layout(&layout);
            let room = drawn.margin_left - drawn.tick_label_margin - Side::Left.widest(&layout);
            (room, layout.y_label_offset.0)
        };
        let (usual, long) = (single((0.0, 1.0)), single((5.1999998e-10, 5.2000002e-10)));
        assert_eq!(usual.1, 0.0);
        assert!(long.0 > usual.0 - 8.0, "{long:?} {usual:?}");
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
