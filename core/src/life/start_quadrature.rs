//! Quadrature over the stretches at which contacts start, for several weights at once.

use super::cells::NEGLIGIBLE;
use super::panels::near;
use crate::numerics::legendre::{NODES, Nodal, RULE, add_moments};

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
                let points = product_rule(&cells, count, &weights);
                if points.weights.iter().flatten().any(|weight| weight.abs() > NEGLIGIBLE) {
                    panels.push(Panel { low, high, cells, points });
                }
            }
        }
        Self { panels, weights, count }
    }

    /// Visits all points, for a function that is smooth between `cuts` but for powers of the distance to the positions in
    /// `steep`. Panels with one of them are divided; the visitor is told which points are of these.
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
                graded((pair[0], pair[1]), 1e-16 * (high - low), steep, &mut |low, high| {
                    visit(&self.gauss(low, high), true);
                });
            }
        }
    }

    /// The Gauss rule on an interval on which the weights are smooth.
    fn gauss(&self, low: f64, high: f64) -> Points {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let r = RULE.nodes.map(|t| middle + half * t);
        let (mut weights, mut values) = (vec![[0.0; NODES]; self.count], vec![0.0; self.count]);
        for j in 0..NODES {
            (self.weights)(r[j], &mut values);
            weights.iter_mut().zip(&values).for_each(|(of, value)| of[j] = half * RULE.weights[j] * value);
        }
        Points { r, weights }
    }
}

/// The points of a panel with these cells.
fn product_rule(cells: &[f64], count: usize, weights: impl Fn(f64, &mut [f64])) -> Points {
    let (low, high) = (cells[0], cells[cells.len() - 1]);
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let (mut moments, mut values) = (vec![[0.0; NODES]; count], vec![0.0; count]);
    for pair in cells.windows(2) {
        let (centre, part) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        for (t, weight) in RULE.nodes.iter().zip(&RULE.weights) {
            let r = centre + part * t;
            weights(r, &mut values);
            for (value, moments) in values.iter().zip(&mut moments) {
                add_moments((r - middle) / half, part * weight * value, moments);
            }
        }
    }
    let weights = moments.iter().map(|moments| RULE.functional(moments)).collect();
    Points { r: RULE.nodes.map(|t| middle + half * t), weights }
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
