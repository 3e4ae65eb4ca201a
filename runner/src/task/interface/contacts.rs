//! Contacts coupled one by one as an interface: an event is an avalanche.

use asperity::Result;
use asperity::ensemble::lattice::{self, Avalanche, Lattice, LatticeState, Until};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};

use super::model::{Column, Model};

/// An avalanche, and the contacts that broke in it.
pub struct Broken {
    avalanche: Avalanche,
    scar: Vec<usize>,
}

/// Contacts on a lattice.
pub struct Contacts {
    /// The contacts.
    pub lattice: Lattice,
    /// Whether they lie on a chain, of which it is told which ones break.
    pub chain: bool,
}

impl Model for Contacts {
    type Event = Broken;
    type State = LatticeState;

    const MAGNITUDE: &'static str = "size";
    const WHOLE: bool = true;
    const TRACE: &'static [Column] =
        &[Column { name: "force", long_name: "force of all contacts", quantity: Quantity::Force }];
    const MAPS: &'static [Column] =
        &[Column { name: "cell_force", long_name: "force of a contact", quantity: Quantity::Force }];

    fn drive(&self) -> f64 {
        self.lattice.drive()
    }

    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(Broken),
    ) -> Result<bool> {
        for _ in 0..most {
            if self.lattice.next_drive() > to {
                return self.lattice.run(Until::Drive(to), monitor, &mut |_| ()).map(|()| true);
            }
            let avalanche = self.lattice.next_event();
            let scar = if self.chain { self.lattice.scar().collect() } else { Vec::new() };
            each(Broken { avalanche, scar });
        }
        Ok(false)
    }

    /// Cells are contacts; beside the columns of all interfaces there are `size`, breaks, and `released`.
    fn columns(&self, events: &[Broken]) -> Record {
        let avalanches: Vec<_> = events.iter().map(|event| event.avalanche).collect();
        let mut record = lattice::record(&avalanches);
        for variable in record.variables.iter_mut().filter(|variable| variable.name == "area") {
            variable.name = "cells".into();
        }
        let share = avalanches.iter().map(|event| event.size as f64 / self.lattice.size() as f64).collect();
        record.push("broken_fraction", "breaks per contact", Quantity::Number, &["event"], share);
        record
    }

    fn slipped(&self, events: &[Broken], first: usize) -> Record {
        let mut record = Record::default();
        let numbered = || events.iter().zip(first..);
        let number = |(event, number): (&Broken, usize)| vec![number as f64; event.scar.len()];
        let mut add = |name, words, values| record.push(name, words, Quantity::Number, &["slipped"], values);
        add("slipped_event", "event in which contacts broke", numbered().flat_map(number).collect());
        let scars = events.iter().flat_map(|event| &event.scar);
        add("slipped_cell", "contacts that broke in it", scars.map(|&cell| cell as f64).collect());
        record
    }

    fn error(&self) -> Option<f64> {
        None
    }

    fn trace(&mut self) -> Result<Vec<f64>> {
        Ok(vec![self.lattice.force()])
    }

    fn maps(&mut self) -> Result<Vec<Vec<f64>>> {
        Ok(vec![self.lattice.forces()])
    }

    fn state(&self) -> LatticeState {
        self.lattice.state()
    }

    fn restore(&mut self, state: LatticeState, _monitor: &mut dyn Monitor) -> Result<()> {
        self.lattice.restore(state)
    }
}
