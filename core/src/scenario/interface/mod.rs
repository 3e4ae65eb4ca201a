//! `[interface]`: cells, or single contacts, coupled by the elasticity of a slider that deforms.

mod areas;
mod build;
mod check;
mod main_shocks;
mod scales;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contacts::Contacts;
use crate::elastic::coupling::Elasticity;
use crate::elastic::{CellLoading, CellSlip};
use crate::shape::{Edges, Shape};
use crate::{Error, Result};
pub use build::CellStart;
pub(super) use build::no_steady_ensemble;
pub use main_shocks::MainShocks;
pub use scales::Scales;

/// An interface of cells coupled by elasticity, or of contacts coupled one by one; `[drive]` moves its load point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Interface {
    /// `[length]` of a chain or `[rows, columns]` of a lattice of elastically coupled cells; `contacts.count` is the number
    /// of contacts of each cell, or, for contacts coupled one by one, of all together.
    #[schemars(length(min = 1, max = 2), extend("items" = { "type": "integer", "minimum": 1 }))]
    pub cells: Vec<usize>,
    /// `"many"`: each cell has many contacts, which move together; or `"one"`: contacts are coupled one by one and re-form
    /// after the slip event.
    #[serde(default)]
    pub contacts: PerCell,
    /// Stiffness K_0 of the spring between a cell and the drive, above 0 for cells of many contacts, 0 or above for contacts
    /// coupled one by one.
    #[schemars(extend("minimum" = 0, "x-dimension" = "force/length"))]
    pub connection: f64,
    /// `neighbours = { stiffness }` with K_int, which has the same range as `connection`, or `half_space = { modulus, cell,
    /// poisson_ratio, sliding }` with the shear modulus G, the side a of a cell, Poisson's ratio ν, 0 unless given, and the
    /// direction of sliding: along the `"columns"`, from row to row and along a chain, or along the `"rows"`. With ν = 0, `modulus`
    /// may be an effective one, as G/(1 − ν) along a chain.
    pub coupling: Elasticity,
    /// Edges of the interface: `"open"` or `"periodic"`.
    #[serde(default)]
    pub edges: Edges,
    /// `"uniform"`: the drive pulls every cell; or `"edge"`: it pulls only the first cell of a chain, the first row of a
    /// lattice.
    #[serde(default)]
    pub loading: CellLoading,
    /// Mass M of a cell, above 0: cells then follow their equation of motion in time, at the velocity of the drive, disturbances
    /// travel as waves, and athermal contacts are loaded and unloaded. It takes the place of `slip`, which is then not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force*time^2/length"))]
    pub mass: Option<f64>,
    /// Slip rule of unstable cells: `"reset"` or `"overdamped"`; only the latter with time-dependent contacts; not used for
    /// cells with a mass and for contacts coupled one by one.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "reset"))]
    pub slip: Option<CellSlip>,
    /// Viscous drag on a moving cell, force per velocity, above 0: events then have durations, and fronts have speeds;
    /// required with time-dependent contacts of cells without mass. With the value G a²/c_s it is the radiation damping of a
    /// half-space.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "force*time/length"))]
    pub viscosity: Option<f64>,
    /// How cells of many contacts differ; without this table they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disorder: Option<Scales>,
    /// Area of each cell of many contacts, above 0, row by row of the lattice, in any unit: only ratios to the mean area count. The
    /// numbers of contacts, the stiffness of `connection`, `mass`, `viscosity` and the normal load are those of a cell of mean
    /// area, and proportional to the area; springs between neighbours are not. Without it all cells have the same area. Not for
    /// `coupling.half_space`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0 }, "x-dimension" = "1"))]
    pub areas: Option<Vec<f64>>,
    /// Accuracy of the drive at which equilibrium is lost, in mean thresholds; with time-dependent contacts there is no such
    /// drive.
    #[serde(default = "drive_tolerance")]
    #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "1"))]
    pub drive_tolerance: f64,
    /// Events are recorded from this drive on, 0 or above.
    #[serde(default)]
    #[schemars(extend("minimum" = 0, "x-dimension" = "length"))]
    pub catalogue_from: f64,
    /// Large events around which foreshocks and aftershocks are counted; only of contacts coupled one by one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub main_shocks: Option<MainShocks>,
    /// Largest number of steps in time at which the velocity of every cell is stored, 2 or more, evenly numbered among all steps,
    /// which are short in events; without it none is. Only with time-dependent contacts or a mass.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 2))]
    pub slip_rates: Option<usize>,
}

/// What a cell is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PerCell {
    /// `contacts.count` contacts that move together. They follow the master equation, or `ensemble.size` of them are simulated
    /// one by one.
    #[default]
    Many,
    /// One contact, which re-forms after the slip event.
    One,
}

fn drive_tolerance() -> f64 {
    Interface::DRIVE_TOLERANCE
}

impl Interface {
    /// Default of `drive_tolerance`, in mean thresholds.
    pub const DRIVE_TOLERANCE: f64 = 1e-6;

    /// Number of cells.
    pub fn size(&self) -> usize {
        self.cells.iter().fold(1, |size, &side| size.saturating_mul(side))
    }

    /// Whether cells move in time, by an equation of motion: those with a mass, and those over time-dependent contacts.
    pub fn moves_in_time(&self, contacts: &Contacts) -> bool {
        self.mass.is_some() || contacts.rules.are_time_dependent()
    }

    /// Speed of long waves along a chain or a lattice with springs between neighbours, √(K_int/M), in cells per time; `None`
    /// without mass and on a half-space, whose waves have no common speed.
    pub fn wave_speed(&self) -> Option<f64> {
        match (self.coupling, self.mass) {
            (Elasticity::Neighbours { stiffness }, Some(mass)) => Some((stiffness / mass).sqrt()),
            _ => None,
        }
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
