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
    /// Root of the weighted mean of the squared residuals.
    pub residual: f64,
}

impl SeparableFit {
    /// Least squares of `y` at `x`, each with its weight, and a scale between `low` and `high`: linear in offset and size for each
    /// scale.
    pub fn of(
        shape: &FitShape,
        x: &[f64],
        (y, weights): (&[f64], &[f64]),
        (low, high): (f64, f64),
    ) -> Option<Self> {
        if x.len() < 4 || x.len() != y.len() || !(low > 0.0 && high.is_finite()) {
            return None;
        }
        let best = |scale: f64| {
            let column: Vec<f64> = x.iter().map(|x| (shape.value)(x / scale)).collect();
            linear(&column, y, weights)
        };
        let scale = nearest_scale(|scale| best(scale).map_or(f64::INFINITY, |fit| fit.2), (low, high))?;
        let (offset, size, squares) = best(scale)?;
        // A singular matrix: the values do not determine all three numbers.
        let gradients = x.iter().map(|x| gradient(shape, size, scale, *x));
        solve(normal(gradients), [1.0; 3])?;
        let residual = (squares / weights.iter().sum::<f64>()).sqrt();
        Some(Self { offset, size, scale, residual })
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

/// Linear regression of `y` on a column, with weights: offset, size and the weighted sum of squared residuals.
pub(super) fn linear(column: &[f64], y: &[f64], weights: &[f64]) -> Option<(f64, f64, f64)> {
    let points = || column.iter().zip(y).zip(weights).map(|((c, y), weight)| (*c, *y, *weight));
    let right = points().fold([0.0; 2], |sum, (c, y, weight)| [sum[0] + weight * y, sum[1] + weight * y * c]);
    let rows = points().map(|(c, _, weight)| [1.0, c].map(|entry| weight.sqrt() * entry));
    let [offset, size] = solve(normal(rows), right)?;
    let squares = points().map(|(c, y, weight)| weight * (y - offset - size * c).powi(2)).sum();
    Some((offset, size, squares))
}

/// Σ g gᵀ, the matrix of the normal equations.
fn normal<const N: usize>(rows: impl Iterator<Item = [f64; N]>) -> [[f64; N]; N] {
    rows.fold([[0.0; N]; N], |sum, row| {
        std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j] + row[i] * row[j]))
    })
}
