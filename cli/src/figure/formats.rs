//! A scene as a file: SVG, PDF, which is made of it, and PNG, which is drawn directly.

use std::sync::{Arc, OnceLock};

use asperity::scenario::{Figure, FigureFormat};
use krilla_svg::{SurfaceExt, SvgSettings};
use kuva::backend::svg::SvgBackend;
use kuva::render::render::{Primitive, Scene};
use usvg::{Tree, fontdb};

use super::clip::cut;
use super::dots::{self, Dots};
use super::raster::fields_as_images;
use super::style::{HEIGHT, LABELS, Page, WIDTH};
use super::{grey, letters, typography};

/// Units of the canvas per inch, as in CSS.
const PER_INCH: f64 = 96.0;
/// Points per inch.
const POINTS: f64 = 72.0;
const MM_PER_INCH: f64 = 25.4;
/// The usual width of pictures in mm.
const USUAL: f64 = WIDTH / PER_INCH * MM_PER_INCH;

/// The canvas of pictures that are drawn in this style.
pub fn page(style: &Figure) -> Page {
    let wide = style.width.unwrap_or(USUAL);
    // What one unit of the canvas is in mm.
    let unit = style.font_size.map_or(wide / WIDTH, |size| size / POINTS * MM_PER_INCH / LABELS);
    Page::new(wide / unit, style.height.map(|height| height / wide))
}

/// Least width and height of a picture of one panel, in units of the canvas: in narrower ones labels touch or are cut.
const LEAST: (f64, f64) = (320.0, 180.0);
/// Most dots of a PNG along a side.
const DOTS: f64 = 20_000.0;

/// Refuses a style in which letters leave no room for curves, or with more dots than programs can show.
///
/// # Errors
/// What was expected.
pub fn check(style: &Figure) -> Result<(), String> {
    let page = page(style);
    let height = page.height(HEIGHT);
    if page.width < LEAST.0 || height < LEAST.1 {
        let widest = (LEAST.0 / page.width).max(LEAST.1 / height);
        return Err(format!(
            "figure: expected a picture at least {widest:.1} times as wide and high for letters of this size, or a smaller figure.font_size"
        ));
    }
    let wide = style.width.unwrap_or(USUAL);
    let dots = wide.max(wide * height / page.width) / MM_PER_INCH * style.dpi;
    if style.formats.contains(&FigureFormat::Png) && dots > DOTS {
        return Err(format!("figure.dpi: expected at most {DOTS} dots along a side, got {dots:.0}"));
    }
    Ok(())
}

/// A picture without clip paths, and what is made of it.
pub struct Picture<'a> {
    scene: Scene,
    title: String,
    style: &'a Figure,
    svg: OnceLock<String>,
}

impl<'a> Picture<'a> {
    /// A picture with this title, which is not typeset.
    pub fn new(scene: Scene, title: &str, style: &'a Figure) -> Self {
        let scene = with_readable_texts(cut(scene));
        Self { scene, title: readable(title), style, svg: OnceLock::new() }
    }

    /// The picture in a format.
    ///
    /// # Errors
    /// What cannot be drawn.
    pub fn converted(&self, format: FigureFormat) -> Result<Vec<u8>, String> {
        match format {
            FigureFormat::Svg => Ok(self.svg().as_bytes().to_vec()),
            FigureFormat::Png => self.png(),
            FigureFormat::Pdf => pdf(self.svg()),
        }
    }

    /// With symbols typeset and a viewBox, so that it can be scaled.
    fn svg(&self) -> &str {
        self.svg.get_or_init(|| self.text())
    }

    fn text(&self) -> String {
        let Self { title, style, .. } = self;
        let scene = fields_as_images(&self.scene, style.grey);
        let drawn = typography::typeset(&SvgBackend::new().render_scene(&scene), title);
        let (width, height) = (scene.width, scene.height);
        let unit = |length: f64| match (style.width, style.font_size) {
            (None, None) => format!("{length}"),
            (wide, _) => format!("{}mm", length * wide.unwrap_or(USUAL) / width),
        };
        let scaled =
            format!("width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\"", unit(width), unit(height));
        let coloured = resized(&drawn, &scaled);
        if style.grey { grey::shaded(&coloured) } else { coloured }
    }

    fn png(&self) -> Result<Vec<u8>, String> {
        let Figure { width, font_size, dpi, grey, .. } = *self.style;
        // Inches per unit of the canvas.
        let unit = match (width, font_size) {
            (None, None) => 1.0 / PER_INCH,
            (wide, _) => wide.unwrap_or(USUAL) / MM_PER_INCH / self.scene.width,
        };
        let dots = Dots { scale: unit * dpi, dpi, grey, title: &self.title };
        dots::png(&self.scene, &dots).map_err(|error| error.to_string())
    }
}

/// The picture without the letters that no file can hold.
fn with_readable_texts(mut scene: Scene) -> Scene {
    for element in &mut scene.elements {
        if let Primitive::Text { content, .. } = element {
            *content = readable(content);
        }
    }
    scene
}

/// A text without the control characters that XML does not allow.
fn readable(text: &str) -> String {
    let is_allowed = |c: &char| match c {
        '\t' | '\n' | '\r' => true,
        '\u{FFFE}' | '\u{FFFF}' => false,
        c => !c.is_control(),
    };
    text.chars().filter(is_allowed).collect()
}

/// The picture with other attributes in the place of its width and height, which stand together in its first tag.
fn resized(svg: &str, attributes: &str) -> String {
    let found = svg.find("width=\"").and_then(|start| {
        let height = start + svg[start..].find("height=\"")? + "height=\"".len();
        Some((start, height + svg[height..].find('"')? + 1))
    });
    found.map_or_else(
        || svg.to_owned(),
        |(start, end)| format!("{}{attributes}{}", &svg[..start], &svg[end..]),
    )
}

/// An SVG picture as a page of its size.
fn pdf(svg: &str) -> Result<Vec<u8>, String> {
    let options =
        usvg::Options { fontdb: database(), font_family: FAMILY.into(), ..usvg::Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let points = |length: f32| (f64::from(length) * POINTS / PER_INCH) as f32;
    let size = krilla::geom::Size::from_wh(points(tree.size().width()), points(tree.size().height()))
        .ok_or("a picture without extent")?;
    let mut document = krilla::Document::new();
    let mut page = document.start_page_with(krilla::page::PageSettings::new(size));
    let mut surface = page.surface();
    surface.draw_svg(&tree, size, SvgSettings::default());
    surface.finish();
    page.finish();
    document.finish().map_err(|error| format!("{error:?}"))
}

const FAMILY: &str = "DejaVu Sans";

/// The fonts of pictures: those in the program, so that pictures do not depend on the machine.
fn database() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let load = || {
        let mut fonts = fontdb::Database::new();
        letters::fonts().into_iter().for_each(|font| fonts.load_font_data(font.to_vec()));
        Arc::new(fonts)
    };
    FONTS.get_or_init(load).clone()
}
