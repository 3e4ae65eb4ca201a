//! Fields as images within a picture: one element instead of a rectangle for each cell, without gaps between cells.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene};

use super::{grey, png_file};

/// The picture with an image in the place of each field.
pub fn fields_as_images(scene: &Scene, grey: bool) -> Scene {
    let mut images = Scene::new(scene.width, scene.height);
    images.background_color.clone_from(&scene.background_color);
    images.text_color.clone_from(&scene.text_color);
    images.font_family.clone_from(&scene.font_family);
    images.defs.clone_from(&scene.defs);
    images.elements.reserve(scene.elements.len());
    for element in &scene.elements {
        match element {
            Primitive::RectBatch { x, y, w, h, fills } if !x.is_empty() => {
                let extra_attrs = CellImage::new([x, y, w, h], fills, grey).image();
                images.elements.push(Primitive::GroupStart { transform: None, title: None, extra_attrs });
                images.elements.push(Primitive::GroupEnd);
            }
            other => images.elements.push(other.clone()),
        }
    }
    images
}

/// Equal cells of a grid as dots.
pub struct CellImage {
    /// Left and upper end.
    pub start: [f64; 2],
    /// Width and height of a cell.
    pub cell: [f64; 2],
    /// Number of cells across and down.
    pub cells: [usize; 2],
    /// Red, green and blue of the cells, row by row from above.
    pub dots: Vec<u8>,
}

impl CellImage {
    /// The cells with these left and upper ends, widths, heights and colours.
    pub fn new([x, y, w, h]: [&[f64]; 4], fills: &[Color], grey: bool) -> Self {
        let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |of: &[f64]| of.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (left, top) = (least(x), least(y));
        let place = |at: f64, start: f64, step: f64| ((at - start) / step).round() as usize;
        let (columns, rows) = (place(most(x), left, w[0]) + 1, place(most(y), top, h[0]) + 1);
        let mut dots = vec![255; 3 * columns * rows];
        for (i, fill) in fills.iter().enumerate() {
            let at = 3 * (place(y[i], top, h[0]) * columns + place(x[i], left, w[0]));
            dots[at..at + 3].copy_from_slice(&grey::rgb(fill, grey).unwrap_or([255; 3]));
        }
        Self { start: [left, top], cell: [w[0], h[0]], cells: [columns, rows], dots }
    }

    /// The field as an image. The plot library has no element for it and writes the attributes of a group as they are: these end
    /// the tag of the group and begin the image.
    fn image(&self) -> Option<String> {
        let ([left, top], [width, height], [columns, rows]) = (self.start, self.cell, self.cells);
        let png = png_file::compressed(&self.dots, [columns as u32, rows as u32]).ok()?;
        Some(format!(
            "><image x=\"{left:.2}\" y=\"{top:.2}\" width=\"{:.2}\" height=\"{:.2}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/",
            width * columns as f64,
            height * rows as f64,
            BASE64_STANDARD.encode(png)
        ))
    }
}
