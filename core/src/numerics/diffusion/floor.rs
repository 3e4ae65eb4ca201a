//! A floor that absorbs: where it cuts a cell, and what it takes as it rises.

use super::{Diffusion, bernoulli};

/// Less than this fraction of a cell above the floor counts as none.
const SLIVER: f64 = 1e-9;

/// The lowest cell above a floor, and the rates that the floor changes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cut {
    /// The lowest cell that holds mass before; what is below the cell that is cut is absorbed.
    pub(super) from: usize,
    /// The cell that is cut; as many as there are cells, if nothing is above the floor.
    pub(super) cell: usize,
    /// Rate at which its mass goes to the next cell up.
    pub(super) up: f64,
    /// Rate at which the mass of that one comes down.
    pub(super) down: f64,
    /// Rate at which its mass diffuses into the floor.
    pub(super) loss: f64,
    /// What the floor has passed of it, over what is left.
    pub(super) passed: f64,
}

impl Cut {
    /// No floor.
    pub(super) fn none(operator: &Diffusion) -> Self {
        let down = operator.down.get(1).copied().unwrap_or(0.0);
        Self { from: 0, cell: 0, up: operator.up[0], down, loss: 0.0, passed: 0.0 }
    }

    /// The cut that a floor makes that comes `from` below; `travel(e)` is how far it has risen above e.
    ///
    /// The density is 0 at the floor, the flux through it that of Scharfetter and Gummel over half of what is left of the
    /// cell, s: 2D/s² per mass without a slope. Towards the next cell the distance is (s + Δ)/2.
    pub(super) fn at(operator: &Diffusion, floor: f64, from: usize, travel: impl Fn(f64) -> f64) -> Self {
        if floor < operator.low {
            return Self::none(operator);
        }
        let (cell, width) = place(operator, floor);
        if cell == operator.cells() {
            return Self { from, cell, up: 0.0, down: 0.0, loss: 0.0, passed: 0.0 };
        }
        let (slope, half) = (operator.slope(cell), 0.5 * width);
        let loss = operator.diffusion / (half * width) * bernoulli(-slope * half);
        let passed = travel(operator.edge(cell)) / width;
        if cell + 1 == operator.cells() {
            return Self { from, cell, up: 0.0, down: 0.0, loss, passed };
        }
        let distance = half + 0.5 * operator.width;
        let (rate, rise) = (operator.diffusion / distance, slope * distance);
        let (up, down) = (rate * bernoulli(rise) / width, rate * bernoulli(-rise) / operator.width);
        Self { from, cell, up, down, loss, passed }
    }
}

/// The lowest cell above a floor, and what is left of its width.
pub(super) fn place(operator: &Diffusion, floor: f64) -> (usize, f64) {
    let cells = ((floor - operator.low) / operator.width).max(0.0);
    let cell = (cells + SLIVER).floor().min(operator.cells() as f64);
    (cell as usize, (cell + 1.0 - cells).clamp(SLIVER, 1.0) * operator.width)
}
