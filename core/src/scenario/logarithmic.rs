//! Values evenly spaced in their logarithm.

use super::positive;
use crate::{Error, Result};

/// `points` values from `from` to `to`, both exactly.
pub(super) fn spaced(from: f64, to: f64, points: usize) -> Vec<f64> {
    let last = points - 1;
    // in decimal logarithms, in which whole powers of ten come out whole
    let (low, high) = (from.log10(), to.log10());
    let inside = |i: usize| 10f64.powf(low + (high - low) * (i as f64 / last as f64));
    (0..points)
        .map(|i| {
            if i == 0 {
                from
            } else if i == last {
                to
            } else {
                inside(i)
            }
        })
        .collect()
}

/// Checks the values of the keys `from`, `to` and `points`.
pub(super) fn check(from: f64, to: f64, points: usize) -> Result<()> {
    positive("from", from)?;
    positive("to", to)?;
    if to <= from {
        return Err(Error::invalid("to", format!("a number above from = {from}"), to));
    }
    if points < 2 {
        return Err(Error::invalid("points", "2 points or more (both ends count)", points));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_are_whole_and_ends_exact() {
        assert_eq!(spaced(1e-2, 1e3, 6), [1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3]);
        let values = spaced(0.3, 7.7, 11);
        assert_eq!((values[0], values[10]), (0.3, 7.7));
        let ratios = values.windows(2).map(|pair| pair[1] / pair[0]);
        // rounding of logarithms of the size of 1
        assert!(ratios.into_iter().all(|ratio| (ratio.powi(10) / (7.7 / 0.3) - 1.0).abs() < 1e-13));
    }
}
