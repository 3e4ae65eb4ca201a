//! `[renormalisation]`: the law of the drives at which coupled contacts break for the first time, beside the mean field's.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Interface, Law, PerCell, Scenario, size};
use crate::contacts::Contacts;
use crate::{Error, Result};

/// Drives interfaces of relaxed contacts until every contact has broken, and counts at which drives they first did.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Renormalisation {
    /// Number of interfaces drawn, from the seed of the ensemble on, each with the next one.
    pub runs: usize,
    /// Number of equal intervals of the drive in which first breaks are counted.
    pub points: usize,
}

impl Default for Renormalisation {
    fn default() -> Self {
        Self { runs: 8, points: 120 }
    }
}

impl Renormalisation {
    /// Whether every value makes sense.
    ///
    /// # Errors
    /// The first that does not.
    pub fn check(&self) -> Result<()> {
        if self.runs < 2 {
            return Err(Error::invalid("runs", "2 runs or more, whose scatter tells the error", self.runs));
        }
        if self.points == 0 {
            return Err(Error::invalid("points", "1 interval or more", self.points));
        }
        size::check("points", self.points, size::BYTES_PER_POINT)
    }

    /// Whether the rest of the scenario is of relaxed contacts that differ, coupled one by one.
    ///
    /// # Errors
    /// What is not so, with its full path.
    pub(super) fn check_contacts(
        interface: &Interface,
        contacts: &Contacts,
        scenario: &Scenario,
    ) -> Result<()> {
        if interface.contacts != PerCell::One {
            let expected = "\"one\" with [renormalisation]: contacts coupled one by one";
            return Err(Error::invalid("interface.contacts", expected, "many"));
        }
        if let Some(atom) = contacts.thresholds.atoms().first() {
            let expected =
                "thresholds without point masses with [renormalisation]: identical contacts break together";
            return Err(Error::invalid("contacts.thresholds", expected, format!("one at {}", atom.position)));
        }
        for (key, law) in
            [("initial", &scenario.initial), ("contacts.reforming", &scenario.contacts.reforming)]
        {
            if *law != Law::zero() {
                let expected =
                    "point = { at = 0.0 }, the default, with [renormalisation]: contacts that are relaxed";
                return Err(Error::invalid(key, expected, "another law"));
            }
        }
        Ok(())
    }
}
