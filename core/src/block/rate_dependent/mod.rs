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
mod moment;
mod motion;
mod regime_in_time;
mod sliding;

use super::{Block, Loading, Slip};
use crate::dynamics::{Arrest, EquationOfMotion, LIMITED_SLIP};
use crate::history::History;
use crate::monitor::{Aside, Monitor, Part, report};
use crate::rate_dependent::{ROUGH, RateDependentContacts};
use crate::{Error, Result};
use log::Log;
pub use log::{RateDependentSlip, Slide};
pub use moment::Moment;
pub use motion::{BlockMotion, BlockMotionState};
use sliding::SlidingBlock;

impl Block {
    /// The default tolerance of a motion in time, in mean thresholds.
    pub const TOLERANCE_IN_TIME: f64 = 1e-4;

    /// Largest error of a step per mean threshold, for a `required` error of the force per N_c⟨k⟩ and mean threshold. Errors of
    /// steps add up: for a method of second order the error of the motion is proportional to the power ⅔ of that of a step.
    pub fn step_for(required: f64) -> f64 {
        /// Longer steps are too long for an estimate of their error from still longer ones.
        const LARGEST: f64 = 1e-5;
        /// Near rounding.
        const SMALLEST: f64 = 1e-12;
        (0.5 * required).powf(1.5).clamp(SMALLEST, LARGEST)
    }

    /// Moves the slider's top along `drive`, from equilibrium with `contacts` ([`RateDependentContacts::steady_velocity`]: at
    /// rest, or in steady sliding), and records the motion of its base at ascending `times` since the start, with
    /// [`Block::TOLERANCE_IN_TIME`].
    ///
    /// With the default slip rule, [`Slip::Reset`], the spring is in balance at every time, K(X_T − X) = F, without mass and
    /// damping. The rule itself is not used: a spring so soft that the slider slips is an error.
    ///
    /// # Errors
    /// A loading other than a spring; [`Slip::Overdamped`] and [`Slip::Arrest`]; a slip without a mass or a damping; times that
    /// are not ascending or outside the drive; contacts whose mean threshold is not known; those of the contacts.
    pub fn follow(
        &self,
        contacts: &dyn RateDependentContacts,
        drive: &History,
        times: &[f64],
    ) -> Result<Slide> {
        self.follow_with(contacts, drive, times, None, &mut ())
    }

    /// The same with the largest error of a step in time, a length, watched by a monitor.
    ///
    /// # Errors
    /// As [`Self::follow`]; a tolerance that is not above 0; stopped by the monitor.
    pub fn follow_with(
        &self,
        contacts: &dyn RateDependentContacts,
        drive: &History,
        times: &[f64],
        tolerance: impl Into<Option<f64>>,
        monitor: &mut dyn Monitor,
    ) -> Result<Slide> {
        let mut slider = self.balanced(contacts, tolerance.into())?;
        drive.check_times(times)?;
        let mut log = Log::new(&slider, self.slip_fraction.unwrap_or(0.0));
        if times.first() == Some(&0.0) {
            log.add_to_trace(slider.moment());
        }
        let mut requested = times.iter().copied().skip_while(|time| *time == 0.0).peekable();
        let mut follow = |slider: &mut SlidingBlock, log: &mut Log, end: f64| {
            slider.begin_segment();
            while slider.motion.time < end {
                let fraction = slider.motion.time / drive.duration();
                slider.step(end, &mut Aside { fraction, monitor })?;
                log.record_step(slider);
            }
            Ok(())
        };
        for (i, knots) in drive.knots().windows(2).enumerate() {
            let segment = drive.segment(i, 0.0);
            slider.continue_at(segment.velocity, segment.pulled);
            log.begin_segment(&slider);
            while let Some(time) = requested.next_if(|time| *time < knots[1].0) {
                follow(&mut slider, &mut log, time)?;
                log.add_to_trace(slider.moment());
            }
            follow(&mut slider, &mut log, knots[1].0)?;
            if requested.next_if_eq(&knots[1].0).is_some() {
                log.add_to_trace(slider.moment());
            }
        }
        report(monitor, 1.0)?;
        Ok(log.close())
    }

    /// As [`Block::follow_with`] with [`Slide::error`], for which the block is moved a second time, with larger tolerances.
    ///
    /// # Errors
    /// Those of [`Block::follow_with`].
    pub fn follow_with_error(
        &self,
        contacts: &dyn RateDependentContacts,
        drive: &History,
        times: &[f64],
        tolerance: impl Into<Option<f64>>,
        monitor: &mut dyn Monitor,
    ) -> Result<Slide> {
        /// Fraction of the work for the second motion.
        const ASIDE: f64 = 0.3;
        let tolerance = self.step_tolerance(contacts, tolerance.into())?;
        let follow = |contacts: &dyn RateDependentContacts, tolerance, part: &mut Part<'_>| {
            self.follow_with(contacts, drive, times, tolerance, part)
        };
        let rough = contacts.rough();
        let rough = rough
            .map(|rough| follow(rough.as_ref(), ROUGH * tolerance, &mut Part::new(monitor, 0.0, ASIDE)))
            .transpose()?;
        let slide = follow(contacts, tolerance, &mut Part::new(monitor, ASIDE, 1.0 - ASIDE))?;
        let error = rough.and_then(|rough| slide.difference(&rough, times));
        Ok(Slide { error, ..slide })
    }

    /// The slider in equilibrium with `contacts`.
    fn balanced(&self, contacts: &dyn RateDependentContacts, tolerance: Option<f64>) -> Result<SlidingBlock> {
        let (equation, tolerance) = (self.equation_of_motion()?, self.step_tolerance(contacts, tolerance)?);
        Ok(SlidingBlock::balanced(equation, contacts, tolerance))
    }

    /// The tolerance of a step, a length; without one, that for the mean threshold of the contacts.
    fn step_tolerance(&self, contacts: &dyn RateDependentContacts, tolerance: Option<f64>) -> Result<f64> {
        let of_contacts = || contacts.mean_threshold().map(|mean| Self::TOLERANCE_IN_TIME * mean);
        let missing =
            || Error::invalid("tolerance", "one of contacts whose mean threshold is not known", "none");
        let tolerance = tolerance.or_else(of_contacts).ok_or_else(missing)?;
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(Error::invalid("tolerance", "a finite length above 0", tolerance));
        }
        Ok(tolerance)
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
        let refused = |name: &str| Err(Error::invalid("slip", LIMITED_SLIP, name));
        match self {
            Self::Inertial { mass, damping } => Ok((mass, damping)),
            Self::Damped { damping } => Ok((0.0, damping)),
            Self::Reset => refused("reset, the default"),
            Self::Overdamped => refused("overdamped"),
            Self::Arrest => refused("arrest"),
        }
    }
}
