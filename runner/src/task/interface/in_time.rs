//! Cells whose contacts are time-dependent as an interface that is driven at a velocity.

use asperity::contacts::{Contacts, Initial};
use asperity::elastic::{Event, InterfaceInTime, Slipped, StateInTime};
use asperity::monitor::Monitor;
use asperity::record::{Quantity, Record};
use asperity::scenario::{self, Scenario};
use asperity::{Error, Result};

use super::cells::{from_slide_to_slide, slipped};
use super::model::{Column, Model};
use crate::task::{Setting, tolerance_over};

/// Cells in time on an elastic slider.
pub struct CellsInTime {
    /// The cells.
    pub interface: InterfaceInTime,
    /// Of the drive.
    pub velocity: f64,
}

impl CellsInTime {
    /// The cells that `interface` describes, driven as `task` says.
    ///
    /// # Errors
    /// What [`scenario::Interface::in_time`] refuses; no velocity.
    pub(super) fn new(
        setting: &Setting<'_>,
        task: &scenario::Drive,
        interface: &scenario::Interface,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let Setting { scenario, contacts, initial } = setting;
        let Some(velocity) = task.velocity else {
            return Err(Error::invalid("drive.velocity", "a velocity above 0", "none"));
        };
        let interface = cells_in_time(scenario, interface, contacts, initial, monitor)?;
        // What that takes is for those who ask.
        let required = scenario.master_equation.tolerance.is_some() && scenario.ensemble.is_none();
        let interface = if required { interface.with_error() } else { interface };
        Ok(Self { interface, velocity })
    }
}

/// The cells that the `interface` of a scenario describes, to the accuracy that it asks for.
///
/// # Errors
/// What [`scenario::Interface::in_time`] refuses.
pub fn cells_in_time(
    scenario: &Scenario,
    interface: &scenario::Interface,
    contacts: &Contacts,
    initial: &Initial,
    monitor: &mut dyn Monitor,
) -> Result<InterfaceInTime> {
    let tolerance = scenario.master_equation.tolerance_of_a_block();
    let ensemble = scenario.ensemble.as_ref();
    let share = ensemble.map_or(tolerance, |ensemble| tolerance_over(ensemble.size()).max(tolerance));
    let step = share * contacts.thresholds.mean();
    interface.in_time(contacts, initial, tolerance, step, ensemble, monitor)
}

impl Model for CellsInTime {
    type Event = (Event, Vec<Slipped>);
    type State = StateInTime;

    const MAGNITUDE: &'static str = "moment";
    const WHOLE: bool = false;
    const TRACE: &'static [Column] = &[
        Column { name: "time", long_name: "time", quantity: Quantity::Time },
        Column { name: "position", long_name: "mean position of the cells", quantity: Quantity::Length },
        Column { name: "velocity", long_name: "mean velocity of the cells", quantity: Quantity::Velocity },
        Column { name: "force", long_name: "friction force of all cells", quantity: Quantity::Force },
    ];
    const MAPS: &'static [Column] = &[
        Column { name: "cell_position", long_name: "position of a cell", quantity: Quantity::Length },
        Column { name: "cell_velocity", long_name: "velocity of a cell", quantity: Quantity::Velocity },
        Column { name: "cell_force", long_name: "friction force of a cell", quantity: Quantity::Force },
    ];

    fn drive(&self) -> f64 {
        self.interface.drive()
    }

    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(Self::Event),
    ) -> Result<bool> {
        from_slide_to_slide(most, || self.interface.next(to, self.velocity, monitor), each)
    }

    fn columns(&self, events: &[Self::Event]) -> Record {
        self.interface.record(&events.iter().map(|event| event.0).collect::<Vec<_>>())
    }

    fn slipped(&self, events: &[Self::Event], first: usize) -> Record {
        slipped(events, first, true)
    }

    fn error(&self) -> Option<f64> {
        self.interface.error()
    }

    fn trace(&mut self) -> Result<Vec<f64>> {
        let mean = |values: Vec<f64>| values.iter().sum::<f64>() / values.len() as f64;
        let Self { interface, .. } = self;
        let (position, velocity) = (mean(interface.positions()), mean(interface.velocities()));
        Ok(vec![interface.time(), position, velocity, interface.force()])
    }

    fn maps(&mut self) -> Result<Vec<Vec<f64>>> {
        let Self { interface, .. } = self;
        Ok(vec![interface.positions(), interface.velocities(), interface.forces()])
    }

    fn state(&self) -> StateInTime {
        self.interface.state()
    }

    fn restore(&mut self, state: StateInTime, _monitor: &mut dyn Monitor) -> Result<()> {
        self.interface.restore(state)
    }
}
