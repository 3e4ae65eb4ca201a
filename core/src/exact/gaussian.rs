//! Gaussian thresholds, and a Gaussian distribution of stretches at the start: the paper's Fig. 2.

use num_complex::Complex64;

use super::extrema::{highest, steepest_fall, window};
use super::{ClosedForm, not_negative, positive};
use crate::Result;

/// P_c = G(x̄, σ) and Q_ini = G(x̄_i, σ_i), R = δ; masses below 0 are kept, not cut off.
///
/// The contact that started at y breaks for the (n+1)-th time at Σξ − y, which is Gaussian with mean
/// (n+1)x̄ − x̄_i and variance V_n = (n+1)σ² + σ_i². With z_n = (X − (n+1)x̄ + x̄_i)/√V_n
///
/// F(X) = x̄_i + X − Σ_{n≥0} [x̄ Φ(z_n) − (σ²/√V_n) φ(z_n)].
///
/// Limits: the truncated law of the solvers differs by its mass below 0 (2.9e-7 at σ = x̄/5), and
/// by the mass of Q_ini below 0 or above the thresholds.
///
/// ```
/// use asperity::exact::{ClosedForm, Gaussian};
///
/// let exact = Gaussian::new(1.0, 0.1);
/// // Contacts that start relaxed are stretched together at first.
/// assert!((exact.force(0.2) - 0.2).abs() < 1e-9);
/// assert!((exact.force(200.0) - 0.505).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian {
    /// x̄, mean threshold.
    pub mean: f64,
    /// σ > 0, standard deviation of thresholds.
    pub std: f64,
    /// x̄_i, mean stretch at X = 0.
    pub initial_mean: f64,
    /// σ_i ≥ 0, standard deviation of stretches at X = 0.
    pub initial_std: f64,
}

impl Gaussian {
    /// Thresholds G(`mean`, `std`), all contacts relaxed at X = 0.
    #[must_use]
    pub fn new(mean: f64, std: f64) -> Self {
        Self { mean, std, initial_mean: 0.0, initial_std: 0.0 }
    }

    /// The same with stretches G(`mean`, `std`) at X = 0.
    #[must_use]
    pub fn starting_from(self, mean: f64, std: f64) -> Self {
        Self { initial_mean: mean, initial_std: std, ..self }
    }

    /// N Var(F/(N_c⟨k⟩)) at X: the variance of the stretch of one contact, so that the force of N_c
    /// contacts scatters by N_c⟨k⟩√(variance/N_c).
    ///
    /// ⟨x²⟩ = x̄_i² + σ_i² + 2∫F − Σ_n E[ξ²; the n-th break before X], each term in closed form.
    #[must_use]
    pub fn variance(&self, position: f64) -> f64 {
        if self.is_beyond(position) {
            return f64::NAN;
        }
        let (mean, var) = (self.mean, self.std * self.std);
        let start = self.initial_mean;
        let mut second = (start + position).powi(2) + self.initial_std.powi(2);
        for (z, root) in self.breaks(position) {
            let (cdf, pdf) = (normal_cdf(z), normal_density(z));
            // Both expectations of truncated Gaussians follow by parts from Φ and φ; the first is
            // the integral of the force lost.
            let path = mean * root * (z * cdf + pdf) - var * cdf;
            let broken = (mean * mean + var) * cdf - (2.0 * mean + var / root * z) * var / root * pdf;
            second -= 2.0 * path + broken;
        }
        second - self.force(position).powi(2)
    }

    /// The root s_j of P̂_c(s) = 1, j ≥ 1: s_j = [x̄ − √(x̄² − 4πijσ²)]/σ²; its conjugate is a root too.
    ///
    /// P̂_c is entire, so that for relaxed contacts F = F_k − Σ_j 2 Re(e^{s_j X}/s_j) for X > 0.
    #[must_use]
    pub fn relaxation_root(&self, j: u32) -> Complex64 {
        let shift = Complex64::new(0.0, 4.0 * std::f64::consts::PI * f64::from(j));
        // The quotient avoids the cancellation in x̄ − √… at small σ.
        shift / (self.mean + (self.mean * self.mean - shift * self.std * self.std).sqrt())
    }

    /// X* = −1/Re s_1, over which |F − F_k| falls by e; ≈ x̄³/(2π²σ²) for narrow laws.
    #[must_use]
    pub fn relaxation_length(&self) -> f64 {
        -1.0 / self.relaxation_root(1).re
    }

    /// (z_n, √V_n) of the breaks n = 0, 1, … that matter at X.
    fn breaks(&self, position: f64) -> impl Iterator<Item = (f64, f64)> {
        let Self { mean, std, initial_mean, initial_std } = *self;
        (1..)
            .map(move |n| {
                let n = f64::from(n);
                let root = (n * std * std + initial_std * initial_std).sqrt();
                ((position - n * mean + initial_mean) / root, root)
            })
            // Φ and φ underflow against 1 far before; z falls as n grows.
            .take_while(|&(z, _)| z > -40.0)
    }

    fn grid(&self) -> Vec<f64> {
        window(self.mean - self.initial_mean, self.std.hypot(self.initial_std))
    }
}

impl ClosedForm for Gaussian {
    fn check(&self) -> Result<()> {
        positive("mean", self.mean)?;
        positive("std", self.std)?;
        not_negative("initial_mean", self.initial_mean)?;
        not_negative("initial_std", self.initial_std).map(drop)
    }

    fn reach(&self) -> f64 {
        1e5 * self.mean
    }

    fn force(&self, position: f64) -> f64 {
        if self.is_beyond(position) {
            return f64::NAN;
        }
        let var = self.std * self.std;
        let broken = self.breaks(position);
        let lost: f64 =
            broken.map(|(z, root)| self.mean * normal_cdf(z) - var / root * normal_density(z)).sum();
        self.initial_mean + position - lost
    }

    fn slope(&self, position: f64) -> f64 {
        if self.is_beyond(position) {
            return f64::NAN;
        }
        let var = self.std * self.std;
        let rate = |(z, root)| normal_density(z) / root * (self.mean + var / root * z);
        1.0 - self.breaks(position).map(rate).sum::<f64>()
    }

    fn kinetic_friction(&self) -> f64 {
        (self.mean * self.mean + self.std * self.std) / (2.0 * self.mean)
    }

    fn static_friction(&self) -> Option<(f64, f64)> {
        highest(|x| self.force(x), |x| self.slope(x), &self.grid())
    }

    fn critical_stiffness(&self) -> f64 {
        steepest_fall(|x| self.slope(x), &self.grid())
    }
}

/// Φ(z).
fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

/// φ(z).
fn normal_density(z: f64) -> f64 {
    (-0.5 * z * z).exp() / (2.0 * std::f64::consts::PI).sqrt()
}
