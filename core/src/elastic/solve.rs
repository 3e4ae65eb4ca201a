//! Response of coupled cells that are held by springs of different stiffness.

use super::batch::{all, change, largest, sum};
use super::coupling::Coupling;

/// Steps after which no more is expected.
const MOST_STEPS: usize = 100;

/// Solves (springs + A) δ = right by conjugate gradients, the response of cells on equal springs being the
/// preconditioner, until no force larger than `goal` is left. Whether the matrix was found to be positive definite; if
/// not, `right` is of no use.
///
/// A matrix with off-diagonals ≤ 0 that is positive definite answers forces ≥ 0 by advances ≥ 0, so that others are
/// found by what they answer, too.
pub(super) fn solve<C: Coupling + ?Sized>(
    coupling: &mut C,
    springs: &[f64],
    right: &mut [f64],
    goal: f64,
) -> bool {
    let number = right.len();
    let forward = all(number, |j| right[j] >= 0.0);
    let begun = largest(number, |j| right[j].abs());
    if begun == 0.0 {
        return true;
    }
    let mean = sum(number, |j| springs[j].abs()) / number as f64;
    let (mut answer, mut way) = (vec![0.0; number], right.to_vec());
    let exact = coupling.near(mean, &mut way);
    // What holds them on equal springs, (mean + A) way.
    let mut held = right.to_vec();
    let mut product = sum(number, |j| right[j] * way[j]);
    let mut near = vec![0.0; number];
    for _ in 0..MOST_STEPS {
        if !exact {
            coupling.forces(&way, &mut held);
            change(&mut held, |j, force| mean * way[j] - force);
        }
        let pull = |j: usize| held[j] + (springs[j] - mean) * way[j];
        let curvature = sum(number, |j| way[j] * pull(j));
        if curvature.is_nan() || curvature <= 0.0 {
            return false;
        }
        let length = product / curvature;
        change(&mut answer, |j, answer| answer + length * way[j]);
        change(right, |j, force| force - length * pull(j));
        if largest(number, |j| right[j].abs()) <= goal {
            break;
        }
        near.copy_from_slice(right);
        coupling.near(mean, &mut near);
        let before = std::mem::replace(&mut product, sum(number, |j| right[j] * near[j]));
        let turn = product / before;
        change(&mut way, |j, way| near[j] + turn * way);
        if exact {
            change(&mut held, |j, held| right[j] + turn * held);
        }
    }
    right.copy_from_slice(&answer);
    let least = -(goal / begun).sqrt() * largest(number, |j| right[j]);
    !forward || all(number, |j| right[j] >= least)
}
