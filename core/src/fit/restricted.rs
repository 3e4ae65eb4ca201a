//! The restricted likelihood, by which sizes of errors are estimated.
//!
//! Fitted numbers follow the errors, so that residuals are smaller than errors, and the most probable sizes of errors are too small:
//! by p/2n for p numbers and n independent readings, by far more for a drift of few correlation lengths. The restricted likelihood is
//! that of what no change of the p numbers can describe (H. D. Patterson and R. Thompson, Biometrika 58, 545 (1971)), or the one
//! with these numbers integrated out (D. A. Harville, Biometrika 61, 383 (1974)): −2 ln L has the term ln |M|, M = JᵀΣ⁻¹J + Π,
//! with the derivatives J of the curves by the numbers and the precision Π of priors. J is that at the end of
//! the search before.

use faer::prelude::Solve;
use faer::{Mat, Side};

use super::error_covariance::ErrorCovariance;
use super::matrix::{product, scaled};

/// Eigenvalue of the scaled information below which a combination of numbers does not change the curve, as N beside ⟨k⟩.
const UNDETERMINED: f64 = 1e-10;

/// The combinations of numbers that the curves determine.
#[derive(Debug, Clone)]
pub(super) struct Restricted {
    /// The derivatives of each curve by them.
    curves: Vec<Mat<f64>>,
    /// The precision of what is known of them beforehand.
    known: Mat<f64>,
}

impl Restricted {
    /// From the derivatives of each curve by the free numbers, the covariances of its errors, and the precision of each prior; `None`
    /// if the curves determine nothing.
    pub fn new<'a>(
        derivatives: Vec<Mat<f64>>,
        covariances: impl Iterator<Item = &'a ErrorCovariance>,
        precision: &[f64],
    ) -> Option<Self> {
        let count = precision.len();
        let prior = Mat::from_fn(count, count, |i, j| if i == j { precision[i] } else { 0.0 });
        let all = Self { curves: derivatives, known: prior };
        let information = all.information(covariances);
        let moving: Vec<usize> = (0..count).filter(|&k| information[(k, k)] > 0.0).collect();
        let eigen = scaled(&information, &moving).self_adjoint_eigen(Side::Lower).ok()?;
        let determined: Vec<usize> = (0..moving.len()).filter(|&j| eigen.S()[j] > UNDETERMINED).collect();
        let mut combinations = Mat::zeros(count, determined.len());
        for (j, &direction) in determined.iter().enumerate() {
            for (i, &k) in moving.iter().enumerate() {
                combinations[(k, j)] = eigen.U()[(i, direction)] / information[(k, k)].sqrt();
            }
        }
        (!determined.is_empty()).then(|| Self {
            known: product(
                product(combinations.transpose(), all.known.as_ref()).as_ref(),
                combinations.as_ref(),
            ),
            curves: all
                .curves
                .iter()
                .map(|derivatives| product(derivatives.as_ref(), combinations.as_ref()))
                .collect(),
        })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.known.nrows()
    }

    /// M = JᵀΣ⁻¹J + Π.
    fn information<'a>(&self, covariances: impl Iterator<Item = &'a ErrorCovariance>) -> Mat<f64> {
        let mut sum = self.known.clone();
        for (derivatives, covariance) in self.curves.iter().zip(covariances) {
            let mut whitened = derivatives.clone();
            covariance.whiten(&mut whitened);
            sum += product(whitened.transpose(), whitened.as_ref());
        }
        sum
    }

    /// ln |M|; `None` if M is not positive definite.
    pub fn log_determinant<'a>(&self, covariances: impl Iterator<Item = &'a ErrorCovariance>) -> Option<f64> {
        let factor = self.information(covariances).llt(Side::Lower).ok()?;
        Some(2.0 * (0..self.count()).map(|i| factor.L()[(i, i)].ln()).sum::<f64>())
    }

    /// The derivatives of each curve by combinations of which M is the unit matrix: JL⁻ᵀ, M = LLᵀ.
    pub fn standardised<'a>(
        &self,
        covariances: impl Iterator<Item = &'a ErrorCovariance>,
    ) -> Option<Vec<Mat<f64>>> {
        let factor = self.information(covariances).llt(Side::Lower).ok()?;
        // L⁻ᵀ = (LLᵀ)⁻¹L.
        let combinations = factor.solve(factor.L());
        Some(
            self.curves
                .iter()
                .map(|derivatives| product(derivatives.as_ref(), combinations.as_ref()))
                .collect(),
        )
    }
}
