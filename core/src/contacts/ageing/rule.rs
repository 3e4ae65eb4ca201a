//! Ageing: thresholds that change with the time a contact has held.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::law::SharedLaw;
use crate::{Error, Result};

/// How the thresholds of contacts age.
pub type Ageing = AgeingRule<SharedLaw>;

/// How the threshold of a contact changes with its age t. Fresh contacts have the distribution P_ci. `D` is the distribution
/// itself, or its description in a scenario.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[schemars(rename = "Ageing")]
#[non_exhaustive]
pub enum AgeingRule<D> {
    /// Thresholds diffuse independently in the potential U = −ln P_cf: ∂_t p = D∂_h[U' + ∂_h]p (Braun and Peyrard). A contact
    /// breaks when its threshold equals its stretch, whichever of the two moves.
    Smoluchowski {
        /// P_cf, the stationary distribution of thresholds if no contact breaks.
        mature: D,
        /// D, stretch² per time, above 0.
        #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length^2/time"))]
        diffusion: f64,
    },
    /// A contact keeps its quantile while the distribution evolves as under Smoluchowski ageing with D = σ_f²/`time` and no
    /// breaking. From Gaussian to Gaussian, mean and variance relax exponentially at the rates 1/`time` and 2/`time`.
    FrozenRank {
        /// P_cf.
        mature: D,
        /// The time in which it matures, above 0.
        #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "time"))]
        time: f64,
    },
    /// h(t) = h_0[1 + β ln(1 + t/τ_0)]: unlimited strengthening, as measured on rock and polymers.
    Logarithmic {
        /// β, 0 or above.
        #[schemars(extend("minimum" = 0, "x-dimension" = "1"))]
        growth: f64,
        /// τ_0, above 0.
        #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "time"))]
        time: f64,
    },
    /// The coupled equations for Q and P_c: all contacts share one distribution of thresholds, ∂_t P_c = D∂_h[U' + ∂_h]P_c +
    /// Γ(P_ci − P_c), Γ the rate at which contacts form per attached one. In steady sliding ages are exponentially distributed,
    /// P_c = ∫₀^∞ e^{−τ} P_c^{Smol}(t = τC/v) dτ with C/v the mean life of contacts. It is no rule for a single contact.
    MeanField {
        /// P_cf.
        mature: D,
        /// D, stretch² per time, above 0.
        #[schemars(extend("exclusiveMinimum" = 0, "x-dimension" = "length^2/time"))]
        diffusion: f64,
    },
}

impl<D> AgeingRule<D> {
    /// The name, as in a scenario.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Smoluchowski { .. } => "smoluchowski",
            Self::FrozenRank { .. } => "frozen_rank",
            Self::Logarithmic { .. } => "logarithmic",
            Self::MeanField { .. } => "mean_field",
        }
    }

    /// P_cf, if the rule has one.
    pub fn mature(&self) -> Option<&D> {
        match self {
            Self::Smoluchowski { mature, .. }
            | Self::FrozenRank { mature, .. }
            | Self::MeanField { mature, .. } => Some(mature),
            Self::Logarithmic { .. } => None,
        }
    }

    /// The same with another description of the mature distribution.
    ///
    /// # Errors
    /// Those of `describe`.
    pub fn try_map<E>(&self, describe: impl FnOnce(&D) -> Result<E>) -> Result<AgeingRule<E>> {
        Ok(match *self {
            Self::Smoluchowski { ref mature, diffusion } => {
                AgeingRule::Smoluchowski { mature: describe(mature)?, diffusion }
            }
            Self::FrozenRank { ref mature, time } => {
                AgeingRule::FrozenRank { mature: describe(mature)?, time }
            }
            Self::Logarithmic { growth, time } => AgeingRule::Logarithmic { growth, time },
            Self::MeanField { ref mature, diffusion } => {
                AgeingRule::MeanField { mature: describe(mature)?, diffusion }
            }
        })
    }
}

impl Ageing {
    /// Checks the parameters, and that the thresholds of fresh contacts lie in the support of P_cf.
    ///
    /// # Errors
    /// A diffusion or time that is not above 0, a growth below 0; a mature distribution with point masses or
    /// gaps; fresh contacts outside its support.
    pub(in crate::contacts) fn check(&self, fresh: &SharedLaw) -> Result<()> {
        let (key, value) = match *self {
            Self::Smoluchowski { diffusion, .. } | Self::MeanField { diffusion, .. } => {
                ("diffusion", diffusion)
            }
            Self::FrozenRank { time, .. } | Self::Logarithmic { time, .. } => ("time", time),
        };
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::invalid(key, "a finite number above 0", value));
        }
        if let Self::Logarithmic { growth, .. } = *self
            && !(growth.is_finite() && growth >= 0.0)
        {
            return Err(Error::invalid("growth", "a finite number, 0 or above", growth));
        }
        self.mature().map_or(Ok(()), |mature| potential(mature, fresh).map_err(|e| e.under("mature")))
    }
}

/// Checks that U = −ln P_cf is a potential in which all fresh thresholds can move.
fn potential(mature: &SharedLaw, fresh: &SharedLaw) -> Result<()> {
    /// Fraction of contacts that no result shows.
    const NEGLIGIBLE: f64 = 1e-12;
    let name = mature.name();
    if !mature.atoms().is_empty() {
        let expected = "a distribution with a density everywhere, since thresholds diffuse in its logarithm";
        return Err(Error::invalid(name, expected, "one with point masses"));
    }
    let (low, high) = (mature.quantile(0.0), mature.upper_quantile(0.0));
    let inside = |k: u32| low + (mature.upper_quantile(NEGLIGIBLE) - low) * f64::from(k) / 512.0;
    if let Some(gap) = (1..512).map(inside).find(|&h| {
        mature.density(h) == 0.0 && mature.survival(h) > NEGLIGIBLE && mature.cumulative(h) > NEGLIGIBLE
    }) {
        let expected = "a distribution without gaps, since thresholds diffuse in its logarithm";
        return Err(Error::invalid(name, expected, format!("one without density at {gap}")));
    }
    let outside = fresh.cumulative(low.next_down()) + fresh.survival(high);
    if outside > NEGLIGIBLE {
        let expected = "a distribution whose support holds all thresholds at formation";
        return Err(Error::invalid(
            name,
            expected,
            format!("a fraction {outside} of them outside [{low}, {high}]"),
        ));
    }
    Ok(())
}
