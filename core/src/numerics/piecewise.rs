//! Functions given cell by cell as Legendre series of degree 15, with adaptive bisection.

use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::laplace::transform;
use super::legendre::{NODES, Nodal, RULE, derivative, primitive, series, series_at, series_of_two};

/// A function that is a polynomial of degree 15 on each cell of [start, end] and 0 elsewhere.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Piecewise {
    /// Boundaries of the cells, one more than cells.
    pub boundaries: Vec<f64>,
    /// Legendre coefficients of each cell.
    pub coefficients: Vec<Nodal>,
}

/// Tolerance of an interpolation: the condition under which a cell is not bisected. The truncation error of a
/// cell is that of `tail`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Resolution {
    /// Truncation error × half width is at most this: an error of integrals.
    Mean(f64),
    /// Truncation error is at most `fraction` × the largest value on the cell, or × `negligible` if that is
    /// larger.
    Relative {
        /// Relative tolerance.
        fraction: f64,
        /// Values below this need no relative accuracy.
        negligible: f64,
    },
    /// Truncation error × half width is at most `fraction` × the integral up to the end of the cell, or ×
    /// `negligible` if that is larger. For a function of one sign.
    Cumulative {
        /// Relative tolerance.
        fraction: f64,
        /// Integrals below this need no relative accuracy.
        negligible: f64,
    },
}

impl Resolution {
    /// The error of a cell, to be compared with [`Resolution::tolerance`]. `values` are those at the Gauss points,
    /// `truncation` the truncation error, `integral` the integral up to the end of the cell.
    fn error(self, values: &Nodal, truncation: f64, half: f64, integral: f64) -> f64 {
        match self {
            Self::Mean(_) => truncation * half,
            Self::Relative { negligible, .. } => {
                truncation / values.iter().fold(negligible, |largest, v| largest.max(v.abs()))
            }
            Self::Cumulative { negligible, .. } => truncation * half / integral.abs().max(negligible),
        }
    }

    /// The tolerance.
    fn tolerance(self) -> f64 {
        let (Self::Mean(tolerance)
        | Self::Relative { fraction: tolerance, .. }
        | Self::Cumulative { fraction: tolerance, .. }) = self;
        tolerance
    }

    /// With ten times the tolerance.
    fn coarser(mut self) -> Self {
        let (Self::Mean(tolerance)
        | Self::Relative { fraction: tolerance, .. }
        | Self::Cumulative { fraction: tolerance, .. }) = &mut self;
        *tolerance *= 10.0;
        self
    }

    /// Whether an error this small after `depth` bisections can be due to rounding of the function.
    fn may_be_rounding(self, error: f64, depth: u32) -> bool {
        match self {
            // Scaled back to the undivided cell, since an integral has no natural width.
            Self::Mean(_) => depth > 6 && error < 1e-9 * 0.5_f64.powi(depth as i32),
            Self::Relative { .. } | Self::Cumulative { .. } => depth > 1 && error < 1e-9,
        }
    }
}

/// Estimate of the truncation error of a Legendre series: its last two coefficients, times the decay from the
/// two before if they decay.
pub fn tail(coefficients: &Nodal) -> f64 {
    let pair = |n: usize| coefficients[n].abs().max(coefficients[n - 1].abs());
    extrapolated(pair(NODES - 1), pair(NODES - 3))
}

/// The truncation error of a series by its last coefficients, times the decay from those before if they decay.
pub fn extrapolated(last: f64, before: f64) -> f64 {
    let square = last * last;
    match last < before {
        // The square would lose digits.
        true if square < f64::MIN_POSITIVE => last * (last / before),
        true => square / before,
        false => last,
    }
}

/// The truncation estimate that rounding of values and positions alone gives, for a cell `distance` half
/// widths from 0.
pub fn rounding(values: &Nodal, distance: f64) -> f64 {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), &v| (low.min(v), high.max(v)));
    16.0 * f64::EPSILON * (low.abs().max(high.abs()) + (high - low) * distance)
}

impl Piecewise {
    /// Interpolates `f` on [0, end]. Cells are bisected until each satisfies `resolution`, or bisection no
    /// longer reduces the error. `edges` are cell boundaries from the start.
    pub fn resolve(f: impl Fn(f64) -> f64, edges: &[f64], end: f64, resolution: Resolution) -> Self {
        let ([out], _) = Self::resolve_all(|x| [f(x)], edges, end, resolution);
        out
    }

    /// Interpolates several functions on the cells that the first of them needs. Also returns the error of the integral of
    /// the first one between edges between which noise would have asked for too many cells, and the tolerance is larger; else 0.
    pub fn resolve_all<const K: usize>(
        f: impl Fn(f64) -> [f64; K],
        edges: &[f64],
        end: f64,
        resolution: Resolution,
    ) -> ([Self; K], f64) {
        Self::resolved(&f, edges, end, resolution)
    }

    /// The same, compiled once for each number of functions.
    fn resolved<const K: usize>(
        f: &dyn Fn(f64) -> [f64; K],
        edges: &[f64],
        end: f64,
        resolution: Resolution,
    ) -> ([Self; K], f64) {
        let mut edges: Vec<f64> =
            edges.iter().copied().filter(|&x| x > 0.0 && x < end).chain([0.0, end]).collect();
        edges.sort_by(f64::total_cmp);
        edges.dedup_by(|b, a| *b - *a <= f64::EPSILON * end);
        let mut out = std::array::from_fn(|_| Self { boundaries: vec![0.0], coefficients: Vec::new() });
        let (mut integral, mut missed) = (0.0, 0.0);
        for pair in edges.windows(2) {
            let mut bisection = Bisection::new(f, resolution, integral);
            while !bisection.divide((pair[0], pair[1]), (f64::INFINITY, 0)) {
                bisection = Bisection::new(f, bisection.resolution.coarser(), integral);
            }
            if bisection.resolution != resolution {
                missed += bisection.missed;
            }
            integral = bisection.integral;
            bisection.append(&mut out);
        }
        (out, missed)
    }

    /// Interpolates several functions on the same cells: those between `boundaries`, bisected until the truncation error ×
    /// half width of each function is at most its tolerance, or is rounding. `limits` are the tolerance and the magnitude
    /// of each; tolerances are larger where noise would ask for too many cells.
    pub fn resolve_each(f: impl Fn(f64) -> Vec<f64>, boundaries: &[f64], limits: &[(f64, f64)]) -> Vec<Self> {
        let start = boundaries.first().copied().into_iter().collect::<Vec<_>>();
        let mut out = vec![Self { boundaries: start, coefficients: Vec::new() }; limits.len()];
        for ends in boundaries.windows(2) {
            let (mut limits, cells) = (limits.to_vec(), out.first().map_or(0, |out| out.coefficients.len()));
            while !bisect_each(&f, (ends[0], ends[1]), (f64::INFINITY, 0), (&limits, cells), &mut out) {
                limits.iter_mut().for_each(|limit| limit.0 *= 10.0);
                for out in &mut out {
                    out.boundaries.truncate(cells + 1);
                    out.coefficients.truncate(cells);
                }
            }
        }
        out
    }

    /// `beyond` + ∫_x^end of the function + the jumps above x, given as (position, height) at cell
    /// boundaries.
    #[must_use]
    pub fn integrated_from_end(&self, beyond: f64, jumps: &[(f64, f64)]) -> Self {
        let mut out = self.clone();
        let mut above = beyond;
        let mut jumps = jumps.iter().rev().peekable();
        for cell in (0..self.coefficients.len()).rev() {
            let (middle, half) = self.cell(cell);
            while let Some(jump) = jumps.next_if(|jump| jump.0 > middle) {
                above += jump.1;
            }
            let c = &self.coefficients[cell];
            // The primitive of a series of degree 15 has degree 16; its last term is dropped, which
            // is of the order of the truncation error of the cell.
            out.coefficients[cell] = primitive(c).map(|term| -half * term);
            out.coefficients[cell][0] += above + half * c[0];
            above += 2.0 * half * c[0];
        }
        out
    }

    /// The function plus `factor` × another one on the same cells.
    #[must_use]
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let mut out = self.clone();
        for (sum, term) in out.coefficients.iter_mut().flatten().zip(other.coefficients.iter().flatten()) {
            *sum += factor * term;
        }
        out
    }

    /// Upper end of the last cell.
    pub fn end(&self) -> f64 {
        self.boundaries.last().copied().unwrap_or(0.0)
    }

    /// Middle and half width of a cell.
    #[inline]
    pub fn cell(&self, cell: usize) -> (f64, f64) {
        let (a, b) = (self.boundaries[cell], self.boundaries[cell + 1]);
        (0.5 * (a + b), 0.5 * (b - a))
    }

    /// The cell that contains x (the right one at a boundary); `None` outside.
    #[inline]
    pub fn find(&self, x: f64) -> Option<usize> {
        let above = self.above(x);
        (above > 0 && above < self.boundaries.len()).then(|| above - 1)
    }

    /// The cell that contains x (the right one at a boundary, and within rounding below one); the first cell
    /// below the start, the last one from the end on.
    pub fn nearest(&self, x: f64) -> usize {
        let reach = x + 1e-12 * x.abs();
        self.above(reach).saturating_sub(1).min(self.coefficients.len() - 1)
    }

    /// Number of boundaries at or below x. Guessed for equal cells, else found by bisection.
    #[inline]
    fn above(&self, x: f64) -> usize {
        let cells = self.coefficients.len();
        let guess = (x / self.end() * cells as f64) as usize;
        if guess < cells && self.boundaries[guess] <= x && x < self.boundaries[guess + 1] {
            return guess + 1;
        }
        self.boundaries.partition_point(|&b| b <= x)
    }

    /// Value at x; 0 outside the cells.
    #[inline]
    pub fn value(&self, x: f64) -> f64 {
        self.find(x).map_or(0.0, |cell| self.value_in(cell, x))
    }

    /// Values at 16 points in rising or falling order; 0 outside the cells.
    #[inline(always)]
    pub fn values(&self, x: &Nodal) -> Nodal {
        let (low, high) = (x[0].min(x[NODES - 1]), x[0].max(x[NODES - 1]));
        match (self.find(low), self.find(high)) {
            (Some(first), Some(last)) if first == last => self.values_in(first, x),
            (Some(first), Some(last)) if first + 1 == last => self.values_in_two(first, x),
            _ => self.values_cell_by_cell(x),
        }
    }

    /// Values at 16 points in a cell and the next one.
    #[inline(always)]
    fn values_in_two(&self, first: usize, x: &Nodal) -> Nodal {
        let edge = self.boundaries[first + 1];
        let [(low, low_half), (high, high_half)] = [self.cell(first), self.cell(first + 1)];
        let mut t = *x;
        for t in &mut t {
            let (middle, half) = if *t >= edge { (high, high_half) } else { (low, low_half) };
            *t = (*t - middle) / half;
        }
        series_of_two([&self.coefficients[first], &self.coefficients[first + 1]], &t, x, edge)
    }

    /// Values at 16 points in several cells.
    #[inline(always)]
    fn values_cell_by_cell(&self, x: &Nodal) -> Nodal {
        let (mut values, mut done) = ([0.0; NODES], 0);
        while done < NODES {
            let Some(cell) = self.find(x[done]) else {
                done += 1;
                continue;
            };
            let within = self.boundaries[cell]..self.boundaries[cell + 1];
            let next = done + x[done..].iter().take_while(|x| within.contains(x)).count();
            let all = self.values_in(cell, x);
            (done..next).for_each(|i| values[i] = all[i]);
            done = next;
        }
        values
    }

    /// Values of the polynomial of a cell at 16 points.
    #[inline(always)]
    pub fn values_in(&self, cell: usize, x: &Nodal) -> Nodal {
        let (middle, half) = self.cell(cell);
        let mut t = *x;
        t.iter_mut().for_each(|t| *t = (*t - middle) / half);
        series_at(&self.coefficients[cell], &t)
    }

    /// Value at x of the polynomial of a cell.
    #[inline]
    pub fn value_in(&self, cell: usize, x: f64) -> f64 {
        let (middle, half) = self.cell(cell);
        series(&self.coefficients[cell], (x - middle) / half)
    }

    /// Value and first K − 1 derivatives at x of the polynomial of a cell.
    pub fn jet_in<const K: usize>(&self, cell: usize, x: f64) -> [f64; K] {
        let (middle, half) = self.cell(cell);
        let mut coefficients = self.coefficients[cell];
        std::array::from_fn(|_| {
            let value = series(&coefficients, (x - middle) / half);
            coefficients = derivative(&coefficients).map(|c| c / half);
            value
        })
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

    /// Gauss points of all cells as (u, quadrature weight × value), with cells cut into parts no wider than
    /// `widest`.
    pub fn points(&self, widest: f64) -> Vec<(f64, f64)> {
        let mut points = Vec::new();
        for (cell, coefficients) in self.coefficients.iter().enumerate() {
            let (middle, half) = self.cell(cell);
            let parts = (2.0 * half / widest).ceil().max(1.0) as usize;
            let part = half / parts as f64;
            for k in 0..parts {
                let centre = middle - half + (2 * k + 1) as f64 * part;
                for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
                    let u = centre + part * t;
                    points.push((u, part * w * series(coefficients, (u - middle) / half)));
                }
            }
        }
        points
    }

    /// Total variation of f(u) e^{−au} with its jumps, from values at the nodes and the ends of cells.
    pub fn variation(&self, a: f64) -> f64 {
        let (mut last, mut variation) = (0.0, 0.0);
        for (cell, coefficients) in self.coefficients.iter().enumerate() {
            let (middle, half) = self.cell(cell);
            for t in std::iter::once(-1.0).chain(RULE.nodes).chain([1.0]) {
                let value = series(coefficients, t) * (-a * (middle + half * t)).exp();
                variation += f64::abs(value - last);
                last = value;
            }
        }
        variation + last.abs()
    }

    /// The Laplace transform ∫e^{−su} f(u) du and its derivative with respect to s.
    pub fn transform(&self, s: Complex64) -> (Complex64, Complex64) {
        /// Cells whose integrals are at most this share of the largest are left out: far below rounding, of the derivative, too.
        const NEGLIGIBLE: f64 = 1e-24;
        let bound = |cell: usize| {
            let (middle, half) = self.cell(cell);
            // |P_n| ≤ 1 on the cell.
            let size: f64 = self.coefficients[cell].iter().map(|c| c.abs()).sum();
            half * size * ((s.re * half).abs() - s.re * middle).exp()
        };
        let bounds: Vec<f64> = (0..self.coefficients.len()).map(bound).collect();
        let least = NEGLIGIBLE * bounds.iter().copied().fold(0.0, f64::max).min(f64::MAX);
        let cells = self
            .coefficients
            .iter()
            .enumerate()
            .filter(|&(cell, _)| bounds[cell] >= least || bounds[cell].is_nan());
        let cells = cells.map(|(cell, coefficients)| transform(coefficients, self.cell(cell), s));
        cells.fold((Complex64::ZERO, Complex64::ZERO), |sum, cell| (sum.0 + cell[0], sum.1 - cell[1]))
    }
}

/// The cells between two edges, by bisection.
struct Bisection<'a, const K: usize> {
    f: &'a dyn Fn(f64) -> [f64; K],
    resolution: Resolution,
    /// The integral of the first function up to the last cell, from the start of the first edge.
    integral: f64,
    /// Upper ends of the cells, and the coefficients of all functions.
    cells: Vec<(f64, [Nodal; K])>,
    /// Sum of the truncation errors of integrals over cells.
    missed: f64,
}

impl<'a, const K: usize> Bisection<'a, K> {
    fn new(f: &'a dyn Fn(f64) -> [f64; K], resolution: Resolution, integral: f64) -> Self {
        Self { f, resolution, integral, cells: Vec::new(), missed: 0.0 }
    }

    /// Interpolates on [a, b], bisecting where needed; returns false if there are too many cells. `before` is the error of the
    /// parent cell.
    fn divide(&mut self, (a, b): (f64, f64), (before, depth): (f64, u32)) -> bool {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let values = RULE.nodes.map(|t| (self.f)(middle + half * t));
        let coefficients = |k: usize| RULE.coefficients(&values.map(|v| v[k]));
        let first = coefficients(0);
        let (up_to_here, truncation) = (self.integral + 2.0 * half * first[0], tail(&first));
        // The last Legendre coefficients estimate the truncation, since they decay geometrically for an
        // analytic function (L. N. Trefethen, Approximation Theory and Approximation Practice, SIAM
        // 2013, chapter 8).
        let error = self.resolution.error(&values.map(|v| v[0]), truncation, half, up_to_here);
        // Where the rounding of f, or of positions beside a pole, dominates, the error at best halves with the
        // width; converging series gain far more.
        let of_rounding = || truncation <= rounding(&values.map(|v| v[0]), middle.abs() / half);
        let noise = error > 0.4 * before && (self.resolution.may_be_rounding(error, depth) || of_rounding());
        let narrowest = half <= 16.0 * f64::EPSILON * b;
        // Bisection does not help where f is not a number.
        let unknown = error.is_nan();
        if error <= self.resolution.tolerance() || noise || narrowest || unknown || depth > MOST_BISECTIONS {
            self.integral = up_to_here;
            self.missed += 2.0 * half * truncation;
            self.cells.push((b, std::array::from_fn(coefficients)));
            return self.cells.len() < MOST_CELLS;
        }
        self.divide((a, middle), (error, depth + 1)) && self.divide((middle, b), (error, depth + 1))
    }

    /// Appends the cells to the functions.
    fn append(self, out: &mut [Piecewise; K]) {
        for (end, coefficients) in self.cells {
            for (piecewise, coefficients) in out.iter_mut().zip(coefficients) {
                piecewise.boundaries.push(end);
                piecewise.coefficients.push(coefficients);
            }
        }
    }
}

/// Interpolates several functions on [a, b], bisecting where one of them needs it; returns false if there are too many cells
/// after the first `cells`. `before` is the largest error of the parent cell, in tolerances.
fn bisect_each(
    f: &dyn Fn(f64) -> Vec<f64>,
    (a, b): (f64, f64),
    (before, depth): (f64, u32),
    (limits, cells): (&[(f64, f64)], usize),
    out: &mut [Piecewise],
) -> bool {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let values = RULE.nodes.map(|t| f(middle + half * t));
    let coefficients: Vec<Nodal> = (0..out.len())
        .map(|k| RULE.coefficients(&std::array::from_fn::<f64, NODES, _>(|i| values[i][k])))
        .collect();
    let mut error = 0.0_f64;
    for (coefficients, &(tolerance, size)) in coefficients.iter().zip(limits) {
        let truncation = tail(coefficients);
        let own = truncation * half / tolerance;
        // Where rounding dominates, the error at best halves with the width.
        let rounding = depth > 1 && own > 0.4 * before && truncation < 1e-9 * size;
        error = error.max(if rounding { 0.0 } else { own });
    }
    if error <= 1.0 || half <= 16.0 * f64::EPSILON * b || depth > MOST_BISECTIONS {
        for (piecewise, coefficients) in out.iter_mut().zip(coefficients) {
            piecewise.boundaries.push(b);
            piecewise.coefficients.push(coefficients);
        }
        return out.first().is_none_or(|out| out.coefficients.len() < cells + MOST_CELLS);
    }
    [(a, middle), (middle, b)]
        .into_iter()
        .all(|half| bisect_each(f, half, (error, depth + 1), (limits, cells), out))
}

/// Bisections that reach 1e-30 of the width: there u^(−1/2) integrates to 1e-15.
const MOST_BISECTIONS: u32 = 100;

/// Largest number of cells between two edges. Those that are graded towards a singularity at each end are a few hundred.
const MOST_CELLS: usize = 4000;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_function_with_a_jump_is_resolved() {
        let f = |x: f64| if x < 0.3 { x.sin() } else { 2.0 + x.cos() };
        let p = Piecewise::resolve(f, &[0.3], 2.0, Resolution::Mean(1e-15));
        for x in [0.0, 0.1, 0.3, 0.31, 1.9999] {
            assert!((p.value(x) - f(x)).abs() < 1e-14, "{x}");
        }
        let exact = (1.0 - 0.3_f64.cos()) + 2.0 * 1.7 + 2.0_f64.sin() - 0.3_f64.sin();
        assert!((p.integral() - exact).abs() < 1e-14);
        assert_eq!(p.value(2.1), 0.0);
        let after = p.integrated_from_end(1.0, &[(0.3, 5.0)]);
        let rest = 1.0 + 2.0 + 2.0_f64.sin() - 1.0_f64.sin();
        assert!((after.value(1.0) - rest).abs() < 1e-14);
        assert!((after.value(0.0) - exact - 6.0).abs() < 1e-14);
    }

    #[test]
    fn a_tail_is_resolved_down_to_the_smallest_numbers() {
        // Squares of coefficients are below the least number from 1e-154 on.
        let f = |x: f64| (-x - x.powf(1.1)).exp();
        let resolution = Resolution::Relative { fraction: 1e-13, negligible: 1e-280 };
        let p = Piecewise::resolve(f, &[1.0], 250.0, resolution);
        for k in 1..230 {
            let x = f64::from(k) + 0.37;
            // The truncation error is relative to the largest value of a cell, some thousand times that at its end.
            assert!((p.value(x) / f(x) - 1.0).abs() < 1e-9, "{x}: {:e}, not {:e}", p.value(x), f(x));
        }
    }

    #[test]
    fn transforms_agree_with_closed_forms_slow_and_fast() {
        let p = Piecewise::resolve(|x: f64| (-x).exp(), &[0.4], 2.0, Resolution::Mean(1e-16));
        for s in [
            Complex64::new(0.3, 0.0),
            Complex64::new(-1.0, 9.0),
            Complex64::new(0.2, 55.0),
            Complex64::new(0.0, 400.0),
            // e^{su} is no number any more.
            Complex64::new(1500.0, 1.0),
        ] {
            let exact = |s: Complex64| (1.0 - (-2.0 * (s + 1.0)).exp()) / (s + 1.0);
            let slope = |s: Complex64| 2.0 * (-2.0 * (s + 1.0)).exp() / (s + 1.0) - exact(s) / (s + 1.0);
            let (value, derivative) = p.transform(s);
            // Rounding of e^{−su}, itself up to e² here.
            assert!((value - exact(s)).norm() < 1e-14, "{s}");
            assert!((derivative - slope(s)).norm() < 3e-14, "{s}");
        }
    }

    #[test]
    fn the_variation_counts_jumps_and_slopes() {
        // A jump from 0 to 1, a rise to e^{1/2}, a jump down to e^{−1/2}, a fall to e^{−1} and a jump to 0.
        let p = Piecewise::resolve(
            |u: f64| if u < 0.5 { 1.0 } else { (-2.0 * u).exp() },
            &[0.5],
            1.0,
            Resolution::Mean(1e-15),
        );
        let (top, after, last) = (0.5_f64.exp(), (-0.5_f64).exp(), (-1.0_f64).exp());
        let exact = 1.0 + (top - 1.0) + (top - after) + (after - last) + last;
        assert!((p.variation(-1.0) - exact).abs() < 1e-13, "{}", p.variation(-1.0));
    }

    #[test]
    fn noise_ends_with_a_larger_tolerance_and_is_reported() {
        // Noise of 1e-6 at each point, a function of its bits.
        let noise =
            |x: f64| (x.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40) as f64 / 2.0_f64.powi(24);
        let f = |x: f64| [x.exp() + 1e-6 * (noise(x) - 0.5)];
        let ([p], missed) = Piecewise::resolve_all(f, &[], 1.0, Resolution::Mean(1e-14));
        assert!(p.coefficients.len() <= MOST_CELLS);
        let off = (p.integral() - (1.0_f64.exp() - 1.0)).abs();
        // The noise of cells adds up in the estimate, and mostly cancels in the integral.
        assert!(off < missed && missed < 1e-6, "{off:e} {missed:e}");
        let each = Piecewise::resolve_each(|x| f(x).to_vec(), &[0.0, 1.0], &[(1e-14, 1.0)]);
        assert!(each[0].coefficients.len() <= MOST_CELLS && (each[0].integral() - p.integral()).abs() < 1e-6);
        let ([_], missed) = Piecewise::resolve_all(|x: f64| [x.exp()], &[], 1.0, Resolution::Mean(1e-14));
        assert_eq!(missed, 0.0);
    }

    #[test]
    fn an_inverse_square_root_integrates() {
        let p = Piecewise::resolve(|x: f64| 0.5 / x.sqrt(), &[], 1.0, Resolution::Mean(1e-16));
        // Each of about 100 graded cells leaves out at most 1e-16.
        assert!((p.integral() - 1.0).abs() < 1e-13, "{:e}", p.integral() - 1.0);
    }
}
