//! What a simulation advances in time: a slider block, or a rigid slider, over contacts that move at a velocity.

use asperity::block::BlockMotion;
use asperity::master::Stretches;
use asperity::monitor::Monitor;
use asperity::rate_dependent::{ContactsState, RateDependentContacts};
use asperity::record::Record;
use asperity::{Error, Result};

use crate::simulated::{Energy, MovedInTime, Simulated, forward, read_with, write};
use crate::stretches::StretchGrid;

/// A slider block in time, whose load point moves at a velocity.
pub struct BlockInTime {
    motion: BlockMotion,
    velocity: f64,
}

impl BlockInTime {
    /// The block, whose load point will move at a velocity.
    ///
    /// # Errors
    /// A velocity that is not above 0.
    pub fn new(motion: BlockMotion, velocity: f64) -> Result<Self> {
        Ok(Self { motion, velocity: checked(velocity)? })
    }
}

fn checked(velocity: f64) -> Result<f64> {
    if velocity > 0.0 && velocity.is_finite() {
        return Ok(velocity);
    }
    Err(Error::invalid("velocity", "a finite number above 0", velocity))
}

impl Simulated for BlockInTime {
    fn cells(&self) -> usize {
        1
    }

    fn drive(&self) -> f64 {
        self.motion.moment().drive
    }

    fn time(&self) -> f64 {
        self.motion.moment().time
    }

    fn force(&self) -> f64 {
        self.motion.moment().force
    }

    fn forces(&self) -> Vec<f64> {
        vec![self.force()]
    }

    fn positions(&self) -> Option<Vec<f64>> {
        Some(vec![self.motion.moment().position])
    }

    fn energy(&self) -> Result<Option<Energy>> {
        Ok(Some(Energy::Slider(self.motion.energy())))
    }

    fn stretch_density(
        &self,
        _: usize,
        grid: StretchGrid,
        _: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, Stretches)> {
        grid.count(&self.motion.stretches())
    }

    fn check(&self, key: &str, until: f64) -> Result<()> {
        forward(key, self.drive(), until)
    }

    fn next_event(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Record> {
        let slip = self.motion.next_with(until, self.velocity, monitor)?;
        Ok(self.motion.record(slip.as_slice()))
    }

    fn advance(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<()> {
        while self.motion.next_with(until, self.velocity, monitor)?.is_some() {}
        Ok(())
    }

    fn in_time(&mut self) -> Option<&mut dyn MovedInTime> {
        Some(self)
    }

    fn write_state(&self, into: &mut Vec<u8>) {
        write(&self.motion.state(), into);
    }

    fn restore_state(&mut self, from: &[u8], monitor: &mut dyn Monitor) -> Result<()> {
        self.motion.restore(read_with(from, monitor)?)
    }
}

impl MovedInTime for BlockInTime {
    fn velocity(&self) -> f64 {
        self.velocity
    }

    fn set_velocity(&mut self, velocity: f64) -> Result<()> {
        self.velocity = checked(velocity)?;
        Ok(())
    }

    fn velocities(&self) -> Vec<f64> {
        vec![self.motion.moment().velocity]
    }

    fn hold(&mut self, duration: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.motion.hold_with(duration, monitor).map(drop)
    }
}

/// Time-dependent contacts under a rigid slider, which moves at a velocity.
pub struct ContactsInTime {
    contacts: Box<dyn RateDependentContacts>,
    /// The drive that was asked for last, from which the position of the contacts differs by rounding.
    drive: f64,
    velocity: f64,
    /// Whether the slider is held.
    held: bool,
}

impl ContactsInTime {
    /// The contacts, which the slider will move at a velocity.
    ///
    /// # Errors
    /// A velocity that is not above 0.
    pub fn new(contacts: Box<dyn RateDependentContacts>, velocity: f64) -> Result<Self> {
        let held = contacts.steady_velocity().is_none();
        Ok(Self { drive: contacts.position(), contacts, velocity: checked(velocity)?, held })
    }

    /// Moves by a displacement in a time; after an error the contacts are where they were.
    fn step(&mut self, by: f64, during: f64, monitor: &mut dyn Monitor) -> Result<()> {
        if during > 0.0 {
            let mut contacts = self.contacts.copy();
            contacts.step(by, during, monitor)?;
            (self.contacts, self.held) = (contacts, by == 0.0);
        }
        if monitor.progress(1.0).is_break() { Err(Error::Stopped) } else { Ok(()) }
    }
}

impl Simulated for ContactsInTime {
    fn cells(&self) -> usize {
        1
    }

    fn drive(&self) -> f64 {
        self.drive
    }

    fn time(&self) -> f64 {
        self.contacts.time()
    }

    fn force(&self) -> f64 {
        self.contacts.force() + self.contacts.free_friction().viscosity * self.velocities()[0]
    }

    fn forces(&self) -> Vec<f64> {
        vec![self.force()]
    }

    fn positions(&self) -> Option<Vec<f64>> {
        Some(vec![self.drive])
    }

    /// The work of a rigid slider is not integrated.
    fn energy(&self) -> Result<Option<Energy>> {
        Ok(None)
    }

    fn stretch_density(
        &self,
        _: usize,
        grid: StretchGrid,
        _: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, Stretches)> {
        grid.count(&self.contacts.stretches())
    }

    fn check(&self, key: &str, until: f64) -> Result<()> {
        forward(key, self.drive(), until)
    }

    /// Contacts break all the time, without events.
    fn next_event(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Record> {
        self.advance(until, monitor)?;
        Ok(Record::default())
    }

    fn advance(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let by = (until - self.contacts.position()).max(0.0);
        self.step(by, by / self.velocity, monitor)?;
        self.drive = until;
        Ok(())
    }

    fn in_time(&mut self) -> Option<&mut dyn MovedInTime> {
        Some(self)
    }

    fn write_state(&self, into: &mut Vec<u8>) {
        write(&(self.drive, self.held, self.contacts.state()), into);
    }

    fn restore_state(&mut self, from: &[u8], monitor: &mut dyn Monitor) -> Result<()> {
        let (drive, held, state): (f64, bool, ContactsState) = read_with(from, monitor)?;
        let mut contacts = self.contacts.copy();
        contacts.restore(&state)?;
        (self.contacts, self.drive, self.held) = (contacts, drive, held);
        Ok(())
    }
}

impl MovedInTime for ContactsInTime {
    fn velocity(&self) -> f64 {
        self.velocity
    }

    fn set_velocity(&mut self, velocity: f64) -> Result<()> {
        self.velocity = checked(velocity)?;
        Ok(())
    }

    fn velocities(&self) -> Vec<f64> {
        vec![if self.held { 0.0 } else { self.velocity }]
    }

    fn hold(&mut self, duration: f64, monitor: &mut dyn Monitor) -> Result<()> {
        if !(duration >= 0.0 && duration.is_finite()) {
            return Err(Error::invalid("duration", "a finite number, 0 or above", duration));
        }
        self.step(0.0, duration, monitor)
    }
}
