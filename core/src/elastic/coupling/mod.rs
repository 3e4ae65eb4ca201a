//! Elastic coupling between the cells of an interface: from displacements to forces.

use super::solve::solve;
use crate::shape::{Edges, Shape};

/// Linear elasticity of the slider between its cells: displacements X_i make the forces −Σ_i A_ji X_i.
///
/// The stiffness matrix A is symmetric and an *M-matrix*: A_ji ≤ 0 for i ≠ j, Σ_i A_ji ≥ 0. A cell that advances pushes
/// every other one forward, so cells never pass a state of equilibrium that lies ahead of all of them (A. A. Middleton,
/// Phys. Rev. Lett. 68, 670 (1992), doi:10.1103/PhysRevLett.68.670).
///
/// Slices hold one value per cell, along rows.
pub trait Coupling: Send + Sync {
    /// How the cells lie.
    fn shape(&self) -> Shape;

    /// What is beyond the outermost.
    fn edges(&self) -> Edges;

    /// Forces = −A X, of all cells.
    fn forces(&mut self, displacements: &[f64], forces: &mut [f64]);

    /// What changes as one cell moves by `displacement`: forces −= A e_cell · displacement.
    fn add(&self, cell: usize, displacement: f64, forces: &mut [f64]);

    /// Solves (diagonal + A) δ = right for the response δ of cells that are held by springs `diagonal` > 0 too.
    fn solve(&mut self, diagonal: f64, right: &mut [f64]);

    /// Solves (springs + A) δ = right where springs differ from cell to cell, and may push; whether the matrix is positive
    /// definite. If not, `right` is of no use.
    fn respond(&mut self, springs: &[f64], right: &mut [f64]) -> bool {
        solve(self, springs, right)
    }

    /// A_jj, the stiffness that a cell feels when it moves alone.
    fn own(&self, cell: usize) -> f64;
}
