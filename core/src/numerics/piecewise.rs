//! A function given cell by cell as Legendre series: lives of contacts, breaking rates, forces.

use super::breaks::Break;
use super::legendre::{NODES, Nodal, RULE, derivative, series};

/// A function on [start, end], a polynomial of degree 15 on each cell, 0 elsewhere.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Piecewise {
    /// Cell boundaries, one more than cells.
    pub boundaries: Vec<f64>,
    /// Legendre coefficients of each cell.
    pub coefficients: Vec<Nodal>,
}

/// Magnitude of what a series leaves out, read off its last two terms.
pub fn tail(coefficients: &Nodal) -> f64 {
    coefficients[NODES - 1].abs().max(coefficients[NODES - 2].abs())
}

impl Piecewise {
    /// Interpolates `f` on [0, end], cells bisected until each leaves out less than `tolerance` in the mean
    /// (last coefficients × width), or no longer gains by bisection. `breaks` are cell boundaries from the first.
    pub fn resolve(f: impl Fn(f64) -> f64, breaks: &[Break], end: f64, tolerance: f64) -> Self {
        let mut edges = vec![0.0, end];
        edges.extend(breaks.iter().map(|b| b.position).filter(|&x| x > 0.0 && x < end));
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|b, a| *b - *a <= f64::EPSILON * end);
        let mut out = Self { boundaries: vec![0.0], coefficients: Vec::new() };
        for pair in edges.windows(2) {
            out.bisect(&f, pair[0], pair[1], f64::INFINITY, 0, tolerance);
        }
        out
    }

    fn bisect(&mut self, f: &impl Fn(f64) -> f64, a: f64, b: f64, before: f64, depth: u32, tolerance: f64) {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let coefficients = RULE.coefficients(&RULE.nodes.map(|t| f(middle + half * t)));
        let missing = tail(&coefficients) * half;
        // Rounding in f halves with the width; anything that converges gains far more.
        let noise = depth > 6 && missing > 0.4 * before && tail(&coefficients) < 1e-9;
        if missing <= tolerance || noise || depth > MOST_BISECTIONS {
            self.boundaries.push(b);
            self.coefficients.push(coefficients);
        } else {
            self.bisect(f, a, middle, missing, depth + 1, tolerance);
            self.bisect(f, middle, b, missing, depth + 1, tolerance);
        }
    }

    /// Where the function ends.
    pub fn end(&self) -> f64 {
        self.boundaries.last().copied().unwrap_or(0.0)
    }

    /// Middle and half width of a cell.
    #[inline]
    pub fn cell(&self, cell: usize) -> (f64, f64) {
        let (a, b) = (self.boundaries[cell], self.boundaries[cell + 1]);
        (0.5 * (a + b), 0.5 * (b - a))
    }

    /// The cell that holds x, the right one at a boundary; `None` outside.
    #[inline]
    pub fn find(&self, x: f64) -> Option<usize> {
        let above = self.boundaries.partition_point(|&b| b <= x);
        (above > 0 && above < self.boundaries.len()).then(|| above - 1)
    }

    /// Value at x; 0 outside the cells.
    #[inline]
    pub fn value(&self, x: f64) -> f64 {
        self.find(x).map_or(0.0, |cell| self.value_in(cell, x))
    }

    /// Value at x of the polynomial of a cell.
    #[inline]
    pub fn value_in(&self, cell: usize, x: f64) -> f64 {
        let (middle, half) = self.cell(cell);
        series(&self.coefficients[cell], (x - middle) / half)
    }

    /// The derivative.
    #[must_use]
    pub fn derivative(&self) -> Self {
        let slope = |cell: usize| derivative(&self.coefficients[cell]).map(|c| c / self.cell(cell).1);
        let coefficients = (0..self.coefficients.len()).map(slope).collect();
        Self { boundaries: self.boundaries.clone(), coefficients }
    }

    /// The integral over all cells.
    pub fn integral(&self) -> f64 {
        (0..self.coefficients.len()).map(|cell| 2.0 * self.cell(cell).1 * self.coefficients[cell][0]).sum()
    }

    /// Σ over Gauss points of all cells of w f(u) g(u): sums a transform of the function, kind by kind.
    /// Cells wider than `widest` are cut into parts, so that an oscillating g is resolved.
    pub fn each_point(&self, widest: f64, mut visit: impl FnMut(f64, f64)) {
        for (cell, coefficients) in self.coefficients.iter().enumerate() {
            let (middle, half) = self.cell(cell);
            let parts = (2.0 * half / widest).ceil().max(1.0) as usize;
            let part = half / parts as f64;
            for k in 0..parts {
                let centre = middle - half + (2 * k + 1) as f64 * part;
                for i in 0..NODES {
                    let u = centre + part * RULE.nodes[i];
                    visit(u, part * RULE.weights[i] * series(coefficients, (u - middle) / half));
                }
            }
        }
    }
}

/// Bisections that reach 1e-30 of the width: u^(−1/2) integrates to 1e-15 there.
const MOST_BISECTIONS: u32 = 100;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_function_with_a_jump_is_resolved() {
        let f = |x: f64| if x < 0.3 { x.sin() } else { 2.0 + x.cos() };
        let at = Break { position: 0.3, exponent: 0.0, amplitude: 1.0 };
        let p = Piecewise::resolve(f, &[at], 2.0, 1e-15);
        for x in [0.0, 0.1, 0.3, 0.31, 1.9999] {
            assert!((p.value(x) - f(x)).abs() < 1e-14, "{x}");
        }
        let exact = (1.0 - 0.3_f64.cos()) + 2.0 * 1.7 + 2.0_f64.sin() - 0.3_f64.sin();
        assert!((p.integral() - exact).abs() < 1e-14);
        assert_eq!(p.value(2.1), 0.0);
    }

    #[test]
    fn an_inverse_square_root_integrates() {
        let p = Piecewise::resolve(|x: f64| 0.5 / x.sqrt(), &[], 1.0, 1e-16);
        // Each of about 100 graded cells leaves out at most 1e-16.
        assert!((p.integral() - 1.0).abs() < 1e-13, "{:e}", p.integral() - 1.0);
    }
}
