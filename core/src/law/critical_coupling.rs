//! The critical coupling of a mean-field model, at which contacts break in one avalanche.

use super::Law;
use super::panels::panel_boundaries;
use crate::numerics::roots::brent_minimum;

/// κ_c = 1/max(x p(x)), the coupling at which contacts with this distribution of thresholds break in one
/// avalanche; 0 if some thresholds are identical.
pub fn critical_coupling(law: &dyn Law) -> f64 {
    if law.atoms().iter().any(|atom| atom.position > 0.0) {
        return 0.0;
    }
    let ends = panel_boundaries(law);
    ends.windows(2).map(|cell| peak(law, cell[0], cell[1])).fold(0.0, f64::max).recip()
}

/// x p(x), with 0 × ∞ = 0.
pub(super) fn weighted(law: &dyn Law, x: f64) -> f64 {
    let density = law.density(x);
    if x == 0.0 || density == 0.0 { 0.0 } else { x * density }
}

/// The maximum of x p(x) on [`low`, `high`), where p is smooth.
fn peak(law: &dyn Law, low: f64, high: f64) -> f64 {
    const PARTS: usize = 8;
    let at = |k: usize| (low + (high - low) * k as f64 / PARTS as f64).min(high.next_down()).max(low);
    let value = |x: f64| weighted(law, x);
    let best = (0..=PARTS).max_by(|&i, &j| value(at(i)).total_cmp(&value(at(j)))).unwrap_or(0);
    let (low, high) = (at(best.saturating_sub(1)), at((best + 1).min(PARTS)));
    (-brent_minimum(|x| -value(x), low, high, 0.0).1).max(value(at(best)))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::{Exponential, Gaussian, Point, Rectangular, SharedLaw};
    use super::*;

    #[test]
    fn closed_forms() {
        let close = |law: SharedLaw, expected: f64| {
            let found = critical_coupling(law.as_ref());
            assert!((found / expected - 1.0).abs() < 1e-14, "{law:?} {found} {expected}");
        };
        // max x p: at the upper end 1.2/0.4; at x̄, 1/e; of a Gaussian at x = μ + zσ, z = (√(α² + 4) − α)/2, α = μ/σ.
        close(Arc::new(Rectangular::new(0.8, 1.2).unwrap()), 1.0 / 3.0);
        close(Arc::new(Exponential::new(0.7).unwrap()), std::f64::consts::E);
        let z = 0.5 * (104.0_f64.sqrt() - 10.0);
        let gaussian = Arc::new(Gaussian::new(1.0, 0.1).unwrap());
        close(gaussian, std::f64::consts::TAU.sqrt() * 0.1 * (0.5 * z * z).exp() / (1.0 + 0.1 * z));
    }

    #[test]
    fn identical_thresholds_need_no_coupling() {
        assert_eq!(critical_coupling(&Point::new(1.0).unwrap()), 0.0);
    }
}
