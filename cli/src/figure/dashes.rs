//! Dashed lines drawn as separate dashes, for the PNG backend, which restarts a dash at every
//! point of a curve and rounds its ends, so that dense curves look solid.

use kuva::render::render::{Primitive, Scene};

type Point = (f64, f64);

/// Replaces every dashed line of the scene by its dashes.
pub fn cut(scene: &mut Scene) {
    let elements = std::mem::take(&mut scene.elements);
    scene.elements = elements.into_iter().flat_map(pieces).collect();
}

fn pieces(element: Primitive) -> Vec<Primitive> {
    match element {
        Primitive::PolyLine { points, stroke, stroke_width, stroke_dasharray: Some(pattern) } => {
            let solid = |points| {
                let stroke = stroke.clone();
                Primitive::PolyLine { points, stroke, stroke_width, stroke_dasharray: None }
            };
            dashes(&points, &pattern, stroke_width).into_iter().map(solid).collect()
        }
        Primitive::Line { x1, y1, x2, y2, stroke, stroke_width, stroke_dasharray: dashed @ Some(_) } => {
            let points = vec![(x1, y1), (x2, y2)];
            pieces(Primitive::PolyLine { points, stroke, stroke_width, stroke_dasharray: dashed })
        }
        other => vec![other],
    }
}

/// The drawn parts of a line through `points`; `pattern` lists drawn and omitted lengths in turn.
/// Each part is shorter by `width`, because of its round ends.
fn dashes(points: &[Point], pattern: &str, width: f64) -> Vec<Vec<Point>> {
    let lengths: Vec<f64> = pattern.split([' ', ',']).filter_map(|word| word.parse().ok()).collect();
    let round_end = |turn: usize| if turn.is_multiple_of(2) { -width } else { width };
    let length = |turn: usize| (lengths[turn % lengths.len()] + round_end(turn)).max(0.1);
    if lengths.is_empty() || points.is_empty() {
        return vec![points.to_vec()];
    }
    let (mut turn, mut left, mut drawn) = (0, length(0), vec![vec![points[0]]]);
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut remaining = (to.0 - from.0).hypot(to.1 - from.1);
        while remaining > left {
            let step = left / remaining;
            from = (from.0 + step * (to.0 - from.0), from.1 + step * (to.1 - from.1));
            remaining -= left;
            extend(&mut drawn, turn, from);
            turn += 1;
            left = length(turn);
            if turn.is_multiple_of(2) {
                drawn.push(vec![from]);
            }
        }
        left -= remaining;
        extend(&mut drawn, turn, to);
    }
    drawn.retain(|dash| dash.len() > 1);
    drawn
}

fn extend(drawn: &mut [Vec<Point>], turn: usize, point: Point) {
    if let Some(dash) = drawn.last_mut().filter(|_| turn.is_multiple_of(2)) {
        dash.push(point);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_run_on_through_the_points_of_a_curve() {
        let points: Vec<Point> = (0..=100).map(|i| (f64::from(i) * 0.1, 0.0)).collect();
        let ends: Vec<(f64, f64)> =
            dashes(&points, "3 1", 0.0).iter().map(|d| (d[0].0, d[d.len() - 1].0)).collect();
        for (got, want) in ends.iter().zip([(0.0, 3.0), (4.0, 7.0), (8.0, 10.0)]) {
            assert!((got.0 - want.0).abs() < 1e-9 && (got.1 - want.1).abs() < 1e-9, "{ends:?}");
        }
        assert_eq!(ends.len(), 3);
    }
}
