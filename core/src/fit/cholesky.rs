//! Cholesky factors of large matrices, and inverses from them: on all threads where this is worth it, with the same bits on any
//! number of them.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::{factor, inverse};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, MatMut, Par, get_global_parallelism};

/// Rows below which threads would wait for each other longer than they work.
const SMALL: usize = 1000;

/// A lower triangular L with LLᵀ the factored matrix; what is above its diagonal is not used.
#[derive(Debug)]
pub(super) struct Cholesky(Mat<f64>);

impl Cholesky {
    /// The factor of a symmetric matrix; `None` if it is not positive definite.
    pub fn new(mut matrix: Mat<f64>) -> Option<Self> {
        let (n, par) = (matrix.nrows(), threads(matrix.nrows()));
        let scratch = factor::cholesky_in_place_scratch::<f64>(n, par, Default::default());
        let mut memory = MemBuffer::new(scratch);
        let stack = MemStack::new(&mut memory);
        let factored =
            factor::cholesky_in_place(matrix.as_mut(), Default::default(), par, stack, Default::default());
        factored.is_ok().then_some(Self(matrix))
    }

    pub fn nrows(&self) -> usize {
        self.0.nrows()
    }

    /// ln |LLᵀ|.
    pub fn log_determinant(&self) -> f64 {
        2.0 * (0..self.0.nrows()).map(|i| self.0[(i, i)].ln()).sum::<f64>()
    }

    /// Replaces M, of few columns, by L⁻¹M. On one thread: others would sum in another order.
    pub fn whiten(&self, matrix: MatMut<'_, f64>) {
        solve_lower_triangular_in_place(self.0.as_ref(), matrix, Par::Seq);
    }

    /// Replaces M, of few columns, by L⁻ᵀM.
    pub fn whiten_transposed(&self, matrix: MatMut<'_, f64>) {
        solve_upper_triangular_in_place(self.0.transpose(), matrix, Par::Seq);
    }

    /// tr A⁻¹ and tr A⁻² of the factored matrix A.
    pub fn traces_of_inverse(&self) -> [f64; 2] {
        let inverse = self.lower_of_inverse();
        let [mut once, mut twice] = [0.0; 2];
        for j in 0..inverse.ncols() {
            let below = inverse.as_ref().col(j).subrows(j, inverse.nrows() - j);
            once += below[0];
            twice += 2.0 * below.squared_norm_l2() - below[0] * below[0];
        }
        [once, twice]
    }

    /// (LLᵀ)⁻¹.
    pub fn inverse(&self) -> Mat<f64> {
        let mut all = self.lower_of_inverse();
        let n = all.nrows();
        for j in 0..n {
            for i in 0..j {
                all[(i, j)] = all[(j, i)];
            }
        }
        all
    }

    /// (LLᵀ)⁻¹ up to its diagonal.
    fn lower_of_inverse(&self) -> Mat<f64> {
        let (n, par) = (self.0.nrows(), threads(self.0.nrows()));
        let mut memory = MemBuffer::new(inverse::inverse_scratch::<f64>(n, par));
        let mut lower = Mat::zeros(n, n);
        inverse::inverse(lower.as_mut(), self.0.as_ref(), par, MemStack::new(&mut memory));
        lower
    }
}

/// On how many threads to work on this many rows.
fn threads(rows: usize) -> Par {
    if rows < SMALL { Par::Seq } else { get_global_parallelism() }
}
