//! The point at which the running integral of a non-negative function reaches a given value:
//! inverse-transform sampling of a waiting time, by adaptive Gauss–Legendre panels.

use super::legendre::{NODES, Nodal, RULE, primitive, series};
use super::piecewise::tail;
use super::roots::brent_root;

/// Error allowed in the integral over a panel, absolute and relative.
const ERROR: (f64, f64) = (1e-10, 1e-12);

/// The x in [0, `length`] at which ∫₀ˣ f = `remaining`, for f ≥ 0 and `remaining` of order 1; `None` if the
/// integral over [0, `length`] is smaller.
///
/// `remaining` is reduced by the integral over the panels passed, so that after `None` it is what is remaining.
/// The width of the panels of 16 Gauss points, at which `f` is evaluated together, is controlled by the decay of the Legendre
/// coefficients of f.
pub fn integral_reaches(f: impl Fn(&Nodal) -> Nodal, length: f64, remaining: &mut f64) -> Option<f64> {
    // If f does not decrease, the integral reaches the value within this width.
    let mut width = (2.0 * *remaining / f(&[0.0; NODES])[0]).min(length);
    let mut from = 0.0;
    while from < length {
        let half = 0.5 * width;
        let coefficients = RULE.coefficients(&f(&RULE.nodes.map(|t| from + half * (1.0 + t))));
        let panel_integral = width * coefficients[0];
        let relative_error = tail(&coefficients) * half / ERROR.0.max(ERROR.1 * panel_integral);
        // The truncation error scales as the 16th power of the width.
        let next = width * (0.9 * relative_error.powf(-1.0 / NODES as f64)).clamp(0.2, 4.0);
        if relative_error > 1.0 && width > f64::EPSILON * length {
            width = next;
            continue;
        }
        if panel_integral >= *remaining {
            let primitive = primitive(&coefficients);
            let excess = |t: f64| half * (coefficients[0] + series(&primitive, t)) - *remaining;
            let t = brent_root(excess, -1.0, 1.0, 1e-15).unwrap_or(1.0);
            return Some(from + half * (1.0 + t));
        }
        *remaining -= panel_integral;
        from += width;
        width = next.min(length - from);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{NODES, integral_reaches};

    /// Closed forms: rates that are constant, that rise by e²⁰, that begin with a root.
    #[test]
    fn places_are_those_of_closed_forms() {
        for goal in [1e-6, 0.3, 2.0, 9.0] {
            let place = |f: &dyn Fn(f64) -> f64, length| {
                integral_reaches(|at| at.map(f), length, &mut goal.clone()).unwrap()
            };
            // The integral is right to 1e-10 on every panel; where it is reached, to that over the rate.
            assert!((place(&|_| 2.0, 1e9) - 0.5 * goal).abs() < 1e-10);
            let exponential = place(&|x: f64| 1e-6 * (20.0 * x).exp(), 2.0);
            let exact = (20e6 * goal).ln_1p() / 20.0;
            assert!((exponential - exact).abs() < 1e-9 / (1e-6 * (20.0 * exact).exp()));
            let line = place(&|x: f64| 2.0 * x, 1e3);
            assert!((line - goal.sqrt()).abs() < 1e-9 / goal.sqrt());
        }
    }

    #[test]
    fn what_is_left_is_the_rest() {
        let mut remaining = 1.0;
        assert_eq!(integral_reaches(|at| at.map(f64::exp), 0.5, &mut remaining), None);
        assert!((remaining - (2.0 - 0.5_f64.exp())).abs() < 1e-13);
        assert_eq!(integral_reaches(|_| [0.0; NODES], 1e300, &mut remaining), None);
    }
}
