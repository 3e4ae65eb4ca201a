//! The search for the most probable values: Fisher scoring, damped as by Levenberg and Marquardt.

use faer::Mat;

use super::free::FreeParameter;
use super::likelihood::LikelihoodPoint;
use super::matrix;
use super::score::Score;
use crate::monitor::{Aside, Monitor, Part};
use crate::{Error, Result};

/// Steps after which the search is given up.
const STEPS: usize = 60;
/// The search ends where the next step would be this short, in standard errors squared: a thousandth of an error.
pub(super) const SHORT: f64 = 1e-6;
/// A search whose end is only the start of another one: a tenth of an error.
pub(super) const COARSE: f64 = 1e-2;
/// One whose end is the start of another one with errors that are several times as large: an error.
pub(super) const ONE_ERROR: f64 = 1.0;
/// Or, where no step lowers the deviance by reason of rounding, this short.
const ROUNDED: f64 = 1e-3;
/// Smallest damping, relative to the information, where a step without any has failed; factors by which it changes, and its
/// largest value.
const DAMPING: f64 = 1e-2;
const MORE: f64 = 8.0;
const LESS: f64 = 0.1;
const MOST: f64 = 1e9;
/// Part of the expected fall of the deviance from which on there is less damping (K. Madsen, H. B. Nielsen and O. Tingleff,
/// *Methods for Non-Linear Least Squares Problems*, 2004).
const TRUSTED: f64 = 0.5;

/// A likelihood as a function of the coordinates of free numbers.
pub(super) trait Objective {
    /// What is computed at a point.
    type Point;

    /// The free numbers.
    fn free(&self) -> &[FreeParameter];

    /// # Errors
    /// A measurement that is only planned: its likelihood has no maximum.
    fn refuse_unmeasured(&self) -> Result<()> {
        Ok(())
    }

    /// How often a step without damping is halved before steps are damped. Damping is relative to the information of each
    /// number: where this is nearly singular, it holds back what is hardly determined even where it is small.
    fn halvings(&self) -> i32;

    /// The likelihood at coordinates; `None` where it is 0 or not defined, such as beyond the range of a number.
    ///
    /// # Errors
    /// Errors of the solver; stopped by the monitor.
    fn trial(&self, coordinates: &[f64], monitor: &mut dyn Monitor) -> Result<Option<Self::Point>>;

    /// −2 ln L, priors included, or that of the restricted likelihood.
    fn deviance(point: &Self::Point) -> f64;

    /// The slope and the expected information at a point.
    ///
    /// # Errors
    /// As [`Self::trial`].
    fn score(&self, coordinates: &[f64], point: &Self::Point, monitor: &mut dyn Monitor) -> Result<Score>;

    /// −2 ln L without what the restricted likelihood adds to it, and half its slope; `None` where the likelihood is 0.
    ///
    /// # Errors
    /// As [`Self::trial`].
    fn unrestricted(
        &self,
        coordinates: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(f64, Mat<f64>)>> {
        let trial = self.trial(coordinates, &mut Part::new(monitor, 0.0, 0.5))?;
        let Some(trial) = trial else { return Ok(None) };
        let score = self.score(coordinates, &trial, &mut Part::new(monitor, 0.5, 0.5))?;
        Ok(Some((Self::deviance(&trial), score.slope)))
    }

    /// The degrees of freedom ν of errors that are independent and of one unknown size.
    fn freedom(&self) -> Option<f64> {
        None
    }

    /// Whether errors of one unknown size have the most probable one for any values of the other numbers.
    fn is_profiled(&self) -> bool {
        self.freedom().is_some()
    }

    /// By how much the deviance rises where a number is `quantile` of its standard errors from its estimate. Of a profiled size of
    /// errors the deviance is ν ln Σr², which rises by ν ln(1 + t²/ν) (D. M. Bates and D. G. Watts, *Nonlinear Regression Analysis
    /// and Its Applications*, 1988).
    fn rise(&self, quantile: f64) -> f64 {
        let square = quantile * quantile;
        let profiled = self.freedom().filter(|_| self.is_profiled());
        profiled.map_or(square, |freedom| freedom * (square / freedom).ln_1p())
    }

    /// The coordinates of the highest likelihood, with the numbers that are `held` fixed and to within `short`, as far as they follow
    /// from this score without another solution; `None` where a step of Newton leads as far.
    ///
    /// # Errors
    /// As [`Self::trial`].
    fn without_solutions(
        &self,
        _at: (&[f64], &Self::Point, &Score),
        _to: (&[bool], f64),
        _monitor: &mut dyn Monitor,
    ) -> Result<Option<Vec<f64>>> {
        Ok(None)
    }
}

/// Where a search has ended.
#[derive(Debug)]
pub(super) struct Optimum<P = LikelihoodPoint> {
    pub coordinates: Vec<f64>,
    pub trial: P,
    pub score: Score,
    /// Numbers at the end of their range.
    pub at_bound: Vec<bool>,
    pub converged: bool,
    /// Solutions of the master equation.
    pub solutions: usize,
    /// By how much the next step would lower the deviance.
    pub fall: f64,
}

/// Minimises the deviance from each of `starts`, until a step would be `short`, in standard errors squared, and returns the
/// lowest minimum. A start from which the solver fails is left out if there is another one.
///
/// # Errors
/// No start where the likelihood is defined, or errors of the solver from all of them; stopped by the monitor.
pub(super) fn search_each<O: Objective>(
    likelihood: &O,
    starts: &[Vec<f64>],
    short: f64,
    monitor: &mut dyn Monitor,
) -> Result<Optimum<O::Point>> {
    let (mut best, mut solutions, share): (Option<Optimum<O::Point>>, _, _) =
        (None, 0, 1.0 / starts.len() as f64);
    let mut failed = None;
    for (k, start) in starts.iter().enumerate() {
        let part = &mut Part::new(monitor, k as f64 * share, share);
        solutions += 1;
        let found = match search_at(likelihood, start, short, part) {
            Ok(Some(found)) => found,
            Ok(None) => continue,
            Err(Error::Stopped) => return Err(Error::Stopped),
            Err(error) => {
                failed = failed.or(Some(error));
                continue;
            }
        };
        solutions += found.solutions;
        let deviance = |one: &Optimum<O::Point>| O::deviance(&one.trial);
        best = Some(match best {
            Some(best) if deviance(&best) <= deviance(&found) => best,
            _ => found,
        });
    }
    let undefined = || {
        let expected =
            "first values from which a curve follows; where the machine has a compliance, one without a slip";
        Error::invalid("free", expected, "none at the first values")
    };
    let mut best = best.ok_or_else(|| failed.unwrap_or_else(undefined))?;
    best.solutions = solutions;
    Ok(best)
}

/// The search from one start; `None` where the likelihood is not defined there.
fn search_at<O: Objective>(
    likelihood: &O,
    start: &[f64],
    short: f64,
    monitor: &mut dyn Monitor,
) -> Result<Option<Optimum<O::Point>>> {
    let Some(trial) = likelihood.trial(start, &mut Aside { fraction: 0.0, monitor })? else {
        return Ok(None);
    };
    search_from(likelihood, (start, trial), (&vec![false; start.len()], short), monitor).map(Some)
}

/// The same from a start where the likelihood is known, with the numbers that are `held` fixed.
///
/// # Errors
/// Errors of the solver; stopped by the monitor.
pub(super) fn search_from<O: Objective>(
    likelihood: &O,
    (start, trial): (&[f64], O::Point),
    at: (&[bool], f64),
    monitor: &mut dyn Monitor,
) -> Result<Optimum<O::Point>> {
    let score = likelihood.score(start, &trial, &mut Aside { fraction: 0.0, monitor })?;
    search_from_score(likelihood, (start, trial, score), at, monitor)
}

/// The same where the slope is known, too.
///
/// # Errors
/// Errors of the solver; stopped by the monitor.
pub(super) fn search_from_score<O: Objective>(
    likelihood: &O,
    (start, mut trial, mut score): (&[f64], O::Point, Score),
    (held, short): (&[bool], f64),
    monitor: &mut dyn Monitor,
) -> Result<Optimum<O::Point>> {
    let mut coordinates = start.to_vec();
    let monitor = &mut Aside { fraction: 0.0, monitor };
    let (mut damping, mut solutions, mut converged, mut fall) = (0.0, 0, false, f64::INFINITY);
    let mut before = f64::INFINITY;
    for step in 0..STEPS {
        // The number of steps is not known beforehand; most searches need about ten.
        monitor.fraction = 1.0 - 0.85_f64.powi(step as i32);
        let Some((active, newton)) = newton_step(likelihood, &coordinates, &score, held) else { break };
        let decrement = -matrix::inner(&newton, &score.slope);
        fall = decrement;
        if decrement < short {
            converged = true;
            break;
        }
        // If the step after this one is as much shorter than it as it is than the one before, this is the last, and so short
        // that the information hardly changes over it.
        let last = decrement < COARSE && decrement * (decrement / before) < short;
        before = if damping == 0.0 { decrement } else { f64::INFINITY };
        let far = if last || damping > 0.0 {
            None
        } else {
            likelihood.without_solutions((&coordinates, &trial, &score), (held, short), monitor)?
        };
        let mut descent = Descent { damping, solutions, far };
        let lower = descent.lower(likelihood, (&coordinates, &trial, &score), &active, monitor)?;
        Descent { damping, solutions, .. } = descent;
        let Some((next, found)) = lower else {
            converged = decrement < ROUNDED;
            break;
        };
        if last {
            score.follow(&difference(&next, &coordinates));
            // What is left is shorter than `short`, and not known better.
            (coordinates, trial, converged, fall) = (next, found, true, 0.0);
            break;
        }
        (coordinates, trial) = (next, found);
        score = likelihood.score(&coordinates, &trial, monitor)?;
    }
    let at_bound = likelihood.free().iter().zip(&coordinates);
    let at_bound = at_bound.map(|(parameter, u)| parameter.bounds.contains(u)).collect();
    Ok(Optimum { coordinates, trial, score, at_bound, converged, solutions, fall })
}

/// Newton's step, and the numbers that move in it; `None` where the information is not positive definite.
fn newton_step<O: Objective>(
    likelihood: &O,
    coordinates: &[f64],
    score: &Score,
    held: &[bool],
) -> Option<(Vec<usize>, Mat<f64>)> {
    let active = active(likelihood.free(), coordinates, score, held);
    let newton = matrix::damped_step(score, &active, 0.0)?;
    // Numbers at an end of their range that all together would leave it stay there.
    let stays = |k: usize| {
        let [low, high] = likelihood.free()[k].bounds;
        (coordinates[k] <= low && newton[(k, 0)] < 0.0) || (coordinates[k] >= high && newton[(k, 0)] > 0.0)
    };
    let moving: Vec<usize> = active.iter().copied().filter(|&k| !stays(k)).collect();
    if moving.len() == active.len() {
        return Some((active, newton));
    }
    let newton = matrix::damped_step(score, &moving, 0.0)?;
    Some((moving, newton))
}

/// The way to a lower deviance along Newton's step, halved or damped as far as that needs.
struct Descent {
    damping: f64,
    /// Solutions so far.
    solutions: usize,
    /// A point that is tried first.
    far: Option<Vec<f64>>,
}

impl Descent {
    /// A point of a deviance that is not higher, and what is known there; `None` if there is none.
    fn lower<O: Objective>(
        &mut self,
        likelihood: &O,
        (coordinates, trial, score): (&[f64], &O::Point, &Score),
        active: &[usize],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(Vec<f64>, O::Point)>> {
        let mut halvings = 0;
        while self.damping <= MOST {
            let far = self.far.take();
            let is_far = far.is_some();
            let step = match far {
                Some(far) => Some(Mat::from_fn(far.len(), 1, |k, _| far[k] - coordinates[k])),
                None => matrix::damped_step(score, active, self.damping),
            };
            let Some(step) = step else {
                self.damping = more(self.damping);
                continue;
            };
            let step = if self.damping == 0.0 { step * faer::Scale(0.5_f64.powi(halvings)) } else { step };
            let next = stepped(likelihood.free(), coordinates, &step);
            let found = likelihood.trial(&next, monitor)?;
            self.solutions += 1;
            match found.filter(|found| O::deviance(found) <= O::deviance(trial)) {
                Some(found) => {
                    let fallen = O::deviance(trial) - O::deviance(&found);
                    let made = difference(&next, coordinates);
                    if fallen > TRUSTED * matrix::expected_fall(score, &made) {
                        self.damping = less(self.damping);
                    }
                    return Ok(Some((next, found)));
                }
                None if is_far => {}
                None if self.damping == 0.0 && halvings < likelihood.halvings() => halvings += 1,
                None => self.damping = more(self.damping),
            }
        }
        Ok(None)
    }
}

fn difference(next: &[f64], coordinates: &[f64]) -> Vec<f64> {
    next.iter().zip(coordinates).map(|(next, u)| next - u).collect()
}

fn more(damping: f64) -> f64 {
    (damping * MORE).max(DAMPING)
}

/// Less damping; none where little is left, so that directions of little information are not held back.
fn less(damping: f64) -> f64 {
    if damping < DAMPING { 0.0 } else { damping * LESS }
}

/// Which numbers move: not those held, nor those that would leave their range.
fn active(free: &[FreeParameter], coordinates: &[f64], score: &Score, held: &[bool]) -> Vec<usize> {
    let outwards = |k: usize| {
        let [low, high] = free[k].bounds;
        (coordinates[k] <= low && score.slope[(k, 0)] > 0.0)
            || (coordinates[k] >= high && score.slope[(k, 0)] < 0.0)
    };
    (0..coordinates.len()).filter(|&k| !held[k] && !outwards(k)).collect()
}

/// The coordinates after a step, shortened as a whole so that no number moves too far, and cut at the ends of ranges.
fn stepped(free: &[FreeParameter], coordinates: &[f64], step: &Mat<f64>) -> Vec<f64> {
    let too_long = free
        .iter()
        .enumerate()
        .map(|(k, parameter)| step[(k, 0)].abs() / parameter.longest_step(coordinates[k]));
    let share = 1.0 / too_long.fold(1.0, f64::max);
    let moved = coordinates.iter().enumerate().map(|(k, u)| {
        let [low, high] = free[k].bounds;
        (u + share * step[(k, 0)]).clamp(low, high)
    });
    moved.collect()
}
