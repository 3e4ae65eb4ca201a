//! The exponential distribution: contacts without memory.

use num_complex::Complex64;
use rand_distr::{Distribution, Exp1};

use super::range::length;
use super::{Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, breakpoint_at_zero, shared, unknown};
use crate::Result;
use crate::random::Stream;

/// Exponential distribution of mean m: S(x) = exp(−x/m), constant hazard rate 1/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exponential {
    mean: f64,
}

impl Exponential {
    /// The distribution of this mean.
    ///
    /// # Errors
    /// A mean that is not finite and above 0.
    pub fn new(mean: f64) -> Result<Self> {
        Ok(Self { mean: length("mean", mean)? })
    }
}

impl Law for Exponential {
    fn name(&self) -> &'static str {
        "exponential"
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("mean", self.mean)]
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        match name {
            "mean" => shared(Self::new(value)),
            _ => Err(unknown(self, name)),
        }
    }

    /// x e^{−x/m}/m².
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let law = *self;
        match name {
            "mean" => Ok(Box::new(move |x| x.max(0.0) * law.survival(x) / law.mean.powi(2))),
            _ => Err(unknown(self, name)),
        }
    }

    fn density(&self, x: f64) -> f64 {
        if x < 0.0 { 0.0 } else { self.survival(x) / self.mean }
    }

    fn ln_density(&self, x: f64) -> f64 {
        if x < 0.0 { f64::NEG_INFINITY } else { -x / self.mean - self.mean.ln() }
    }

    fn survival(&self, x: f64) -> f64 {
        self.ln_survival(x).exp()
    }

    fn ln_survival(&self, x: f64) -> f64 {
        -x.max(0.0) / self.mean
    }

    fn hazard(&self, x: f64) -> f64 {
        if x < 0.0 { 0.0 } else { 1.0 / self.mean }
    }

    fn quantile(&self, p: f64) -> f64 {
        -self.mean * (-p).ln_1p()
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        -self.mean * q.ln()
    }

    /// M_n = xⁿ S(x) + n m M_{n−1}, by parts.
    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let x = x.max(0.0);
        let survival = self.survival(x);
        let step = |(moment, boundary): (f64, f64), n| {
            (boundary * x + f64::from(n) * self.mean * moment, boundary * x)
        };
        (1..=order).fold((survival, survival), step).0
    }

    fn std(&self) -> f64 {
        self.mean
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        breakpoint_at_zero(0.0, 1.0 / self.mean)
    }

    fn constant_hazard(&self) -> Option<f64> {
        Some(1.0 / self.mean)
    }

    fn decay_rate(&self) -> f64 {
        1.0 / self.mean
    }

    /// 1/(1 + sm), a pole at s = −1/m.
    fn laplace(&self, s: Complex64) -> Complex64 {
        (1.0 + s * self.mean).inv()
    }

    fn laplace_with_derivative(&self, s: Complex64) -> [Complex64; 2] {
        let value = self.laplace(s);
        [value, -self.mean * value * value]
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        for x in out {
            let unit: f64 = Exp1.sample(stream);
            *x = self.mean * unit;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_above_x() {
        let law = Exponential::new(2.0).unwrap();
        // M_2(x) = (x² + 2mx + 2m²) e^{−x/m}; a few roundings.
        assert!((law.upper_moment(2, 3.0) - 29.0 * (-1.5_f64).exp()).abs() < 1e-14);
        assert_eq!((law.mean(), law.hazard(1e9)), (2.0, 0.5));
        assert!(Exponential::new(0.0).is_err());
    }
}
