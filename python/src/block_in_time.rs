//! A slider block in time, as a simulation advances it.

use asperity::block::BlockMotion;
use asperity::master::Stretches;
use asperity::monitor::Monitor;
use asperity::record::Record;
use asperity::{Error, Result};

use crate::simulated::{Energy, MovedInTime, Simulated, forward, read, write};
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

    fn restore_state(&mut self, from: &[u8], _: &mut dyn Monitor) -> Result<()> {
        self.motion.restore(read(&mut &*from)?)
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
