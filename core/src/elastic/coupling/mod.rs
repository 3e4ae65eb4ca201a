//! Elastic coupling between the cells of an interface: from displacements to forces, and back.

mod conjugate_gradients;
mod half_space;
mod neighbours;

pub use conjugate_gradients::MOST_ITERATIONS;
pub use half_space::{HalfSpace, SlidingDirection, Solid};
pub use neighbours::Neighbours;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::batch;
use crate::error::positive;
use crate::monitor::Monitor;
use crate::numerics::product::product;
use crate::shape::{Edges, Shape};
use crate::{Error, Result};

/// Bytes that a coupling may take: 1 TiB. Who drives an interface compares with the free memory.
const BYTES: u64 = 1 << 40;

/// Linear elasticity of the slider between its cells: displacements X_i make the forces −Σ_i A_ji X_i.
///
/// The stiffness matrix A is symmetric and an *M-matrix*: A_ji ≤ 0 for i ≠ j, Σ_i A_ji ≥ 0. A cell that advances pushes
/// every other one forward, so that cells never pass a balance that lies ahead of all of them (A. A. Middleton, Phys. Rev.
/// Lett. 68, 670 (1992), doi:10.1103/PhysRevLett.68.670).
///
/// Slices hold one value per cell, row by row: displacements are lengths, A has the unit of a stiffness.
///
/// What takes long for many cells asks its monitor in between. Where that stops it, what was to be written is of no use.
pub trait Coupling: std::fmt::Debug + Send + Sync {
    /// Arrangement of the cells.
    fn shape(&self) -> Shape;

    /// What is beyond the outermost cells.
    fn edges(&self) -> Edges;

    /// Forces = −A X, of all cells.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn forces(&mut self, displacements: &[f64], forces: &mut [f64], monitor: &mut dyn Monitor) -> Result<()>;

    /// Preconditioner: replaces r in `right` by P⁻¹ r, with a symmetric positive definite matrix P near d + A for the
    /// `diagonal` d > 0. Costs little more than [`Coupling::forces`]. Returns whether P = d + A.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn precondition(&mut self, diagonal: f64, right: &mut [f64], monitor: &mut dyn Monitor) -> Result<bool>;

    /// Solves (d + A) δ = r with the same `diagonal` d > 0 for all cells; `right` is r on entry and δ on return. Iterative
    /// solutions have a residual of 1e-14 of the largest force. Returns the number of applications of the preconditioner.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn solve_uniform(
        &mut self,
        diagonal: f64,
        right: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<usize> {
        conjugate_gradients::solve_uniform(self, diagonal, right, monitor)
    }

    /// Solves (d + A) δ = r with a diagonal d_j that varies from cell to cell and may be negative, until no residual force is
    /// larger than `goal`; `right` is r on entry and δ on return. Returns the number of applications of the preconditioner,
    /// [`MOST_ITERATIONS`] where the solution was given up; none if the matrix is not positive definite.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn solve_variable(
        &mut self,
        diagonal: &[f64],
        right: &mut [f64],
        goal: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<usize>> {
        conjugate_gradients::solve_variable(self, diagonal, right, goal, monitor)
    }

    /// A_jj, the stiffness of the slider against the displacement of one cell alone.
    fn self_stiffness(&self, cell: usize) -> f64;

    /// Elastic energy ½ X·A X of the slider, from displacements and the `forces` that they make.
    fn energy(&self, displacements: &[f64], forces: &[f64]) -> f64 {
        let Some(first) = displacements.first() else { return 0.0 };
        // Forces add up to 0 but for rounding errors, which must not be multiplied by the mean displacement.
        let mut relative = vec![0.0; displacements.len()];
        batch::fill(&mut relative, |cell| displacements[cell] - first);
        -0.5 * product(&relative, forces)
    }
}

/// What couples the cells of an interface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "Coupling")]
#[non_exhaustive]
pub enum Elasticity {
    /// Springs between nearest neighbours.
    Neighbours {
        /// K_int, stiffness of such a spring, 0 or above.
        #[schemars(extend("minimum" = 0, "x-dimension" = "force/length"))]
        stiffness: f64,
    },
    /// An elastic half-space.
    HalfSpace {
        /// G*, its shear modulus, force per area, above 0.
        #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force/length^2"))]
        modulus: f64,
        /// Side a of a cell, above 0.
        #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length"))]
        cell: f64,
        /// ν, its Poisson's ratio, from −0.9 to 0.48; 0 where `modulus` is an effective one.
        #[serde(default)]
        #[schemars(extend("minimum" = -0.9, "maximum" = 0.48, "x-dimension" = "1"))]
        poisson_ratio: f64,
        /// The direction of sliding, along which a solid with ν > 0 is stiffer.
        #[serde(default)]
        sliding: SlidingDirection,
    },
}

impl Elasticity {
    /// The coupling of cells of this shape.
    ///
    /// # Errors
    /// What [`Neighbours::new`] and [`HalfSpace::new_with`] refuse.
    pub fn build(self, shape: Shape, edges: Edges, monitor: &mut dyn Monitor) -> Result<Box<dyn Coupling>> {
        match self {
            Self::Neighbours { stiffness } => neighbours(shape, edges, stiffness),
            Self::HalfSpace { modulus, cell, poisson_ratio, sliding } => {
                let solid = Solid::new(modulus, poisson_ratio, sliding);
                Ok(Box::new(HalfSpace::new_with(shape, edges, solid, cell, monitor)?))
            }
        }
    }

    /// Area of a cell; `None` where cells have no size.
    pub fn area(self) -> Option<f64> {
        match self {
            Self::Neighbours { .. } => None,
            Self::HalfSpace { cell, .. } => Some(cell * cell),
        }
    }
}

/// Springs of stiffness K_int between nearest neighbours.
///
/// # Errors
/// What [`Neighbours::new`] refuses.
pub fn neighbours(shape: Shape, edges: Edges, stiffness: f64) -> Result<Box<dyn Coupling>> {
    Ok(Box::new(Neighbours::new(shape, edges, stiffness)?))
}

/// A half-space of this solid under square cells of side `cell`. A number is its shear modulus for Poisson's ratio ν = 0, or an
/// effective one.
///
/// # Errors
/// What [`HalfSpace::new`] refuses.
pub fn half_space(
    shape: Shape,
    edges: Edges,
    solid: impl Into<Solid>,
    cell: f64,
) -> Result<Box<dyn Coupling>> {
    Ok(Box::new(HalfSpace::new(shape, edges, solid, cell)?))
}

/// Refuses a coupling that takes more memory than is allowed.
fn fits(shape: Shape, bytes_per_cell: u64) -> Result<()> {
    let needed = bytes_per_cell.saturating_mul(shape.size() as u64);
    if needed > BYTES {
        let what = format!("the coupling of {} cells", shape.size());
        return Err(Error::TooLarge { key: "cells".into(), what, needed, allowed: BYTES });
    }
    Ok(())
}
