//! The covariance of the force at a list of positions, as a matrix.

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
