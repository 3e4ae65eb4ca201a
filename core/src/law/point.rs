//! The point distribution (Dirac delta): identical contacts.

use num_complex::Complex64;

use super::range::length_or_zero;
use super::{Atom, Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, Zone, shared, unknown};
use crate::random::Stream;
use crate::{Error, Result};

/// The point mass at a ≥ 0: P(ξ = a) = 1.
///
/// It has no density: the hazard rate is 0 below a and, as wherever S = 0, infinite from a on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    at: f64,
}

impl Point {
    /// The point mass at `at`.
    ///
    /// # Errors
    /// A position below 0 or not finite.
    pub fn new(at: f64) -> Result<Self> {
        Ok(Self { at: length_or_zero("at", at)? })
    }
}

impl Law for Point {
    fn name(&self) -> &'static str {
        "point"
    }

    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::new("at", self.at)]
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        match name {
            "at" => shared(Self::new(value)),
            _ => Err(unknown(self, name)),
        }
    }

    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        self.with_parameter(name, self.at)?;
        let expected = "a parameter on which S depends smoothly: where a point mass moves, S jumps";
        Err(Error::invalid(name, expected, "the position of a point mass"))
    }

    fn density(&self, _x: f64) -> f64 {
        0.0
    }

    fn survival(&self, x: f64) -> f64 {
        if x < self.at { 1.0 } else { 0.0 }
    }

    fn ln_survival(&self, x: f64) -> f64 {
        self.survival(x).ln()
    }

    fn hazard(&self, x: f64) -> f64 {
        if x < self.at { 0.0 } else { f64::INFINITY }
    }

    fn quantile(&self, _p: f64) -> f64 {
        self.at
    }

    fn upper_quantile(&self, _q: f64) -> f64 {
        self.at
    }

    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        self.survival(x) * self.at.powi(order as i32)
    }

    fn std(&self) -> f64 {
        0.0
    }

    fn atoms(&self) -> Vec<Atom> {
        vec![Atom { position: self.at, weight: 1.0 }]
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        Vec::new()
    }

    /// None: there is no density to resolve.
    fn zones(&self) -> Vec<Zone> {
        Vec::new()
    }

    /// exp(−sa). Entire.
    fn laplace(&self, s: Complex64) -> Complex64 {
        (-s * self.at).exp()
    }

    fn laplace_with_derivative(&self, s: Complex64) -> [Complex64; 2] {
        let value = self.laplace(s);
        [value, -self.at * value]
    }

    fn fill(&self, _stream: &mut Stream, out: &mut [f64]) {
        out.fill(self.at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn breaks_at_its_point_and_nowhere_else() {
        let law = Point::new(1.0).unwrap();
        assert_eq!(law.survival(1.0_f64.next_down()), 1.0);
        assert_eq!(law.survival(1.0), 0.0);
        assert_eq!(law.mean(), 1.0);
        assert!(Point::new(-0.5).is_err());
    }
}
