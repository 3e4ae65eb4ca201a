//! Quadrature over the stretches at which contacts start, for several weights at once.

use super::cells::NEGLIGIBLE;
use super::panels::near;
use crate::numerics::legendre::{NODES, Nodal, RULE, add_moments_at, gauss_points, series_at};

/// Product integration: Σ_j ω_kj f(r_j) = ∫ w_k(r) f(r) dr for weights w_k and any f that a polynomial of degree 15
/// represents on a panel, ω_kj = ∫ w_k ℓ_j dr with the cardinal polynomials ℓ_j of the Gauss points r_j (P. J. Davis and
/// P. Rabinowitz, *Methods of Numerical Integration*, 1984, §2.5.6). The weights may have either sign and any width:
/// all share the points, whose number follows from f alone.
pub(super) struct StartQuadrature<W> {
    panels: Vec<Panel>,
    weights: W,
    count: usize,
}

/// Points r_j with their ω_kj for each k.
pub(super) struct Points {
    pub(super) r: Nodal,
    pub(super) weights: Vec<Nodal>,
}

struct Panel {
    low: f64,
    high: f64,
    /// Ends of the cells on which the weights are smooth.
    cells: Vec<f64>,
    /// For each cell, the Legendre coefficients of each weight.
    series: Vec<Vec<Nodal>>,
    points: Points,
}

impl<W: Fn(f64, &mut [f64])> StartQuadrature<W> {
    /// For `count` weights w_k, written by `weights`, that are smooth between the rising `ends`, with panels no wider
    /// than `widest`.
    pub(super) fn new(ends: &[f64], widest: f64, count: usize, weights: W) -> Self {
        let mut panels = Vec::new();
        if let (Some(&low), Some(&high)) = (ends.first(), ends.last()) {
            let parts = ((high - low) / widest).ceil().max(if high > low { 1.0 } else { 0.0 });
            let at = |part: usize| low + (high - low) * part as f64 / parts;
            for part in 0..parts as usize {
                let (low, high) = (at(part), at(part + 1));
                let inside = ends.iter().copied().filter(|&r| r > low && r < high);
                let cells: Vec<f64> = [low].into_iter().chain(inside).chain([high]).collect();
                let values: Vec<_> =
                    cells.windows(2).map(|ends| at_gauss_points(ends[0], ends[1], count, &weights)).collect();
                let points = product_rule(&cells, count, &values);
                if points.weights.iter().flatten().any(|weight| weight.abs() > NEGLIGIBLE) {
                    let of_cell = |values: &Vec<Nodal>| values.iter().map(|v| RULE.coefficients(v)).collect();
                    let series = values.iter().map(of_cell).collect();
                    panels.push(Panel { low, high, cells, series, points });
                }
            }
        }
        Self { panels, weights, count }
    }

    /// Visits all points, for a function that is smooth between `cuts` but for powers of the distance to the positions in
    /// `steep`. Panels with one of them are divided; the visitor learns which points are near a steep position.
    pub(super) fn each(&self, cuts: &[f64], steep: &[f64], mut visit: impl FnMut(&Points, bool)) {
        for panel in &self.panels {
            let (low, high) = (panel.low, panel.high);
            let inside = cuts.iter().copied().filter(|&r| r > low && r < high);
            let mut ends: Vec<f64> = inside.collect();
            if ends.is_empty() && !near(steep, low, high) {
                visit(&panel.points, false);
                continue;
            }
            ends.extend(&panel.cells);
            ends.sort_by(f64::total_cmp);
            for pair in ends.windows(2).filter(|pair| pair[0] < pair[1]) {
                if near(steep, pair[0], pair[1]) {
                    graded((pair[0], pair[1]), 1e-16 * (high - low), steep, &mut |low, high| {
                        let values = at_gauss_points(low, high, self.count, &self.weights);
                        visit(&gauss(low, high, values), true);
                    });
                } else {
                    visit(&panel.section(pair[0], pair[1]), false);
                }
            }
        }
    }
}

impl Panel {
    /// The Gauss rule on a section of one of the cells.
    fn section(&self, low: f64, high: f64) -> Points {
        let middle = 0.5 * (low + high);
        let cell = self.cells.partition_point(|&end| end <= middle) - 1;
        let (centre, half) = (
            0.5 * (self.cells[cell] + self.cells[cell + 1]),
            0.5 * (self.cells[cell + 1] - self.cells[cell]),
        );
        let t = gauss_points((middle - centre) / half, 0.5 * (high - low) / half);
        gauss(low, high, self.series[cell].iter().map(|series| series_at(series, &t)).collect())
    }
}

/// `count` weights at the Gauss points of an interval.
fn at_gauss_points(low: f64, high: f64, count: usize, weights: impl Fn(f64, &mut [f64])) -> Vec<Nodal> {
    let r = gauss_points(0.5 * (low + high), 0.5 * (high - low));
    let (mut out, mut values) = (vec![[0.0; NODES]; count], vec![0.0; count]);
    for j in 0..NODES {
        weights(r[j], &mut values);
        out.iter_mut().zip(&values).for_each(|(of, value)| of[j] = *value);
    }
    out
}

/// The Gauss rule on an interval, for weights with these values.
fn gauss(low: f64, high: f64, mut weights: Vec<Nodal>) -> Points {
    let half = 0.5 * (high - low);
    for of in &mut weights {
        of.iter_mut().zip(&RULE.weights).for_each(|(value, weight)| *value *= half * weight);
    }
    Points { r: gauss_points(0.5 * (low + high), half), weights }
}

/// The points of a panel with these cells, at whose Gauss points the `count` weights have these values.
fn product_rule(cells: &[f64], count: usize, values: &[Vec<Nodal>]) -> Points {
    let (low, high) = (cells[0], cells[cells.len() - 1]);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let mut moments = vec![[0.0; NODES]; count];
    for (pair, values) in cells.windows(2).zip(values) {
        let (centre, part) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        let t = gauss_points(centre, part).map(|r| (r - middle) / half);
        for (values, moments) in values.iter().zip(&mut moments) {
            let terms = std::array::from_fn(|j| part * RULE.weights[j] * values[j]);
            add_moments_at(&t, &terms, moments);
        }
    }
    let weights = moments.iter().map(|moments| RULE.functional(moments)).collect();
    Points { r: gauss_points(middle, half), weights }
}

/// Visits the parts of an interval, bisected down to the width `least` while they are wider than their distance to a steep
/// position.
fn graded((low, high): (f64, f64), least: f64, steep: &[f64], visit: &mut impl FnMut(f64, f64)) {
    let middle = 0.5 * (low + high);
    if high - low > least && low < middle && middle < high && near(steep, low, high) {
        graded((low, middle), least, steep, visit);
        return graded((middle, high), least, steep, visit);
    }
    visit(low, high);
}
