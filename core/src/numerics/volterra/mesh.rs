//! The mesh of a solution: runs of cells of equal width, and the earlier solution resampled on the cells of a
//! run.

use super::kernel::Kernel;
use super::leading::Leading;
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

    /// ∫₀^x of kernel(x − Y) density(Y) over the cells that have a density, one by one but for leading cells far from x.
    pub(super) fn convolve_at(
        &self,
        (density, leading): (&Piecewise, &Leading),
        kernel: &Kernel,
        x: f64,
    ) -> f64 {
        let low = x - kernel.curve().end();
        let first = self.boundaries.partition_point(|&b| b <= low).saturating_sub(1);
        let merged = leading.until(&density.boundaries, FAR * x);
        let merged = merged.filter(|&(cells, end, _)| first < cells && kernel.is_smooth(x - end, x, end));
        let far = merged.map_or(0.0, |(_, end, values)| {
            convolve_part((0.5 * end, 0.5 * end), &RULE.coefficients(values), kernel, x)
        });
        let first = merged.map_or(first, |(cells, ..)| cells);
        let cells = (first..density.coefficients.len()).take_while(|&cell| self.boundaries[cell] < x);
        far + cells.map(|cell| self.convolve_cell(cell, &density.coefficients[cell], kernel, x)).sum::<f64>()
    }

    /// The part of that integral from a cell on which the density has the Legendre coefficients `density`.
    pub(super) fn convolve_cell(&self, cell: usize, density: &Nodal, kernel: &Kernel, x: f64) -> f64 {
        convolve_part(self.cell(cell), density, kernel, x)
    }
}

/// ∫ of kernel(x − Y) density(Y) over Y < x in a cell.
#[inline(never)]
fn convolve_part((middle, half): (f64, f64), density: &Nodal, kernel: &Kernel, x: f64) -> f64 {
    let (low, high) = ((x - middle - half).max(0.0), x - middle + half);
    let density_at = |t: f64| series(density, t);
    let density = |u: f64| density_at((x - u - middle) / half);
    // Down to a distance of 0 the kernel may have many narrow cells.
    let leading = if low < 4.0 * f64::EPSILON * x { kernel.leading(high) } else { None };
    let (low, near) = leading.map_or((low, 0.0), |(end, values)| {
        let part = |i: usize| RULE.weights[i] * values[i] * density(0.5 * end * (1.0 + RULE.nodes[i]));
        (end, 0.5 * end * (0..NODES).map(part).sum::<f64>())
    });
    let mut cuts = vec![low];
    kernel.splits(low, high, 2.0 * half, &mut cuts);
    cuts.push(high);
    if cuts.len() == 2 && low > 0.0 && leading.is_none() {
        // Far from a narrow cell, x − u would lose the digits of the position within the cell.
        let part = |t: f64| density_at(t) * kernel.curve().value(x - middle - half * t);
        return half * (0..NODES).map(|i| RULE.weights[i] * part(RULE.nodes[i])).sum::<f64>();
    }
    let integrand = |u: f64| density(u) * kernel.curve().value(u);
    near + cuts.windows(2).map(|pair| RULE.integrate(pair[0], pair[1], integrand)).sum::<f64>()
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

/// Merged cells end at this fraction of a position that they are convolved to: a kernel with a singularity at 0 is resolved
/// there as well as it is on its own cells, which double in width.
pub(super) const FAR: f64 = 0.25;

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
        let values = RULE.projection(&parts, (middle, half));
        let fit = RULE.coefficients(&values);
        let missed = |(m, h, part): &(f64, f64, Nodal)| {
            let at = |i: usize| part[i] - series(&fit, (m + h * RULE.nodes[i] - middle) / half);
            (0..NODES).map(|i| at(i).abs()).fold(0.0, f64::max)
        };
        let roughness = parts.iter().map(missed).fold(0.0, f64::max);
        Self { values, parts, roughness }
    }
}
