//! Where the integral of a function reaches a value.

use super::legendre::{NODES, RULE, primitive, series};
use super::piecewise::tail;
use super::roots::brent_root;

/// Error allowed in the integral over a panel, absolute and relative.
const ERROR: (f64, f64) = (1e-10, 1e-12);

/// The place in [0, `length`] where the integral of `f` ≥ 0 from 0 has used up what is `left`, a number of order 1.
///
/// If it is not used up, `left` is what remains. Panels of 16 Gauss points are as wide as is right, by the decay of the
/// coefficients of a smooth function.
pub fn used_up(f: impl Fn(f64) -> f64, length: f64, left: &mut f64) -> Option<f64> {
    // Where f does not fall, it is used up before.
    let mut width = (2.0 * *left / f(0.0)).min(length);
    let mut from = 0.0;
    while from < length {
        let half = 0.5 * width;
        let coefficients = RULE.coefficients(&RULE.nodes.map(|t| f(from + half * (1.0 + t))));
        let whole = width * coefficients[0];
        let excess = tail(&coefficients) * half / ERROR.0.max(ERROR.1 * whole);
        let next = width * (0.9 * excess.powf(-1.0 / NODES as f64)).clamp(0.2, 4.0);
        if excess > 1.0 && width > f64::EPSILON * length {
            width = next;
            continue;
        }
        if whole >= *left {
            let primitive = primitive(&coefficients);
            let lacks = |t: f64| half * (coefficients[0] + series(&primitive, t)) - *left;
            let t = brent_root(lacks, -1.0, 1.0, 1e-15).unwrap_or(1.0);
            return Some(from + half * (1.0 + t));
        }
        *left -= whole;
        from += width;
        width = next.min(length - from);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::used_up;

    /// Closed forms: rates that are constant, that rise by e²⁰, that begin with a root.
    #[test]
    fn places_are_those_of_closed_forms() {
        for goal in [1e-6, 0.3, 2.0, 9.0] {
            let place = |f: &dyn Fn(f64) -> f64, length| used_up(f, length, &mut goal.clone()).unwrap();
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
        let mut left = 1.0;
        assert_eq!(used_up(|x: f64| x.exp(), 0.5, &mut left), None);
        assert!((left - (2.0 - 0.5_f64.exp())).abs() < 1e-13);
        assert_eq!(used_up(|_| 0.0, 1e300, &mut left), None);
    }
}
