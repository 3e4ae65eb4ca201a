//! Preconditioned conjugate gradients for coupled cells on springs of different stiffness.

use super::Coupling;
use crate::Result;
use crate::elastic::batch::{all, change, largest, sum, sweep};
use crate::monitor::{Monitor, report};

/// Residual of a solution with one diagonal for all cells, relative to the largest force: about the rounding error.
const ROUNDED: f64 = 1e-14;

/// Number of iterations after which a solution is given up.
pub const MOST_ITERATIONS: usize = 100;

/// Number of cells from which on the monitor is asked in every iteration: a hundred of them take some hundredths of a second.
const MANY: usize = 1 << 12;

/// [`Coupling::solve_variable`], (d + A) δ = r for a diagonal d, by preconditioned conjugate gradients (M. R. Hestenes and E. Stiefel, J. Res. Natl.
/// Bur. Stand. 49, 409 (1952), doi:10.6028/jres.049.044), until max |r − (d + A) δ| ≤ `goal`; `right` is r on entry, and δ
/// on return. Returns the number of applications of the preconditioner; none if the matrix was found not to be positive
/// definite.
///
/// The preconditioner P is m + A with the mean m of |d|, or near it. P differs from the matrix by d − m only, while A grows
/// with the wave number. So the preconditioned matrix is close to 1 for all but the longest waves, and the number of
/// iterations depends on the spread of d, not on the number of cells. Where P = m + A, the product P p follows each
/// direction p by the recurrence of p, since P z = r for the preconditioned residual z: no product with A is needed.
///
/// A matrix that is not positive definite shows by a direction p with pᵀ(d + A) p ≤ 0, or by the solution: the inverse of a
/// positive definite M-matrix has no negative entry, so that r ≥ 0 has a solution δ ≥ 0. The error of δ, relative to the
/// largest δ, is that of the residual times the condition number, which is not known; the root of the relative residual
/// allows for half of the digits.
pub(super) fn solve_variable<C: Coupling + ?Sized>(
    coupling: &mut C,
    diagonal: &[f64],
    right: &mut [f64],
    goal: f64,
    monitor: &mut dyn Monitor,
) -> Result<Option<usize>> {
    let number = right.len();
    let forward = all(number, |j| right[j] >= 0.0);
    let initial = largest(number, |j| right[j].abs());
    if initial == 0.0 {
        return Ok(Some(0));
    }
    let mean = sum(number, |j| diagonal[j].abs()) / number as f64;
    // `right` is the residual from here on; z is the preconditioned residual, p the direction, q = (m + A) p.
    let (mut solution, mut p) = (vec![0.0; number], right.to_vec());
    let exact = coupling.precondition(mean, &mut p, monitor)?;
    let (mut q, mut z) = (right.to_vec(), vec![0.0; number]);
    let add = |a: f64, b: f64| a + b;
    // (d + A) p of a cell.
    let product = |p: f64, q: f64, d: f64| q + (d - mean) * p;
    let energy = |[]: [f64; 0], [p, q, d]: [f64; 3]| ([], p * product(p, q, d));
    let mut rz = sweep([], [right, &p], |[], [r, z]| ([], r * z), add);
    let mut curvature = if exact { sweep([], [&p, &q, diagonal], energy, add) } else { 0.0 };
    let mut applied = 1;
    while applied < MOST_ITERATIONS {
        if number >= MANY {
            report(monitor, 0.0)?;
        }
        if !exact {
            coupling.forces(&p, &mut q, monitor)?;
            change(&mut q, |j, force| mean * p[j] - force);
            curvature = sweep([], [&p, &q, diagonal], energy, add);
        }
        // A direction of negative curvature proves that the matrix is not positive definite: the
        // interface is unstable there.
        if curvature.is_nan() || curvature <= 0.0 {
            return Ok(None);
        }
        let length = rz / curvature;
        // The new residual goes to z, too, to be preconditioned there.
        let step = |[x, r, _]: [f64; 3], [p, q, d]: [f64; 3]| {
            let r = r - length * product(p, q, d);
            ([x + length * p, r, r], r.abs())
        };
        if sweep([&mut solution, right, &mut z], [&p, &q, diagonal], step, f64::max) <= goal {
            break;
        }
        coupling.precondition(mean, &mut z, monitor)?;
        applied += 1;
        let before = rz;
        rz = sweep([], [right, &z], |[], [r, z]| ([], r * z), add);
        let conjugate = rz / before;
        if exact {
            let turn = |[p, q]: [f64; 2], [z, r, d]: [f64; 3]| {
                let (p, q) = (z + conjugate * p, r + conjugate * q);
                ([p, q], p * product(p, q, d))
            };
            curvature = sweep([&mut p, &mut q], [&z, right, diagonal], turn, add);
        } else {
            sweep([&mut p], [&z], |[p], [z]| ([z + conjugate * p], 0.0), add);
        }
    }
    right.copy_from_slice(&solution);
    let least = -(goal / initial).sqrt() * largest(number, |j| right[j]);
    Ok((!forward || all(number, |j| right[j] >= least)).then_some(applied))
}

/// [`Coupling::solve_uniform`] by conjugate gradients, to a residual of rounding errors.
pub(super) fn solve_uniform<C: Coupling + ?Sized>(
    coupling: &mut C,
    diagonal: f64,
    right: &mut [f64],
    monitor: &mut dyn Monitor,
) -> Result<usize> {
    let goal = ROUNDED * right.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    let solved = coupling.solve_variable(&vec![diagonal; right.len()], right, goal, monitor)?;
    Ok(solved.unwrap_or_default())
}
