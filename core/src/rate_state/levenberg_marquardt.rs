//! Least squares by the method of Levenberg and Marquardt, with derivatives by differences (K. Levenberg, Q. Appl. Math. 2, 164
//! (1944); D. W. Marquardt, J. Soc. Ind. Appl. Math. 11, 431 (1963)).

use crate::Result;
use crate::monitor::{Aside, Monitor, report};
use crate::numerics::linear::solve;

/// Largest number of iterations: along a narrow curved valley, as that of b and D of peaks by the slip law, they are many.
const ITERATIONS: usize = 1000;

/// Relative change of the sum of squares at which the iterations end.
const SETTLED: f64 = 1e-8;

/// Change of a logarithm by which derivatives are found: the error of the integration over the change, and its square, are
/// both some 1e-4.
pub(super) const CHANGE: f64 = 1e-4;

/// The values of N parameters with the least sum of squares of the `residuals`, and that sum. Derivatives are found with these
/// `changes` of the parameters; one whose change is 0 keeps its value. `None` if there are no residuals at the start.
///
/// # Errors
/// A stop by the monitor.
pub(super) fn least_squares<const N: usize>(
    start: [f64; N],
    changes: [f64; N],
    residuals: impl Fn(&[f64; N]) -> Option<Vec<f64>>,
    monitor: &mut dyn Monitor,
) -> Result<Option<([f64; N], f64)>> {
    let sum = |residuals: &[f64]| residuals.iter().map(|r| r * r).sum::<f64>();
    let mut values = start;
    let Some(mut left) = residuals(&values) else { return Ok(None) };
    let (mut squares, mut damping) = (sum(&left), 1e-3);
    for _ in 0..ITERATIONS {
        let Some(slopes) = slopes(&values, &changes, &left, &residuals) else { break };
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let normal: [[f64; N]; N] =
            std::array::from_fn(|i| std::array::from_fn(|j| product(&slopes[i], &slopes[j])));
        let right: [f64; N] = std::array::from_fn(|i| -product(&slopes[i], &left));
        let before = squares;
        let mut improved = false;
        while damping < 1e10 {
            report(monitor, 0.0)?;
            let step = solve(damped(normal, damping), right);
            let trial = step.map(|step| std::array::from_fn(|i| values[i] + step[i]));
            let tried = trial.and_then(|trial| Some((trial, residuals(&trial)?)));
            if let Some((trial, tried)) = tried.filter(|(_, tried)| sum(tried) < squares) {
                (values, squares, left) = (trial, sum(&tried), tried);
                damping = (0.1 * damping).max(1e-12);
                improved = true;
                break;
            }
            damping *= 10.0;
        }
        if !improved || before - squares <= SETTLED * squares {
            break;
        }
    }
    Ok(Some((values, squares)))
}

/// The fit with the least sum of squares of those that `fit` finds from each of `starts`: its values, and that sum.
///
/// # Errors
/// Those of `fit`; a stop by the monitor.
pub(super) fn best_of<S, V>(
    starts: &[S],
    monitor: &mut dyn Monitor,
    fit: impl Fn(&S, &mut dyn Monitor) -> Result<Option<(V, f64)>>,
) -> Result<Option<(V, f64)>> {
    let mut best: Option<(V, f64)> = None;
    for (i, start) in starts.iter().enumerate() {
        let found = fit(start, &mut Aside { fraction: i as f64 / starts.len() as f64, monitor })?;
        if found.as_ref().is_some_and(|found| best.as_ref().is_none_or(|best| found.1 < best.1)) {
            best = found;
        }
    }
    report(monitor, 1.0)?;
    Ok(best)
}

/// The matrix of the normal equations with a larger diagonal, by which a parameter that nothing depends on stays as it is.
fn damped<const N: usize>(mut normal: [[f64; N]; N], damping: f64) -> [[f64; N]; N] {
    for (i, row) in normal.iter_mut().enumerate() {
        row[i] = if row[i] == 0.0 { 1.0 } else { row[i] * (1.0 + damping) };
    }
    normal
}

/// Derivatives of the residuals by the parameters, by differences; `None` where there are no residuals.
fn slopes<const N: usize>(
    values: &[f64; N],
    changes: &[f64; N],
    left: &[f64],
    residuals: &impl Fn(&[f64; N]) -> Option<Vec<f64>>,
) -> Option<[Vec<f64>; N]> {
    let mut slopes = std::array::from_fn(|_| vec![0.0; left.len()]);
    for (i, slopes) in slopes.iter_mut().enumerate().filter(|(i, _)| changes[*i] != 0.0) {
        let mut beside = *values;
        beside[i] += changes[i];
        let other = residuals(&beside)?;
        *slopes = other.iter().zip(left).map(|(a, b)| (a - b) / changes[i]).collect();
    }
    Some(slopes)
}
