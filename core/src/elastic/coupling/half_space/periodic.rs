//! A half-space with periodic edges.

use super::from_first;
use crate::numerics::line::Line;
use crate::numerics::modes::Modes;
use crate::shape::Shape;

/// A = scale √Δ on a torus.
#[derive(Debug)]
pub(super) struct Periodic {
    scale: f64,
    modes: Modes,
    self_stiffness: f64,
}

impl Periodic {
    pub(super) fn new(shape: Shape, scale: f64) -> Self {
        let lines = super::sides(shape).map(Line::periodic);
        let self_stiffness = scale * mean_root(&lines);
        Self { scale, modes: Modes::new(super::sides(shape), lines), self_stiffness }
    }

    pub(super) fn forces(&mut self, displacements: &[f64], forces: &mut [f64]) {
        let scale = self.scale;
        from_first(displacements, forces);
        self.modes.apply(forces, |λ| -scale * λ.sqrt());
    }

    pub(super) fn solve(&mut self, diagonal: f64, right: &mut [f64]) {
        let scale = self.scale;
        self.modes.apply(right, |λ| (diagonal + scale * λ.sqrt()).recip());
    }

    pub(super) fn self_stiffness(&self) -> f64 {
        self.self_stiffness
    }
}

/// √λ, averaged over the modes of a lattice of such lines: what multiplies a cell by itself.
fn mean_root(lines: &[Line; 2]) -> f64 {
    let [down, along] = lines.each_ref().map(|line| (0..line.length()).map(|mode| line.eigenvalue(mode)));
    let row = |other: f64| along.clone().map(|λ| (λ + other).sqrt()).sum::<f64>();
    down.map(row).sum::<f64>() / (lines[0].length() * lines[1].length()) as f64
}
