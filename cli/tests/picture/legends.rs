//! Legends: each is below all panels, or in one of them and covers nothing that is drawn there.

use super::{frames, numbers, tags};

/// Distance of places along a line that are looked at, in units of the canvas: less than the distance that legends keep.
const STEP: f64 = 1.0;

/// The legend of a picture is where it covers nothing; whether it is in a panel.
pub fn check(place: &str, svg: &str) -> Option<bool> {
    let boxes: Vec<[f64; 4]> = tags(svg).iter().filter_map(|tag| rectangle(tag, "data-legend=\"")).collect();
    assert!(boxes.len() < 2, "{place}: {boxes:?}");
    let at = *boxes.first()?;
    let frames = frames(svg);
    let is_within = |frame: &[f64; 4]| {
        at[0] > frame[0]
            && at[1] > frame[1]
            && at[0] + at[2] < frame[0] + frame[2]
            && at[1] + at[3] < frame[1] + frame[3]
    };
    let lowest = frames.iter().map(|frame| frame[1] + frame[3]).fold(0.0, f64::max);
    let is_inside = frames.iter().any(is_within);
    assert!(is_inside || at[1] > lowest, "{place}: {at:?} in {frames:?}");
    let covered = drawn(svg)
        .into_iter()
        .find(|&(x, y)| (at[0]..at[0] + at[2]).contains(&x) && (at[1]..at[1] + at[3]).contains(&y));
    assert_eq!(covered, None, "{place}: {at:?}");
    let middle = (at[0] + 0.5 * at[2], at[1] + 0.5 * at[3]);
    assert!(!areas(svg).iter().any(|area| has(area, middle)), "{place}: {at:?}");
    Some(is_inside)
}

fn rectangle(tag: &super::Tag, key: &str) -> Option<[f64; 4]> {
    let [left, top, width, height] = numbers(tag.text, key, '"')?.try_into().ok()?;
    Some([tag.at[0] + left, tag.at[1] + top, width, height])
}

/// The outlines of areas within the frames of panels: paths with a colour.
fn areas(svg: &str) -> Vec<Vec<(f64, f64)>> {
    let mut found = Vec::new();
    for tag in
        tags(svg).iter().filter(|tag| tag.text.starts_with("path") && !tag.text.contains("fill=\"none\""))
    {
        let path = tag.text.split(" d=\"").nth(1).and_then(|rest| rest.split('"').next());
        let moved = |(x, y): (f64, f64)| (x + tag.at[0], y + tag.at[1]);
        found.extend(
            path.into_iter()
                .flat_map(|path| path.split('M'))
                .map(|run| points(run).into_iter().map(moved).collect()),
        );
    }
    found
}

/// Whether a place is within an outline: a line from it to the right crosses the outline an odd number of times.
fn has(outline: &[(f64, f64)], (x, y): (f64, f64)) -> bool {
    let next = outline.iter().cycle().skip(1);
    let crosses = |(a, b): &(&(f64, f64), &(f64, f64))| {
        (a.1 > y) != (b.1 > y) && x < a.0 + (b.0 - a.0) * (y - a.1) / (b.1 - a.1)
    };
    outline.iter().zip(next).filter(crosses).count() % 2 == 1
}

/// Places on all lines, outlines and markers within the frames of panels.
fn drawn(svg: &str) -> Vec<(f64, f64)> {
    let (mut found, mut groups): (Vec<(f64, f64)>, Vec<bool>) = (Vec::new(), Vec::new());
    for tag in tags(svg) {
        if tag.text.starts_with("/g") {
            groups.pop();
        } else if tag.text.starts_with("g ") || tag.text == "g" {
            groups.push(tag.text.contains("data-frame"));
        }
        if !groups.iter().any(|is_frame| *is_frame) {
            continue;
        }
        let attribute = |key: &str| numbers(tag.text, key, '"').and_then(|found| found.first().copied());
        let mut places = Vec::new();
        if let Some(path) = tag.text.split(" d=\"").nth(1).and_then(|rest| rest.split('"').next()) {
            path.split('M').for_each(|run| places.extend(along(run)));
        } else if let (Some(x), Some(y)) = (attribute(" cx=\""), attribute(" cy=\"")) {
            places.push((x, y));
        } else if let (Some(x), Some(y)) = (attribute(" x1=\""), attribute(" y1=\"")) {
            let end = (attribute(" x2=\"").unwrap_or(x), attribute(" y2=\"").unwrap_or(y));
            places.extend(between((x, y), end));
        } else if let [Some(x), Some(y), Some(width), Some(height)] =
            [" x=\"", " y=\"", " width=\"", " height=\""].map(attribute)
        {
            let corners = [(x, y), (x + width, y), (x + width, y + height), (x, y + height), (x, y)];
            corners.windows(2).for_each(|pair| places.extend(between(pair[0], pair[1])));
        }
        found.extend(places.into_iter().map(|(x, y)| (x + tag.at[0], y + tag.at[1])));
    }
    found
}

/// The points of a run of a path.
fn points(run: &str) -> Vec<(f64, f64)> {
    let split = run.split(|c: char| c.is_whitespace() || c == ',' || c.is_alphabetic());
    let numbers: Vec<f64> = split.filter_map(|number| number.parse().ok()).collect();
    let mut points: Vec<(f64, f64)> = numbers.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect();
    if run.contains('Z') {
        points.extend(points.first().copied());
    }
    points
}

/// Places along a run of points of a path.
fn along(run: &str) -> Vec<(f64, f64)> {
    points(run).windows(2).flat_map(|pair| between(pair[0], pair[1])).collect()
}

/// Places from a point to another.
fn between(from: (f64, f64), to: (f64, f64)) -> Vec<(f64, f64)> {
    let (right, down) = (to.0 - from.0, to.1 - from.1);
    let count = (right.hypot(down) / STEP).ceil().max(1.0);
    (0..=count as usize)
        .map(|i| i as f64 / count)
        .map(|part| (from.0 + part * right, from.1 + part * down))
        .collect()
}
