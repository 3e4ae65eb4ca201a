//! What draws from the posterior of a fit say.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Extended;

/// Draws from the posterior of a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PosteriorSummary {
    /// Number of chains.
    pub chains: usize,
    /// Draws of each chain.
    pub draws: usize,
    /// Number of draws whose paths diverged.
    pub divergences: usize,
    /// The numbers; those of which the fit knows only a limit keep their estimates and are not among them.
    pub numbers: Vec<PosteriorNumber>,
}

/// A number by draws from its posterior.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PosteriorNumber {
    /// Its key in the scenario.
    pub key: String,
    /// Mean of the draws.
    pub mean: f64,
    /// Their standard deviation.
    pub std: f64,
    /// Their quantiles of 2.5 %, 50 % and 97.5 %.
    pub quantiles: [f64; 3],
    /// r̂, near 1 where the chains agree; NaN where all draws are the same.
    pub r_hat: Extended,
    /// The number of independent draws that they are worth.
    pub effective_size: Extended,
}

/// Largest r̂ of chains that are long enough, and the least effective number of draws.
const AGREED: f64 = 1.01;
const ENOUGH: f64 = 400.0;

impl PosteriorSummary {
    /// Sentences about draws that are not to be trusted.
    pub fn warnings(&self) -> Vec<String> {
        let mut found = Vec::new();
        if self.divergences > 0 {
            found.push(format!(
                "{} of {} draws diverged: the density bends too much there, and the draws may miss a part of it",
                self.divergences,
                self.chains * self.draws
            ));
        }
        for number in &self.numbers {
            // NaN is no agreement.
            let agree = number.r_hat.0 <= AGREED;
            let enough = number.effective_size.0 >= ENOUGH;
            if !agree || !enough {
                found.push(format!(
                    "more draws are needed for {}: r̂ = {:.3}, worth {:.0} independent draws",
                    number.key, number.r_hat.0, number.effective_size.0
                ));
            }
        }
        found
    }
}
