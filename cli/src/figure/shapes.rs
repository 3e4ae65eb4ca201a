//! A picture as areas of one colour each, in dots.

use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene};
use tiny_skia::{
    Paint, Path, PathBuilder, PixmapMut, PixmapPaint, PixmapRef, Rect, Stroke, StrokeDash, Transform,
};

use super::clip::runs;
use super::coverage::Coverage;
use super::letters::{Letters, Text};
use super::raster::CellImage;
use super::room::translation;
use super::{curve::Point, grey};

/// What is drawn at once.
pub enum Shape {
    /// An area with its colour, the last part of which is the opacity.
    Area(Path, [u8; 4]),
    /// A rectangle with its sides along the axes: most of the lines of a picture.
    Bar(Rect, [u8; 4]),
    /// A text with its colour: red, green, blue.
    Letters(Coverage, [u8; 3]),
    /// Cells: red, green, blue and opacity, their number across and down, and where they are.
    Image(Vec<u8>, [u32; 2], Transform),
}

impl Shape {
    /// Draws the shape on dots whose first row is this one of the picture.
    pub fn draw(&self, dots: &mut PixmapMut, first: u32) {
        let up = Transform::from_translate(0.0, -(first as f32));
        match self {
            Self::Area(path, colour) if is_on(dots, first, path.bounds()) => {
                dots.fill_path(path, &paint(*colour), tiny_skia::FillRule::Winding, up, None);
            }
            Self::Bar(bar, colour) if is_on(dots, first, *bar) => {
                if let Some(bar) = bar.transform(up) {
                    dots.fill_rect(bar, &paint(*colour), Transform::identity(), None);
                }
            }
            Self::Letters(letters, colour) => letters.draw(dots, first, *colour),
            Self::Image(cells, [columns, rows], place) => {
                let Some(image) = PixmapRef::from_bytes(cells, *columns, *rows) else { return };
                dots.draw_pixmap(0, 0, image, &PixmapPaint::default(), place.post_concat(up), None);
            }
            Self::Area(..) | Self::Bar(..) => {}
        }
    }
}

/// Whether a part of a shape with these bounds is on dots whose first row is this one of the picture.
fn is_on(dots: &PixmapMut, first: u32, bounds: Rect) -> bool {
    bounds.bottom() >= first as f32 && bounds.top() <= (first + dots.height()) as f32
}

fn paint([red, green, blue, opacity]: [u8; 4]) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(red, green, blue, opacity);
    paint
}

/// The shapes of a picture in the order in which they are drawn, without the background, which is white. `scale` is the number of
/// dots per unit of the canvas, and `title` is not typeset.
pub fn shapes(scene: &Scene, title: &str, grey: bool, scale: f64) -> Vec<Shape> {
    let shapes = Vec::with_capacity(scene.elements.len());
    let mut drawn = Drawn { shapes, title, grey, scale, moved: Vec::new(), letters: Letters::default() };
    scene.elements.iter().for_each(|element| drawn.add(element));
    drawn.shapes
}

struct Drawn<'a> {
    shapes: Vec<Shape>,
    title: &'a str,
    grey: bool,
    scale: f64,
    /// By how much the groups around an element are moved.
    moved: Vec<Point>,
    letters: Letters,
}

impl Drawn<'_> {
    fn add(&mut self, element: &Primitive) {
        match element {
            Primitive::GroupStart { transform, .. } => {
                self.moved.push(transform.as_deref().and_then(translation).unwrap_or_default());
            }
            Primitive::GroupEnd => drop(self.moved.pop()),
            Primitive::Line { x1, y1, x2, y2, stroke, stroke_width, stroke_dasharray: None }
                if (x1 == x2) != (y1 == y2) =>
            {
                let half = 0.5 * stroke_width;
                let (wide, high) = if x1 == x2 { (half, 0.0) } else { (0.0, half) };
                let sides = [x1.min(*x2) - wide, y1.min(*y2) - high, x1.max(*x2) + wide, y1.max(*y2) + high];
                let [left, top, right, bottom] = sides.map(|side| side as f32);
                self.bar(Rect::from_ltrb(left, top, right, bottom), stroke, None);
            }
            Primitive::Line { x1, y1, x2, y2, stroke, stroke_width, stroke_dasharray } => {
                let path = line(&[(*x1, *y1), (*x2, *y2)], false);
                self.stroke(path, stroke, *stroke_width, stroke_dasharray.as_deref());
            }
            Primitive::PolyLine { points, stroke, stroke_width, stroke_dasharray } => {
                self.stroke(line(points, false), stroke, *stroke_width, stroke_dasharray.as_deref());
            }
            Primitive::Path(path) => self.path(path),
            Primitive::Rect { x, y, width, height, fill, stroke, stroke_width, opacity } => {
                let sides = [x, y, width, height].map(|side| *side as f32);
                let bar = Rect::from_xywh(sides[0], sides[1], sides[2], sides[3]);
                self.bar(bar, fill, *opacity);
                if let Some(stroke) = stroke {
                    self.stroke(bar.map(PathBuilder::from_rect), stroke, stroke_width.unwrap_or(1.0), None);
                }
            }
            Primitive::Circle { cx, cy, r, fill, fill_opacity, stroke, stroke_width } => {
                self.circle((*cx, *cy), *r, (fill, *fill_opacity), (stroke.as_ref(), *stroke_width));
            }
            Primitive::CircleBatch { cx, cy, r, fill, fill_opacity, stroke, stroke_width } => {
                let colours = ((fill, *fill_opacity), (stroke.as_ref(), *stroke_width));
                cx.iter().zip(cy).for_each(|(x, y)| self.circle((*x, *y), *r, colours.0, colours.1));
            }
            Primitive::RectBatch { x, y, w, h, fills } if !x.is_empty() => {
                self.image(&CellImage::new([x, y, w, h], fills, self.grey));
            }
            Primitive::Text { x, y, content, size, anchor, rotate, bold, color } => {
                let is_typeset = content != self.title;
                let text =
                    Text { content, size: f64::from(*size), anchor: *anchor, is_bold: *bold, is_typeset };
                let turned = Transform::from_rotate(rotate.unwrap_or(0.0) as f32);
                let place = turned.post_translate(*x as f32, *y as f32);
                let place = place.post_concat(self.place());
                let outline = self.letters.outline(&text).and_then(|outline| outline.transform(place));
                let covered = outline.as_ref().map(Coverage::of);
                let colour = grey::rgb(color.as_ref().unwrap_or(&Color::Rgb(0, 0, 0)), self.grey);
                self.shapes
                    .extend(covered.zip(colour).map(|(letters, colour)| Shape::Letters(letters, colour)));
            }
            // Rich texts are in no picture, and clip paths are cut.
            _ => {}
        }
    }

    fn path(&mut self, path: &PathData) {
        let mut lines = PathBuilder::new();
        for run in runs(&path.d) {
            line(&run.points, run.is_closed).iter().for_each(|run| lines.push_path(run));
        }
        let lines = lines.finish();
        if let Some(fill) = &path.fill {
            self.fill(lines.clone(), fill, path.opacity);
        }
        self.stroke(lines, &path.stroke, path.stroke_width, path.stroke_dasharray.as_deref());
    }

    /// A filled rectangle.
    fn bar(&mut self, bar: Option<Rect>, colour: &Color, opacity: Option<f64>) {
        let Some([red, green, blue]) = grey::rgb(colour, self.grey) else { return };
        let opacity = (255.0 * opacity.unwrap_or(1.0)).round() as u8;
        if let Some(bar) = bar.and_then(|bar| bar.transform(self.place())) {
            self.shapes.push(Shape::Bar(bar, [red, green, blue, opacity]));
        }
    }

    fn circle(
        &mut self,
        (x, y): Point,
        radius: f64,
        fill: (&Color, Option<f64>),
        stroke: (Option<&Color>, Option<f64>),
    ) {
        self.area(PathBuilder::from_circle(x as f32, y as f32, radius as f32), fill, stroke);
    }

    /// An area and its edge.
    fn area(
        &mut self,
        path: Option<Path>,
        (fill, opacity): (&Color, Option<f64>),
        (stroke, width): (Option<&Color>, Option<f64>),
    ) {
        self.fill(path.clone(), fill, opacity);
        if let Some(stroke) = stroke {
            self.stroke(path, stroke, width.unwrap_or(1.0), None);
        }
    }

    fn stroke(&mut self, path: Option<Path>, colour: &Color, width: f64, dashes: Option<&str>) {
        if matches!(colour, Color::None) || width <= 0.0 {
            return;
        }
        let dash = dashes.and_then(|dashes| {
            let lengths = dashes.split([' ', ',']).filter_map(|length| length.parse().ok());
            StrokeDash::new(lengths.collect(), 0.0)
        });
        let stroke = Stroke { width: width as f32, ..Stroke::default() };
        let outline = path.and_then(|path| {
            let dashed = dash.and_then(|dash| path.dash(&dash, self.scale as f32));
            dashed.as_ref().unwrap_or(&path).stroke(&stroke, self.scale as f32)
        });
        self.fill(outline, colour, None);
    }

    fn fill(&mut self, path: Option<Path>, colour: &Color, opacity: Option<f64>) {
        let Some([red, green, blue]) = grey::rgb(colour, self.grey) else { return };
        let opacity = (255.0 * opacity.unwrap_or(1.0)).round() as u8;
        if let Some(path) = path.and_then(|path| path.transform(self.place())) {
            self.shapes.push(Shape::Area(path, [red, green, blue, opacity]));
        }
    }

    fn image(&mut self, image: &CellImage) {
        let cells = image.dots.chunks_exact(3).flat_map(|dot| [dot[0], dot[1], dot[2], 255]).collect();
        let [x, y] = image.start.map(|start| start as f32);
        let [width, height] = image.cell.map(|side| side as f32);
        let place = Transform::from_row(width, 0.0, 0.0, height, x, y).post_concat(self.place());
        self.shapes.push(Shape::Image(cells, image.cells.map(|count| count as u32), place));
    }

    /// From units of the canvas to dots.
    fn place(&self) -> Transform {
        let (across, down) = self.moved.iter().fold((0.0, 0.0), |sum, by| (sum.0 + by.0, sum.1 + by.1));
        Transform::from_translate(across as f32, down as f32).post_scale(self.scale as f32, self.scale as f32)
    }
}

/// A line through points.
fn line(points: &[Point], is_closed: bool) -> Option<Path> {
    let mut path = PathBuilder::new();
    for (i, &(x, y)) in points.iter().enumerate() {
        let step = if i == 0 { PathBuilder::move_to } else { PathBuilder::line_to };
        step(&mut path, x as f32, y as f32);
    }
    if is_closed {
        path.close();
    }
    path.finish()
}
