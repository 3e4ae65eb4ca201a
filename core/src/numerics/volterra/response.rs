//! Further functions on the mesh of a solution: convolutions of them, and the solution for another source.

use super::Solution;
use super::block::{Blocks, ConvolutionBlock, apply, block, inverted};
use super::kernel::Kernel;
use crate::Result;
use crate::monitor::{Monitor, report};
use crate::numerics::breakpoints::Atom;
use crate::numerics::legendre::{NODES, Nodal, RULE};
use crate::numerics::piecewise::Piecewise;

impl Solution {
    /// kernel ∗ `function`, point masses of the kernel included, for a function on the mesh of this solution.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] by the monitor.
    pub fn convolve_function(
        &self,
        function: &Piecewise,
        kernel: &Kernel,
        monitor: &mut dyn Monitor,
    ) -> Result<Piecewise> {
        let (mut blocks, atoms) = (Blocks::new(kernel, self.resolved), kernel.atoms().collect::<Vec<_>>());
        let values = self.gauss_values(function);
        let mut out = Piecewise { boundaries: self.mesh.boundaries.clone(), coefficients: Vec::new() };
        for cell in 0..values.len() {
            let mut sums = self.shifted(function, &atoms, cell);
            blocks.add_history(&self.mesh, cell, &values[..=cell], function, &mut sums);
            out.coefficients.push(RULE.coefficients(&sums));
            if cell % 16 == 15 {
                report(monitor, cell as f64 / values.len() as f64)?;
            }
        }
        Ok(out)
    }

    /// The solution b of b = source + kernel ∗ b, for a source on the mesh of this solution and the kernel of its
    /// equation. The mesh, which ends cells at all breakpoints of this solution, is not refined.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] by the monitor.
    pub fn respond(
        &self,
        source: &Piecewise,
        kernel: &Kernel,
        monitor: &mut dyn Monitor,
    ) -> Result<Piecewise> {
        let (mut blocks, atoms) = (Blocks::new(kernel, self.resolved), kernel.atoms().collect::<Vec<_>>());
        let mut density = Piecewise { boundaries: vec![0.0], coefficients: Vec::new() };
        let mut values: Vec<Nodal> = Vec::new();
        let mut inverse: Option<(u32, Box<ConvolutionBlock>)> = None;
        for (cell, values_of_source) in self.gauss_values(source).into_iter().enumerate() {
            let shifted = self.shifted(&density, &atoms, cell);
            let mut known = std::array::from_fn(|i| values_of_source[i] + shifted[i]);
            blocks.add_history(&self.mesh, cell, &values, &density, &mut known);
            let run = self.mesh.run_of[cell];
            let (_, own) = match &mut inverse {
                Some(made) if made.0 == run => made,
                other => other.insert((run, own_inverse(kernel, &atoms, self.mesh.cell(cell).1))),
            };
            let mut found = [0.0; NODES];
            apply(own, &known, &mut found);
            values.push(found);
            density.boundaries.push(self.mesh.boundaries[cell + 1]);
            density.coefficients.push(RULE.coefficients(&found));
            if cell % 16 == 15 {
                report(monitor, cell as f64 / self.values.len() as f64)?;
            }
        }
        Ok(density)
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
