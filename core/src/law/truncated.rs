//! A distribution conditioned on values below a highest one.

use std::convert::Infallible;

use num_complex::Complex64;

use super::{
    Atom, Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, Zone, expectation, invert_ln_survival,
    shared, unknown,
};
use crate::random::Stream;
use crate::{Error, Result};

/// A distribution P conditioned on ξ < b: density p(x)/P(ξ < b) for x < b, and 0 above.
///
/// S(x) = (P(ξ > x) − P(ξ ≥ b))/P(ξ < b), with an error of 1e-16/P(ξ < b) and no better relative to S close to b. Its parameters
/// are those of P, and derivatives by them leave b as it is.
#[derive(Debug, Clone)]
pub struct Truncated {
    law: SharedLaw,
    highest: f64,
    /// P(ξ < b) and P(ξ ≥ b).
    kept: f64,
    left_out: f64,
}

impl Truncated {
    /// The distribution `law` conditioned on ξ < `highest`.
    ///
    /// # Errors
    /// A highest value that is not a finite number above 0, or below which there is nothing.
    pub fn new(law: SharedLaw, highest: f64) -> Result<Self> {
        super::positive("highest", highest)?;
        let before = highest.next_down();
        let (kept, left_out) = (law.cumulative(before), law.survival(before));
        if kept > 0.0 {
            return Ok(Self { law, highest, kept, left_out });
        }
        let found = format!("{highest}, and all values at or above it");
        Err(Error::invalid("highest", "a number above the lowest value", found))
    }

    /// P(ξ ≥ b), the share of the whole distribution that is left out.
    pub fn left_out(&self) -> f64 {
        self.left_out
    }

    /// E[f(ξ)], accurate to 1e-13 of E|f|.
    fn expected(&self, f: impl Fn(f64) -> f64) -> f64 {
        let inside = |x: f64| if x < self.highest { Ok::<_, Infallible>(f(x)) } else { Ok(0.0) };
        let sum = expectation(self.law.as_ref(), [0.0, self.highest], inside);
        sum.unwrap_or_else(|never| match never {}) / self.kept
    }
}

impl Law for Truncated {
    fn name(&self) -> &'static str {
        "truncated"
    }

    fn parameters(&self) -> Vec<Parameter> {
        self.law.parameters()
    }

    /// With the same highest value.
    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        if self.parameters().iter().all(|parameter| parameter.name != name) {
            return Err(unknown(self, name));
        }
        shared(Self::new(self.law.with_parameter(name, value)?, self.highest))
    }

    /// With l = P(ξ ≥ b), S is (S_P − l)/(1 − l), and ∂S/∂θ is (∂S_P/∂θ − ∂l/∂θ (1 − S))/(1 − l), also where edges of P move.
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let whole = self.law.survival_derivative(name)?;
        let (law, left_out) = (self.clone(), whole(self.highest.next_down()));
        Ok(Box::new(
            move |x| {
                if x < law.highest { (whole(x) - left_out * law.cumulative(x)) / law.kept } else { 0.0 }
            },
        ))
    }

    fn density(&self, x: f64) -> f64 {
        if x < self.highest { self.law.density(x) / self.kept } else { 0.0 }
    }

    fn ln_density(&self, x: f64) -> f64 {
        if x < self.highest { self.law.ln_density(x) - self.kept.ln() } else { f64::NEG_INFINITY }
    }

    fn survival(&self, x: f64) -> f64 {
        if x < self.highest { (self.law.survival(x) - self.left_out).max(0.0) / self.kept } else { 0.0 }
    }

    fn ln_survival(&self, x: f64) -> f64 {
        // 1 − P(ξ ≤ x) where that is the larger one, so that no digit of a small P(ξ ≤ x) is lost.
        let below = self.cumulative(x);
        if below < 0.5 { (-below).ln_1p() } else { self.survival(x).ln() }
    }

    fn cumulative(&self, x: f64) -> f64 {
        if x < self.highest { (self.law.cumulative(x) / self.kept).min(1.0) } else { 1.0 }
    }

    fn ln_cumulative(&self, x: f64) -> f64 {
        if x < self.highest { (self.law.ln_cumulative(x) - self.kept.ln()).min(0.0) } else { 0.0 }
    }

    fn hazard(&self, x: f64) -> f64 {
        let survival = self.survival(x);
        if survival > 0.0 { self.density(x) / survival } else { f64::INFINITY }
    }

    fn quantile(&self, p: f64) -> f64 {
        if p < 0.5 {
            return self.law.quantile(p * self.kept);
        }
        self.upper_quantile(1.0 - p)
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        if q > 0.5 {
            return self.law.quantile((1.0 - q) * self.kept);
        }
        invert_ln_survival(|x| self.ln_survival(x), q.ln()).min(self.highest)
    }

    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        if x >= self.highest {
            return 0.0;
        }
        let above = |x| self.law.upper_moment(order, x);
        (above(x) - above(self.highest.next_down())).max(0.0) / self.kept
    }

    fn std(&self) -> f64 {
        let mean = self.mean();
        self.expected(|x| (x - mean).powi(2)).sqrt()
    }

    fn atoms(&self) -> Vec<Atom> {
        let below = self.law.atoms().into_iter().filter(|atom| atom.position < self.highest);
        below.map(|atom| Atom { weight: atom.weight / self.kept, ..atom }).collect()
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        let scaled = |b: Breakpoint| Breakpoint { amplitude: b.amplitude / self.kept, ..b };
        let below = self.law.breakpoints().into_iter().filter(|b| b.position < self.highest).map(scaled);
        let amplitude = -self.density(self.highest.next_down());
        let end = Breakpoint { position: self.highest, exponent: 0.0, amplitude };
        below.chain((amplitude < 0.0).then_some(end)).collect()
    }

    fn zones(&self) -> Vec<Zone> {
        let below = self.law.zones().into_iter().filter(|zone| zone.low < self.highest);
        below.map(|zone| Zone { high: zone.high.min(self.highest), ..zone }).collect()
    }

    fn seams(&self) -> Vec<f64> {
        let below = self.law.seams().into_iter().filter(|&x| x < self.highest);
        below.chain([self.highest]).collect()
    }

    fn laplace_is_closed(&self) -> bool {
        false
    }

    /// By quadrature, real and imaginary part. Entire.
    fn laplace(&self, s: Complex64) -> Complex64 {
        let part = |part: fn(Complex64) -> f64| self.expected(|x| part((-s * x).exp()));
        Complex64::new(part(|z| z.re), part(|z| z.im))
    }

    /// Draws of the whole distribution, without those at or above the highest value; by inversion where these are nearly all.
    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        /// The smallest part kept for which drawing again is fast.
        const LEAST: f64 = 0.01;
        if self.kept < LEAST {
            return out
                .fill_with(|| self.law.quantile(stream.uniform() * self.kept).min(self.highest.next_down()));
        }
        out.fill_with(|| {
            let mut drawn = [f64::INFINITY];
            while drawn[0] >= self.highest {
                self.law.fill(stream, &mut drawn);
            }
            drawn[0]
        });
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::{Exponential, Mixture, Point, Rectangular};
    use crate::random::Purpose;

    fn truncated(law: impl Law + 'static, highest: f64) -> Truncated {
        Truncated::new(Arc::new(law), highest).unwrap()
    }

    #[test]
    fn a_rectangular_distribution_stays_one() {
        let (cut, short) = (truncated(Rectangular::new(0.2, 2.0).unwrap(), 0.8), Rectangular::new(0.2, 0.8));
        let short = short.unwrap();
        // 0.6 of 1.8 are kept.
        assert!((cut.left_out() - 2.0 / 3.0).abs() < 1e-15);
        let same = |a: f64, b: f64| assert!((a - b).abs() < 1e-13 * b.abs().max(1.0), "{a} {b}");
        for x in [0.1, 0.2, 0.35, 0.5, 0.79] {
            same(cut.density(x), short.density(x));
            same(cut.survival(x), short.survival(x));
            same(cut.ln_survival(x), short.ln_survival(x));
            same(cut.upper_moment(2, x), short.upper_moment(2, x));
        }
        for p in [0.0, 0.3, 0.7, 1.0] {
            same(cut.quantile(p), short.quantile(p));
            same(cut.upper_quantile(p), short.upper_quantile(p));
        }
        same(cut.std(), short.std());
        let s = Complex64::new(-0.7, 3.0);
        // The quadrature's 1e-13, and that of rounding.
        assert!((cut.laplace(s) - short.laplace(s)).norm() < 1e-12);
        let edges = |law: &dyn Law| law.breakpoints().iter().map(|b| b.position).collect::<Vec<_>>();
        assert_eq!(edges(&cut), edges(&short));
    }

    #[test]
    fn an_exponential_distribution_has_the_closed_forms_of_its_truncation() {
        let cut = truncated(Exponential::new(1.0).unwrap(), 1.0);
        // Over 0 < x < 1: mean 1 − 1/(e − 1), and S = (e^{−x} − e^{−1})/(1 − e^{−1}).
        assert!((cut.mean() - (1.0 - 1.0 / 1.0_f64.exp_m1())).abs() < 1e-15);
        let survival = |x: f64| (-x).exp() * (x - 1.0).exp_m1() / (-1.0_f64).exp_m1();
        // A few roundings, of which 0.63 are kept.
        for x in [1e-9, 0.3, 0.999] {
            assert!((cut.survival(x) - survival(x)).abs() < 5e-16);
            assert!((cut.survival(cut.quantile(1.0 - survival(x))) - survival(x)).abs() < 1e-15);
        }
    }

    #[test]
    fn point_masses_at_the_highest_value_are_left_out() {
        let at = |x: f64| Arc::new(Point::new(x).unwrap()) as SharedLaw;
        let law = Mixture::new(vec![(0.5, at(0.25)), (0.25, at(0.5)), (0.25, at(1.0))]).unwrap();
        let cut = truncated(law, 1.0);
        assert_eq!(cut.left_out(), 0.25);
        assert_eq!(
            cut.atoms().iter().map(|a| (a.position, a.weight)).collect::<Vec<_>>(),
            [(0.25, 0.5 / 0.75), (0.5, 0.25 / 0.75)]
        );
        let mut drawn = [0.0; 100];
        cut.fill(&mut Stream::new(1, Purpose::Sample, 0), &mut drawn);
        assert!(drawn.iter().all(|&x| x < 1.0));
        assert!(Truncated::new(at(1.0), 1.0).is_err());
    }
}
