//! Sample paths of the force: a Gaussian process with given mean and covariance, by Cholesky factorisation.

use rand_core::Rng;
use rand_distr::{Distribution, StandardNormal};

use super::{ALLOWED, Covariance};
use crate::monitor::{Monitor, Part, fits, report};
use crate::random::{Purpose, Stream};
use crate::{Error, Result};

impl Covariance {
    /// `count` sample paths of the force at the positions, one after another: a Gaussian process with this mean
    /// and covariance. The force of many contacts is one by the central limit theorem, so that a path costs the
    /// same for any number of contacts. The same seed gives the same paths.
    ///
    /// # Errors
    /// More than 2 GB; a covariance that is not positive definite to within ten times its estimated error.
    pub fn sample_paths(&self, count: usize, seed: u64) -> Result<Vec<Vec<f64>>> {
        self.sample_paths_with(count, seed, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::sample_paths`]; stopped by the monitor.
    pub fn sample_paths_with(
        &self,
        count: usize,
        seed: u64,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Vec<f64>>> {
        let needed = (count as u64).saturating_mul(8 * (self.positions.len() as u64 + 4));
        fits("count", "sample paths", needed, ALLOWED)?;
        let factor = &mut Part::new(monitor, 0.0, 0.5);
        let factor = cholesky(&self.values, self.positions.len(), self.error, factor)?.ok_or_else(|| {
            let found = format!("an estimated error of {:e}", self.error);
            Error::invalid("positions", "positions at which the covariance is positive definite", found)
        })?;
        let path = |index: u64| {
            let mut stream = Stream::new(seed, Purpose::SamplePaths, index);
            let normal: Vec<f64> = (0..self.mean.len()).map(|_| standard_normal(&mut stream)).collect();
            let row = |(i, mean): (usize, &f64)| {
                let entries = &factor[i * self.mean.len()..][..=i];
                mean + entries.iter().zip(&normal).map(|(a, b)| a * b).sum::<f64>()
            };
            self.mean.iter().enumerate().map(row).collect()
        };
        let mut paths = Vec::with_capacity(count);
        for index in 0..count {
            paths.push(path(index as u64));
            if index % 64 == 63 {
                report(monitor, 0.5 + 0.5 * index as f64 / count as f64)?;
            }
        }
        Ok(paths)
    }
}

fn standard_normal(stream: &mut impl Rng) -> f64 {
    StandardNormal.sample(stream)
}

/// The lower triangular factor L of a symmetric matrix A = LLᵀ, row by row. Pivots that are 0 up to rounding,
/// or up to the `error` of the matrix, give a column of zeros: the force at this position follows from those
/// at earlier ones. `None` if a pivot is further below 0.
fn cholesky(matrix: &[f64], size: usize, error: f64, monitor: &mut dyn Monitor) -> Result<Option<Vec<f64>>> {
    let largest = (0..size).map(|i| matrix[i * (size + 1)]).fold(0.0, f64::max);
    let least = (1e-12 * largest).max(10.0 * error);
    let mut factor = vec![0.0; matrix.len()];
    for i in 0..size {
        if i % 64 == 63 {
            report(monitor, (i as f64 / size as f64).powi(3))?;
        }
        for j in 0..=i {
            let [above, left] = [i, j].map(|row| &factor[row * size..][..j]);
            let rest = matrix[i * size + j] - above.iter().zip(left).map(|(a, b)| a * b).sum::<f64>();
            let pivot = factor[j * (size + 1)];
            factor[i * size + j] = match i == j {
                true if rest > least => rest.sqrt(),
                true if rest < -least => return Ok(None),
                false if pivot > 0.0 => rest / pivot,
                _ => 0.0,
            };
        }
    }
    Ok(Some(factor))
}
