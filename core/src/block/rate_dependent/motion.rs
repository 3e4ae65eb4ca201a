//! A slider block in time that is moved step by step, from slip to slip, and can be observed in between.

use serde::{Deserialize, Serialize};

use super::log::{Log, events_record};
use super::sliding::SlidingBlock;
use super::{Block, Moment, RateDependentSlip};
use crate::dynamics::MotionState;
use crate::energy::EnergyBalance;
use crate::error::{not_negative, positive};
use crate::history::LoadPointSegment;
use crate::monitor::{Aside, Monitor, report};
use crate::rate_dependent::{RateDependentContacts, StretchInterval};
use crate::record::Record;
use crate::{Error, Result};

/// A slider block in time over time-dependent contacts, moved from slip to slip.
///
/// The motion is that of [`Block::follow`], and the velocity of the load point may be chosen at every step. Each stop ends a
/// step in time, so that stops change results within the tolerance.
///
/// ```
/// use std::sync::Arc;
/// use asperity::block::{Block, Loading, Slip};
/// use asperity::contacts::{Ageing, Contacts, Initial, Rules};
/// use asperity::law::{Gaussian, Point};
/// use asperity::master::Transport;
///
/// let ageing = Some(Ageing::Logarithmic { growth: 0.1, time: 1.0 });
/// let rules = Rules { ageing, ..Rules::default() };
/// let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// let transport = Transport::new(Contacts { rules, ..contacts }, &Initial::default())?;
/// let block = Block::new(Loading::Spring(0.5), Slip::Damped { damping: 0.01 }, None)?;
/// let mut slider = block.motion(&transport)?;
/// while let Some(slip) = slider.next(4.0, 0.1)? {
///     println!("at t = {:.2} the force drops by {:.3}", slip.before.time, slip.drop());
/// }
/// slider.hold(100.0)?;
/// assert_eq!((slider.moment().drive, slider.moment().time > 100.0), (4.0, true));
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug)]
pub struct BlockMotion {
    slider: SlidingBlock,
    log: Log,
    begun: EnergyBalance,
}

/// The state of a slider in time. A motion of the same description continues from it bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BlockMotionState {
    motion: MotionState,
    segment: LoadPointSegment,
    log: Log,
}

impl Block {
    /// The slider in equilibrium with `contacts` ([`RateDependentContacts::steady_velocity`]: at rest, or in steady sliding), to
    /// be moved step by step, with [`Block::TOLERANCE_IN_TIME`].
    ///
    /// # Errors
    /// As [`Block::follow`].
    pub fn motion(&self, contacts: &dyn RateDependentContacts) -> Result<BlockMotion> {
        self.motion_with(contacts, None)
    }

    /// The same with the largest error of a step in time, a length.
    ///
    /// # Errors
    /// As [`Self::motion`]; a tolerance that is not above 0.
    pub fn motion_with(
        &self,
        contacts: &dyn RateDependentContacts,
        tolerance: impl Into<Option<f64>>,
    ) -> Result<BlockMotion> {
        let slider = self.balanced(contacts, tolerance.into())?;
        let log = Log::new(&slider, self.slip_fraction.unwrap_or(0.0));
        Ok(BlockMotion { begun: slider.moment().energy, slider, log })
    }
}

impl BlockMotion {
    /// The present state of the slider: time, drive, position, velocity and forces.
    pub fn moment(&self) -> Moment {
        self.slider.moment()
    }

    /// Energies since the beginning.
    pub fn energy(&self) -> EnergyBalance {
        self.moment().energy - self.begun
    }

    /// The attached contacts as intervals of stretch; [`crate::rate_dependent::binned`] converts them to a density.
    pub fn stretches(&self) -> Vec<StretchInterval> {
        self.slider.cell().contacts.stretches()
    }

    /// Slips as columns, those of [`super::Slide::events_record`].
    pub fn record(&self, slips: &[RateDependentSlip]) -> Record {
        events_record(slips)
    }

    /// Moves the load point to `drive` at a velocity, or until a slip has ended, which is returned. A slip that has not ended
    /// continues in the next call.
    ///
    /// # Errors
    /// A drive behind the present one; a velocity that is not above 0; those of [`Block::follow`].
    pub fn next(&mut self, drive: f64, velocity: f64) -> Result<Option<RateDependentSlip>> {
        self.next_with(drive, velocity, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::next`]; stopped by the monitor, after which the slider is where the last step ended.
    pub fn next_with(
        &mut self,
        drive: f64,
        velocity: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<RateDependentSlip>> {
        positive("velocity", velocity)?;
        let here = self.slider.motion.drive;
        if !(drive >= here && drive.is_finite()) {
            return Err(Error::invalid("drive", format!("a finite number, {here} or above"), drive));
        }
        self.continue_at(velocity, velocity);
        let segment = self.slider.segment;
        let end = segment.time + (drive - segment.drive) / velocity;
        let slip = self.follow(end, monitor)?;
        // A slip may end in the last step, too.
        if self.slider.motion.time >= end {
            self.slider.motion.drive = drive;
            self.slider.begin_segment();
        }
        Ok(slip)
    }

    /// Holds the load point for a duration, through slips that begin or end in it, which are returned.
    ///
    /// # Errors
    /// A duration that is not a finite number, 0 or above; those of [`Block::follow`].
    pub fn hold(&mut self, duration: f64) -> Result<Vec<RateDependentSlip>> {
        self.hold_with(duration, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::hold`]; stopped by the monitor, after which the slider is where the last step ended.
    pub fn hold_with(&mut self, duration: f64, monitor: &mut dyn Monitor) -> Result<Vec<RateDependentSlip>> {
        not_negative("duration", duration)?;
        self.continue_at(0.0, self.slider.segment.pulled);
        let end = self.slider.motion.time + duration;
        let mut slips = Vec::new();
        while let Some(slip) = self.follow(end, monitor)? {
            slips.push(slip);
        }
        self.slider.begin_segment();
        Ok(slips)
    }

    /// The present state.
    pub fn state(&self) -> BlockMotionState {
        let SlidingBlock { motion, segment } = &self.slider;
        BlockMotionState { motion: motion.state(), segment: *segment, log: self.log.clone() }
    }

    /// Restores the state of a motion of the same description.
    ///
    /// # Errors
    /// A state of other contacts, after which nothing has changed.
    pub fn restore(&mut self, state: BlockMotionState) -> Result<()> {
        let BlockMotionState { motion, segment, log } = state;
        self.slider.motion.restore(motion, &mut ())?;
        (self.slider.segment, self.log) = (segment, log);
        Ok(())
    }

    /// The load point continues at a velocity, if it has not this velocity already; slips are ten times as fast as `pulled`.
    fn continue_at(&mut self, velocity: f64, pulled: f64) {
        let segment = &self.slider.segment;
        if (segment.velocity, segment.pulled) != (velocity, pulled) {
            self.slider.continue_at(velocity, pulled);
            self.log.begin_segment(&self.slider);
        }
    }

    /// Moves until the time `end`, or until a slip has ended.
    fn follow(&mut self, end: f64, monitor: &mut dyn Monitor) -> Result<Option<RateDependentSlip>> {
        let begin = self.slider.segment.time;
        while self.slider.motion.time < end {
            let fraction = (self.slider.motion.time - begin) / (end - begin);
            self.slider.step(end, &mut Aside { fraction, monitor })?;
            self.log.record_step(&self.slider);
            if let Some(slip) = self.log.take_slip() {
                return Ok(Some(slip));
            }
        }
        report(monitor, 1.0)?;
        Ok(None)
    }
}
