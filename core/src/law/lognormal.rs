//! The lognormal distribution: a tail heavier than any exponential.

use std::f64::consts::FRAC_PI_2;

use num_complex::Complex64;
use rand_distr::{Distribution, StandardNormal};

use super::quadrature::trapezoid;
use super::range::{length, width};
use super::{
    Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, invert_ln_survival, normal, shared, unknown,
};
use crate::Result;
use crate::random::Stream;

/// Lognormal distribution of mean m and standard deviation σ (of ξ, not of ln ξ): ln ξ is Gaussian of
/// variance s² = ln(1 + σ²/m²) around ln M, M = m/√(1 + σ²/m²).
///
/// Relative errors of density and S are about 1e-15 (1 + |ln S|). z below is ln(x/M)/s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lognormal {
    mean: f64,
    std: f64,
    /// The median M, the spread s of ln ξ, and m − M.
    median: f64,
    spread: f64,
    offset: f64,
}

impl Lognormal {
    /// The distribution of this mean and standard deviation.
    ///
    /// # Errors
    /// A mean or a standard deviation that is not finite and above 0.
    pub fn new(mean: f64, std: f64) -> Result<Self> {
        let mean = length("mean", mean)?;
        let std = width(mean, std)?;
        let variation = std / mean;
        let ratio = 1.0_f64.hypot(variation);
        let (median, spread) = (mean / ratio, (variation * variation).ln_1p().sqrt());
        Ok(Self { mean, std, median, spread, offset: median * variation * (variation / (1.0 + ratio)) })
    }

    /// z for x > 0. In narrow distributions ln(1 + u) keeps the digits of x − M, where M itself is not known
    /// accurately enough.
    fn standard(&self, x: f64) -> f64 {
        let u = (x - self.mean + self.offset) / self.median;
        (if u.abs() < 0.5 { u.ln_1p() } else { (x / self.median).ln() }) / self.spread
    }
}

impl Law for Lognormal {
    fn name(&self) -> &'static str {
        "lognormal"
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

    /// S = Q(z) with z = ln(x/M)/s: ∂S/∂θ = p(x) x [∂ ln M/∂θ + z ∂s/∂θ]. With w = σ/m and D = 1 + w², ∂ ln M is
    /// (1 + w²/D)/m for m and −w/(mD) for σ; s ∂s is −w²/(mD) and w/(mD).
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let (law, w) = (*self, self.std / self.mean);
        let whole = self.mean * (1.0 + w * w);
        let (median, spread) = match name {
            "mean" => (1.0 / self.mean + w * w / whole, -w * w / whole),
            "std" => (-w / whole, w / whole),
            _ => return Err(unknown(self, name)),
        };
        Ok(Box::new(move |x| {
            if x <= 0.0 {
                return 0.0;
            }
            x * law.density(x) * (median + law.standard(x) * spread / law.spread)
        }))
    }

    /// φ(z)/(s x).
    fn density(&self, x: f64) -> f64 {
        if x <= 0.0 { 0.0 } else { normal::density(self.standard(x)) / (self.spread * x) }
    }

    fn ln_density(&self, x: f64) -> f64 {
        if x <= 0.0 {
            return f64::NEG_INFINITY;
        }
        normal::ln_density(self.standard(x)) - self.spread.ln() - x.ln()
    }

    fn survival(&self, x: f64) -> f64 {
        if x <= 0.0 { 1.0 } else { normal::survival(self.standard(x)) }
    }

    fn ln_survival(&self, x: f64) -> f64 {
        if x <= 0.0 { 0.0 } else { normal::ln_survival(self.standard(x)) }
    }

    /// ln Φ(z).
    fn ln_cumulative(&self, x: f64) -> f64 {
        if x <= 0.0 { f64::NEG_INFINITY } else { normal::ln_survival(-self.standard(x)) }
    }

    fn hazard(&self, x: f64) -> f64 {
        if x <= 0.0 { 0.0 } else { normal::hazard(self.standard(x)) / (self.spread * x) }
    }

    fn quantile(&self, p: f64) -> f64 {
        invert_ln_survival(|x| self.ln_survival(x), (-p).ln_1p())
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        invert_ln_survival(|x| self.ln_survival(x), q.ln())
    }

    /// ⟨ξⁿ⟩ P(Z > z − ns) with ⟨ξⁿ⟩ = mⁿ (1 + σ²/m²)^{n(n−1)/2}.
    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let n = f64::from(order);
        let whole = self.mean.powi(order as i32) * (0.5 * n * (n - 1.0) * self.spread * self.spread).exp();
        if x <= 0.0 { whole } else { whole * normal::survival(self.standard(x) - n * self.spread) }
    }

    fn std(&self) -> f64 {
        self.std
    }

    /// None: the density and all its derivatives vanish at 0.
    fn breakpoints(&self) -> Vec<Breakpoint> {
        Vec::new()
    }

    fn laplace_is_closed(&self) -> bool {
        false
    }

    fn decay_rate(&self) -> f64 {
        0.0
    }

    /// ∫ φ(v) exp(−s M e^{s_ln v}) dv by the trapezoidal rule. For Re s < 0 the integral diverges; its
    /// analytic continuation from Re s > 0 is the same integral along x = t e^{∓iθ}, rotated just so far, θ =
    /// atan(|Re s|/|Im s|), that e^{−sx} no longer grows. Relative accuracy drops by a factor of e^{θ²/(2
    /// s_ln²)}. On the negative real axis, the branch cut of the continuation, it is infinite like the
    /// transform itself.
    fn laplace(&self, s: Complex64) -> Complex64 {
        if s.im == 0.0 && s.re < 0.0 {
            return Complex64::from(f64::INFINITY);
        }
        let angle = (s.arg().abs() - FRAC_PI_2).max(0.0).copysign(s.im);
        let scaled = s * self.median * Complex64::cis(-angle);
        // φ is below 1e-17 beyond.
        trapezoid(-8.7, 8.7, |v| {
            let weight = 0.5 * Complex64::new(v, -angle / self.spread).powi(2);
            (-weight - scaled * (self.spread * v).exp()).exp() / std::f64::consts::TAU.sqrt()
        })
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        for x in out {
            let z: f64 = StandardNormal.sample(stream);
            *x = self.median * (self.spread * z).exp();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_asked_for() {
        let law = Lognormal::new(2.0, 0.5).unwrap();
        // A few roundings.
        assert!((law.mean() - 2.0).abs() < 1e-15);
        assert!((law.upper_moment(2, -1.0) - 4.25).abs() < 1e-14);
        assert!((law.survival(law.median) - 0.5).abs() < 1e-15);
    }

    #[test]
    fn its_transform_has_no_value_on_the_negative_axis() {
        assert!(Lognormal::new(1.0, 0.1).unwrap().laplace(Complex64::from(-0.1)).re.is_infinite());
    }
}
