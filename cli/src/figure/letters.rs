//! Texts as outlines of their letters, for dots.

use std::collections::HashMap;
use std::sync::OnceLock;

use kuva::render::render::TextAnchor;
use rustybuzz::ttf_parser::{GlyphId, OutlineBuilder};
use rustybuzz::{Direction, Face, GlyphBuffer, Script, ShapePlan, UnicodeBuffer};
use tiny_skia::{Path, PathBuilder, Transform};

use super::typography::{self, Span};

/// The fonts of pictures, which are in the program: upright, italic, bold.
pub fn fonts() -> [&'static [u8]; 3] {
    [dejavu::sans::regular(), dejavu::sans::oblique(), dejavu::sans::bold()]
}

/// A font, read once.
fn face(number: usize) -> &'static Face<'static> {
    static FACES: [OnceLock<Face<'static>>; 3] = [const { OnceLock::new() }; 3];
    let read = || Face::from_slice(fonts()[number], 0).expect("a font of the program");
    FACES[number].get_or_init(read)
}

/// About how wide a typeset text of this size is: the advances of its letters, without kerning, which brings letters nearer.
pub fn width(text: &str, size: f64) -> f64 {
    let advance = |face: &Face, letter: char| {
        let glyph = face.glyph_index(letter)?;
        Some(f64::from(face.glyph_hor_advance(glyph)?) / f64::from(face.units_per_em()))
    };
    let wide = |span: &Span| -> f64 {
        let face = face(usize::from(span.is_italic));
        span.size * span.text.chars().filter_map(|letter| advance(face, letter)).sum::<f64>()
    };
    typography::spans(text, size).iter().map(wide).sum()
}

/// A text and where it stands.
pub struct Text<'a> {
    pub content: &'a str,
    pub size: f64,
    pub anchor: TextAnchor,
    pub is_bold: bool,
    /// Whether symbols and numbers are typeset.
    pub is_typeset: bool,
}

/// Lays texts out. What letters and scripts have in common is computed once.
#[derive(Default)]
pub struct Letters {
    outlines: HashMap<(usize, u16), Option<Path>>,
    plans: Vec<(usize, Direction, Script, ShapePlan)>,
}

impl Letters {
    /// The outline of a text that is anchored at 0, if it has one.
    pub fn outline(&mut self, text: &Text) -> Option<Path> {
        // As programs show texts in SVG.
        let content = text.content.split_whitespace().collect::<Vec<_>>().join(" ");
        let spans = match text.is_typeset {
            true => typography::spans(&content, text.size),
            false => vec![Span { text: content, is_italic: false, size: text.size, lowered: 0.0 }],
        };
        let (mut outline, mut end) = (PathBuilder::new(), 0.0);
        for span in &spans {
            let font = if span.is_italic { 1 } else { 2 * usize::from(text.is_bold) };
            end = self.append(&mut outline, span, font, end);
        }
        let start = match text.anchor {
            TextAnchor::Start => 0.0,
            TextAnchor::Middle => -0.5 * end,
            TextAnchor::End => -end,
        };
        outline.finish()?.transform(Transform::from_translate(start, 0.0))
    }

    /// Appends a piece of a text, and gives the place where it ends.
    fn append(&mut self, outline: &mut PathBuilder, span: &Span, font: usize, start: f32) -> f32 {
        let scale = span.size as f32 / face(font).units_per_em() as f32;
        let glyphs = self.shaped(&span.text, font);
        let mut at = start;
        for (glyph, place) in glyphs.glyph_infos().iter().zip(glyphs.glyph_positions()) {
            let across = at + scale * place.x_offset as f32;
            let down = span.lowered as f32 - scale * place.y_offset as f32;
            let glyph = self.glyph(font, glyph.glyph_id as u16).and_then(|glyph| {
                glyph.clone().transform(Transform::from_row(scale, 0.0, 0.0, -scale, across, down))
            });
            glyph.iter().for_each(|glyph| outline.push_path(glyph));
            at += scale * place.x_advance as f32;
        }
        at
    }

    /// The letters of a text and their places.
    fn shaped(&mut self, text: &str, font: usize) -> GlyphBuffer {
        let mut buffer = UnicodeBuffer::new();
        buffer.push_str(text);
        buffer.guess_segment_properties();
        let key = (font, buffer.direction(), buffer.script());
        let found = self.plans.iter().position(|plan| (plan.0, plan.1, plan.2) == key);
        let found = found.unwrap_or_else(|| {
            let plan = ShapePlan::new(face(font), key.1, Some(key.2), None, &[]);
            self.plans.push((key.0, key.1, key.2, plan));
            self.plans.len() - 1
        });
        rustybuzz::shape_with_plan(face(font), &self.plans[found].3, buffer)
    }

    /// The outline of a letter in units of the font, upwards.
    fn glyph(&mut self, font: usize, number: u16) -> Option<&Path> {
        let draw = || {
            let mut outline = Outline(PathBuilder::new());
            face(font).outline_glyph(GlyphId(number), &mut outline)?;
            outline.0.finish()
        };
        self.outlines.entry((font, number)).or_insert_with(draw).as_ref()
    }
}

struct Outline(PathBuilder);

impl OutlineBuilder for Outline {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.0.close();
    }
}
