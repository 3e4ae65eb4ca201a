//! The highest point and the steepest fall of a curve that is smooth between knots.

use crate::numerics::roots::{brent_minimum, brent_root};

/// Pieces into which the searched interval is cut.
const PIECES: usize = 800;

/// Where to look for the extrema of a curve with steps of scale `width` around `middle`.
pub(super) fn window(middle: f64, width: f64) -> Vec<f64> {
    let (start, end) = ((middle - 12.0 * width).max(0.0), middle + 12.0 * width);
    (0..=PIECES).map(|i| start + (end - start) * i as f64 / PIECES as f64).collect()
}

/// The highest maximum of `force` inside `grid`, as (place, value); every knot must be in the grid.
pub(super) fn highest(
    force: impl Fn(f64) -> f64,
    slope: impl Fn(f64) -> f64,
    grid: &[f64],
) -> Option<(f64, f64)> {
    let mut rising = slope(grid[0]) > 0.0;
    let mut best: Option<(f64, f64)> = None;
    for piece in grid.windows(2) {
        let (start, end) = (piece[0], piece[1]);
        // The slope may jump at a knot: its sign is taken on both sides, since a maximum may be a
        // cusp.
        let before = slope(end.next_down()) > 0.0;
        let after = slope(end) > 0.0;
        let top = match (rising, before, after) {
            (true, false, _) => brent_root(&slope, start, end.next_down(), 0.0),
            (_, true, false) => Some(end),
            _ => None,
        };
        if let Some(top) = top.map(|x| (x, force(x))) {
            best = best.filter(|b| b.1 >= top.1).or(Some(top));
        }
        rising = after;
    }
    best
}

/// max(0, −min F') inside `grid`; every knot must be in the grid.
pub(super) fn steepest_fall(slope: impl Fn(f64) -> f64, grid: &[f64]) -> f64 {
    let ends = |piece: &[f64]| slope(piece[0]).min(slope(piece[1].next_down()));
    let lowest = (0..grid.len() - 1)
        .min_by(|&i, &j| ends(&grid[i..i + 2]).total_cmp(&ends(&grid[j..j + 2])))
        .unwrap_or(0);
    let near = lowest.saturating_sub(1)..(lowest + 2).min(grid.len() - 1);
    let inside = near.map(|i| {
        let piece = &grid[i..i + 2];
        let (_, value) = brent_minimum(&slope, piece[0], piece[1].next_down(), 1e-9 * piece[1]);
        value.min(ends(piece))
    });
    -inside.fold(0.0, f64::min)
}
