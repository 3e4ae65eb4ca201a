//! The regime of a motion in time, which is followed until it is decided.

use super::log::Log;
use crate::Result;
use crate::block::{Block, Regime};
use crate::error::positive;
use crate::monitor::{Aside, Monitor};
use crate::rate_dependent::RateDependentContacts;

/// Longest motion, in units of the shortest one without slips.
const LONGEST: f64 = 128.0;

impl Block {
    /// The regime of sliding over contacts in time, with the load point at `velocity`. The first loading ends with the first
    /// slip, or when the load point has moved by `loading`. Sliding is smooth, or stick-slip transient, if there is no slip any
    /// more for as long as [`Regime`] requires, while the load point moves by `sliding` at least. Stick-slip is persistent if it
    /// is so after 40 slips, or after 16 of which the later half have force drops that are equal to 0.1 % and would remain so
    /// through 20 more slips by their trend. The motion ends as soon as that is decided; at the latest when the load point has
    /// moved by 128 times `loading` and `sliding` together.
    ///
    /// `tolerance` is the largest error of a step in time, a length.
    ///
    /// # Errors
    /// Distances or a velocity that are not above 0; those of [`Block::follow`]; stopped by the monitor.
    pub fn regime_in_time(
        &self,
        contacts: &dyn RateDependentContacts,
        velocity: f64,
        [loading, sliding]: [f64; 2],
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Regime> {
        positive("velocity", velocity)?;
        positive("loading", loading)?;
        positive("sliding", sliding)?;
        let mut slider = self.balanced(contacts, Some(tolerance))?;
        let mut log = Log::new(&slider, self.slip_fraction.unwrap_or(0.0));
        slider.continue_at(velocity, velocity);
        log.begin_segment(&slider);
        let shortest = (loading + sliding) / velocity;
        for end in [shortest, LONGEST * shortest] {
            while slider.motion.time < end {
                let fraction = (slider.motion.time / shortest).min(1.0);
                slider.step(end, &mut Aside { fraction, monitor })?;
                log.record_step(&slider);
                if let Some(regime) = log.decided([loading, sliding]) {
                    return Ok(regime);
                }
            }
        }
        Ok(log.close().regime)
    }
}
