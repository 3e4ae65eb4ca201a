//! Contacts coupled one by one as an interface: an event is an avalanche.

use asperity::Result;
use asperity::ensemble::lattice::{self, Avalanche, Lattice, State, Until};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};

use super::model::{Map, Model};

impl Model for Lattice {
    type Event = Avalanche;
    type State = State;

    const MAGNITUDE: &'static str = "size";
    const WHOLE: bool = true;
    const MAPS: &'static [Map] =
        &[Map { name: "cell_force", long_name: "force of a contact", quantity: Quantity::Force }];

    fn drive(&self) -> f64 {
        self.drive()
    }

    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(Avalanche),
    ) -> Result<bool> {
        for _ in 0..most {
            if self.next_drive() > to {
                return self.run(Until::Drive(to), monitor, &mut |_| ()).map(|()| true);
            }
            each(self.next_event());
        }
        Ok(false)
    }

    /// Cells are contacts; beside the columns of all interfaces there are `size`, breaks, and `released`.
    fn columns(&self, events: &[Avalanche]) -> Record {
        let mut record = lattice::record(events);
        for variable in record.variables.iter_mut().filter(|variable| variable.name == "area") {
            variable.name = "cells".into();
        }
        let share = events.iter().map(|event| event.size as f64 / self.size() as f64).collect();
        record.push("broken_fraction", "breaks per contact", Quantity::Number, &["event"], share);
        record
    }

    fn maps(&self) -> Vec<Vec<f64>> {
        vec![self.forces()]
    }

    fn state(&self) -> State {
        self.state()
    }

    fn restore(&mut self, state: State) -> Result<()> {
        self.restore(state)
    }
}
