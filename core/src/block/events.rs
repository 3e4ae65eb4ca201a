//! What happens at a fixed drive: slips, and the sizes of all events.

use super::{EnergyBalance, Point};
use crate::record::{Quantity, Record};

/// A slip.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// X_1 and F_1, where balance was lost.
    pub before: Point,
    /// Where it was found again.
    pub after: Point,
    /// X_2 of an inertial slip, where the slider first came to rest; else the position after.
    pub position_turn: f64,
    /// Breaks in the slip, per contact; a contact that breaks twice counts twice, but once in a reset, where this is 1.
    pub broken_fraction: f64,
    /// Energies of the slip.
    pub energy: EnergyBalance,
    /// Energies since the slip before, all that was no slip.
    pub approach: EnergyBalance,
}

impl Event {
    /// F_1 less the force after the slip.
    pub fn drop(&self) -> f64 {
        self.before.force - self.after.force
    }

    /// Way of the slider's bottom.
    pub fn slip(&self) -> f64 {
        self.after.position - self.before.position
    }
}

/// Events of about the same size.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Size {
    /// Their number.
    pub events: u64,
    /// Sum of breaks per contact.
    pub broken: f64,
    /// Sum of ways of the slider.
    pub slip: f64,
    /// Sum of force drops.
    pub drop: f64,
}

/// Statistics of all events by the share of contacts that break, in bins that are powers of 10^{1/10}: bin i holds
/// shares nearest to 10^{i/10 − 12} (by their logarithm), the first also what is below, the last what is above 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// One for each bin.
    pub bins: Vec<Size>,
}

/// Bins per factor of ten.
const PER_DECADE: usize = 10;

/// Decades below a share of 1.
const DECADES: usize = 12;

impl Default for Sizes {
    fn default() -> Self {
        Self { bins: vec![Size::default(); PER_DECADE * DECADES + 1] }
    }
}

impl Sizes {
    /// The share of contacts in the middle of a bin.
    pub fn middle(bin: usize) -> f64 {
        10.0_f64.powf(bin as f64 / PER_DECADE as f64 - DECADES as f64)
    }

    /// Number of all events.
    pub fn events(&self) -> u64 {
        self.bins.iter().map(|bin| bin.events).sum()
    }

    #[inline]
    pub(super) fn add(&mut self, broken: f64, slip: f64, drop: f64) {
        let bin = (PER_DECADE as f64 * (broken.log10() + DECADES as f64)).round();
        // Casting puts −∞, from no break, into the first.
        let bin = &mut self.bins[(bin as usize).min(PER_DECADE * DECADES)];
        bin.events += 1;
        bin.broken += broken;
        bin.slip += slip;
        bin.drop += drop;
    }
}

/// The columns of `events.csv`.
pub(super) fn record(events: &[Event], drive: Quantity) -> Record {
    let mut record = Record::default();
    let mut column = |name: &str, long_name: &str, quantity, value: &dyn Fn(&Event) -> f64| {
        record.push(name, long_name, quantity, &["event"], events.iter().map(value).collect());
    };
    let (length, force, energy) = (Quantity::Length, Quantity::Force, Quantity::Energy);
    column("drive", "drive at the slip", drive, &|e| e.before.drive);
    column("position_before", "position before", length, &|e| e.before.position);
    column("position_after", "position after", length, &|e| e.after.position);
    column("position_turn", "position of the first rest", length, &|e| e.position_turn);
    column("force_before", "force before", force, &|e| e.before.force);
    column("force_after", "force after", force, &|e| e.after.force);
    column("drop", "force drop", force, &Event::drop);
    column("slip", "slip", length, &Event::slip);
    column("broken_fraction", "breaks per contact", Quantity::Number, &|e| e.broken_fraction);
    column("dissipated_breaks", "energy lost in breaks", energy, &|e| e.energy.breaks);
    column("dissipated_slip", "energy lost by the slider", energy, &|e| e.energy.dissipated());
    record
}
