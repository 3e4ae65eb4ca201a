//! A velocity step behind the spring of a machine: rate-and-state friction solved with the spring, and fitted to the curve.
//!
//! The load point moves at v₀ until X_T = 0 and at v from there on. The equations are those of a slider behind a spring
//! (`spring_friction`).

use super::extent;
use super::levenberg_marquardt::{CHANGE, best_of, least_squares};
use super::spring_friction::{SpringFriction, StateLaw, StateVariable};
use super::velocity_step::{FEWEST, VelocityStep};
use crate::error::{all_finite, as_many, positive};
use crate::monitor::Monitor;
use crate::numerics::order::sort_by_number;
use crate::{Error, Result};

/// Rate-and-state friction behind a spring, fitted to a velocity step. Forces are in the unit of the curve. What the fit leaves
/// is stated as a misfit; there are no errors of the parameters, for which the curve would need a noise that is known.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct MachineStep {
    /// Root-mean-square residual of the fit, a force.
    pub residual: f64,
    /// The residual relative to the difference between the largest and the smallest force.
    pub residual_relative: f64,
    /// Direct effect a, per factor e of velocity, a force.
    pub direct: f64,
    /// The state variables, the one of the shorter distance first.
    pub states: Vec<StateVariable>,
    /// F₀, the force before the step.
    pub before: f64,
    /// The law of the state variables.
    pub law: StateLaw,
    /// v/v₀.
    pub ratio: f64,
    /// Stiffness K of the spring, a force per length.
    pub stiffness: f64,
}

/// A velocity step to be fitted.
struct StepCurve<'a> {
    displacement: &'a [f64],
    force: &'a [f64],
    ratio: f64,
    stiffness: f64,
    law: StateLaw,
    /// Difference between the largest and the smallest force.
    range: f64,
}

/// Factors of the distance, of a first reading without a spring, at which fits start.
const STARTS: [f64; 3] = [0.2, 1.0, 4.0];

impl MachineStep {
    /// Fits a velocity step by the factor `ratio`: `force` against `displacement` of the load point, which is 0 at the step and
    /// rises; at negative displacements the force is F₀. The spring has the given `stiffness`. There are one or two `states`.
    ///
    /// Least squares by the method of Levenberg and Marquardt, from several starts.
    ///
    /// # Errors
    /// Numbers of displacements and forces that differ, fewer than 8 points after the step, displacements that do not rise, a
    /// ratio or a stiffness that is not above 0, a ratio of 1, another number of states; a constant force; a stop by the monitor.
    pub fn read(
        displacement: &[f64],
        force: &[f64],
        ratio: f64,
        stiffness: f64,
        (law, states): (StateLaw, usize),
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        check(displacement, force, ratio, stiffness)?;
        let (low, high) = extent(force);
        if high <= low {
            return Err(Error::invalid("force", "a force that changes", low));
        }
        let curve = StepCurve { displacement, force, ratio, stiffness, law, range: high - low };
        let start = curve.start();
        match states {
            1 => curve.fitted(&STARTS.map(|factor| start.with([(1.0, factor)])), monitor),
            2 => {
                let pairs = [[(0.5, 0.3), (0.5, 3.0)], [(1.0, 0.3), (0.3, 3.0)], [(1.0, 1.0), (-0.3, 5.0)]];
                curve.fitted(&pairs.map(|parts| start.with(parts)), monitor)
            }
            other => Err(Error::invalid("states", "1 or 2 state variables", other)),
        }
    }

    /// The fitted force at rising displacements of the load point.
    pub fn forces(&self, displacement: &[f64]) -> Vec<f64> {
        let friction = SpringFriction::new(self.direct, &self.states, self.law, self.stiffness);
        changes(&friction, displacement, self.ratio).map_or_else(
            || vec![f64::NAN; displacement.len()],
            |changes| changes.iter().map(|change| self.before + change).collect(),
        )
    }
}

fn check(displacement: &[f64], force: &[f64], ratio: f64, stiffness: f64) -> Result<()> {
    positive("ratio", ratio)?;
    positive("stiffness", stiffness)?;
    if ratio == 1.0 {
        return Err(Error::invalid("ratio", "another velocity after the step", ratio));
    }
    as_many("force", force.len(), (displacement.len(), "forces, one for each displacement"))?;
    all_finite("displacement", displacement)?;
    all_finite("force", force)?;
    if let Some(i) = displacement.windows(2).position(|pair| pair[1] <= pair[0]) {
        let expected = format!("a number above {}", displacement[i]);
        return Err(Error::invalid(format!("displacement.{}", i + 1), expected, displacement[i + 1]));
    }
    let after = displacement.iter().filter(|x| **x > 0.0).count();
    if after < FEWEST {
        return Err(Error::invalid("displacement", format!("{FEWEST} points after the step"), after));
    }
    Ok(())
}

/// F − F₀ at displacements of the load point after a step of its velocity by the factor `ratio`; `None` if the slider runs away.
fn changes(friction: &SpringFriction, displacement: &[f64], ratio: f64) -> Option<Vec<f64>> {
    let (mut motion, mut at) = (friction.steady(), 0.0);
    let mut forces = Vec::with_capacity(displacement.len());
    for &end in displacement {
        if end > at {
            friction.advance(&mut motion, ratio, (end - at) / ratio)?;
            at = end;
        }
        forces.push(friction.force(&motion));
    }
    Some(forces)
}

/// The state variables of F₀, ln a, and b and ln D of each.
fn states_of(values: &[f64]) -> Vec<StateVariable> {
    let pairs = values[2..].chunks_exact(2);
    pairs.map(|pair| StateVariable { evolution: pair[0], distance: pair[1].exp() }).collect()
}

/// Where a fit starts: F₀, a, b and D.
#[derive(Clone, Copy)]
struct StartValues {
    before: f64,
    direct: f64,
    evolution: f64,
    distance: f64,
}

impl StartValues {
    /// With state variables whose b and D are these multiples: F₀, ln a, and b and ln D of each.
    fn with<const S: usize>(self, parts: [(f64, f64); S]) -> (Vec<f64>, usize) {
        let mut values = vec![self.before, self.direct.ln()];
        for (evolution, distance) in parts {
            values.extend([evolution * self.evolution, (distance * self.distance).ln()]);
        }
        (values, S)
    }
}

impl StepCurve<'_> {
    /// From a reading without a spring.
    fn start(&self) -> StartValues {
        let first = self.displacement.partition_point(|x| *x <= 0.0);
        let known = &self.force[..first.max(1)];
        let before = known.iter().sum::<f64>() / known.len() as f64;
        let (after, force) = (&self.displacement[first..], &self.force[first..]);
        let scale = self.range / self.ratio.ln().abs();
        let read = VelocityStep::read(after, force, before, self.ratio);
        let (direct, evolution, distance) = read
            .map_or((scale, scale, 0.1 * after[after.len() - 1]), |read| {
                (read.direct, read.evolution, read.distance)
            });
        // A direct effect is lost where the spring is soft.
        let direct = direct.max(0.2 * scale).max(0.2 * evolution.abs());
        StartValues { before, direct, evolution, distance }
    }

    /// The best of the fits from these starts.
    fn fitted(&self, starts: &[(Vec<f64>, usize)], monitor: &mut dyn Monitor) -> Result<MachineStep> {
        let best = best_of(starts, monitor, |(values, states), part| {
            if *states == 1 { self.nearest::<4>(values, part) } else { self.nearest::<6>(values, part) }
        })?;
        let Some((values, squares)) = best else {
            return Err(Error::invalid(
                "force",
                "a velocity step that rate-and-state friction describes behind this spring",
                "another curve: in every fit the slider runs away",
            ));
        };
        let mut states = states_of(&values);
        sort_by_number(&mut states, |item| item.distance);
        let residual = (squares / self.force.len() as f64).sqrt();
        Ok(MachineStep {
            residual,
            residual_relative: residual / self.range,
            direct: values[1].exp(),
            states,
            before: values[0],
            law: self.law,
            ratio: self.ratio,
            stiffness: self.stiffness,
        })
    }

    /// Residuals at F₀, ln a, and b and ln D of each state variable; `None` where the slider runs away.
    fn residuals(&self, values: &[f64]) -> Option<Vec<f64>> {
        let friction = SpringFriction::new(values[1].exp(), &states_of(values), self.law, self.stiffness);
        let computed = changes(&friction, self.displacement, self.ratio)?;
        Some(self.force.iter().zip(computed).map(|(force, change)| force - values[0] - change).collect())
    }

    /// The values of N parameters with the least sum of squares, and that sum.
    fn nearest<const N: usize>(
        &self,
        start: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(Vec<f64>, f64)>> {
        let scale = self.range / self.ratio.ln().abs();
        // F₀ and b are forces, the others are logarithms.
        let changes = std::array::from_fn(|i| if i % 2 == 1 { CHANGE } else { CHANGE * scale });
        let start: [f64; N] = std::array::from_fn(|i| start[i]);
        let found = least_squares(start, changes, |values| self.residuals(values), monitor)?;
        Ok(found.map(|(values, squares)| (values.to_vec(), squares)))
    }
}
