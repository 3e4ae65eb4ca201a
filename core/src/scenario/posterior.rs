//! `fit.posterior`: draws from the posterior of a fit.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::size;
use crate::{Error, Result};

/// Draws from the posterior of a fit by the No-U-turn sampler.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct FitPosterior {
    /// Draws of each chain, 4 or more.
    #[schemars(extend("minimum" = 4))]
    pub draws: usize,
    /// Number of chains, 1 or more.
    #[schemars(extend("minimum" = 1))]
    pub chains: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for FitPosterior {
    fn default() -> Self {
        Self { draws: 1000, chains: 4, seed: 1 }
    }
}

impl FitPosterior {
    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value; more draws than fit in memory.
    pub fn check(&self) -> Result<()> {
        if self.draws < 4 {
            return Err(Error::invalid("draws", "4 draws or more of each chain", self.draws));
        }
        if self.chains == 0 {
            return Err(Error::invalid("chains", "1 chain or more", self.chains));
        }
        size::check("draws", self.chains.saturating_mul(self.draws), size::BYTES_PER_POINT)
    }
}
