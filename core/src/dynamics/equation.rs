//! The equation of motion, but for the coupling of cells.

use super::{Arrest, SlidingCell};

/// Coefficients of the equation of motion.
#[derive(Debug, Clone, Copy)]
pub struct EquationOfMotion {
    /// K_0, stiffness of the spring from a cell to the drive.
    pub connection: f64,
    /// How many cells have one: the first ones.
    pub connected: usize,
    /// M of a cell, or 0.
    pub mass: f64,
    /// η, force on a cell per velocity; above 0 where M is 0.
    pub viscosity: f64,
    /// What becomes of a cell that its contacts would pull back.
    pub arrest: Arrest,
}

/// The drive in a step.
#[derive(Debug, Clone, Copy)]
pub struct DriveMotion {
    /// X_T at the start.
    pub position: f64,
    /// Its velocity.
    pub velocity: f64,
}

impl DriveMotion {
    /// X_T after a time.
    pub fn after(self, time: f64) -> f64 {
        self.position + self.velocity * time
    }
}

impl EquationOfMotion {
    /// K_0j.
    pub fn connection(&self, cell: usize) -> f64 {
        if cell < self.connected { self.connection } else { 0.0 }
    }

    /// Ẍ of a cell that is not coupled to others; 0 without mass.
    pub fn acceleration(&self, cell: &SlidingCell, drive: f64) -> f64 {
        if self.mass == 0.0 {
            return 0.0;
        }
        (self.excess(cell, drive) - self.viscosity * cell.velocity) / self.mass
    }
}
