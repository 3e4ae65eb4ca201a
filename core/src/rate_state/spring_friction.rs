//! Rate-and-state friction of a slider that a load point pulls through a spring, solved in time.
//!
//! The spring K is in balance at every time. With w = ln(V/v₀) for the velocity V of the slider, u_i = ln(v₀θ_i/D_i) for one or
//! two state variables, and the time τ = v₀t, a length,
//!
//! F = F₀ + a w + Σ b_i u_i, dF/dτ = K (r − e^w),
//!
//! where r v₀ is the velocity of the load point, and du_i/dτ = (e^{−u_i} − e^w)/D_i by the ageing law dθ/dt = 1 − Vθ/D
//! (J. H. Dieterich, J. Geophys. Res. 84, 2161 (1979)), −e^w (w + u_i)/D_i by the slip law dθ/dt = −(Vθ/D) ln(Vθ/D) (A. Ruina,
//! J. Geophys. Res. 88, 10359 (1983)).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::numerics::roots::brent_root;

/// The law by which a state variable evolves.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StateLaw {
    /// dθ/dt = 1 − Vθ/D: it also evolves at rest.
    #[default]
    Ageing,
    /// dθ/dt = −(Vθ/D) ln(Vθ/D): it evolves with slip only.
    Slip,
}

/// A state variable of rate-and-state friction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StateVariable {
    /// Evolution effect b, per factor e of velocity, a force.
    pub evolution: f64,
    /// Characteristic slip distance D, a length.
    pub distance: f64,
}

/// Rate-and-state friction of up to two state variables, behind a spring.
pub(super) struct SpringFriction {
    direct: f64,
    states: [StateVariable; 2],
    law: StateLaw,
    stiffness: f64,
}

/// w and u_i.
type StateVector = [f64; 3];

/// The motion of a slider: w and u_i, and the width in τ of the next step of the integration.
#[derive(Clone)]
pub(super) struct SpringMotion {
    y: StateVector,
    width: f64,
    steps: usize,
}

/// Error of a step of the integration, of w and u_i.
const TOLERANCE: f64 = 1e-8;

/// Largest number of steps of the integration, those that end at a given place not counted. Steps are not much longer than a/K,
/// also in steady sliding: a curve over more than some 10⁵ a/K is left to larger a, which it does not distinguish.
const STEPS: usize = 40_000;

/// Largest w and −u_i: a slider that runs away.
const FASTEST: f64 = 60.0;

/// Largest w and u_i of a slider that has come to steady sliding.
const STEADY: f64 = 1e-7;

impl SpringFriction {
    /// The direct effect a, one or two state variables, and the spring.
    pub fn new(direct: f64, states: &[StateVariable], law: StateLaw, stiffness: f64) -> Self {
        // Without effect, a second state variable evolves as the first, so that it asks for no shorter steps.
        let second = states.get(1).copied().unwrap_or(StateVariable { evolution: 0.0, ..states[0] });
        Self { direct, states: [states[0], second], law, stiffness }
    }

    /// Steady sliding at v₀.
    pub fn steady(&self) -> SpringMotion {
        let shortest = self.states.iter().map(|state| state.distance).fold(f64::INFINITY, f64::min);
        SpringMotion { y: [0.0; 3], width: 1e-3 * shortest.min(self.direct / self.stiffness), steps: 0 }
    }

    /// F − F₀ of a motion.
    pub fn force(&self, motion: &SpringMotion) -> f64 {
        let states: f64 = self.states.iter().zip(&motion.y[1..]).map(|(state, u)| state.evolution * u).sum();
        self.direct * motion.y[0] + states
    }

    /// Moves the load point at r v₀, r = `ratio`, for the `duration` τ; `None` if the slider runs away, or
    /// after too many steps.
    pub fn advance(&self, motion: &mut SpringMotion, ratio: f64, duration: f64) -> Option<()> {
        let mut left = duration;
        while left > 0.0 {
            left -= self.step(motion, ratio, left)?;
        }
        Some(())
    }

    /// F − F₀ where the force is highest once the load point moves at v₀ again after a hold: where the slider, too, has reached
    /// this velocity. The steady force if it comes to it from below; `None` if it does not.
    pub fn peak(&self, mut motion: SpringMotion) -> Option<f64> {
        while motion.y.iter().any(|value| value.abs() > STEADY) {
            let before = motion.clone();
            let by = self.step(&mut motion, 1.0, f64::INFINITY)?;
            if by > 0.0 && before.y[0] < 0.0 && motion.y[0] >= 0.0 {
                let at = |by: f64| self.dormand_prince(&before.y, by, 1.0).0;
                let by = brent_root(|by| at(by)[0], 0.0, by, 1e-12 * by)?;
                motion.y = at(by);
                break;
            }
        }
        Some(self.force(&motion))
    }

    /// A trial of a step of at most `most`. Returns how far it went: 0 if its error was too large.
    fn step(&self, motion: &mut SpringMotion, ratio: f64, most: f64) -> Option<f64> {
        let by = motion.width.min(most);
        let (next, error) = self.dormand_prince(&motion.y, by, ratio);
        // A step that was cut says little about the next one, unless it failed.
        if by == motion.width || error > 1.0 {
            motion.steps += 1;
            if motion.steps > STEPS {
                return None;
            }
            motion.width = by * (0.9 * error.max(1e-5).powf(-0.2)).clamp(0.2, 5.0);
        }
        if error > 1.0 {
            return Some(0.0);
        }
        motion.y = next;
        let runs_away = next[0] > FASTEST || next[1..].iter().any(|u| *u < -FASTEST);
        (!runs_away).then_some(by)
    }

    /// Slopes along τ.
    fn slope(&self, y: &StateVector, ratio: f64) -> StateVector {
        let velocity = y[0].exp();
        let state = |i: usize| {
            let rate = match self.law {
                StateLaw::Ageing => (-y[i + 1]).exp() - velocity,
                StateLaw::Slip => -velocity * (y[0] + y[i + 1]),
            };
            rate / self.states[i].distance
        };
        let (first, second) = (state(0), state(1));
        let states = self.states[0].evolution * first + self.states[1].evolution * second;
        [(self.stiffness * (ratio - velocity) - states) / self.direct, first, second]
    }

    /// A step of the method of Dormand and Prince (1980), of order 5, and its error in units of the tolerance.
    fn dormand_prince(&self, y: &StateVector, by: f64, ratio: f64) -> (StateVector, f64) {
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
        slopes[0] = self.slope(y, ratio);
        let mut next = *y;
        for (i, weights) in STAGES.iter().enumerate() {
            next = std::array::from_fn(|j| {
                y[j] + by * weights.iter().zip(&slopes).map(|(weight, slope)| weight * slope[j]).sum::<f64>()
            });
            slopes[i + 1] = self.slope(&next, ratio);
        }
        // The second state variable has no effect where there is one alone; its error does not count.
        let counted = if self.states[1].evolution == 0.0 { 2 } else { 3 };
        let error = |j: usize| {
            let sum: f64 = ERROR.iter().zip(&slopes).map(|(weight, slope)| weight * slope[j]).sum();
            (by * sum).abs() / TOLERANCE
        };
        // The maximum of two numbers leaves out what is none.
        let largest =
            |largest: f64, error: f64| if error.is_nan() { f64::INFINITY } else { largest.max(error) };
        (next, (0..counted).map(error).fold(0.0, largest))
    }
}
