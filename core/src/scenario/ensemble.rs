//! `[ensemble]`: a simulation of single contacts for the same task.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::contacts::{Contacts, Initial};
use crate::ensemble::Disorder;
use crate::{Error, Result, ensemble};

/// The earthquake-like model: contacts drawn at random and simulated one by one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Ensemble {
    /// Number of simulated contacts; forces are scaled to `contacts.count`. Without `[ensemble]` there is no simulation. For
    /// an interface, the number of contacts of each cell (required).
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("minimum" = 1, "default" = 100_000))]
    pub size: Option<usize>,
    /// Seed; the same seed gives the same contacts, on any number of threads.
    pub seed: u64,
    /// `"annealed"`: a contact gets a new threshold when it re-forms; or `"quenched"`: contacts keep their thresholds.
    pub disorder: Disorder,
}

impl Default for Ensemble {
    fn default() -> Self {
        Self { size: None, seed: 1, disorder: Disorder::Annealed }
    }
}

impl Ensemble {
    /// Default number of contacts.
    pub const SIZE: usize = 100_000;

    /// Number of simulated contacts.
    pub fn size(&self) -> usize {
        self.size.unwrap_or(Self::SIZE)
    }

    /// The contacts, drawn at random.
    ///
    /// # Errors
    /// No contacts, or distributions in which no contact survives its initial stretch.
    pub fn build(&self, contacts: Contacts, initial: Initial) -> Result<ensemble::Ensemble> {
        self.check().map_err(|e| e.under("ensemble"))?;
        let built = ensemble::Ensemble::new(contacts, initial, self.size(), self.seed, self.disorder);
        built.map_err(Error::of_scenario)
    }

    fn check(&self) -> Result<()> {
        if self.size == Some(0) {
            return Err(Error::invalid("size", "1 contact or more", 0));
        }
        // TOML has no whole numbers above this.
        if i64::try_from(self.seed).is_err() {
            return Err(Error::invalid("seed", "a whole number below 2^63", self.seed));
        }
        Ok(())
    }
}
