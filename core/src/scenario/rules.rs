//! `[contacts]`: `temperature`, `ageing` and `delay`, the rules that make contacts time-dependent.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Law, Tabulated};
use crate::{Result, contacts};

/// Contacts below their thresholds break at the rate ω e^{−ΔE/T}.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Temperature {
    /// T in units of energy (force × length), above 0.
    pub energy: f64,
    /// ω, per time, above 0.
    pub attempt_rate: f64,
    /// The barrier ΔE.
    #[serde(default)]
    pub barrier: Barrier,
}

/// The barrier that holds a contact of stretch x below its threshold x_s; with E_0 = ½k x_s²:
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Barrier {
    /// ½k(x_s² − x²).
    #[default]
    Elastic,
    /// E_0(1 − x/x_s).
    Bell,
    /// E_0(1 − x/x_s)^{3/2}.
    Catastrophe,
}

/// How thresholds change with the age of a contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Ageing {
    /// Thresholds diffuse towards the mature law, each for itself.
    Smoluchowski {
        /// P_cf, the law of thresholds that never break.
        mature: Law,
        /// D, stretch² per time, above 0.
        diffusion: f64,
    },
    /// The law matures and every contact keeps its quantile in it.
    FrozenRank {
        /// P_cf.
        mature: Law,
        /// The time in which it matures, above 0.
        time: f64,
    },
    /// Every threshold grows by a fraction for each factor in age: h(t) = h_0[1 + growth ln(1 + t/time)].
    Logarithmic {
        /// β, 0 or above.
        growth: f64,
        /// τ_0, above 0.
        time: f64,
    },
    /// The law of thresholds in steady sliding, by the closed equations for it and the stretches.
    MeanField {
        /// P_cf.
        mature: Law,
        /// D, stretch² per time, above 0.
        diffusion: f64,
    },
}

/// How long a broken contact is free before it re-forms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Delay {
    /// τ, 0 or above.
    pub time: f64,
}

impl Temperature {
    pub(super) fn build(self) -> contacts::Temperature {
        let barrier = match self.barrier {
            Barrier::Elastic => contacts::Barrier::Elastic,
            Barrier::Bell => contacts::Barrier::Bell,
            Barrier::Catastrophe => contacts::Barrier::Catastrophe,
        };
        contacts::Temperature { energy: self.energy, attempt_rate: self.attempt_rate, barrier }
    }
}

impl Ageing {
    pub(super) fn build(&self) -> Result<contacts::Ageing> {
        let law = |name: &str, law: &Law| law.build().map_err(|e| e.under("mature").under(name));
        Ok(match *self {
            Self::Smoluchowski { ref mature, diffusion } => {
                contacts::Ageing::Smoluchowski { mature: law("smoluchowski", mature)?, diffusion }
            }
            Self::FrozenRank { ref mature, time } => {
                contacts::Ageing::FrozenRank { mature: law("frozen_rank", mature)?, time }
            }
            Self::Logarithmic { growth, time } => contacts::Ageing::Logarithmic { growth, time },
            Self::MeanField { ref mature, diffusion } => {
                contacts::Ageing::MeanField { mature: law("mean_field", mature)?, diffusion }
            }
        })
    }

    pub(super) fn tables<'a>(&'a mut self, key: &str, tables: &mut Vec<(String, &'a mut Tabulated)>) {
        let (name, mature) = match self {
            Self::Smoluchowski { mature, .. } => ("smoluchowski", mature),
            Self::FrozenRank { mature, .. } => ("frozen_rank", mature),
            Self::MeanField { mature, .. } => ("mean_field", mature),
            Self::Logarithmic { .. } => return,
        };
        mature.tables(&format!("{key}.{name}.mature"), tables);
    }
}
