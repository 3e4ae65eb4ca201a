//! Operations on piecewise functions: shift, mirror, restrict, add.

use super::legendre::{NODES, Nodal, RULE};
use super::piecewise::Piecewise;
use crate::Result;

impl Piecewise {
    /// Lower end of the first cell.
    pub fn start(&self) -> f64 {
        self.boundaries.first().copied().unwrap_or(0.0)
    }

    /// f(x − by). A cell that rounding makes too narrow at its new place adds its integral to a neighbour.
    #[must_use]
    pub fn shifted(&self, by: f64) -> Self {
        let mut out = Self { boundaries: vec![self.start() + by], coefficients: Vec::new() };
        let mut leftover = 0.0;
        for (cell, coefficients) in self.coefficients.iter().enumerate() {
            let (low, high) = (out.end(), self.boundaries[cell + 1] + by);
            let half = self.cell(cell).1;
            let mass = 2.0 * half * coefficients[0];
            if high - low < half {
                leftover += mass;
                continue;
            }
            // The mass of the cell is kept, not its density: probability is conserved to rounding
            // over many shifts.
            let mut moved = *coefficients;
            moved[0] = (mass + std::mem::take(&mut leftover)) / (high - low);
            out.boundaries.push(high);
            out.coefficients.push(moved);
        }
        let last = out.coefficients.len().saturating_sub(1);
        if leftover != 0.0 && !out.coefficients.is_empty() {
            out.coefficients[last][0] += leftover / (2.0 * out.cell(last).1);
        }
        out
    }

    /// f(x − by) for a function that starts at 0, with the constant `before` on [0, by].
    #[must_use]
    pub fn preceded(&self, by: f64, before: f64) -> Self {
        let mut out = self.shifted(by);
        let mut constant = [0.0; NODES];
        constant[0] = before;
        out.boundaries.insert(0, 0.0);
        out.coefficients.insert(0, constant);
        out
    }

    /// f(−x).
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let turned = |c: &Nodal| std::array::from_fn(|n| if n % 2 == 0 { c[n] } else { -c[n] });
        Self {
            boundaries: self.boundaries.iter().rev().map(|x| -x).collect(),
            coefficients: self.coefficients.iter().rev().map(turned).collect(),
        }
    }

    /// `factor` × f.
    #[must_use]
    pub fn scaled(mut self, factor: f64) -> Self {
        self.coefficients.iter_mut().flatten().for_each(|c| *c *= factor);
        self
    }

    /// The function restricted to [low, high].
    #[must_use]
    pub fn part(&self, low: f64, high: f64) -> Self {
        let mut out = Self::default();
        for cell in 0..self.coefficients.len() {
            let (a, b) = (self.boundaries[cell].max(low), self.boundaries[cell + 1].min(high));
            if a >= b {
                continue;
            }
            if out.boundaries.is_empty() {
                out.boundaries.push(a);
            }
            out.boundaries.push(b);
            out.coefficients.push(self.expanded(cell, a, b));
        }
        out
    }

    /// The polynomial of a cell as a Legendre series on [low, high].
    fn expanded(&self, cell: usize, low: f64, high: f64) -> Nodal {
        if (self.boundaries[cell], self.boundaries[cell + 1]) == (low, high) {
            return self.coefficients[cell];
        }
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        RULE.coefficients(&RULE.nodes.map(|t| self.value_in(cell, middle + half * t)))
    }

    /// The sum with another function; cells are joined where one polynomial serves both within `tolerance`
    /// (an integral).
    #[must_use]
    pub fn added(&self, other: &Self, tolerance: f64) -> Self {
        if self.coefficients.is_empty() {
            return other.clone();
        }
        let mut boundaries = [self.boundaries.as_slice(), &other.boundaries].concat();
        boundaries.sort_by(f64::total_cmp);
        boundaries.dedup();
        let on = |f: &Self, low: f64, high: f64| {
            f.find(0.5 * (low + high)).map_or([0.0; NODES], |cell| f.expanded(cell, low, high))
        };
        let sum = |pair: &[f64]| {
            let (a, b) = (on(self, pair[0], pair[1]), on(other, pair[0], pair[1]));
            std::array::from_fn(|n| a[n] + b[n])
        };
        let coefficients = boundaries.windows(2).map(sum).collect();
        Self { boundaries, coefficients }.joined(tolerance)
    }

    /// The function on fewer cells: neighbours are joined as long as that changes no integral by more than
    /// `tolerance`.
    #[must_use]
    pub fn joined(self, tolerance: f64) -> Self {
        self.joined_with(tolerance, |_| Ok(())).expect("the function that is called returns no error")
    }

    /// The same with a function that is called at every cell and may end the work.
    ///
    /// # Errors
    /// Those of the function.
    pub fn joined_with(mut self, tolerance: f64, ask: impl Fn(usize) -> Result<()>) -> Result<Self> {
        loop {
            let mut out = Self { boundaries: vec![self.start()], coefficients: Vec::new() };
            let mut cell = 0;
            while cell < self.coefficients.len() {
                ask(cell)?;
                let pair = self.pair(cell, tolerance);
                let taken = if pair.is_some() { 2 } else { 1 };
                out.coefficients.push(pair.unwrap_or(self.coefficients[cell]));
                cell += taken;
                out.boundaries.push(self.boundaries[cell]);
            }
            // Pairs are joined in rounds, each of which at best halves the number of cells, until none fits.
            if out.coefficients.len() == self.coefficients.len() {
                return Ok(out);
            }
            self = out;
        }
    }

    /// One series for a cell and the next, if it represents both.
    fn pair(&self, cell: usize, tolerance: f64) -> Option<Nodal> {
        let (low, high) = (self.boundaries[cell], *self.boundaries.get(cell + 2)?);
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let between = self.boundaries[cell + 1];
        let at = |x: f64| self.value_in(if x < between { cell } else { cell + 1 }, x);
        let joint = Self {
            boundaries: vec![low, high],
            coefficients: vec![RULE.coefficients(&RULE.nodes.map(|t| at(middle + half * t)))],
        };
        let serves = |cell: usize| {
            let (m, h) = self.cell(cell);
            let missed = |t: &f64| (joint.value_in(0, m + h * t) - self.value_in(cell, m + h * t)).abs();
            RULE.nodes.iter().map(missed).fold(0.0, f64::max) * half <= tolerance
        };
        (serves(cell) && serves(cell + 1)).then(|| joint.coefficients[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::piecewise::Resolution;

    fn sine() -> Piecewise {
        Piecewise::resolve(f64::sin, &[0.7, 1.1], 2.0, Resolution::Mean(1e-15))
    }

    #[test]
    fn moves_and_mirrors_keep_values() {
        let moved = sine().shifted(-3.0).mirrored();
        for x in [1.05, 1.9, 2.5, 2.99] {
            assert!((moved.value(x) - (3.0 - x).sin()).abs() < 1e-14, "{x}");
        }
        let part = sine().part(0.5, 0.9);
        assert!((part.value(0.6) - 0.6_f64.sin()).abs() < 1e-14 && part.value(0.95) == 0.0);
    }

    #[test]
    fn a_singular_function_keeps_its_integral_when_moved() {
        let steep = Piecewise::resolve(|x: f64| 0.5 / x.sqrt(), &[], 1.0, Resolution::Mean(1e-16));
        for moved in [steep.shifted(1.0), steep.mirrored().shifted(7.0)] {
            // 119 graded cells, each right to rounding; those that differ by less than rounding are gone.
            assert!((moved.integral() - steep.integral()).abs() < 1e-13);
            assert!(moved.coefficients.len() < steep.coefficients.len());
        }
    }

    #[test]
    fn a_sum_needs_no_more_cells_than_its_terms() {
        let (whole, other) =
            (sine(), Piecewise::resolve(f64::cos, &[0.3, 1.3], 2.5, Resolution::Mean(1e-15)));
        let sum = whole.added(&other, 1e-14);
        for x in [0.1, 0.69, 1.2, 1.99] {
            assert!((sum.value(x) - x.sin() - x.cos()).abs() < 1e-13, "{x}");
        }
        assert!((sum.value(2.2) - 2.2_f64.cos()).abs() < 1e-13);
        // Where the sine ends it jumps.
        assert_eq!(sum.boundaries, [0.0, 2.0, 2.5]);
    }
}
