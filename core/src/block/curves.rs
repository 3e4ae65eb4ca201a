//! Curves of a population under a slider: F(X), its equilibria X_T(X) and its potential V(X_T, X).

use super::Loading;
use super::equilibrium_path::EquilibriumPath;
use crate::monitor::Monitor;
use crate::numerics::legendre::{NODES, RULE};
use crate::numerics::roots::brent_minimum;
use crate::population::{Direction, Population, Response};
use crate::{Error, Result};

/// Ways between two reports to the monitor.
const REPORT: u32 = 1024;

/// A jump of the force, of the largest, that a curve shows by two points.
const SHOWN: f64 = 1e-3;

/// F(X) as the slider's bottom moves forward from where a population stands.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// X, rising; twice where the force jumps.
    pub position: Vec<f64>,
    /// F.
    pub force: Vec<f64>,
    /// F'.
    pub tangent: Vec<f64>,
    /// ∫F dX from the first position.
    pub work: Vec<f64>,
}

impl Curve {
    /// The curve over `distance` at `points` even positions, both ends included, and at jumps of the force; the
    /// population is left as it is.
    ///
    /// # Errors
    /// A distance that is not above 0, fewer than two points; those of the population; stopped by the monitor.
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
        along(population, distance, monitor, |look, length| {
            let begin = CurveRow::at(look, 0.0, work);
            if let Some(end) = end.filter(|end| (end.force - begin.force).abs() > SHOWN * largest) {
                curve.push(end);
                curve.push(begin);
            }
            while next < points && start + next as f64 * spacing <= look.position + length * (1.0 + 1e-12) {
                let a = start + next as f64 * spacing - look.position;
                curve.push(CurveRow::at(look, a.clamp(0.0, length), work));
                next += 1;
            }
            let last = CurveRow::at(look, length, work);
            largest = largest.max(last.force.abs());
            work = last.work;
            end = look.way.breaks.then_some(last);
            true
        })?;
        Ok(curve)
    }

    fn push(&mut self, state: CurveRow) {
        self.position.push(state.position);
        self.force.push(state.force);
        self.tangent.push(state.tangent);
        self.work.push(state.work);
    }

    /// X_T(X) = X + F/K, the drive at which each position is an equilibrium.
    pub fn drive(&self, stiffness: f64) -> Vec<f64> {
        let loading = Loading::Spring(stiffness);
        self.position.iter().zip(&self.force).map(|(&x, &f)| loading.drive(x, f)).collect()
    }

    /// Whether each equilibrium is stable, F' + K > 0.
    pub fn stable(&self, stiffness: f64) -> Vec<bool> {
        self.tangent.iter().map(|tangent| tangent + stiffness > 0.0).collect()
    }

    /// V(X_T, X) = ½K(X_T − X)² + ∫F dX at each position.
    pub fn potential(&self, stiffness: f64, drive: f64) -> Vec<f64> {
        let loading = Loading::Spring(stiffness);
        self.position.iter().zip(&self.work).map(|(&x, &work)| loading.stored(drive, x) + work).collect()
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
    /// At an advance `a` on the way ahead, `work` having been done before it.
    fn at(look: &EquilibriumPath<'_>, a: f64, work: f64) -> Self {
        let Response { force, tangent } = look.response(a);
        let work = work + look.integral(a, |_, response| response.force);
        Self { position: look.position + a, force, tangent, work }
    }
}

/// K_c = −min F' as the slider's bottom moves forward over `distance` from where a population stands, 0 where F
/// never falls; infinite where it jumps down. A block that is less stiff is unstable.
///
/// # Errors
/// A distance that is not above 0; those of the population; stopped by the monitor.
pub fn critical_stiffness(
    population: &dyn Population,
    distance: f64,
    monitor: &mut dyn Monitor,
) -> Result<f64> {
    let mut critical: f64 = 0.0;
    let mut end: Option<f64> = None;
    along(population, distance, monitor, |look, length| {
        let fallen = end.is_some_and(|end| look.here.force < end);
        critical = if fallen { f64::INFINITY } else { critical.max(-lowest_tangent(look, length)) };
        end = look.way.breaks.then(|| look.response(length).force);
        critical.is_finite()
    })?;
    Ok(critical)
}

/// The lowest tangent on the way ahead up to `length`.
fn lowest_tangent(look: &EquilibriumPath<'_>, length: f64) -> f64 {
    let ends = look.here.tangent.min(look.response(length).tangent);
    if look.way.straight {
        return ends;
    }
    let tangent = |a: f64| look.response(a).tangent;
    let place = |i: usize| match i {
        0 => 0.0,
        i if i <= NODES => 0.5 * length * (1.0 + RULE.nodes[i - 1]),
        _ => length,
    };
    let lowest = (1..=NODES).min_by(|&i, &j| tangent(place(i)).total_cmp(&tangent(place(j)))).unwrap_or(1);
    let (_, inside) = brent_minimum(tangent, place(lowest - 1), place(lowest + 1), 1e-9 * length);
    ends.min(inside)
}

/// Moves a copy of a population forward over `distance`, way by way, as long as `visit` of what is ahead and how much
/// of it is left says so.
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
    let mut look = EquilibriumPath::new(copy.as_mut(), Loading::Rigid, Direction::Forward, monitor)?;
    let start = look.position;
    for ways in 0_u32.. {
        let left = distance - (look.position - start);
        let length = look.way.length.min(left);
        if !visit(&look, length) || length >= left {
            return Ok(());
        }
        let breaks = look.way.breaks;
        look.advance(length)?;
        if breaks {
            look.cross()?;
        }
        look.towards(Direction::Forward)?;
        if ways.is_multiple_of(REPORT) {
            look.tell(1.0 - left / distance)?;
        }
    }
    Ok(())
}
