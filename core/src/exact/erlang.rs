//! Erlang thresholds, among them exponential ones: a finite sum of exponentials.

use num_complex::Complex64;

use super::extrema::{highest, steepest_fall, window};
use super::{ClosedForm, positive};
use crate::Result;

/// P_c = λ^m x^{m−1} e^{−λx}/(m−1)!: the sum of m exponential lengths of mean 1/λ; R = Q_ini = δ.
///
/// With s_j = λ(e^{2πij/m} − 1),
///
/// F'(X) = m e^{−λX} − Σ_{j=1}^{m−1} e^{s_j X}, F_k = (m+1)/(2λ).
///
/// m = 1 is the exponential law: F = x̄(1 − e^{−X/x̄}), which has no maximum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Erlang {
    /// m ≥ 1, the shape.
    pub shape: u32,
    /// λ > 0, the rate, per length.
    pub rate: f64,
}

impl Erlang {
    /// The law of that shape and mean.
    #[must_use]
    pub fn with_mean(shape: u32, mean: f64) -> Self {
        Self { shape, rate: f64::from(shape) / mean }
    }

    /// s_j, j = 1 … m−1, the roots of P̂_c(s) = 1.
    #[must_use]
    pub fn relaxation_root(&self, j: u32) -> Complex64 {
        let angle = 2.0 * std::f64::consts::PI * f64::from(j) / f64::from(self.shape);
        // cos − 1 without cancellation at large m.
        let real = -2.0 * (0.5 * angle).sin().powi(2);
        self.rate * Complex64::new(real, angle.sin())
    }

    /// X*, over which |F − F_k| falls by e: 1/[λ(1 − cos 2π/m)], but 1/λ for m ≤ 4, where the pole of
    /// P̂_c lies to the right of the roots.
    #[must_use]
    pub fn relaxation_length(&self) -> f64 {
        let pole = 1.0 / self.rate;
        if self.shape <= 4 { pole } else { -1.0 / self.relaxation_root(1).re }
    }

    /// Σ over the roots of a function that takes conjugate values at conjugate roots.
    fn over_roots(&self, term: impl Fn(Complex64) -> Complex64) -> f64 {
        (1..self.shape).map(|j| term(self.relaxation_root(j)).re).sum()
    }

    fn grid(&self) -> Vec<f64> {
        let shape = f64::from(self.shape);
        window(shape / self.rate, shape.sqrt() / self.rate)
    }
}

impl ClosedForm for Erlang {
    fn check(&self) -> Result<()> {
        positive("shape", f64::from(self.shape))?;
        positive("rate", self.rate).map(drop)
    }

    fn force(&self, position: f64) -> f64 {
        let pole = -f64::from(self.shape) * (-self.rate * position).exp_m1() / self.rate;
        pole - self.over_roots(|s| ((s * position).exp() - 1.0) / s)
    }

    fn slope(&self, position: f64) -> f64 {
        f64::from(self.shape) * (-self.rate * position).exp() - self.over_roots(|s| (s * position).exp())
    }

    fn kinetic_friction(&self) -> f64 {
        0.5 * (f64::from(self.shape) + 1.0) / self.rate
    }

    fn static_friction(&self) -> Option<(f64, f64)> {
        highest(|x| self.force(x), |x| self.slope(x), &self.grid())
    }

    fn critical_stiffness(&self) -> f64 {
        steepest_fall(|x| self.slope(x), &self.grid())
    }
}
