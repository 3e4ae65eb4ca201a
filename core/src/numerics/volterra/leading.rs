//! The leading cells of a curve on a mesh that is graded above a singularity at 0, merged into one cell.

use crate::numerics::legendre::{Nodal, RULE, gauss_points};
use crate::numerics::piecewise::Piecewise;

/// Cells are merged as long as each ends at least this much farther from 0 than the one before.
const GROWTH: f64 = 1.25;

/// Fewer cells are not worth merging.
const FEWEST: usize = 8;

/// The curve on [0, e_n] for the first ends e_n of cells: Gauss values of the polynomial that has the same integrals with all
/// polynomials of its degree. What is smooth over [0, e_n] sees no more of the curve than this.
#[derive(Debug, Clone, Default)]
pub(super) struct Leading {
    merged: Vec<Nodal>,
}

impl Leading {
    pub(super) fn of(curve: &Piecewise) -> Self {
        let mut leading = Self::default();
        leading.extend(curve, f64::INFINITY);
        leading
    }

    /// Takes in the cells of the curve that end at or before `end`; those taken in before are the same.
    pub(super) fn extend(&mut self, curve: &Piecewise, end: f64) {
        let edges = &curve.boundaries;
        for cell in self.merged.len()..curve.coefficients.len() {
            let (low, high) = (edges[cell], edges[cell + 1]);
            if edges[0] != 0.0 || high < GROWTH * low || high > end {
                return;
            }
            let (middle, half) = curve.cell(cell);
            let own = (middle, half, curve.values_in(cell, &gauss_points(middle, half)));
            let before = self.merged.last().map(|values| (0.5 * low, 0.5 * low, *values));
            let parts: Vec<_> = before.into_iter().chain([own]).collect();
            self.merged.push(RULE.projection(&parts, (0.5 * high, 0.5 * high)));
        }
    }

    /// The number of cells that are merged up to `end` at most, where they end, and the values; `None` for few.
    pub(super) fn until(&self, edges: &[f64], end: f64) -> Option<(usize, f64, &Nodal)> {
        let cells = edges.iter().skip(1).take(self.merged.len()).take_while(|&&edge| edge <= end).count();
        (cells >= FEWEST).then(|| (cells, edges[cells], &self.merged[cells - 1]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::legendre::NODES;

    /// x^−0.6 on cells that double in width from 1e-9, each by its polynomial.
    fn pole() -> Piecewise {
        let boundaries: Vec<f64> = [0.0].into_iter().chain((0..30).map(|k| 1e-9 * 2.0_f64.powi(k))).collect();
        let values = |pair: &[f64]| {
            let (middle, half) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            RULE.coefficients(&RULE.nodes.map(|t| (middle + half * t).powf(-0.6)))
        };
        let coefficients = boundaries.windows(2).map(values).collect();
        Piecewise { boundaries, coefficients }
    }

    #[test]
    fn merged_cells_have_the_integrals_of_the_cells() {
        let curve = pole();
        let leading = Leading::of(&curve);
        for end in [1e-6, 0.01, 0.3] {
            let (cells, reach, values) = leading.until(&curve.boundaries, end).unwrap();
            assert!(reach <= end && curve.boundaries[cells + 1] > end);
            // A polynomial of the highest degree that is kept.
            let smooth = |x: f64| (1.0 - 1.5 * x / reach).powi(NODES as i32 - 1);
            let places = RULE.nodes.map(|t| 0.5 * reach * (1.0 + t));
            let merged: f64 =
                (0..NODES).map(|i| 0.5 * reach * RULE.weights[i] * values[i] * smooth(places[i])).sum();
            let pairs = curve.boundaries[..=cells].windows(2);
            let exact: f64 =
                pairs.map(|pair| RULE.integrate(pair[0], pair[1], |x| curve.value(x) * smooth(x))).sum();
            // Rounding of some thirty cells, whose integrals have both signs.
            assert!((merged - exact).abs() < 1e-13 * exact.abs(), "{end}: {merged} {exact}");
        }
    }

    #[test]
    fn equal_cells_are_not_merged() {
        let boundaries: Vec<f64> = (0..40).map(f64::from).collect();
        let curve = Piecewise { coefficients: vec![[1.0; NODES]; 39], boundaries };
        assert!(Leading::of(&curve).until(&curve.boundaries, 39.0).is_none());
    }

    #[test]
    fn cells_are_taken_in_as_they_are_needed() {
        let (curve, mut leading) = (pole(), Leading::default());
        leading.extend(&curve, 1e-5);
        // The end that was asked for.
        assert!(leading.until(&curve.boundaries, 1.0).unwrap().1 <= 1e-5);
        leading.extend(&curve, 1.0);
        assert_eq!(
            leading.until(&curve.boundaries, 0.1).unwrap().2,
            Leading::of(&curve).until(&curve.boundaries, 0.1).unwrap().2
        );
    }
}
