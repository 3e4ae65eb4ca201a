//! Volterra equations of the second kind of convolution type, g = source + kernel ∗ g, to high order.
//!
//! g is a sum of atoms and of a density that is a polynomial on each cell of a mesh, collocated at the Gauss points
//! (H. Brunner, *Collocation Methods for Volterra Integral and Related Functional Differential Equations*, 2004).
//! Cell boundaries lie on every break of g that matters, so jumps cost no accuracy; cells are halved where the
//! polynomial is not resolved and grow again where it is. In a run of equal cells the history is a block
//! Toeplitz product whose blocks are computed once; between runs blocks are kept, too, for cells that lie alike.

mod block;
mod kernel;
mod march;
mod mesh;

pub use kernel::Kernel;
pub use march::solve;

use self::block::Blocks;
use self::mesh::Mesh;
use super::breakpoints::{Atom, Breakpoint};
use super::legendre::{Nodal, RULE};
use super::piecewise::Piecewise;
use crate::Result;
use crate::monitor::{Monitor, report};

/// The solution g of g = source + kernel ∗ g on [0, end].
#[derive(Debug, Clone)]
pub struct Solution {
    /// To what the density was to be resolved.
    resolved: f64,
    mesh: Mesh,
    /// Gauss values of the density, cell by cell.
    values: Vec<Nodal>,
    /// The density.
    pub density: Piecewise,
    /// The point masses, by rising position.
    pub atoms: Vec<Atom>,
    /// The breaks of the density that matter, by rising position.
    pub breakpoints: Vec<Breakpoint>,
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
    /// How far source + kernel ∗ g may be from 1 where it should be 1.
    pub kept: f64,
    /// Error that a break inside a cell may cause in the convolution of another kernel with g.
    pub carried: f64,
    /// Width of cells to begin with, in units of the narrow cells of source and kernel …
    pub widening: f64,
    /// … which together hold this fraction of their mass; a tenth, where they narrow towards a steep break.
    pub light: f64,
}

/// Σ over atoms at or before x of weight × curve(x − position), x = start + offset: the distance to an atom at the start
/// keeps its digits.
pub fn struck(curve: &Piecewise, atoms: &[Atom], (start, offset): (f64, f64)) -> f64 {
    let end = curve.end();
    let last = atoms.partition_point(|a| a.position <= start + offset);
    let distances = atoms[..last].iter().rev().map(|a| (a.weight, (start - a.position) + offset));
    distances.take_while(|(_, u)| *u <= end).map(|(weight, u)| weight * curve.value(u)).sum()
}

impl Solution {
    /// source + kernel ∗ g on the mesh of g, atoms of g included; the kernel must have none of its own.
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
                source.value(start + offset) + struck(kernel.curve(), &self.atoms, (start, offset))
            });
            blocks.add_history(&self.mesh, cell, &self.values[..=cell], &self.density, &mut values);
            coefficients.push(RULE.coefficients(&values));
            if cell % 16 == 15 {
                report(monitor, (cell + 1) as f64 / self.mesh.cells() as f64)?;
            }
        }
        Ok(Piecewise { boundaries: self.mesh.boundaries.clone(), coefficients })
    }

    /// (source + kernel ∗ g)(x) at one x by quadrature over the density, not by blocks.
    pub fn convolve_at(&self, source: &Piecewise, kernel: &Kernel, x: f64) -> f64 {
        source.value(x)
            + struck(kernel.curve(), &self.atoms, (x, 0.0))
            + self.mesh.convolve_at(&self.density, kernel, x)
    }
}
