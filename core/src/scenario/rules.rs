//! `[contacts]`: `ageing` and `delay`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Law, Tabulated, not_negative};
use crate::{Result, contacts};

/// How thresholds change with the age of a contact.
pub type Ageing = contacts::AgeingRule<Law>;

/// The time for which a broken contact is detached before it re-forms.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Delay {
    /// Time τ, 0 or above, for which a broken contact is detached before it re-forms; without `[contacts.delay]` it re-forms
    /// at once.
    #[schemars(extend("minimum" = 0, "x-dimension" = "time"))]
    pub time: f64,
}

impl Delay {
    pub(super) fn build(self) -> Result<f64> {
        not_negative("time", self.time)
    }
}

impl Ageing {
    pub(super) fn build(&self) -> Result<contacts::Ageing> {
        self.try_map(|law| law.build().map_err(|e| e.under("mature").under(self.name())))
    }

    pub(super) fn tables<'a>(&'a mut self, key: &str, tables: &mut Vec<(String, &'a mut Tabulated)>) {
        let name = self.name();
        match self {
            Self::Smoluchowski { mature, .. }
            | Self::FrozenRank { mature, .. }
            | Self::MeanField { mature, .. } => {
                mature.tables(&format!("{key}.{name}.mature"), tables);
            }
            Self::Logarithmic { .. } => {}
        }
    }
}
