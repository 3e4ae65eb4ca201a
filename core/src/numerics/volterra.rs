//! Volterra equations of the second kind of convolution type, g = source + kernel ∗ g, to high order.
//!
//! g is a sum of atoms and of a density that is a polynomial on each cell of a mesh, collocated at the Gauss points
//! (H. Brunner, *Collocation Methods for Volterra Integral and Related Functional Differential Equations*, 2004).
//! Cell boundaries lie on every break of g that matters, so jumps cost no accuracy; cells are halved where the
//! polynomial is not resolved and grow again where it is. In a run of equal cells the history is a block
//! Toeplitz product whose blocks are computed once.

use super::breaks::{Atom, Break, renewed, same_position};
use super::legendre::{NODES, Nodal, RULE};
use super::piecewise::{Piecewise, tail};
use crate::monitor::{Monitor, report};
use crate::{Error, Float, Result};

/// A matrix from the Gauss values of one cell to those of another, column by column.
type Block = [Nodal; NODES];

/// A density on u ≥ 0 with its breaks, atoms among them.
#[derive(Debug, Clone, Default)]
pub struct Kernel {
    curve: Piecewise,
    breaks: Vec<Break>,
    /// For each boundary of the curve: is it a break?
    hard: Vec<bool>,
}

impl Kernel {
    /// A kernel from its density and all its breaks, by rising position.
    pub fn new(curve: Piecewise, breaks: Vec<Break>) -> Self {
        let next = |x: f64| breaks.partition_point(|b| b.position < x * (1.0 - 1e-12));
        let is_break = |x: f64| breaks.get(next(x)).is_some_and(|b| same_position(b.position, x));
        let hard = curve.boundaries.iter().map(|&x| is_break(x)).collect();
        Self { curve, breaks, hard }
    }

    /// The density.
    pub fn curve(&self) -> &Piecewise {
        &self.curve
    }

    /// The breaks.
    pub fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    /// Point masses.
    pub fn atoms(&self) -> impl Iterator<Item = Atom> + '_ {
        let atoms = self.breaks.iter().filter(|b| b.is_atom());
        atoms.map(|b| Atom { position: b.position, weight: b.amplitude })
    }

    /// Boundaries in (low, high) at which a quadrature over cells of width `width` must be split.
    fn splits(&self, low: f64, high: f64, width: f64, out: &mut Vec<f64>) {
        let edges = &self.curve.boundaries;
        let first = edges.partition_point(|&b| b <= low);
        for k in first..edges.len() {
            if edges[k] >= high {
                break;
            }
            let left = k.checked_sub(1).map_or(f64::INFINITY, |j| edges[k] - edges[j]);
            let right = edges.get(k + 1).map_or(f64::INFINITY, |b| b - edges[k]);
            if self.hard[k] || left.min(right) < 0.49 * width {
                out.push(edges[k]);
            }
        }
    }

    /// Width of the narrowest cell that holds more than 1e-4 of the mass.
    fn narrowest(&self) -> f64 {
        let heavy =
            |cell: &usize| 2.0 * self.curve.cell(*cell).1 * self.curve.coefficients[*cell][0].abs() > 1e-4;
        let cells = (0..self.curve.coefficients.len()).filter(heavy);
        cells.map(|cell| 2.0 * self.curve.cell(cell).1).fold(f64::INFINITY, f64::min)
    }
}

/// Consecutive cells of one width.
#[derive(Debug, Clone, Copy)]
struct Run {
    first: usize,
    start: f64,
    width: f64,
}

/// The cells of a solution and the runs that they form.
#[derive(Debug, Clone, Default)]
struct Mesh {
    boundaries: Vec<f64>,
    runs: Vec<Run>,
    run_of: Vec<u32>,
}

impl Mesh {
    fn cells(&self) -> usize {
        self.run_of.len()
    }

    /// Middle and half width; in a run, middles are exact multiples of the width apart.
    fn cell(&self, cell: usize) -> (f64, f64) {
        let run = self.runs[self.run_of[cell] as usize];
        (run.start + ((cell - run.first) as f64 + 0.5) * run.width, 0.5 * run.width)
    }
}

/// The blocks of one kernel on one mesh, each computed once per run.
struct Blocks<'a> {
    kernel: &'a Kernel,
    /// By lag within the latest run; `None` where the kernel vanishes.
    cached: Vec<Option<Box<Block>>>,
    run: u32,
}

impl<'a> Blocks<'a> {
    fn new(kernel: &'a Kernel) -> Self {
        Self { kernel, cached: Vec::new(), run: u32::MAX }
    }

    /// Adds ∫ over cells first..cell (and none later) of k(X_i − Y) g(Y) dY to the values at the points of `cell`.
    fn add_history(&mut self, mesh: &Mesh, cell: usize, values: &[Nodal], out: &mut Nodal) {
        let run = mesh.run_of[cell];
        if run != self.run {
            self.run = run;
            self.cached.clear();
        }
        let first = mesh.runs[run as usize].first;
        let start = mesh.boundaries[cell];
        for source in (0..values.len()).rev() {
            if start - mesh.boundaries[source + 1] >= self.kernel.curve.end() {
                break;
            }
            if source >= first {
                let block = self.within_run(mesh, cell - source);
                if let Some(block) = block {
                    apply(block, &values[source], out);
                }
            } else if let Some(block) = block(self.kernel, mesh.cell(cell), mesh.cell(source)) {
                apply(&block, &values[source], out);
            }
        }
    }

    /// The block between cells `lag` apart in the current run.
    fn within_run(&mut self, mesh: &Mesh, lag: usize) -> Option<&Block> {
        let width = mesh.runs[self.run as usize].width;
        while self.cached.len() <= lag {
            let gap = self.cached.len() as f64 * width;
            self.cached.push(block(self.kernel, (gap, 0.5 * width), (0.0, 0.5 * width)));
        }
        self.cached[lag].as_deref()
    }
}

/// out += block · values.
#[inline]
fn apply(block: &Block, values: &Nodal, out: &mut Nodal) {
    for (column, value) in block.iter().zip(values) {
        for (sum, entry) in out.iter_mut().zip(column) {
            *sum += entry * value;
        }
    }
}

/// The block ∫_source ℓ_j(Y) k(X_i − Y) dY for the Gauss points X_i of the cell `target`; `None` where it vanishes.
fn block(kernel: &Kernel, target: (f64, f64), source: (f64, f64)) -> Option<Box<Block>> {
    let gap = target.0 - source.0;
    let mut out = Box::new([[0.0; NODES]; NODES]);
    let mut largest = 0.0_f64;
    let mut cuts = Vec::new();
    for i in 0..NODES {
        let offset = gap + target.1 * RULE.nodes[i];
        let (low, high) = ((offset - source.1).max(0.0), offset + source.1);
        if high <= 0.0 || low >= kernel.curve.end() {
            continue;
        }
        cuts.clear();
        cuts.push(low);
        kernel.splits(low, high, 2.0 * source.1, &mut cuts);
        cuts.push(high);
        let plain = cuts.len() == 2 && offset >= source.1;
        let mut row = [0.0; NODES];
        if plain {
            for j in 0..NODES {
                row[j] = source.1 * RULE.weights[j] * kernel.curve.value(offset - source.1 * RULE.nodes[j]);
            }
        } else {
            split_row(kernel, offset, source.1, &cuts, &mut row);
        }
        for j in 0..NODES {
            out[j][i] = row[j];
            largest = largest.max(row[j].abs());
        }
    }
    // A thousand such blocks would add 1e-15 of the solution.
    (largest > 1e-20).then_some(out)
}

/// One row of a block whose integrand is smooth only between `cuts` in u.
fn split_row(kernel: &Kernel, offset: f64, half: f64, cuts: &[f64], row: &mut Nodal) {
    for pair in cuts.windows(2) {
        let (middle, part) = (0.5 * (pair[0] + pair[1]), 0.5 * (pair[1] - pair[0]));
        let Some(cell) = kernel.curve.find(middle) else { continue };
        let end = kernel.curve.end();
        for q in 0..NODES {
            let u = middle + part * RULE.nodes[q];
            let value = match kernel.curve.boundaries[cell + 1] {
                top if u < top => kernel.curve.value_in(cell, u),
                _ if u < end => kernel.curve.value(u),
                _ => 0.0,
            };
            let weight = part * RULE.weights[q] * value;
            let cardinals = RULE.cardinals((offset - u) / half);
            for (sum, cardinal) in row.iter_mut().zip(&cardinals) {
                *sum += weight * cardinal;
            }
        }
    }
}

/// The solution g of g = source + kernel ∗ g on [0, end].
#[derive(Debug, Clone)]
pub struct Solution {
    mesh: Mesh,
    /// Gauss values of the density, cell by cell.
    values: Vec<Nodal>,
    /// The density.
    pub density: Piecewise,
    /// The point masses, by rising position.
    pub atoms: Vec<Atom>,
    /// The largest tail of a cell (the last Legendre coefficients): an estimate of the error of the density.
    pub tail: f64,
}

/// How fine the density is resolved.
#[derive(Debug, Clone, Copy)]
pub struct Accuracy {
    /// A cell's tail may be this large (per unit of g) …
    pub density: f64,
    /// … or this large times the cell's width.
    pub mass: f64,
    /// Width of cells to begin with, in units of the narrowest cell of source and kernel that matters.
    pub widening: f64,
    /// Whether cells may outgrow the kernel's own.
    pub may_grow: bool,
}

/// The march through the cells.
struct March<'a> {
    source: &'a Kernel,
    kernel: &'a Kernel,
    accuracy: Accuracy,
    kernel_atoms: Vec<Atom>,
    atoms: Vec<Atom>,
    mesh: Mesh,
    values: Vec<Nodal>,
    density: Piecewise,
    blocks: Blocks<'a>,
    /// Inverse of identity − kernel on the cell itself, for the run it was made for.
    inverse: Option<(u32, Box<Block>)>,
    tail: f64,
}

/// Solves g = source + kernel ∗ g on [0, end].
///
/// # Errors
/// [`Error::Stopped`] by the monitor; [`Error::TooLarge`] for too many atoms; [`Error::Accuracy`] where cells would
/// shrink beyond reason.
pub fn solve(
    source: &Kernel,
    kernel: &Kernel,
    end: f64,
    accuracy: Accuracy,
    monitor: &mut dyn Monitor,
) -> Result<Solution> {
    let width = (accuracy.widening * source.narrowest().min(kernel.narrowest())).min(end);
    let spacing = width / (2 * NODES) as f64;
    let matters = |b: &Break| b.weight(spacing) > 10.0 * accuracy.density;
    let breaks = renewed(&source.breaks, &kernel.breaks, end, matters)?;
    let atoms =
        breaks.iter().filter(|b| b.is_atom()).map(|b| Atom { position: b.position, weight: b.amplitude });
    let mut march = March {
        source,
        kernel,
        accuracy,
        kernel_atoms: kernel.atoms().collect(),
        atoms: atoms.collect(),
        mesh: Mesh { boundaries: vec![0.0], ..Mesh::default() },
        values: Vec::new(),
        density: Piecewise { boundaries: vec![0.0], coefficients: Vec::new() },
        blocks: Blocks::new(kernel),
        inverse: None,
        tail: 0.0,
    };
    let mut stops: Vec<f64> = breaks.iter().map(|b| b.position).filter(|&x| x > 0.0 && x < end).collect();
    stops.push(end);
    stops.dedup_by(|b, a| same_position(*a, *b));
    let mut pace = Pace { base: width, width };
    for stop in stops {
        march.section(stop, end, &mut pace, monitor)?;
    }
    let March { mesh, values, density, atoms, tail, .. } = march;
    Ok(Solution { mesh, values, density, atoms, tail })
}

/// The width of cells: the base width, and the one in use.
struct Pace {
    base: f64,
    width: f64,
}

impl March<'_> {
    /// Cells from where the march stands to `stop`, halved and grown as needed.
    fn section(&mut self, stop: f64, end: f64, pace: &mut Pace, monitor: &mut dyn Monitor) -> Result<()> {
        let mut patience = 0_usize;
        loop {
            let here = self.density.end();
            let count = ((stop - here) / pace.width - 1e-9).ceil().max(1.0);
            let width = (stop - here) / count;
            self.start_run(here, width);
            let mut change = false;
            let mut done = 0;
            while done < count as usize && !change {
                let missing = self.cell(if done + 1 == count as usize {
                    stop
                } else {
                    here + (done + 1) as f64 * width
                });
                if let Some(missing) = missing {
                    done += 1;
                    patience = patience.saturating_sub(1);
                    change =
                        done < count as usize && self.grows(missing, done, patience, end - here, width, pace);
                    if change {
                        pace.width = 2.0 * width;
                    }
                } else {
                    if width < 1e-40 * end {
                        return Err(self.unresolved());
                    }
                    pace.width = 0.5 * width;
                    patience = 6;
                    change = true;
                }
                if self.values.len().is_multiple_of(64) {
                    report(monitor, self.density.end() / end)?;
                }
            }
            if !change {
                return Ok(());
            }
        }
    }

    /// Whether the next cell should be twice as wide: soon where a kink made cells small, late otherwise, since every
    /// change of width costs new blocks.
    fn grows(&self, missing: f64, done: usize, patience: usize, left: f64, width: f64, pace: &Pace) -> bool {
        let limit = self.accuracy.density;
        let recovering = width < 0.3 * pace.base
            && patience == 0
            && missing < 0.05 * limit.max(self.accuracy.mass / width);
        let settled =
            self.accuracy.may_grow && done >= 256 && missing < 1e-5 * limit && left > 2048.0 * width;
        recovering || settled
    }

    fn unresolved(&self) -> Error {
        Error::Accuracy {
            what: format!("the breaking rate at X = {}", self.density.end()),
            reached: Float(self.tail),
            wanted: Float(self.accuracy.density),
        }
    }

    fn start_run(&mut self, start: f64, width: f64) {
        if let Some(run) = self.mesh.runs.last() {
            let there = run.start + (self.values.len() - run.first) as f64 * run.width;
            if (run.width - width).abs() <= 1e-11 * width && (there - start).abs() <= 1e-11 * width {
                return;
            }
        }
        if self.mesh.runs.last().is_some_and(|run| run.first == self.values.len()) {
            self.mesh.runs.pop();
        }
        self.mesh.runs.push(Run { first: self.values.len(), start, width });
        self.inverse = None;
        self.blocks.run = u32::MAX;
    }

    /// Solves the next cell of the run, up to `stop`; the size of its tail, or `None` where it is not resolved.
    fn cell(&mut self, stop: f64) -> Option<f64> {
        let cell = self.values.len();
        self.mesh.run_of.push(self.mesh.runs.len() as u32 - 1);
        self.mesh.boundaries.push(stop);
        let (middle, half) = self.mesh.cell(cell);
        let mut known = self.known(middle, half);
        self.blocks.add_history(&self.mesh, cell, &self.values, &mut known);
        let mut values = [0.0; NODES];
        apply(self.inverse(half), &known, &mut values);
        let coefficients = RULE.coefficients(&values);
        let missing = tail(&coefficients);
        if missing > self.accuracy.density && missing * half > self.accuracy.mass || missing.is_nan() {
            self.mesh.run_of.pop();
            self.mesh.boundaries.pop();
            return None;
        }
        if missing * half > self.accuracy.mass * 1e-3 {
            self.tail = self.tail.max(missing);
        }
        self.values.push(values);
        self.density.boundaries.push(stop);
        self.density.coefficients.push(coefficients);
        Some(missing)
    }

    /// Source and atoms at the Gauss points of a cell.
    fn known(&self, middle: f64, half: f64) -> Nodal {
        RULE.nodes.map(|t| {
            let x = middle + half * t;
            let shifted: f64 =
                self.kernel_atoms.iter().map(|a| a.weight * self.density.value(x - a.position)).sum();
            self.source.curve.value(x) + struck(&self.kernel.curve, &self.atoms, x) + shifted
        })
    }

    /// (identity − kernel on the cell itself)⁻¹.
    fn inverse(&mut self, half: f64) -> &Block {
        let run = self.mesh.runs.len() as u32;
        if self.inverse.as_ref().is_none_or(|(made_for, _)| *made_for != run) {
            let mut matrix =
                block(self.kernel, (0.0, half), (0.0, half)).map_or([[0.0; NODES]; NODES], |b| *b);
            for atom in &self.kernel_atoms {
                for i in 0..NODES {
                    let t = RULE.nodes[i] - atom.position / half;
                    if t >= -1.0 {
                        let cardinals = RULE.cardinals(t);
                        (0..NODES).for_each(|j| matrix[j][i] += atom.weight * cardinals[j]);
                    }
                }
            }
            for (j, column) in matrix.iter_mut().enumerate() {
                column.iter_mut().for_each(|entry| *entry = -*entry);
                column[j] += 1.0;
            }
            self.inverse = Some((run, Box::new(inverted(matrix))));
        }
        match &self.inverse {
            Some((_, inverse)) => inverse,
            None => unreachable!("made above"),
        }
    }
}

/// Σ over atoms at or before x of weight × curve(x − position).
pub fn struck(curve: &Piecewise, atoms: &[Atom], x: f64) -> f64 {
    let end = curve.end();
    let last = atoms.partition_point(|a| a.position <= x);
    let within = atoms[..last].iter().rev().take_while(|a| x - a.position <= end);
    within.map(|a| a.weight * curve.value(x - a.position)).sum()
}

/// Inverse of a small matrix by Gauss–Jordan elimination with row pivoting (the matrices are near the identity).
fn inverted(mut a: Block) -> Block {
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

impl Solution {
    /// source + kernel ∗ g on the mesh of g, atoms of g included; the kernel must have none of its own.
    ///
    /// # Errors
    /// [`Error::Stopped`] by the monitor.
    pub fn convolve(
        &self,
        source: &Piecewise,
        kernel: &Kernel,
        monitor: &mut dyn Monitor,
    ) -> Result<Piecewise> {
        let mut blocks = Blocks::new(kernel);
        let mut coefficients = Vec::with_capacity(self.values.len());
        for cell in 0..self.values.len() {
            let (middle, half) = self.mesh.cell(cell);
            let mut values = RULE.nodes.map(|t| {
                let x = middle + half * t;
                source.value(x) + struck(&kernel.curve, &self.atoms, x)
            });
            blocks.add_history(&self.mesh, cell, &self.values[..=cell], &mut values);
            coefficients.push(RULE.coefficients(&values));
            if cell % 1024 == 1023 {
                report(monitor, (cell + 1) as f64 / self.mesh.cells() as f64)?;
            }
        }
        Ok(Piecewise { boundaries: self.mesh.boundaries.clone(), coefficients })
    }

    /// (source + kernel ∗ g)(x) at one x by quadrature over the density, not by blocks.
    pub fn convolve_at(&self, source: &Piecewise, kernel: &Kernel, x: f64) -> f64 {
        let low = x - kernel.curve.end();
        let first = self.mesh.boundaries.partition_point(|&b| b <= low).saturating_sub(1);
        let cells = (first..self.values.len()).take_while(|&cell| self.mesh.boundaries[cell] < x);
        let integral: f64 = cells.map(|cell| self.convolve_cell(cell, kernel, x)).sum();
        source.value(x) + struck(&kernel.curve, &self.atoms, x) + integral
    }

    fn convolve_cell(&self, cell: usize, kernel: &Kernel, x: f64) -> f64 {
        let (middle, half) = self.mesh.cell(cell);
        let (low, high) = ((x - middle - half).max(0.0), x - middle + half);
        let mut cuts = vec![low];
        kernel.splits(low, high, 2.0 * half, &mut cuts);
        cuts.push(high);
        let integrand = |u: f64| self.density.value_in(cell, x - u) * kernel.curve.value(u);
        cuts.windows(2).map(|pair| RULE.integrate(pair[0], pair[1], integrand)).sum()
    }
}
