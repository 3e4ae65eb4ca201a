//! Volterra equations of the second kind of convolution type, g = source + kernel ∗ g, by piecewise
//! collocation.
//!
//! g is a sum of point masses and a density that is a polynomial of degree 15 on each cell of a mesh,
//! collocated at the Gauss points (H. Brunner, *Collocation Methods for Volterra Integral and Related
//! Functional Differential Equations*, 2004). Cell boundaries lie on every breakpoint of g that matters, so
//! that jumps cost no accuracy. Cells are halved where the polynomial does not resolve g, and doubled where
//! it does. In a run of equal cells the history is a block Toeplitz product whose blocks are computed once;
//! between runs, blocks are cached for pairs of cells with the same relative position.

mod block;
mod kernel;
mod leading;
mod march;
mod mesh;
mod response;

pub use kernel::Kernel;
pub use march::solve;

use self::block::Blocks;
use self::leading::Leading;
use self::mesh::Mesh;
use super::breakpoints::{Atom, Breakpoint};
use super::legendre::{Nodal, RULE};
use super::piecewise::Piecewise;
use crate::Result;
use crate::monitor::Monitor;

/// The solution g of g = source + kernel ∗ g on [0, end].
#[derive(Debug, Clone)]
pub struct Solution {
    /// The tolerance of the density.
    resolved: f64,
    mesh: Mesh,
    /// Gauss values of the density, cell by cell.
    values: Vec<Nodal>,
    /// The density.
    pub density: Piecewise,
    /// Its leading cells, merged.
    leading: Leading,
    /// The point masses, by rising position.
    pub atoms: Vec<Atom>,
    /// The breakpoints of the density that matter, by rising position.
    pub breakpoints: Vec<Breakpoint>,
}

/// Tolerances of a solution.
#[derive(Debug, Clone, Copy)]
pub struct Accuracy {
    /// A cell is resolved if its truncation error is at most this …
    pub density: f64,
    /// … or at most this divided by the width of the cell.
    pub mass: f64,
    /// Tolerance on the conservation law source + kernel ∗ g = 1 (conservation of probability).
    pub conservation: f64,
    /// Error allowed in the convolution of another kernel with g because of a breakpoint inside a cell.
    pub convolved: f64,
    /// Initial width of cells, in units of the width of the narrow cells of source and kernel.
    pub initial_width: f64,
    /// Narrow cells are those that together hold this fraction of the mass; a tenth where they narrow towards
    /// a steep breakpoint.
    pub narrow_fraction: f64,
}

/// Σ over point masses at or before x of weight × curve(x − position), for x = start + offset: given
/// separately, so that the distance to a point mass at `start` keeps its digits.
pub fn convolve_atoms(curve: &Piecewise, atoms: &[Atom], (start, offset): (f64, f64)) -> f64 {
    let end = curve.end();
    let last = atoms.partition_point(|a| a.position <= start + offset);
    let distances = atoms[..last].iter().rev().map(|a| (a.weight, (start - a.position) + offset));
    distances.take_while(|(_, u)| *u <= end).map(|(weight, u)| weight * curve.value(u)).sum()
}

impl Solution {
    /// source + kernel ∗ g on the mesh of g, point masses of g included. The kernel must have none.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] by the monitor.
    pub fn convolve(
        &self,
        source: &Piecewise,
        kernel: &Kernel,
        monitor: &mut dyn Monitor,
    ) -> Result<Piecewise> {
        let mut blocks = Blocks::new(kernel, self.resolved);
        let mut coefficients = Vec::with_capacity(self.values.len());
        for cell in 0..self.values.len() {
            let mut values = self.mesh.points(cell).map(|(start, offset)| {
                source.value(start + offset) + convolve_atoms(kernel.curve(), &self.atoms, (start, offset))
            });
            blocks.add_history(&self.mesh, cell, &self.values[..=cell], &self.density, &mut values);
            coefficients.push(RULE.coefficients(&values));
            self.report(cell, monitor)?;
        }
        Ok(Piecewise { boundaries: self.mesh.boundaries.clone(), coefficients })
    }

    /// (source + kernel ∗ g)(x) by quadrature over the density instead of blocks: an independent check.
    pub fn convolve_at(&self, source: &Piecewise, kernel: &Kernel, x: f64) -> f64 {
        source.value(x)
            + convolve_atoms(kernel.curve(), &self.atoms, (x, 0.0))
            + self.mesh.convolve_at((&self.density, &self.leading), kernel, x)
    }
}
