//! Further functions on the mesh of a solution: convolutions of them, and the solutions for other sources. Several
//! functions share the blocks of a kernel, which are most of the cost.

use super::block::{Blocks, ConvolutionBlock, FarCell, Past, add_directly, apply, block, inverted};
use super::kernel::Kernel;
use super::{Solution, convolve_atoms};
use crate::Result;
use crate::monitor::{Monitor, report};
use crate::numerics::breakpoints::Atom;
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::piecewise::Piecewise;

impl Solution {
    /// source + kernel ∗ g on the mesh of g for several sources, each with its kernel or none, which has no point masses.
    /// Kernels with the same cells and breakpoints share the values of g between cells of different widths.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] by the monitor.
    pub fn convolve_each(
        &self,
        sources: &[&Piecewise],
        kernels: &[Option<&Kernel>],
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Piecewise>> {
        let present: Vec<&Kernel> = kernels.iter().copied().flatten().collect();
        let alike = present.windows(2).all(|pair| pair[0].has_cells_of(pair[1]));
        let mut blocks: Vec<_> = present.iter().map(|kernel| Blocks::new(kernel, self.resolved)).collect();
        let mut pasts: Vec<Past> = present.iter().map(|_| Past::default()).collect();
        let empty = Piecewise { boundaries: self.mesh.boundaries.clone(), coefficients: Vec::new() };
        let mut out = vec![empty; kernels.len()];
        for cell in 0..self.values.len() {
            self.forget(cell, &mut pasts);
            let mut far: Vec<Vec<FarCell>> = vec![Vec::new(); present.len()];
            let mut sums: Vec<Nodal> = Vec::with_capacity(present.len());
            for (k, kernel) in present.iter().enumerate() {
                let points = self.mesh.points(cell);
                sums.push(points.map(|point| convolve_atoms(kernel.curve(), &self.atoms, point)));
                let history = (&self.values[..=cell], &self.density, &mut pasts[k]);
                blocks[k].add_history_by(&self.mesh, cell, history, &mut sums[k], |_, source, values, _| {
                    far[k].push((source, *values));
                });
            }
            let target = self.mesh.cell(cell);
            if alike && far.windows(2).all(|pair| pair[0] == pair[1]) {
                for source in far.first().into_iter().flatten() {
                    add_directly(&present, target, source, &mut sums);
                }
            } else {
                for (k, cells) in far.iter().enumerate() {
                    cells.iter().for_each(|source| {
                        add_directly(&present[k..=k], target, source, &mut sums[k..=k]);
                    });
                }
            }
            let mut sums = sums.into_iter();
            for ((out, source), kernel) in out.iter_mut().zip(sources).zip(kernels) {
                let convolved = kernel.and_then(|_| sums.next()).unwrap_or([0.0; NODES]);
                let mut values = self.mesh.points(cell).map(|(start, offset)| source.value(start + offset));
                values.iter_mut().zip(convolved).for_each(|(value, convolved)| *value += convolved);
                out.coefficients.push(RULE.coefficients(&values));
            }
            self.report(cell, monitor)?;
        }
        Ok(out)
    }

    /// kernel ∗ function, point masses of the kernel included, for functions on the mesh of this solution.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] by the monitor.
    pub fn convolve_functions(
        &self,
        functions: &[Piecewise],
        kernel: &Kernel,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Piecewise>> {
        let (mut blocks, atoms) = (Blocks::new(kernel, self.resolved), kernel.atoms().collect::<Vec<_>>());
        let values: Vec<_> = functions.iter().map(|function| self.gauss_values(function)).collect();
        let mut pasts: Vec<Past> = functions.iter().map(|_| Past::default()).collect();
        let empty = Piecewise { boundaries: self.mesh.boundaries.clone(), coefficients: Vec::new() };
        let mut out = vec![empty; functions.len()];
        for cell in 0..self.values.len() {
            self.forget(cell, &mut pasts);
            for (k, function) in functions.iter().enumerate() {
                let mut sums = self.shifted(function, &atoms, cell);
                let history = (&values[k][..=cell], function, &mut pasts[k]);
                blocks.add_history_of(&self.mesh, cell, history, &mut sums);
                out[k].coefficients.push(RULE.coefficients(&sums));
            }
            self.report(cell, monitor)?;
        }
        Ok(out)
    }

    /// The solutions b of b = source + kernel ∗ b, for sources on the mesh of this solution and the kernel of its
    /// equation. The mesh, which ends cells at all breakpoints of this solution, is not refined.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] by the monitor.
    pub fn respond(
        &self,
        sources: &[Piecewise],
        kernel: &Kernel,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Piecewise>> {
        let (mut blocks, atoms) = (Blocks::new(kernel, self.resolved), kernel.atoms().collect::<Vec<_>>());
        let mut pasts: Vec<Past> = sources.iter().map(|_| Past::default()).collect();
        let mut values: Vec<Vec<Nodal>> = vec![Vec::new(); sources.len()];
        let empty = Piecewise { boundaries: vec![0.0], coefficients: Vec::new() };
        let mut out = vec![empty; sources.len()];
        let known: Vec<_> = sources.iter().map(|source| self.gauss_values(source)).collect();
        let mut inverse: Option<(u32, Box<ConvolutionBlock>)> = None;
        for cell in 0..self.values.len() {
            self.forget(cell, &mut pasts);
            let run = self.mesh.run_of[cell];
            let (_, own) = match &mut inverse {
                Some(made) if made.0 == run => made,
                other => other.insert((run, own_inverse(kernel, &atoms, self.mesh.cell(cell).1))),
            };
            for k in 0..sources.len() {
                let shifted = self.shifted(&out[k], &atoms, cell);
                let mut sums = std::array::from_fn(|i| known[k][cell][i] + shifted[i]);
                blocks.add_history_of(&self.mesh, cell, (&values[k], &out[k], &mut pasts[k]), &mut sums);
                let mut found = [0.0; NODES];
                apply(own, &sums, &mut found);
                values[k].push(found);
                out[k].boundaries.push(self.mesh.boundaries[cell + 1]);
                out[k].coefficients.push(RULE.coefficients(&found));
            }
            self.report(cell, monitor)?;
        }
        Ok(out)
    }

    /// Drops the resampled functions of the run before, at the first cell of a run.
    fn forget(&self, cell: usize, pasts: &mut [Past]) {
        if self.mesh.runs[self.mesh.run_of[cell] as usize].first == cell {
            pasts.iter_mut().for_each(Past::start_run);
        }
    }

    pub(super) fn report(&self, cell: usize, monitor: &mut dyn Monitor) -> Result<()> {
        if cell % 16 == 15 { report(monitor, (cell + 1) as f64 / self.values.len() as f64) } else { Ok(()) }
    }

    /// A function at the Gauss points of all cells.
    fn gauss_values(&self, function: &Piecewise) -> Vec<Nodal> {
        (0..self.values.len())
            .map(|cell| {
                let (middle, half) = self.mesh.cell(cell);
                function.values_in(cell, &RULE.nodes.map(|t| middle + half * t))
            })
            .collect()
    }

    /// Σ over point masses of weight × function(x − position) at the Gauss points of a cell.
    fn shifted(&self, function: &Piecewise, atoms: &[Atom], cell: usize) -> Nodal {
        self.mesh.points(cell).map(|(start, offset)| {
            atoms.iter().map(|a| a.weight * function.value((start - a.position) + offset)).sum()
        })
    }
}

/// (identity − kernel on a cell itself)⁻¹, point masses that are closer than its width included.
pub(super) fn own_inverse(kernel: &Kernel, atoms: &[Atom], half: f64) -> Box<ConvolutionBlock> {
    let mut matrix = block(kernel, (0.0, half), (0.0, half)).block.map_or([[0.0; NODES]; NODES], |b| *b);
    for atom in atoms {
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
    Box::new(inverted(matrix))
}
