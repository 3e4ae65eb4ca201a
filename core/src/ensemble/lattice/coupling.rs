//! How contacts on a lattice hang together, and on the drive.

use crate::{Error, Result};

/// How contacts lie; each is coupled to its nearest neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// So many in a row, two neighbours each.
    Chain(usize),
    /// Rows and columns of a square lattice, four neighbours each.
    Square([usize; 2]),
}

/// What is beyond the outermost contacts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Edges {
    /// Something rigid: the outward share of a break is lost.
    #[default]
    Open,
    /// The contacts of the other side.
    Periodic,
}

/// Springs between contacts and from each contact to the drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupling {
    /// How contacts lie.
    pub shape: Shape,
    /// What is beyond the outermost.
    pub edges: Edges,
    /// K_int, stiffness of the spring between two neighbours.
    pub neighbours: f64,
    /// K_0, stiffness of the spring to the drive.
    pub connection: f64,
}

impl Shape {
    /// Rows and columns; a chain is one row.
    pub fn sides(self) -> [usize; 2] {
        match self {
            Self::Chain(length) => [1, length],
            Self::Square(sides) => sides,
        }
    }

    /// Number of contacts.
    pub fn size(self) -> usize {
        let [rows, columns] = self.sides();
        rows.saturating_mul(columns)
    }

    /// z, the number of neighbours of a contact inside.
    pub fn neighbours(self) -> usize {
        match self {
            Self::Chain(_) => 2,
            Self::Square(_) => 4,
        }
    }
}

impl Coupling {
    /// Springs by which each neighbour gains the share α of what a breaking contact lets go: K_int = α, K_0 = 1 − zα.
    pub fn sharing(shape: Shape, edges: Edges, share: f64) -> Self {
        Self { shape, edges, neighbours: share, connection: 1.0 - shape.neighbours() as f64 * share }
    }

    /// α = K_int/(z K_int + K_0), what each neighbour gains of the force that a breaking contact lets go.
    pub fn share(&self) -> f64 {
        self.neighbours / self.stiffness()
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
        self.check_sides()?;
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

    fn check_sides(&self) -> Result<()> {
        let (sides, least) = match (self.shape, self.edges) {
            (Shape::Chain(length), Edges::Periodic) => (vec![length], 3),
            (Shape::Chain(length), Edges::Open) => (vec![length], 1),
            (Shape::Square(sides), Edges::Periodic) => (sides.to_vec(), 3),
            (Shape::Square(sides), Edges::Open) => (sides.to_vec(), 1),
        };
        if sides.iter().any(|&side| side < least) {
            let expected = match self.edges {
                Edges::Open => "at least 1 in each direction",
                Edges::Periodic => "at least 3 in each direction where edges are periodic",
            };
            return Err(Error::invalid("cells", expected, format!("{sides:?}")));
        }
        Ok(())
    }
}
