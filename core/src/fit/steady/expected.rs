//! The expected periodogram and the mean of a record of the force of contacts in steady sliding.

use super::record::transform;
use crate::Result;
use crate::master::MasterEquation;
use crate::monitor::Monitor;

/// Multiples of the length over which contacts dephase up to which the autocovariance is computed at first: it falls by e^{−1}
/// over that length.
const DEPHASED: f64 = 20.0;
/// The same of the mean advance from break to break, for contacts that dephase within it.
const LIVES: f64 = 6.0;
/// The autocovariance is computed up to where it stays below this fraction of the variance.
const NEGLIGIBLE: f64 = 1e-7;

/// What is expected of a record of n readings at the spacing h.
#[derive(Debug, Clone)]
pub(super) struct ExpectedRecord {
    /// The mean force F_k.
    pub mean: f64,
    /// The expected squares v_k of the components of the discrete Fourier transform, k = 0 … n/2:
    /// v_k = Re 2Σ_u (1 − u/n) c(uh) e^{−2πiuk/n} − c(0). v₀/n is the variance of the mean of the record.
    pub squares: Vec<f64>,
}

impl ExpectedRecord {
    /// What the contacts of `equation` lead to.
    ///
    /// # Errors
    /// Those of [`crate::master::SteadyState::autocovariance`].
    pub fn new(
        equation: &MasterEquation,
        (n, spacing): (usize, f64),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let covariance = autocovariance(equation, (n, spacing), monitor)?;
        let mean = equation.steady_state().kinetic_friction();
        Ok(Self { mean, squares: squares(&covariance, n) })
    }

    /// The same with the autocovariance times e^{−u/length}, which widens the peaks of the spectrum.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn widened(
        equation: &MasterEquation,
        (n, spacing): (usize, f64),
        length: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        /// Lengths after which what is left is negligible.
        const LEFT: f64 = 16.0;
        let steady = equation.steady_state();
        let lags = n.min((LEFT * length / spacing).ceil().min(n as f64) as usize + 1);
        let advances: Vec<f64> = (0..lags).map(|u| spacing * u as f64).collect();
        let mut covariance =
            steady.autocovariance_with(&advances, equation.contacts().count, None, monitor)?;
        covariance.iter_mut().zip(&advances).for_each(|(c, u)| *c *= (-u / length).exp());
        Ok(Self { mean: steady.kinetic_friction(), squares: squares(&covariance, n) })
    }
}

/// The expected squares v_k from the autocovariance at the first lags, 0 beyond.
fn squares(covariance: &[f64], n: usize) -> Vec<f64> {
    let mut folded = vec![0.0; n];
    for (u, c) in covariance.iter().enumerate() {
        // Lags u and u − n, and those with the opposite sign.
        let weighted = (1.0 - u as f64 / n as f64) * c;
        folded[u] += weighted;
        if u > 0 {
            folded[n - u] += weighted;
        }
    }
    transform(folded).into_iter().map(|mode| mode.re).collect()
}

/// c(uh) for u = 0, 1, …, up to where it is negligible, or to u = n − 1.
fn autocovariance(
    equation: &MasterEquation,
    (n, spacing): (usize, f64),
    monitor: &mut dyn Monitor,
) -> Result<Vec<f64>> {
    let (steady, size) = (equation.steady_state(), equation.contacts().count);
    let mut reach = (DEPHASED * steady.dephasing_length()).max(LIVES * steady.mean_life());
    loop {
        let lags = n.min((reach / spacing).ceil().min(n as f64) as usize + 2);
        let advances: Vec<f64> = (0..lags).map(|u| spacing * u as f64).collect();
        let covariance = steady.autocovariance_with(&advances, size, None, monitor)?;
        let last = &covariance[lags - lags / 8 - 1..];
        if lags == n || last.iter().all(|c| c.abs() <= NEGLIGIBLE * covariance[0]) {
            return Ok(covariance);
        }
        reach *= 2.0;
    }
}
