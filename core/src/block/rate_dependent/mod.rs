//! A slider block in time over time-dependent contacts, which age while it sticks.
//!
//! M Ẍ = K(X_T(t) − X) − F − γẊ. The drive X_T(t) is a [`History`] that begins in equilibrium: at rest, X_T = X + F/K, or, over
//! contacts that slide steadily at v, at this velocity, X_T = X + (F + γv)/K. This is the
//! equation of motion of [`crate::dynamics`] for a single cell, which unloads its contacts after an arrest.
//!
//! Without mass and damping the spring is in balance at every time, K(X_T − X) = F, as the spring of a testing machine. The
//! slider then creeps while the drive is at rest, dX = −dF/K. A spring too soft for a balance that changes continuously makes
//! the slider slip, for which a mass or a damping is required.

mod log;

use super::{Block, Loading, Slip};
use crate::dynamics::{Arrest, EquationOfMotion, OneCell, SliderMotion, SlidingCell};
use crate::history::History;
use crate::monitor::{Aside, Monitor, report};
use crate::rate_dependent::{ErrorEstimator, RateDependentContacts};
use crate::{Error, Result};
use log::Log;
pub use log::{Moment, RateDependentSlip, Slide};

impl Block {
    /// Moves the slider's top along `drive`, from equilibrium with `contacts` ([`RateDependentContacts::steady_velocity`]: at
    /// rest, or in steady sliding), and records the motion of its base at ascending `times` since the start. `tolerance` is
    /// the largest error of a step in time, a length.
    ///
    /// With the default slip rule, [`Slip::Reset`], the spring is in balance at every time, K(X_T − X) = F, without mass and
    /// damping. The rule itself is not used: a spring so soft that the slider slips is an error.
    ///
    /// # Errors
    /// A loading other than a spring; [`Slip::Overdamped`] and [`Slip::Arrest`]; a slip without a mass or a damping; times that
    /// are not ascending or outside the drive; a tolerance that is not above 0; those of the contacts.
    pub fn follow(
        &self,
        contacts: &dyn RateDependentContacts,
        drive: &History,
        times: &[f64],
        tolerance: f64,
    ) -> Result<Slide> {
        self.follow_with(contacts, drive, times, tolerance, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::follow`]; stopped by the monitor.
    pub fn follow_with(
        &self,
        contacts: &dyn RateDependentContacts,
        drive: &History,
        times: &[f64],
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Slide> {
        self.followed(contacts, None, drive, times, tolerance, monitor)
    }

    /// As [`Block::follow`] with [`Slide::error`]. It takes three times as long, because two copies of the contacts are moved.
    ///
    /// # Errors
    /// Those of [`Block::follow`].
    pub fn follow_with_error(
        &self,
        contacts: &dyn RateDependentContacts,
        drive: &History,
        times: &[f64],
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Slide> {
        self.followed(contacts, ErrorEstimator::of(contacts), drive, times, tolerance, monitor)
    }

    fn followed(
        &self,
        contacts: &dyn RateDependentContacts,
        estimator: Option<ErrorEstimator>,
        drive: &History,
        times: &[f64],
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Slide> {
        let equation = self.equation_of_motion()?;
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(Error::invalid("tolerance", "a finite length above 0", tolerance));
        }
        drive.check_times(times)?;
        let mut slider = SlidingBlock::balanced(equation, contacts, tolerance);
        slider.motion.estimators = estimator.map(|estimator| vec![estimator]);
        let moving = drive.pieces().iter().map(|piece| piece.velocity).find(|velocity| *velocity > 0.0);
        let mut log = Log::new(&slider, moving.unwrap_or(f64::INFINITY), self.slip_fraction.unwrap_or(0.0));
        if times.first() == Some(&0.0) {
            log.add_to_trace(slider.moment());
        }
        let mut requested = times.iter().copied().skip_while(|time| *time == 0.0).peekable();
        for (piece, knots) in drive.pieces().iter().zip(drive.knots().windows(2)) {
            slider.motion.change_drive_velocity(piece.velocity - slider.velocity);
            slider.velocity = piece.velocity;
            log.set_velocity(piece.velocity);
            while let Some(time) = requested.next_if(|time| *time < knots[1].0) {
                slider.follow(time, drive.duration(), &mut log, monitor)?;
                log.add_to_trace(slider.moment());
            }
            slider.follow(knots[1].0, drive.duration(), &mut log, monitor)?;
            if requested.next_if_eq(&knots[1].0).is_some() {
                log.add_to_trace(slider.moment());
            }
        }
        report(monitor, 1.0)?;
        Ok(log.close(slider.motion.error()))
    }

    /// The equation of motion of the slider.
    fn equation_of_motion(&self) -> Result<EquationOfMotion> {
        let Loading::Spring(connection) = self.loading else {
            return Err(Error::invalid("stiffness", "a block with a stiffness, to be moved in time", "none"));
        };
        let (mass, viscosity) = self.slip.inertia_and_drag()?;
        Ok(EquationOfMotion {
            connection,
            connected: 1,
            mass,
            viscosity,
            background: self.background,
            arrest: Arrest::Unload,
        })
    }
}

impl Slip {
    /// Mass M and damping γ of a motion in time. Both are 0 for the default, [`Slip::Reset`], with which the spring is in
    /// balance at every time and a slip is an error.
    ///
    /// # Errors
    /// [`Slip::Overdamped`] and [`Slip::Arrest`].
    pub fn inertia_and_drag(self) -> Result<(f64, f64)> {
        if self == Self::Reset { Ok((0.0, 0.0)) } else { self.limits() }
    }

    /// Mass M and damping γ, which limit the velocity of a slip.
    ///
    /// # Errors
    /// A slip rule that has neither.
    pub fn limits(self) -> Result<(f64, f64)> {
        let refused = |name: &str| {
            let expected = "damped or inertial where contacts are time-dependent: during a slip the velocity must be limited by a damping or a mass";
            Err(Error::invalid("slip", expected, name))
        };
        match self {
            Self::Inertial { mass, damping } => Ok((mass, damping)),
            Self::Damped { damping } => Ok((0.0, damping)),
            Self::Reset => refused("reset"),
            Self::Overdamped => refused("overdamped"),
            Self::Arrest => refused("arrest"),
        }
    }
}

/// A slider in motion.
struct SlidingBlock {
    motion: SliderMotion,
    /// Present velocity of the drive.
    velocity: f64,
}

impl SlidingBlock {
    /// A slider in equilibrium with `contacts`: at rest, or in steady sliding at their velocity.
    fn balanced(equation: EquationOfMotion, contacts: &dyn RateDependentContacts, tolerance: f64) -> Self {
        let cell = SlidingCell::new(contacts.copy(), contacts.position());
        let drag = (equation.viscosity + cell.known.free.viscosity) * cell.velocity;
        let drive = cell.position + (cell.force + drag) / equation.connection;
        let velocity = cell.velocity;
        Self { motion: SliderMotion::new(equation, vec![cell], drive, tolerance), velocity }
    }

    fn cell(&self) -> &SlidingCell {
        &self.motion.cells[0]
    }

    /// Continues until the time `end`. The whole motion lasts `whole`.
    fn follow(&mut self, end: f64, whole: f64, log: &mut Log, monitor: &mut dyn Monitor) -> Result<()> {
        let begin = (self.motion.time, self.motion.drive);
        while self.motion.time < end {
            let motion = &mut self.motion;
            let left = end - motion.time;
            let aside = &mut Aside { fraction: motion.time / whole, monitor };
            if motion.step(&mut OneCell, self.velocity, left, aside)? >= left {
                motion.time = end;
            }
            // From the beginning of the piece, so that rounding errors of steps do not add up.
            motion.drive = begin.1 + self.velocity * (motion.time - begin.0);
            log.record_step(self);
        }
        Ok(())
    }
}
