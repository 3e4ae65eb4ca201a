//! Quantiles of distributions that have no closed form for them.

/// The smallest x ≥ 0 with ln S(x) ≤ `level`; infinite for −∞.
///
/// Non-negative doubles are ordered like their bit patterns, which go about with log₂ x: bisection of these ends between two
/// neighbours after 63 steps, for any scale and any S. Where S is smooth, ln(ln S/`level`) is nearly a straight line there, and
/// false position (M. Dowell and P. Jarratt, BIT 11, 168 (1971)) ends at the same two after some 15.
pub(super) fn invert_ln_survival(ln_survival: impl Fn(f64) -> f64, level: f64) -> f64 {
    // The square of this is finite.
    const FAR: f64 = 1e150;
    if level == f64::NEG_INFINITY {
        return f64::INFINITY;
    }
    // The last bit pattern known to be too small and the first known to be large enough, with ln(ln S/level).
    let mut ends = [(-1, f64::NEG_INFINITY), (FAR.to_bits() as i64, f64::INFINITY)];
    let (mut widths, mut moved) = ([i64::MAX; 3], None);
    while ends[1].0 - ends[0].0 > 1 {
        let width = ends[1].0 - ends[0].0;
        // Bisection, where three steps together have done less.
        let inside = if width > widths[0] / 2 { width / 2 } else { crossing(&ends) };
        let at = ends[0].0 + inside.clamp(1, width - 1);
        widths = [widths[1], widths[2], width];
        let value = ln_survival(f64::from_bits(at as u64));
        let side = usize::from(value <= level);
        if moved == Some(side) {
            // The other end has stayed: with half of its value it will not for long.
            ends[1 - side].1 *= 0.5;
        }
        moved = Some(side);
        ends[side] = (at, (value / level).ln());
    }
    f64::from_bits(ends[1].0 as u64)
}

/// How far above the lower end a straight line crosses 0; the middle where none is known.
fn crossing(&[(low, below), (high, above)]: &[(i64, f64); 2]) -> i64 {
    let part = below / (below - above);
    let width = high - low;
    if part.is_finite() { (width as f64 * part) as i64 } else { width / 2 }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;
    use crate::law::{Gamma, Gaussian, Law, Lognormal};

    fn by_bisection(ln_survival: impl Fn(f64) -> f64, level: f64) -> f64 {
        let (mut low, mut high) = (0, 1e150_f64.to_bits());
        while low < high {
            let middle = low + (high - low) / 2;
            if ln_survival(f64::from_bits(middle)) <= level { high = middle } else { low = middle + 1 }
        }
        f64::from_bits(low)
    }

    /// Levels from the lowest to the highest quantile that is used.
    const LEVELS: [f64; 7] = [-1e-18, -1e-3, -0.3, -0.7, -7.0, -41.0, -690.0];

    #[test]
    fn the_same_as_by_bisection_in_fewer_steps() {
        let laws: [&dyn Law; 7] = [
            &Gaussian::new(1.0, 0.12).unwrap(),
            &Gaussian::new(0.1, 0.03).unwrap(),
            &Gaussian::new(0.0, 1e-9).unwrap(),
            &Gaussian::new(1.0, 5.0).unwrap(),
            &Lognormal::new(1.0, 0.5).unwrap(),
            &Gamma::new(1.0, 2.0).unwrap(),
            &Gamma::new(1.0, 0.3).unwrap(),
        ];
        for law in laws {
            for level in LEVELS {
                let count = Cell::new(0);
                let counted = |x: f64| {
                    count.set(count.get() + 1);
                    law.ln_survival(x)
                };
                let found = invert_ln_survival(counted, level);
                let expected = by_bisection(|x| law.ln_survival(x), level);
                // Rounding of ln S may make it rise between neighbours.
                assert!(
                    (found / expected - 1.0).abs() < 1e-14,
                    "{}: {level}: {found}, {expected}",
                    law.name()
                );
                assert!(count.get() < 40, "{}: {level}: {} steps", law.name(), count.get());
            }
        }
    }

    #[test]
    fn jumps_and_ends_are_found() {
        let steps = |x: f64| match x {
            _ if x < 1.0 => 0.0,
            _ if x < 2.0 => -0.5,
            _ => f64::NEG_INFINITY,
        };
        assert_eq!(invert_ln_survival(steps, -0.3), 1.0);
        assert_eq!(invert_ln_survival(steps, -0.5), 1.0);
        assert_eq!(invert_ln_survival(steps, -0.6), 2.0);
        assert_eq!(invert_ln_survival(steps, 0.0), 0.0);
        assert_eq!(invert_ln_survival(steps, f64::NEG_INFINITY), f64::INFINITY);
        assert_eq!(invert_ln_survival(|x| -x, -3.0), 3.0);
        // Nothing is left beyond 1e150.
        assert_eq!(invert_ln_survival(|_| 0.0, -1.0), 1e150);
    }
}
