//! The equation of motion without the coupling of cells.

use super::{Arrest, SlidingCell};

/// Coefficients of the equation of motion. The stiffness of the spring, the mass and the viscosity are those of a cell of area
/// 1, and proportional to the area.
#[derive(Debug, Clone, Copy)]
pub struct EquationOfMotion {
    /// Stiffness K_0 of the spring from a cell to the drive.
    pub connection: f64,
    /// Number of cells that have such a spring, from the first one.
    pub connected: usize,
    /// Mass M of a cell, 0 or above.
    pub mass: f64,
    /// Viscosity η, a force on a cell per velocity, 0 or above.
    pub viscosity: f64,
    /// Background force B on a cell, against its motion; at rest what the balance of forces asks for, from −B to B. X_T is
    /// counted from where the spring carries B, so that B is not in the equation of a cell that slides forward.
    pub background: f64,
    /// Rule for a cell whose contacts would pull it back.
    pub arrest: Arrest,
}

/// The motion of the drive in a step.
#[derive(Debug, Clone, Copy)]
pub struct DriveMotion {
    /// X_T at the start of the step.
    pub position: f64,
    /// Velocity of the drive.
    pub velocity: f64,
}

impl DriveMotion {
    /// X_T after a time.
    pub fn after(self, time: f64) -> f64 {
        self.position + self.velocity * time
    }
}

impl EquationOfMotion {
    /// Whether the forces are in balance at every time, without mass and drag.
    pub fn is_quasistatic(&self) -> bool {
        self.mass == 0.0 && self.viscosity == 0.0
    }

    /// Stiffness K_0j = a_j K_0 of the spring of cell j; 0 if it has none.
    pub fn connection(&self, j: usize, cell: &SlidingCell) -> f64 {
        if j < self.connected { cell.area * self.connection } else { 0.0 }
    }

    /// Mass a_j M of a cell.
    pub fn mass(&self, cell: &SlidingCell) -> f64 {
        cell.area * self.mass
    }

    /// Viscosity of a cell, a_j η, and of its free contacts.
    pub fn viscosity(&self, cell: &SlidingCell) -> f64 {
        cell.area * self.viscosity + cell.known.free.viscosity
    }

    /// Acceleration Ẍ of cell j, on which the others act with the force `coupling`; 0 without mass, and of a cell at rest that
    /// would go back but stands.
    pub fn acceleration(&self, j: usize, cell: &SlidingCell, drive: f64, coupling: f64) -> f64 {
        if self.mass == 0.0 {
            return 0.0;
        }
        let pull = self.pull(j, cell, drive, coupling);
        let free = (pull - cell.force - self.viscosity(cell) * cell.velocity) / self.mass(cell);
        if self.stands(cell) { free.max(0.0) } else { free }
    }

    /// Friction force on cell j: the force of its contacts, or, where it stands although they would pull it back, what balances its
    /// spring and the force `coupling` of the others.
    pub fn friction(&self, j: usize, cell: &SlidingCell, drive: f64, coupling: f64) -> f64 {
        if self.stands(cell) { cell.force.min(self.pull(j, cell, drive, coupling)) } else { cell.force }
    }

    /// Force of the spring of cell j and of the other cells.
    fn pull(&self, j: usize, cell: &SlidingCell, drive: f64, coupling: f64) -> f64 {
        self.connection(j, cell) * (drive - cell.position) + coupling
    }

    /// Whether a cell is at rest, and stays there if its contacts would pull it back.
    fn stands(&self, cell: &SlidingCell) -> bool {
        self.arrest == Arrest::Stand && cell.velocity == 0.0 && !cell.known.may_turn
    }

    /// The highest velocity √(Ẋ² + MẌ²/K) that a cell reaches as it swings about where forces balance, with the stiffness K of its
    /// spring and its contacts; less where it is held by others, too. Without a mass the velocity.
    pub fn speed(&self, j: usize, cell: &SlidingCell, acceleration: f64) -> f64 {
        let resistance = self.resistance(j, cell, 0.0);
        if self.mass == 0.0 || resistance <= 0.0 {
            return cell.velocity;
        }
        let swing = self.mass(cell) / resistance * acceleration * acceleration;
        (cell.velocity * cell.velocity + swing).sqrt()
    }

    /// Kinetic energy ½MẊ² of a cell.
    pub fn kinetic(&self, cell: &SlidingCell) -> f64 {
        0.5 * self.mass(cell) * cell.velocity * cell.velocity
    }
}
