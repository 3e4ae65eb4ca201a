//! How the cells of an interface differ.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::super::{exactly_one, not_negative};
use crate::elastic::cells::scales;
use crate::{Error, Result};

/// How cells differ: all lengths of the contacts of cell j, such as their thresholds, are multiplied by s_j.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Scales {
    /// Standard deviation, 0 or above, of the scale factors s_j of the cells, which multiply all lengths of their contacts;
    /// they are drawn from a Gaussian distribution of mean 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 0, "x-dimension" = "1"))]
    pub std: Option<f64>,
    /// Seed of these random numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1))]
    pub seed: Option<u64>,
    /// CSV with the one column `scale`, a row for each cell, row by row of the lattice, instead of `std`; its path is
    /// relative to the scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The scale factors themselves, instead of a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("items" = { "type": "number", "exclusiveMinimum": 0 }, "x-dimension" = "1"))]
    pub scale: Option<Vec<f64>>,
}

impl Scales {
    /// The seed of the random numbers.
    pub fn seed(&self) -> u64 {
        self.seed.unwrap_or(1)
    }

    /// Checks the values for this number of cells, and draws the scale factors unless they are too many to be drawn twice.
    pub(super) fn try_out(&self, cells: usize) -> Result<()> {
        /// About a tenth of a second.
        const MANY: usize = 1 << 22;
        self.check(cells).map_err(|e| e.under("disorder"))?;
        if cells > MANY { Ok(()) } else { self.build(cells).map(drop) }
    }

    /// The scale factors of this number of cells.
    pub(super) fn build(&self, cells: usize) -> Result<Vec<f64>> {
        self.check(cells).map_err(|e| e.under("disorder"))?;
        match &self.scale {
            Some(scale) => Ok(scale.clone()),
            None => scales(cells, self.std.unwrap_or(0.0), self.seed()).map_err(|e| e.under("disorder")),
        }
    }

    /// Checks the values for this number of cells.
    fn check(&self, cells: usize) -> Result<()> {
        let Self { std, file, scale, .. } = self;
        let given = [("std", std.is_some()), ("file", file.is_some()), ("scale", scale.is_some())];
        exactly_one("", "one of std, file and scale", &given)?;
        if let (Some(seed), None) = (self.seed, self.std) {
            return Err(Error::invalid("seed", "none without std: nothing is drawn", seed));
        }
        self.std.map(|std| not_negative("std", std)).transpose()?;
        // TOML has no whole numbers above this.
        if let Some(seed) = self.seed.filter(|&seed| i64::try_from(seed).is_err()) {
            return Err(Error::invalid("seed", "a whole number below 2^63", seed));
        }
        let Some(scales) = &self.scale else { return Ok(()) };
        if scales.len() != cells {
            return Err(Error::invalid("scale", format!("{cells} scales, one for each cell"), scales.len()));
        }
        match scales.iter().position(|&scale| !(scale.is_finite() && scale > 0.0)) {
            Some(cell) => Err(Error::invalid(format!("scale.{cell}"), "a number above 0", scales[cell])),
            None => Ok(()),
        }
    }
}
