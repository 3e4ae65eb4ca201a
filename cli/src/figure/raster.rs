//! Fields as images within a picture: one element instead of a rectangle for each cell, without gaps between cells.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene};

use super::{formats, grey};

/// The picture with an image in the place of each field.
pub fn fields_as_images(mut scene: Scene, grey: bool) -> Scene {
    let mut elements = Vec::with_capacity(scene.elements.len());
    for element in scene.elements {
        match element {
            Primitive::RectBatch { x, y, w, h, fills } if !x.is_empty() => {
                let extra_attrs = image([&x, &y, &w, &h], &fills, grey);
                elements.push(Primitive::GroupStart { transform: None, title: None, extra_attrs });
                elements.push(Primitive::GroupEnd);
            }
            other => elements.push(other),
        }
    }
    scene.elements = elements;
    scene
}

/// Equal cells of a grid as an image. The plot library has no element for it and writes the attributes of a group as they are:
/// these end the tag of the group and begin the image.
fn image([x, y, w, h]: [&[f64]; 4], fills: &[Color], grey: bool) -> Option<String> {
    let least = |of: &[f64]| of.iter().copied().fold(f64::INFINITY, f64::min);
    let most = |of: &[f64]| of.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (left, top) = (least(x), least(y));
    let place = |at: f64, start: f64, step: f64| ((at - start) / step).round() as usize;
    let (columns, rows) = (place(most(x), left, w[0]) + 1, place(most(y), top, h[0]) + 1);
    let mut dots = vec![255; 3 * columns * rows];
    for (i, fill) in fills.iter().enumerate() {
        let at = 3 * (place(y[i], top, h[0]) * columns + place(x[i], left, w[0]));
        dots[at..at + 3].copy_from_slice(&rgb(fill, grey));
    }
    let png = formats::compressed(&dots, [columns as u32, rows as u32]).ok()?;
    Some(format!(
        "><image x=\"{left:.2}\" y=\"{top:.2}\" width=\"{:.2}\" height=\"{:.2}\" preserveAspectRatio=\"none\" \
         style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/",
        w[0] * columns as f64,
        h[0] * rows as f64,
        BASE64_STANDARD.encode(png)
    ))
}

fn rgb(colour: &Color, grey: bool) -> [u8; 3] {
    let Color::Rgb(red, green, blue) = *colour else { return [255; 3] };
    if grey { [grey::luminance([red, green, blue]); 3] } else { [red, green, blue] }
}
