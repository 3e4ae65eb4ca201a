//! A look-up table for a smooth function of one variable.

use super::legendre::{NODES, Nodal, RULE};

/// A function on x ≥ 0 as polynomials on equal cells of 1/(1 + x). Accurate to nearly all digits for a smooth
/// function of one order of magnitude with a power series in 1/x at infinity.
#[derive(Debug)]
pub struct Table {
    cells: [[f64; TERMS]; CELLS],
}

const CELLS: usize = 64;
const TERMS: usize = 11;

impl Table {
    /// Tabulates the function from its values at 16 points of each cell.
    pub fn of(f: impl Fn(f64) -> f64) -> Self {
        let cell = |cell: usize| {
            let place = |t: f64| (cell as f64 + 0.5 * (1.0 + t)) / CELLS as f64;
            let values = RULE.nodes.map(|t| f(place(t).recip() - 1.0));
            monomials(&RULE.coefficients(&values)[..TERMS])
        };
        Self { cells: std::array::from_fn(cell) }
    }

    /// The function at x ≥ 0, by Horner's rule.
    #[inline]
    pub fn value(&self, x: f64) -> f64 {
        let place = CELLS as f64 / (1.0 + x);
        let cell = (place as usize).min(CELLS - 1);
        let t = 2.0 * (place - cell as f64) - 1.0;
        self.cells[cell].iter().rev().fold(0.0, |sum, term| sum * t + term)
    }

    /// The function at sixteen places, with the same bits; the loops vectorise.
    #[inline(always)]
    pub fn values(&self, x: &Nodal) -> Nodal {
        let (mut t, mut terms) = ([0.0; NODES], [[0.0; NODES]; TERMS]);
        for i in 0..NODES {
            let place = CELLS as f64 / (1.0 + x[i]);
            let cell = (place as usize).min(CELLS - 1);
            t[i] = 2.0 * (place - cell as f64) - 1.0;
            for k in 0..TERMS {
                terms[k][i] = self.cells[cell][k];
            }
        }
        let mut sums = [0.0; NODES];
        for term in terms.iter().rev() {
            for i in 0..NODES {
                sums[i] = sums[i] * t[i] + term[i];
            }
        }
        sums
    }
}

/// The coefficients of powers of t of a Legendre series.
fn monomials(series: &[f64]) -> [f64; TERMS] {
    let (mut previous, mut current, mut sum) = ([0.0; TERMS], [0.0; TERMS], [0.0; TERMS]);
    current[0] = 1.0;
    for (n, coefficient) in series.iter().enumerate() {
        (0..TERMS).for_each(|k| sum[k] += coefficient * current[k]);
        let n = n as f64;
        let below = |k: usize| if k == 0 { 0.0 } else { current[k - 1] };
        let next = |k: usize| ((2.0 * n + 1.0) * below(k) - n * previous[k]) / (n + 1.0);
        (previous, current) = (current, std::array::from_fn(next));
    }
    sum
}

const _: () = assert!(TERMS <= NODES);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::dawson::dawson;

    #[test]
    fn a_table_keeps_all_digits() {
        let f = |x: f64| (1.0 + x).powi(2) * dawson(x) / x;
        let table = Table::of(f);
        for k in 0..2000 {
            let x = 1e-3 * 1.01_f64.powi(k);
            // Roundings at 16 places, which add up at the ends of a cell.
            assert!((table.value(x) / f(x) - 1.0).abs() < 8e-15, "{x}: {:e}", table.value(x) / f(x) - 1.0);
            assert_eq!(table.values(&[x; NODES]), [table.value(x); NODES]);
        }
    }
}
