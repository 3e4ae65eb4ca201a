//! How an interface is driven, and by which rule its cells slip.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::cells::CellAreas;
use crate::shape::Shape;
use crate::{Error, Result};

/// Which cells are connected to the drive.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[schemars(rename = "Loading")]
#[non_exhaustive]
pub enum CellLoading {
    /// All cells.
    #[default]
    Uniform,
    /// The first row of a lattice, the first cell of a chain.
    Edge,
}

/// Slip rule: what a cell does that loses its balance, at fixed X_T.
///
/// A cell of area a_j becomes unstable where it moves down a slope F_j' < −a_j ΣK_0i/Σa_i, which the springs of all cells
/// together would not stabilise, having moved farther than the tolerance of the drive; or where contacts break together.
/// With `Reset`, and where contacts broke together, every unstable cell has slipped. Otherwise a cell has slipped if it
/// moved farther than creep may within the tolerance δ of the drive (near a fold about √(δℓ), with the length ℓ on which
/// slopes change), and at least a tenth as far as the cell that moved farthest: the others were pulled along.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum CellSlip {
    /// All contacts of a slipping cell break where it becomes unstable, and re-form where the slide ends. Until then the
    /// cell carries only the force that the re-formed contacts will have.
    #[default]
    Reset,
    /// Cells move to the next balance; contacts break and re-form on the way.
    Overdamped,
}

/// How an interface is driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InterfaceParameters {
    /// K_0, stiffness of the spring from a cell of area 1 to the drive, force per length.
    pub connection: f64,
    /// Which cells have such a spring.
    pub loading: CellLoading,
    /// Slip rule.
    pub slip: CellSlip,
    /// η, viscous force on a cell of area 1 per velocity during slides, above 0. Slides then have a duration, during which
    /// the drive is at rest. Without viscosity slides end in the same states and have no duration.
    pub viscosity: Option<f64>,
    /// Tolerance on the drive at which balance is lost, a length.
    pub drive_tolerance: f64,
    /// Area of a cell of relative area 1; `None` where areas are counted in cells.
    pub area: Option<f64>,
}

impl InterfaceParameters {
    /// Cells that are all connected to the drive, slip by reset and have no viscosity; areas are counted in cells.
    pub fn new(connection: f64, drive_tolerance: f64) -> Self {
        let (loading, slip) = (CellLoading::default(), CellSlip::default());
        Self { connection, loading, slip, viscosity: None, drive_tolerance, area: None }
    }

    /// Checks the numbers.
    pub(super) fn check(&self) -> Result<()> {
        let viscosity = self.viscosity.unwrap_or(1.0);
        let tolerance = self.drive_tolerance;
        for (key, value) in [
            ("connection", self.connection),
            ("viscosity", viscosity),
            ("drive_tolerance", tolerance),
            ("area", self.area.unwrap_or(1.0)),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::invalid(key, "a finite number above 0", value));
            }
        }
        Ok(())
    }
}

/// Springs from the cells to the drive: K_0j = a_j K_0 for the first cells, 0 for the others.
#[derive(Debug, Clone)]
pub(super) struct DriveSprings {
    stiffness: f64,
    /// Number of cells with a spring.
    connected: usize,
    /// Number of all cells.
    cells: usize,
    areas: CellAreas,
}

impl DriveSprings {
    pub fn new(parameters: &InterfaceParameters, shape: Shape, areas: CellAreas) -> Self {
        let connected = match parameters.loading {
            CellLoading::Uniform => shape.size(),
            CellLoading::Edge => shape.first_row(),
        };
        Self { stiffness: parameters.connection, connected, cells: shape.size(), areas }
    }

    /// The largest a_j K_0.
    pub fn largest(&self) -> f64 {
        self.areas.largest() * self.stiffness
    }

    /// K_0j.
    #[inline]
    pub fn of(&self, cell: usize) -> f64 {
        if cell < self.connected { self.areas.of(cell) * self.stiffness } else { 0.0 }
    }

    /// ΣK_0j.
    pub fn total(&self) -> f64 {
        self.areas.total(self.connected) * self.stiffness
    }

    /// ΣK_0j/Σa_j.
    pub fn per_area(&self) -> f64 {
        self.stiffness * self.areas.total(self.connected) / self.areas.total(self.cells)
    }

    /// a_j.
    pub fn areas(&self) -> &CellAreas {
        &self.areas
    }

    /// Whether every cell has a spring.
    pub fn hold_all(&self) -> bool {
        self.connected == self.cells
    }
}
