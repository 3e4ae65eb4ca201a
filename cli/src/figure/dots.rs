//! A picture as PNG, drawn and compressed a band of rows at a time: bands stay in the cache of the processor, and a large picture
//! takes no more memory than a small one.

use kuva::render::render::Scene;
use png::{ColorType, EncodingError, PixelDimensions, Unit};
use tiny_skia::PixmapMut;

use super::png_file::{DRAWN, png_file};
use super::shapes::{Shape, shapes};

/// Bytes of a band.
const BAND: usize = 1 << 20;

/// How many dots a picture has, and how they are coloured.
pub struct Dots<'a> {
    /// Dots per unit of the canvas.
    pub scale: f64,
    pub dpi: f64,
    pub grey: bool,
    /// A text that is not typeset.
    pub title: &'a str,
}

/// A picture as a PNG file.
///
/// # Errors
/// What cannot be written.
pub fn png(scene: &Scene, style: &Dots) -> Result<Vec<u8>, EncodingError> {
    let side = |length: f64| (length * style.scale).ceil() as u32;
    let [width, height] = [side(scene.width), side(scene.height)];
    let shapes = shapes(scene, style.title, style.grey, style.scale);
    let colour = if style.grey { ColorType::Grayscale } else { ColorType::Rgb };
    let per_metre = (style.dpi / 0.0254).round() as u32;
    let resolution = PixelDimensions { xppu: per_metre, yppu: per_metre, unit: Unit::Meter };
    png_file([width, height], colour, Some(resolution), |rows| {
        let band = (BAND / (DRAWN * width as usize)).clamp(1, height as usize) as u32;
        let mut dots = vec![0; DRAWN * width as usize * band as usize];
        for first in (0..height).step_by(band as usize) {
            let count = band.min(height - first);
            let dots = &mut dots[..DRAWN * (width * count) as usize];
            draw(&shapes, dots, [width, count], first);
            rows.write(dots)?;
        }
        Ok(())
    })
}

/// Draws rows from the first on.
fn draw(shapes: &[Shape], dots: &mut [u8], [width, count]: [u32; 2], first: u32) {
    dots.fill(255);
    if let Some(mut band) = PixmapMut::from_bytes(dots, width, count) {
        shapes.iter().for_each(|shape| shape.draw(&mut band, first));
    }
}
