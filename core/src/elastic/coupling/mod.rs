//! Elastic coupling between the cells of an interface: from displacements to forces.

mod half_space;
mod neighbours;

pub use half_space::HalfSpace;
pub use neighbours::Neighbours;

use super::batch;
use super::solve::solve;
use crate::numerics::product::product;
use crate::shape::{Edges, Shape};
use crate::{Error, Result};

/// What a solution leaves of the largest force, about what roundings do.
const ROUNDED: f64 = 1e-14;

/// Bytes that a coupling may take.
const BYTES: u64 = 16 << 30;

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

    /// About (diagonal + A)⁻¹ right, at the cost of little more than [`Coupling::forces`], by a symmetric positive definite
    /// matrix; whether it is that inverse.
    fn precondition(&mut self, diagonal: f64, right: &mut [f64]) -> bool;

    /// Solves (diagonal + A) δ = right for the response δ of cells that are held by equal springs `diagonal` > 0 too, to
    /// 1e-14 of the largest force where nothing better is known than iterations; how many of [`Coupling::precondition`] that took.
    fn solve_uniform(&mut self, diagonal: f64, right: &mut [f64]) -> usize {
        iterate(self, diagonal, right)
    }

    /// Solves (springs + A) δ = right where springs differ from cell to cell, and may push, until no force larger than
    /// `goal` is left; how many of [`Coupling::precondition`] that took, a hundred where it was given up. None if the matrix is not
    /// positive definite: `right` is of no use then.
    fn solve_variable(&mut self, springs: &[f64], right: &mut [f64], goal: f64) -> Option<usize> {
        solve(self, springs, right, goal)
    }

    /// A_jj, the stiffness that a cell feels when it moves alone.
    fn self_stiffness(&self, cell: usize) -> f64;

    /// ½ X·A X, stored in the coupling, where `forces` are those at `displacements`.
    fn energy(&self, displacements: &[f64], forces: &[f64]) -> f64 {
        let Some(first) = displacements.first() else { return 0.0 };
        // Forces add to 0 but for rounding, which is not to count with how far all have come.
        let mut relative = vec![0.0; displacements.len()];
        batch::fill(&mut relative, |cell| displacements[cell] - first);
        -0.5 * product(&relative, forces)
    }
}

/// [`Coupling::solve_uniform`] where nothing better is known.
fn iterate<C: Coupling + ?Sized>(coupling: &mut C, diagonal: f64, right: &mut [f64]) -> usize {
    let largest = right.iter().fold(0.0_f64, |most, force| most.max(force.abs()));
    coupling.solve_variable(&vec![diagonal; right.len()], right, ROUNDED * largest).unwrap_or_default()
}

/// Springs of stiffness K_int between nearest neighbours.
///
/// # Errors
/// What [`Neighbours::new`] refuses.
pub fn neighbours(shape: Shape, edges: Edges, stiffness: f64) -> Result<Box<dyn Coupling>> {
    Ok(Box::new(Neighbours::new(shape, edges, stiffness)?))
}

/// A half-space of effective shear modulus G* under square cells of side `cell`: G* is the shear modulus G for Poisson's ratio
/// ν = 0, and G/(1 − ν) on a chain along the direction of sliding. On a lattice with ν > 0 waves along that direction are stiffer
/// than waves across it by 1/(1 − ν), which no G* says.
///
/// # Errors
/// What [`HalfSpace::new`] refuses.
pub fn half_space(shape: Shape, edges: Edges, modulus: f64, cell: f64) -> Result<Box<dyn Coupling>> {
    Ok(Box::new(HalfSpace::new(shape, edges, modulus, cell)?))
}

fn positive(key: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(Error::invalid(key, "a finite number above 0", value))
}

/// Refuses what takes more memory than is allowed.
fn fits(shape: Shape, bytes_per_cell: u64) -> Result<()> {
    let needed = bytes_per_cell.saturating_mul(shape.size() as u64);
    if needed > BYTES {
        let what = format!("the coupling of {} cells", shape.size());
        return Err(Error::TooLarge { key: "cells".into(), what, needed, allowed: BYTES });
    }
    Ok(())
}
