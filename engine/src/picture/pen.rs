//! A picture with axes and curves, and what is drawn over them.

use std::borrow::Cow;

use super::axis::{Axis, Span};
use super::field::Field;
use super::legend::{self, Form, Key};
use super::panel::{Column, Handle, Panel};
use super::svg::{At, LETTER, Stroke, Svg};

/// From the edges to the plot, above, to the right and below.
const TOP: f64 = 12.0;
const RIGHT: f64 = 24.0;
const BOTTOM: f64 = 52.0;
/// Right of a field, with the scale of its colours.
const SCALE: f64 = 66.0;

/// Values, and where the answer has them.
#[derive(Debug, Clone)]
pub struct Series<'a> {
    /// The values.
    pub values: Cow<'a, [f64]>,
    /// As in [`Column::of`].
    pub of: String,
}

impl<'a> Series<'a> {
    /// Values of the answer.
    pub fn of(of: &str, values: &'a [f64]) -> Self {
        Self { values: Cow::Borrowed(values), of: of.to_owned() }
    }

    /// Values that only the picture has.
    pub fn own(values: Vec<f64>) -> Self {
        Self { values: Cow::Owned(values), of: String::new() }
    }

    /// A column of them.
    pub fn column(&self, name: String) -> Column {
        let values = if self.of.is_empty() { self.values.to_vec() } else { vec![] };
        Column { name, of: self.of.clone(), values, times: 1, rows: self.values.len() }
    }
}

/// A curve: NaN interrupts it.
#[derive(Debug, Clone)]
pub struct Curve<'a> {
    /// Its entry in the legend.
    pub key: Key,
    /// Its places.
    pub x: Series<'a>,
    /// Its values.
    pub y: Series<'a>,
}

/// What a picture is of.
#[derive(Debug)]
pub struct Frame<'a> {
    /// The name of its place in the page.
    pub id: &'static str,
    /// Width and height in pixels, without the legend.
    pub size: [f64; 2],
    /// Words at the axes, as in a picture.
    pub words: [String; 2],
    /// The same in a table.
    pub names: [String; 2],
    /// Which axes are logarithmic.
    pub logarithmic: [bool; 2],
    /// The curves.
    pub curves: Vec<Curve<'a>>,
    /// What is drawn in colours over both axes.
    pub field: Option<Field<'a>>,
}

/// Draws over the curves of a frame.
#[derive(Debug)]
pub struct Pen<'a> {
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    svg: Svg,
    frame: Frame<'a>,
    plot: [f64; 4],
}

impl<'a> Pen<'a> {
    /// Draws the axes and the curves of a frame.
    pub fn new(frame: Frame<'a>) -> Self {
        let span = if frame.field.is_some() { Span::Exact } else { Span::Wider };
        let x = axis(&frame, |curve| &curve.x.values, Span::Exact, 0);
        let y = axis(&frame, |curve| &curve.y.values, span, 1);
        let [width, height] = frame.size;
        let bottom = height - BOTTOM;
        let rows = y.ticks(((bottom - TOP) / 28.0) as usize);
        let longest = rows.iter().map(|&value| y.label(value).len()).max().unwrap_or(0);
        let left = (34.0 + LETTER * longest as f64).max(66.0);
        let right = width - if frame.field.is_some() { SCALE } else { RIGHT };
        let plot = [left, TOP, (right - left).max(10.0), bottom - TOP];
        let mut pen = Self { x, y, svg: Svg::default(), frame, plot };
        pen.draw_axes(&rows);
        if let Some(field) = pen.frame.field.take() {
            field.draw(&mut pen.svg, plot);
        }
        pen.svg.clipped(pen.frame.id, plot);
        pen.draw_curves(|form| matches!(form, Form::Line(_)));
        pen
    }

    fn draw_axes(&mut self, rows: &[f64]) {
        let [left, top, width, height] = self.plot;
        let [right, bottom] = [left + width, top + height];
        let faint = Stroke::line("faint", "0.5", "");
        let columns = self.x.ticks((width / 44.0) as usize);
        for &x in columns.iter().chain(&self.x.lines()) {
            let at = self.left(x);
            self.svg.straight([at, top], [at, bottom], faint);
        }
        for &y in rows.iter().chain(&self.y.lines()) {
            let at = self.top(y);
            self.svg.straight([left, at], [right, at], faint);
        }
        for x in columns {
            let at = At { anchor: "middle", ..At::start(self.left(x), bottom + 16.0) };
            self.svg.text(at, &self.x.label(x));
        }
        for &y in rows {
            let at = At { anchor: "end", ..At::start(left - 6.0, self.top(y) + 4.0) };
            self.svg.text(at, &self.y.label(y));
        }
        let middle = left + 0.5 * width;
        let room = 2.0 * middle.min(self.frame.size[0] - middle);
        let at = At { x: middle, y: bottom + 40.0, anchor: "middle", upward: false, room };
        self.svg.text(at, &self.frame.words[0]);
        let middle = top + 0.5 * height;
        let at = At { x: 12.0, y: middle, anchor: "middle", upward: true, room: 2.0 * middle };
        self.svg.text(at, &self.frame.words[1]);
    }

    fn draw_curves(&mut self, which: fn(Form) -> bool) {
        for curve in std::mem::take(&mut self.frame.curves) {
            let Key { color, form, .. } = curve.key;
            if which(form) {
                let points = &mut points(&curve.x.values, &curve.y.values);
                match form {
                    Form::Line(dash) => self.line(points, Stroke::line(color, "1.75", dash)),
                    _ => self.dots(points, color, 4.0, form == Form::Rings),
                }
            }
            self.frame.curves.push(curve);
        }
    }

    fn left(&self, x: f64) -> f64 {
        self.plot[0] + self.plot[2] * self.x.share(x)
    }

    fn top(&self, y: f64) -> f64 {
        self.plot[1] + self.plot[3] * (1.0 - self.y.share(y))
    }

    /// A path through points; those without a place interrupt it.
    fn through(&mut self, points: &mut dyn Iterator<Item = [f64; 2]>) {
        self.svg.begin();
        let mut step = "M";
        for [x, y] in points {
            let (left, top) = (self.left(x), self.top(y));
            let there = left.is_finite() && top.is_finite();
            if there {
                self.svg.step(step, left, top);
            }
            step = if there { "L" } else { "M" };
        }
    }

    /// A line through points.
    pub fn line(&mut self, points: &mut dyn Iterator<Item = [f64; 2]>, stroke: Stroke) {
        self.through(points);
        self.svg.end(stroke);
    }

    /// The area within points.
    pub fn area(&mut self, points: &mut dyn Iterator<Item = [f64; 2]>, fill: &'static str) {
        self.through(points);
        self.svg.raw("Z");
        self.svg.end(Stroke::area(fill));
    }

    /// Dots at points.
    pub fn dots(
        &mut self,
        points: &mut dyn Iterator<Item = [f64; 2]>,
        color: &'static str,
        radius: f64,
        hollow: bool,
    ) {
        self.svg.begin();
        for [x, y] in points {
            let (left, top) = (self.left(x), self.top(y));
            if left.is_finite() && top.is_finite() {
                self.svg.circle(left, top, radius);
            }
        }
        let fill = if hollow { "paper" } else { color };
        self.svg.end(Stroke { fill, ..Stroke::line(color, "1.5", "") });
    }

    /// Point masses: as high as their weights.
    pub fn stems(&mut self, at: &[f64], weights: &[f64], color: &'static str) {
        for (&x, &weight) in at.iter().zip(weights) {
            let top = [x, self.stem(weight)];
            self.line(&mut [[x, 0.0], top].into_iter(), Stroke::line(color, "2.5", ""));
            self.dots(&mut [top].into_iter(), color, 3.0, false);
        }
    }

    /// How high a point mass is drawn.
    pub fn stem(&self, weight: f64) -> f64 {
        0.9 * weight * self.y.max
    }

    /// Words at a place.
    pub fn text(&mut self, x: f64, y: f64, words: &str) {
        let at = At::start(self.left(x), self.top(y));
        self.svg.text(at, words);
    }

    /// A path that the page fills with dots, in the values of the axes.
    pub fn readings(&mut self) {
        let [left, top, width, height] = self.plot;
        let [across, up] = [width / (self.x.max - self.x.min), height / (self.y.max - self.y.min)];
        let [right, down] = [left - across * self.x.min, top + height + up * self.y.min];
        let place = format!("matrix({across} 0 0 {} {right} {down})", -up);
        self.svg.raw(
            "<path class=\"readings\" d=\"\" vector-effect=\"non-scaling-stroke\" stroke-linecap=\"round\"",
        );
        self.svg.raw(" stroke=\"var(--ink)\" stroke-width=\"3\" transform=\"");
        self.svg.raw(&place);
        self.svg.raw("\"/>");
    }

    /// What can be dragged at a place: at the edge where it is beyond it, from which it is dragged back.
    pub fn handle(&self, x: f64, y: f64, change: String, remove: String) -> Handle {
        let at = [self.left(self.x.within(x)), self.top(self.y.within(y))];
        Handle { at, change, remove }
    }

    /// The picture with its legend, to which `keys` are added, and with handles. The numbers are those of the curves.
    pub fn panel(mut self, title: &str, keys: &[Key], handles: Vec<Handle>) -> Panel {
        self.svg.raw("</g>\n");
        self.draw_curves(|form| !matches!(form, Form::Line(_)));
        let [width, height] = self.frame.size;
        let all: Vec<Key> = self.frame.curves.iter().map(|curve| &curve.key).chain(keys).cloned().collect();
        let legend = legend::draw(&mut self.svg, &all, width, height);
        self.draw_handles(&handles);
        Panel {
            id: self.frame.id,
            title: title.to_owned(),
            columns: self.columns(),
            svg: self.svg.0,
            size: [width, height + legend + 4.0],
            plot: self.plot,
            x: self.x,
            y: self.y,
            handles,
            scrub: false,
            add: String::new(),
        }
    }

    fn draw_handles(&mut self, handles: &[Handle]) {
        self.svg.raw("<g class=\"handles\">");
        self.svg.begin();
        for handle in handles {
            self.svg.circle(handle.at[0], handle.at[1], 5.0);
        }
        self.svg.end(Stroke { fill: "paper", ..Stroke::line("orange", "1.5", "") });
        self.svg.raw("</g>");
    }

    /// The numbers of the curves: those of the same places side by side, others one below the other.
    fn columns(&self) -> Vec<Column> {
        let curves = &self.frame.curves;
        let Some(first) = curves.first() else { return vec![] };
        let [across, up] = &self.frame.names;
        let name = |curve: &Curve<'_>| super::plain(&curve.key.label) + up;
        let mut columns = vec![first.x.column(across.clone())];
        if curves.iter().all(|curve| curve.x.values == first.x.values) {
            columns.extend(curves.iter().map(|curve| curve.y.column(name(curve))));
            return columns;
        }
        let joined = |own: usize| {
            let all = curves.iter().enumerate().flat_map(|(i, curve)| {
                curve.y.values.iter().map(move |&y| if i == own { y } else { f64::NAN })
            });
            Series::own(all.collect())
        };
        let places = curves.iter().flat_map(|curve| curve.x.values.iter().copied()).collect();
        columns[0] = Series::own(places).column(across.clone());
        columns.extend(curves.iter().enumerate().map(|(i, curve)| joined(i).column(name(curve))));
        columns
    }
}

fn axis<'a>(frame: &'a Frame<'a>, of: fn(&'a Curve<'a>) -> &'a [f64], span: Span, number: usize) -> Axis {
    match &frame.field {
        Some(field) => Axis { min: field.ends[number][0], max: field.ends[number][1], logarithmic: false },
        None => {
            let mut values = frame.curves.iter().flat_map(|curve| of(curve).iter().copied());
            Axis::of(&mut values, span, frame.logarithmic[number])
        }
    }
}

fn points<'a>(x: &'a [f64], y: &'a [f64]) -> impl Iterator<Item = [f64; 2]> + 'a {
    x.iter().zip(y).map(|(&x, &y)| [x, y])
}
