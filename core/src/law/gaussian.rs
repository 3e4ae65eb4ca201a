//! The Gaussian distribution conditioned on x ≥ 0.

use std::f64::consts::SQRT_2;

use num_complex::Complex64;

use super::range::{length, length_or_zero, width};
use super::{
    Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, breakpoint_at_zero, invert_ln_survival,
    normal, shared, unknown, ziggurat,
};
use crate::Result;
use crate::numerics::legendre::RULE;
use crate::random::Stream;

/// Gaussian of mean μ ≥ 0 and standard deviation σ, conditioned on x ≥ 0: p(x) = φ((x − μ)/σ) / (σ Φ(μ/σ)).
///
/// `mean` and `std` are μ and σ; [`Law::mean`] and [`Law::std`] are those of the conditioned distribution.
/// Relative errors down to S = 1e-300: 1e-13 of ln S and the hazard rate, 5e-16 (1 + z²) of S.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaussian {
    mean: f64,
    std: f64,
    /// α = μ/σ, Φ(α) and ln Φ(α).
    alpha: f64,
    above: f64,
    ln_above: f64,
}

impl Gaussian {
    /// The distribution of these parameters.
    ///
    /// # Errors
    /// A mean below 0, a standard deviation of 0 or below, or one of them not finite.
    pub fn new(mean: f64, std: f64) -> Result<Self> {
        let mean = length_or_zero("mean", mean)?;
        // The mean is that before truncation: the width has no upper limit.
        let std = if std < mean { width(mean, std)? } else { length("std", std)? };
        let alpha = mean / std;
        let (above, ln_above) = (normal::survival(-alpha), normal::ln_survival(-alpha));
        Ok(Self { mean, std, alpha, above, ln_above })
    }

    fn standard(&self, x: f64) -> f64 {
        (x - self.mean) / self.std
    }

    /// Below this x, P(ξ ≤ x) is the smaller tail and is computed instead of S.
    fn bulk(&self) -> f64 {
        self.mean.max(self.std)
    }

    /// P(ξ ≤ x) for 0 ≤ x ≤ max(μ, σ). Near 0 the difference of two Φ would cancel; the density varies there
    /// by a factor of order e, and Gauss quadrature is exact to rounding.
    fn below(&self, x: f64) -> f64 {
        if self.is_near_zero(x) {
            return RULE.integrate(0.0, x, |t| self.density(t));
        }
        (normal::survival(-self.standard(x)) - normal::survival(self.alpha)) / self.above
    }

    /// Whether a difference of two Φ would cancel in P(ξ ≤ x).
    fn is_near_zero(&self, x: f64) -> bool {
        x * self.alpha.max(1.0) < self.std
    }
}

impl Law for Gaussian {
    fn name(&self) -> &'static str {
        "gaussian"
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("mean", self.mean), Parameter::new("std", self.std)]
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        match name {
            "mean" => shared(Self::new(value, self.std)),
            "std" => shared(Self::new(self.mean, value)),
            _ => Err(unknown(self, name)),
        }
    }

    /// p(x) − p(0) S(x) for μ, z p(x) + α p(0) S(x) for σ: the second terms are those of the norm Φ(α).
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let (law, edge) = (*self, self.density(0.0));
        let inside = move |x: f64, value: f64| if x > 0.0 { value } else { 0.0 };
        match name {
            "mean" => Ok(Box::new(move |x| inside(x, law.density(x) - edge * law.survival(x)))),
            "std" => Ok(Box::new(move |x| {
                inside(x, law.standard(x) * law.density(x) + law.alpha * edge * law.survival(x))
            })),
            _ => Err(unknown(self, name)),
        }
    }

    fn density(&self, x: f64) -> f64 {
        if x < 0.0 {
            return 0.0;
        }
        normal::density(self.standard(x)) / (self.std * self.above)
    }

    fn ln_density(&self, x: f64) -> f64 {
        if x < 0.0 {
            return f64::NEG_INFINITY;
        }
        normal::ln_density(self.standard(x)) - self.std.ln() - self.ln_above
    }

    fn survival(&self, x: f64) -> f64 {
        if x <= 0.0 {
            return 1.0;
        }
        if x < self.bulk() { 1.0 - self.below(x) } else { normal::survival(self.standard(x)) / self.above }
    }

    fn ln_survival(&self, x: f64) -> f64 {
        if x <= 0.0 {
            return 0.0;
        }
        if x < self.bulk() {
            return (-self.below(x)).ln_1p();
        }
        normal::ln_survival(self.standard(x)) - self.ln_above
    }

    /// ln Φ(z) + ln(1 − Φ(−α)/Φ(z)) − ln Φ(α) at z = (x − μ)/σ; near 0 a quadrature relative to p(x).
    fn ln_cumulative(&self, x: f64) -> f64 {
        if x <= 0.0 {
            return f64::NEG_INFINITY;
        }
        if x >= self.bulk() {
            return (-self.survival(x)).ln_1p();
        }
        if self.is_near_zero(x) {
            let ln_density = self.ln_density(x);
            return RULE.integrate(0.0, x, |t| (self.ln_density(t) - ln_density).exp()).ln() + ln_density;
        }
        let ln_below = normal::ln_survival(-self.standard(x));
        let cut = (normal::ln_survival(self.alpha) - ln_below).exp();
        ln_below + (-cut).ln_1p() - self.ln_above
    }

    fn hazard(&self, x: f64) -> f64 {
        if x < 0.0 { 0.0 } else { normal::hazard(self.standard(x)) / self.std }
    }

    fn quantile(&self, p: f64) -> f64 {
        invert_ln_survival(|x| self.ln_survival(x), (-p).ln_1p())
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        invert_ln_survival(|x| self.ln_survival(x), q.ln())
    }

    /// M_n = μ M_{n−1} + (n−1) σ² M_{n−2} + σ² x^{n−1} p(x), by parts; no term is negative.
    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let x = x.max(0.0);
        let variance = self.std * self.std;
        let (mut before, mut moment) = (0.0, self.survival(x));
        let mut boundary = variance * self.density(x);
        for n in 0..order {
            (before, moment) = (moment, self.mean * moment + f64::from(n) * variance * before + boundary);
            boundary *= x;
        }
        moment
    }

    /// σ √(1 − λ(α + λ)) with λ = φ(α)/Φ(α).
    fn std(&self) -> f64 {
        let lambda = self.std * self.density(0.0);
        self.std * (1.0 - lambda * (self.alpha + lambda)).sqrt()
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        breakpoint_at_zero(0.0, self.density(0.0))
    }

    /// [exp(−sμ + s²σ²/2) − ½ exp(−α²/2) erfcx(−ζ)]/Φ(α) with ζ = (sσ − α)/√2 and erfcx(z) = exp(z²) erfc(z);
    /// where Re ζ > 0 the two would cancel, and ½ exp(−α²/2) erfcx(ζ)/Φ(α) is the same. Entire.
    fn laplace(&self, s: Complex64) -> Complex64 {
        let zeta = (s * self.std - self.alpha) / SQRT_2;
        let boundary = 0.5 * (-0.5 * self.alpha * self.alpha).exp();
        let tail = |zeta| boundary * normal::complex_erfcx(zeta);
        if zeta.re > 0.0 {
            return tail(zeta) / self.above;
        }
        ((0.5 * s * s * self.std * self.std - s * self.mean).exp() - tail(-zeta)) / self.above
    }

    /// P̂' = (sσ² − μ) P̂ − σ² p(0), from σ²p' = −(x − μ)p by parts.
    fn laplace_with_derivative(&self, s: Complex64) -> [Complex64; 2] {
        let (value, variance) = (self.laplace(s), self.std * self.std);
        [value, (s * variance - self.mean) * value - variance * self.density(0.0)]
    }

    /// Rejection of negative draws: at worst every other one.
    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        ziggurat::fill(stream, out, |z| self.mean + self.std * z, |x| x >= 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_gaussian() {
        let law = Gaussian::new(0.0, 1.0).unwrap();
        // Closed forms, a few roundings each.
        assert!((law.mean() - (2.0 / std::f64::consts::PI).sqrt()).abs() < 1e-15);
        assert!((law.std() - (1.0 - 2.0 / std::f64::consts::PI).sqrt()).abs() < 1e-15);
        assert!((law.upper_moment(2, -1.0) - 1.0).abs() < 1e-15);
        assert_eq!(law.survival(0.0), 1.0);
    }

    #[test]
    fn refuses_what_it_cannot_be() {
        for (mean, std) in [(f64::NAN, 1.0), (-1.0, 1.0), (1.0, 0.0), (1.0, f64::INFINITY)] {
            assert!(Gaussian::new(mean, std).is_err());
        }
        assert!(Gaussian::new(1.0, 0.1).unwrap().with_parameter("scale", 1.0).is_err());
    }
}
