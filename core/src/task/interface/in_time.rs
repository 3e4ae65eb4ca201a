//! Cells with time-dependent contacts as an interface that is driven at a velocity.

use crate::elastic::{Event, RateDependentInterface, RateDependentInterfaceState, Slipped};
use crate::energy::EnergyBalance;
use crate::monitor::Monitor;
use crate::record::{Column, Quantity, Record};
use crate::scenario::{self, Model};
use crate::{Error, Result};

use super::cells::{from_slide_to_slide, mean, slipped};
use super::model::DrivenInterface;
use crate::task::finite_size_tolerance;

/// Cells with time-dependent contacts, coupled by the elasticity of the slider.
#[derive(Debug)]
pub struct DrivenRateDependentCells {
    /// The cells.
    pub interface: RateDependentInterface,
    /// Velocity of the drive.
    pub velocity: f64,
}

impl DrivenRateDependentCells {
    /// The cells that `interface` describes, driven as `task` says.
    ///
    /// # Errors
    /// No velocity; those of [`scenario::Interface::in_time`].
    pub(super) fn new(
        model: &Model,
        task: &scenario::Drive,
        interface: &scenario::Interface,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let Some(velocity) = task.velocity else {
            return Err(Error::invalid("drive.velocity", "a velocity above 0", "none"));
        };
        let interface = cells_in_time(model, interface, monitor)?;
        // The error estimate moves copies of all contacts, so it is made only if an accuracy is required.
        let required = model.master_equation.tolerance.is_some() && model.ensemble.is_none();
        let interface = if required { interface.with_error() } else { interface };
        Ok(Self { interface, velocity })
    }
}

/// The cells that `interface` describes, with the contacts and the accuracy of `model`.
///
/// # Errors
/// Those of [`scenario::Interface::in_time`].
pub fn cells_in_time(
    model: &Model,
    interface: &scenario::Interface,
    monitor: &mut dyn Monitor,
) -> Result<RateDependentInterface> {
    let Model { contacts, initial, .. } = model;
    let tolerance = model.master_equation.tolerance_of_a_block();
    let ensemble = model.ensemble.as_ref();
    let relative =
        ensemble.map_or(tolerance, |ensemble| finite_size_tolerance(ensemble.size()).max(tolerance));
    let step = relative * contacts.thresholds.mean();
    interface.in_time(contacts, initial, tolerance, step, ensemble, monitor)
}

impl DrivenInterface for DrivenRateDependentCells {
    type Event = (Event, Vec<Slipped>);
    type State = RateDependentInterfaceState;

    const MAGNITUDE: &'static str = "moment";
    const WHOLE: bool = false;
    const TRACE: &'static [Column] = &[
        Column::new("time", "time", Quantity::Time, &["point"]),
        Column::new("position", "mean position of the cells", Quantity::Length, &["point"]),
        Column::new("velocity", "mean velocity of the cells", Quantity::Velocity, &["point"]),
        Column::new("force", "friction force of all cells", Quantity::Force, &["point"]),
    ];
    const MAPS: &'static [Column] = &[
        Column::new("cell_position", "position of a cell", Quantity::Length, &["map_drive", "cell"]),
        Column::new("cell_velocity", "velocity of a cell", Quantity::Velocity, &["map_drive", "cell"]),
        Column::new("cell_force", "friction force of a cell", Quantity::Force, &["map_drive", "cell"]),
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
        from_slide_to_slide(most, || self.interface.next_with(to, self.velocity, monitor), each)
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

    fn time(&self) -> f64 {
        self.interface.time()
    }

    fn force(&self) -> f64 {
        self.interface.force()
    }

    fn forces(&self) -> Vec<f64> {
        self.interface.forces()
    }

    fn positions(&self) -> Option<Vec<f64>> {
        Some(self.interface.positions())
    }

    fn energy(&self) -> Option<EnergyBalance> {
        Some(self.interface.energy())
    }

    fn trace(&self) -> Vec<f64> {
        let Self { interface, .. } = self;
        vec![self.time(), mean(&interface.positions()), mean(&interface.velocities()), self.force()]
    }

    fn maps(&self) -> Vec<Vec<f64>> {
        vec![self.interface.positions(), self.interface.velocities(), self.forces()]
    }

    fn state(&self) -> RateDependentInterfaceState {
        self.interface.state()
    }

    fn restore(&mut self, state: RateDependentInterfaceState, _monitor: &mut dyn Monitor) -> Result<()> {
        self.interface.restore(state)
    }
}
