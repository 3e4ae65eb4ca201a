//! Cells that move in time as an interface that is driven at a velocity, or along a protocol.

use serde::{Deserialize, Serialize};

use crate::elastic::{Event, RateDependentInterface, RateDependentInterfaceState, SlipRates, Slipped};
use crate::energy::EnergyBalance;
use crate::error::{not_negative, positive};
use crate::history::{History, LoadPointSegment};
use crate::master::Tolerance;
use crate::monitor::{Aside, Monitor};
use crate::record::{Column, Quantity, Record};
use crate::scenario::{self, CellStart, Model};
use crate::{Error, Result};

use super::cells::{from_slide_to_slide, slipped};
use super::model::DrivenInterface;
use crate::task::finite_size_tolerance;

/// Cells that move in time, coupled by the elasticity of the slider.
#[derive(Debug)]
pub struct DrivenRateDependentCells {
    /// The cells.
    pub interface: RateDependentInterface,
    /// The drive at the start.
    origin: f64,
    motion: LoadPointMotion,
    /// By what the error of the forces is estimated, if it is.
    second: Option<SecondSolution>,
}

/// The same cells with larger tolerances.
#[derive(Debug)]
struct SecondSolution {
    rough: Box<DrivenRateDependentCells>,
    /// Largest difference of the force of a cell so far.
    error: f64,
    /// The accuracy that is required, and the unit of force for it.
    required: (Tolerance, f64),
}

/// The state of cells that move in time, with that of the cells by which their error is estimated.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct DrivenRateDependentState {
    interface: RateDependentInterfaceState,
    /// The second solution, and the largest difference from it so far.
    second: Option<(RateDependentInterfaceState, f64)>,
}

/// The motion of the load point.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum LoadPointMotion {
    /// At one velocity, to any drive.
    Velocity(f64),
    /// Along a history that begins at the start.
    History(History),
}

impl LoadPointMotion {
    /// The motion of `[drive]`.
    ///
    /// # Errors
    /// No velocity.
    pub(super) fn of(task: &scenario::Drive) -> Result<Self> {
        task.velocity
            .map(Self::Velocity)
            .ok_or_else(|| Error::invalid("drive.velocity", "a velocity above 0", "none"))
    }
}

impl DrivenRateDependentCells {
    /// Cells at their start, whose load point will move.
    pub fn new(interface: RateDependentInterface, motion: LoadPointMotion) -> Self {
        Self { origin: interface.drive(), interface, motion, second: None }
    }

    /// The cells that `interface` describes, with an estimate of the error if an accuracy is required: by a second solution with
    /// larger tolerances, along `rough_motion` if this is another one, of fewer pieces.
    ///
    /// # Errors
    /// Those of [`scenario::Interface::in_time`].
    pub(super) fn of(
        model: &Model,
        interface: &scenario::Interface,
        (motion, rough_motion): (LoadPointMotion, Option<LoadPointMotion>),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let cells = cells_in_time(model, interface, monitor)?;
        let rough = if model.estimates_error_of_cells() {
            let aside = &mut Aside { fraction: 1.0, monitor };
            cells.rough(interface.elasticity(aside)?, aside)?
        } else {
            None
        };
        let unit = model.stiffness() * model.contacts.thresholds.mean();
        let second = rough.map(|rough| SecondSolution {
            rough: Box::new(Self::new(rough, rough_motion.unwrap_or_else(|| motion.clone()))),
            error: 0.0,
            required: (model.master_equation.tolerance(), unit),
        });
        let cells = match interface.slip_rates {
            Some(most) => cells.with_slip_rates(most),
            None => cells,
        };
        Ok(Self { second, ..Self::new(cells, motion) })
    }

    /// Velocity of the load point; `None` along a history.
    pub fn velocity(&self) -> Option<f64> {
        match self.motion {
            LoadPointMotion::Velocity(velocity) => Some(velocity),
            LoadPointMotion::History(_) => None,
        }
    }

    /// The load point continues at a velocity.
    ///
    /// # Errors
    /// A velocity that is not above 0.
    pub fn set_velocity(&mut self, velocity: f64) -> Result<()> {
        positive("velocity", velocity)?;
        self.motion = LoadPointMotion::Velocity(velocity);
        Ok(())
    }

    /// Holds the load point for a duration, through the events that end in it, which are returned.
    ///
    /// # Errors
    /// A duration that is not a finite number, 0 or above; those of [`RateDependentInterface::follow_with`].
    pub fn hold_with(
        &mut self,
        duration: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<(Event, Vec<Slipped>)>> {
        not_negative("duration", duration)?;
        let (time, drive) = (self.interface.time(), self.interface.drive());
        let pulled = self.velocity().unwrap_or(f64::INFINITY);
        let (segment, end) = (LoadPointSegment { time, drive, velocity: 0.0, pulled }, time + duration);
        let mut events = Vec::new();
        while self.interface.time() < end {
            events.extend(self.interface.follow_with(&segment, end, monitor)?);
        }
        Ok(events)
    }

    /// Moves the second solution to where this one is, and compares the forces. Along a ramp in fewer pieces it is there at
    /// another time. A long run that is not accurate enough ends here rather than at its end.
    fn compare(&mut self, to: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let Some(SecondSolution { rough, error, required }) = &mut self.second else { return Ok(()) };
        let aside = &mut Aside { fraction: 1.0, monitor };
        let (to, ramp) = match (&self.motion, &rough.motion) {
            (LoadPointMotion::History(own), LoadPointMotion::History(coarse)) if own != coarse => {
                let arrival = coarse.arrival(own.position(to.min(own.duration())), to);
                (arrival.max(rough.interface.time()), ", along ramps in pieces of constant velocity")
            }
            _ => (to, ""),
        };
        while !rough.next_in(to, aside)?.is_empty() {}
        let forces = self.interface.forces().into_iter().zip(rough.interface.forces());
        *error = forces.map(|(fine, rough)| (fine - rough).abs()).fold(*error, f64::max);
        let what = || format!("the force of a cell at a drive of {}{ramp}", rough.drive());
        required.0.allows(*error / required.1, what).map_err(Error::of_scenario)
    }

    /// Follows the pieces of a history to the time `to`, or until events have ended, which it returns.
    fn next_in(&mut self, to: f64, monitor: &mut dyn Monitor) -> Result<Vec<(Event, Vec<Slipped>)>> {
        let Self { interface, origin, motion, .. } = self;
        let history = match motion {
            LoadPointMotion::Velocity(velocity) => return interface.next_with(to, *velocity, monitor),
            LoadPointMotion::History(history) => history,
        };
        let to = to.min(history.duration());
        loop {
            let piece = history.piece_at(interface.time());
            let end = history.knots()[piece + 1].0.min(to);
            // Progress goes from one call of this function to the next.
            let aside = &mut Aside { fraction: 0.0, monitor };
            let events = interface.follow_with(&history.segment(piece, *origin), end, aside)?;
            if !events.is_empty() || interface.time() >= to {
                return Ok(events);
            }
        }
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
    let Model { contacts, initial, steady, .. } = model;
    let tolerance = model.master_equation.tolerance_of_a_block();
    let (step, ensemble) = (model.master_equation.step_of_a_cell(), model.ensemble.as_ref());
    let relative = ensemble.map_or(step, |ensemble| finite_size_tolerance(ensemble.size()).max(step));
    let step = relative * contacts.thresholds.mean();
    // The stretches of athermal contacts in steady sliding are initial ones.
    let steady = steady.filter(|_| contacts.rules.are_time_dependent());
    let start = steady.map_or(CellStart::Initial(initial), CellStart::Steady);
    interface.in_time(contacts, start, tolerance, step, ensemble, monitor)
}

impl DrivenInterface for DrivenRateDependentCells {
    type Event = (Event, Vec<Slipped>);
    type State = DrivenRateDependentState;

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

    fn progress(&self) -> f64 {
        match self.motion {
            LoadPointMotion::Velocity(_) => self.drive(),
            LoadPointMotion::History(_) => self.time(),
        }
    }

    fn origin(&self) -> f64 {
        self.origin
    }

    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(Self::Event),
    ) -> Result<bool> {
        let reached = from_slide_to_slide(most, || self.next_in(to, monitor), each)?;
        if reached {
            self.compare(to, monitor)?;
        }
        Ok(reached)
    }

    fn last_events(&mut self) -> Vec<Self::Event> {
        self.interface.last_events()
    }

    fn unfinished_events(&self) -> usize {
        self.interface.unfinished_events()
    }

    fn columns(&self, events: &[Self::Event]) -> Record {
        self.interface.record(&events.iter().map(|event| event.0).collect::<Vec<_>>())
    }

    fn slipped(&self, events: &[Self::Event], first: usize) -> Record {
        slipped(events, first, true)
    }

    fn error(&self) -> Option<f64> {
        self.second.as_ref().map(|second| second.error)
    }

    fn time(&self) -> f64 {
        self.interface.time()
    }

    fn slip_rates(&self) -> Option<&SlipRates> {
        self.interface.slip_rates()
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
        vec![self.time(), interface.mean_position(), interface.mean_velocity(), self.force()]
    }

    fn maps(&self) -> Vec<Vec<f64>> {
        vec![self.interface.positions(), self.interface.velocities(), self.forces()]
    }

    fn state(&self) -> DrivenRateDependentState {
        let kept = |second: &SecondSolution| (second.rough.interface.state(), second.error);
        DrivenRateDependentState { interface: self.interface.state(), second: self.second.as_ref().map(kept) }
    }

    fn restore(&mut self, state: DrivenRateDependentState, monitor: &mut dyn Monitor) -> Result<()> {
        let DrivenRateDependentState { interface, second } = state;
        if let Some((own, (kept, error))) = self.second.as_mut().zip(second) {
            own.rough.interface.restore_with(kept, monitor)?;
            own.error = error;
        }
        self.interface.restore_with(interface, monitor)
    }
}
