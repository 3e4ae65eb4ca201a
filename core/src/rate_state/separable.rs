//! Least squares of a curve y = offset + size s(x/scale), by variable projection.

use crate::numerics::linear::solve;
use crate::numerics::roots::brent_minimum;

/// Number of trial scales before the best one is refined.
const CANDIDATES: usize = 60;

/// A curve s(z) and its slope.
pub(super) struct FitShape {
    pub value: fn(f64) -> f64,
    pub slope: fn(f64) -> f64,
}

/// e^{−z}.
pub(super) const DECAY: FitShape = FitShape { value: |z| (-z).exp(), slope: |z| -(-z).exp() };

/// ln(1 + z).
pub(super) const GROWTH: FitShape = FitShape { value: f64::ln_1p, slope: |z| 1.0 / (1.0 + z) };

/// The fit y = offset + size s(x/scale).
pub(super) struct SeparableFit {
    pub offset: f64,
    pub size: f64,
    pub scale: f64,
    squares: f64,
    points: usize,
}

impl SeparableFit {
    /// Least squares, with a scale between `low` and `high`: linear in offset and size for each scale.
    pub fn of(shape: &FitShape, x: &[f64], y: &[f64], (low, high): (f64, f64)) -> Option<Self> {
        if x.len() < 4 || x.len() != y.len() || !(low > 0.0 && high.is_finite()) {
            return None;
        }
        let best = |scale: f64| linear(x.iter().map(|x| (shape.value)(x / scale)), y);
        let scale = nearest_scale(|scale| best(scale).map_or(f64::INFINITY, |fit| fit.2), (low, high))?;
        let (offset, size, squares) = best(scale)?;
        // A singular matrix: the values do not determine all three numbers.
        let gradients = x.iter().map(|x| gradient(shape, size, scale, *x));
        solve(normal(gradients), [1.0; 3])?;
        Some(Self { offset, size, scale, squares, points: x.len() })
    }

    /// Root mean square of the residuals.
    pub fn residual(&self) -> f64 {
        (self.squares / self.points as f64).sqrt()
    }
}

/// The scale between `low` and `high` with the smallest sum of squares. A scan comes first, as there may be
/// several minima.
pub(super) fn nearest_scale(squares: impl Fn(f64) -> f64, (low, high): (f64, f64)) -> Option<f64> {
    let step = (high / low).ln() / CANDIDATES as f64;
    // Both ends are candidates as they are.
    let candidate = |i: usize| if i == CANDIDATES { high } else { low * (step * i as f64).exp() };
    let candidates = (0..=CANDIDATES).map(|i| (candidate(i), squares(candidate(i))));
    let (nearest, lowest) = candidates.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let [from, to] = [(nearest.ln() - step).max(low.ln()), (nearest.ln() + step).min(high.ln())];
    let (log, least) = brent_minimum(|log: f64| squares(log.exp()), from, to, 1e-10);
    Some(if lowest <= least { nearest } else { log.exp() })
}

/// Derivatives of the fitted curve at x with respect to offset, size and scale.
pub(super) fn gradient(shape: &FitShape, size: f64, scale: f64, x: f64) -> [f64; 3] {
    let z = x / scale;
    [1.0, (shape.value)(z), -size * (shape.slope)(z) * z / scale]
}

/// Linear regression of y on a column: offset, size and the sum of squared residuals.
pub(super) fn linear(column: impl Iterator<Item = f64> + Clone, y: &[f64]) -> Option<(f64, f64, f64)> {
    let rows = || column.clone().map(|c| [1.0, c]).zip(y);
    let right = rows().fold([0.0; 2], |sum, (row, y)| [sum[0] + y * row[0], sum[1] + y * row[1]]);
    let [offset, size] = solve(normal(rows().map(|row| row.0)), right)?;
    let squares = rows().map(|(row, y)| (y - offset - size * row[1]).powi(2)).sum();
    Some((offset, size, squares))
}

/// Σ g gᵀ, the matrix of the normal equations.
fn normal<const N: usize>(rows: impl Iterator<Item = [f64; N]>) -> [[f64; N]; N] {
    rows.fold([[0.0; N]; N], |sum, row| {
        std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + row[i] * row[j]))
    })
}
