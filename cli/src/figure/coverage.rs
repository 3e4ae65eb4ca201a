//! Texts as the parts of dots that their letters cover. They take many small areas, for which the general way to draw areas spends
//! most of its time on each piece of a row.

use ab_glyph_rasterizer::{Rasterizer, point};
use tiny_skia::{Path, PathSegment, PixmapMut, Point};

use super::png_file::DRAWN;

/// How much of each dot of a rectangle is covered.
pub struct Coverage {
    left: usize,
    top: usize,
    width: usize,
    /// From 0 to 255, row by row.
    covered: Vec<u8>,
}

impl Coverage {
    /// What an area covers; `None` beyond the left or upper edge of the picture, or for one without extent.
    pub fn of(area: &Path) -> Option<Self> {
        let bounds = area.bounds();
        if bounds.left() < 0.0 || bounds.top() < 0.0 {
            return None;
        }
        let [left, top] = [bounds.left(), bounds.top()].map(f32::floor);
        let [width, height] =
            [bounds.right() - left, bounds.bottom() - top].map(|side| side.ceil() as usize + 1);
        let mut drawn = Rasterizer::new(width, height);
        outline(area, (left, top), &mut drawn);
        let mut covered = vec![0; width * height];
        drawn.for_each_pixel(|dot, part| covered[dot] = (255.0 * part.min(1.0) + 0.5) as u8);
        Some(Self { left: left as usize, top: top as usize, width, covered })
    }

    /// Draws the area on opaque dots whose first row is this one of the picture.
    pub fn draw(&self, dots: &mut PixmapMut, first: u32, colour: [u8; 3]) {
        let (wide, high) = (dots.width() as usize, dots.height() as usize);
        let end = self.width.min(wide.saturating_sub(self.left));
        for (row, covered) in (self.top..).zip(self.covered.chunks_exact(self.width)) {
            let Some(row) = row.checked_sub(first as usize).filter(|row| *row < high) else { continue };
            let start = DRAWN * (row * wide + self.left);
            let drawn = dots.data_mut()[start..].chunks_exact_mut(DRAWN);
            let covered = drawn.zip(&covered[..end]).filter(|(_, part)| **part > 0);
            covered.for_each(|(dot, &part)| mix(dot, colour, part));
        }
    }
}

/// Mixes a part of a colour into a dot.
fn mix(dot: &mut [u8], colour: [u8; 3], part: u8) {
    let part = u32::from(part);
    for (below, above) in dot.iter_mut().zip(colour) {
        *below = ((u32::from(*below) * (255 - part) + u32::from(above) * part + 127) / 255) as u8;
    }
}

/// Draws the outline of an area from its left and upper end.
fn outline(area: &Path, (left, top): (f32, f32), drawn: &mut Rasterizer) {
    let place = |at: Point| point(at.x - left, at.y - top);
    let (mut start, mut at) = (Point::zero(), Point::zero());
    for segment in area.segments() {
        let end = match segment {
            PathSegment::MoveTo(end) => {
                drawn.draw_line(place(at), place(start));
                start = end;
                end
            }
            PathSegment::LineTo(end) => {
                drawn.draw_line(place(at), place(end));
                end
            }
            PathSegment::QuadTo(turn, end) => {
                drawn.draw_quad(place(at), place(turn), place(end));
                end
            }
            PathSegment::CubicTo(first, second, end) => {
                drawn.draw_cubic(place(at), place(first), place(second), place(end));
                end
            }
            PathSegment::Close => {
                drawn.draw_line(place(at), place(start));
                start
            }
        };
        at = end;
    }
    drawn.draw_line(place(at), place(start));
}
