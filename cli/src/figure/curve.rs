//! Curves thinned to fewer points without visible change.

use kuva::plot::{LinePlot, ScatterPlot};
use kuva::render::plots::Plot;

/// Largest number of points of a drawn curve: two for every dot of the width of a picture.
const MOST: usize = 4000;

/// A point of a curve.
pub type Point = (f64, f64);

/// The curve through `x` and `y`, thinned.
pub fn curve(x: &[f64], y: &[f64]) -> Vec<Point> {
    thinned(x.iter().copied().zip(y.iter().copied()).filter(|p| p.1.is_finite()).collect())
}

/// Keeps first, last, highest and lowest point of every group, so that no extremum is lost.
pub fn thinned(points: Vec<Point>) -> Vec<Point> {
    if points.len() <= MOST {
        return points;
    }
    let run = points.len().div_ceil(MOST / 4);
    points.chunks(run).flat_map(outline).collect()
}

fn outline(run: &[Point]) -> Vec<Point> {
    let by_height = |&a: &usize, &b: &usize| run[a].1.total_cmp(&run[b].1);
    let lowest = (0..run.len()).min_by(by_height).unwrap_or(0);
    let highest = (0..run.len()).max_by(by_height).unwrap_or(0);
    let mut kept = vec![0, lowest, highest, run.len() - 1];
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|i| run[i]).collect()
}

/// The pieces of a curve below `top`, cut where it crosses.
pub fn below(points: &[Point], top: f64) -> Vec<Vec<Point>> {
    let mut pieces: Vec<Vec<Point>> = vec![Vec::new()];
    for pair in points.windows(2) {
        let (a, b) = (pair[0], pair[1]);
        let piece = pieces.last_mut().expect("there is always one");
        if a.1 <= top {
            piece.push(a);
        }
        if (a.1 <= top) != (b.1 <= top) {
            piece.push((a.0 + (b.0 - a.0) * (top - a.1) / (b.1 - a.1), top));
            if b.1 > top {
                pieces.push(Vec::new());
            }
        }
    }
    if let Some(&last) = points.last().filter(|p| p.1 <= top) {
        pieces.last_mut().expect("there is always one").push(last);
    }
    pieces.retain(|p| p.len() > 1);
    pieces
}

/// A line plot, dashed if a pattern is given.
pub fn line(points: Vec<Point>, color: &str, width: f64, dashes: Option<&str>) -> Plot {
    let plot = LinePlot::new().with_data(points).with_color(color).with_stroke_width(width);
    Plot::Line(match dashes {
        Some(dashes) => plot.with_line_style(kuva::plot::LineStyle::Custom(dashes.to_owned())),
        None => plot,
    })
}

/// A density as a line; none where all is in point masses, which stems show.
pub fn density_line(x: &[f64], density: &[f64], color: &str, width: f64) -> Option<Plot> {
    let is_there = density.iter().any(|&height| height > 0.0);
    is_there.then(|| line(curve(x, density), color, width, None))
}

/// Points, with error bars if there are errors.
pub fn errors(x: &[f64], y: &[f64], error: &[f64], color: &str) -> Vec<Plot> {
    let points = || x.iter().zip(y);
    let bar = |((&x, &y), &error): ((&f64, &f64), &f64)| {
        line(vec![(x, y - error), (x, y + error)], color, 1.4, None)
    };
    let markers = ScatterPlot::new().with_data(points().map(|(&x, &y)| (x, y)));
    let markers = Plot::Scatter(markers.with_color(color).with_size(2.6));
    points().zip(error).map(bar).chain([markers]).collect()
}

/// A bin of a histogram: its place, its density, and how many values are in it.
pub type Counted = (f64, f64, f64);

/// A histogram on logarithmic axes as points, with the standard errors √n of n counts, down to the lower end of the axis.
pub fn counted(points: &[Counted], low: f64, color: &str) -> Vec<Plot> {
    let bar = |&(x, density, count): &Counted| {
        let error = density / count.sqrt();
        line(vec![(x, (density - error).max(low)), (x, density + error)], color, 1.4, None)
    };
    let markers = ScatterPlot::new().with_data(points.iter().map(|&(x, density, _)| (x, density)));
    let markers = Plot::Scatter(markers.with_color(color).with_size(3.0));
    points.iter().map(bar).chain([markers]).collect()
}

/// The computed points of a smooth curve, if they can be distinguished.
pub fn computed(x: &[f64], y: &[f64], color: &str) -> Plot {
    const MOST: usize = 60;
    let shown = if x.len() > MOST { Vec::new() } else { curve(x, y) };
    Plot::Scatter(ScatterPlot::new().with_data(shown).with_color(color).with_size(2.4))
}

/// The indices of points of a curve that are evenly spaced along it in a picture of these ranges, so that no period of it is
/// passed over. The first and the last are among them.
pub fn spread(points: &[Point], (x, y): ((f64, f64), (f64, f64)), most: usize) -> Vec<usize> {
    let length = |pair: &[Point]| {
        let (right, up) = ((pair[1].0 - pair[0].0) / (x.1 - x.0), (pair[1].1 - pair[0].1) / (y.1 - y.0));
        right.hypot(up)
    };
    let along: Vec<f64> =
        points.windows(2).map(length).map(|l| if l.is_finite() { l } else { 0.0 }).collect();
    let total: f64 = along.iter().sum();
    let step = (total / (most.max(2) - 1) as f64).max(CLOSEST);
    let (mut shown, mut passed, mut next) = (Vec::new(), 0.0, 0.0);
    for i in 0..points.len() {
        if passed >= next || i + 1 == points.len() {
            shown.push(i);
            next = passed + step;
        }
        passed += along.get(i).copied().unwrap_or(0.0);
    }
    shown
}

/// Smallest distance of the points of a curve that is drawn as points, over the size of the picture.
const CLOSEST: f64 = 0.03;

/// A filled histogram with bins of equal width around `centres`.
pub fn histogram(centres: &[f64], heights: &[f64], color: &str) -> Plot {
    let plot = LinePlot::new().with_data(steps(centres, heights)).with_color(color);
    Plot::Line(plot.with_stroke_width(0.8).with_fill().with_fill_opacity(0.45))
}

/// The outline of a histogram with bins of equal width around `centres`.
fn steps(centres: &[f64], heights: &[f64]) -> Vec<Point> {
    let half = if centres.len() > 1 { 0.5 * (centres[1] - centres[0]) } else { centres[0].max(0.5) };
    let bars = centres.iter().zip(heights);
    let tops = bars.flat_map(|(&c, &h)| [(c - half, h), (c + half, h)]);
    let first = centres.first().map(|&c| (c - half, 0.0));
    let last = centres.last().map(|&c| (c + half, 0.0));
    first.into_iter().chain(tops).chain(last).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_ends_and_extrema() {
        let mut points: Vec<Point> =
            (0..100_000).map(|i| (f64::from(i), (f64::from(i) * 1e-3).sin())).collect();
        points[54_321].1 = 7.0;
        points[54_322].1 = -7.0;
        let kept = thinned(points.clone());
        assert!(kept.len() <= MOST);
        assert!(kept.contains(&(54_321.0, 7.0)) && kept.contains(&(54_322.0, -7.0)));
        assert_eq!((kept.first(), kept.last()), (points.first(), points.last()));
        assert!(kept.is_sorted_by(|a, b| a.0 < b.0));
    }

    #[test]
    fn points_of_a_curve_are_spread_along_it_and_meet_all_of_its_periods() {
        // 25 teeth of height 1, on 2501 points.
        let teeth: Vec<Point> = (0..=2500).map(|i| (f64::from(i), f64::from(i % 100) / 100.0)).collect();
        let shown = spread(&teeth, ((0.0, 2500.0), (0.0, 1.0)), 200);
        assert!(shown.len() <= 201 && shown[0] == 0 && shown[shown.len() - 1] == 2500);
        for tooth in 0..25 {
            let within = shown.iter().filter(|&&i| i / 100 == tooth).count();
            assert!((3..=9).contains(&within), "{tooth}: {within}");
        }
        assert_eq!(spread(&teeth[..1], ((0.0, 1.0), (0.0, 1.0)), 10), [0]);
    }

    #[test]
    fn curves_are_cut_where_they_cross_the_top() {
        let pieces = below(&[(0.0, 0.0), (1.0, 2.0), (2.0, 0.0)], 1.0);
        assert_eq!(pieces, [vec![(0.0, 0.0), (0.5, 1.0)], vec![(1.5, 1.0), (2.0, 0.0)]]);
    }
}
