//! Noise of measured curves: white noise plus drift, estimated by restricted likelihood.
//!
//! The covariance of the noise at the positions X_i is
//!
//! C_ij = σ² δ_ij + Σ_k σ_k² e^{−|X_i − X_j|/ℓ_k},
//!
//! white noise of standard deviation σ and up to two Ornstein–Uhlenbeck processes: slow drift, and noise that is
//! correlated over some points, as filters of instruments make it. Such noise is a Markov process, so that a
//! Kalman filter (R. E. Kalman, J. Basic Eng. 82, 35 (1960)) whitens n points at a cost in proportion to n.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::monitor::{Monitor, report};
use crate::numerics::least_squares::LeastSquares;
use crate::numerics::nelder_mead::nelder_mead;
use crate::numerics::order::sort_by_number;

/// Largest number of Ornstein–Uhlenbeck processes.
const MOST: usize = 2;
/// Smallest and largest standard deviation of a process, relative to that of the white noise.
const RATIOS: (f64, f64) = (1e-3, 1e3);
/// Correlation lengths, relative to the length of the record, at which searches start.
const STARTS: [f64; 3] = [0.01, 0.05, 0.3];
/// Largest correlation length, relative to the length of the record. Longer ones make the same record.
const LONGEST: f64 = 3.0;
/// By how much a second process must lower −2 ln(likelihood) to be kept: the 95 % quantile of χ² for its two
/// parameters.
const SECOND: f64 = 6.0;
/// Logarithms of the factors by which the length of the slowest process is varied.
const OFFSETS: [f64; 13] = [-3.0, -2.5, -2.0, -1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0];
/// First steps of a search, in the logarithms of ratios and lengths, and its tolerance of −2 ln(likelihood).
const STEP: f64 = 0.7;
const TOLERANCE: f64 = 1e-3;

/// A stationary Gaussian process with the covariance σ² e^{−|X|/ℓ}.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OrnsteinUhlenbeck {
    /// Standard deviation σ, a force.
    pub std: f64,
    /// Correlation length ℓ, a length.
    pub length: f64,
}

/// The noise of a measured curve: white noise plus drift.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct MeasuredNoise {
    /// Standard deviation of the white noise, a force.
    pub white: f64,
    /// The drift: none, one or two processes, those of short correlation lengths first.
    pub drift: Vec<OrnsteinUhlenbeck>,
}

impl MeasuredNoise {
    /// White noise of standard deviation 1.
    pub(super) const UNIT: Self = Self { white: 1.0, drift: Vec::new() };

    /// Whitens `columns` of values at rising positions: multiplies each by the inverse of the Cholesky factor
    /// of C. Returns ln det C.
    pub(super) fn whiten(&self, position: &[f64], columns: &mut [Vec<f64>]) -> f64 {
        let count = self.drift.len();
        let mut states = vec![[0.0; MOST]; columns.len()];
        // Covariance of the processes given all values before: at first, that of the stationary state.
        let mut covariance = [[0.0; MOST]; MOST];
        (0..count).for_each(|k| covariance[k][k] = self.drift[k].std.powi(2));
        let mut log_determinant = 0.0;
        for i in 0..position.len() {
            if i > 0 {
                self.predict(position[i] - position[i - 1], &mut covariance, &mut states);
            }
            let rows: [f64; MOST] = covariance.map(|row| row.iter().sum());
            let variance = self.white.powi(2) + rows.iter().sum::<f64>();
            let std = variance.sqrt();
            for (column, state) in columns.iter_mut().zip(&mut states) {
                let innovation = column[i] - state.iter().sum::<f64>();
                (0..count).for_each(|k| state[k] += rows[k] / variance * innovation);
                column[i] = innovation / std;
            }
            for k in 0..count {
                (0..count).for_each(|l| covariance[k][l] -= rows[k] * rows[l] / variance);
            }
            log_determinant += variance.ln();
        }
        log_determinant
    }

    /// The processes after an advance by `gap`.
    fn predict(&self, gap: f64, covariance: &mut [[f64; MOST]; MOST], states: &mut [[f64; MOST]]) {
        let mut factors = [0.0; MOST];
        for (factor, process) in factors.iter_mut().zip(&self.drift) {
            *factor = (-gap / process.length).exp();
        }
        states.iter_mut().for_each(|state| (0..MOST).for_each(|k| state[k] *= factors[k]));
        for k in 0..self.drift.len() {
            (0..self.drift.len()).for_each(|l| covariance[k][l] *= factors[k] * factors[l]);
            let forgotten = -(-2.0 * gap / self.drift[k].length).exp_m1();
            covariance[k][k] += self.drift[k].std.powi(2) * forgotten;
        }
    }

    pub(super) fn scaled(mut self, factor: f64) -> Self {
        self.white *= factor;
        self.drift.iter_mut().for_each(|process| process.std *= factor);
        sort_by_number(&mut self.drift, |item| item.length);
        self
    }
}

/// What the noise is estimated from: `residual` at `position`, left by a fit with the derivatives `gradients` by its
/// parameters.
pub(super) struct Residuals<'a> {
    pub position: &'a [f64],
    pub residual: &'a [f64],
    pub gradients: &'a [Vec<f64>],
}

impl Residuals<'_> {
    /// The noise of largest restricted likelihood (H. D. Patterson and R. Thompson, Biometrika 58, 545
    /// (1971)): that of the part of the residuals that no change of the parameters can explain, so that the
    /// noise is not underestimated where the fit follows it. The search begins at `before` if it is given.
    /// `None` if the likelihood does not exist anywhere.
    ///
    /// # Errors
    /// A stop by the monitor.
    pub fn noise(
        &self,
        before: Option<&MeasuredNoise>,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<MeasuredNoise>> {
        if let Some(before) = before {
            let found = self.search(&logarithms(before), monitor)?;
            return Ok(self.scaled(&found.0));
        }
        let span = self.span();
        let mut one = (Vec::new(), f64::INFINITY);
        for start in STARTS {
            one = lower(one, self.search(&[0.0, (start * span).ln()], monitor)?);
        }
        let mut two = (Vec::new(), f64::INFINITY);
        for start in STARTS {
            let added = [one.0[0], one.0[1], -0.5, (start * span).ln()];
            two = lower(two, self.search(&added, monitor)?);
        }
        Ok(self.scaled(if two.1 + SECOND < one.1 { &two.0 } else { &one.0 }))
    }

    /// Noise whose slowest process has other correlation lengths, at the largest likelihood for each, with
    /// its weight: the likelihood, for a prior that is uniform in ln ℓ. The weights have the sum 1.
    ///
    /// # Errors
    /// A stop by the monitor.
    pub fn alternatives(
        &self,
        noise: &MeasuredNoise,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<(f64, MeasuredNoise)>> {
        let mut logs = logarithms(noise);
        let Some(best) = logs.pop() else { return Ok(Vec::new()) };
        let mut found = Vec::new();
        for offset in OFFSETS {
            let length = best + offset;
            if !(self.shortest()..=LONGEST * self.span()).contains(&length.exp()) {
                continue;
            }
            let whole = |rest: &[f64]| [rest, &[length]].concat();
            let (rest, deviance) = self.minimum(|rest| self.deviance(&whole(rest)), &logs, monitor)?;
            found.extend(self.scaled(&whole(&rest)).map(|noise| (deviance, noise)));
        }
        let lowest = found.iter().map(|(deviance, _)| *deviance).fold(f64::INFINITY, f64::min);
        found.iter_mut().for_each(|(deviance, _)| *deviance = (0.5 * (lowest - *deviance)).exp());
        let sum: f64 = found.iter().map(|(weight, _)| weight).sum();
        found.iter_mut().for_each(|(weight, _)| *weight /= sum);
        Ok(found)
    }

    /// Shortest correlation length: noise that is correlated over less than the spacing of points is white.
    fn shortest(&self) -> f64 {
        0.3 * self.span() / self.position.len() as f64
    }

    fn span(&self) -> f64 {
        self.position[self.position.len() - 1] - self.position[0]
    }

    /// The place and the value of the minimum of −2 ln(likelihood) near `start`.
    fn search(&self, start: &[f64], monitor: &mut dyn Monitor) -> Result<(Vec<f64>, f64)> {
        self.minimum(|logs| self.deviance(logs), start, monitor)
    }

    fn minimum(
        &self,
        deviance: impl Fn(&[f64]) -> f64,
        start: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, f64)> {
        let mut stopped = Ok(());
        let asked = |logs: &[f64]| {
            if stopped.is_ok() {
                stopped = report(monitor, 0.0);
            }
            // With a constant value the search ends at once.
            if stopped.is_ok() { deviance(logs) } else { 0.0 }
        };
        let found = nelder_mead(asked, start, STEP, TOLERANCE);
        stopped.map(|()| found)
    }

    /// −2 ln(restricted likelihood) up to a constant, at the best standard deviation of the white noise. `logs` are the
    /// logarithms of relative standard deviation and length of each process.
    fn deviance(&self, logs: &[f64]) -> f64 {
        let (noise, outside) = self.bounded(logs);
        let Some((least, log_determinant)) = self.fitted(&noise) else { return f64::INFINITY };
        let freedom = self.freedom();
        freedom * (least.squares / freedom).ln() + log_determinant + least.log_determinant() + outside
    }

    fn freedom(&self) -> f64 {
        (self.position.len() - self.gradients.len()) as f64
    }

    /// The fit of the gradients to the residuals in noise of relative size `noise`, and ln det C.
    pub fn fitted(&self, noise: &MeasuredNoise) -> Option<(LeastSquares, f64)> {
        let mut columns = self.gradients.to_vec();
        columns.push(self.residual.to_vec());
        let log_determinant = noise.whiten(self.position, &mut columns);
        let residual = columns.pop()?;
        Some((LeastSquares::new(columns, residual)?, log_determinant))
    }

    fn scaled(&self, logs: &[f64]) -> Option<MeasuredNoise> {
        let (noise, _) = self.bounded(logs);
        let (least, _) = self.fitted(&noise)?;
        Some(noise.scaled((least.squares / self.freedom()).sqrt()))
    }

    /// Noise with white noise of standard deviation 1, within the bounds, and a penalty for the distance from them.
    fn bounded(&self, logs: &[f64]) -> (MeasuredNoise, f64) {
        let span = self.span();
        let mut outside = 0.0;
        let mut within = |log: f64, low: f64, high: f64| {
            let inside = log.clamp(low.ln(), high.ln());
            outside += (log - inside).powi(2);
            inside.exp()
        };
        let processes = logs.chunks_exact(2).map(|log| OrnsteinUhlenbeck {
            std: within(log[0], RATIOS.0, RATIOS.1),
            length: within(log[1], self.shortest(), LONGEST * span),
        });
        let drift = processes.collect();
        (MeasuredNoise { white: 1.0, drift }, outside)
    }
}

fn lower(a: (Vec<f64>, f64), b: (Vec<f64>, f64)) -> (Vec<f64>, f64) {
    if b.1 < a.1 || a.0.is_empty() { b } else { a }
}

/// Logarithms of relative standard deviations and lengths.
fn logarithms(noise: &MeasuredNoise) -> Vec<f64> {
    noise.drift.iter().flat_map(|process| [(process.std / noise.white).ln(), process.length.ln()]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The covariance as a matrix, whitened by Gaussian elimination (Cholesky) instead of the filter.
    #[test]
    fn whitening_is_that_of_the_covariance_matrix() {
        let drift =
            vec![OrnsteinUhlenbeck { std: 0.5, length: 0.3 }, OrnsteinUhlenbeck { std: 2.0, length: 7.0 }];
        let noise = MeasuredNoise { white: 0.7, drift };
        let position: Vec<f64> = (0..30).map(|i| f64::from(i) * (1.0 + 0.03 * f64::from(i))).collect();
        let values: Vec<f64> = position.iter().map(|x| (0.7 * x).sin() + 0.1 * x).collect();
        let covariance = |i: usize, j: usize| {
            let drift = noise.drift.iter().map(|process| {
                process.std.powi(2) * (-(position[i] - position[j]).abs() / process.length).exp()
            });
            drift.sum::<f64>() + if i == j { 0.49 } else { 0.0 }
        };
        let mut factor = vec![vec![0.0; 30]; 30];
        let mut expected = vec![0.0; 30];
        for i in 0..30 {
            for j in 0..=i {
                let known: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let rest = covariance(i, j) - known;
                factor[i][j] = if i == j { rest.sqrt() } else { rest / factor[j][j] };
            }
            let known: f64 = (0..i).map(|k| factor[i][k] * expected[k]).sum();
            expected[i] = (values[i] - known) / factor[i][i];
        }
        let log: f64 = (0..30).map(|i| 2.0 * factor[i][i].ln()).sum();
        let mut columns = vec![values.clone()];
        // Rounding of 30 steps with a condition number of about 1e3.
        assert!((noise.whiten(&position, &mut columns) - log).abs() < 1e-11);
        for (found, expected) in columns[0].iter().zip(&expected) {
            assert!((found - expected).abs() < 1e-12, "{found} {expected}");
        }
    }
}
