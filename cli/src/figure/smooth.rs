//! Smooth curves through computed points: piecewise cubic Hermite interpolation that keeps the order of neighbouring values.

use super::curve::Point;

/// Points of the curve from one computed point to the next.
const FINE: usize = 24;

/// The curve through points with ascending positive abscissae, smooth on a logarithmic axis.
pub fn along_logarithm(x: &[f64], y: &[f64]) -> Vec<Point> {
    let points = x.iter().map(|x| x.ln()).zip(y.iter().copied()).filter(|point| point.1.is_finite());
    smooth(&points.collect::<Vec<_>>()).into_iter().map(|(x, y)| (x.exp(), y)).collect()
}

/// The curve through points with ascending abscissae. Between two points it lies between their ordinates, so that it has
/// extrema only at computed points.
///
/// Slopes at points are those of F. N. Fritsch and J. Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984).
pub fn smooth(points: &[Point]) -> Vec<Point> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let slopes = slopes(points);
    let pieces = points.windows(2).zip(slopes.windows(2));
    let inner =
        pieces.flat_map(|(ends, slopes)| (0..FINE).map(|i| cubic(ends, slopes, i as f64 / FINE as f64)));
    inner.chain(points.last().copied()).collect()
}

/// The cubic with these ends and slopes, at a part of the way.
fn cubic(ends: &[Point], slopes: &[f64], t: f64) -> Point {
    let (a, b) = (ends[0], ends[1]);
    let step = b.0 - a.0;
    let (up, rest) = (t * t * (3.0 - 2.0 * t), 1.0 - t);
    let bend = step * t * rest * (slopes[0] * rest - slopes[1] * t);
    (a.0 + t * step, a.1 + up * (b.1 - a.1) + bend)
}

/// The slopes at the points: 0 at extrema, weighted harmonic means of those of both sides elsewhere.
fn slopes(points: &[Point]) -> Vec<f64> {
    let steps: Vec<f64> = points.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    let chords: Vec<f64> =
        points.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)).collect();
    let inner = |i: usize| {
        let (before, after) = (chords[i - 1], chords[i]);
        if before * after <= 0.0 {
            return 0.0;
        }
        let weights = (steps[i - 1] + 2.0 * steps[i], 2.0 * steps[i - 1] + steps[i]);
        (weights.0 + weights.1) / (weights.1 / before + weights.0 / after)
    };
    let last = chords.len() - 1;
    let first = end((steps[0], steps[1]), (chords[0], chords[1]));
    let end = end((steps[last], steps[last - 1]), (chords[last], chords[last - 1]));
    std::iter::once(first).chain((1..=last).map(inner)).chain([end]).collect()
}

/// The slope at an end: that of the parabola through three points, unless it would overshoot.
fn end(steps: (f64, f64), chords: (f64, f64)) -> f64 {
    let slope = ((2.0 * steps.0 + steps.1) * chords.0 - steps.0 * chords.1) / (steps.0 + steps.1);
    if slope * chords.0 <= 0.0 {
        0.0
    } else if chords.0 * chords.1 <= 0.0 && slope.abs() > 3.0 * chords.0.abs() {
        3.0 * chords.0
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The interpolation is close to a smooth function between the points that it meets.
    #[test]
    fn a_smooth_function_is_met_between_its_points() {
        let at = |i: usize| 0.25 * i as f64;
        let points: Vec<Point> = (0..=8).map(|i| (at(i), at(i).exp())).collect();
        let curve = smooth(&points);
        let met = |point: &Point| curve.iter().any(|p| (p.0 - point.0).abs() + (p.1 - point.1).abs() < 1e-12);
        assert!(points.iter().all(met));
        let worst = curve.iter().map(|(x, y)| (y / x.exp() - 1.0).abs()).fold(0.0, f64::max);
        // Slopes of second order give errors of h³ / 12 = 1.3e-3 with h = 1/4; straight pieces are off by h² / 8 = 7.8e-3.
        assert!(worst < 1.5e-3, "{worst}");
    }

    #[test]
    fn nothing_overshoots() {
        let points = [(0.0, 0.0), (1.0, 0.0), (1.5, 3.0), (4.0, 3.1), (5.0, 1.0)];
        let curve = smooth(&points);
        for pair in points.windows(2) {
            let ends = (pair[0].1.min(pair[1].1) - 1e-12)..=(pair[0].1.max(pair[1].1) + 1e-12);
            let between: Vec<_> = curve.iter().filter(|p| (pair[0].0..=pair[1].0).contains(&p.0)).collect();
            assert!(between.len() > FINE && between.iter().all(|p| ends.contains(&p.1)));
        }
        assert_eq!(smooth(&points[..2]), points[..2]);
    }
}
