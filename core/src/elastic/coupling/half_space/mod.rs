//! A half-space: every cell acts on every other.

mod open;
mod periodic;
mod solid;

pub use self::solid::{SlidingDirection, Solid};

use self::open::OpenEdges;
use self::periodic::Periodic;
use self::solid::WaveStiffness;
use super::{Coupling, conjugate_gradients, fits, positive};
use crate::Result;
use crate::monitor::Monitor;
use crate::shape::{Edges, Shape};

/// The elasticity of a half-space of shear modulus G and Poisson's ratio ν, whose surface moves along one direction, x, under square
/// cells of side a: the stress on it is −G [q_x²/(1 − ν) + q_y²] X̂(q)/|q|, which makes the force on a cell when multiplied by its
/// area a². For ν = 0 this is −G|q| X̂.
///
/// On a lattice q² is taken as 4 sin²(qa/2)/a², the lattice Laplacian, in each direction, so that A = G a [Δ_x/(1 − ν) + Δ_y]/√Δ,
/// Δ = Δ_x + Δ_y: the same for waves longer than cells, and an M-matrix ([`Solid::POISSON_RATIOS`]). |q| itself up to the edge
/// of the Brillouin zone is not an M-matrix: on a lattice a cell that advances would pull back those at even distances along
/// its row and its column; on a chain it would not act on them. At a distance r ≫ a the force on a cell is
/// G a⁴ [1 − ν/(1 − ν) (1 − 3x²/r²)]/(2πr³) per unit displacement, as between points, with corrections (a/r)²; at m cells along a
/// chain in the direction of sliding it is G a/(π(1 − ν)(m² − ¼)).
///
/// Periodic edges: forces and solutions are one convolution. Open edges: cells act on each other as in an infinite
/// plane, and the surface beyond them is free to follow, so that a rigid translation costs no energy; forces are one
/// convolution with zeros beyond the edges. Solutions are iterated by conjugate gradients, with the cosine modes of free
/// edges as preconditioner, to 1e-14 in some fifteen iterations.
///
/// Takes 8 bytes per cell of a periodic lattice and 56 of an open one, up to 200 of a chain, for its one long transform.
#[derive(Debug)]
pub struct HalfSpace {
    shape: Shape,
    kind: Method,
}

#[derive(Debug)]
enum Method {
    Periodic(Box<Periodic>),
    OpenEdges(Box<OpenEdges>),
}

impl HalfSpace {
    /// Cells of side `cell` under a half-space of this solid.
    ///
    /// # Errors
    /// No cells, or fewer than three in a periodic direction; those of [`Solid::check`]; a side not above 0; more cells than fit in
    /// 1 TiB.
    pub fn new(shape: Shape, edges: Edges, solid: impl Into<Solid>, cell: f64) -> Result<Self> {
        Self::new_with(shape, edges, solid, cell, &mut ())
    }

    /// The same with a monitor: many cells under open edges take long.
    ///
    /// # Errors
    /// As [`HalfSpace::new`]; stopped by the monitor.
    pub fn new_with(
        shape: Shape,
        edges: Edges,
        solid: impl Into<Solid>,
        cell: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let solid = solid.into();
        shape.check(edges)?;
        solid.check()?;
        positive("cell", cell)?;
        positive("modulus", solid.modulus * cell)?;
        let stiffness = solid.stiffness(cell);
        // More while it is made than afterwards.
        let bytes = match (shape, edges) {
            (Shape::Chain(_), _) => 200,
            (Shape::Square(_), Edges::Periodic) => 8,
            (Shape::Square(_), Edges::Open) => 80,
        };
        fits(shape, bytes)?;
        let kind = match edges {
            Edges::Periodic => Method::Periodic(Box::new(Periodic::new(shape, stiffness))),
            Edges::Open => Method::OpenEdges(Box::new(OpenEdges::new(shape, stiffness, monitor)?)),
        };
        Ok(Self { shape, kind })
    }
}

/// Sides for transforms: a chain is one column.
fn sides(shape: Shape) -> [usize; 2] {
    match shape {
        Shape::Chain(length) => [length, 1],
        Shape::Square(sides) => sides,
    }
}

/// Displacements relative to that of the first cell, so that a rigid translation costs no digits.
fn from_first(displacements: &[f64], out: &mut [f64]) {
    out.iter_mut().zip(displacements).for_each(|(out, x)| *out = x - displacements[0]);
}

impl Coupling for HalfSpace {
    fn shape(&self) -> Shape {
        self.shape
    }

    fn edges(&self) -> Edges {
        match self.kind {
            Method::Periodic(_) => Edges::Periodic,
            Method::OpenEdges(_) => Edges::Open,
        }
    }

    fn forces(&mut self, displacements: &[f64], forces: &mut [f64], monitor: &mut dyn Monitor) -> Result<()> {
        match &mut self.kind {
            Method::Periodic(periodic) => periodic.forces(displacements, forces, monitor),
            Method::OpenEdges(open) => open.forces(displacements, forces, monitor),
        }
    }

    /// The exact inverse where edges are periodic, otherwise that of free edges.
    fn precondition(&mut self, diagonal: f64, right: &mut [f64], monitor: &mut dyn Monitor) -> Result<bool> {
        match &mut self.kind {
            Method::Periodic(periodic) => periodic.solve(diagonal, right, monitor)?,
            Method::OpenEdges(open) => open.precondition(diagonal, right, monitor)?,
        }
        Ok(matches!(self.kind, Method::Periodic(_)))
    }

    fn solve_uniform(
        &mut self,
        diagonal: f64,
        right: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<usize> {
        if let Method::Periodic(periodic) = &mut self.kind {
            periodic.solve(diagonal, right, monitor)?;
            return Ok(1);
        }
        conjugate_gradients::solve_uniform(self, diagonal, right, monitor)
    }

    fn self_stiffness(&self, cell: usize) -> f64 {
        match &self.kind {
            Method::Periodic(periodic) => periodic.self_stiffness(),
            Method::OpenEdges(open) => open.self_stiffness(cell),
        }
    }
}
