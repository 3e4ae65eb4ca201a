//! Where a panel has room for a legend.

use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene};

use super::clip::{Frame, runs};
use super::curve::Point;

/// Distance of a legend from the frame, and from what is drawn, in units of the canvas: more than the length of a tick and more
/// than half a marker.
const INSET: f64 = 12.0;
const AWAY: f64 = 8.0;

/// A panel of a picture.
pub struct Panel {
    /// The number of elements up to the end of what is plotted in it.
    pub end: usize,
    frame: Frame,
    /// By how much the groups around the panel are moved.
    moved: Point,
    /// The lines and the outlines of areas in it.
    lines: Vec<Vec<Point>>,
    areas: Vec<Vec<Point>>,
}

/// The panels of a picture in their order.
pub fn panels(scene: &Scene) -> Vec<Panel> {
    let (mut found, mut moved, mut open): (Vec<Panel>, Vec<Point>, Option<Panel>) = Default::default();
    for (i, element) in scene.elements.iter().enumerate() {
        match element {
            Primitive::GroupStart { transform, .. } => {
                moved.push(transform.as_deref().and_then(translation).unwrap_or_default());
            }
            Primitive::GroupEnd => drop(moved.pop()),
            Primitive::ClipStart { x, y, width, height, .. } => {
                let frame = Frame { across: (*x, x + width), along: (*y, y + height) };
                let moved = moved.iter().fold((0.0, 0.0), |sum, by| (sum.0 + by.0, sum.1 + by.1));
                open = Some(Panel { end: 0, frame, moved, lines: Vec::new(), areas: Vec::new() });
            }
            Primitive::ClipEnd => {
                found.extend(open.take().map(|panel| Panel { end: i + 1, ..panel }));
            }
            element => open.iter_mut().for_each(|panel| panel.add(element)),
        }
    }
    found
}

/// By how much a group with this attribute is moved.
pub fn translation(transform: &str) -> Option<Point> {
    let (across, down) = transform.strip_prefix("translate(")?.strip_suffix(')')?.split_once([',', ' '])?;
    Some((across.trim().parse().ok()?, down.trim().parse().ok()?))
}

impl Panel {
    /// Its left upper corner on the canvas.
    pub fn on_canvas(&self) -> Point {
        (self.moved.0 + self.frame.across.0, self.moved.1 + self.frame.along.0)
    }

    /// The left upper corner of a box of this size that covers nothing, if there is room for one.
    pub fn room(&self, [width, height]: [f64; 2]) -> Option<Point> {
        let (left, right) = (self.frame.across.0 + INSET, self.frame.across.1 - INSET - width);
        let (top, bottom) = (self.frame.along.0 + INSET, self.frame.along.1 - INSET - height);
        if right < left || bottom < top {
            return None;
        }
        let middle = 0.5 * (left + right);
        let places =
            [(right, top), (left, top), (right, bottom), (left, bottom), (middle, top), (middle, bottom)];
        places.into_iter().find(|&(x, y)| {
            let across = (x - AWAY, x + width + AWAY);
            self.is_empty(&Frame { across, along: (y - AWAY, y + height + AWAY) })
        })
    }

    fn is_empty(&self, place: &Frame) -> bool {
        let crosses = |line: &Vec<Point>| match line[..] {
            [point] => place.has(point),
            _ => line.windows(2).any(|pair| place.segment(pair[0], pair[1]).is_some()),
        };
        !self.lines.iter().any(crosses) && self.areas.iter().all(|area| place.area(area).is_empty())
    }

    fn add(&mut self, element: &Primitive) {
        let circle = |x: f64, y: f64, r: f64| rectangle([x - r, y - r, 2.0 * r, 2.0 * r]);
        match element {
            Primitive::PolyLine { points, .. } => self.lines.push(points.clone()),
            Primitive::Line { x1, y1, x2, y2, .. } => self.lines.push(vec![(*x1, *y1), (*x2, *y2)]),
            Primitive::Path(path) => {
                let is_filled = !matches!(path.fill, None | Some(Color::None));
                let outlines = runs(&path.d).into_iter();
                match is_filled {
                    true => self.areas.extend(outlines.map(|run| run.points)),
                    false => self.lines.extend(outlines.map(|run| run.closed())),
                }
            }
            Primitive::Circle { cx, cy, r, .. } => self.areas.push(circle(*cx, *cy, *r)),
            Primitive::CircleBatch { cx, cy, r, .. } => {
                self.areas.extend(cx.iter().zip(cy).map(|(x, y)| circle(*x, *y, *r)));
            }
            Primitive::Rect { x, y, width, height, .. } => {
                self.areas.push(rectangle([*x, *y, *width, *height]));
            }
            // The cells of a map fill its frame.
            Primitive::RectBatch { x, .. } if !x.is_empty() => {
                let (left, top) = (self.frame.across.0, self.frame.along.0);
                let (width, height) = (self.frame.across.1 - left, self.frame.along.1 - top);
                self.areas.push(rectangle([left, top, width, height]));
            }
            Primitive::Text { x, y, .. } => self.lines.push(vec![(*x, *y)]),
            _ => {}
        }
    }
}

/// The outline of a rectangle: left, top, width, height.
fn rectangle([x, y, width, height]: [f64; 4]) -> Vec<Point> {
    vec![(x, y), (x + width, y), (x + width, y + height), (x, y + height)]
}
