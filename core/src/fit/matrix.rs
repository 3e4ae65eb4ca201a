//! Small matrices: steps of the search, the covariance of the estimates, and what the data do not determine.

use faer::linalg::matmul::matmul;
use faer::prelude::Solve;
use faer::{Accum, Mat, MatRef, Par, Side};

use super::score::Score;

/// AB on one thread: others would sum in another order, and wait longer than they work where a matrix is narrow.
pub(super) fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut product = Mat::zeros(a.nrows(), b.ncols());
    matmul(product.as_mut(), Accum::Replace, a, b, 1.0, Par::Seq);
    product
}

/// aᵀb of two columns.
pub(super) fn inner(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    product(a.transpose(), b.as_ref())[(0, 0)]
}

/// −(I + λ diag I)⁻¹ times the slope, of the `active` numbers; 0 for the others, and for numbers without information.
pub(super) fn damped_step(score: &Score, active: &[usize], damping: f64) -> Option<Mat<f64>> {
    let active: Vec<usize> = active.iter().copied().filter(|&k| score.information[(k, k)] > 0.0).collect();
    let mut step = Mat::zeros(score.slope.nrows(), 1);
    if active.is_empty() {
        return Some(step);
    }
    let scale = |k: usize| score.information[(k, k)].sqrt();
    let scaled = scaled(&score.information, &active);
    // Numbers that are not determined on their own move together, as little as possible.
    let least = 1e-12;
    let damped = Mat::from_fn(active.len(), active.len(), |i, j| {
        scaled[(i, j)] + if i == j { damping + least } else { 0.0 }
    });
    let right = Mat::from_fn(active.len(), 1, |i, _| -score.slope[(active[i], 0)] / scale(active[i]));
    let solved = damped.llt(Side::Lower).ok()?.solve(&right);
    for (i, &k) in active.iter().enumerate() {
        step[(k, 0)] = solved[(i, 0)] / scale(k);
    }
    Some(step)
}

/// The fall of the deviance over a step h that slope g and information I let expect, −2gᵀh − hᵀIh.
pub(super) fn expected_fall(score: &Score, step: &[f64]) -> f64 {
    let step = Mat::from_fn(step.len(), 1, |i, _| step[i]);
    -2.0 * inner(&step, &score.slope) - inner(&step, &(&score.information * &step))
}

/// The information of the `active` numbers in units that make its diagonal 1.
pub(super) fn scaled(information: &Mat<f64>, active: &[usize]) -> Mat<f64> {
    let scale = |k: usize| information[(k, k)].sqrt();
    Mat::from_fn(active.len(), active.len(), |i, j| {
        information[(active[i], active[j])] / (scale(active[i]) * scale(active[j]))
    })
}

/// The directions in the `active` numbers, in units of their information, whose eigenvalue is below `least`.
pub(super) fn undetermined(information: &Mat<f64>, active: &[usize], least: f64) -> Vec<Vec<f64>> {
    let Ok(eigen) = scaled(information, active).self_adjoint_eigen(Side::Lower) else { return Vec::new() };
    let (values, vectors) = (eigen.S(), eigen.U());
    let direction = |k: usize| (0..active.len()).map(|i| vectors[(i, k)]).collect();
    (0..active.len()).filter(|&k| values[k] < least).map(direction).collect()
}

/// The inverse of the information of the `active` numbers; 0 for the others.
pub(super) fn covariance(information: &Mat<f64>, active: &[usize]) -> Option<Mat<f64>> {
    let n = information.nrows();
    let mut all = Mat::zeros(n, n);
    let factor = scaled(information, active).llt(Side::Lower).ok()?;
    let inverse = factor.solve(Mat::<f64>::identity(active.len(), active.len()));
    let scale = |k: usize| information[(k, k)].sqrt();
    for (i, &a) in active.iter().enumerate() {
        for (j, &b) in active.iter().enumerate() {
            all[(a, b)] = inverse[(i, j)] / (scale(a) * scale(b));
        }
    }
    Some(all)
}

/// tr P I⁻¹ over the `active` numbers, also where some are hardly determined: directions whose eigenvalue is below 1e-13 of
/// the largest, in units that make the diagonal of I 1, count as if they had that of this limit. P is to be small in them.
pub(super) fn trace_with_inverse(
    penalty: &Mat<f64>,
    information: &Mat<f64>,
    active: &[usize],
) -> Option<f64> {
    const LEAST: f64 = 1e-13;
    let eigen = scaled(information, active).self_adjoint_eigen(Side::Lower).ok()?;
    let (values, vectors) = (eigen.S(), eigen.U());
    let least = LEAST * (0..active.len()).map(|k| values[k]).fold(0.0, f64::max);
    let scale = |k: usize| information[(k, k)].sqrt();
    let relative = Mat::from_fn(active.len(), active.len(), |i, j| {
        penalty[(active[i], active[j])] / (scale(active[i]) * scale(active[j]))
    });
    let along = vectors.transpose() * relative * vectors;
    Some((0..active.len()).map(|k| along[(k, k)] / values[k].max(least)).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strong_penalty_takes_all_but_its_null_space() {
        // The data say 1 of each of twelve numbers, second differences are penalised: tr P I⁻¹ is (12 − 2)/λ.
        let mut penalty = Mat::<f64>::zeros(12, 12);
        for first in 0..10 {
            for (a, wa) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                for (b, wb) in [1.0, -2.0, 1.0].into_iter().enumerate() {
                    penalty[(first + a, first + b)] += wa * wb;
                }
            }
        }
        let active: Vec<usize> = (0..12).collect();
        for strength in [1e9, 1e15, 1e18] {
            let information = &penalty * faer::Scale(strength) + Mat::<f64>::identity(12, 12);
            let trace = trace_with_inverse(&penalty, &information, &active).unwrap();
            // Rounding of 1e-16 in the null space, against the smallest eigenvalue of 1e-13 that counts, twelve times.
            assert!((strength * trace - 10.0).abs() < 0.02, "{strength:e}: {}", strength * trace);
        }
    }
}
