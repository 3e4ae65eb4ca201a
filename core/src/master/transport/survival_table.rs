//! The surviving fraction S of a smooth distribution, tabulated to a small fraction of the tolerance.

use crate::law::Law;

/// S(x) by cubic Hermite interpolation between equally spaced positions.
#[derive(Debug)]
pub(super) struct SurvivalTable {
    /// First position; below it S is taken as 1.
    low: f64,
    /// Cells per length.
    scale: f64,
    /// S and its change per cell at each position.
    nodes: Vec<[f64; 2]>,
}

/// Largest error of S in units of the tolerance: cohorts and steps are so many that errors add.
const ERROR: f64 = 1e-6;

/// Largest number of cells. Distributions that need more are asked directly; so are those with jumps, for which cells never
/// suffice.
const CELLS: usize = 1 << 13;

/// Number of cells tried first.
const FEW: usize = 1 << 8;

/// Fractions below this are no part of the table.
const NEGLIGIBLE: f64 = 1e-16;

impl SurvivalTable {
    /// The table of a law; `None` if it would need too many cells.
    pub(super) fn of(law: &dyn Law, tolerance: f64) -> Option<Self> {
        let low = law.quantile(ERROR * tolerance).max(0.0);
        let high = law.upper_quantile(NEGLIGIBLE);
        if !(high.is_finite() && high > low) {
            return None;
        }
        let mut cells = FEW;
        while cells <= CELLS {
            let table = Self::on(law, low, high, cells);
            if table.is_accurate(law, ERROR * tolerance) {
                return Some(table);
            }
            cells *= 2;
        }
        None
    }

    fn on(law: &dyn Law, low: f64, high: f64, cells: usize) -> Self {
        let width = (high - low) / cells as f64;
        let node = |k: usize| {
            let x = low + k as f64 * width;
            [law.survival(x), -width * law.density(x)]
        };
        Self { low, scale: width.recip(), nodes: (0..=cells).map(node).collect() }
    }

    /// Whether S at the middles of cells, where the interpolation is worst, is off by no more than `error`.
    fn is_accurate(&self, law: &dyn Law, error: f64) -> bool {
        let middle = |k: usize| self.low + (k as f64 + 0.5) / self.scale;
        (0..self.nodes.len() - 1).all(|k| {
            let x = middle(k);
            (self.value(x) - law.survival(x)).abs() <= error
        })
    }

    /// The stretch up to which S is 1.
    pub(super) fn low(&self) -> f64 {
        self.low
    }

    /// S(x), which never leaves [0, 1].
    #[inline]
    pub(super) fn value(&self, x: f64) -> f64 {
        let place = (x - self.low) * self.scale;
        if place <= 0.0 {
            return 1.0;
        }
        let cell = place as usize;
        if cell + 1 >= self.nodes.len() {
            return 0.0;
        }
        let t = place - cell as f64;
        let ([a, slope_a], [b, slope_b]) = (self.nodes[cell], self.nodes[cell + 1]);
        let rest = 1.0 - t;
        let value = rest * rest * ((1.0 + 2.0 * t) * a + t * slope_a)
            + t * t * ((1.0 + 2.0 * rest) * b - rest * slope_b);
        value.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use crate::law::{Gaussian, Lognormal, Mixture, Rectangular, SharedLaw, Weibull};

    #[test]
    fn a_table_is_as_accurate_as_asked() {
        let laws: [&dyn Law; 3] = [
            &Gaussian::new(1.0, 0.1).unwrap(),
            &Lognormal::new(1.0, 0.3).unwrap(),
            &Weibull::new(1.0, 4.0).unwrap(),
        ];
        for law in laws {
            for tolerance in [1e-3, 1e-5] {
                let table = SurvivalTable::of(law, tolerance).unwrap();
                for k in 0..5000 {
                    let x = 1e-3 * f64::from(k) * 0.777;
                    let off = (table.value(x) - law.survival(x)).abs();
                    // Twice: the error is checked at the middles of cells only, and is largest near them.
                    assert!(off <= 2.0 * ERROR * tolerance, "{} {tolerance}: {off:e} at {x}", law.name());
                }
            }
        }
    }

    #[test]
    fn a_density_with_jumps_inside_has_no_table() {
        let parts: Vec<(f64, SharedLaw)> = [(0.5, (0.75, 1.25)), (0.5, (0.9, 1.0))]
            .map(|(weight, (low, high))| {
                (weight, Arc::new(Rectangular::new(low, high).unwrap()) as SharedLaw)
            })
            .into();
        assert!(SurvivalTable::of(&Mixture::new(parts).unwrap(), 1e-6).is_none());
    }
}
