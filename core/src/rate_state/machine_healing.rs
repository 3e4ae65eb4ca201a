//! Healing behind the spring of a machine: rate-and-state friction solved with the spring through slide–hold–slide tests, and
//! fitted to the peaks of the force and to its relaxation in the holds.
//!
//! The load point moves at v, rests for the time of the hold and moves at v again (J. H. Dieterich, J. Geophys. Res. 77, 3690
//! (1972)). In the hold the slider creeps on and unloads the spring; after it the force is highest where the slider has
//! reached v. Peak and relaxation thus depend on the stiffness of the machine, on v and on the law of the state variable
//! (N. M. Beeler, T. E. Tullis and J. D. Weeks, Geophys. Res. Lett. 21, 1987 (1994); C. Marone, Annu. Rev. Earth Planet. Sci. 26,
//! 643 (1998)). The equations are those of a slider behind a spring (`spring_friction`).

use super::extent;
use super::healing::check_holds;
use super::levenberg_marquardt::{CHANGE, best_of, least_squares};
use super::spring_friction::{SpringFriction, StateLaw, StateVariable};
use crate::error::{finite, positive};
use crate::monitor::Monitor;
use crate::numerics::order::sort_by_number;
use crate::{Error, Result};

/// Slide–hold–slide tests in a machine, each from steady sliding.
#[derive(Debug, Clone, Copy)]
pub struct HoldTests<'a> {
    /// Times of the holds, above 0.
    pub hold: &'a [f64],
    /// The highest force after each hold.
    pub peak: &'a [f64],
    /// The force at the end of each hold, if it is known.
    pub held: Option<&'a [f64]>,
    /// F₀, the force of steady sliding before the holds; 0 if all forces are differences from it.
    pub before: f64,
    /// Velocity v of the load point before and after the holds, above 0.
    pub velocity: f64,
    /// Stiffness K of the machine, a force per length, above 0.
    pub stiffness: f64,
}

/// Rate-and-state friction behind a spring, fitted to slide–hold–slide tests. Forces are in the unit of the tests. What the fit
/// leaves is stated as a misfit; there are no errors of the parameters, for which the forces would need a noise that is known.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MachineHealing {
    /// Root-mean-square residual of the fit, a force.
    pub residual: f64,
    /// The residual relative to the difference between the largest and the smallest force, F₀ among them.
    pub residual_relative: f64,
    /// Direct effect a, per factor e of velocity, a force: found if the forces at the ends of the holds are given.
    pub direct: f64,
    /// The state variable: evolution effect b and characteristic slip distance D.
    pub state: StateVariable,
    /// F₀.
    pub before: f64,
    /// The law of the state variable.
    pub law: StateLaw,
    /// Velocity v of the load point.
    pub velocity: f64,
    /// Stiffness K of the machine, a force per length.
    pub stiffness: f64,
}

/// Distances v t of the search for D, in units of that in the shortest hold.
const DISTANCES: [f64; 4] = [0.1, 1.0, 10.0, 100.0];

/// Direct effects at which a search for it starts, in units of the first b.
const DIRECTS: [f64; 2] = [0.5, 1.5];

impl MachineHealing {
    /// Fits b and D, and a unless it is the given `direct` effect.
    ///
    /// Least squares by the method of Levenberg and Marquardt, from several starts. Peaks alone do not determine a: after long
    /// holds they grow by b per factor e of hold time, from a time on that depends on D and on a/K. The forces at the ends of the
    /// holds do, or a velocity step ([`MachineStep`](super::MachineStep)).
    ///
    /// # Errors
    /// Fewer than 4 holds, or numbers of forces that differ from theirs; hold times, a velocity, a stiffness or a direct effect
    /// that are not above 0; forces that are all the same; neither a direct effect nor forces at the ends of the holds; a stop by
    /// the monitor.
    pub fn read(
        tests: &HoldTests<'_>,
        law: StateLaw,
        direct: Option<f64>,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        check(tests, direct)?;
        let curve = HoldForces::new(tests, law)?;
        let changes = [direct.map_or(CHANGE, |_| 0.0), CHANGE * curve.range, CHANGE];
        let best = best_of(&curve.starts(direct), monitor, |start, part| {
            least_squares(*start, changes, |values| curve.residuals(values), part)
        })?;
        let undescribed =
            || Error::invalid("force", "healing behind this spring", "a slider that runs away in every fit");
        let (values, squares) = best.ok_or_else(undescribed)?;
        Ok(curve.found(&values, squares))
    }

    /// The highest force after each hold, and the force at its end; all NaN where the slider runs away in one of them.
    pub fn forces(&self, hold: &[f64]) -> Vec<(f64, f64)> {
        let friction = SpringFriction::new(self.direct, &[self.state], self.law, self.stiffness);
        match held(&friction, hold, self.velocity) {
            Some(changes) => {
                changes.iter().map(|(peak, held)| (self.before + peak, self.before + held)).collect()
            }
            None => vec![(f64::NAN, f64::NAN); hold.len()],
        }
    }
}

/// F − F₀ at the peak after each hold and at the end of the hold; `None` where the slider runs away. A longer hold continues from
/// the end of the shorter one.
fn held(friction: &SpringFriction, hold: &[f64], velocity: f64) -> Option<Vec<(f64, f64)>> {
    let mut order: Vec<usize> = (0..hold.len()).collect();
    sort_by_number(&mut order, |&i| hold[i]);
    let (mut motion, mut time) = (friction.steady(), 0.0);
    let mut changes = vec![(0.0, 0.0); hold.len()];
    for i in order {
        friction.advance(&mut motion, 0.0, velocity * (hold[i] - time))?;
        time = hold[i];
        changes[i] = (friction.peak(motion.clone())?, friction.force(&motion));
    }
    Some(changes)
}

/// Tests to be fitted, with forces above F₀.
struct HoldForces<'a> {
    tests: &'a HoldTests<'a>,
    law: StateLaw,
    /// Difference between the largest and the smallest force, F₀ among them.
    range: f64,
}

impl<'a> HoldForces<'a> {
    fn new(tests: &'a HoldTests<'a>, law: StateLaw) -> Result<Self> {
        let forces = tests.peak.iter().chain(tests.held.unwrap_or_default());
        let (low, high) = extent(forces.chain([&tests.before]));
        if high <= low {
            return Err(Error::invalid("force", "forces that differ from that of steady sliding", low));
        }
        Ok(Self { tests, law, range: high - low })
    }

    /// Values of ln a, b and ln D at which fits start.
    fn starts(&self, direct: Option<f64>) -> Vec<[f64; 3]> {
        let HoldTests { hold, peak, velocity, .. } = *self.tests;
        let longest = (0..hold.len()).max_by(|&i, &j| hold[i].total_cmp(&hold[j])).unwrap_or(0);
        let (shortest, _) = extent(hold);
        let mut starts = Vec::new();
        for distance in DISTANCES.map(|factor| factor * velocity * shortest) {
            let grown = (velocity * hold[longest] / distance).ln_1p();
            let evolution = (peak[longest] - self.tests.before) / grown;
            let scale = evolution.abs().max(1e-3 * self.range);
            match direct {
                Some(direct) => starts.push([direct.ln(), evolution, distance.ln()]),
                None => {
                    starts.extend(DIRECTS.map(|factor| [(factor * scale).ln(), evolution, distance.ln()]))
                }
            }
        }
        starts
    }

    /// Residuals at ln a, b and ln D; `None` where the slider runs away.
    fn residuals(&self, &[direct, evolution, distance]: &[f64; 3]) -> Option<Vec<f64>> {
        let state = StateVariable { evolution, distance: distance.exp() };
        let friction = SpringFriction::new(direct.exp(), &[state], self.law, self.tests.stiffness);
        let changes = held(&friction, self.tests.hold, self.tests.velocity)?;
        let before = self.tests.before;
        let peaks = self.tests.peak.iter().zip(&changes).map(|(force, change)| force - before - change.0);
        let ends = self.tests.held.unwrap_or_default().iter().zip(&changes);
        let ends = ends.map(|(force, change)| force - before - change.1);
        Some(peaks.chain(ends).collect())
    }

    fn found(&self, &[direct, evolution, distance]: &[f64; 3], squares: f64) -> MachineHealing {
        let HoldTests { peak, held, before, velocity, stiffness, .. } = *self.tests;
        let count = peak.len() + held.unwrap_or_default().len();
        let residual = (squares / count as f64).sqrt();
        MachineHealing {
            residual,
            residual_relative: residual / self.range,
            direct: direct.exp(),
            state: StateVariable { evolution, distance: distance.exp() },
            before,
            law: self.law,
            velocity,
            stiffness,
        }
    }
}

fn check(tests: &HoldTests<'_>, direct: Option<f64>) -> Result<()> {
    let HoldTests { hold, peak, held, before, velocity, stiffness } = *tests;
    check_holds(hold, [("force", peak)].into_iter().chain(held.map(|held| ("held", held))))?;
    finite("before", before)?;
    positive("velocity", velocity)?;
    positive("stiffness", stiffness)?;
    match (direct, held) {
        (Some(direct), _) => positive("a", direct).map(drop),
        (None, Some(_)) => Ok(()),
        (None, None) => {
            let expected = "a of a velocity step, or held, the forces at the ends of the holds: peaks alone do not determine a";
            Err(Error::invalid("a", expected, "neither"))
        }
    }
}
