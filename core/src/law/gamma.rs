//! The gamma distribution: sums of exponential waiting times.

use num_complex::Complex64;
use rand_distr::Distribution;

use super::incomplete_gamma::{GammaShape, IncompleteGamma, upper_by_shape};
use super::range::{length, width};
use super::{
    Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, breakpoint_at_zero, invert_ln_survival,
    shared, unknown,
};
use crate::random::Stream;
use crate::{Error, Result};

/// Gamma distribution of mean m and standard deviation σ: p(x) = x^{k−1} e^{−x/θ}/(Γ(k) θᵏ) with shape k =
/// (m/σ)² and scale θ = σ²/m.
///
/// Relative errors of density, S and ln S are about 1e-15 (1 + |ln S|), for any shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gamma {
    mean: f64,
    std: f64,
    shape: GammaShape,
    scale: f64,
    sampler: rand_distr::Gamma<f64>,
}

impl Gamma {
    /// The distribution of this mean and standard deviation.
    ///
    /// # Errors
    /// A mean or a standard deviation that is not finite and above 0.
    pub fn new(mean: f64, std: f64) -> Result<Self> {
        let mean = length("mean", mean)?;
        let std = width(mean, std)?;
        let (shape, scale) = ((mean / std).powi(2), std * (std / mean));
        let sampler = rand_distr::Gamma::new(shape, scale)
            .map_err(|_| Error::invalid("std", format!("within 1e±150 of mean = {mean}"), std))?;
        Ok(Self { mean, std, shape: GammaShape::new(shape), scale, sampler })
    }

    fn at(&self, x: f64) -> IncompleteGamma {
        IncompleteGamma::new(&self.shape, x / self.scale, (x - self.mean) / self.mean)
    }

    /// p(0⁺), which is also the hazard rate there.
    fn density_at_zero(&self) -> f64 {
        match self.shape.a.total_cmp(&1.0) {
            std::cmp::Ordering::Less => f64::INFINITY,
            std::cmp::Ordering::Equal => 1.0 / self.scale,
            std::cmp::Ordering::Greater => 0.0,
        }
    }
}

impl Law for Gamma {
    fn name(&self) -> &'static str {
        "gamma"
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

    /// With k = m²/σ² and y = xm/σ²: ∂Q/∂k and ∂Q/∂y = −D/y give (2k ∂Q/∂k − D)/m and 2(D − k ∂Q/∂k)/σ.
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let (law, by_mean) = (*self, name == "mean");
        if !by_mean && name != "std" {
            return Err(unknown(self, name));
        }
        Ok(Box::new(move |x| {
            if x <= 0.0 {
                return 0.0;
            }
            let (y, excess) = (x / law.scale, (x - law.mean) / law.mean);
            let (by_shape, kernel) = (upper_by_shape(&law.shape, y, excess), law.at(x).kernel());
            if by_mean { (2.0 * by_shape - kernel) / law.mean } else { 2.0 * (kernel - by_shape) / law.std }
        }))
    }

    fn density(&self, x: f64) -> f64 {
        if x < 0.0 {
            return 0.0;
        }
        if x == 0.0 { self.density_at_zero() } else { self.at(x).kernel() / x }
    }

    /// ln D − ln x with D = p(x) x.
    fn ln_density(&self, x: f64) -> f64 {
        if x <= 0.0 { self.density(x).ln() } else { self.at(x).ln_kernel() - x.ln() }
    }

    fn survival(&self, x: f64) -> f64 {
        if x <= 0.0 { 1.0 } else { self.at(x).upper() }
    }

    fn ln_survival(&self, x: f64) -> f64 {
        if x <= 0.0 { 0.0 } else { self.at(x).ln_upper() }
    }

    fn ln_cumulative(&self, x: f64) -> f64 {
        if x <= 0.0 { f64::NEG_INFINITY } else { self.at(x).ln_lower() }
    }

    fn hazard(&self, x: f64) -> f64 {
        if x < 0.0 {
            return 0.0;
        }
        if x == 0.0 { self.density_at_zero() } else { self.at(x).kernel_over_upper() / x }
    }

    fn quantile(&self, p: f64) -> f64 {
        invert_ln_survival(|x| self.ln_survival(x), (-p).ln_1p())
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        invert_ln_survival(|x| self.ln_survival(x), q.ln())
    }

    /// θⁿ G_n with G_0 = Q and G_{n+1} = (k + n) G_n + yⁿ D, y = x/θ: Γ(a+1, y) = a Γ(a, y) + yᵃ e^{−y}.
    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let x = x.max(0.0);
        let (survival, kernel) =
            if x == 0.0 { (1.0, 0.0) } else { (self.at(x).upper(), self.at(x).kernel()) };
        let step = |(moment, boundary): (f64, f64), n| {
            ((self.mean + f64::from(n) * self.scale) * moment + self.scale * boundary, boundary * x)
        };
        (0..order).fold((survival, kernel), step).0
    }

    fn std(&self) -> f64 {
        self.std
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        breakpoint_at_zero(self.shape.a - 1.0, self.scale.powf(-self.shape.a))
    }

    fn decay_rate(&self) -> f64 {
        1.0 / self.scale
    }

    /// (1 + sθ)^{−k}, cut along the real axis below the singularity −1/θ.
    fn laplace(&self, s: Complex64) -> Complex64 {
        let w = s * self.scale;
        // ln(1 + w), accurate for small w and large k.
        let modulus = 0.5 * (2.0 * w.re + w.norm_sqr()).ln_1p();
        (-self.shape.a * Complex64::new(modulus, w.im.atan2(1.0 + w.re))).exp()
    }

    /// P̂' = −kθ P̂/(1 + sθ).
    fn laplace_with_derivative(&self, s: Complex64) -> [Complex64; 2] {
        let value = self.laplace(s);
        [value, -self.shape.a * self.scale * value / (1.0 + s * self.scale)]
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        out.fill_with(|| self.sampler.sample(stream));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shape_one_is_exponential() {
        let law = Gamma::new(2.0, 2.0).unwrap();
        for x in [0.0, 0.3, 2.0, 40.0_f64] {
            // Some roundings, times the exponent's.
            let tolerance = 1e-15 * (1.0 + x);
            assert!((law.survival(x) / (-0.5 * x).exp() - 1.0).abs() < tolerance);
            assert!((law.hazard(x) - 0.5).abs() < 1e-15);
        }
        assert_eq!(law.breakpoints(), [Breakpoint { position: 0.0, exponent: 0.0, amplitude: 0.5 }]);
    }

    #[test]
    fn refuses_what_it_cannot_be() {
        for (mean, std) in [(0.0, 1.0), (1.0, 0.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
            assert!(Gamma::new(mean, std).is_err());
        }
    }
}
