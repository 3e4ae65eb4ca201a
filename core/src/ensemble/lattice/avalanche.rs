//! Avalanches and their catalogue.

use serde::{Deserialize, Serialize};

use crate::record::{Quantity, Record};

/// One avalanche: all breaks at one drive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Avalanche {
    /// X, by which the drive has stretched every contact when the first one breaks.
    pub drive: f64,
    /// The time at which that happens; 0 without a velocity.
    pub time: f64,
    /// The age of the contact that breaks first; 0 without a velocity.
    pub age: f64,
    /// The contact that broke first, counted along rows; of several the one of the smallest number.
    pub epicentre: usize,
    /// Breaks.
    pub size: u64,
    /// Contacts that broke, once or more often.
    pub area: u64,
    /// Generations of breaks.
    pub duration: u64,
    /// Σ(f − k r) over all breaks: the force released to neighbours, edges and drive.
    pub released: f64,
    /// Force of all contacts when the first one breaks.
    pub force_before: f64,
    /// Force of all contacts at the end.
    pub force_after: f64,
}

impl Avalanche {
    /// The drop of the force: what edges and drive have absorbed.
    pub fn drop(&self) -> f64 {
        self.force_before - self.force_after
    }
}

/// An avalanche that goes on, with the sums over its completed generations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct OngoingAvalanche {
    pub(super) epicentre: usize,
    /// Of the contact that broke first.
    #[serde(default)]
    pub(super) age: f64,
    pub(super) size: u64,
    pub(super) duration: u64,
    /// In units of the stiffness of a contact.
    pub(super) released: f64,
    /// What edges and drive have absorbed, in the same units.
    pub(super) lost: f64,
    pub(super) force_before: f64,
    pub(super) generation: OngoingGeneration,
}

/// A generation that goes on, with its sums so far.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct OngoingGeneration {
    /// Force that its contacts have released, in units of the stiffness of a contact.
    pub(super) released: f64,
    /// What open edges have absorbed of it, in the same units.
    pub(super) outward: f64,
    /// Contacts that have passed the released force on.
    pub(super) distributed: usize,
}

/// Time and age of the avalanches of a lattice at a velocity as columns.
pub fn record_in_time(avalanches: &[Avalanche]) -> Record {
    let mut record = Record::default();
    let mut column = |name: &str, long_name: &str, value: &dyn Fn(&Avalanche) -> f64| {
        record.push(name, long_name, Quantity::Time, &["event"], avalanches.iter().map(value).collect());
    };
    column("time", "time of the avalanche", &|a| a.time);
    column("age", "age of the contact that broke first", &|a| a.age);
    record
}

/// A catalogue as columns.
pub fn record(avalanches: &[Avalanche]) -> Record {
    let mut record = Record::default();
    let mut column = |name: &str, long_name: &str, quantity, value: &dyn Fn(&Avalanche) -> f64| {
        record.push(name, long_name, quantity, &["event"], avalanches.iter().map(value).collect());
    };
    let (count, force) = (Quantity::Count, Quantity::Force);
    column("drive", "drive at the avalanche", Quantity::Length, &|a| a.drive);
    column("epicentre", "contact that broke first", count, &|a| a.epicentre as f64);
    column("size", "breaks", count, &|a| a.size as f64);
    column("area", "contacts that broke", count, &|a| a.area as f64);
    column("duration", "generations of breaks", count, &|a| a.duration as f64);
    column("released", "released force", force, &|a| a.released);
    column("force_before", "force before", force, &|a| a.force_before);
    column("force_after", "force after", force, &|a| a.force_after);
    column("drop", "force drop", force, &Avalanche::drop);
    record
}
