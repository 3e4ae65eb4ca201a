//! Contacts coupled one by one as an interface: an event is an avalanche.

use crate::Result;
use crate::energy::EnergyBalance;
use crate::ensemble::lattice::{self, Avalanche, Lattice, LatticeState, Until};
use crate::monitor::Monitor;
use crate::record::{Column, Quantity, Record};

use super::model::DrivenInterface;

/// An avalanche, and the contacts that broke in it.
#[derive(Debug)]
pub struct BrokenContacts {
    pub(super) avalanche: Avalanche,
    scar: Vec<usize>,
}

/// Contacts coupled one by one on a lattice.
#[derive(Debug)]
pub struct DrivenContacts {
    /// The contacts.
    pub lattice: Lattice,
    /// Whether they form a chain, where the contacts that break in an event are recorded.
    pub chain: bool,
}

impl DrivenContacts {
    /// Drives the contacts through the next avalanche.
    pub(super) fn next(&mut self, monitor: &mut dyn Monitor) -> Result<BrokenContacts> {
        let avalanche = self.lattice.next_event(monitor)?;
        let scar = if self.chain { self.lattice.broken_contacts().collect() } else { Vec::new() };
        Ok(BrokenContacts { avalanche, scar })
    }
}

impl DrivenInterface for DrivenContacts {
    type Event = BrokenContacts;
    type State = LatticeState;

    const MAGNITUDE: &'static str = "size";
    const WHOLE: bool = true;
    const TRACE: &'static [Column] =
        &[Column::new("force", "force of all contacts", Quantity::Force, &["point"])];
    const MAPS: &'static [Column] =
        &[Column::new("cell_force", "force of a contact", Quantity::Force, &["map_drive", "cell"])];

    fn drive(&self) -> f64 {
        self.lattice.drive()
    }

    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(BrokenContacts),
    ) -> Result<bool> {
        for _ in 0..most {
            if self.lattice.next_drive() > to {
                return self.lattice.run_with(Until::Drive(to), monitor, &mut |_| ()).map(|()| true);
            }
            each(self.next(monitor)?);
        }
        Ok(false)
    }

    /// Each cell is one contact. In addition to the columns of all interfaces there are `size` (breaks) and `released`.
    fn columns(&self, events: &[BrokenContacts]) -> Record {
        let avalanches: Vec<_> = events.iter().map(|event| event.avalanche).collect();
        event_columns(&avalanches, self.lattice.size())
    }

    fn slipped(&self, events: &[BrokenContacts], first: usize) -> Record {
        broken_columns(events, first)
    }

    fn error(&self) -> Option<f64> {
        None
    }

    fn time(&self) -> f64 {
        0.0
    }

    fn force(&self) -> f64 {
        self.lattice.force()
    }

    fn forces(&self) -> Vec<f64> {
        self.lattice.forces()
    }

    fn positions(&self) -> Option<Vec<f64>> {
        None
    }

    fn energy(&self) -> Option<EnergyBalance> {
        None
    }

    fn trace(&self) -> Vec<f64> {
        vec![self.force()]
    }

    fn maps(&self) -> Vec<Vec<f64>> {
        vec![self.forces()]
    }

    fn state(&self) -> LatticeState {
        self.lattice.state()
    }

    fn restore(&mut self, state: LatticeState, _monitor: &mut dyn Monitor) -> Result<()> {
        self.lattice.restore(state)
    }
}

/// Avalanches on a lattice of `size` contacts as columns.
pub fn event_columns(avalanches: &[Avalanche], size: usize) -> Record {
    let mut record = lattice::record(avalanches);
    for variable in record.variables.iter_mut().filter(|variable| variable.name == "area") {
        variable.name = "cells".into();
    }
    let broken = avalanches.iter().map(|event| event.size as f64 / size as f64).collect();
    record.push("broken_fraction", "breaks per contact", Quantity::Number, &["event"], broken);
    record
}

/// Contacts that broke in events, as columns. The first event has the number `first`.
pub fn broken_columns(events: &[BrokenContacts], first: usize) -> Record {
    let mut record = Record::default();
    let numbered = || events.iter().zip(first..);
    let number = |(event, number): (&BrokenContacts, usize)| vec![number as f64; event.scar.len()];
    let mut add = |name, words, values| record.push(name, words, Quantity::Count, &["slipped"], values);
    add("slipped_event", "event in which contacts broke", numbered().flat_map(number).collect());
    let scars = events.iter().flat_map(|event| &event.scar);
    add("slipped_cell", "contacts that broke in it", scars.map(|&cell| cell as f64).collect());
    record
}
