//! How contacts on a lattice hang together, and on the drive.

use crate::shape::{Edges, Shape};
use crate::{Error, Result};

/// Springs between contacts and from each contact to the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LatticeCoupling {
    /// How contacts lie.
    pub shape: Shape,
    /// What is beyond the outermost; open edges are rigid, and take the outward share of a break.
    pub edges: Edges,
    /// K_int, stiffness of the spring between two neighbours.
    pub neighbours: f64,
    /// K_0, stiffness of the spring to the drive.
    pub connection: f64,
}

impl LatticeCoupling {
    /// Springs by which each neighbour gains the share α of what a breaking contact lets go: K_int = α, K_0 = 1 − zα.
    pub fn sharing(shape: Shape, edges: Edges, share: f64) -> Self {
        Self { shape, edges, neighbours: share, connection: 1.0 - shape.neighbours() as f64 * share }
    }

    /// α = K_int/(z K_int + K_0), what each neighbour gains of the force that a breaking contact lets go.
    pub fn share(&self) -> f64 {
        self.neighbours / self.stiffness()
    }

    /// κ = zα = zK_int/(z K_int + K_0), what all neighbours of a contact inside gain together.
    pub fn total_share(&self) -> f64 {
        self.shape.neighbours() as f64 * self.share()
    }

    /// 1 − zα = K_0/(z K_int + K_0), what the drive takes of it.
    pub fn dissipated(&self) -> f64 {
        self.connection / self.stiffness()
    }

    /// All springs of a contact together.
    fn stiffness(&self) -> f64 {
        self.shape.neighbours() as f64 * self.neighbours + self.connection
    }

    /// Checks the numbers; keys are those of the table `[interface]`.
    ///
    /// # Errors
    /// No contacts, or fewer than three in a periodic direction; stiffnesses below 0 or not finite, or both 0; no
    /// connection where edges are periodic.
    pub fn check(&self) -> Result<()> {
        self.shape.check(self.edges)?;
        for (key, value) in
            [("coupling.neighbours.stiffness", self.neighbours), ("connection", self.connection)]
        {
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
