//! Texts as the parts of dots that their letters cover. They take many small areas, for which the general way to draw areas spends
//! most of its time on each piece of a row.

use ab_glyph_rasterizer::{Rasterizer, point};
use tiny_skia::{Path, PathSegment, PixmapMut, Point};

use super::png_file::DRAWN;

/// How much of each dot of a rectangle is covered.
pub struct Coverage {
    left: isize,
    top: isize,
    width: usize,
    /// From 0 to 255, row by row.
    covered: Vec<u8>,
}

impl Coverage {
    /// What an area covers, which may begin outside of the picture.
    pub fn of(area: &Path) -> Self {
        let bounds = area.bounds();
        let [left, top] = [bounds.left(), bounds.top()].map(f32::floor);
        let [width, height] =
            [bounds.right() - left, bounds.bottom() - top].map(|side| side.ceil() as usize + 1);
        let mut drawn = Rasterizer::new(width, height);
        outline(area, (left, top), &mut drawn);
        let mut covered = vec![0; width * height];
        drawn.for_each_pixel(|dot, part| covered[dot] = (255.0 * part.min(1.0) + 0.5) as u8);
        Self { left: left as isize, top: top as isize, width, covered }
    }

    /// Draws the area on opaque dots whose first row is this one of the picture.
    pub fn draw(&self, dots: &mut PixmapMut, first: u32, colour: [u8; 3]) {
        let (wide, high) = (dots.width() as usize, dots.height() as usize);
        // Columns of the rectangle that are in the picture.
        let inside = |column: isize| column.clamp(0, self.width as isize) as usize;
        let (start, end) = (inside(-self.left), inside(wide as isize - self.left));
        if start >= end {
            return;
        }
        let left = (self.left + start as isize) as usize;
        for (row, covered) in (self.top - first as isize..).zip(self.covered.chunks_exact(self.width)) {
            let Some(row) = usize::try_from(row).ok().filter(|row| *row < high) else { continue };
            let drawn = dots.data_mut()[DRAWN * (row * wide + left)..].chunks_exact_mut(DRAWN);
            let covered = drawn.zip(&covered[start..end]).filter(|(_, part)| **part > 0);
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

#[cfg(test)]
mod tests {
    use tiny_skia::{PathBuilder, Rect};

    use super::*;

    /// The dots that are black after an area from `left`, `top` on was drawn on 6 × 4 white ones, in bands of one row.
    fn black(left: f32, top: f32, width: f32, height: f32) -> Vec<[u32; 2]> {
        let covered =
            Coverage::of(&PathBuilder::from_rect(Rect::from_xywh(left, top, width, height).unwrap()));
        let row = |row: u32| {
            let mut dots = vec![255; DRAWN * 6];
            covered.draw(&mut PixmapMut::from_bytes(&mut dots, 6, 1).unwrap(), row, [0; 3]);
            let black = (0..6).filter(move |column| dots[DRAWN * *column as usize] == 0);
            black.map(move |column| [row, column]).collect::<Vec<_>>()
        };
        (0..4).flat_map(row).collect()
    }

    #[test]
    fn what_begins_outside_of_the_picture_is_clipped() {
        assert_eq!(black(1.0, 2.0, 2.0, 1.0), [[2, 1], [2, 2]]);
        assert_eq!(black(-2.0, 1.0, 4.0, 1.0), [[1, 0], [1, 1]]);
        assert_eq!(black(4.0, -1.0, 5.0, 2.0), [[0, 4], [0, 5]]);
        assert_eq!(black(-3.0, 3.0, 20.0, 8.0).len(), 6);
        for (left, top) in [(-9.0, 0.0), (9.0, 0.0), (0.0, -9.0), (0.0, 9.0)] {
            assert_eq!(black(left, top, 2.0, 2.0), [] as [[u32; 2]; 0]);
        }
    }
}
