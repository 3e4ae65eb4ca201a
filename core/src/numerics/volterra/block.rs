//! Convolution blocks: the matrices that take the density on one cell to its contribution to the convolution
//! on another.

use std::collections::HashMap;

use super::kernel::Kernel;
use super::leading::Leading;
use super::mesh::{FAR, Mesh, Resampled, SHORT_RUN};
use crate::numerics::legendre::{NODES, Nodal, RULE, add_moments_at, dot_in_lanes, gauss_points, series_at};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::wide::vectorised;

/// A matrix from the Gauss values on one cell to those on another, column by column.
pub(super) type ConvolutionBlock = [Nodal; NODES];

/// A block between cells a given number of widths apart.
pub(super) struct LaggedBlock {
    /// `None` where the kernel vanishes.
    pub(super) block: Option<Box<ConvolutionBlock>>,
    /// Magnitude of the part of the kernel that is not smooth on the scale of the cells: a smooth kernel only
    /// sees a polynomial part of the density.
    pub(super) roughness: f64,
}

/// Relative position of two cells: the distance of their middles in units of 1e-11 of the target's width, and
/// the two widths.
///
/// The distance is a whole number kept as the bits of a float: beside a breakpoint, cells are so narrow that it exceeds
/// every integer type, and a saturated distance would be that of other pairs too.
type RelativePosition = (u64, u64, u64);

fn by_position(target: (f64, f64), source: (f64, f64)) -> RelativePosition {
    // But for the last 16 bits, 1e-11 of the number.
    let rounded = |width: f64| (width.to_bits() + (1 << 15)) >> 16;
    let gap = (target.0 - source.0) / (2e-11 * target.1);
    (gap.round().to_bits(), rounded(target.1), rounded(source.1))
}

/// Largest number of blocks cached between cells of different runs: 32 MB.
const MOST_CACHED: usize = 1 << 14;

/// What is kept of a function before a run.
#[derive(Default)]
pub(super) struct Past {
    /// The function on cells as wide as those of the run, once it is needed.
    resampled: Option<Vec<Resampled>>,
    /// Its leading cells, merged as far as was needed.
    leading: Leading,
}

impl Past {
    /// Drops what belongs to the run before.
    pub(super) fn start_run(&mut self) {
        self.resampled = None;
    }
}

/// A cell by its middle and half width, and the density at its Gauss points.
pub(super) type FarCell = ((f64, f64), Nodal);

/// The blocks of one kernel on the latest run of a mesh, each computed once.
pub(super) struct Blocks<'a> {
    kernel: &'a Kernel,
    /// Error allowed when the history is replaced by its fit.
    slack: f64,
    /// By distance in cells.
    cached: Vec<LaggedBlock>,
    /// Between cells of different runs; many coincide where breakpoints lie on a lattice.
    by_position: HashMap<RelativePosition, Option<Box<ConvolutionBlock>>>,
    run: u32,
    past: Past,
}

impl<'a> Blocks<'a> {
    /// Blocks for a convolution with an allowed error of some 1e-4 of `density`, per unit of the kernel.
    pub(super) fn new(kernel: &'a Kernel, density: f64) -> Self {
        let slack = 1e-4 * density * kernel.size();
        Self {
            kernel,
            slack,
            cached: Vec::new(),
            by_position: HashMap::new(),
            run: u32::MAX,
            past: Past::default(),
        }
    }

    pub(super) fn reset(&mut self, run: u32) {
        self.run = run;
        self.cached.clear();
        self.past.start_run();
    }

    /// The leading cells of the function whose history was added last, merged as far as was needed.
    pub(super) fn leading(&self) -> &Leading {
        &self.past.leading
    }

    /// Adds ∫ k(X_i − Y) g(Y) dY over all cells with known `values` at the Gauss points X_i of `cell`, which
    /// is one of them or the next. `density` holds the same values as Legendre series.
    pub(super) fn add_history(
        &mut self,
        mesh: &Mesh,
        cell: usize,
        values: &[Nodal],
        density: &Piecewise,
        out: &mut Nodal,
    ) {
        if mesh.run_of[cell] != self.run {
            self.reset(mesh.run_of[cell]);
        }
        let mut past = std::mem::take(&mut self.past);
        self.add_history_of(mesh, cell, (values, density, &mut past), out);
        self.past = past;
    }

    /// The same for one of several functions that share the blocks; each has a `past` of its own, which
    /// is told when a run starts.
    pub(super) fn add_history_of(
        &mut self,
        mesh: &Mesh,
        cell: usize,
        history: (&[Nodal], &Piecewise, &mut Past),
        out: &mut Nodal,
    ) {
        let target = mesh.cell(cell);
        self.add_history_by(mesh, cell, history, out, |blocks, source, values, out| {
            blocks.add_cell(target, source, values, out);
        });
    }

    /// The same, with `far` for cells, each by its middle, half width and values, that no block of the run applies to.
    pub(super) fn add_history_by(
        &mut self,
        mesh: &Mesh,
        cell: usize,
        (values, density, past): (&[Nodal], &Piecewise, &mut Past),
        out: &mut Nodal,
        mut far: impl FnMut(&mut Self, (f64, f64), &Nodal, &mut Nodal),
    ) {
        if mesh.run_of[cell] != self.run {
            self.reset(mesh.run_of[cell]);
        }
        let run = mesh.runs[self.run as usize];
        let (end, ahead) = (self.kernel.curve().end(), cell - run.first);
        let near = |lag: usize| (lag as f64 - 1.0) * run.width < end;
        // Cells of the same run: one block for each distance (block Toeplitz).
        for source in (run.first..values.len()).rev().take_while(|source| near(cell - source)) {
            if let Some(block) = &self.within_run(run.width, cell - source).block {
                apply(block, &values[source], out);
            }
        }
        if past.resampled.is_none() && ahead >= SHORT_RUN && run.first > 0 {
            past.resampled = Resampled::of(run, density, end);
        }
        // Earlier runs have other widths. Resampled on the cells of this run they can use the same blocks, as
        // long as neither the density nor the kernel has structure that the resampling loses.
        let slack = self.slack;
        let Some(past) = &past.resampled else {
            let start = mesh.boundaries[cell];
            let near = |source: &usize| start - mesh.boundaries[source + 1] < end;
            let limit = (FAR * start).min(run.start);
            past.leading.extend(density, limit);
            let smooth = |reach: f64| self.kernel.is_smooth(start - reach, start + run.width, reach);
            let merged = past.leading.until(&density.boundaries, limit).filter(|merged| smooth(merged.1));
            let first = merged.map_or(0, |(cells, ..)| cells);
            for source in (first..run.first.min(values.len())).rev().take_while(near) {
                far(self, mesh.cell(source), &values[source], out);
            }
            if let Some((_, reach, values)) = merged {
                far(self, (0.5 * reach, 0.5 * reach), values, out);
            }
            return;
        };
        for (k, source) in past.iter().enumerate().take_while(|(k, _)| near(ahead + 1 + k)) {
            let lagged = self.within_run(run.width, ahead + 1 + k);
            match &lagged.block {
                block if source.roughness * lagged.roughness * run.width <= slack => {
                    block.iter().for_each(|block| apply(block, &source.values, out));
                }
                _ => {
                    for (middle, half, values) in &source.parts {
                        far(self, (*middle, *half), values, out);
                    }
                }
            }
        }
    }

    /// Adds the integral over `cell` itself, which has these values.
    pub(super) fn add_own(&mut self, mesh: &Mesh, cell: usize, values: &Nodal, out: &mut Nodal) {
        if mesh.run_of[cell] != self.run {
            self.reset(mesh.run_of[cell]);
        }
        let width = mesh.runs[self.run as usize].width;
        if let Some(block) = &self.within_run(width, 0).block {
            apply(block, values, out);
        }
    }

    /// Adds the contribution of a cell of any run. A kernel with steep breakpoints bypasses the cache, which
    /// does not separate positions that close.
    fn add_cell(&mut self, target: (f64, f64), source: (f64, f64), values: &Nodal, out: &mut Nodal) {
        let kernel = self.kernel;
        if kernel.is_steep() {
            block(kernel, target, source).block.iter().for_each(|block| apply(block, values, out));
            return;
        }
        if self.by_position.len() >= MOST_CACHED {
            self.by_position.clear();
        }
        let block = self
            .by_position
            .entry(by_position(target, source))
            .or_insert_with(|| block(kernel, target, source).block);
        block.iter().for_each(|block| apply(block, values, out));
    }

    /// The block between cells `lag` apart in the current run.
    fn within_run(&mut self, width: f64, lag: usize) -> &LaggedBlock {
        while self.cached.len() <= lag {
            let gap = self.cached.len() as f64 * width;
            self.cached.push(block(self.kernel, (gap, 0.5 * width), (0.0, 0.5 * width)));
        }
        &self.cached[lag]
    }
}

/// out += block · values.
#[inline]
pub(super) fn apply(block: &ConvolutionBlock, values: &Nodal, out: &mut Nodal) {
    vectorised(
        #[inline(always)]
        || multiply(block, values, out),
    );
}

#[inline(always)]
fn multiply(block: &ConvolutionBlock, values: &Nodal, out: &mut Nodal) {
    let mut sums = *out;
    for (column, value) in block.iter().zip(values) {
        for (sum, entry) in sums.iter_mut().zip(column) {
            *sum += entry * value;
        }
    }
    *out = sums;
}

/// Where the kernel is below this fraction of its mean, a block is neglected: a thousand of them add 1e-16 of
/// the mass of the source, which a narrow cell may hold as well as a wide one.
const NEGLIGIBLE: f64 = 1e-20;

/// The block ∫_source ℓ_j(Y) k(X_i − Y) dY for the Gauss points X_i of the cell `target`; ℓ_j are the
/// cardinal polynomials.
pub(super) fn block(kernel: &Kernel, target: (f64, f64), source: (f64, f64)) -> LaggedBlock {
    vectorised(
        #[inline(always)]
        || computed(kernel, target, source),
    )
}

/// The same, compiled for the registers of its caller.
#[inline(always)]
fn computed(kernel: &Kernel, target: (f64, f64), source: (f64, f64)) -> LaggedBlock {
    let gap = target.0 - source.0;
    let reach = target.1 + source.1;
    let negligible = NEGLIGIBLE * kernel.size() / kernel.curve().end();
    if kernel.bound(gap - reach, gap + reach) < negligible {
        return LaggedBlock { block: None, roughness: 0.0 };
    }
    let mut out = Box::new([[0.0; NODES]; NODES]);
    let (mut largest, mut split) = ([0.0_f64; NODES], false);
    let mut cuts = Vec::new();
    for i in 0..NODES {
        let offset = gap + target.1 * RULE.nodes[i];
        let (low, high) = ((offset - source.1).max(0.0), offset + source.1);
        if high <= 0.0 || low >= kernel.curve().end() {
            continue;
        }
        // Up to a distance of 0 the kernel may have many narrow cells.
        let leading = if low == 0.0 { kernel.leading(high) } else { None };
        let low = leading.map_or(low, |merged| merged.0);
        cuts.clear();
        cuts.push(low);
        kernel.splits(low, high, 2.0 * source.1, &mut cuts);
        cuts.push(high);
        let mut row = [0.0; NODES];
        if cuts.len() == 2 && offset >= source.1 {
            let values = kernel.curve().values(&gauss_points(offset, -source.1));
            (0..NODES).for_each(|j| row[j] = source.1 * RULE.weights[j] * values[j]);
        } else {
            split = true;
            row = split_row(kernel, (offset, source.1), leading, &cuts);
        }
        for j in 0..NODES {
            out[j][i] = row[j];
            largest[j] = largest[j].max(row[j].abs());
        }
    }
    let (width, largest) = (2.0 * source.1, largest.into_iter().fold(0.0, f64::max));
    let spacing = width / (2 * NODES) as f64;
    let roughness = if split { kernel.roughness(gap - reach, gap + reach, width, spacing) } else { 0.0 };
    LaggedBlock { block: (largest > width * negligible).then_some(out), roughness }
}

/// One row of a block whose integrand is smooth only between the `cuts` in u; before the first, the kernel is `leading`.
#[inline(always)]
fn split_row(
    kernel: &Kernel,
    (offset, half): (f64, f64),
    leading: Option<(f64, &Nodal)>,
    cuts: &[f64],
) -> Nodal {
    let (curve, mut moments) = (kernel.curve(), [0.0; NODES]);
    let mut add = |places: &Nodal, part: f64, values: &Nodal| {
        let t = std::array::from_fn(|i| ((offset - places[i]) / half).clamp(-1.0, 1.0));
        let weighted = std::array::from_fn(|i| values[i] * (part * RULE.weights[i]));
        add_moments_at(&t, &weighted, &mut moments);
    };
    if let Some((end, values)) = leading {
        add(&gauss_points(0.5 * end, 0.5 * end), 0.5 * end, values);
    }
    for pair in cuts.windows(2) {
        let (middle, part) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        let Some(cell) = curve.find(middle) else { continue };
        // One look-up serves the whole part if it lies in one cell.
        let inside = curve.boundaries[cell] <= pair[0] && pair[1] <= curve.boundaries[cell + 1];
        let places = gauss_points(middle, part);
        let values = if inside { curve.values_in(cell, &places) } else { curve.values(&places) };
        add(&places, part, &values);
    }
    RULE.functional(&moments)
}

/// Adds ∫_source g(Y) k(X_i − Y) dY at the Gauss points X_i of the cell `target` for several kernels k on the same cells,
/// and g with these values: for a pair of cells that is met once, this costs less than blocks, and the kernels share the
/// values of g where an integral is split.
pub(super) fn add_directly(kernels: &[&Kernel], target: (f64, f64), source: &FarCell, out: &mut [Nodal]) {
    vectorised(
        #[inline(always)]
        || integrate_directly(kernels, target, source, out),
    );
}

#[inline(always)]
fn integrate_directly(
    kernels: &[&Kernel],
    target: (f64, f64),
    &((centre, half), ref values): &FarCell,
    out: &mut [Nodal],
) {
    let (shared, density) = (kernels[0], RULE.coefficients(values));
    let mut cuts = Vec::new();
    for i in 0..NODES {
        let offset = target.0 - centre + target.1 * RULE.nodes[i];
        let (low, high) = ((offset - half).max(0.0), offset + half);
        if high <= 0.0 || low >= shared.curve().end() {
            continue;
        }
        cuts.clear();
        cuts.push(low);
        shared.splits(low, high, 2.0 * half, &mut cuts);
        cuts.push(high);
        if cuts.len() == 2 && offset >= half {
            let (places, mut weights) = (gauss_points(offset, -half), *values);
            (0..NODES).for_each(|j| weights[j] *= half * RULE.weights[j]);
            for (kernel, out) in kernels.iter().zip(&mut *out) {
                out[i] += dot_in_lanes(&weights, &kernel.curve().values(&places));
            }
            continue;
        }
        for pair in cuts.windows(2) {
            let (middle, part) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
            let Some(cell) = shared.curve().find(middle) else { continue };
            let places = gauss_points(middle, part);
            let mut t = places;
            t.iter_mut().for_each(|u| *u = ((offset - *u) / half).clamp(-1.0, 1.0));
            let mut weights = series_at(&density, &t);
            (0..NODES).for_each(|j| weights[j] *= part * RULE.weights[j]);
            let edges = &shared.curve().boundaries;
            let inside = edges[cell] <= pair[0] && pair[1] <= edges[cell + 1];
            for (kernel, out) in kernels.iter().zip(&mut *out) {
                let curve = kernel.curve();
                let values = if inside { curve.values_in(cell, &places) } else { curve.values(&places) };
                out[i] += dot_in_lanes(&weights, &values);
            }
        }
    }
}

/// The inverse of a small matrix by Gauss–Jordan elimination with pivoting. The matrices are near the
/// identity.
pub(super) fn inverted(mut a: ConvolutionBlock) -> ConvolutionBlock {
    let mut out = [[0.0; NODES]; NODES];
    (0..NODES).for_each(|i| out[i][i] = 1.0);
    // Columns are stored together, so this eliminates on the transpose, whose inverse is the transpose of the inverse.
    for pivot in 0..NODES {
        let best =
            (pivot..NODES).max_by(|&p, &q| a[p][pivot].abs().total_cmp(&a[q][pivot].abs())).unwrap_or(pivot);
        a.swap(pivot, best);
        out.swap(pivot, best);
        let scale = 1.0 / a[pivot][pivot];
        a[pivot].iter_mut().chain(out[pivot].iter_mut()).for_each(|x| *x *= scale);
        let (row, result) = (a[pivot], out[pivot]);
        for other in (0..NODES).filter(|&k| k != pivot) {
            let factor = a[other][pivot];
            (0..NODES).for_each(|k| {
                a[other][k] -= factor * row[k];
                out[other][k] -= factor * result[k];
            });
        }
    }
    out
}
