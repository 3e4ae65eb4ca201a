//! `[renormalisation]`: the distribution of the drives at which coupled contacts break for the first time, compared with
//! mean-field theory.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{CellLoading, Interface, Model, PerCell, Scales, size};
use crate::contacts::Stiffness;
use crate::{Error, Result};

/// Number of runs whose disorder is drawn in advance, to refuse scales that are not above 0; later runs check their own.
const RUNS_CHECKED: usize = 1000;
/// Memory of a first break: two points of two numbers in its run, and in the mean of all runs.
const BYTES_PER_FIRST_BREAK: f64 = 64.0;

/// Drives interfaces of relaxed contacts until every contact has broken (for cells, all but 1e-6), and makes a histogram of
/// the drives of the first breaks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Renormalisation {
    /// Number of independent interfaces, each driven until every contact has broken (for cells, all but 1e-6), with
    /// successive seeds: from `ensemble.seed` on for contacts coupled one by one, from `interface.disorder.seed` on for
    /// cells; errors are estimated from their scatter.
    #[schemars(extend("minimum" = 2))]
    pub runs: usize,
    /// Number of equal intervals of the drive in which first breaks are counted.
    #[schemars(extend("minimum" = 1))]
    pub points: usize,
}

impl Default for Renormalisation {
    fn default() -> Self {
        Self { runs: 8, points: 120 }
    }
}

impl Renormalisation {
    /// Checks every value.
    ///
    /// # Errors
    /// The first invalid value.
    pub fn check(&self) -> Result<()> {
        if self.runs < 2 {
            return Err(Error::invalid("runs", "2 runs or more, whose scatter gives the error", self.runs));
        }
        if self.points == 0 {
            return Err(Error::invalid("points", "1 interval or more", self.points));
        }
        size::check("points", self.points, size::BYTES_PER_POINT)
    }

    /// Refuses more runs than fit in memory: all of them are kept until the last has ended.
    fn check_size(&self, interface: &Interface) -> Result<()> {
        // Each contact, or cell, leaves two points at least, and as many in what all runs say together.
        let each = interface.size() as f64 * BYTES_PER_FIRST_BREAK;
        size::check("runs", self.runs, each).map_err(|error| error.under("renormalisation"))
    }

    /// Whether the rest of the scenario is of relaxed contacts that differ, coupled one by one or in cells that differ.
    ///
    /// # Errors
    /// What is not so, with its full path.
    pub(super) fn check_interface(&self, interface: &Interface, model: &Model) -> Result<()> {
        let Model { contacts, initial, ensemble, .. } = model;
        if let Some(atom) = contacts.thresholds.atoms().first() {
            let expected =
                "thresholds without point masses with [renormalisation]: identical contacts break together";
            return Err(Error::invalid("contacts.thresholds", expected, format!("one at {}", atom.position)));
        }
        for (key, law) in [("initial", &initial.law), ("contacts.reforming", &contacts.reforming)] {
            if law.quantile(1.0) > 0.0 {
                let expected =
                    "point = { at = 0.0 }, the default, with [renormalisation]: contacts that are relaxed";
                return Err(Error::invalid(key, expected, "another law"));
            }
        }
        self.check_size(interface)?;
        if interface.contacts == PerCell::One {
            if let Some(rule) = contacts.rules.first() {
                let expected = "none with [renormalisation]: contacts are followed along the drive alone";
                return Err(Error::invalid(format!("contacts.{rule}"), expected, "one"));
            }
            return interface.check_cells(contacts, ensemble.as_ref());
        }
        check_many(interface, model)?;
        let checked = self.runs.min(RUNS_CHECKED);
        (0..checked).try_for_each(|run| interface.redrawn(run).check_cells(contacts, None))
    }
}

/// Refuses cells that are not driven together and slowly, or do not differ by chance.
fn check_many(interface: &Interface, model: &Model) -> Result<()> {
    let contacts = &model.contacts;
    let refused = |key: &str, expected: &str, why: &str, found: &str| {
        let expected = format!("{expected} with [renormalisation] of cells: {why}");
        Err(Error::invalid(key, expected, found))
    };
    if let Some(rule) = contacts.rules.first() {
        return refused(
            &format!("contacts.{rule}"),
            "none",
            "they are followed along the drive alone",
            "one",
        );
    }
    let key = match contacts.stiffness {
        Stiffness::Equal(_) => None,
        Stiffness::PerThreshold(_) => Some("contacts.stiffness_per_threshold"),
        Stiffness::Tabulated(_) => Some("contacts.stiffness_of_threshold"),
    };
    if let Some(key) = key {
        let found = "stiffness that depends on the threshold";
        return refused(key, "equal stiffness", "κ is the same for every contact", found);
    }
    if model.ensemble.is_some() {
        return refused(
            "ensemble",
            "none",
            "each has many contacts, which follow the master equation",
            "one",
        );
    }
    if interface.loading == CellLoading::Edge {
        return refused("interface.loading", "\"uniform\"", "all are at the same drive", "edge");
    }
    if interface.viscosity.is_some() {
        return refused("interface.viscosity", "none", "slides end in the same places without", "one");
    }
    if interface.mass.is_some() {
        return refused("interface.mass", "none", "they are in balance between slides", "one");
    }
    match &interface.disorder {
        Some(Scales { std: Some(_), .. }) => Ok(()),
        disorder => {
            let found = if disorder.is_some() { "scales that are given" } else { "none" };
            refused("interface.disorder", "{ std, seed }", "each run draws their scales anew", found)
        }
    }
}
