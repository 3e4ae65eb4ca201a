//! Slips, which are events at a fixed drive, and the size statistics of all events.

use super::{EnergyBalance, Point};
use crate::record::{Quantity, Record};

/// A slip.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Event {
    /// State X_1, F_1 at the loss of stability.
    pub before: Point,
    /// State of the next equilibrium.
    pub after: Point,
    /// Position X_2 of the first arrest of an inertial slip; otherwise the position after the slip.
    pub position_turn: f64,
    /// Breaks in the slip, per contact. A contact that breaks twice counts twice; a reset counts as 1.
    pub broken_fraction: f64,
    /// Energies of the slip.
    pub energy: EnergyBalance,
    /// Energies between the previous slip and this one.
    pub approach: EnergyBalance,
}

impl Event {
    /// Force drop: F_1 minus the force after the slip.
    pub fn drop(&self) -> f64 {
        self.before.force - self.after.force
    }

    /// Displacement of the slider's base.
    pub fn slip(&self) -> f64 {
        self.after.position - self.before.position
    }
}

/// Where the motion at a fixed drive has led.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one at a time")]
pub(super) enum MotionEnd {
    /// To a new equilibrium, with the event if it is large enough to count.
    Balanced(Option<Event>),
    /// To none: the slider has run away.
    Away,
}

/// Events of about the same size.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct Size {
    /// Their number.
    pub events: u64,
    /// Sum of breaks per contact.
    pub broken: f64,
    /// Sum of displacements of the slider.
    pub slip: f64,
    /// Sum of force drops.
    pub drop: f64,
}

/// Statistics of all events by the fraction of contacts that break, in logarithmic bins: bin i holds fractions nearest to
/// 10^{i/10 − 12}. The first bin also holds smaller fractions, the last one those above 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Sizes {
    /// The bins.
    pub bins: Vec<Size>,
}

/// Bins per factor of ten.
const PER_DECADE: usize = 10;

/// Decades below a fraction of 1.
const DECADES: usize = 12;

impl Default for Sizes {
    fn default() -> Self {
        Self { bins: vec![Size::default(); PER_DECADE * DECADES + 1] }
    }
}

impl Sizes {
    /// The fraction of contacts at the middle of a bin.
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
        // The cast saturates: −∞, the logarithm of no breaks, falls into the first bin.
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
