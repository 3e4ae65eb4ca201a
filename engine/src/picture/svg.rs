//! The text of a picture, in pixels of the page.

use super::words::{escaped, plain, symbols};

/// The width of a letter.
pub const LETTER: f64 = 5.8;
/// The size of letters.
const SIZE: f64 = 11.0;

/// How a path is drawn. Colours are names of the style; an empty one draws nothing.
#[derive(Debug, Clone, Copy)]
pub struct Stroke {
    /// The colour of the line.
    pub color: &'static str,
    /// The colour inside.
    pub fill: &'static str,
    /// The width of the line.
    pub width: &'static str,
    /// The dashes, empty for a whole line.
    pub dash: &'static str,
}

impl Stroke {
    /// A line of a curve.
    pub const fn line(color: &'static str, width: &'static str, dash: &'static str) -> Self {
        Self { color, fill: "", width, dash }
    }

    /// An area without an edge.
    pub const fn area(fill: &'static str) -> Self {
        Self { color: "", fill, width: "0", dash: "" }
    }
}

/// Where words stand.
#[derive(Debug, Clone, Copy)]
pub struct At {
    /// From the left.
    pub x: f64,
    /// From the top.
    pub y: f64,
    /// The part of the words that is at this place: `start`, `middle` or `end`.
    pub anchor: &'static str,
    /// Whether they are read from below.
    pub upward: bool,
    /// Letters become smaller where the words do not fit into this length.
    pub room: f64,
}

impl At {
    /// Words that begin at a place.
    pub fn start(x: f64, y: f64) -> Self {
        Self { x, y, anchor: "start", upward: false, room: f64::INFINITY }
    }
}

/// The elements of a picture.
#[derive(Debug, Default)]
pub struct Svg(pub String);

impl Svg {
    /// Adds text as it is.
    pub fn raw(&mut self, text: &str) {
        self.0.push_str(text);
    }

    /// Adds a number with two digits after the point.
    pub fn number(&mut self, value: f64) {
        let hundredths = (100.0 * value).round() as i64;
        if hundredths < 0 {
            self.0.push('-');
        }
        // From the last digit on, with the point before two of them.
        let (mut left, mut digits, mut place) = (hundredths.unsigned_abs(), [b'0'; 24], 24);
        while left > 0 || place > 21 {
            place -= 1;
            digits[place] = b'0' + (left % 10) as u8;
            left /= 10;
            if place == 22 {
                place -= 1;
                digits[place] = b'.';
            }
        }
        if digits[place] == b'.' {
            place -= 1;
        }
        self.0.extend(digits[place..].iter().map(|&digit| digit as char));
    }

    /// Adds an attribute that is a number.
    pub fn attribute(&mut self, name: &str, value: f64) {
        self.raw(" ");
        self.raw(name);
        self.raw("=\"");
        self.number(value);
        self.raw("\"");
    }

    /// Adds a step of a path.
    pub fn step(&mut self, letter: &str, x: f64, y: f64) {
        self.raw(letter);
        self.number(x);
        self.raw(" ");
        self.number(y);
    }

    /// Begins a path, whose steps follow.
    pub fn begin(&mut self) {
        self.raw("<path d=\"");
    }

    /// Ends a path.
    pub fn end(&mut self, stroke: Stroke) {
        self.raw("\" fill=\"");
        self.color(stroke.fill);
        self.raw("\" stroke=\"");
        self.color(stroke.color);
        self.raw("\" stroke-width=\"");
        self.raw(stroke.width);
        if !stroke.dash.is_empty() {
            self.raw("\" stroke-dasharray=\"");
            self.raw(stroke.dash);
        }
        self.raw("\"/>\n");
    }

    /// A straight line.
    pub fn straight(&mut self, [x, y]: [f64; 2], [right, bottom]: [f64; 2], stroke: Stroke) {
        self.begin();
        self.step("M", x, y);
        self.step(" ", right, bottom);
        self.end(stroke);
    }

    /// Adds a circle to a path.
    pub fn circle(&mut self, x: f64, y: f64, radius: f64) {
        self.step("M", x - radius, y);
        for width in [2.0 * radius, -2.0 * radius] {
            self.step("a", radius, radius);
            self.step(" 0 1 0 ", width, 0.0);
        }
    }

    fn color(&mut self, name: &str) {
        if name.is_empty() {
            self.raw("none");
            return;
        }
        self.raw("var(--");
        self.raw(name);
        self.raw(")");
    }

    /// Words with marks of HTML, `<i>` and `<sub>`.
    pub fn text(&mut self, at: At, words: &str) {
        let size = SIZE.min(SIZE * at.room / (LETTER * plain(words).chars().count() as f64));
        self.raw("<text transform=\"translate(");
        self.step("", at.x, at.y);
        self.raw(if at.upward { ") rotate(-90)" } else { ") rotate(0)" });
        self.raw("\" text-anchor=\"");
        self.raw(at.anchor);
        self.raw("\" fill=\"var(--ink)\"");
        self.attribute("font-size", size);
        self.raw(">");
        self.raw(&symbols(words));
        self.raw("</text>\n");
    }

    /// A group, whose elements follow; `</g>` ends it.
    pub fn clipped(&mut self, id: &str, [left, top, width, height]: [f64; 4]) {
        let id = escaped(id);
        self.raw("<clipPath id=\"");
        self.raw(&id);
        self.raw("-plot\"><rect");
        for (name, value) in [("x", left), ("y", top), ("width", width), ("height", height)] {
            self.attribute(name, value);
        }
        self.raw("/></clipPath><g clip-path=\"url(#");
        self.raw(&id);
        self.raw("-plot)\">\n");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_two_digits() {
        for (value, text) in
            [(0.0, "0.00"), (-0.5, "-0.50"), (12.345, "12.35"), (0.07, "0.07"), (1e6, "1000000.00")]
        {
            let mut svg = Svg::default();
            svg.number(value);
            assert_eq!(svg.0, text);
        }
    }
}
