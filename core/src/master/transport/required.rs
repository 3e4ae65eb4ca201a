//! Solutions to a required accuracy, repeated with smaller tolerances.

use super::{Trace, Transport};
use crate::history::History;
use crate::monitor::{Monitor, Part, Preparation};
use crate::{Error, Result};

/// Calls `solve` with a tolerance, and with smaller ones until the error that it returns beside its solution, in units of the
/// required one, is at most 1. If it is never, the solution of the smallest error is returned.
///
/// # Errors
/// Those of `solve`. A smaller tolerance at which it needs too much memory or too short steps only ends the attempts.
pub fn as_required<T>(
    mut tolerance: f64,
    required: bool,
    monitor: &mut dyn Monitor,
    mut solve: impl FnMut(f64, &mut Part<'_>) -> Result<(T, f64)>,
) -> Result<(T, f64)> {
    /// Largest number of calls of `solve`.
    const ATTEMPTS: usize = 4;
    /// Smallest tolerance.
    const FINEST: f64 = 1e-12;
    /// Ratio of the tolerance of an attempt to that of the one before: the second solution of this one is then about as accurate as
    /// the first one of that.
    const FINER: f64 = 1.0 / 16.0;
    let share = if required { 0.5 } else { 1.0 };
    let mut best = solve(tolerance, &mut Part::new(monitor, 0.0, share))?;
    let (mut start, mut excess) = (share, best.1);
    for _ in 1..ATTEMPTS {
        if excess <= 1.0 || tolerance == FINEST {
            break;
        }
        // The error is taken as proportional to the tolerance; the factor ½ is a margin.
        tolerance = (tolerance * FINER.min(0.5 / excess)).max(FINEST);
        let rest = 0.5 * (1.0 - start);
        let found = match solve(tolerance, &mut Part::new(monitor, start, rest)) {
            Err(Error::TooLarge { .. } | Error::StepTooShort { .. }) => break,
            found => found?,
        };
        (start, excess) = (start + rest, found.1);
        if excess < best.1 {
            best = found;
        }
    }
    Ok(best)
}

impl Transport {
    /// Follows a history with contacts that `build` makes for a tolerance. While the estimated error of F/(N_c⟨k⟩) per mean
    /// threshold is above the `required` one, contacts for smaller tolerances follow it once more.
    ///
    /// # Errors
    /// Those of `build` and of [`Transport::follow_with`]; [`Error::Accuracy`] if the required accuracy is not reached.
    pub fn follow_as_required(
        build: &mut dyn FnMut(f64, &mut dyn Monitor) -> Result<Self>,
        (history, times): (&History, &[f64]),
        (tolerance, required): (f64, Option<f64>),
        monitor: &mut dyn Monitor,
    ) -> Result<Trace> {
        let follow = |tolerance: f64, part: &mut Part<'_>| {
            let mut preparation = Preparation::new(part);
            let mut transport = build(tolerance, &mut preparation)?;
            let trace = transport.follow_with(history, times, &mut preparation.rest())?;
            let excess = required.map_or(0.0, |required| trace.error / transport.unit() / required);
            Ok(((trace, transport.unit()), excess))
        };
        let ((trace, unit), _) = as_required(tolerance, required.is_some(), monitor, follow)?;
        trace.check(unit, required)?;
        Ok(trace)
    }
}
