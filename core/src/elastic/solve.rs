//! Response of coupled cells that are held by springs of different stiffness.

use super::batch::{all, change, fill, largest, sum};
use super::coupling::Coupling;

/// What is left of the largest force, of what it was.
const PRECISION: f64 = 1e-7;

/// Steps after which no more is expected.
const MOST_STEPS: usize = 400;

/// Solves (springs + A) δ = right by conjugate gradients, the response of cells on equal springs being the
/// preconditioner. Whether the matrix was found to be positive definite; if not, `right` is of no use.
///
/// A matrix with off-diagonals ≤ 0 that is positive definite answers forces ≥ 0 by advances ≥ 0, so that others are
/// found by what they answer, too.
pub(super) fn solve<C: Coupling + ?Sized>(coupling: &mut C, springs: &[f64], right: &mut [f64]) -> bool {
    let number = right.len();
    let forward = all(number, |j| right[j] >= 0.0);
    let goal = PRECISION * largest(number, |j| right[j].abs());
    if goal == 0.0 {
        return true;
    }
    let mean = sum(number, |j| springs[j].abs()) / number as f64;
    let (mut answer, mut way) = (vec![0.0; number], vec![0.0; number]);
    let mut held = right.to_vec();
    coupling.near(mean, &mut held);
    way.copy_from_slice(&held);
    let mut product = sum(number, |j| right[j] * held[j]);
    for _ in 0..MOST_STEPS {
        // held = (springs + A) way.
        coupling.forces(&way, &mut held);
        change(&mut held, |j, force| springs[j] * way[j] - force);
        let curvature = sum(number, |j| way[j] * held[j]);
        if curvature.is_nan() || curvature <= 0.0 {
            return false;
        }
        let length = product / curvature;
        change(&mut answer, |j, answer| answer + length * way[j]);
        change(right, |j, force| force - length * held[j]);
        if largest(number, |j| right[j].abs()) <= goal {
            break;
        }
        fill(&mut held, |j| right[j]);
        coupling.near(mean, &mut held);
        let before = std::mem::replace(&mut product, sum(number, |j| right[j] * held[j]));
        change(&mut way, |j, way| held[j] + product / before * way);
    }
    right.copy_from_slice(&answer);
    let least = -PRECISION.sqrt() * largest(number, |j| right[j]);
    !forward || all(number, |j| right[j] >= least)
}
