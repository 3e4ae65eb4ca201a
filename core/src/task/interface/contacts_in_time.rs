//! Contacts coupled one by one that move in time, at a velocity or along a protocol.

use crate::energy::EnergyBalance;
use crate::ensemble::lattice::{self, LatticeState, Until};
use crate::error::{not_negative, positive};
use crate::monitor::Monitor;
use crate::record::{Column, Quantity, Record};
use crate::{Error, Result};

use super::contacts::{BrokenContacts, DrivenContacts};
use super::in_time::LoadPointMotion;
use super::model::DrivenInterface;

/// How far below the end of a piece its time may be, relative to it, when the drive has reached that end: a few roundings of
/// products and quotients of the velocity.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Contacts coupled one by one on a lattice, in time.
#[derive(Debug)]
pub struct DrivenContactsInTime {
    contacts: DrivenContacts,
    motion: LoadPointMotion,
}

impl DrivenContactsInTime {
    /// Contacts at their start, which move as the load point does.
    pub fn new(contacts: DrivenContacts, motion: LoadPointMotion) -> Self {
        Self { contacts, motion }
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
    /// A velocity that is not above 0; stopped by the monitor.
    pub fn set_velocity_with(&mut self, velocity: f64, monitor: &mut dyn Monitor) -> Result<()> {
        positive("velocity", velocity)?;
        // Next breaks are computed again at another velocity only, so that a restored state goes on bit for bit.
        if self.contacts.lattice.velocity() != Some(velocity) {
            self.contacts.lattice.set_velocity_with(velocity, monitor)?;
        }
        self.motion = LoadPointMotion::Velocity(velocity);
        Ok(())
    }

    /// Holds the load point for a duration, through the events in it.
    ///
    /// # Errors
    /// A duration that is not a finite number, 0 or above; a load point along a history; stopped by the monitor, after which the load
    /// point moves on from there.
    pub fn hold_with(&mut self, duration: f64, monitor: &mut dyn Monitor) -> Result<()> {
        not_negative("duration", duration)?;
        let Some(velocity) = self.velocity() else {
            return Err(Error::invalid("duration", "none along a history", duration));
        };
        let lattice = &mut self.contacts.lattice;
        let end = lattice.time() + duration;
        lattice.set_velocity_with(0.0, monitor)?;
        lattice.run_with(Until::Time(end), monitor, &mut |_| ())?;
        lattice.set_velocity_with(velocity, monitor)
    }

    /// Goes on to `until`, or through the next event before it; returns whether it got there.
    fn next(
        &mut self,
        until: Until,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(BrokenContacts),
    ) -> Result<bool> {
        let lattice = &mut self.contacts.lattice;
        let beyond = match until {
            Until::Time(time) => lattice.next_time() > time,
            Until::Drive(drive) => lattice.next_drive() > drive,
            Until::Events(_) => false,
        };
        if beyond {
            return lattice.run_with(until, monitor, &mut |_| ()).map(|()| true);
        }
        each(self.contacts.next(monitor)?);
        Ok(false)
    }
}

impl DrivenInterface for DrivenContactsInTime {
    type Event = BrokenContacts;
    type State = LatticeState;

    const MAGNITUDE: &'static str = DrivenContacts::MAGNITUDE;
    const WHOLE: bool = true;
    const CLOCK: &'static str = "time";
    const TRACE: &'static [Column] = &[
        Column::new("time", "time", Quantity::Time, &["point"]),
        Column::new("force", "force of all contacts", Quantity::Force, &["point"]),
    ];
    const MAPS: &'static [Column] = DrivenContacts::MAPS;

    fn drive(&self) -> f64 {
        self.contacts.drive()
    }

    fn progress(&self) -> f64 {
        match self.motion {
            LoadPointMotion::Velocity(_) => self.drive(),
            LoadPointMotion::History(_) => self.time(),
        }
    }

    fn advance(
        &mut self,
        to: f64,
        most: u64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(BrokenContacts),
    ) -> Result<bool> {
        for _ in 0..most {
            let history = match &self.motion {
                LoadPointMotion::Velocity(velocity) => {
                    // A hold that was stopped has left the contacts at rest.
                    let lattice = &mut self.contacts.lattice;
                    if lattice.velocity() != Some(*velocity) && !lattice.is_within_avalanche() {
                        lattice.set_velocity_with(*velocity, monitor)?;
                    }
                    if self.next(Until::Drive(to), monitor, each)? {
                        return Ok(true);
                    }
                    continue;
                }
                LoadPointMotion::History(history) => history,
            };
            let lattice = &mut self.contacts.lattice;
            // A time that was reached along the drive is right to rounding.
            let piece = history.piece_at(lattice.time() * (1.0 + ROUNDING));
            let end = history.knots()[piece + 1].0.min(to);
            let velocity = history.pieces()[piece].velocity;
            if lattice.velocity() != Some(velocity) {
                lattice.set_velocity_with(velocity, monitor)?;
            }
            if self.next(Until::Time(end), monitor, each)? && end >= to {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Those of contacts without time, with `time` and `age`.
    fn columns(&self, events: &[BrokenContacts]) -> Record {
        let mut record = self.contacts.columns(events);
        let avalanches: Vec<_> = events.iter().map(|event| event.avalanche).collect();
        record.variables.extend(lattice::record_in_time(&avalanches).variables);
        record
    }

    fn slipped(&self, events: &[BrokenContacts], first: usize) -> Record {
        self.contacts.slipped(events, first)
    }

    fn error(&self) -> Option<f64> {
        None
    }

    fn time(&self) -> f64 {
        self.contacts.lattice.time()
    }

    fn force(&self) -> f64 {
        self.contacts.force()
    }

    fn forces(&self) -> Vec<f64> {
        self.contacts.forces()
    }

    fn positions(&self) -> Option<Vec<f64>> {
        None
    }

    fn energy(&self) -> Option<EnergyBalance> {
        None
    }

    fn trace(&self) -> Vec<f64> {
        vec![self.time(), self.force()]
    }

    fn maps(&self) -> Vec<Vec<f64>> {
        self.contacts.maps()
    }

    fn state(&self) -> LatticeState {
        self.contacts.state()
    }

    fn restore(&mut self, state: LatticeState, monitor: &mut dyn Monitor) -> Result<()> {
        self.contacts.restore(state, monitor)
    }
}
