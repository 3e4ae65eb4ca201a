//! Springs between contacts on a lattice, and to the drive.

use crate::shape::{Edges, Shape};
use crate::{Error, Result};

/// Springs between contacts and from each contact to the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticeCoupling {
    /// How contacts lie.
    pub shape: Shape,
    /// What is beyond the outermost contacts; open edges are rigid, and absorb the outward share of a break.
    pub edges: Edges,
    /// K_int, stiffness of the spring between two neighbours.
    pub neighbours: f64,
    /// K_0, stiffness of the spring to the drive.
    pub connection: f64,
}

impl LatticeCoupling {
    /// Springs for which each neighbour gains the fraction α of the force that a breaking contact releases:
    /// K_int = α, K_0 = 1 − zα.
    pub fn with_alpha(shape: Shape, edges: Edges, alpha: f64) -> Self {
        Self { shape, edges, neighbours: alpha, connection: 1.0 - shape.neighbours() as f64 * alpha }
    }

    /// α = K_int/(z K_int + K_0): the fraction of the force released by a breaking contact that each
    /// neighbour gains.
    pub fn alpha(&self) -> f64 {
        self.neighbours / self.stiffness()
    }

    /// κ = zα: the fraction that all neighbours of an inner contact gain together.
    pub fn mean_field_coupling(&self) -> f64 {
        self.shape.neighbours() as f64 * self.alpha()
    }

    /// 1 − zα = K_0/(z K_int + K_0): the fraction that the drive absorbs.
    pub fn dissipated(&self) -> f64 {
        self.connection / self.stiffness()
    }

    /// Total stiffness of the springs of a contact.
    fn stiffness(&self) -> f64 {
        self.shape.neighbours() as f64 * self.neighbours + self.connection
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// No contacts, or fewer than three in a periodic direction; stiffnesses below 0 or not finite, or both 0; no
    /// connection where edges are periodic.
    pub fn check(&self) -> Result<()> {
        self.shape.check(self.edges)?;
        for (key, value) in [("neighbours", self.neighbours), ("connection", self.connection)] {
            if !(value.is_finite() && value >= 0.0) {
                return Err(Error::invalid(key, "a finite number, 0 or above", value));
            }
        }
        if self.stiffness() == 0.0 {
            return Err(Error::invalid("connection", "above 0 where neighbours are not coupled", 0.0));
        }
        if self.connection == 0.0 && self.edges == Edges::Periodic {
            let expected =
                "above 0 where edges are periodic: nothing else takes force away, and avalanches never end";
            return Err(Error::invalid("connection", expected, 0.0));
        }
        Ok(())
    }
}
