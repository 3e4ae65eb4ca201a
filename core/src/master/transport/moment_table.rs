//! The mean of the thresholds above one, ∫_x^∞ ξ dP, of distributions without a closed form, tabulated to a small fraction of
//! the tolerance.

use crate::law::Law;
use crate::numerics::piecewise::{Piecewise, Resolution};

/// ∫_x^∞ ξ dP as polynomials.
#[derive(Debug)]
pub(super) struct MomentTable(Piecewise);

/// Largest error in units of the tolerance and of the mean, as of the table of S: cohorts and steps are so many that errors
/// add.
const ERROR: f64 = 1e-6;

/// A table is no more accurate than that, for rounding of moments.
const FINEST: f64 = 1e-14;

/// Fractions below this are no part of the table.
const NEGLIGIBLE: f64 = 1e-16;

impl MomentTable {
    /// The table of a law without point masses; `None` for one that is quick to ask, or whose tail is so heavy that it counts
    /// beyond the table.
    pub(super) fn of(law: &dyn Law, tolerance: f64) -> Option<Self> {
        let top = law.upper_quantile(NEGLIGIBLE);
        if law.laplace_is_closed() || !law.atoms().is_empty() || !top.is_finite() {
            return None;
        }
        if law.upper_moment(1, top) > ERROR * tolerance * law.mean() {
            return None;
        }
        let resolution =
            Resolution::Relative { fraction: (ERROR * tolerance).max(FINEST), negligible: law.mean() };
        let zones = law.zones().into_iter().flat_map(|zone| [zone.low, zone.high]);
        let edges: Vec<f64> = law.breakpoints().into_iter().map(|b| b.position).chain(zones).collect();
        Some(Self(Piecewise::resolve(|x| law.upper_moment(1, x), &edges, top, resolution)))
    }

    /// The moment above x.
    pub(super) fn value(&self, x: f64) -> f64 {
        self.0.value(x.max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::{Gamma, Gaussian, Renormalised, Root, SharedLaw};

    /// ∫_x^∞ ξ dP at multiples of `width`: M_1(x) = x S(x) + ∫_x^∞ S, from S alone.
    fn from_survival(law: &dyn Law, width: f64, number: u32) -> Vec<f64> {
        /// Intervals of Simpson's rule between two of them, whose error for these is below 1e-16.
        const INTERVALS: u32 = 5000;
        let between = |from: f64, to: f64| {
            let step = (to - from) / f64::from(INTERVALS);
            let term = |k: u32| {
                let weight = if k == 0 || k == INTERVALS { 1.0 } else { 2.0 * f64::from(1 + k % 2) };
                weight * law.survival(from + f64::from(k) * step)
            };
            step / 3.0 * (0..=INTERVALS).map(term).sum::<f64>()
        };
        let at = |k: u32| width * f64::from(k);
        let mut above = between(at(number), law.upper_quantile(1e-18).max(at(number)));
        let moment = |k: u32| {
            above += between(at(k), at(k + 1));
            at(k) * law.survival(at(k)) + above
        };
        let mut moments: Vec<f64> = (0..number).rev().map(moment).collect();
        moments.reverse();
        moments
    }

    #[test]
    fn a_table_is_as_accurate_as_asked() {
        const WIDTH: f64 = 0.0521;
        let gaussian: SharedLaw = Arc::new(Gaussian::new(1.0, 0.05).unwrap());
        let gamma: SharedLaw = Arc::new(Gamma::new(1.0, 0.5).unwrap());
        // √A for areas A of a distribution.
        let areas: [SharedLaw; 2] = [
            Arc::new(Renormalised::new(gaussian, 0.01).unwrap()),
            Arc::new(Renormalised::new(gamma, 0.1).unwrap()),
        ];
        for areas in areas {
            let law = Root::new(1.0, areas).unwrap();
            let expected = from_survival(&law, WIDTH, 40);
            for tolerance in [1e-4, 1e-6] {
                let table = MomentTable::of(&law, tolerance).unwrap();
                for (k, expected) in (0..).zip(&expected) {
                    let x = WIDTH * f64::from(k);
                    let off = (table.value(x) - expected).abs();
                    // Simpson's rule beside the power of x with which the density of √A begins: 1e-12.
                    assert!(off <= 2.0 * ERROR * tolerance + 1e-12, "{tolerance}: {off:e} at {x}");
                }
            }
        }
    }

    #[test]
    fn laws_with_a_closed_form_are_asked() {
        assert!(MomentTable::of(&Gaussian::new(1.0, 0.1).unwrap(), 1e-6).is_none());
    }
}
