//! The covariance of the force at a list of positions, as a matrix.

use crate::parallel;

/// Rows of a matrix that are filled together: entries above the diagonal come from different rows of the triangle,
/// eight of which fill a cache line.
const BAND: usize = 8;

/// `scale` × the symmetric matrix with this lower triangle, row by row.
pub(super) fn symmetric(triangle: &[Vec<f64>], scale: f64) -> Vec<f64> {
    let count = triangle.len();
    let mut values = vec![0.0; count * count];
    let bands = values.chunks_mut((BAND * count).max(1)).zip(triangle.chunks(BAND));
    parallel::map(bands.collect(), &|band, (rows, lower): (&mut [f64], &[Vec<f64>])| {
        for (row, lower) in rows.chunks_mut(count).zip(lower) {
            row.iter_mut().zip(lower).for_each(|(entry, value)| *entry = scale * value);
        }
        let first = BAND * band;
        for (j, column) in triangle.iter().enumerate().skip(first + 1) {
            // Column j of row i is above the diagonal for i < j.
            let above = &column[first..(first + lower.len()).min(j)];
            for (i, value) in above.iter().enumerate() {
                rows[i * count + j] = scale * value;
            }
        }
    });
    values
}

/// The matrix of which row and column k are row and column `order[k]` of another order.
pub(super) fn reordered(matrix: &[f64], order: &[usize]) -> Vec<f64> {
    let count = order.len();
    let mut rank = vec![0; count];
    order.iter().enumerate().for_each(|(k, &number)| rank[number] = k);
    rank.iter().flat_map(|&i| rank.iter().map(move |&j| matrix[i * count + j])).collect()
}

/// The covariance of the force of `size` contacts at pairs of positions of a pull, scaled to N_c contacts.
#[derive(Debug, Clone)]
pub struct Covariance {
    pub(super) positions: Vec<f64>,
    pub(super) mean: Vec<f64>,
    /// Row by row.
    pub(super) values: Vec<f64>,
    pub(super) error: f64,
}

impl Covariance {
    /// The positions X.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// F(X), the mean force at each position.
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Cov(F(X₁), F(X₂)), a force squared: a symmetric matrix, row by row.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The covariance of positions number `first` and `second`.
    ///
    /// # Panics
    /// Numbers beyond those of the positions.
    pub fn at(&self, first: usize, second: usize) -> f64 {
        self.values[first * self.positions.len() + second]
    }

    /// The standard deviation of the force at each position.
    pub fn std(&self) -> Vec<f64> {
        (0..self.positions.len()).map(|i| self.at(i, i).max(0.0).sqrt()).collect()
    }

    /// Estimated error of the covariances, a force squared: the largest difference between the diagonal and the
    /// variance from ∫x²Q, and the errors of the solutions that the covariance is made of.
    pub fn error_estimate(&self) -> f64 {
        self.error
    }
}
