//! Response of coupled cells that are held by springs of different stiffness.

use super::batch::{all, change, largest, sum, sweep};
use super::coupling::Coupling;

/// Steps after which no more is expected: `goal` has not been met then.
pub(super) const MOST_STEPS: usize = 100;

/// Solves (springs + A) δ = right by conjugate gradients, the response of cells on equal springs being the
/// preconditioner, until no force larger than `goal` is left. How many such responses that took; none if the matrix was
/// found not to be positive definite, `right` being of no use then.
///
/// A matrix with off-diagonals ≤ 0 that is positive definite answers forces ≥ 0 by advances ≥ 0, so that others are
/// found by what they answer, too.
pub(super) fn solve<C: Coupling + ?Sized>(
    coupling: &mut C,
    springs: &[f64],
    right: &mut [f64],
    goal: f64,
) -> Option<usize> {
    let number = right.len();
    let forward = all(number, |j| right[j] >= 0.0);
    let begun = largest(number, |j| right[j].abs());
    if begun == 0.0 {
        return Some(0);
    }
    let mean = sum(number, |j| springs[j].abs()) / number as f64;
    let (mut answer, mut way) = (vec![0.0; number], right.to_vec());
    let exact = coupling.precondition(mean, &mut way);
    // What holds them on equal springs, (mean + A) way.
    let (mut held, mut near) = (right.to_vec(), vec![0.0; number]);
    let add = |a: f64, b: f64| a + b;
    let pull = |way: f64, held: f64, spring: f64| held + (spring - mean) * way;
    let work = |[]: [f64; 0], [way, held, spring]: [f64; 3]| ([], way * pull(way, held, spring));
    let mut product = sweep([], [right, &way], |[], [right, way]| ([], right * way), add);
    let mut curvature = if exact { sweep([], [&way, &held, springs], work, add) } else { 0.0 };
    let mut taken = 1;
    while taken < MOST_STEPS {
        if !exact {
            coupling.forces(&way, &mut held);
            change(&mut held, |j, force| mean * way[j] - force);
            curvature = sweep([], [&way, &held, springs], work, add);
        }
        if curvature.is_nan() || curvature <= 0.0 {
            return None;
        }
        let length = product / curvature;
        let go = |[answer, right, _]: [f64; 3], [way, held, spring]: [f64; 3]| {
            let left = right - length * pull(way, held, spring);
            ([answer + length * way, left, left], left.abs())
        };
        if sweep([&mut answer, right, &mut near], [&way, &held, springs], go, f64::max) <= goal {
            break;
        }
        coupling.precondition(mean, &mut near);
        taken += 1;
        let before = product;
        product = sweep([], [right, &near], |[], [right, near]| ([], right * near), add);
        let turn = product / before;
        if exact {
            let turned = |[way, held]: [f64; 2], [near, right, spring]: [f64; 3]| {
                let (way, held) = (near + turn * way, right + turn * held);
                ([way, held], way * pull(way, held, spring))
            };
            curvature = sweep([&mut way, &mut held], [&near, right, springs], turned, add);
        } else {
            sweep([&mut way], [&near], |[way], [near]| ([near + turn * way], 0.0), add);
        }
    }
    right.copy_from_slice(&answer);
    let least = -(goal / begun).sqrt() * largest(number, |j| right[j]);
    (!forward || all(number, |j| right[j] >= least)).then_some(taken)
}
