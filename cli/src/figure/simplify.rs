//! Lines without the points that cannot be seen: each one that is left out is at most [`NEAR`] from the line that is drawn.
//!
//! Seen from a point that is kept, straight lines that pass the next points closely enough have directions in a sector, which
//! narrows from point to point. The first point outside of it begins the next piece (J. Sklansky and V. Gonzalez, Pattern
//! Recognition 12, 327 (1980)).

use super::curve::Point;

/// Largest distance of a point that is left out, in units of the canvas: less than a tenth of a dot at 400 dots per inch.
const NEAR: f64 = 0.02;

/// The line through some of these points, the first and the last among them.
pub fn simplified(points: &[Point]) -> Vec<Point> {
    let [first, rest @ ..] = points else { return Vec::new() };
    let (mut kept, mut piece) = (vec![*first], Piece::at(*first));
    for &point in rest {
        if !piece.extends_to(point) {
            kept.push(piece.last);
            piece = Piece::at(piece.last);
            piece.extends_to(point);
        }
    }
    if !rest.is_empty() {
        kept.push(piece.last);
    }
    kept
}

/// A curve without points on straight lines between others, to about a millionth of these extents: the plot library takes as long for
/// each point as for one that is seen.
pub fn bends(points: &[Point], (width, height): (f64, f64)) -> Vec<Point> {
    const FINE: f64 = 2e4;
    // Powers of two, which change no digit of a number.
    let scale = |extent: f64| if extent > 0.0 { (FINE / extent).log2().round().exp2() } else { 1.0 };
    let scale = [scale(width), scale(height)];
    let scaled: Vec<Point> = points.iter().map(|point| (point.0 * scale[0], point.1 * scale[1])).collect();
    simplified(&scaled).into_iter().map(|point| (point.0 / scale[0], point.1 / scale[1])).collect()
}

/// A straight piece of a line.
struct Piece {
    first: Point,
    last: Point,
    /// Distance of the last point from the first.
    reach: f64,
    /// Directions from the first point that pass all others closely enough: between these two, counterclockwise.
    sector: Option<(Point, Point)>,
}

impl Piece {
    fn at(first: Point) -> Self {
        Self { first, last: first, reach: 0.0, sector: None }
    }

    /// Whether a straight line to the point passes all others closely enough. If so, it is the last.
    fn extends_to(&mut self, point: Point) -> bool {
        let to = (point.0 - self.first.0, point.1 - self.first.1);
        let reach = to.0.hypot(to.1);
        if reach < self.reach {
            return false;
        }
        if reach > NEAR {
            let Some(sector) = narrowed(self.sector, (to.0 / reach, to.1 / reach), NEAR / reach) else {
                return false;
            };
            self.sector = Some(sector);
        }
        (self.last, self.reach) = (point, reach);
        true
    }
}

/// The part of a sector within the angle of this sine around a direction; `None` if the direction is not in the sector.
fn narrowed(sector: Option<(Point, Point)>, to: Point, sine: f64) -> Option<(Point, Point)> {
    let turned = |sine: f64| {
        let cosine = (1.0 - sine * sine).sqrt();
        (to.0 * cosine - to.1 * sine, to.0 * sine + to.1 * cosine)
    };
    let around = (turned(-sine), turned(sine));
    let Some((from, until)) = sector else { return Some(around) };
    if cross(from, to) < 0.0 || cross(to, until) < 0.0 {
        return None;
    }
    let later = if cross(from, around.0) > 0.0 { around.0 } else { from };
    let sooner = if cross(around.1, until) > 0.0 { around.1 } else { until };
    Some((later, sooner))
}

fn cross(a: Point, b: Point) -> f64 {
    a.0 * b.1 - a.1 * b.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance of a point from a segment.
    fn distance(point: Point, from: Point, to: Point) -> f64 {
        let along = (to.0 - from.0, to.1 - from.1);
        let length = along.0.hypot(along.1).max(1e-12);
        let away = (point.0 - from.0, point.1 - from.1);
        let part = ((away.0 * along.0 + away.1 * along.1) / length.powi(2)).clamp(0.0, 1.0);
        (away.0 - part * along.0).hypot(away.1 - part * along.1)
    }

    /// No point is farther from the piece of the line that passes it than the bound, which holds for distances from the
    /// infinite line; from its ends rounding is added.
    fn is_close(points: &[Point], kept: &[Point]) -> bool {
        let mut pieces = kept.windows(2);
        let mut piece = pieces.next().expect("two points are kept");
        points.iter().all(|&point| {
            while distance(point, piece[0], piece[1]) > NEAR + 1e-9 {
                let Some(next) = pieces.next() else { return false };
                piece = next;
            }
            true
        })
    }

    #[test]
    fn a_smooth_curve_keeps_few_points_and_its_place() {
        let points: Vec<Point> =
            (0..4000).map(|i| 0.15 * f64::from(i)).map(|x| (x, 200.0 * (0.02 * x).sin())).collect();
        let kept = simplified(&points);
        // An arc of curvature c strays by 0.02 from a chord of length (8 · 0.02 / c)^(1/2): 1.4 where c is 0.08.
        assert!((100..500).contains(&kept.len()), "{}", kept.len());
        assert!(is_close(&points, &kept));
        assert_eq!((kept[0], kept[kept.len() - 1]), (points[0], points[3999]));
    }

    #[test]
    fn corners_and_returns_stay() {
        let teeth: Vec<Point> =
            (0..600).map(|i| (f64::from(i / 2), if i % 4 < 2 { 0.0 } else { 100.0 })).collect();
        assert!(is_close(&teeth, &simplified(&teeth)));
        // There and back on one line, not all the way.
        let back = [(0.0, 0.0), (5.0, 0.0), (10.0, 0.0), (7.0, 0.0), (3.0, 0.0)];
        assert_eq!(simplified(&back), [(0.0, 0.0), (10.0, 0.0), (3.0, 0.0)]);
    }

    #[test]
    fn points_on_straight_lines_are_left_out_and_others_keep_all_digits() {
        let tooth = |i: i32| (0.1 * f64::from(i), 0.3 * f64::from(i % 100));
        let teeth: Vec<Point> = (0..400).map(tooth).collect();
        let kept = bends(&teeth, (40.0, 30.0));
        assert_eq!(kept, [0, 99, 100, 199, 200, 299, 300, 399].map(tooth));
        // A bend of a hundred-thousandth of the height is not straight.
        let bent = [(0.0, 0.0), (1.0, 1e-5), (2.0, 0.0)];
        assert_eq!(bends(&bent, (2.0, 1.0)), bent);
        assert_eq!(bends(&[], (0.0, 0.0)), []);
    }

    #[test]
    fn random_walks_stay_within_the_bound() {
        let mut state = 1_u64;
        let mut step = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        for size in [0.001, 0.01, 0.1, 10.0] {
            let mut at = (0.0, 0.0);
            let walk: Vec<Point> = (0..2000)
                .map(|_| {
                    at = (at.0 + size * step(), at.1 + size * step());
                    at
                })
                .collect();
            assert!(is_close(&walk, &simplified(&walk)), "{size}");
        }
    }

    #[test]
    fn short_lines_stay() {
        assert_eq!(simplified(&[]), []);
        assert_eq!(simplified(&[(1.0, 2.0)]), [(1.0, 2.0)]);
        assert_eq!(simplified(&[(1.0, 2.0), (1.0, 2.0)]), [(1.0, 2.0), (1.0, 2.0)]);
    }
}
