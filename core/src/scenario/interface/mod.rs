//! `[interface]`: cells, or single contacts, that move differently since the slider between them deforms.

mod build;
mod check;
mod scales;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::shape::{Edges, Shape};
use crate::{Error, Result};
pub use scales::Scales;

/// An interface of cells coupled by elasticity, or of contacts coupled one by one; `[drive]` moves its top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Interface {
    /// Length of a chain, such as `[1000]`, or rows and columns of a lattice, such as `[512, 512]`.
    pub cells: Vec<usize>,
    /// Whether a cell has many contacts, or is one.
    #[serde(default)]
    pub contacts: PerCell,
    /// Stiffness K_0 of the spring between a cell and the drive, 0 or above.
    pub connection: f64,
    /// What couples cells to each other.
    pub coupling: Coupling,
    /// What is beyond the outermost cells.
    #[serde(default)]
    pub edges: Edges,
    /// Which cells the drive pulls.
    #[serde(default)]
    pub loading: Loading,
    /// What happens to cells that have lost their balance, where they have many contacts; `reset` by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "reset"))]
    pub slip: Option<CellSlip>,
    /// Viscous drag of a moving cell, force per velocity, above 0: events then take time, and fronts have speeds. Needed
    /// where contacts are time-dependent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscosity: Option<f64>,
    /// How cells of many contacts differ; without this table they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disorder: Option<Scales>,
    /// How closely the drive at which balance is lost is found, in mean thresholds, where contacts know no time.
    #[serde(default = "drive_tolerance")]
    pub drive_tolerance: f64,
    /// Drive from which on events are recorded, 0 or above.
    #[serde(default)]
    pub catalogue_from: f64,
}

/// What a cell is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PerCell {
    /// Contacts that move together, `contacts.count` of them: so many that they follow the master equation, or
    /// `ensemble.size` that are followed one by one.
    #[default]
    Many,
    /// One contact, which re-forms when the slide is over.
    One,
}

/// What couples cells.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Coupling {
    /// Springs between nearest neighbours.
    Neighbours {
        /// K_int, stiffness of such a spring, 0 or above.
        stiffness: f64,
    },
    /// An elastic half-space.
    HalfSpace {
        /// G*, its modulus, force per area, above 0.
        modulus: f64,
        /// Side a of a cell, above 0.
        cell: f64,
    },
}

/// Which cells the drive pulls.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Loading {
    /// All of them.
    #[default]
    Uniform,
    /// The first of a chain, the first row of a lattice.
    Edge,
}

/// What happens to cells that have lost their balance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CellSlip {
    /// All contacts of an unstable cell break and re-form.
    #[default]
    Reset,
    /// Cells move to the next balance, contacts breaking and re-forming on the way.
    Overdamped,
}

fn drive_tolerance() -> f64 {
    Interface::DRIVE_TOLERANCE
}

impl Interface {
    /// The accuracy of drives, in mean thresholds, where nothing is said.
    pub const DRIVE_TOLERANCE: f64 = 1e-6;

    /// Number of cells.
    pub fn size(&self) -> usize {
        self.cells.iter().fold(1, |size, &side| size.saturating_mul(side))
    }

    fn shape(&self) -> Result<Shape> {
        match self.cells[..] {
            [length] if length > 0 => Ok(Shape::Chain(length)),
            [rows, columns] if rows > 0 && columns > 0 => Ok(Shape::Square([rows, columns])),
            _ => {
                let expected = "[length] of a chain or [rows, columns] of a lattice, each 1 or more";
                Err(Error::invalid("cells", expected, format!("{:?}", self.cells)))
            }
        }
    }
}
