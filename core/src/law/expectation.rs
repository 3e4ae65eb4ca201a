//! Expectations of functions of a variable with a distribution.

use super::Law;
use super::panels::panel_boundaries;
use crate::numerics::legendre::RULE;

/// Bisections of a panel, at most.
const MOST_HALVINGS: u32 = 30;

/// Error at which a panel is not bisected further, relative to ∫|f| dP.
const TOLERANCE: f64 = 1e-13;

/// E\[f(ξ)\] = ∫ f dP over low ≤ ξ ≤ high, point masses at both ends included.
///
/// Gauss's rule with 16 nodes on panels that resolve the distribution and its tails down to 1e-20; panels are bisected until
/// their results change by less than 1e-13 of ∫|f| dP, at most 30 times. At a jump of f the error may be larger: use `low` and
/// `high`. f is called between them only, and no more once it has failed.
///
/// # Errors
/// Those of `f`.
pub fn expectation<E>(
    law: &dyn Law,
    [low, high]: [f64; 2],
    mut f: impl FnMut(f64) -> Result<f64, E>,
) -> Result<f64, E> {
    let mut sum = Signed::default();
    // Empty, or not an interval.
    if low.partial_cmp(&high).is_none_or(std::cmp::Ordering::is_gt) {
        return Ok(0.0);
    }
    for atom in law.atoms().iter().filter(|atom| low <= atom.position && atom.position <= high) {
        sum = sum.plus(Signed::of(atom.weight * f(atom.position)?));
    }
    let mut boundaries: Vec<f64> =
        panel_boundaries(law).iter().map(|x| x.clamp(low.max(0.0), high.max(0.0))).collect();
    boundaries.dedup();
    let mut panels = Vec::new();
    for ends in boundaries.windows(2) {
        let ends = [ends[0], ends[1]];
        let whole = gauss(law, ends, &mut f)?;
        sum = sum.plus(whole);
        panels.push((ends, whole, 0));
    }
    while let Some(([from, to], whole, depth)) = panels.pop() {
        let middle = 0.5 * (from + to);
        let halves = [gauss(law, [from, middle], &mut f)?, gauss(law, [middle, to], &mut f)?];
        let both = halves[0].plus(halves[1]);
        sum = sum.plus(both).minus(whole);
        let far = (both.value - whole.value).abs() > TOLERANCE * sum.size;
        if far && depth < MOST_HALVINGS {
            panels.push(([from, middle], halves[0], depth + 1));
            panels.push(([middle, to], halves[1], depth + 1));
        }
    }
    Ok(sum.value)
}

/// A sum, and that of the moduli of its terms.
#[derive(Debug, Clone, Copy, Default)]
struct Signed {
    value: f64,
    size: f64,
}

impl Signed {
    fn of(value: f64) -> Self {
        Self { value, size: value.abs() }
    }

    fn plus(self, other: Self) -> Self {
        Self { value: self.value + other.value, size: self.size + other.size }
    }

    fn minus(self, other: Self) -> Self {
        Self { value: self.value - other.value, size: self.size - other.size }
    }
}

/// ∫ f p by Gauss's rule. f is not called where p is 0.
fn gauss<E>(
    law: &dyn Law,
    [from, to]: [f64; 2],
    f: &mut impl FnMut(f64) -> Result<f64, E>,
) -> Result<Signed, E> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    let mut sum = Signed::default();
    for (t, w) in RULE.nodes.iter().zip(RULE.weights) {
        let x = middle + half * t;
        let density = law.density(x);
        if density > 0.0 {
            sum = sum.plus(Signed::of(half * w * density * f(x)?));
        }
    }
    Ok(sum)
}

/// The differential entropy −∫ p ln p, in nats; −∞ for a distribution with point masses.
pub fn entropy(law: &dyn Law) -> f64 {
    if !law.atoms().is_empty() {
        return f64::NEG_INFINITY;
    }
    let found =
        expectation(law, [0.0, f64::INFINITY], |x| Ok::<_, std::convert::Infallible>(-law.ln_density(x)));
    let Ok(entropy) = found;
    entropy
}

/// x, or the number below it where x is the upper end of the support: a density includes the lower end of a jump only, while
/// likelihoods of samples, as those of `scipy.stats`, include both ends.
pub fn within_support(law: &dyn Law, x: f64) -> f64 {
    let below = x.next_down();
    if law.density(x) == 0.0 && law.density(below) > 0.0 { below } else { x }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{E, PI};
    use std::sync::Arc;

    use super::*;
    use crate::law::{Exponential, Gaussian, Mixture, Point, Rectangular, Weibull};

    const ALL: [f64; 2] = [0.0, f64::INFINITY];

    fn of(law: &dyn Law, range: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
        expectation(law, range, |x| Ok::<_, ()>(f(x))).unwrap()
    }

    #[test]
    fn closed_forms() {
        let exponential = Exponential::new(2.0).unwrap();
        let pole = Weibull::new(0.5, 1.0).unwrap();
        let spread = Rectangular::new(0.0, 1.0).unwrap();
        // A few hundred roundings, and the tolerance; twice that where f or the density diverges.
        for (found, expected, error) in [
            (of(&exponential, ALL, |x| (-x).exp()), 1.0 / 3.0, 1e-13),
            (of(&exponential, [2.0, 4.0], |_| 1.0), 1.0 / E - 1.0 / (E * E), 1e-13),
            (of(&pole, ALL, |x| x), 2.0, 1e-12),
            (of(&spread, ALL, f64::ln), -1.0, 1e-12),
            (of(&spread, [0.0, 1.0 / 3.0], |_| 1.0), 1.0 / 3.0, 1e-13),
            (entropy(&Gaussian::new(1.0, 0.05).unwrap()), 0.5 * (2.0 * PI * E * 0.0025).ln(), 1e-12),
            (entropy(&exponential), 1.0 + 2.0_f64.ln(), 1e-12),
        ] {
            assert!((found - expected).abs() < error, "{found} instead of {expected}");
        }
    }

    #[test]
    fn point_masses_and_failures() {
        let law = Mixture::new(vec![
            (0.25, Arc::new(Point::new(1.0).unwrap()) as crate::law::SharedLaw),
            (0.75, Arc::new(Rectangular::new(1.0, 2.0).unwrap())),
        ])
        .unwrap();
        // A few roundings.
        assert!((of(&law, ALL, |x| x) - 1.375).abs() < 1e-14);
        assert!((of(&law, [0.0, 1.0], |x| x) - 0.25).abs() < 1e-14);
        assert_eq!(entropy(&law), f64::NEG_INFINITY);
        assert_eq!(expectation(&law, ALL, |_| Err::<f64, _>("no")), Err("no"));
    }

    #[test]
    fn the_logarithm_of_the_density_does_not_underflow() {
        let law = Gaussian::new(1.0, 0.05).unwrap();
        let exact = |x: f64| -0.5 * ((x - 1.0) / 0.05).powi(2) - (0.05 * (2.0 * PI).sqrt()).ln();
        for x in [0.5, 1.0, 3.0, 9.0] {
            // Relative error of ln S.
            assert!((law.ln_density(x) / exact(x) - 1.0).abs() < 1e-12, "{x}");
        }
        assert_eq!(law.ln_density(-1.0), f64::NEG_INFINITY);
        let spread = Rectangular::new(0.5, 1.5).unwrap();
        assert_eq!(
            [0.1, 1.0, 2.0].map(|x| spread.ln_density(x)),
            [f64::NEG_INFINITY, 0.0, f64::NEG_INFINITY]
        );
    }
}
