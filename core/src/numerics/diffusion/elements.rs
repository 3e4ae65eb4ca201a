//! Spectral elements: a density as a Legendre series of degree 15 on each element (A. T. Patera, J. Comput.
//! Phys. 54, 468 (1984)). The Galerkin basis is that of the p-version: hat functions at the ends, integrated
//! Legendre polynomials inside (I. Babuška, B. A. Szabó and I. N. Katz, SIAM J. Numer. Anal. 18, 515 (1981)).

use std::sync::LazyLock;

use crate::numerics::legendre::{NODES, Nodal, RULE, add_moments, series};
use crate::numerics::piecewise::tail;

/// The narrowest element, relative to the whole length.
pub(super) const NARROWEST: f64 = 1e-13;

/// Truncation errors below this fraction of the largest coefficient may be rounding.
pub(super) const ROUNDING: f64 = 1e-12;

/// A number for each pair of basis functions of an element.
pub(super) type Matrix = [Nodal; NODES];

/// A density on [x, H], element by element; it may jump between elements.
#[derive(Debug, Clone, Default)]
pub struct Elements {
    /// Ends of the elements, one more than elements.
    pub edges: Vec<f64>,
    /// Legendre coefficients on each element.
    pub series: Vec<Nodal>,
}

/// The basis functions of an element, of which continuous densities consist: (1 ∓ t)/2, and (P_k −
/// P_{k−2})/√(4k − 2) for k ≥ 2.
#[derive(Debug)]
pub(super) struct Basis {
    /// Values of all functions at each Gauss point.
    pub(super) values: Matrix,
    /// Slopes of all functions at each Gauss point.
    pub(super) slopes: Matrix,
    /// Mass matrix: ∫ of products of two basis functions.
    pub(super) mass: Matrix,
    /// Stiffness matrix: ∫ of products of two slopes.
    pub(super) stiffness: Matrix,
}

/// The basis, computed once.
pub(super) static BASIS: LazyLock<Basis> = LazyLock::new(Basis::new);

/// √(4k − 2).
fn norm(k: usize) -> f64 {
    (4.0 * k as f64 - 2.0).sqrt()
}

fn legendre(t: f64) -> Nodal {
    let mut values = [0.0; NODES];
    add_moments(t, 1.0, &mut values);
    values
}

impl Basis {
    fn new() -> Self {
        let (mut values, mut slopes) = ([[0.0; NODES]; NODES], [[0.0; NODES]; NODES]);
        for (q, &t) in RULE.nodes.iter().enumerate() {
            let p = legendre(t);
            let unit = |k: usize| -> Nodal { std::array::from_fn(|i| f64::from(u8::from(i == k))) };
            let all = Self::in_basis(&p);
            values[q] = all;
            for k in 0..NODES {
                slopes[q][k] = match k {
                    0 => -0.5,
                    1 => 0.5,
                    // P_k' − P_{k−2}' = (2k − 1) P_{k−1}: the slopes of the inner functions are
                    // orthogonal, and the stiffness matrix is diagonal but for the ends.
                    _ => (2.0 * k as f64 - 1.0) * series(&unit(k - 1), t) / norm(k),
                };
            }
        }
        let product = |a: &Matrix| -> Matrix {
            let sum = |k: usize, l: usize| (0..NODES).map(|q| RULE.weights[q] * a[q][k] * a[q][l]).sum();
            std::array::from_fn(|k| std::array::from_fn(|l| sum(k, l)))
        };
        Self { mass: product(&values), stiffness: product(&slopes), values, slopes }
    }

    /// A linear functional of the Legendre polynomials, as one of the basis functions.
    fn in_basis(of: &Nodal) -> Nodal {
        std::array::from_fn(|k| match k {
            0 => 0.5 * (of[0] - of[1]),
            1 => 0.5 * (of[0] + of[1]),
            _ => (of[k] - of[k - 2]) / norm(k),
        })
    }

    /// ∫ of each basis function times a Legendre series, on an element of this half width.
    pub(super) fn moments(series: &Nodal, half: f64) -> Nodal {
        Self::in_basis(&std::array::from_fn(|n| 2.0 * half * series[n] / (2.0 * n as f64 + 1.0)))
    }

    /// The Legendre series of a sum of basis functions.
    pub(super) fn series(amplitudes: &Nodal) -> Nodal {
        let mut out = [0.0; NODES];
        out[0] = 0.5 * (amplitudes[0] + amplitudes[1]);
        out[1] = 0.5 * (amplitudes[1] - amplitudes[0]);
        for k in 2..NODES {
            out[k] += amplitudes[k] / norm(k);
            out[k - 2] -= amplitudes[k] / norm(k);
        }
        out
    }
}

impl Elements {
    /// A density between the first and last of the `edges`, on elements that are halved until each has a
    /// truncation error × half width below the `tolerance` at its upper end, or a half width below `finest`.
    pub fn of(
        density: impl Fn(f64) -> f64,
        edges: &[f64],
        tolerance: impl Fn(f64) -> f64,
        finest: f64,
    ) -> Self {
        let mut out = Self { edges: vec![edges[0]], series: Vec::new() };
        for pair in edges.windows(2) {
            out.resolve(&density, (pair[0], pair[1]), &tolerance, finest);
        }
        out
    }

    fn resolve(
        &mut self,
        density: &impl Fn(f64) -> f64,
        (low, high): (f64, f64),
        tolerance: &impl Fn(f64) -> f64,
        finest: f64,
    ) {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let series = RULE.coefficients(&RULE.nodes.map(|t| density(middle + half * t)));
        let rounding = ROUNDING * series.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
        if tail(&series) > rounding.max(tolerance(high) / half) && half > finest {
            self.resolve(density, (low, middle), tolerance, finest);
            return self.resolve(density, (middle, high), tolerance, finest);
        }
        self.edges.push(high);
        self.series.push(series);
    }

    /// Number of elements.
    pub fn count(&self) -> usize {
        self.series.len()
    }

    /// Middle and half width of an element.
    pub fn element(&self, i: usize) -> (f64, f64) {
        (0.5 * (self.edges[i] + self.edges[i + 1]), 0.5 * (self.edges[i + 1] - self.edges[i]))
    }

    /// Width of an element.
    pub fn width(&self, i: usize) -> f64 {
        self.edges[i + 1] - self.edges[i]
    }

    /// ∫p.
    pub fn mass(&self) -> f64 {
        (0..self.count()).map(|i| self.width(i) * self.series[i][0]).sum()
    }

    /// ∫ of p times several functions.
    pub fn sums<const K: usize>(&self, weights: impl Fn(f64) -> [f64; K]) -> [f64; K] {
        self.sums_above(f64::NEG_INFINITY, weights)
    }

    /// ∫ of p times several functions, above a position.
    pub fn sums_above<const K: usize>(&self, place: f64, weights: impl Fn(f64) -> [f64; K]) -> [f64; K] {
        let mut sums = [0.0; K];
        for i in self.edges[1..].partition_point(|&edge| edge <= place)..self.count() {
            let (middle, half) = self.element(i);
            let from = self.edges[i].max(place);
            let (centre, part) = (0.5 * (from + self.edges[i + 1]), 0.5 * (self.edges[i + 1] - from));
            for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
                let at = centre + part * t;
                let mass = part * w * series(&self.series[i], (at - middle) / half);
                sums.iter_mut().zip(weights(at)).for_each(|(sum, weight)| *sum += mass * weight);
            }
        }
        sums
    }

    /// p at a position, from the right; 0 outside.
    pub fn value(&self, place: f64) -> f64 {
        let above = self.edges.partition_point(|&edge| edge <= place);
        if above == 0 || above > self.count() {
            return 0.0;
        }
        let (middle, half) = self.element(above - 1);
        series(&self.series[above - 1], (place - middle) / half)
    }

    /// The L² projection on other elements of the same interval. It is exact where they are parts of these,
    /// and conserves all moments up to the degree.
    #[must_use]
    pub fn on(&self, edges: &[f64]) -> Self {
        let mut first = 0;
        let mut part = |pair: &[f64]| {
            while first + 1 < self.count() && self.edges[first + 1] <= pair[0] {
                first += 1;
            }
            self.projected((pair[0], pair[1]), first)
        };
        Self { edges: edges.to_vec(), series: edges.windows(2).map(&mut part).collect() }
    }

    /// The projection on [low, high]; `first` is the first element that overlaps it.
    fn projected(&self, (low, high): (f64, f64), first: usize) -> Nodal {
        // Unchanged elements are copied bit for bit, so that rounding does not accumulate over
        // steps.
        if (self.edges[first], self.edges[first + 1]) == (low, high) {
            return self.series[first];
        }
        let half = 0.5 * (high - low);
        let mut moments = [0.0; NODES];
        for i in (first..self.count()).take_while(|&i| self.edges[i] < high) {
            let (from, to) = (self.edges[i].max(low), self.edges[i + 1].min(high));
            let part = 0.5 * (to - from);
            // From differences of edges: positions themselves are rounded by more than narrow elements bear.
            let places = |start: f64, half: f64, t: f64| ((from - start) + part * (1.0 + t)) / half - 1.0;
            for (t, w) in RULE.nodes.iter().zip(&RULE.weights) {
                let mass = w * part * series(&self.series[i], places(self.edges[i], self.element(i).1, *t));
                add_moments(places(low, half, *t), mass, &mut moments);
            }
        }
        std::array::from_fn(|n| moments[n] * (n as f64 + 0.5) / half)
    }

    /// The truncation error of an element.
    pub fn truncation(&self, i: usize) -> f64 {
        tail(&self.series[i])
    }

    /// Joins neighbours where one element represents both to `allowed`(lower end, half width), but never
    /// across the positions `kept`.
    ///
    /// Widths of elements that are joined differ little, so that a layer that spreads meets elements that grow with the distance
    /// from it. A floor that `rises` keeps all narrow elements, which resolve the layer above it. Otherwise one that is left alone
    /// among wide ones after a jump has become smooth is joined, too: the rounding of the flux through it would limit the steps.
    #[must_use]
    pub fn coarsened(mut self, allowed: impl Fn(f64, f64) -> f64, kept: &[f64], rises: bool) -> Self {
        let mut i = 0;
        // A joint element may be joinable with the one before it: one step back after each success.
        while i + 1 < self.count() {
            if let Some(joint) = self.joint(i, &allowed, rises).filter(|_| !kept.contains(&self.edges[i + 1]))
            {
                self.edges.remove(i + 1);
                self.series.remove(i + 1);
                self.series[i] = joint;
                i = i.saturating_sub(1);
            } else {
                i += 1;
            }
        }
        self
    }

    /// One series for an element and the next, if it represents both.
    fn joint(&self, i: usize, allowed: &impl Fn(f64, f64) -> f64, rises: bool) -> Option<Nodal> {
        let narrower = if self.width(i) < self.width(i + 1) { i } else { i + 1 };
        if self.differ_much(i, i + 1) && (rises || !self.is_alone(narrower)) {
            return None;
        }
        let (low, high) = (self.edges[i], self.edges[i + 2]);
        let half = 0.5 * (high - low);
        let (joint, truncation) = (self.projected((low, high), i), allowed(low, half));
        let serves = |k: usize| {
            let place = |t: f64| ((self.edges[k] - low) + 0.5 * self.width(k) * (1.0 + t)) / half - 1.0;
            let off = |t: &f64| (series(&joint, place(*t)) - series(&self.series[k], *t)).abs();
            RULE.nodes.iter().chain(&[-1.0, 1.0]).map(off).fold(0.0, f64::max) <= truncation
        };
        (tail(&joint) <= truncation && serves(i) && serves(i + 1)).then_some(joint)
    }

    /// Whether the widths of two elements differ by so much that they are not neighbours of a graded mesh.
    fn differ_much(&self, i: usize, k: usize) -> bool {
        /// Two of the divisions by four at a jump or a floor.
        const RATIO: f64 = 16.1;
        let [a, b] = [i, k].map(|i| self.width(i));
        a.max(b) > RATIO * a.min(b)
    }

    /// Whether an element has no neighbour of about its width.
    fn is_alone(&self, i: usize) -> bool {
        let below = i.checked_sub(1).is_none_or(|below| self.differ_much(below, i));
        below && (i + 1 == self.count() || self.differ_much(i, i + 1))
    }
}

/// The edges with the roughest elements divided. Rough elements disturb their neighbours: those with a far
/// smaller error wait.
pub(super) fn refined(edges: &[f64], roughness: &[f64], absorbing: bool) -> Vec<f64> {
    /// Elements with at least this fraction of the largest error do not wait.
    const FRACTION: f64 = 0.01;
    let least = (FRACTION * roughness.iter().fold(0.0, |a: f64, &b| a.max(b))).max(1.0);
    let mut out = vec![edges[0]];
    for (i, pair) in edges.windows(2).enumerate() {
        let width = pair[1] - pair[0];
        if roughness[i] >= least {
            // The layer above an absorbing floor is at the lower end of the first element, which is
            // divided unevenly.
            if i == 0 && absorbing {
                out.extend([pair[0] + width / 16.0, pair[0] + width / 4.0]);
            } else {
                // The error of an element falls as the 16th power of its width.
                let parts = (1.3 * roughness[i].powf(1.0 / 16.0)).ceil().clamp(2.0, 4.0);
                out.extend((1..parts as u32).map(|k| pair[0] + width * f64::from(k) / parts));
            }
        }
        out.push(pair[1]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bell(h: f64) -> f64 {
        (-0.5 * ((h - 0.5) / 0.1).powi(2)).exp()
    }

    #[test]
    fn elements_keep_moments_when_they_are_cut_and_joined() {
        let fine = Elements::of(bell, &[0.0, 0.3, 1.0], |_| 1e-15, 1e-6);
        let moments = |p: &Elements| p.sums(|h| [1.0, h, h * h]);
        let cut = fine.on(&[0.0, 0.11, 0.2, 0.3, 0.5, 0.6, 0.9, 1.0]);
        let joined = cut.clone().coarsened(|_, half| 1e-13 / half, &[], false);
        assert!(joined.count() < cut.count());
        for other in [&cut, &joined] {
            for (a, b) in moments(&fine).iter().zip(moments(other)) {
                // Rounding.
                assert!((a - b).abs() < 1e-15, "{a} {b}");
            }
            // What elements leave out, over their widths.
            assert!((other.value(0.47) - bell(0.47)).abs() < 1e-11);
        }
    }

    #[test]
    fn an_element_far_narrower_than_its_neighbours_is_joined_with_them() {
        let narrow = Elements::of(bell, &[0.0, 0.5, 0.5 + 1e-9, 1.0], |_| 1e-15, 1e-6);
        let joined = narrow.clone().coarsened(|_, half| 1e-13 / half, &[], false);
        let narrowest = |p: &Elements| (0..p.count()).map(|i| p.width(i)).fold(f64::INFINITY, f64::min);
        // The tolerance of elements bounds their width from below, of a bell of this width at about a fifth of it.
        assert!(narrowest(&narrow) < 1e-8 && narrowest(&joined) > 0.02, "{}", narrowest(&joined));
        let kept = narrow.coarsened(|_, half| 1e-13 / half, &[0.5], false);
        assert!(kept.edges.contains(&0.5));
    }

    #[test]
    fn elements_as_narrow_as_a_diffusion_layer_are_joined_wherever_they_are() {
        // A jump at 1 of height 1 that has spread over 1e-3, on elements made for a layer of 1e-8.
        let smooth = |h: f64| 8.0 + 0.5 * libm::erfc((h - 1.0) / 1e-3);
        let distances = std::iter::successors(Some(0.25), |d| Some(0.25 * d)).take_while(|d| *d > 1e-8);
        let mut edges: Vec<f64> = distances.flat_map(|d| [1.0 - d, 1.0 + d]).chain([0.5, 1.0, 1.5]).collect();
        edges.sort_by(f64::total_cmp);
        let narrow = Elements::of(smooth, &edges, |_| 1e-15, 1e-9);
        let joined = narrow.clone().coarsened(|_, half| 1e-14 / half, &[], true);
        let narrowest = (0..joined.count()).map(|i| joined.width(i)).fold(f64::INFINITY, f64::min);
        // What is allowed, 1e-11 of the density in elements of this width, is reached with a quarter of the layer.
        assert!(narrowest > 2e-4, "{narrowest:e}, {} elements", joined.count());
        for k in 0..100 {
            let at = 1.0 + 1e-3 * (0.04 * f64::from(k) - 2.0);
            assert!((joined.value(at) - smooth(at)).abs() < 1e-9, "{at}");
        }
    }

    #[test]
    fn sums_of_the_functions_are_legendre_series() {
        let amplitudes: Nodal = std::array::from_fn(|k| 1.0 / (1.0 + k as f64));
        let found = Basis::series(&amplitudes);
        for (q, &t) in RULE.nodes.iter().enumerate() {
            let exact: f64 = (0..NODES).map(|k| amplitudes[k] * BASIS.values[q][k]).sum();
            assert!((series(&found, t) - exact).abs() < 1e-15);
        }
    }
}
