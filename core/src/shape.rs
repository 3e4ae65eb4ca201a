//! Arrangement of cells or contacts, and boundary conditions.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{Error, Result};

/// Arrangement of cells; adjacent ones are nearest neighbours.
///
/// ```
/// use asperity::shape::Shape;
///
/// assert_eq!(Shape::Square([3, 4]).size(), 12);
/// assert_eq!(Shape::Chain(5).neighbours(), 2);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// A chain with this number of cells, each with two neighbours.
    Chain(usize),
    /// Rows and columns of a square lattice, with four neighbours each; numbered along rows.
    Square([usize; 2]),
}

/// Boundary conditions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Edges {
    /// Free: nothing beyond the outermost cells; of contacts coupled one by one, a rigid neighbour.
    #[default]
    Open,
    /// The cells of the opposite side.
    Periodic,
}

impl Shape {
    /// Rows and columns; a chain is one row.
    pub fn sides(self) -> [usize; 2] {
        match self {
            Self::Chain(length) => [1, length],
            Self::Square(sides) => sides,
        }
    }

    /// Number of cells.
    pub fn size(self) -> usize {
        let [rows, columns] = self.sides();
        rows.saturating_mul(columns)
    }

    /// Number of cells in the first row of a lattice, 1 at the beginning of a chain.
    pub fn first_row(self) -> usize {
        match self {
            Self::Chain(length) => length.min(1),
            Self::Square([_, columns]) => columns,
        }
    }

    /// Coordination number z, the number of neighbours of an inner cell.
    pub fn neighbours(self) -> usize {
        match self {
            Self::Chain(_) => 2,
            Self::Square(_) => 4,
        }
    }

    /// Checks that there are cells, and that none is its own neighbour, or twice that of another.
    ///
    /// # Errors
    /// No cells, or fewer than three in a periodic direction; the key is `cells`.
    pub fn check(self, edges: Edges) -> Result<()> {
        let (least, expected) = match edges {
            Edges::Open => (1, "at least 1 in each direction"),
            Edges::Periodic => (3, "at least 3 in each direction where edges are periodic"),
        };
        let sides = match self {
            Self::Chain(length) => vec![length],
            Self::Square(sides) => sides.to_vec(),
        };
        if sides.iter().any(|&side| side < least) {
            return Err(Error::invalid("cells", expected, format!("{sides:?}")));
        }
        Ok(())
    }
}
