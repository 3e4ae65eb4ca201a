//! The march of the solution through its cells, from break to break.

use super::block::{Block, Blocks, apply, block, inverted};
use super::kernel::Kernel;
use super::mesh::{Mesh, Run};
use super::{Accuracy, Solution, struck};
use crate::monitor::{Monitor, report};
use crate::numerics::breaks::{Atom, Break, renewed, same_position};
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::piecewise::{Piecewise, tail};
use crate::{Error, Float, Result};

/// The march through the cells.
struct March<'a> {
    source: &'a Kernel,
    kernel: &'a Kernel,
    kept: (&'a Piecewise, &'a Kernel),
    accuracy: Accuracy,
    kept_blocks: Blocks<'a>,
    /// The width that needs no proof.
    base: f64,
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
/// `kept` are a source and a kernel with source + kernel ∗ g = 1 (what has not gone into g yet): cells that outgrow the
/// narrow ones are only taken where this holds, so that nothing is stepped over.
///
/// # Errors
/// [`Error::Stopped`] by the monitor; [`Error::TooLarge`] for too many atoms; [`Error::Accuracy`] where cells would
/// shrink beyond reason.
pub fn solve(
    source: &Kernel,
    kernel: &Kernel,
    kept: (&Piecewise, &Kernel),
    end: f64,
    accuracy: Accuracy,
    monitor: &mut dyn Monitor,
) -> Result<Solution> {
    // Convolution only smooths: what follows a source with a density is no narrower than that.
    let own = source.narrow(accuracy.light);
    let narrow = if source.size() > 1e-3 { own } else { own.min(kernel.narrow(accuracy.light)) };
    let width = (accuracy.widening * narrow).min(end);
    let spacing = width / (2 * NODES) as f64;
    let matters = |b: &Break| b.weight(spacing) > 10.0 * accuracy.density;
    let breaks = renewed(source.breaks(), kernel.breaks(), end, matters, monitor)?;
    let atoms =
        breaks.iter().filter(|b| b.is_atom()).map(|b| Atom { position: b.position, weight: b.amplitude });
    let mut march = March {
        source,
        kernel,
        kept,
        kept_blocks: Blocks::new(kept.1, accuracy.density),
        accuracy,
        base: width,
        kernel_atoms: kernel.atoms().collect(),
        atoms: atoms.collect(),
        mesh: Mesh { boundaries: vec![0.0], ..Mesh::default() },
        values: Vec::new(),
        density: Piecewise { boundaries: vec![0.0], coefficients: Vec::new() },
        blocks: Blocks::new(kernel, accuracy.density),
        inverse: None,
        tail: 0.0,
    };
    let mut stops: Vec<f64> = breaks.iter().map(|b| b.position).filter(|&x| x > 0.0 && x < end).collect();
    stops.push(end);
    stops.dedup_by(|b, a| same_position(*a, *b));
    let mut pace = Pace { width, patience: 0 };
    for stop in stops {
        march.section(stop, end, &mut pace, monitor)?;
    }
    let March { mesh, values, density, atoms, tail, .. } = march;
    let breaks = breaks.into_iter().filter(|b| !b.is_atom()).collect();
    Ok(Solution { resolved: accuracy.density, mesh, values, density, atoms, breaks, tail })
}

/// The width of cells in use, and how many cells to leave it alone.
struct Pace {
    width: f64,
    patience: usize,
}

impl Pace {
    fn halve(&mut self, width: f64) {
        (self.width, self.patience) = (0.5 * width, 6);
    }
}

/// The most cells of a solution: 2 GB.
const MOST_CELLS: usize = 1 << 22;

impl March<'_> {
    /// Cells from where the march stands to `stop`, halved and grown as needed.
    fn section(&mut self, stop: f64, end: f64, pace: &mut Pace, monitor: &mut dyn Monitor) -> Result<()> {
        while self.density.end() < stop {
            self.run(stop, end, pace, monitor)?;
        }
        Ok(())
    }

    /// A run of equal cells towards `stop`, until it is there or another width serves better.
    fn run(&mut self, stop: f64, end: f64, pace: &mut Pace, monitor: &mut dyn Monitor) -> Result<()> {
        let here = self.density.end();
        let count = ((stop - here) / pace.width - 1e-9).ceil().max(1.0);
        let width = (stop - here) / count;
        self.start_run(here, width);
        for done in 1..=count as usize {
            let last = done == count as usize;
            let Some(missing) = self.cell(if last { stop } else { here + done as f64 * width }) else {
                pace.halve(width);
                return if width < 1e-40 * end { Err(self.unresolved()) } else { Ok(()) };
            };
            pace.patience = pace.patience.saturating_sub(1);
            if !last && self.grows(missing, done, end - here, width, pace) {
                pace.width = 2.0 * width;
                return Ok(());
            }
            if !last && done.is_multiple_of(256) && self.is_flat() {
                pace.width = stop - here;
                return Ok(());
            }
            report(monitor, self.density.end() / end)?;
            self.fits(end)?;
        }
        Ok(())
    }

    /// Whether the next cell should be twice as wide: at once where nothing breaks, soon where a kink made cells small,
    /// late otherwise, since every change of width costs new blocks.
    fn grows(&self, missing: f64, done: usize, left: f64, width: f64, pace: &Pace) -> bool {
        let limit = self.accuracy.density;
        let largest = self
            .values
            .last()
            .map_or(0.0, |values| values.iter().fold(0.0, |most: f64, v| most.max(v.abs())));
        let many = left.min(self.kernel.curve().end()) > 512.0 * self.base;
        let quiet = many && largest * width < 1e-3 * self.accuracy.mass;
        let recovering = width < 0.3 * self.base && missing < 0.05 * limit.max(self.accuracy.mass / width);
        let settled = done >= 256 && missing < 1e-5 * limit && left > 3072.0 * width;
        (quiet || recovering) && pace.patience == 0 || settled
    }

    /// Whether the density has not changed for as long as the kernel reaches: it never will again.
    fn is_flat(&self) -> bool {
        let (here, reach) = (self.density.end(), self.kernel.curve().end());
        let back = self.density.boundaries.partition_point(|&b| b < here - reach).saturating_sub(1);
        let cells = &self.density.coefficients[back..];
        let level = cells[0][0];
        let close = 0.1 * self.accuracy.density;
        let flat = |c: &Nodal| (c[0] - level).abs() < close && c[1..].iter().all(|c| c.abs() < close);
        here > self.source.curve().end() + reach && cells.iter().all(flat)
    }

    /// Whether the solution so far, and as much again as its pace asks for, can be kept.
    fn fits(&self, end: f64) -> Result<()> {
        let cells = self.values.len();
        if cells < MOST_CELLS {
            return Ok(());
        }
        let per_cell = 3 * size_of::<Nodal>() as u64;
        Err(Error::TooLarge {
            what: format!(
                "a pull resolved that finely (it has come to {:.3} of {end:.3})",
                self.density.end()
            ),
            needed: (cells as f64 * end / self.density.end()) as u64 * per_cell,
            allowed: MOST_CELLS as u64 * per_cell,
        })
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
        self.blocks.reset(u32::MAX);
        self.kept_blocks.reset(u32::MAX);
    }

    /// Solves the next cell of the run, up to `stop`; the size of its tail, or `None` where it is not resolved.
    fn cell(&mut self, stop: f64) -> Option<f64> {
        let cell = self.values.len();
        if self.source.hides(self.density.end(), stop, self.accuracy.mass) {
            return None;
        }
        self.mesh.run_of.push(self.mesh.runs.len() as u32 - 1);
        self.mesh.boundaries.push(stop);
        let (middle, half) = self.mesh.cell(cell);
        let mut known = self.known(middle, half);
        self.blocks.add_history(&self.mesh, cell, &self.values, &self.density, &mut known);
        let mut values = [0.0; NODES];
        apply(self.inverse(half), &known, &mut values);
        let coefficients = RULE.coefficients(&values);
        let missing = tail(&coefficients);
        let rounding = 4.0 * f64::EPSILON * values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let coarse = missing > self.accuracy.density.max(rounding) && missing * half > self.accuracy.mass;
        if coarse || missing.is_nan() {
            self.mesh.run_of.pop();
            self.mesh.boundaries.pop();
            return None;
        }
        self.tail = self.tail.max(missing.min(missing * half / self.accuracy.mass * self.accuracy.density));
        self.values.push(values);
        self.density.boundaries.push(stop);
        self.density.coefficients.push(coefficients);
        if 2.0 * half > 1.01 * self.base && !self.keeps(middle, half) {
            self.values.pop();
            self.density.boundaries.pop();
            self.density.coefficients.pop();
            self.mesh.run_of.pop();
            self.mesh.boundaries.pop();
            return None;
        }
        Some(if missing < rounding { 0.0 } else { missing })
    }

    /// Whether all that should be in g is there, at the points of the latest cell.
    fn keeps(&mut self, middle: f64, half: f64) -> bool {
        let (source, kernel) = self.kept;
        let mut whole = RULE.nodes.map(|t| {
            let x = middle + half * t;
            source.value(x) + struck(kernel.curve(), &self.atoms, x)
        });
        let cell = self.values.len() - 1;
        self.kept_blocks.add_history(&self.mesh, cell, &self.values, &self.density, &mut whole);
        whole.iter().all(|w| (w - 1.0).abs() <= self.accuracy.kept)
    }

    /// Source and atoms at the Gauss points of a cell.
    fn known(&self, middle: f64, half: f64) -> Nodal {
        RULE.nodes.map(|t| {
            let x = middle + half * t;
            let shifted: f64 =
                self.kernel_atoms.iter().map(|a| a.weight * self.density.value(x - a.position)).sum();
            self.source.curve().value(x) + struck(self.kernel.curve(), &self.atoms, x) + shifted
        })
    }

    /// (identity − kernel on the cell itself)⁻¹.
    fn inverse(&mut self, half: f64) -> &Block {
        let run = self.mesh.runs.len() as u32;
        if self.inverse.as_ref().is_none_or(|(made_for, _)| *made_for != run) {
            let mut matrix =
                block(self.kernel, (0.0, half), (0.0, half)).block.map_or([[0.0; NODES]; NODES], |b| *b);
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
