//! Intervals of estimates: from the information, and by the profile of the likelihood.

use faer::Mat;

use super::matrix;
use super::score::Score;
use super::search::{Objective, Optimum, SHORT, search_from};
use crate::Result;
use crate::monitor::{Aside, Monitor, Part};
use crate::numerics::roots::brent_root;
use crate::numerics::student::two_sided;

/// An interval that covers 95 %.
pub(super) const TWO_SIDED: Width = Width { outside: 0.05, normal: 1.959_963_984_540_054 };
/// A limit that holds with 95 %.
const ONE_SIDED: Width = Width { outside: 0.1, normal: 1.644_853_626_951_472_2 };
/// Accuracy of the end of an interval, in 1.96 standard errors.
const ACCURACY: f64 = 0.01;
/// The other numbers are taken for what they are at the minimum where their change would lower the deviance by this much less than
/// matters, if the size of an error has changed by this much in its logarithm: over it their information changes by a factor 3.
const CERTAIN: f64 = 10.0;
const NEAR: f64 = 0.5;
/// Accuracy of a limit, in its logarithm.
const LIMIT: f64 = 0.005;

/// The width of an interval to both sides.
#[derive(Debug, Clone, Copy)]
pub(super) struct Width {
    /// Probability that a value is outside of it.
    outside: f64,
    /// Half of it in standard errors that are known.
    normal: f64,
}

impl Width {
    /// Half of it in standard errors: Student's t, if errors are independent and of one unknown size.
    pub fn quantile(self, freedom: Option<f64>) -> f64 {
        freedom.map_or(self.normal, |freedom| two_sided(self.outside, freedom))
    }
}

/// The lowest deviance where one number has the coordinate `u`.
///
/// # Errors
/// Errors of the solver; stopped by the monitor.
pub(super) fn profile<O: Objective>(
    ended: (&O, &Optimum<O::Point>),
    at: (usize, f64),
    monitor: &mut dyn Monitor,
) -> Result<f64> {
    profile_to(ended, at, SHORT, monitor)
}

/// The same, by a search that ends where the next step would lower the deviance by less than `short`; this fall is counted.
fn profile_to<O: Objective>(
    (likelihood, optimum): (&O, &Optimum<O::Point>),
    (number, u): (usize, f64),
    short: f64,
    monitor: &mut dyn Monitor,
) -> Result<f64> {
    let mut held = vec![false; optimum.coordinates.len()];
    held[number] = true;
    let mut start = optimum.coordinates.clone();
    start[number] = u;
    let aside = &mut Aside { fraction: 0.0, monitor };
    let Some(trial) = likelihood.trial(&start, aside)? else { return Ok(f64::INFINITY) };
    let step = u - optimum.coordinates[number];
    if likelihood.free()[number].is_of_errors() && step.abs() <= NEAR {
        let fall = fall_of_others(optimum, number, step).filter(|fall| CERTAIN * fall < short);
        if let Some(fall) = fall {
            return Ok(O::deviance(&trial) - fall);
        }
    }
    let found = search_from(likelihood, (&start, trial), (&held, short), monitor)?;
    let fall = if found.converged { found.fall } else { 0.0 };
    Ok(O::deviance(&found.trial) - fall)
}

/// By how much the deviance falls by the change of all other numbers, where it is quadratic and one number has moved from its minimum
/// by `step`: with the information I of the others and c of them with this one, step² cᵀI⁻¹c.
fn fall_of_others<P>(optimum: &Optimum<P>, number: usize, step: f64) -> Option<f64> {
    let information = &optimum.score.information;
    let moving: Vec<usize> =
        (0..optimum.at_bound.len()).filter(|&k| k != number && !optimum.at_bound[k]).collect();
    let covariance = matrix::covariance(information, &moving)?;
    let slope = Mat::from_fn(information.nrows(), 1, |k, _| step * information[(k, number)]);
    Some(matrix::inner(&slope, &(covariance * &slope)))
}

/// The value below which a number is with 95 %.
///
/// # Errors
/// Those of [`profile`].
pub(super) fn upper_limit<O: Objective>(
    ended: (&O, &Optimum<O::Point>),
    number: usize,
    monitor: &mut dyn Monitor,
) -> Result<f64> {
    let (likelihood, optimum) = ended;
    let (start, parameter) = (optimum.coordinates[number], &likelihood.free()[number]);
    let rise = likelihood.rise(ONE_SIDED.quantile(likelihood.freedom()));
    let (step, accuracy) = if parameter.logarithmic {
        (step_of_squares(optimum.score.slope[(number, 0)], rise), LIMIT)
    } else {
        let step = step_to_rise(optimum, number, rise);
        (step, LIMIT * step)
    };
    let end = end_of_rise(ended, (number, start, step), (rise, accuracy), monitor)?;
    Ok(parameter.value(end))
}

/// The step from the end of the range of a number to its limit, for a deviance that is quadratic in all numbers: with half its slope
/// g and the information I of this number, all others estimated, 2gδ + Iδ² is the rise.
fn step_to_rise<P>(optimum: &Optimum<P>, number: usize, rise: f64) -> f64 {
    let Score { slope, information } = &optimum.score;
    let slope = slope[(number, 0)];
    let moving: Vec<usize> =
        (0..optimum.at_bound.len()).filter(|&k| k == number || !optimum.at_bound[k]).collect();
    let variance = matrix::covariance(information, &moving).map(|covariance| covariance[(number, number)]);
    let information = variance.map_or(information[(number, number)], f64::recip);
    ((slope * slope + information * rise).sqrt() - slope) / information
}

/// About the step of the logarithm of an error at the end of its range, where half the deviance has this slope, to its limit:
/// errors add by their squares, in which the deviance begins to rise in proportion.
fn step_of_squares(slope: f64, rise: f64) -> f64 {
    /// Where the slope does not show it, and the factor by which the step is longer, so that it rather brackets the limit.
    const UNKNOWN: f64 = 0.5;
    const LONGER: f64 = 1.01;
    if slope <= 0.0 {
        return UNKNOWN;
    }
    (LONGER * 0.5 * (rise / slope).ln_1p()).min(UNKNOWN)
}

/// The interval of 95 % by the profile: where the deviance, lowest in all other numbers, has risen by [`Objective::rise`], 3.84 for
/// errors of known size.
///
/// # Errors
/// Those of [`profile`].
pub(super) fn by_profile<O: Objective>(
    ended: (&O, &Optimum<O::Point>),
    (number, error): (usize, f64),
    monitor: &mut dyn Monitor,
) -> Result<[f64; 2]> {
    let (likelihood, optimum) = ended;
    let start = optimum.coordinates[number];
    let parameter = &likelihood.free()[number];
    if optimum.at_bound[number] && start <= parameter.bounds[0] {
        // At the end of its range a number has a limit only.
        return Ok([0.0, upper_limit(ended, number, monitor)?]);
    }
    /// The first step of a logarithm at the upper end of its range, where its error is not known.
    const UNKNOWN: f64 = 0.5;
    let quantile = TWO_SIDED.quantile(likelihood.freedom());
    let half = if optimum.at_bound[number] { UNKNOWN } else { quantile * error };
    let rise = likelihood.rise(quantile);
    let mut end = |side: f64, done: f64| -> Result<f64> {
        let (step, part) = (side * half, &mut Part::new(monitor, done, 0.5));
        let found = end_of_rise(ended, (number, start, step), (rise, ACCURACY * step.abs()), part)?;
        Ok(parameter.value(found.clamp(parameter.bounds[0], parameter.bounds[1])))
    };
    Ok([end(-1.0, 0.0)?, end(1.0, 0.5)?])
}

/// The coordinate, from `start` in the direction of `step`, where the profile has risen by `rise`, to `accuracy`.
fn end_of_rise<O: Objective>(
    ended: (&O, &Optimum<O::Point>),
    (number, start, step): (usize, f64, f64),
    (rise, accuracy): (f64, f64),
    monitor: &mut dyn Monitor,
) -> Result<f64> {
    /// Steps after which the profile counts as flat.
    const STEPS: usize = 40;
    let lowest = O::deviance(&ended.1.trial);
    // The fall that is left is counted, to a tenth and better; the slope of the deviance at the end is of the order of the rise
    // over the step.
    let short = ACCURACY * rise;
    let (mut failed, mut known) = (None, vec![(start, -rise)]);
    let mut above = |u: f64| {
        if let Some((_, above)) = known.iter().find(|(at, _)| *at == u) {
            return *above;
        }
        // Most searches end after a few trials.
        let tried = known.len() as f64;
        let aside = &mut Aside { fraction: tried / (tried + 4.0), monitor };
        match profile_to(ended, (number, u), short, aside) {
            Ok(deviance) => {
                let risen = deviance.min(lowest + 1e6) - lowest - rise;
                // The rise goes with the square of the step.
                known.push((u, if risen.abs() < 2.0 * ACCURACY * rise { 0.0 } else { risen }));
                known[known.len() - 1].1
            }
            Err(error) => {
                // A zero ends the search.
                failed = Some(error);
                0.0
            }
        }
    };
    let mut inside = start;
    let mut found = if step > 0.0 { f64::INFINITY } else { f64::NEG_INFINITY };
    for _ in 0..STEPS {
        let outside = inside + step;
        let risen = above(outside);
        if risen >= 0.0 {
            found = brent_root(&mut above, inside, outside, accuracy).unwrap_or(outside);
            break;
        }
        inside = outside;
    }
    failed.map_or(Ok(found), Err)
}
