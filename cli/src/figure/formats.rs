//! A scene as a file: SVG, and what is made of it, PNG and PDF.

use std::sync::{Arc, OnceLock};

use asperity::scenario::{Figure, FigureFormat};
use krilla_svg::{SurfaceExt, SvgSettings};
use kuva::backend::svg::SvgBackend;
use kuva::render::render::Scene;
use resvg::tiny_skia::{PixmapMut, Transform};
use resvg::usvg::{self, Tree, fontdb};

use super::clip::cut;
use super::raster::fields_as_images;
use super::style::{HEIGHT, LABELS, Page, WIDTH};
use super::{grey, typography};

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

/// Least width and height of a picture of one panel, in units of the canvas: about as much as its labels take.
const LEAST: (f64, f64) = (240.0, 180.0);
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

/// The picture as SVG, with symbols typeset and a viewBox, so that it can be scaled.
pub fn svg(scene: Scene, title: &str, style: &Figure) -> String {
    let scene = fields_as_images(cut(scene), style.grey);
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

/// An SVG picture in another format. `dots` is memory, which may be that of another picture.
///
/// # Errors
/// What cannot be drawn.
pub fn converted(
    svg: &str,
    format: FigureFormat,
    style: &Figure,
    dots: &mut Vec<u8>,
) -> Result<Vec<u8>, String> {
    if format == FigureFormat::Svg {
        return Ok(svg.as_bytes().to_vec());
    }
    let options = usvg::Options { fontdb: fonts(), font_family: FAMILY.into(), ..usvg::Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    if format == FigureFormat::Pdf { pdf(&tree) } else { png(&tree, style.dpi / PER_INCH, dots) }
}

fn png(tree: &Tree, scale: f64, dots: &mut Vec<u8>) -> Result<Vec<u8>, String> {
    let (width, height) = (f64::from(tree.size().width()) * scale, f64::from(tree.size().height()) * scale);
    let size = [width.ceil() as u32, height.ceil() as u32];
    let count = size.map(|side| side as usize).iter().product::<usize>();
    // White. A fraction of a dot may remain at the right and at the bottom.
    dots.clear();
    dots.resize(4 * count, 255);
    let mut picture = PixmapMut::from_bytes(dots, size[0], size[1])
        .ok_or_else(|| format!("{width:.0} × {height:.0} dots are too many"))?;
    resvg::render(tree, Transform::from_scale(scale as f32, scale as f32), &mut picture);
    // Without the opacity, which is full.
    for i in 0..count {
        dots.copy_within(4 * i..4 * i + 3, 3 * i);
    }
    compressed(&dots[..3 * count], size).map_err(|error| error.to_string())
}

/// Red, green and blue of dots as a PNG file. Fast compression of differences to the row above takes a twentieth of the time of
/// the usual compression, for half as many bytes more.
pub(super) fn compressed(dots: &[u8], [width, height]: [u32; 2]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Up);
    encoder.write_header()?.write_image_data(dots)?;
    Ok(bytes)
}

/// A page of the size of the picture.
fn pdf(tree: &Tree) -> Result<Vec<u8>, String> {
    let points = |length: f32| (f64::from(length) * POINTS / PER_INCH) as f32;
    let size = krilla::geom::Size::from_wh(points(tree.size().width()), points(tree.size().height()))
        .ok_or("a picture without extent")?;
    let mut document = krilla::Document::new();
    let mut page = document.start_page_with(krilla::page::PageSettings::new(size));
    let mut surface = page.surface();
    surface.draw_svg(tree, size, SvgSettings::default());
    surface.finish();
    page.finish();
    document.finish().map_err(|error| format!("{error:?}"))
}

const FAMILY: &str = "DejaVu Sans";

/// The fonts of pictures: those in the program, so that pictures do not depend on the machine.
fn fonts() -> Arc<fontdb::Database> {
    static FONTS: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let load = || {
        let mut fonts = fontdb::Database::new();
        for font in [dejavu::sans::regular(), dejavu::sans::oblique(), dejavu::sans::bold()] {
            fonts.load_font_data(font.to_vec());
        }
        Arc::new(fonts)
    };
    FONTS.get_or_init(load).clone()
}
