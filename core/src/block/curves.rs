//! Curves of a population under a slider: F(X), its equilibria X_T(X) and its potential V(X_T, X).

use super::Loading;
use super::equilibrium_path::EquilibriumPath;
use crate::monitor::Monitor;
use crate::numerics::legendre::{NODES, RULE};
use crate::numerics::roots::brent_minimum;
use crate::population::{Direction, Population, Response};
use crate::{Error, Result};

/// Intervals between two reports to the monitor.
const REPORT: u32 = 1024;

/// Smallest jump of the force that a curve shows by two points, relative to the largest force.
const SHOWN: f64 = 1e-3;

/// The curve F(X) for forward motion of the slider's base from the present state of a population.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// Position X, a length, in ascending order; given twice where the force jumps.
    pub position: Vec<f64>,
    /// Friction force F.
    pub force: Vec<f64>,
    /// Tangent stiffness F' = dF/dX.
    pub tangent: Vec<f64>,
    /// Work ∫F dX from the first position.
    pub work: Vec<f64>,
    /// The part of F that is a background force.
    background: f64,
}

impl Curve {
    /// The curve over `distance` at `points` evenly spaced positions, both ends included, and at jumps of the force.
    /// The population does not change.
    ///
    /// # Errors
    /// A distance that is not above 0, fewer than two points; those of the population; a stop by the monitor.
    pub fn new(
        population: &dyn Population,
        distance: f64,
        points: usize,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        if points < 2 {
            return Err(Error::invalid("points", "at least the 2 ends", points));
        }
        let start = population.position();
        let spacing = distance / (points - 1) as f64;
        let (mut curve, mut next, mut work) = (Self::default(), 0, 0.0);
        let mut largest: f64 = 0.0;
        let mut end: Option<CurveRow> = None;
        let mut reached: Option<CurveRow> = None;
        along(population, distance, monitor, |path, length| {
            let begin = CurveRow::at(path, 0.0, work);
            // A jump of the force is shown by the points before and after it.
            if let Some(end) = end.filter(|end| (end.force - begin.force).abs() > SHOWN * largest) {
                curve.push(end);
                curve.push(begin);
            }
            while next + 1 < points && start + next as f64 * spacing <= path.position + length {
                let a = start + next as f64 * spacing - path.position;
                curve.push(CurveRow::at(path, a.clamp(0.0, length), work));
                next += 1;
            }
            let last = CurveRow::at(path, length, work);
            largest = largest.max(last.force.abs());
            work = last.work;
            end = path.interval.breaks.then_some(last);
            reached = Some(last);
            true
        })?;
        // The last point is the end itself, whatever the rounding of the others.
        reached.into_iter().for_each(|end| curve.push(end));
        Ok(curve)
    }

    /// The same with a background force B in addition to that of the contacts.
    #[must_use]
    pub fn with_background(mut self, background: f64) -> Self {
        let start = self.position.first().copied().unwrap_or(0.0);
        self.background += background;
        self.force.iter_mut().for_each(|force| *force += background);
        for (work, position) in self.work.iter_mut().zip(&self.position) {
            *work += background * (position - start);
        }
        self
    }

    fn push(&mut self, state: CurveRow) {
        self.position.push(state.position);
        self.force.push(state.force);
        self.tangent.push(state.tangent);
        self.work.push(state.work);
    }

    /// The drive X_T(X) = X + F/K at which each position is an equilibrium, for the stiffness K of the block, with the F of
    /// the contacts: X_T is counted from where the spring carries the background force.
    pub fn drive(&self, stiffness: f64) -> Vec<f64> {
        let loading = Loading::Spring(stiffness);
        self.position.iter().zip(&self.force).map(|(&x, &f)| loading.drive(x, f - self.background)).collect()
    }

    /// Whether each equilibrium is stable: F' + K > 0.
    pub fn stable(&self, stiffness: f64) -> Vec<bool> {
        self.tangent.iter().map(|tangent| tangent + stiffness > 0.0).collect()
    }

    /// The potential V(X_T, X) = ½K(X_T − X)² + ∫F dX at each position, an energy.
    pub fn potential(&self, stiffness: f64, drive: f64) -> Vec<f64> {
        let loading = Loading::Spring(stiffness);
        // ½(p + B)²/K with p = K(X_T − X), up to a constant.
        let height =
            |(&x, &work): (&f64, &f64)| loading.stored(drive, x) + self.background * (drive - x) + work;
        self.position.iter().zip(&self.work).map(height).collect()
    }
}

/// A row of a curve.
#[derive(Clone, Copy)]
struct CurveRow {
    position: f64,
    force: f64,
    tangent: f64,
    work: f64,
}

impl CurveRow {
    /// The row after an advance `a` in the interval ahead, with the work done before it.
    fn at(path: &EquilibriumPath<'_>, a: f64, work: f64) -> Self {
        let Response { force, tangent } = path.response(a);
        let work = work + path.integral(a, |_, response| response.force);
        Self { position: path.position + a, force, tangent, work }
    }
}

/// Critical stiffness K_c = −min F' for forward motion over `distance` from the present state of a population; 0 if F
/// never decreases, infinite if it jumps down. A block with K < K_c becomes unstable.
///
/// # Errors
/// A distance that is not above 0; those of the population; a stop by the monitor.
pub fn critical_stiffness(
    population: &dyn Population,
    distance: f64,
    monitor: &mut dyn Monitor,
) -> Result<f64> {
    let mut critical: f64 = 0.0;
    let mut end: Option<f64> = None;
    along(population, distance, monitor, |path, length| {
        let fallen = end.is_some_and(|end| path.here.force < end);
        // A jump down is a slope of −∞: no spring is stiff enough there.
        critical = if fallen { f64::INFINITY } else { critical.max(-lowest_tangent(path, length)) };
        end = path.interval.breaks.then(|| path.response(length).force);
        critical.is_finite()
    })?;
    Ok(critical)
}

/// The smallest tangent in the interval ahead up to `length`.
fn lowest_tangent(path: &EquilibriumPath<'_>, length: f64) -> f64 {
    let ends = path.here.tangent.min(path.response(length).tangent);
    if path.interval.straight {
        return ends;
    }
    let tangent = |a: f64| path.response(a).tangent;
    let place = |i: usize| match i {
        0 => 0.0,
        i if i <= NODES => 0.5 * length * (1.0 + RULE.nodes[i - 1]),
        _ => length,
    };
    // The tangent is a polynomial on the interval: the lowest Gauss point brackets its minimum.
    let lowest = (1..=NODES).min_by(|&i, &j| tangent(place(i)).total_cmp(&tangent(place(j)))).unwrap_or(1);
    let (_, inside) = brent_minimum(tangent, place(lowest - 1), place(lowest + 1), 1e-9 * length);
    ends.min(inside)
}

/// Moves a copy of a population forward over `distance`, one smooth interval after the other. `visit` receives the interval
/// ahead and its length, and returns whether to continue.
fn along(
    population: &dyn Population,
    distance: f64,
    monitor: &mut dyn Monitor,
    mut visit: impl FnMut(&EquilibriumPath<'_>, f64) -> bool,
) -> Result<()> {
    if !(distance > 0.0 && distance.is_finite()) {
        return Err(Error::invalid("distance", "a finite length above 0", distance));
    }
    let mut copy = population.copy();
    let mut path = EquilibriumPath::new(copy.as_mut(), (Loading::Rigid, 0.0), Direction::Forward, monitor)?;
    let start = path.position;
    for intervals in 0_u32.. {
        let left = distance - (path.position - start);
        let length = path.interval.length.min(left);
        if !visit(&path, length) || length >= left {
            return Ok(());
        }
        let breaks = path.interval.breaks;
        path.advance(length)?;
        if breaks {
            path.cross()?;
        }
        path.find_interval(Direction::Forward)?;
        if intervals.is_multiple_of(REPORT) {
            path.report_progress(1.0 - left / distance)?;
        }
    }
    Ok(())
}
