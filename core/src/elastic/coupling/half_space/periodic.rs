//! A half-space with periodic edges.

use super::{WaveStiffness, from_first};
use crate::Result;
use crate::monitor::Monitor;
use crate::numerics::line::Line;
use crate::numerics::modes::Modes;
use crate::shape::Shape;

/// A on a torus.
#[derive(Debug)]
pub(super) struct Periodic {
    stiffness: WaveStiffness,
    modes: Modes,
    self_stiffness: f64,
}

impl Periodic {
    pub(super) fn new(shape: Shape, stiffness: WaveStiffness) -> Self {
        let lines = super::sides(shape).map(Line::periodic);
        let self_stiffness = mean(stiffness, &lines);
        Self { stiffness, modes: Modes::new(super::sides(shape), lines), self_stiffness }
    }

    pub(super) fn forces(
        &mut self,
        displacements: &[f64],
        forces: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let stiffness = self.stiffness;
        from_first(displacements, forces);
        self.modes.apply(forces, |down, along| -stiffness.against(down, along), monitor)
    }

    pub(super) fn solve(
        &mut self,
        diagonal: f64,
        right: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<()> {
        let stiffness = self.stiffness;
        let inverse = |down: f64, along: f64| (diagonal + stiffness.against(down, along)).recip();
        self.modes.apply(right, inverse, monitor)
    }

    pub(super) fn self_stiffness(&self) -> f64 {
        self.self_stiffness
    }
}

/// The mean over the modes of a lattice of such lines: what multiplies a cell by itself.
fn mean(stiffness: WaveStiffness, lines: &[Line; 2]) -> f64 {
    let [down, along] = lines.each_ref().map(|line| (0..line.length()).map(|mode| line.eigenvalue(mode)));
    let row = |down: f64| along.clone().map(|along| stiffness.against(down, along)).sum::<f64>();
    down.map(row).sum::<f64>() / (lines[0].length() * lines[1].length()) as f64
}
