//! Ageing: thresholds that drift with the time a contact has held.

use crate::law::SharedLaw;
use crate::{Error, Result};

/// How the thresholds of newborn contacts, of law P_ci, change with the age t of the contact.
#[derive(Debug, Clone)]
pub enum Ageing {
    /// Thresholds diffuse in the potential U = −ln P_cf: ∂_t p = D∂_h[U' + ∂_h]p (the paper's). A contact breaks when its
    /// threshold meets its stretch, whichever of the two moves.
    Smoluchowski {
        /// P_cf, the law of thresholds that never break.
        mature: SharedLaw,
        /// D, stretch² per time.
        diffusion: f64,
    },
    /// A contact keeps its quantile while the law matures as under [`Ageing::Smoluchowski`] with D = σ_f²/`time`, nothing
    /// breaking. From Gaussian to Gaussian mean and variance relax exponentially, at the rates 1/`time` and 2/`time`.
    FrozenRank {
        /// P_cf.
        mature: SharedLaw,
        /// The time in which it matures.
        time: f64,
    },
    /// h(t) = h_0[1 + β ln(1 + t/τ_0)]: strengthening without end, as measured on rock and polymers.
    Logarithmic {
        /// β.
        growth: f64,
        /// τ_0.
        time: f64,
    },
    /// The closure of the coupled equations for Q and P_c in steady sliding: P_c = ∫₀^∞ e^{−τ} P_c^{Smol}(t = τC/v) dτ, with
    /// C the mean of P_c: ages are distributed exponentially. No rule for a single contact.
    MeanField {
        /// P_cf.
        mature: SharedLaw,
        /// D, stretch² per time.
        diffusion: f64,
    },
}

impl Ageing {
    /// The name, as in a scenario.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Smoluchowski { .. } => "smoluchowski",
            Self::FrozenRank { .. } => "frozen_rank",
            Self::Logarithmic { .. } => "logarithmic",
            Self::MeanField { .. } => "mean_field",
        }
    }

    /// P_cf, where there is one.
    pub fn mature(&self) -> Option<&SharedLaw> {
        match self {
            Self::Smoluchowski { mature, .. }
            | Self::FrozenRank { mature, .. }
            | Self::MeanField { mature, .. } => Some(mature),
            Self::Logarithmic { .. } => None,
        }
    }

    /// Checks the numbers, and that newborn thresholds of the law `newborn` can mature.
    ///
    /// # Errors
    /// A diffusion or time that is not above 0, a growth below 0; a mature law with point masses or gaps, or one outside
    /// whose support contacts are born.
    pub(in crate::contacts) fn check(&self, newborn: &SharedLaw) -> Result<()> {
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
        self.mature().map_or(Ok(()), |mature| potential(mature, newborn).map_err(|e| e.under("mature")))
    }
}

/// Checks that U = −ln P_cf is a potential in which all newborn thresholds can move.
fn potential(mature: &SharedLaw, newborn: &SharedLaw) -> Result<()> {
    /// A share of contacts that no result shows.
    const NEGLIGIBLE: f64 = 1e-12;
    let name = mature.name();
    if !mature.atoms().is_empty() {
        let expected = "a law with a density everywhere, since thresholds diffuse in its logarithm";
        return Err(Error::invalid(name, expected, "one with point masses"));
    }
    let (low, high) = (mature.quantile(0.0), mature.upper_quantile(0.0));
    let inside = |k: u32| low + (mature.upper_quantile(NEGLIGIBLE) - low) * f64::from(k) / 512.0;
    if let Some(gap) = (1..512).map(inside).find(|&h| {
        mature.density(h) == 0.0 && mature.survival(h) > NEGLIGIBLE && mature.cumulative(h) > NEGLIGIBLE
    }) {
        let expected = "a law without gaps, since thresholds diffuse in its logarithm";
        return Err(Error::invalid(name, expected, format!("one without density at {gap}")));
    }
    let outside = newborn.cumulative(low.next_down()) + newborn.survival(high);
    if outside > NEGLIGIBLE {
        let expected = "a law whose support holds all newborn thresholds";
        return Err(Error::invalid(
            name,
            expected,
            format!("a share {outside} of them outside [{low}, {high}]"),
        ));
    }
    Ok(())
}
