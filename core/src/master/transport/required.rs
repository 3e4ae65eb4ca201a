//! Contacts followed to a required accuracy.

use super::{Trace, Transport};
use crate::Result;
use crate::history::History;
use crate::monitor::{Monitor, Part, Preparation};

/// Smallest tolerance.
const FINEST: f64 = 1e-12;

impl Transport {
    /// Follows a history with contacts that `build` makes for a tolerance. If the estimated error of F/(N_c⟨k⟩) per mean
    /// threshold is above the `required` one, contacts for a smaller tolerance follow it once more.
    ///
    /// # Errors
    /// Those of `build` and of [`Transport::follow_with`]; [`Error::Accuracy`](crate::Error::Accuracy) if the required
    /// accuracy is not reached then either.
    pub fn follow_as_required(
        build: &mut dyn FnMut(f64, &mut dyn Monitor) -> Result<Self>,
        (history, times): (&History, &[f64]),
        (tolerance, required): (f64, Option<f64>),
        monitor: &mut dyn Monitor,
    ) -> Result<Trace> {
        let mut follow = |tolerance: f64, part: &mut Part<'_>| {
            let mut preparation = Preparation::new(part);
            let mut transport = build(tolerance, &mut preparation)?;
            let trace = transport.follow_with(history, times, &mut preparation.rest())?;
            Ok((trace, transport.unit()))
        };
        let first = if required.is_some() { 0.5 } else { 1.0 };
        let (trace, unit) = follow(tolerance, &mut Part::new(monitor, 0.0, first))?;
        let excess = required.map_or(0.0, |required| trace.error / unit / required);
        if excess <= 1.0 {
            return Ok(trace);
        }
        // The error is taken as proportional to the tolerance; the factor ½ is a margin.
        let finer = (0.5 * tolerance / excess).max(FINEST);
        let (trace, unit) = follow(finer, &mut Part::new(monitor, first, 1.0 - first))?;
        trace.check(unit, required)?;
        Ok(trace)
    }
}
