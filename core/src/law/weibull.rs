//! The Weibull distribution: the weakest of many links.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use num_complex::Complex64;
use rand_distr::{Distribution, Exp1};

use super::incomplete_gamma::{GammaShape, IncompleteGamma};
use super::quadrature::trapezoid;
use super::range::length;
use super::{
    Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, breakpoint_at_zero, positive, shared, unknown,
};
use crate::Result;
use crate::random::Stream;

/// Weibull distribution of shape k and scale λ: S(x) = exp(−y), y = (x/λ)ᵏ.
///
/// Relative errors of density and S are about 1e-15 (1 + y).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weibull {
    shape: f64,
    scale: f64,
    std: f64,
}

impl Weibull {
    /// The distribution of this shape and scale.
    ///
    /// # Errors
    /// A shape or a scale that is not finite and above 0, or moments that overflow.
    pub fn new(shape: f64, scale: f64) -> Result<Self> {
        let (shape, scale) = (positive("shape", shape)?, length("scale", scale)?);
        let std = positive("shape", scale * unit_std(shape))?;
        Ok(Self { shape, scale, std })
    }

    /// The shape k at which the coefficient of variation is `width`: Γ(1 + 2/k)/Γ(1 + 1/k)² = 1 + `width`², by
    /// bisection between 0.1 and 1e5: a width out of this range gives an end of it. Near 1e5 rounding of 1 + 2/k leaves a relative
    /// error of some 1e-6.
    pub fn shape_of_width(width: f64) -> f64 {
        let variance = |k: f64| (libm::lgamma(1.0 + 2.0 / k) - 2.0 * libm::lgamma(1.0 + 1.0 / k)).exp_m1();
        let (mut low, mut high) = (0.1, 1e5);
        for _ in 0..200 {
            let middle = f64::sqrt(low * high);
            if variance(middle).sqrt() > width { low = middle } else { high = middle }
        }
        low
    }

    fn exponent(&self, x: f64) -> f64 {
        (x.max(0.0) / self.scale).powf(self.shape)
    }
}

/// y e^{−y} k du = −dS with u = ln(x/λ), y = e^{ku}.
fn weight(shape: f64, u: Complex64) -> Complex64 {
    let ln = u * shape;
    shape * (ln - ln.exp()).exp()
}

/// σ/λ = √(Γ(1 + 2/k) − Γ(1 + 1/k)²). For a large shape this cancels; there ∫ (x − x̄)² p by quadrature.
fn unit_std(shape: f64) -> f64 {
    let mean = libm::tgamma(1.0 + 1.0 / shape);
    if shape < 2.0 {
        return (libm::tgamma(1.0 + 2.0 / shape) - mean * mean).sqrt();
    }
    let square = |u: f64| weight(shape, u.into()) * (u.exp_m1() - (mean - 1.0)).powi(2);
    trapezoid(-45.0 / shape, 4.0 / shape, square).re.sqrt()
}

impl Law for Weibull {
    fn name(&self) -> &'static str {
        "weibull"
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("shape", self.shape), Parameter::new("scale", self.scale)]
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        match name {
            "shape" => shared(Self::new(value, self.scale)),
            "scale" => shared(Self::new(self.shape, value)),
            _ => Err(unknown(self, name)),
        }
    }

    /// −S y ln(x/λ) for k, S y k/λ for λ, with y = (x/λ)ᵏ.
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let law = *self;
        let fall = move |x: f64| {
            let survival = law.survival(x);
            if survival > 0.0 { survival * law.exponent(x) } else { 0.0 }
        };
        match name {
            "shape" => Ok(Box::new(move |x| if x > 0.0 { -fall(x) * (x / law.scale).ln() } else { 0.0 })),
            "scale" => Ok(Box::new(move |x| fall(x) * law.shape / law.scale)),
            _ => Err(unknown(self, name)),
        }
    }

    fn density(&self, x: f64) -> f64 {
        let survival = self.survival(x);
        if survival == 0.0 { 0.0 } else { self.hazard(x) * survival }
    }

    /// ln(k/λ) + (k − 1) ln(x/λ) − y.
    fn ln_density(&self, x: f64) -> f64 {
        let (exponent, ratio) = (self.exponent(x), x / self.scale);
        if ratio <= 0.0 || exponent == f64::INFINITY {
            return self.density(x).ln();
        }
        (self.shape / self.scale).ln() + (self.shape - 1.0) * ratio.ln() - exponent
    }

    fn survival(&self, x: f64) -> f64 {
        (-self.exponent(x)).exp()
    }

    fn ln_survival(&self, x: f64) -> f64 {
        -self.exponent(x)
    }

    /// ln(1 − e^{−y}); ln y = k ln(x/λ) where y underflows.
    fn ln_cumulative(&self, x: f64) -> f64 {
        let exponent = self.exponent(x);
        if x > 0.0 && exponent < f64::MIN_POSITIVE {
            return self.shape * (x / self.scale).ln();
        }
        let below = -(-exponent).exp_m1();
        if below < 0.5 { below.ln() } else { (-self.survival(x)).ln_1p() }
    }

    /// (k/λ)(x/λ)^{k−1}.
    fn hazard(&self, x: f64) -> f64 {
        if x < 0.0 { 0.0 } else { self.shape / self.scale * (x / self.scale).powf(self.shape - 1.0) }
    }

    fn quantile(&self, p: f64) -> f64 {
        self.scale * (-(-p).ln_1p()).powf(1.0 / self.shape)
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        self.scale * (-q.ln()).powf(1.0 / self.shape)
    }

    /// λⁿ Γ(1 + n/k, y).
    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        if order == 0 {
            return self.survival(x);
        }
        let (a, y) = (1.0 + f64::from(order) / self.shape, self.exponent(x));
        let upper =
            if y > 0.0 { IncompleteGamma::new(&GammaShape::new(a), y, (y - a) / a).upper() } else { 1.0 };
        self.scale.powi(order as i32) * libm::tgamma(a) * upper
    }

    fn std(&self) -> f64 {
        self.std
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        breakpoint_at_zero(self.shape - 1.0, libm::tgamma(self.shape + 1.0) / self.scale.powf(self.shape))
    }

    fn laplace_is_closed(&self) -> bool {
        false
    }

    fn decay_rate(&self) -> f64 {
        match self.shape {
            shape if shape > 1.0 => f64::INFINITY,
            shape if shape < 1.0 => 0.0,
            _ => 1.0 / self.scale,
        }
    }

    /// ∫ e^{−sx} dP over u = ln(x/λ) by the trapezoidal rule; entire for k > 1, 1/(1 + sλ) for k = 1. For Re
    /// s < 0 along x = t e^{∓iθ}, rotated until e^{−sx} no longer grows, as far as e^{−y} allows. For k < 1,
    /// where the integral diverges, that is its analytic continuation, infinite on the negative real axis
    /// like the integral.
    ///
    /// The absolute error is 1e-14; for k > 1 and |arg s| > π/2 + 1.2/k it is 1e-14 of the largest e^{−sx} p.
    fn laplace(&self, s: Complex64) -> Complex64 {
        let s = s * self.scale;
        if self.shape == 1.0 {
            return (1.0 + s).inv();
        }
        if self.shape < 1.0 && s.im == 0.0 && s.re < 0.0 {
            return Complex64::from(f64::INFINITY);
        }
        let rotation = if s.im == 0.0 { 0.0 } else { rotation(self.shape, s.arg().abs()).copysign(s.im) };
        // By Cauchy's theorem the integral along the rotated ray is the same, since the integrand
        // is analytic and decays in between.
        let turned = s * Complex64::cis(-rotation);
        let upper_limit = upper_limit(self.shape, (-turned.re).max(0.0), (self.shape * rotation).cos());
        trapezoid(-45.0 / self.shape, upper_limit, |u| {
            weight(self.shape, Complex64::new(u, -rotation)) * (-turned * u.exp()).exp()
        })
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        for x in out {
            let unit: f64 = Exp1.sample(stream);
            *x = self.scale * unit.powf(1.0 / self.shape);
        }
    }
}

/// The angle by which the contour is rotated for |arg s| = `angle`.
fn rotation(shape: f64, angle: f64) -> f64 {
    let (needed, most) = ((angle - FRAC_PI_2).max(0.0), 1.2 / shape);
    if shape > 1.0 {
        return needed.min(most);
    }
    // A heavy tail extends far into the oscillations of e^{−sx}; a larger rotation makes it decay there.
    (angle - FRAC_PI_4).max(0.0).min(most).max(needed)
}

/// A u above which c y exceeds growth · eᵘ by 45 in the exponent.
fn upper_limit(shape: f64, growth: f64, c: f64) -> f64 {
    let mut u = 4.0 / shape;
    while c * (shape * u).exp() - growth * u.exp() < 45.0 + shape * u {
        u += 0.25 / shape;
    }
    u
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_shape_keeps_its_width() {
        // π/√6 (1/k + …): the Gumbel limit, to order 1/k.
        let limit = std::f64::consts::PI / 6.0_f64.sqrt();
        assert!((1e6 * unit_std(1e6) / limit - 1.0).abs() < 1e-5);
        // The two forms meet; the closed one cancels by a factor of about five.
        let closed = (libm::tgamma(2.0) - libm::tgamma(1.5).powi(2)).sqrt();
        assert!((unit_std(2.0) / closed - 1.0).abs() < 1e-14);
    }

    #[test]
    fn refuses_what_it_cannot_be() {
        for (shape, scale) in [(0.0, 1.0), (1.0, -1.0), (f64::NAN, 1.0), (1e-3, 1.0)] {
            assert!(Weibull::new(shape, scale).is_err());
        }
    }
}
