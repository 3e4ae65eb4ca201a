//! A half-space with periodic edges.

use super::from_first;
use super::sweep::Weights;
use crate::numerics::line::Line;
use crate::numerics::modes::Modes;
use crate::shape::Shape;

/// A = scale √Δ on a torus.
pub(super) struct Periodic {
    sides: [usize; 2],
    scale: f64,
    modes: Modes,
    kernel: Weights,
}

impl Periodic {
    pub(super) fn new(shape: Shape, scale: f64) -> Self {
        let lines = super::sides(shape);
        let mut modes = Modes::new(lines, lines.map(Line::joined));
        let mut response = vec![0.0; shape.size()];
        response[0] = 1.0;
        modes.apply(&mut response, |λ| scale * λ.sqrt());
        let sides = shape.sides();
        let [height, width] = sides.map(|side| side / 2 + 1);
        let values = response.chunks(sides[1]).take(height).flat_map(|row| &row[..width]).copied().collect();
        Self { sides, scale, modes, kernel: Weights { values, columns: width, periodic: true } }
    }

    pub(super) fn forces(&mut self, displacements: &[f64], forces: &mut [f64]) {
        let scale = self.scale;
        from_first(displacements, forces);
        self.modes.apply(forces, |λ| -scale * λ.sqrt());
    }

    pub(super) fn add(&self, cell: usize, displacement: f64, forces: &mut [f64]) {
        self.kernel.add(self.sides, cell, -displacement, forces);
    }

    pub(super) fn solve(&mut self, diagonal: f64, right: &mut [f64]) {
        let scale = self.scale;
        self.modes.apply(right, |λ| (diagonal + scale * λ.sqrt()).recip());
    }

    pub(super) fn own(&self) -> f64 {
        self.kernel.values[0]
    }
}
