//! Solutions to a required accuracy, repeated with smaller tolerances.

use super::{Trace, Transport};
use crate::history::{History, LoadedHistory};
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
        followed((tolerance, required), monitor, |tolerance, part| {
            let mut preparation = Preparation::new(part);
            let mut transport = build(tolerance, &mut preparation)?;
            let trace = transport.follow_with(history, times, &mut preparation.rest())?;
            Ok((trace, transport.unit()))
        })
    }

    /// The same under a normal load that steps, as [`Transport::follow_under_load`]. `build` makes the contacts at the start, and
    /// those that have just formed, which are followed from each rise of the load on.
    ///
    /// # Errors
    /// Those of `build` and of [`Transport::follow_under_load`]; [`Error::Accuracy`] if the required accuracy is not reached.
    pub fn follow_under_load_as_required(
        mut build: impl FnMut(f64, &mut dyn Monitor) -> Result<[Self; 2]>,
        (motion, times): (&LoadedHistory, &[f64]),
        (tolerance, required): (f64, Option<f64>),
        monitor: &mut dyn Monitor,
    ) -> Result<Trace> {
        followed((tolerance, required), monitor, |tolerance, part| {
            let mut preparation = Preparation::new(part);
            let [transport, fresh] = build(tolerance, &mut preparation)?;
            let unit = transport.unit();
            let trace = transport.follow_under_load(&fresh, motion, times, &mut preparation.rest())?;
            Ok((trace, unit))
        })
    }
}

/// Repeats `follow`, which returns a trace and the unit of its force, until the trace is as accurate as required.
///
/// # Errors
/// Those of `follow`; [`Error::Accuracy`] if the required accuracy is not reached.
fn followed(
    (tolerance, required): (f64, Option<f64>),
    monitor: &mut dyn Monitor,
    mut follow: impl FnMut(f64, &mut Part<'_>) -> Result<(Trace, f64)>,
) -> Result<Trace> {
    let solve = |tolerance: f64, part: &mut Part<'_>| {
        let (trace, unit) = follow(tolerance, part)?;
        let excess = required.map_or(0.0, |required| trace.error / unit / required);
        Ok(((trace, unit), excess))
    };
    let ((trace, unit), _) = as_required(tolerance, required.is_some(), monitor, solve)?;
    trace.check(unit, required)?;
    Ok(trace)
}
