//! The distribution of thresholds over all cells of an interface whose cells differ in scale: a product
//! distribution.

use super::panels::panel_boundaries;
use super::{Law, Series};
use crate::numerics::legendre::RULE;
use crate::{Error, Result};

/// Standard deviations at which the Gaussian of the scales is cut: 1e-18 of it is beyond.
const REACH: f64 = 9.0;

/// Width in standard deviations over which 16 Gauss points integrate it to rounding.
const WIDTH: f64 = 1.4;

/// Tolerance of the series.
const TOLERANCE: f64 = 1e-12;

/// Relative distance below which two positions are the same.
const APART: f64 = 1e-12;

/// The distribution of s ξ, where ξ has a distribution without point masses and s is an independent scale,
/// Gaussian of mean 1 and standard deviation `std`, conditioned on s > 0. With φ the standard Gaussian,
///
/// p(y) = ∫ φ(t) P(y/s) dt/s, s = 1 + std t.
///
/// Returned as a series, accurate to 1e-12; tails of 1e-20 are cut off.
///
/// # Errors
/// A standard deviation that is not a finite number above 0, point masses, those of [`Series::resolve`].
pub fn scattered(law: &dyn Law, std: f64) -> Result<Series> {
    super::positive("std", std)?;
    if let Some(atom) = law.atoms().first() {
        let found = format!("one at {}", atom.position);
        return Err(Error::invalid("law", "a distribution without point masses", found));
    }
    let product = Product { law, std, panels: panel_boundaries(law) };
    let density = |points: &[f64]| Ok(points.iter().map(|&y| product.density(y)).collect());
    Series::resolve(density, &product.boundaries(), TOLERANCE).map(|(series, _)| series)
}

/// A scale s = 1 + std t, as t, which is accurate near s = 1, and as s, which is accurate near 0.
#[derive(Debug, Clone, Copy)]
struct Scale {
    off: f64,
    factor: f64,
}

/// ∫f by the Gauss rule on `parts` equal panels, rounded up.
fn summed([low, high]: [f64; 2], parts: f64, f: impl Fn(f64) -> f64) -> f64 {
    let parts = parts.ceil().max(1.0);
    let at = |k: usize| low + (high - low) * (k as f64 / parts);
    (0..parts as usize).map(|k| RULE.integrate(at(k), at(k + 1), &f)).sum()
}

struct Product<'a> {
    law: &'a dyn Law,
    std: f64,
    /// Panel boundaries of the distribution of ξ, rising.
    panels: Vec<f64>,
}

impl Product<'_> {
    /// The density at y > 0, integrated between the scales at which P(y/s) may not be smooth.
    fn density(&self, y: f64) -> f64 {
        let met = |x: f64| Scale { off: (y / x - 1.0) / self.std, factor: y / x };
        let reached = |off: f64| Scale { off, factor: 1.0 + self.std * off };
        let (lowest, highest) = (met(self.panels[self.panels.len() - 1]), met(self.panels[0]));
        let low = if lowest.off > -REACH { lowest } else { reached(-REACH) };
        let high = if highest.off < REACH { highest } else { reached(REACH) };
        let inner = self.panels.iter().rev().map(|&x| met(x));
        let inner = inner.filter(|scale| scale.off > low.off && scale.off < high.off);
        let mut from = low;
        let mut sum = 0.0;
        for to in inner.chain([high]).filter(|to| to.factor > low.factor) {
            sum += self.between(y, from, to);
            from = to;
        }
        sum
    }

    /// The contribution of an interval of scales; for small scales integrated over ln s, on which P(y/s)
    /// varies evenly.
    fn between(&self, y: f64, from: Scale, to: Scale) -> f64 {
        const SMALL: f64 = 0.5;
        let widths = (to.off - from.off) / WIDTH;
        if from.factor < SMALL {
            let [low, high] = [from, to].map(|scale| scale.factor.ln());
            return summed([low, high], (high - low).max(widths), |ln_factor| {
                let factor = ln_factor.exp();
                let off = (factor - 1.0) / self.std;
                (-0.5 * off * off).exp() * self.law.density(y / factor) / self.std
            });
        }
        summed([from.off, to.off], widths, |off| {
            let factor = 1.0 + self.std * off;
            (-0.5 * off * off).exp() * self.law.density(y / factor) / factor
        })
    }

    /// Boundaries between which nothing is missed: around a breakpoint of P, p changes over std times its
    /// position.
    fn boundaries(&self) -> Vec<f64> {
        let reach = REACH * self.std;
        let around = |x: f64| [(x * (1.0 - reach)).max(0.0), x, x * (1.0 + reach)];
        let breakpoints = self.law.breakpoints().into_iter().map(|b| b.position);
        let ends = [self.panels[0], self.panels[self.panels.len() - 1]];
        let mut boundaries: Vec<f64> = breakpoints.chain(ends).flat_map(around).collect();
        boundaries.extend(&self.panels);
        boundaries.sort_by(f64::total_cmp);
        boundaries.dedup_by(|next, kept| *next - *kept <= APART * *next);
        boundaries
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{
        Exponential, Gamma, Gaussian, Lognormal, Mixture, Point, Rectangular, SharedLaw, Weibull,
    };
    use super::*;

    fn laws() -> Vec<SharedLaw> {
        let narrow: SharedLaw = Arc::new(Gaussian::new(1.0, 0.02).unwrap());
        let rectangular: SharedLaw = Arc::new(Rectangular::new(0.8, 1.2).unwrap());
        let mixture = Mixture::new(vec![(0.3, narrow.clone()), (0.7, rectangular.clone())]).unwrap();
        vec![
            narrow,
            rectangular,
            Arc::new(mixture),
            Arc::new(Exponential::new(0.7).unwrap()),
            Arc::new(Gamma::new(1.0, 1.5).unwrap()),
            Arc::new(Lognormal::new(1.0, 0.5).unwrap()),
            Arc::new(Weibull::new(12.153, 1.0).unwrap()),
        ]
    }

    /// ⟨sⁿ⟩⟨ξⁿ⟩.
    #[test]
    fn moments_are_products() {
        for law in laws() {
            for std in [1e-6, 0.01, 0.1] {
                let product = scattered(law.as_ref(), std).unwrap();
                let variance = std * std;
                for (order, scales) in [(1, 1.0), (2, 1.0 + variance), (3, 1.0 + 3.0 * variance)] {
                    let off =
                        product.upper_moment(order, -1.0) / (scales * law.upper_moment(order, -1.0)) - 1.0;
                    assert!(off.abs() < 1e-11, "{law:?} {std} {order} {off:e}");
                }
            }
        }
    }

    /// Against ∫ g(y/x) dx/x over a uniform law, g the law of scales, by Simpson's rule, whose steps are 1e-3 of the width of
    /// g; and far from its edges the uniform law itself.
    #[test]
    fn densities_are_those_of_products() {
        let (low, high, steps) = (0.8, 1.2, 20_000_u32);
        let uniform = Rectangular::new(low, high).unwrap();
        for std in [0.02, 0.1, 0.2, 0.3, 0.5] {
            let (product, scales) = (scattered(&uniform, std).unwrap(), Gaussian::new(1.0, std).unwrap());
            for y in [0.5, 0.8, 0.97, 1.3, 1.7] {
                let value = |i: u32| {
                    let x = low + (high - low) * f64::from(i) / f64::from(steps);
                    let weight = if i == 0 || i == steps { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
                    weight * scales.density(y / x) / x
                };
                let expected = (0..=steps).map(value).sum::<f64>() / f64::from(3 * steps);
                let off = product.density(y) - expected;
                assert!(off.abs() < 1e-11, "{std} {y} {off:e}");
            }
        }
        let sharp = scattered(&uniform, 1e-3).unwrap();
        // E[1/s] = 1 + std² + …
        assert!((sharp.density(1.0) - 2.5 * (1.0 + 1e-6)).abs() < 1e-10);
    }

    /// Scales down to 0: moments are those of a Gaussian cut off there, with λ = φ(1/std)/Φ(1/std).
    #[test]
    fn scales_may_come_down_to_nothing() {
        let narrow = Gaussian::new(1.0, 0.05).unwrap();
        let laws: [SharedLaw; 4] = [
            Arc::new(Exponential::new(1.0).unwrap()),
            Arc::new(Rectangular::new(0.0, 2.0).unwrap()),
            Arc::new(Lognormal::new(1.0, 1.0).unwrap()),
            Arc::new(narrow),
        ];
        for law in laws {
            for std in [0.12, 0.3, 0.5] {
                let product = scattered(law.as_ref(), std).unwrap();
                let standard = Gaussian::new(1.0 / std, 1.0).unwrap();
                // The law on x ≥ 0 is cut off and normalised: its density at 0 is λ.
                let slope = standard.density(0.0);
                for (order, scales) in [(1, 1.0 + std * slope), (2, 1.0 + std * std + std * slope)] {
                    let off =
                        product.upper_moment(order, -1.0) / (scales * law.upper_moment(order, -1.0)) - 1.0;
                    // What the series leaves out, a lognormal tail weighing most.
                    assert!(off.abs() < 1e-10, "{law:?} {std} {order} {off:e}");
                }
            }
        }
    }

    #[test]
    fn identical_thresholds_are_refused() {
        assert!(scattered(&Point::new(1.0).unwrap(), 0.1).is_err());
        assert!(scattered(&Exponential::new(1.0).unwrap(), 0.0).is_err());
    }
}
