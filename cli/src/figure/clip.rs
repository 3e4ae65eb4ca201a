//! What is plotted, cut at the frames of the panels, so that a picture needs no clip paths: programs that draw it take several
//! times as long with them, and editors of vector graphics show them as groups that cannot be taken apart.
//!
//! Lines are cut by the method of Y.-D. Liang and B. A. Barsky, ACM Trans. Graphics 3, 1 (1984), areas by that of
//! I. E. Sutherland and G. W. Hodgman, Commun. ACM 17, 32 (1974). Markers are drawn whole, if their centres are in the frame.

use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene};

use super::curve::Point;
use super::simplify::simplified;

/// Largest distance of a point beyond a frame that is rounding.
const NEAR: f64 = 0.02;
/// Most points of the outline of a marker.
const MARKER: usize = 8;
/// Largest extent of a marker.
const SIZE: f64 = 20.0;

/// The picture without clip paths. What is plotted in a panel is a group with the attribute `data-frame`: left, top, width and
/// height of the frame.
pub fn cut(mut scene: Scene) -> Scene {
    scene.defs.retain(|definition| !definition.starts_with("<clipPath"));
    let (mut elements, mut frame) = (Vec::with_capacity(scene.elements.len()), None);
    for element in scene.elements {
        match element {
            Primitive::ClipStart { x, y, width, height, .. } => {
                frame = Some(Frame { across: (x, x + width), along: (y, y + height) });
                let attributes = [x, y, width, height].map(short).join(" ");
                let extra_attrs = Some(format!("data-frame=\"{attributes}\""));
                elements.push(Primitive::GroupStart { transform: None, title: None, extra_attrs });
            }
            Primitive::ClipEnd => {
                frame = None;
                elements.push(Primitive::GroupEnd);
            }
            element => match &frame {
                Some(frame) => frame.cut(element, &mut elements),
                None => elements.push(element),
            },
        }
    }
    scene.elements = elements;
    scene
}

/// A frame: its left and right, its upper and lower end.
pub struct Frame {
    pub across: (f64, f64),
    pub along: (f64, f64),
}

impl Frame {
    /// The parts of an element within the frame.
    fn cut(&self, element: Primitive, parts: &mut Vec<Primitive>) {
        match element {
            Primitive::PolyLine { points, stroke, stroke_width, stroke_dasharray } => {
                let piece = |points| {
                    let (stroke, stroke_dasharray) = (stroke.clone(), stroke_dasharray.clone());
                    Primitive::PolyLine { points, stroke, stroke_width, stroke_dasharray }
                };
                parts.extend(self.pieces(&points).iter().map(|points| piece(simplified(points))));
            }
            Primitive::Path(path) => parts.extend(self.path(*path)),
            Primitive::Line { x1, y1, x2, y2, .. } if !self.has((0.5 * (x1 + x2), 0.5 * (y1 + y2))) => {}
            Primitive::Circle { cx, cy, .. } if !self.has((cx, cy)) => {}
            Primitive::CircleBatch { cx, cy, r, fill, fill_opacity, stroke, stroke_width } => {
                let (cx, cy) = cx.into_iter().zip(cy).filter(|&centre| self.has(centre)).unzip();
                parts.push(Primitive::CircleBatch { cx, cy, r, fill, fill_opacity, stroke, stroke_width });
            }
            Primitive::Rect { x, y, width, height, fill, stroke, stroke_width, opacity } => {
                if let Some([x, y, width, height]) = self.rectangle([x, y, width, height]) {
                    parts.push(Primitive::Rect { x, y, width, height, fill, stroke, stroke_width, opacity });
                }
            }
            other => parts.push(other),
        }
    }

    /// Whether a point is in the frame.
    pub fn has(&self, (x, y): Point) -> bool {
        (self.across.0 - NEAR..=self.across.1 + NEAR).contains(&x)
            && (self.along.0 - NEAR..=self.along.1 + NEAR).contains(&y)
    }

    fn path(&self, path: PathData) -> Option<Primitive> {
        let runs = runs(&path.d);
        if runs.iter().all(|run| is_marker(&run.points)) {
            let inside = runs.iter().all(|run| self.has(centre(&run.points)));
            return inside.then(|| Primitive::Path(Box::new(path)));
        }
        let filled = !matches!(path.fill, None | Some(Color::None));
        let d: String = match filled {
            true => runs.iter().map(|run| written(&simplified(&self.area(&run.points)), true)).collect(),
            false => runs
                .iter()
                .flat_map(|run| self.pieces(&run.closed()))
                .map(|run| written(&simplified(&run), false))
                .collect(),
        };
        (!d.is_empty()).then(|| Primitive::Path(Box::new(PathData { d, ..path })))
    }

    /// The pieces of a line.
    fn pieces(&self, points: &[Point]) -> Vec<Vec<Point>> {
        if points.iter().all(|&point| self.has(point)) {
            return vec![points.to_vec()];
        }
        let mut pieces: Vec<Vec<Point>> = Vec::new();
        for pair in points.windows(2) {
            let Some((from, to)) = self.segment(pair[0], pair[1]) else { continue };
            match pieces.last_mut() {
                Some(piece) if piece.last() == Some(&from) => piece.push(to),
                _ => pieces.push(vec![from, to]),
            }
        }
        pieces
    }

    /// The part of a segment.
    pub fn segment(&self, from: Point, to: Point) -> Option<(Point, Point)> {
        let (right, down) = (to.0 - from.0, to.1 - from.1);
        let (mut start, mut end): (f64, f64) = (0.0, 1.0);
        for (direction, room) in [
            (-right, from.0 - self.across.0),
            (right, self.across.1 - from.0),
            (-down, from.1 - self.along.0),
            (down, self.along.1 - from.1),
        ] {
            if direction < 0.0 {
                start = start.max(room / direction);
            } else if direction > 0.0 {
                end = end.min(room / direction);
            } else if room < -NEAR {
                return None;
            }
        }
        let at = |part: f64| (from.0 + part * right, from.1 + part * down);
        let whole = |part: f64, point: Point| if part == 0.0 || part == 1.0 { point } else { at(part) };
        (start <= end).then(|| (whole(start, from), whole(end, to)))
    }

    /// The part of an area with this outline.
    pub fn area(&self, outline: &[Point]) -> Vec<Point> {
        let mut outline = outline.to_vec();
        let along = |a: f64, b: f64, edge: f64| (edge - a) / (b - a);
        for (edge, sign, upright) in [
            (self.across.0, 1.0, true),
            (self.across.1, -1.0, true),
            (self.along.0, 1.0, false),
            (self.along.1, -1.0, false),
        ] {
            let place = |point: Point| if upright { point.0 } else { point.1 };
            let inside = |point: Point| sign * (place(point) - edge) >= 0.0;
            let mut kept = Vec::with_capacity(outline.len() + 4);
            for i in 0..outline.len() {
                let (before, now) = (outline[(i + outline.len() - 1) % outline.len()], outline[i]);
                if inside(before) != inside(now) {
                    let part = along(place(before), place(now), edge);
                    kept.push((before.0 + part * (now.0 - before.0), before.1 + part * (now.1 - before.1)));
                }
                if inside(now) {
                    kept.push(now);
                }
            }
            outline = kept;
        }
        outline
    }

    /// The part of a rectangle: left, top, width, height.
    fn rectangle(&self, [x, y, width, height]: [f64; 4]) -> Option<[f64; 4]> {
        let (left, right) = (x.max(self.across.0), (x + width).min(self.across.1));
        let (top, bottom) = (y.max(self.along.0), (y + height).min(self.along.1));
        (left < right && top < bottom).then_some([left, top, right - left, bottom - top])
    }
}

/// A run of points of a path.
pub struct Run {
    pub points: Vec<Point>,
    pub is_closed: bool,
}

impl Run {
    /// The points, with the first at the end if the path returns there.
    pub fn closed(&self) -> Vec<Point> {
        let back = self.points.first().filter(|_| self.is_closed);
        self.points.iter().chain(back).copied().collect()
    }
}

/// The runs of points of a path of straight lines.
pub fn runs(d: &str) -> Vec<Run> {
    let read = |run: &str| {
        let numbers = run.split(|c: char| c.is_whitespace() || c == ',' || c.is_alphabetic());
        let numbers: Vec<f64> = numbers.filter_map(|number| number.parse().ok()).collect();
        let points = numbers.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
        Run { points, is_closed: run.contains('Z') }
    };
    d.split('M').map(read).filter(|run| !run.points.is_empty()).collect()
}

/// Whether points are the outline of a marker.
fn is_marker(points: &[Point]) -> bool {
    let extent = |of: fn(&Point) -> f64| {
        let values = points.iter().map(of);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    (3..=MARKER).contains(&points.len()) && extent(|point| point.0) < SIZE && extent(|point| point.1) < SIZE
}

fn centre(points: &[Point]) -> Point {
    let count = points.len() as f64;
    (
        points.iter().map(|point| point.0).sum::<f64>() / count,
        points.iter().map(|point| point.1).sum::<f64>() / count,
    )
}

/// A run of points as it is written in a path.
fn written(points: &[Point], closed: bool) -> String {
    let mut text = String::new();
    for (i, point) in points.iter().enumerate() {
        let step = if i == 0 { 'M' } else { 'L' };
        text += &format!("{step}{} {}", short(point.0), short(point.1));
    }
    if closed && !text.is_empty() { text + "Z" } else { text }
}

/// A coordinate to a hundredth of the unit of the canvas.
fn short(coordinate: f64) -> String {
    format!("{}", (100.0 * coordinate).round() / 100.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { across: (0.0, 10.0), along: (0.0, 5.0) };

    #[test]
    fn lines_end_at_the_frame() {
        let zigzag = [(-5.0, 2.0), (5.0, 2.0), (5.0, 7.0), (8.0, 4.0), (20.0, 4.0)];
        let expected = [vec![(0.0, 2.0), (5.0, 2.0), (5.0, 5.0)], vec![(7.0, 5.0), (8.0, 4.0), (10.0, 4.0)]];
        assert_eq!(FRAME.pieces(&zigzag), expected);
        assert_eq!(FRAME.pieces(&[(1.0, 6.0), (9.0, 6.0)]), [] as [Vec<Point>; 0]);
        // A line along an edge stays.
        assert_eq!(FRAME.pieces(&[(0.0, 5.0), (10.0, 5.0)]).len(), 1);
    }

    #[test]
    fn areas_end_at_the_frame() {
        let area = FRAME.area(&[(-2.0, 1.0), (4.0, 1.0), (4.0, 9.0), (-2.0, 9.0)]);
        assert_eq!(area.len(), 4);
        for corner in [(0.0, 1.0), (4.0, 1.0), (4.0, 5.0), (0.0, 5.0)] {
            assert!(area.contains(&corner), "{corner:?} {area:?}");
        }
        assert!(FRAME.area(&[(11.0, 1.0), (12.0, 1.0), (12.0, 2.0)]).is_empty());
    }

    #[test]
    fn markers_are_whole_or_not_there() {
        let triangle = |x: f64| PathData {
            d: format!("M {x},4 L {},6 L {},6 Z", x - 1.0, x + 1.0),
            fill: Some(Color::Rgb(0, 0, 0)),
            stroke: Color::None,
            stroke_width: 0.0,
            opacity: None,
            stroke_dasharray: None,
        };
        let d = |x| match FRAME.path(triangle(x)) {
            Some(Primitive::Path(path)) => path.d,
            _ => String::new(),
        };
        // Its centre is at a height of 5.33, beyond the frame, or at the corner.
        assert_eq!(d(3.0), "");
        let higher = Frame { along: (0.0, 5.4), ..FRAME };
        assert!(
            matches!(higher.path(triangle(0.0)), Some(Primitive::Path(path)) if path.d == triangle(0.0).d)
        );
    }
}
