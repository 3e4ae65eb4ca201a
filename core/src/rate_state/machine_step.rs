//! A velocity step behind the spring of a machine: rate-and-state friction solved with the spring, and fitted to the curve.
//!
//! The load point moves at v₀ until X_T = 0 and at v from there on, and the spring K between it and the slider is in balance at
//! every time. With w = ln(V/v₀) for the velocity V of the slider, and u_i = ln(v₀θ_i/D_i) for one or two state variables,
//!
//! F = F₀ + a w + Σ b_i u_i, dF/dX_T = K (1 − e^w v₀/v),
//!
//! and du_i/dX_T = (v₀/v)(e^{−u_i} − e^w)/D_i by the ageing law dθ/dt = 1 − Vθ/D (J. H. Dieterich, J. Geophys. Res. 84, 2161
//! (1979)), −(v₀/v) e^w (w + u_i)/D_i by the slip law dθ/dt = −(Vθ/D) ln(Vθ/D) (A. Ruina, J. Geophys. Res. 88, 10359 (1983)).

use super::velocity_step::{FEWEST, VelocityStep};
use crate::error::positive;
use crate::monitor::{Monitor, report};
use crate::numerics::linear::solve;
use crate::{Error, Result};

/// The law by which a state variable evolves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StateLaw {
    /// dθ/dt = 1 − Vθ/D: it also evolves at rest.
    Ageing,
    /// dθ/dt = −(Vθ/D) ln(Vθ/D): it evolves with slip only.
    Slip,
}

/// A state variable of rate-and-state friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StateVariable {
    /// Evolution effect b, per factor e of velocity, a force.
    pub evolution: f64,
    /// Characteristic slip distance D, a length.
    pub distance: f64,
}

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

/// Largest number of iterations of a fit.
const ITERATIONS: usize = 60;

/// Relative change of the sum of squares at which a fit ends.
const SETTLED: f64 = 1e-10;

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
        let (low, high) = force.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), force| {
            (low.min(*force), high.max(*force))
        });
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
        let Self { direct, before, law, ratio, stiffness, .. } = *self;
        let mut friction = SpringFriction { direct, states: [NONE; 2], law };
        friction.states[..self.states.len()].copy_from_slice(&self.states);
        friction.step(displacement, ratio, stiffness).map_or_else(
            || vec![f64::NAN; displacement.len()],
            |changes| changes.iter().map(|change| before + change).collect(),
        )
    }
}

fn check(displacement: &[f64], force: &[f64], ratio: f64, stiffness: f64) -> Result<()> {
    positive("ratio", ratio)?;
    positive("stiffness", stiffness)?;
    if ratio == 1.0 {
        return Err(Error::invalid("ratio", "another velocity after the step", ratio));
    }
    if displacement.len() != force.len() {
        let expected = format!("{} forces, one for each displacement", displacement.len());
        return Err(Error::invalid("force", expected, force.len()));
    }
    for (name, values) in [("displacement", displacement), ("force", force)] {
        if let Some(i) = values.iter().position(|value| !value.is_finite()) {
            return Err(Error::invalid(format!("{name}.{i}"), "a finite number", values[i]));
        }
    }
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

/// A state variable without effect.
const NONE: StateVariable = StateVariable { evolution: 0.0, distance: 1.0 };

/// Rate-and-state friction of up to two state variables.
#[derive(Clone, Copy)]
struct SpringFriction {
    direct: f64,
    states: [StateVariable; 2],
    law: StateLaw,
}

/// w and u_i.
type StateVector = [f64; 3];

/// Error of a step of the integration, of w and u_i.
const TOLERANCE: f64 = 1e-8;

/// Largest number of steps of the integration.
const STEPS: usize = 1_000_000;

/// Largest w: a slider that runs away.
const FASTEST: f64 = 60.0;

impl SpringFriction {
    /// F − F₀ at displacements of the load point after a step of its velocity by the factor `ratio`; `None` if the slider runs
    /// away.
    fn step(&self, displacement: &[f64], ratio: f64, stiffness: f64) -> Option<Vec<f64>> {
        let (mut at, mut y, mut steps) = (0.0, [0.0; 3], 0);
        let shortest = self.states.iter().map(|state| state.distance).fold(f64::INFINITY, f64::min);
        let mut width = 1e-3 * shortest.min(self.direct / stiffness);
        let mut forces = Vec::with_capacity(displacement.len());
        for &end in displacement {
            while at < end {
                let by = width.min(end - at);
                let (next, error) = self.dormand_prince(&y, by, ratio, stiffness);
                steps += 1;
                if steps > STEPS {
                    return None;
                }
                if error <= 1.0 {
                    at = if by < width { end } else { at + by };
                    y = next;
                    if y.iter().any(|value| value.abs() > FASTEST) {
                        return None;
                    }
                }
                // A step that was cut at a displacement says little about the next one, unless it failed.
                if by == width || error > 1.0 {
                    width = by * (0.9 * error.max(1e-5).powf(-0.2)).clamp(0.2, 5.0);
                }
            }
            let states: f64 = self.states.iter().zip(&y[1..]).map(|(state, u)| state.evolution * u).sum();
            forces.push(self.direct * y[0] + states);
        }
        Some(forces)
    }

    /// Slopes along the displacement of the load point.
    fn slope(&self, y: &StateVector, ratio: f64, stiffness: f64) -> StateVector {
        let velocity = y[0].exp();
        let state = |i: usize| {
            let rate = match self.law {
                StateLaw::Ageing => (-y[i + 1]).exp() - velocity,
                StateLaw::Slip => -velocity * (y[0] + y[i + 1]),
            };
            rate / (ratio * self.states[i].distance)
        };
        let (first, second) = (state(0), state(1));
        let states = self.states[0].evolution * first + self.states[1].evolution * second;
        [(stiffness * (1.0 - velocity / ratio) - states) / self.direct, first, second]
    }

    /// A step of the method of Dormand and Prince (1980), of order 5, and its error in units of the tolerance.
    fn dormand_prince(&self, y: &StateVector, by: f64, ratio: f64, stiffness: f64) -> (StateVector, f64) {
        const STAGES: [[f64; 6]; 6] = [
            [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
            [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
            [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
            [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
            [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
        ];
        const ERROR: [f64; 7] = [
            71.0 / 57600.0,
            0.0,
            -71.0 / 16695.0,
            71.0 / 1920.0,
            -17253.0 / 339_200.0,
            22.0 / 525.0,
            -1.0 / 40.0,
        ];
        let mut slopes = [[0.0; 3]; 7];
        slopes[0] = self.slope(y, ratio, stiffness);
        let mut next = *y;
        for (i, weights) in STAGES.iter().enumerate() {
            next = std::array::from_fn(|j| {
                y[j] + by * weights.iter().zip(&slopes).map(|(weight, slope)| weight * slope[j]).sum::<f64>()
            });
            slopes[i + 1] = self.slope(&next, ratio, stiffness);
        }
        // The second state variable has no effect where there is one alone; its error does not count.
        let counted = if self.states[1].evolution == 0.0 { 2 } else { 3 };
        let error = |j: usize| {
            let sum: f64 = ERROR.iter().zip(&slopes).map(|(weight, slope)| weight * slope[j]).sum();
            (by * sum).abs() / TOLERANCE
        };
        let error = (0..counted).map(error).fold(0.0, f64::max);
        (next, if error.is_finite() { error } else { f64::INFINITY })
    }
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
        let mut best: Option<(Vec<f64>, f64)> = None;
        for (i, (values, states)) in starts.iter().enumerate() {
            report(monitor, i as f64 / starts.len() as f64)?;
            let found = if *states == 1 {
                self.least_squares::<4>(values, monitor)?
            } else {
                self.least_squares::<6>(values, monitor)?
            };
            if let Some(found) = found
                && best.as_ref().is_none_or(|best| found.1 < best.1)
            {
                best = Some(found);
            }
        }
        report(monitor, 1.0)?;
        let Some((values, squares)) = best else {
            return Err(Error::invalid(
                "force",
                "a velocity step that rate-and-state friction describes",
                "another curve",
            ));
        };
        let mut states: Vec<StateVariable> = values[2..]
            .chunks_exact(2)
            .map(|pair| StateVariable { evolution: pair[0], distance: pair[1].exp() })
            .collect();
        states.sort_by(|a, b| a.distance.total_cmp(&b.distance));
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
        let mut friction = SpringFriction { direct: values[1].exp(), states: [NONE; 2], law: self.law };
        for (state, pair) in friction.states.iter_mut().zip(values[2..].chunks_exact(2)) {
            *state = StateVariable { evolution: pair[0], distance: pair[1].exp() };
        }
        if values.len() == 4 {
            friction.states[1].distance = friction.states[0].distance;
        }
        let computed = friction.step(self.displacement, self.ratio, self.stiffness)?;
        Some(self.force.iter().zip(computed).map(|(force, change)| force - values[0] - change).collect())
    }

    /// The values of N parameters with the least sum of squares, and that sum.
    fn least_squares<const N: usize>(
        &self,
        start: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(Vec<f64>, f64)>> {
        let sum = |residuals: &[f64]| residuals.iter().map(|r| r * r).sum::<f64>();
        let mut values: [f64; N] = std::array::from_fn(|i| start[i]);
        let Some(mut residuals) = self.residuals(&values) else { return Ok(None) };
        let (mut squares, mut damping) = (sum(&residuals), 1e-3);
        for _ in 0..ITERATIONS {
            report(monitor, 0.0)?;
            let Some(slopes) = self.slopes(&values, &residuals) else { break };
            let normal: [[f64; N]; N] = std::array::from_fn(|i| {
                std::array::from_fn(|j| slopes[i].iter().zip(&slopes[j]).map(|(a, b)| a * b).sum())
            });
            let right: [f64; N] =
                std::array::from_fn(|i| -slopes[i].iter().zip(&residuals).map(|(a, r)| a * r).sum::<f64>());
            let before = squares;
            let mut improved = false;
            while damping < 1e10 {
                let mut damped = normal;
                (0..N).for_each(|i| damped[i][i] *= 1.0 + damping);
                let step = solve(damped, right);
                let trial = step.map(|step| std::array::from_fn(|i| values[i] + step[i]));
                let tried = trial.and_then(|trial| Some((trial, self.residuals(&trial)?)));
                if let Some((trial, tried)) = tried.filter(|(_, tried)| sum(tried) < squares) {
                    (values, squares, residuals) = (trial, sum(&tried), tried);
                    damping = (0.1 * damping).max(1e-12);
                    improved = true;
                    break;
                }
                damping *= 10.0;
            }
            if !improved || before - squares <= SETTLED * squares {
                break;
            }
        }
        Ok(Some((values.to_vec(), squares)))
    }

    /// Derivatives of the residuals by the parameters, by differences; `None` where the slider runs away.
    fn slopes<const N: usize>(&self, values: &[f64; N], residuals: &[f64]) -> Option<[Vec<f64>; N]> {
        // The error of the integration over the change, and its square, are both some 1e-4.
        const CHANGE: f64 = 1e-4;
        let scale = self.range / self.ratio.ln().abs();
        let mut slopes = std::array::from_fn(|_| Vec::new());
        for (i, slopes) in slopes.iter_mut().enumerate() {
            // F₀ and b are forces, the others are logarithms.
            let change = if i == 0 || (i >= 2 && i % 2 == 0) { CHANGE * scale } else { CHANGE };
            let mut beside = *values;
            beside[i] += change;
            let other = self.residuals(&beside)?;
            *slopes = other.iter().zip(residuals).map(|(a, b)| (a - b) / change).collect();
        }
        Some(slopes)
    }
}
