//! The solid of a half-space, whose stiffness depends on the direction of waves where Poisson's ratio is not 0.

use std::ops::RangeInclusive;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::positive;
use crate::{Error, Result};

/// An elastic solid whose surface moves along one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Solid {
    /// Shear modulus G, force per area, above 0.
    pub modulus: f64,
    /// Poisson's ratio ν, in [`Solid::POISSON_RATIOS`].
    pub poisson_ratio: f64,
    /// The direction in which its surface moves.
    pub sliding: SlidingDirection,
}

/// The direction of sliding on a lattice of rows and columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum SlidingDirection {
    /// Along the columns, from row to row; along a chain.
    #[default]
    Columns,
    /// Along the rows; across a chain.
    Rows,
}

impl Solid {
    /// Ratios ν for which a cell that advances pulls no other one back. Beyond about 0.4828 it would pull back the third one
    /// across the direction of sliding, and below about −0.934 the third one along it.
    pub const POISSON_RATIOS: RangeInclusive<f64> = -0.9..=0.48;

    /// A solid of shear modulus G whose surface moves along `sliding`.
    pub fn new(modulus: f64, poisson_ratio: f64, sliding: SlidingDirection) -> Self {
        Self { modulus, poisson_ratio, sliding }
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// A modulus not above 0; a ratio beyond [`Solid::POISSON_RATIOS`].
    pub fn check(self) -> Result<()> {
        positive("modulus", self.modulus)?;
        if Self::POISSON_RATIOS.contains(&self.poisson_ratio) {
            return Ok(());
        }
        let [least, most] = [Self::POISSON_RATIOS.start(), Self::POISSON_RATIOS.end()];
        Err(Error::invalid("poisson_ratio", format!("a number from {least} to {most}"), self.poisson_ratio))
    }

    /// The stiffness of cells of side `cell`.
    pub(super) fn stiffness(self, cell: f64) -> WaveStiffness {
        let across = self.modulus * cell;
        let along = across / (1.0 - self.poisson_ratio);
        match self.sliding {
            SlidingDirection::Columns => WaveStiffness { columns: along, rows: across },
            SlidingDirection::Rows => WaveStiffness { columns: across, rows: along },
        }
    }
}

/// A solid for which Poisson's ratio is 0, or which is described by one effective modulus G*.
impl From<f64> for Solid {
    fn from(modulus: f64) -> Self {
        Self::new(modulus, 0.0, SlidingDirection::default())
    }
}

/// The stiffness A = (s_column Δ_column + s_row Δ_row)/√Δ of cells, in units of force per length.
#[derive(Debug, Clone, Copy)]
pub(super) struct WaveStiffness {
    /// Against waves down the columns.
    pub columns: f64,
    /// Against waves along the rows.
    pub rows: f64,
}

impl WaveStiffness {
    /// That against rows above that against columns, 0 in an isotropic solid.
    pub fn excess(self) -> f64 {
        self.rows - self.columns
    }

    /// Against a wave with these eigenvalues of Δ_column and Δ_row.
    pub fn against(self, down: f64, along: f64) -> f64 {
        let root = (along + down).sqrt();
        if root > 0.0 { self.columns * root + self.excess() * (along / root) } else { 0.0 }
    }
}
