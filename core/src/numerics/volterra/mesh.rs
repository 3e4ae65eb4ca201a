//! The mesh of a solution: runs of cells of equal width, and the earlier solution resampled on the cells of a
//! run.

use super::kernel::Kernel;
use crate::numerics::legendre::{NODES, Nodal, RULE, series, series_at};
use crate::numerics::piecewise::Piecewise;

/// Consecutive cells of one width.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    pub(super) first: usize,
    pub(super) start: f64,
    pub(super) width: f64,
}

/// The cells of a solution and the runs that they form.
#[derive(Debug, Clone, Default)]
pub(super) struct Mesh {
    pub(super) boundaries: Vec<f64>,
    pub(super) runs: Vec<Run>,
    pub(super) run_of: Vec<u32>,
}

impl Mesh {
    pub(super) fn cells(&self) -> usize {
        self.run_of.len()
    }

    /// Middle and half width; in a run, middles are exact multiples of the width apart.
    pub(super) fn cell(&self, cell: usize) -> (f64, f64) {
        let run = self.runs[self.run_of[cell] as usize];
        (run.start + ((cell - run.first) as f64 + 0.5) * run.width, 0.5 * run.width)
    }

    /// Gauss points of a cell, each as the start of its run and the distance from there.
    pub(super) fn points(&self, cell: usize) -> [(f64, f64); NODES] {
        let run = self.runs[self.run_of[cell] as usize];
        let middle = (cell - run.first) as f64 + 0.5;
        RULE.nodes.map(|t| (run.start, (middle + 0.5 * t) * run.width))
    }

    /// ∫₀^x of kernel(x − Y) density(Y), cell by cell.
    pub(super) fn convolve_at(&self, density: &Piecewise, kernel: &Kernel, x: f64) -> f64 {
        let low = x - kernel.curve().end();
        let first = self.boundaries.partition_point(|&b| b <= low).saturating_sub(1);
        let cells = (first..self.cells()).take_while(|&cell| self.boundaries[cell] < x);
        cells.map(|cell| self.convolve_cell(cell, &density.coefficients[cell], kernel, x)).sum()
    }

    /// The part of that integral from a cell on which the density has the Legendre coefficients `density`.
    pub(super) fn convolve_cell(&self, cell: usize, density: &Nodal, kernel: &Kernel, x: f64) -> f64 {
        let (middle, half) = self.cell(cell);
        let (low, high) = ((x - middle - half).max(0.0), x - middle + half);
        let mut cuts = vec![low];
        kernel.splits(low, high, 2.0 * half, &mut cuts);
        cuts.push(high);
        if cuts.len() == 2 && low > 0.0 {
            // Far from a narrow cell, x − u would lose the digits of the position within the cell.
            let part = |t: f64| series(density, t) * kernel.curve().value(x - middle - half * t);
            return half * (0..NODES).map(|i| RULE.weights[i] * part(RULE.nodes[i])).sum::<f64>();
        }
        let integrand = |u: f64| series(density, (x - u - middle) / half) * kernel.curve().value(u);
        cuts.windows(2).map(|pair| RULE.integrate(pair[0], pair[1], integrand)).sum()
    }
}

/// The solution before a run on one cell as wide as those of the run and aligned with them.
pub(super) struct Resampled {
    /// Gauss values of the least-squares fit to the density: all that a kernel that is smooth on this scale
    /// can see.
    pub(super) values: Nodal,
    /// The cells that it consists of, cut at its ends: middle, half width, Gauss values. Empty if the fit is
    /// exact.
    pub(super) parts: Vec<(f64, f64, Nodal)>,
    /// Largest difference between density and fit.
    pub(super) roughness: f64,
}

/// Longer runs resample the earlier solution.
pub(super) const SHORT_RUN: usize = 3;

/// Largest number of resampled cells.
const LONGEST_PAST: usize = 16_384;

impl Resampled {
    /// The solution before a run, back to 0 or `reach`, latest cell first; `None` if there would be too many.
    pub(super) fn of(run: Run, density: &Piecewise, reach: f64) -> Option<Vec<Self>> {
        let count = (run.start.min(reach) / run.width - 1e-9).ceil();
        let back = |k: usize| run.start - k as f64 * run.width;
        (count <= LONGEST_PAST as f64)
            .then(|| (0..count as usize).map(|k| Self::new(density, back(k + 1), back(k))).collect())
    }

    fn new(density: &Piecewise, low: f64, high: f64) -> Self {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let edges = &density.boundaries;
        let first = edges.partition_point(|&b| b <= low).saturating_sub(1);
        let mut parts = Vec::new();
        for cell in (first..density.coefficients.len()).take_while(|&cell| edges[cell] < high) {
            let (centre, whole) = density.cell(cell);
            let (a, b) = (edges[cell].max(low), edges[cell + 1].min(high));
            let (m, h) = (0.5 * (a + b), 0.5 * (b - a));
            // Overlaps due to rounding do not count.
            if h > 1e-9 * whole {
                let within = RULE.nodes.map(|t| ((m - centre) + h * t) / whole);
                parts.push((m, h, series_at(&density.coefficients[cell], &within)));
            }
        }
        if parts.len() == 1 && parts[0].1 > half * (1.0 - 1e-6) {
            return Self { values: parts[0].2, parts: Vec::new(), roughness: 0.0 };
        }
        let mut values = [0.0; NODES];
        for (m, h, part) in &parts {
            for i in 0..NODES {
                let cardinals = RULE.cardinals((m + h * RULE.nodes[i] - middle) / half);
                let weight = h / half * RULE.weights[i] * part[i];
                (0..NODES).for_each(|j| values[j] += weight * cardinals[j]);
            }
        }
        (0..NODES).for_each(|j| values[j] /= RULE.weights[j]);
        let fit = RULE.coefficients(&values);
        let missed = |(m, h, part): &(f64, f64, Nodal)| {
            let at = |i: usize| part[i] - series(&fit, (m + h * RULE.nodes[i] - middle) / half);
            (0..NODES).map(|i| at(i).abs()).fold(0.0, f64::max)
        };
        let roughness = parts.iter().map(missed).fold(0.0, f64::max);
        Self { values, parts, roughness }
    }
}
