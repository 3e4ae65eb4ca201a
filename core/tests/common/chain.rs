//! A chain of cells with free ends, coupled to nearest neighbours: elasticity of a few lines, for tests.
#![allow(dead_code)]

use asperity::elastic::Coupling;
use asperity::shape::{Edges, Shape};

#[derive(Clone, Copy)]
pub struct Chain {
    pub cells: usize,
    pub stiffness: f64,
}

impl Chain {
    fn links(&self, cell: usize) -> f64 {
        let links = usize::from(cell > 0) + usize::from(cell + 1 < self.cells);
        self.stiffness * links as f64
    }
}

impl Coupling for Chain {
    fn shape(&self) -> Shape {
        Shape::Chain(self.cells)
    }

    fn edges(&self) -> Edges {
        Edges::Open
    }

    fn forces(&mut self, x: &[f64], forces: &mut [f64]) {
        for j in 0..self.cells {
            let left = if j > 0 { x[j - 1] - x[j] } else { 0.0 };
            let right = if j + 1 < self.cells { x[j + 1] - x[j] } else { 0.0 };
            forces[j] = self.stiffness * (left + right);
        }
    }

    fn add(&self, cell: usize, displacement: f64, forces: &mut [f64]) {
        forces[cell] -= self.own(cell) * displacement;
        for next in [cell.wrapping_sub(1), cell + 1] {
            if let Some(force) = forces.get_mut(next) {
                *force += self.stiffness * displacement;
            }
        }
    }

    fn solve(&mut self, diagonal: f64, right: &mut [f64]) {
        self.respond(&vec![diagonal; self.cells], right);
    }

    /// By elimination.
    fn respond(&mut self, springs: &[f64], right: &mut [f64]) -> bool {
        let mut pivots: Vec<f64> = Vec::new();
        for j in 0..self.cells {
            let own = springs[j] + self.links(j);
            let pivot = match pivots.last() {
                None => own,
                Some(last) => {
                    right[j] += self.stiffness / last * right[j - 1];
                    own - self.stiffness * self.stiffness / last
                }
            };
            if pivot <= 0.0 {
                return false;
            }
            pivots.push(pivot);
        }
        for j in (0..self.cells).rev() {
            let next = right.get(j + 1).copied().unwrap_or(0.0);
            right[j] = (right[j] + self.stiffness * next) / pivots[j];
        }
        true
    }

    fn own(&self, cell: usize) -> f64 {
        self.links(cell)
    }
}
