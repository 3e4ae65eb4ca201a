//! The uniform distribution on an interval.

use num_complex::Complex64;

use super::range::{length, length_or_zero};
use super::{Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, Zone, shared, unknown};
use crate::random::Stream;
use crate::{Error, Result};

/// Uniform distribution on [a, b], 0 ≤ a < b: p(x) = 1/(b − a) for a ≤ x < b.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangular {
    min: f64,
    max: f64,
}

impl Rectangular {
    /// The distribution on [`min`, `max`].
    ///
    /// # Errors
    /// A `min` below 0, a `max` not above it, or one of them not finite.
    pub fn new(min: f64, max: f64) -> Result<Self> {
        length_or_zero("min", min)?;
        if !(max.is_finite() && max > min) {
            return Err(Error::invalid("max", format!("a finite number above min = {min}"), max));
        }
        length("max", max)?;
        Ok(Self { min, max })
    }

    fn width(&self) -> f64 {
        self.max - self.min
    }
}

impl Law for Rectangular {
    fn name(&self) -> &'static str {
        "rectangular"
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("min", self.min), Parameter::new("max", self.max)]
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        match name {
            "min" => shared(Self::new(value, self.max)),
            "max" => shared(Self::new(self.min, value)),
            _ => Err(unknown(self, name)),
        }
    }

    /// On [a, b): (b − x)/(b − a)² for a, (x − a)/(b − a)² for b.
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let Self { min, max } = *self;
        let inside = move |x: f64, value: f64| {
            if x >= min && x < max { value / (max - min).powi(2) } else { 0.0 }
        };
        match name {
            "min" => Ok(Box::new(move |x| inside(x, max - x))),
            "max" => Ok(Box::new(move |x| inside(x, x - min))),
            _ => Err(unknown(self, name)),
        }
    }

    fn density(&self, x: f64) -> f64 {
        if x >= self.min && x < self.max { 1.0 / self.width() } else { 0.0 }
    }

    fn survival(&self, x: f64) -> f64 {
        ((self.max - x.max(self.min)) / self.width()).max(0.0)
    }

    fn ln_survival(&self, x: f64) -> f64 {
        let below = (x.max(self.min) - self.min) / self.width();
        if below < 0.5 { (-below).ln_1p() } else { self.survival(x).ln() }
    }

    fn hazard(&self, x: f64) -> f64 {
        if x < self.min { 0.0 } else { 1.0 / (self.max - x).max(0.0) }
    }

    fn quantile(&self, p: f64) -> f64 {
        if p < 0.5 { self.min + p * self.width() } else { self.upper_quantile(1.0 - p) }
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        self.max - q * self.width()
    }

    /// (bⁿ⁺¹ − yⁿ⁺¹)/((n+1)(b − a)) with y = max(x, a), as S(y)/(n+1) Σ_j b^j y^{n−j}: nothing cancels.
    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let y = x.max(self.min);
        let sum = (0..=order).fold((0.0, 1.0), |(sum, power), _| (sum * y + power, power * self.max)).0;
        self.survival(x) * sum / f64::from(order + 1)
    }

    fn std(&self) -> f64 {
        self.width() / 12.0_f64.sqrt()
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        let amplitude = 1.0 / self.width();
        vec![
            Breakpoint { position: self.min, exponent: 0.0, amplitude },
            Breakpoint { position: self.max, exponent: 0.0, amplitude: -amplitude },
        ]
    }

    /// A polynomial between its breakpoints.
    fn zones(&self) -> Vec<Zone> {
        vec![Zone { low: self.quantile(0.0), high: self.upper_quantile(0.0), resolution: f64::INFINITY }]
    }

    /// exp(−s(a+b)/2) sinh(h)/h with h = s(b − a)/2. Entire.
    fn laplace(&self, s: Complex64) -> Complex64 {
        let half = 0.5 * s * self.width();
        // Below this |h|, sinh(h)/h is 1 to the last bit, and 0/0 would be near.
        let shape = if half.norm() < 1e-9 { Complex64::from(1.0) } else { half.sinh() / half };
        (-0.5 * s * (self.min + self.max)).exp() * shape
    }

    /// With f(h) = sinh(h)/h, f' = (cosh(h) − f)/h, near 0 by its series h/3 + h³/30 + h⁵/840 + h⁷/45360.
    fn laplace_with_derivative(&self, s: Complex64) -> [Complex64; 2] {
        let (middle, half) = (0.5 * (self.min + self.max), 0.5 * s * self.width());
        let (value, front) = (self.laplace(s), (-s * middle).exp());
        let slope = if half.norm() < 0.1 {
            let square = half * half;
            half * (1.0 / 3.0 + square * (1.0 / 30.0 + square * (1.0 / 840.0 + square / 45_360.0)))
        } else {
            (half.cosh() - half.sinh() / half) / half
        };
        [value, 0.5 * self.width() * front * slope - middle * value]
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        out.fill_with(|| self.min + self.width() * stream.uniform());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_belong_to_the_right() {
        let law = Rectangular::new(0.5, 1.0).unwrap();
        assert_eq!((law.density(0.5), law.density(1.0)), (2.0, 0.0));
        assert_eq!((law.survival(0.5), law.survival(1.0)), (1.0, 0.0));
        assert_eq!(law.hazard(1.0), f64::INFINITY);
        assert_eq!((law.quantile(0.0), law.quantile(1.0)), (0.5, 1.0));
        assert_eq!(law.upper_moment(2, -1.0), 7.0 / 12.0);
    }

    #[test]
    fn refuses_an_empty_interval() {
        for (min, max) in [(1.0, 1.0), (-0.1, 1.0), (0.0, f64::INFINITY), (f64::NAN, 1.0)] {
            assert!(Rectangular::new(min, max).is_err());
        }
    }
}
