//! Contacts coupled one by one as an interface: an event is an avalanche.

use asperity::Result;
use asperity::ensemble::lattice::{self, Avalanche, Lattice, State, Until};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};

use super::model::{Column, Model};

/// An avalanche, and the contacts that broke in it.
pub struct Broken {
    avalanche: Avalanche,
    scar: Vec<usize>,
}

impl Model for Lattice {
    type Event = Broken;
    type State = State;

    const MAGNITUDE: &'static str = "size";
    const WHOLE: bool = true;
    const TRACE: &'static [Column] =
        &[Column { name: "force", long_name: "force of all contacts", quantity: Quantity::Force }];
    const MAPS: &'static [Column] =
        &[Column { name: "cell_force", long_name: "force of a contact", quantity: Quantity::Force }];

    fn drive(&self) -> f64 {
        self.drive()
    }

    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(Broken),
    ) -> Result<bool> {
        for _ in 0..most {
            if self.next_drive() > to {
                return self.run(Until::Drive(to), monitor, &mut |_| ()).map(|()| true);
            }
            let avalanche = self.next_event();
            each(Broken { avalanche, scar: self.scar().collect() });
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
        let share = avalanches.iter().map(|event| event.size as f64 / self.size() as f64).collect();
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

    fn trace(&mut self) -> Result<Vec<f64>> {
        Ok(vec![self.force()])
    }

    fn maps(&mut self) -> Result<Vec<Vec<f64>>> {
        Ok(vec![self.forces()])
    }

    fn state(&self) -> State {
        self.state()
    }

    fn restore(&mut self, state: State) -> Result<()> {
        self.restore(state)
    }
}
