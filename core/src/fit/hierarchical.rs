//! Symmetric matrices of which the blocks beside the diagonal have low ranks, as those of covariances of processes have, and their
//! Cholesky factors (S. Ambikasaran, D. Foreman-Mackey, L. Greengard, D. W. Hogg and M. O'Neil, IEEE Trans. Pattern Anal. Mach.
//! Intell. 38, 252 (2016)).
//!
//! A matrix is divided into halves, and again. With the block below the diagonal A₂₁ = U Vᵀ, the factor has L₁₁ of A₁₁, L₂₁ = U Wᵀ
//! with L₁₁W = V, and L₂₂ of A₂₂ − U WᵀW Uᵀ. All on one thread.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};

use super::cholesky::Cholesky;
use super::low_rank::LowRank;
use super::matrix::product;

/// Rows of a block that is not divided.
const SMALLEST: usize = 128;

/// A symmetric matrix.
#[derive(Debug, Clone)]
pub(super) enum Hierarchical {
    /// Its elements up to the diagonal.
    Whole(Mat<f64>),
    Divided(Box<Divided>),
}

#[derive(Debug, Clone)]
pub(super) struct Divided {
    first: Hierarchical,
    second: Hierarchical,
    /// The block below the diagonal.
    below: LowRank,
}

/// A lower triangular L with LLᵀ the factored matrix.
#[derive(Debug)]
pub(super) enum Factor {
    Whole(Cholesky),
    Divided(Box<DividedFactor>),
}

#[derive(Debug)]
pub(super) struct DividedFactor {
    first: Factor,
    second: Factor,
    below: LowRank,
}

impl Hierarchical {
    /// The matrix with these elements up to the diagonal, each to `tolerance`.
    pub fn new(lower: MatRef<'_, f64>, tolerance: f64) -> Self {
        let n = lower.nrows();
        let half = n / 2;
        if half < SMALLEST {
            return Self::Whole(lower.to_owned());
        }
        let Some(below) = LowRank::new(lower.submatrix(half, 0, n - half, half), tolerance) else {
            return Self::Whole(lower.to_owned());
        };
        let first = Self::new(lower.submatrix(0, 0, half, half), tolerance);
        let second = Self::new(lower.submatrix(half, half, n - half, n - half), tolerance);
        Self::Divided(Box::new(Divided { first, second, below }))
    }

    /// The matrix with these elements on its diagonal, and zeros beside it.
    pub fn diagonal_of(elements: &[f64]) -> Self {
        let n = elements.len();
        let half = n / 2;
        if half < SMALLEST {
            return Self::Whole(Mat::from_fn(n, n, |i, j| if i == j { elements[i] } else { 0.0 }));
        }
        let (first, second) = elements.split_at(half);
        Self::Divided(Box::new(Divided {
            first: Self::diagonal_of(first),
            second: Self::diagonal_of(second),
            below: LowRank { left: Mat::zeros(n - half, 0), right: Mat::zeros(half, 0) },
        }))
    }

    /// Adds these elements on the diagonal.
    pub fn add_diagonal(&mut self, elements: &[f64]) {
        match self {
            Self::Whole(lower) => {
                elements.iter().enumerate().for_each(|(i, element)| lower[(i, i)] += element)
            }
            Self::Divided(parts) => {
                let (first, second) = elements.split_at(parts.first.nrows());
                parts.first.add_diagonal(first);
                parts.second.add_diagonal(second);
            }
        }
    }

    /// `factor` times this, plus `added` on the diagonal.
    pub fn scaled(&self, factor: f64, added: f64) -> Self {
        match self {
            Self::Whole(lower) => {
                let mut scaled = lower * faer::Scale(factor);
                (0..scaled.nrows()).for_each(|i| scaled[(i, i)] += added);
                Self::Whole(scaled)
            }
            Self::Divided(parts) => Self::Divided(Box::new(Divided {
                first: parts.first.scaled(factor, added),
                second: parts.second.scaled(factor, added),
                below: parts.below.scaled(factor),
            })),
        }
    }

    /// The elements on the diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        match self {
            Self::Whole(lower) => (0..lower.nrows()).map(|i| lower[(i, i)]).collect(),
            Self::Divided(parts) => [parts.first.diagonal(), parts.second.diagonal()].concat(),
        }
    }

    /// Adds `factor` times this to another matrix, up to the diagonal.
    pub fn add_to(&self, mut lower: MatMut<'_, f64>, factor: f64) {
        match self {
            Self::Whole(own) => {
                let n = own.nrows();
                for j in 0..n {
                    let column = lower.as_mut().col_mut(j).subrows_mut(j, n - j);
                    let entries = column.iter_mut().zip(own.col(j).subrows(j, n - j).iter());
                    entries.for_each(|(entry, own)| *entry += factor * own);
                }
            }
            Self::Divided(parts) => {
                let half = parts.first.nrows();
                let (first, _, mut below, second) = lower.split_at_mut(half, half);
                parts.first.add_to(first, factor);
                parts.second.add_to(second, factor);
                let LowRank { left, right } = &parts.below;
                matmul(below.as_mut(), Accum::Add, left.as_ref(), right.transpose(), factor, Par::Seq);
            }
        }
    }

    fn nrows(&self) -> usize {
        match self {
            Self::Whole(lower) => lower.nrows(),
            Self::Divided(parts) => parts.first.nrows() + parts.second.nrows(),
        }
    }

    /// Subtracts U G Uᵀ, with the symmetric G.
    fn subtract(&mut self, u: MatRef<'_, f64>, g: &Mat<f64>, tolerance: f64) {
        match self {
            Self::Whole(lower) => {
                let product = product(u, g.as_ref());
                matmul(lower.as_mut(), Accum::Add, product.as_ref(), u.transpose(), -1.0, Par::Seq);
            }
            Self::Divided(parts) => {
                let (upper, lower) = u.split_at_row(parts.first.nrows());
                parts.first.subtract(upper, g, tolerance);
                parts.second.subtract(lower, g, tolerance);
                parts.below.subtract(&product(lower, g.as_ref()), upper, tolerance);
            }
        }
    }

    /// The Cholesky factor; `None` if the matrix is not positive definite.
    pub fn factor(self, tolerance: f64) -> Option<Factor> {
        match self {
            Self::Whole(lower) => Cholesky::new(lower).map(Factor::Whole),
            Self::Divided(parts) => {
                let Divided { first, mut second, mut below } = *parts;
                let first = first.factor(tolerance)?;
                first.whiten(below.right.as_mut());
                let gram = product(below.right.transpose(), below.right.as_ref());
                second.subtract(below.left.as_ref(), &gram, tolerance);
                let second = second.factor(tolerance)?;
                Some(Factor::Divided(Box::new(DividedFactor { first, second, below })))
            }
        }
    }
}

impl Factor {
    /// ln |LLᵀ|.
    pub fn log_determinant(&self) -> f64 {
        match self {
            Self::Whole(factor) => factor.log_determinant(),
            Self::Divided(parts) => parts.first.log_determinant() + parts.second.log_determinant(),
        }
    }

    fn nrows(&self) -> usize {
        match self {
            Self::Whole(factor) => factor.nrows(),
            Self::Divided(parts) => parts.first.nrows() + parts.second.nrows(),
        }
    }

    /// Replaces M, of few columns, by L⁻¹M.
    pub fn whiten(&self, matrix: MatMut<'_, f64>) {
        match self {
            Self::Whole(factor) => factor.whiten(matrix),
            Self::Divided(parts) => {
                let DividedFactor { first, second, below } = &**parts;
                let (mut upper, mut lower) = matrix.split_at_row_mut(first.nrows());
                first.whiten(upper.as_mut());
                let inner = product(below.right.transpose(), upper.as_ref());
                matmul(lower.as_mut(), Accum::Add, below.left.as_ref(), inner.as_ref(), -1.0, Par::Seq);
                second.whiten(lower);
            }
        }
    }

    /// Replaces M, of few columns, by L⁻ᵀM.
    pub fn whiten_transposed(&self, matrix: MatMut<'_, f64>) {
        match self {
            Self::Whole(factor) => factor.whiten_transposed(matrix),
            Self::Divided(parts) => {
                let DividedFactor { first, second, below } = &**parts;
                let (mut upper, mut lower) = matrix.split_at_row_mut(first.nrows());
                second.whiten_transposed(lower.as_mut());
                let inner = product(below.left.transpose(), lower.as_ref());
                matmul(upper.as_mut(), Accum::Add, below.right.as_ref(), inner.as_ref(), -1.0, Par::Seq);
                first.whiten_transposed(upper);
            }
        }
    }

    /// Replaces M by A⁻¹M.
    pub fn solve(&self, mut matrix: MatMut<'_, f64>) {
        self.whiten(matrix.as_mut());
        self.whiten_transposed(matrix);
    }

    /// tr A⁻¹ and tr A⁻² of the factored matrix A.
    ///
    /// With S = A₂₂ − A₂₁A₁₁⁻¹A₁₂, P = A₁₁⁻¹V and Q = S⁻¹U, the blocks of A⁻¹ are A₁₁⁻¹ + P UᵀQ Pᵀ, −Q Pᵀ and S⁻¹.
    pub fn traces_of_inverse(&self) -> [f64; 2] {
        match self {
            Self::Whole(factor) => factor.traces_of_inverse(),
            Self::Divided(parts) => {
                let DividedFactor { first, second, below } = &**parts;
                let ([first_once, first_twice], [second_once, second_twice]) =
                    (first.traces_of_inverse(), second.traces_of_inverse());
                let mut p = below.right.clone();
                first.whiten_transposed(p.as_mut());
                let mut solved = p.clone();
                first.solve(solved.as_mut());
                let mut q = below.left.clone();
                second.solve(q.as_mut());
                let inner = product(below.left.transpose(), q.as_ref());
                let (pp, qq) = (product(p.transpose(), p.as_ref()), product(q.transpose(), q.as_ref()));
                let along = product(inner.as_ref(), pp.as_ref());
                let once = first_once + second_once + trace(&along);
                let crossed = product(inner.as_ref(), product(p.transpose(), solved.as_ref()).as_ref());
                let twice = first_twice
                    + second_twice
                    + 2.0 * trace(&crossed)
                    + trace(&product(along.as_ref(), along.as_ref()))
                    + 2.0 * trace(&product(qq.as_ref(), pp.as_ref()));
                [once, twice]
            }
        }
    }

    /// A⁻¹ of the factored matrix A.
    pub fn inverse(&self) -> Mat<f64> {
        match self {
            Self::Whole(factor) => factor.inverse(),
            Self::Divided(_) => {
                let n = self.nrows();
                let mut all = Mat::identity(n, n);
                self.solve(all.as_mut());
                all
            }
        }
    }
}

fn trace(matrix: &Mat<f64>) -> f64 {
    (0..matrix.nrows()).map(|i| matrix[(i, i)]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 700;

    /// The covariance of a process with independent increments, another one that is smooth, and independent errors.
    fn covariance(i: usize, j: usize) -> f64 {
        let (x, y) = (i as f64 / N as f64, j as f64 / N as f64);
        x.min(y) + 2.0 * (-8.0 * (x - y) * (x - y)).exp() + if i == j { 1e-4 } else { 0.0 }
    }

    fn divided(element: impl Fn(usize, usize) -> f64) -> Hierarchical {
        Hierarchical::new(Mat::from_fn(N, N, element).as_ref(), 1e-12)
    }

    /// Against the closed forms of exp(−|i − j|/ℓ): with ρ = exp(−1/ℓ), the determinant is (1 − ρ²)^(n−1) and the inverse has three
    /// diagonals, 1 + ρ² (1 at both ends) and −ρ beside it, over 1 − ρ².
    #[test]
    fn determinant_and_traces_are_those_of_an_exponential_covariance() {
        let rho = 0.9_f64;
        let matrix = divided(|i, j| rho.powi(i.abs_diff(j) as i32));
        assert!(matches!(&matrix, Hierarchical::Divided(parts) if parts.below.left.ncols() == 1));
        let factor = matrix.factor(1e-12).unwrap();
        let (n, left) = (N as f64, 1.0 - rho * rho);
        let determinant = (n - 1.0) * left.ln();
        // Rounding, times the condition number of 361.
        assert!((factor.log_determinant() / determinant - 1.0).abs() < 1e-11);
        let middle = 1.0 + rho * rho;
        let once = ((n - 2.0) * middle + 2.0) / left;
        let twice = ((n - 2.0) * middle * middle + 2.0 + 2.0 * (n - 1.0) * rho * rho) / (left * left);
        let [found_once, found_twice] = factor.traces_of_inverse();
        assert!((found_once / once - 1.0).abs() < 1e-10, "{found_once} {once}");
        assert!((found_twice / twice - 1.0).abs() < 1e-10, "{found_twice} {twice}");
    }

    #[test]
    fn a_divided_matrix_is_the_same_as_a_whole_one() {
        let whole = Mat::from_fn(N, N, covariance);
        let half = divided(|i, j| covariance(i, j) / 2.0 - if i == j { 5e-4 } else { 0.0 });
        let factor = half.scaled(2.0, 1e-3).factor(1e-12).unwrap();
        assert!(matches!(&factor, Factor::Divided(parts) if matches!(parts.second, Factor::Divided(_))));
        let exact = Cholesky::new(whole.clone()).unwrap();
        // Errors of elements of 1e-12, over the smallest eigenvalue of 1e-4, for 700 of them.
        let near = |a: f64, b: f64| (a - b).abs() < 1e-5 * b.abs().max(1.0);
        assert!(near(factor.log_determinant(), exact.log_determinant()));
        for (found, exact) in factor.traces_of_inverse().into_iter().zip(exact.traces_of_inverse()) {
            assert!(near(found, exact), "{found} {exact}");
        }
        let columns = Mat::from_fn(N, 3, |i, j| ((i * (j + 2)) as f64).sin());
        let (mut whitened, mut expected) = (columns.clone(), columns.clone());
        factor.whiten(whitened.as_mut());
        exact.whiten(expected.as_mut());
        let apart = |a: &Mat<f64>, b: &Mat<f64>| (a - b).norm_max() / b.norm_max();
        assert!(apart(&whitened, &expected) < 1e-5, "{}", apart(&whitened, &expected));
        // A A⁻¹M is M, and the inverse is that of the columns of the unit matrix.
        let mut solved = columns.clone();
        factor.solve(solved.as_mut());
        assert!(apart(&(&whole * &solved), &columns) < 1e-5);
        assert!(apart(&(factor.inverse() * &columns), &solved) < 1e-5);
        let mut sum = Mat::zeros(N, N);
        half.add_to(sum.as_mut(), 3.0);
        for (i, j) in [(0, 0), (400, 399), (500, 3), (699, 350), (120, 100)] {
            let expected = 1.5 * covariance(i, j) - if i == j { 1.5e-3 } else { 0.0 };
            assert!((sum[(i, j)] - expected).abs() < 1e-11, "{i}, {j}");
        }
        assert_eq!(half.diagonal()[600], covariance(600, 600) / 2.0 - 5e-4);
    }

    #[test]
    fn a_matrix_without_low_ranks_stays_whole() {
        let scattered = |i: usize, j: usize| if i == j { 60.0 } else { (0.37 * (i * j) as f64).sin() };
        let matrix = divided(scattered);
        assert!(matches!(matrix, Hierarchical::Whole(_)));
        let exact = Cholesky::new(Mat::from_fn(N, N, scattered)).map(|factor| factor.log_determinant());
        assert!(exact.is_some());
        assert_eq!(matrix.factor(1e-12).map(|factor| factor.log_determinant()), exact);
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_has_no_factor() {
        assert!(
            divided(|i, j| covariance(i, j) - if i == j && i == 600 { 10.0 } else { 0.0 })
                .factor(1e-12)
                .is_none()
        );
    }
}
