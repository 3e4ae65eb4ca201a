//! The size-biased distribution: one in which each value counts in proportion to its size.

use num_complex::Complex64;

use super::{Atom, Breakpoint, Law, Parameter, SharedLaw, Zone, invert_ln_survival, unknown};
use crate::Result;
use crate::random::Stream;

/// The size-biased distribution of another: density x p(x)/x̄. Expectations are weighted ones of the other,
/// E*\[f(ξ)\] = E\[ξ f(ξ)\]/x̄.
///
/// Sums over contacts that are weighted by their initial stretch are x̄ times the same sums over contacts whose
/// initial stretch has this distribution.
#[derive(Debug, Clone)]
pub(crate) struct SizeBiased {
    law: SharedLaw,
    mean: f64,
}

impl SizeBiased {
    /// The size-biased distribution of `law`; `None` if its mean is 0.
    pub fn of(law: &SharedLaw) -> Option<Self> {
        let mean = law.mean();
        (mean > 0.0).then(|| Self { law: law.clone(), mean })
    }

    /// x̄, the mean of the distribution that is not size-biased: E\[ξ f(ξ)\] = x̄ E*\[f(ξ)\].
    pub fn unweighted_mean(&self) -> f64 {
        self.mean
    }
}

impl Law for SizeBiased {
    fn name(&self) -> &'static str {
        "size_biased"
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn with_parameter(&self, name: &str, _value: f64) -> Result<SharedLaw> {
        Err(unknown(self, name))
    }

    fn density(&self, x: f64) -> f64 {
        if x > 0.0 { x * self.law.density(x) / self.mean } else { 0.0 }
    }

    fn ln_density(&self, x: f64) -> f64 {
        if x > 0.0 { x.ln() + self.law.ln_density(x) - self.mean.ln() } else { f64::NEG_INFINITY }
    }

    fn survival(&self, x: f64) -> f64 {
        self.upper_moment(0, x)
    }

    fn ln_survival(&self, x: f64) -> f64 {
        self.survival(x).ln()
    }

    fn hazard(&self, x: f64) -> f64 {
        let survival = self.survival(x);
        if survival > 0.0 { self.density(x) / survival } else { f64::INFINITY }
    }

    fn quantile(&self, p: f64) -> f64 {
        match p {
            0.0 => self.law.quantile(0.0),
            1.0 => self.law.quantile(1.0),
            _ => invert_ln_survival(|x| self.ln_survival(x), (-p).ln_1p()),
        }
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        match q {
            0.0 => self.law.upper_quantile(0.0),
            _ => invert_ln_survival(|x| self.ln_survival(x), q.ln()),
        }
    }

    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        self.law.upper_moment(order + 1, x) / self.mean
    }

    fn std(&self) -> f64 {
        (self.upper_moment(2, -1.0) - self.mean().powi(2)).max(0.0).sqrt()
    }

    fn atoms(&self) -> Vec<Atom> {
        let atoms = self.law.atoms().into_iter().filter(|atom| atom.position > 0.0);
        atoms.map(|atom| Atom { weight: atom.weight * atom.position / self.mean, ..atom }).collect()
    }

    /// x (x − b)₊ᵉ/Γ(e + 1) = b (x − b)₊ᵉ/Γ(e + 1) + (e + 1)(x − b)₊ᵉ⁺¹/Γ(e + 2).
    fn breakpoints(&self) -> Vec<Breakpoint> {
        let terms = |b: Breakpoint| {
            let amplitude = b.amplitude / self.mean;
            [
                Breakpoint { amplitude: amplitude * b.position, ..b },
                Breakpoint { exponent: b.exponent + 1.0, amplitude: amplitude * (b.exponent + 1.0), ..b },
            ]
        };
        self.law.breakpoints().into_iter().flat_map(terms).filter(|b| b.amplitude != 0.0).collect()
    }

    fn zones(&self) -> Vec<Zone> {
        self.law.zones()
    }

    fn seams(&self) -> Vec<f64> {
        self.law.seams()
    }

    fn decay_rate(&self) -> f64 {
        self.law.decay_rate()
    }

    fn known_rate(&self) -> f64 {
        self.law.known_rate()
    }

    fn laplace_is_closed(&self) -> bool {
        false
    }

    /// −P̂'(s)/x̄.
    fn laplace(&self, s: Complex64) -> Complex64 {
        -self.law.laplace_with_derivative(s)[1] / self.mean
    }

    /// By inversion of the distribution function.
    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        out.fill_with(|| self.quantile(stream.uniform()));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::{Exponential, Gamma, Mixture, Point};

    /// The size-biased exponential distribution is the gamma distribution of shape 2.
    #[test]
    fn an_exponential_becomes_a_gamma_distribution_of_shape_two() {
        let law: SharedLaw = Arc::new(Exponential::new(0.5).unwrap());
        let biased = SizeBiased::of(&law).unwrap();
        let gamma = Gamma::new(1.0, 0.5_f64.sqrt()).unwrap();
        for x in [0.1, 0.7, 2.0, 9.0] {
            assert!((biased.density(x) / gamma.density(x) - 1.0).abs() < 1e-13);
            assert!((biased.survival(x) / gamma.survival(x) - 1.0).abs() < 1e-13);
            assert!((biased.upper_moment(2, x) / gamma.upper_moment(2, x) - 1.0).abs() < 1e-12);
        }
        assert!((biased.std() - gamma.std()).abs() < 1e-14);
        let s = Complex64::new(0.3, 2.0);
        assert!((biased.laplace(s) - gamma.laplace(s)).norm() < 1e-13);
        assert!((biased.quantile(0.3) - gamma.quantile(0.3)).abs() < 1e-13);
    }

    #[test]
    fn point_masses_count_by_their_position() {
        let at = |x: f64| Arc::new(Point::new(x).unwrap()) as SharedLaw;
        assert!(SizeBiased::of(&at(0.0)).is_none());
        let law: SharedLaw =
            Arc::new(Mixture::new(vec![(0.5, at(0.0)), (0.25, at(1.0)), (0.25, at(3.0))]).unwrap());
        let biased = SizeBiased::of(&law).unwrap();
        let expected = [(1.0, 0.25), (3.0, 0.75)];
        assert_eq!(biased.atoms().iter().map(|a| (a.position, a.weight)).collect::<Vec<_>>(), expected);
        assert_eq!(biased.survival(1.0), 0.75);
    }
}
