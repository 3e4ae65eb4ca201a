//! Springs between nearest neighbours.

use super::{Coupling, conjugate_gradients, fits, positive};
use crate::Result;
use crate::elastic::batch;
use crate::monitor::Monitor;
use crate::numerics::line::Line;
use crate::numerics::modes::Modes;
use crate::numerics::springs::Chain;
use crate::parallel;
use crate::shape::{Edges, Shape};

/// Number of cells up to which one thread does all of the work.
const SHARE: usize = 1 << 14;

/// Stiffness between neighbours, relative to the diagonal, above which the exact inverse is worth its transforms.
const STIFF: f64 = 4.0;

/// Equal springs K_int between nearest neighbours: the force on cell j is K_int Σ (X_i − X_j) over its neighbours i.
///
/// Open edges are free: cells there have fewer neighbours. Eigenvalues of A are K_int times those of the lattice
/// Laplacian, 2K_int(1 − cos q) for a wave along one direction. Forces take some additions per cell, a cell that moved
/// acts on its neighbours alone. Linear systems are solved by elimination on a chain, on a lattice by cosine transforms (open
/// edges) or Fourier transforms. Takes 8 bytes per cell of a lattice and of a chain, 16 of a periodic one.
#[derive(Debug)]
pub struct Neighbours {
    shape: Shape,
    edges: Edges,
    stiffness: f64,
    solver: Solver,
}

#[derive(Debug)]
enum Solver {
    Chain(Chain),
    Square(Modes),
}

impl Neighbours {
    /// Springs of stiffness K_int between the cells of `shape`.
    ///
    /// # Errors
    /// No cells, or fewer than three in a periodic direction; stiffness not above 0; more cells than fit in 1 TiB.
    pub fn new(shape: Shape, edges: Edges, stiffness: f64) -> Result<Self> {
        shape.check(edges)?;
        positive("stiffness", stiffness)?;
        fits(shape, 16)?;
        let line = match edges {
            Edges::Open => Line::free,
            Edges::Periodic => Line::periodic,
        };
        let solver = match shape {
            Shape::Chain(_) => Solver::Chain(Chain::new(edges, stiffness)),
            Shape::Square(sides) => Solver::Square(Modes::new(sides, sides.map(line))),
        };
        Ok(Self { shape, edges, stiffness, solver })
    }

    /// Number of neighbours of a cell.
    fn around(&self, cell: usize) -> usize {
        let [rows, columns] = self.shape.sides();
        let (row, column) = (cell / columns, cell % columns);
        beside(row, rows, self.edges).count() + beside(column, columns, self.edges).count()
    }
}

/// Neighbours of a place on a line of `length` places.
fn beside(place: usize, length: usize, edges: Edges) -> impl Iterator<Item = usize> {
    let (before, after) = match edges {
        _ if length == 1 => (None, None),
        Edges::Open => (place.checked_sub(1), Some(place + 1).filter(|&next| next < length)),
        Edges::Periodic => (Some((place + length - 1) % length), Some((place + 1) % length)),
    };
    before.into_iter().chain(after)
}

impl Coupling for Neighbours {
    fn shape(&self) -> Shape {
        self.shape
    }

    fn edges(&self) -> Edges {
        self.edges
    }

    fn forces(
        &mut self,
        displacements: &[f64],
        forces: &mut [f64],
        _monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let [rows, columns] = self.shape.sides();
        let (edges, stiffness) = (self.edges, self.stiffness);
        let row_of = |row: usize| &displacements[row * columns..(row + 1) * columns];
        let sweep = |row: usize, forces: &mut [f64]| {
            let own = row_of(row);
            along(own, edges, forces);
            beside(row, rows, edges).for_each(|other| pull(row_of(other), own, forces));
            forces.iter_mut().for_each(|force| *force *= stiffness);
        };
        if forces.len() <= SHARE || parallel::current_num_threads() == 1 {
            forces.chunks_mut(columns).enumerate().for_each(|(row, forces)| sweep(row, forces));
        } else {
            let least = SHARE.div_ceil(columns);
            parallel::map_with(forces.chunks_mut(columns).collect(), least, &|| (), &|(), row, forces| {
                sweep(row, forces)
            });
        }
        Ok(())
    }

    /// The exact inverse, or, where neighbours are not much stiffer than the diagonal, that of a diagonal matrix.
    fn precondition(&mut self, diagonal: f64, right: &mut [f64], monitor: &mut dyn Monitor) -> Result<bool> {
        // A diagonal preconditioner has a condition number of about 1 + 8K_int/d on a lattice:
        // below the limit a few cheap iterations beat two transforms.
        let stiff = self.stiffness > STIFF * diagonal;
        if stiff {
            self.solve_uniform(diagonal, right, monitor)?;
        } else {
            let spring = diagonal + self.stiffness * self.shape.neighbours() as f64;
            batch::change(right, |_, force| force / spring);
        }
        Ok(stiff)
    }

    fn solve_uniform(
        &mut self,
        diagonal: f64,
        right: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<usize> {
        let stiffness = self.stiffness;
        match &mut self.solver {
            Solver::Chain(chain) => {
                chain.solve(|_| diagonal, right);
            }
            Solver::Square(modes) => {
                let inverse = |down: f64, along: f64| (diagonal + stiffness * (along + down)).recip();
                modes.apply(right, inverse, monitor)?;
            }
        }
        Ok(1)
    }

    fn solve_variable(
        &mut self,
        diagonal: &[f64],
        right: &mut [f64],
        goal: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<usize>> {
        match &mut self.solver {
            Solver::Chain(chain) => Ok(chain.solve(|j| diagonal[j], right).then_some(1)),
            Solver::Square(_) => conjugate_gradients::solve_variable(self, diagonal, right, goal, monitor),
        }
    }

    fn self_stiffness(&self, cell: usize) -> f64 {
        self.stiffness * self.around(cell) as f64
    }
}

/// Σ (X_i − X_j) over the neighbours in a row.
fn along(row: &[f64], edges: Edges, sums: &mut [f64]) {
    let last = row.len() - 1;
    if last == 0 {
        sums[0] = 0.0;
        return;
    }
    let (before, after) = match edges {
        Edges::Open => (row[0], row[last]),
        Edges::Periodic => (row[last], row[0]),
    };
    // Sums of differences: a rigid translation makes exactly no force.
    sums[0] = (before - row[0]) + (row[1] - row[0]);
    sums[last] = (row[last - 1] - row[last]) + (after - row[last]);
    for (sum, window) in sums[1..].iter_mut().zip(row.windows(3)) {
        *sum = (window[0] - window[1]) + (window[2] - window[1]);
    }
}

/// Adds the differences to an adjacent row.
fn pull(other: &[f64], own: &[f64], sums: &mut [f64]) {
    for ((sum, other), own) in sums.iter_mut().zip(other).zip(own) {
        *sum += other - own;
    }
}
