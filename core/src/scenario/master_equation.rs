//! `[master_equation]`: tolerances of its solution.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::block::Block;
use crate::contacts::Rules;
use crate::master::{Tolerance, Transport};
use crate::{Error, Result};

/// How the master equation is solved.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct MasterEquation {
    /// Allowed error of the force, in units of N_c⟨k⟩ times the mean threshold, from 1e-12 to 1e-2; a run of any task with a
    /// larger estimated error fails. Without this key the aim is 1e-10, and no run fails. `accuracy` in `summary.json` is
    /// the estimated error of F/(N_c⟨k⟩), a length. Where the velocity varies, the default is 1e-6, or 1e-4 if in addition
    /// thresholds diffuse; the estimate, an upper one, may be some ten times larger. A step of a block or of a cell in time has
    /// by default an error of 1e-4 mean thresholds; errors add up, and that of the force is estimated only if this key is given,
    /// which then takes shorter steps and a second motion.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1e-12, "maximum" = 1e-2, "default" = 1e-10, "x-dimension" = "1"))]
    pub tolerance: Option<f64>,
}

impl MasterEquation {
    /// Tolerance of a pull at constant velocity.
    pub fn tolerance(&self) -> Tolerance {
        self.tolerance.into()
    }

    /// Tolerance at a varying velocity of contacts with these rules.
    pub fn tolerance_in_time(&self, rules: &Rules) -> f64 {
        let required = self.tolerance.map(|required| required.min(Transport::LARGEST_TOLERANCE));
        required.unwrap_or_else(|| Transport::default_tolerance(rules))
    }

    /// Tolerance of the contacts of a block that is moved in time, or of a cell of an interface.
    pub fn tolerance_of_a_block(&self) -> f64 {
        self.tolerance.unwrap_or(Block::TOLERANCE_IN_TIME)
    }

    /// Tolerance of a step of a block in time, per mean threshold.
    pub fn step_of_a_block(&self) -> f64 {
        self.tolerance.map_or(Block::TOLERANCE_IN_TIME, Block::step_for)
    }

    /// Tolerance of a step of a cell of an interface in time, per mean threshold.
    pub fn step_of_a_cell(&self) -> f64 {
        /// Part of the error of a block: cells slip one after the other, and errors of the times of their slips add up.
        const PART: f64 = 1.0 / 16.0;
        self.tolerance.map_or(Block::TOLERANCE_IN_TIME, |required| Block::step_for(PART * required))
    }

    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        match self.tolerance.filter(|tolerance| !(1e-12..=1e-2).contains(tolerance)) {
            None => Ok(()),
            Some(wrong) => {
                Err(Error::invalid("tolerance", "a number from 1e-12 to 1e-2", format!("{wrong:e}")))
            }
        }
    }
}
