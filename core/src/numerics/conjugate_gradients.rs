//! Large symmetric positive definite systems, by conjugate gradients with a preconditioner.

use rayon::prelude::*;

use super::product::product;

/// Numbers changed by one thread.
const CHUNK: usize = 1 << 14;

/// Steps after which roundings alone are left for any preconditioner worth having.
const STEPS: usize = 1000;

/// Room for the iterations: residual, preconditioned residual, direction, and the matrix times it.
#[derive(Debug, Clone)]
pub struct ConjugateGradients {
    residual: Vec<f64>,
    near: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

impl ConjugateGradients {
    /// For systems of `size` equations; takes 32 bytes for each.
    pub fn new(size: usize) -> Self {
        let zeros = || vec![0.0; size];
        Self { residual: zeros(), near: zeros(), direction: zeros(), image: zeros() }
    }

    /// Replaces `right` by the solution x of matrix x = right.
    ///
    /// `matrix` writes its product with the first slice into the second; `near` replaces a slice by its product with
    /// an approximation B of the inverse. Ends when the residual, in the norm √(r·Br), is `tolerance` times what it was,
    /// and tells after how many steps.
    pub fn solve(
        &mut self,
        mut matrix: impl FnMut(&[f64], &mut [f64]),
        mut near: impl FnMut(&mut [f64]),
        tolerance: f64,
        right: &mut [f64],
    ) -> usize {
        let Self { residual, near: preconditioned, direction, image } = self;
        residual.copy_from_slice(right);
        right.fill(0.0);
        direction.fill(0.0);
        let (mut before, mut goal) = (f64::INFINITY, 0.0);
        for step in 0..STEPS {
            preconditioned.copy_from_slice(residual);
            near(preconditioned);
            let square = product(residual, preconditioned);
            if step == 0 {
                goal = tolerance * tolerance * square;
            }
            if square <= goal {
                return step;
            }
            add(preconditioned, square / before, direction);
            matrix(direction, image);
            let way = square / product(direction, image);
            advance(right, way, direction);
            advance(residual, -way, image);
            before = square;
        }
        STEPS
    }
}

/// direction ← near + factor · direction.
fn add(near: &[f64], factor: f64, direction: &mut [f64]) {
    direction.par_chunks_mut(CHUNK).zip(near.par_chunks(CHUNK)).for_each(|(direction, near)| {
        direction.iter_mut().zip(near).for_each(|(d, z)| *d = z + factor * *d);
    });
}

/// x ← x + way · direction.
fn advance(x: &mut [f64], way: f64, direction: &[f64]) {
    x.par_chunks_mut(CHUNK).zip(direction.par_chunks(CHUNK)).for_each(|(x, direction)| {
        x.iter_mut().zip(direction).for_each(|(x, d)| *x += way * d);
    });
}
