//! The legend of a picture: in a corner of a panel, or in the middle of its upper or lower side, where it covers nothing that is
//! drawn there; below the picture where no panel has such room.

use kuva::plot::{LegendEntry, LegendShape, MarkerShape};
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};

use super::curve::Point;
use super::letters;
use super::room::{Panel, panels};
use super::style::{self, Page};

/// Font size of a legend, and the smallest of one that is wider than its picture.
const SIZE: u32 = 12;
const SMALLEST: u32 = 8;
/// Height of a row.
const ROW: f64 = 18.0;
/// Width of a line or an area beside its words: two dashes of every kind fit.
const SAMPLE: f64 = 24.0;
/// Distance of words from what they name, and of columns from each other.
const GAP: f64 = 7.0;
const BETWEEN: f64 = 20.0;
/// Half the width of a marker.
const MARKER: f64 = 5.0;
/// Width of lines.
const LINE: f64 = 2.0;
/// Height of the middle of letters above their line, over the font size.
const MIDDLE: f64 = 0.36;
/// Distance of a legend below a picture from its right end, and from its lower end.
const EDGES: (f64, f64) = (8.0, 6.0);

/// The picture with a legend in one of these panels, the first that has room, or else below it.
pub fn placed(mut scene: Scene, entries: &[LegendEntry], of: &[usize]) -> Scene {
    if entries.is_empty() {
        return scene;
    }
    let letters = letters_in(scene.width - 2.0 * EDGES.0, entries);
    let widest = widest(entries, letters);
    let size = [widest, ROW * entries.len() as f64];
    let found = panels(&scene);
    let room =
        of.iter().filter_map(|&panel| found.get(panel)).find_map(|panel| Some((panel, panel.room(size)?)));
    match room {
        Some((panel, at)) => {
            let rows = (0..entries.len()).map(|row| (at.0, at.1 + ROW * row as f64));
            let drawn = drawn((entries, letters), rows, size, at);
            scene.elements.splice(panel.end..panel.end, drawn);
        }
        None => below(&mut scene, (entries, letters), widest, &found),
    }
    scene
}

/// A picture that is as high as it would be without a legend: one of one panel below which there is a legend is drawn anew with a
/// lower panel.
pub fn fitted(page: Page, draw: impl Fn(Page) -> Option<Scene>) -> Option<Scene> {
    let drawn = draw(page)?;
    let beyond = drawn.height - page.height(style::HEIGHT);
    if beyond > 0.0 && panels(&drawn).len() == 1 { draw(page.with_free(beyond)) } else { Some(drawn) }
}

/// Appends a legend in as many columns as fit below a picture.
fn below(scene: &mut Scene, (entries, letters): (&[LegendEntry], u32), widest: f64, panels: &[Panel]) {
    let left = panels.iter().map(|panel| panel.on_canvas().0).fold(f64::INFINITY, f64::min);
    let left = if left.is_finite() { left } else { EDGES.0 };
    // A wide one begins before the panels.
    let left = left.min(scene.width - EDGES.0 - widest).max(EDGES.0);
    let room = scene.width - left - EDGES.0;
    let columns = (((room + BETWEEN) / (widest + BETWEEN)) as usize).clamp(1, entries.len());
    // Entries that fill less than a row are as close to each other as those of more rows.
    let top = scene.height;
    let places = (0..entries.len()).map(|i| {
        let (row, column) = (i / columns, i % columns);
        (left + column as f64 * (widest + BETWEEN), top + ROW * row as f64)
    });
    let rows = entries.len().div_ceil(columns) as f64;
    let size = [columns as f64 * (widest + BETWEEN) - BETWEEN, ROW * rows];
    scene.elements.extend(drawn((entries, letters), places, size, (left, top)));
    scene.height += ROW * rows + EDGES.1;
}

/// The font size of entries in this room.
fn letters_in(room: f64, entries: &[LegendEntry]) -> u32 {
    (SMALLEST..=SIZE).rev().find(|&size| widest(entries, size) <= room).unwrap_or(SMALLEST)
}

/// The width of the widest entry in letters of this size.
fn widest(entries: &[LegendEntry], size: u32) -> f64 {
    let words = entries.iter().map(|entry| letters::width(&entry.label, f64::from(size)));
    SAMPLE + GAP + words.fold(0.0, f64::max)
}

/// Entries at their places, as a group with the attribute `data-legend`: left, top, width and height of all.
fn drawn(
    (entries, letters): (&[LegendEntry], u32),
    places: impl Iterator<Item = Point>,
    [width, height]: [f64; 2],
    (left, top): Point,
) -> Vec<Primitive> {
    let attributes = format!("data-legend=\"{left:.2} {top:.2} {width:.2} {height:.2}\"");
    let start = Primitive::GroupStart { transform: None, title: None, extra_attrs: Some(attributes) };
    let both =
        entries.iter().zip(places).flat_map(|(entry, at)| [sample(entry, at), words(entry, letters, at)]);
    std::iter::once(start).chain(both).chain([Primitive::GroupEnd]).collect()
}

fn words(entry: &LegendEntry, size: u32, (x, y): Point) -> Primitive {
    Primitive::Text {
        x: x + SAMPLE + GAP,
        y: y + 0.5 * ROW + MIDDLE * f64::from(size),
        content: entry.label.clone(),
        size,
        anchor: TextAnchor::Start,
        rotate: None,
        bold: false,
        color: None,
    }
}

/// A line, an area or a marker as in the picture.
fn sample(entry: &LegendEntry, (x, y): Point) -> Primitive {
    let (middle, centre) = (y + 0.5 * ROW, x + 0.5 * SAMPLE);
    let fill = Color::from(entry.color.as_str());
    let rectangle = |width: f64, fill| Primitive::Rect {
        x: centre - 0.5 * width,
        y: middle - MARKER,
        width,
        height: 2.0 * MARKER,
        fill,
        stroke: None,
        stroke_width: None,
        opacity: None,
    };
    match entry.shape {
        LegendShape::Line => Primitive::Line {
            x1: x,
            y1: middle,
            x2: x + SAMPLE,
            y2: middle,
            stroke: fill,
            stroke_width: LINE,
            stroke_dasharray: entry.dasharray.clone(),
        },
        LegendShape::Rect => rectangle(SAMPLE, fill),
        LegendShape::Marker(MarkerShape::Square) => rectangle(2.0 * MARKER, fill),
        LegendShape::Marker(shape) if shape != MarkerShape::Circle => outlined(shape, (centre, middle), fill),
        _ => Primitive::Circle {
            cx: centre,
            cy: middle,
            r: 0.9 * MARKER,
            fill,
            fill_opacity: None,
            stroke: None,
            stroke_width: None,
        },
    }
}

/// A marker of straight lines around a centre: a cross, a triangle or a diamond.
fn outlined(shape: MarkerShape, (x, y): Point, colour: Color) -> Primitive {
    let at = |(right, down): (f64, f64)| format!("{:.2},{:.2}", x + MARKER * right, y + MARKER * down);
    let run = |points: &[(f64, f64)]| points.iter().map(|&point| at(point)).collect::<Vec<_>>().join(" L");
    let (d, is_filled) = match shape {
        MarkerShape::Cross => {
            let strokes = [[(-0.7, -0.7), (0.7, 0.7)], [(0.7, -0.7), (-0.7, 0.7)]];
            (strokes.map(|stroke| format!("M{}", run(&stroke))).join(" "), false)
        }
        MarkerShape::Triangle => (format!("M{} Z", run(&[(0.0, -1.0), (-1.0, 0.7), (1.0, 0.7)])), true),
        MarkerShape::TriangleDown => (format!("M{} Z", run(&[(0.0, 1.0), (-1.0, -0.7), (1.0, -0.7)])), true),
        _ => (format!("M{} Z", run(&[(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)])), true),
    };
    Primitive::Path(Box::new(PathData {
        d,
        fill: is_filled.then(|| colour.clone()),
        stroke: colour,
        stroke_width: if is_filled { 0.5 } else { 1.5 },
        opacity: None,
        stroke_dasharray: None,
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A panel of 400 × 300 at (60, 10), in which these lines are drawn.
    fn panel(lines: &[&[Point]]) -> Scene {
        let mut scene = Scene::new(480.0, 360.0);
        scene.add(Primitive::ClipStart { x: 60.0, y: 10.0, width: 400.0, height: 300.0, id: String::new() });
        for points in lines {
            scene.add(Primitive::PolyLine {
                points: points.to_vec(),
                stroke: "#000000".into(),
                stroke_width: 1.0,
                stroke_dasharray: None,
            });
        }
        scene.add(Primitive::ClipEnd);
        scene
    }

    /// Left, top, width and height of the legend.
    fn place(scene: &Scene) -> [f64; 4] {
        let attribute = scene.elements.iter().find_map(|element| match element {
            Primitive::GroupStart { extra_attrs: Some(text), .. } => text.strip_prefix("data-legend=\""),
            _ => None,
        });
        let numbers =
            attribute.unwrap().trim_end_matches('"').split(' ').map(|number| number.parse().unwrap());
        numbers.collect::<Vec<f64>>().try_into().unwrap()
    }

    fn entries() -> [LegendEntry; 2] {
        [style::line("master equation", style::BLUE, None), style::area("±2 std", style::BLUE)]
    }

    #[test]
    fn a_legend_is_where_nothing_is_drawn() {
        // One line or two that leave one corner: upper right, upper left, lower right, lower left.
        let upper = [(60.0, 30.0), (460.0, 30.0)];
        let lower = [(60.0, 290.0), (460.0, 290.0)];
        let (left, right) = ([(100.0, 10.0), (100.0, 310.0)], [(420.0, 10.0), (420.0, 310.0)]);
        for (lines, is_right, is_above) in [
            ([&lower[..], &left], true, true),
            ([&lower, &right], false, true),
            ([&upper, &left], true, false),
            ([&upper, &right], false, false),
        ] {
            let [x, y, width, height] = place(&placed(panel(&lines), &entries(), &[0]));
            assert_eq!((x + 0.5 * width > 260.0, y + 0.5 * height < 160.0), (is_right, is_above));
            assert!(x > 60.0 && y > 10.0 && x + width < 460.0 && y + height < 310.0);
        }
    }

    #[test]
    fn a_legend_without_room_is_below() {
        let across = |y: f64| [(60.0, y), (460.0, y)];
        let lines = [across(30.0), across(290.0)];
        let drawn = placed(panel(&[&lines[0], &lines[1]]), &entries(), &[0]);
        let [x, y, width, height] = place(&drawn);
        assert_eq!((x, y, height), (60.0, 360.0, ROW));
        assert!(x + width < 480.0 && y + height <= drawn.height);
        // In a panel that is too small, too.
        let many: Vec<_> = (0..20).map(|i| style::line(format!("curve {i}"), style::BLUE, None)).collect();
        assert_eq!(place(&placed(panel(&[]), &many, &[0]))[1], 360.0);
    }

    #[test]
    fn a_wide_legend_begins_before_the_panels() {
        let across = |y: f64| [(60.0, y), (460.0, y)];
        let wide = [style::line("wide ".repeat(12), style::BLUE, None)];
        let drawn = placed(panel(&[&across(30.0), &across(290.0)]), &wide, &[]);
        let [x, _, width, _] = place(&drawn);
        assert!((8.0..60.0).contains(&x) && x + width <= drawn.width - 7.9, "{x} {width}");
    }

    #[test]
    fn a_picture_without_entries_stays() {
        let drawn = placed(panel(&[]), &[], &[0]);
        assert_eq!((drawn.elements.len(), drawn.height), (2, 360.0));
    }
}
