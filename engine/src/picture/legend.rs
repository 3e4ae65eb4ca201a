//! The legend below a picture.

use super::svg::{At, LETTER, Stroke, Svg};
use super::words::plain;

/// What an entry of a legend looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// A line, with dashes unless they are empty.
    Line(&'static str),
    /// Dots.
    Dots,
    /// Hollow dots.
    Rings,
    /// A band along a curve.
    Band,
}

/// An entry of a legend.
#[derive(Debug, Clone)]
pub struct Key {
    /// Words with marks of HTML.
    pub label: String,
    /// A name of the style.
    pub color: &'static str,
    /// What it looks like.
    pub form: Form,
}

impl Key {
    /// An entry.
    pub fn new(label: &str, color: &'static str, form: Form) -> Self {
        Self { label: label.to_owned(), color, form }
    }
}

/// Height of a line of a legend.
const LINE: f64 = 16.0;
/// From the edge to the first entry.
const EDGE: f64 = 12.0;

/// Draws the legend below `height`; its own height, 0 for a single entry.
pub fn draw(svg: &mut Svg, keys: &[Key], width: f64, height: f64) -> f64 {
    if keys.len() < 2 {
        return 0.0;
    }
    let (mut x, mut y) = (EDGE, height + 8.0);
    for key in keys {
        let space = 40.0 + LETTER * plain(&key.label).chars().count() as f64;
        if x > EDGE && x + space > width {
            (x, y) = (EDGE, y + LINE);
        }
        symbol(svg, key, x, y);
        svg.text(At { room: width - x - 26.0, ..At::start(x + 26.0, y + 4.0) }, &key.label);
        x += space;
    }
    y + EDGE - height
}

fn symbol(svg: &mut Svg, key: &Key, x: f64, y: f64) {
    match key.form {
        Form::Line(dash) => {
            svg.straight([x, y], [x + 20.0, y], Stroke::line(key.color, "1.75", dash));
        }
        Form::Band => svg.straight([x, y], [x + 20.0, y], Stroke::line(key.color, "10", "")),
        Form::Dots | Form::Rings => {
            svg.begin();
            svg.circle(x + 10.0, y, 4.0);
            let fill = if key.form == Form::Dots { key.color } else { "paper" };
            svg.end(Stroke { fill, ..Stroke::line(key.color, "1.5", "") });
        }
    }
}
