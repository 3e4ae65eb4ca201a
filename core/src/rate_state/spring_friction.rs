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
//!
//! Steps are those of J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6, 19 (1980), and where these would be unstable, as
//! behind a stiff spring, which the slider follows within a/K, those of the Rosenbrock method RODAS (E. Hairer and G. Wanner, Solving
//! Ordinary Differential Equations II, 2nd edition, Springer 1996, section VI.4), which is L-stable and of order 4.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::numerics::roots::brent_root_between;

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

/// Largest number of steps of the integration, those that end at a given place not counted: a slider that sticks and slips may
/// take any number.
const STEPS: usize = 40_000;

/// Largest step over the shortest time constant for the method of Dormand and Prince, which is stable up to 3.3.
const EXPLICIT: f64 = 2.0;

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
                let method = self.method(&before.y, by);
                let at = |by: f64| self.attempt(method, &before.y, by, 1.0).0;
                // A step of length 0 is not defined: its end is known.
                let ends = [(0.0, before.y[0]), (by, motion.y[0])];
                let by = brent_root_between(|by| at(by)[0], ends, 1e-12 * by)?;
                motion.y = at(by);
                break;
            }
        }
        Some(self.force(&motion))
    }

    /// A trial of a step of at most `most`. Returns how far it went: 0 if its error was too large.
    fn step(&self, motion: &mut SpringMotion, ratio: f64, most: f64) -> Option<f64> {
        let by = motion.width.min(most);
        let method = self.method(&motion.y, by);
        let (next, error) = self.attempt(method, &motion.y, by, ratio);
        // A step that was cut says little about the next one, unless it failed.
        if by == motion.width || error > 1.0 {
            motion.steps += 1;
            if motion.steps > STEPS {
                return None;
            }
            motion.width = by * (0.9 * error.max(1e-5).powf(-1.0 / method.order())).clamp(0.2, 5.0);
        }
        if error > 1.0 {
            return Some(0.0);
        }
        motion.y = next;
        let runs_away = next[0] > FASTEST || next[1..].iter().any(|u| *u < -FASTEST);
        (!runs_away).then_some(by)
    }

    /// The method for a step from here.
    fn method(&self, y: &StateVector, by: f64) -> StepMethod {
        if by * self.derivatives(y).fastest_decay() > EXPLICIT {
            StepMethod::Rosenbrock
        } else {
            StepMethod::DormandPrince
        }
    }

    /// A step, and its error in units of the tolerance.
    fn attempt(&self, method: StepMethod, y: &StateVector, by: f64, ratio: f64) -> (StateVector, f64) {
        let (next, error) = match method {
            StepMethod::DormandPrince => self.dormand_prince(y, by, ratio),
            StepMethod::Rosenbrock => self.rosenbrock(y, by, ratio),
        };
        // The second state variable has no effect where there is one alone; its error does not count.
        let counted = if self.states[1].evolution == 0.0 { 2 } else { 3 };
        let error = error[..counted].iter().map(|error| error.abs() / TOLERANCE);
        // The maximum of two numbers leaves out what is none.
        let largest =
            |largest: f64, error: f64| if error.is_nan() { f64::INFINITY } else { largest.max(error) };
        (next, error.fold(0.0, largest))
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

    /// The derivatives of the slopes.
    fn derivatives(&self, y: &StateVector) -> Derivatives {
        let velocity = y[0].exp();
        let states = [0, 1].map(|i| {
            let [across, own] = match self.law {
                StateLaw::Ageing => [-velocity, -(-y[i + 1]).exp()],
                StateLaw::Slip => [-velocity * (y[0] + y[i + 1] + 1.0), -velocity],
            };
            [across, own].map(|rate| rate / self.states[i].distance)
        });
        let effect = |i: usize, rate: f64| self.states[i].evolution * rate;
        let by_velocity = self.stiffness * velocity + effect(0, states[0][0]) + effect(1, states[1][0]);
        Derivatives {
            direct: -by_velocity / self.direct,
            by_states: [0, 1].map(|i| -effect(i, states[i][1]) / self.direct),
            states,
        }
    }

    /// A step of RODAS, and its error. The weights of the slopes are those of the transformed stages, which spare products with
    /// the Jacobian matrix.
    fn rosenbrock(&self, y: &StateVector, by: f64, ratio: f64) -> (StateVector, StateVector) {
        const GAMMA: f64 = 0.25;
        const PLACES: [[f64; 4]; 4] = [
            [1.544, 0.0, 0.0, 0.0],
            [0.946_678_528_081_582_6, 0.255_701_169_898_328_4, 0.0, 0.0],
            [3.314_825_187_068_521, 2.896_124_015_972_201, 0.998_641_913_997_781_7, 0.0],
            [1.221_224_509_226_641, 6.019_134_481_288_629, 12.537_083_329_320_87, -0.687_886_036_105_895],
        ];
        const COUPLING: [[f64; 5]; 5] = [
            [-5.6688, 0.0, 0.0, 0.0, 0.0],
            [-2.430_093_356_833_875, -0.206_359_915_709_191_5, 0.0, 0.0, 0.0],
            [-0.107_352_905_815_137_5, -9.594_562_251_023_355, -20.470_286_148_096_16, 0.0, 0.0],
            [
                7.496_443_313_967_647,
                -10.246_804_314_643_52,
                -33.999_903_528_199_05,
                11.708_908_932_061_6,
                0.0,
            ],
            [
                8.083_246_795_921_522,
                -7.981_132_988_064_893,
                -31.521_594_328_743_71,
                16.319_305_431_231_36,
                -6.058_818_238_834_054,
            ],
        ];
        let derivatives = self.derivatives(y);
        let (mut stages, mut place) = ([[0.0; 3]; 6], *y);
        for i in 0..stages.len() {
            place = match i {
                0 => *y,
                5 => std::array::from_fn(|j| place[j] + stages[4][j]),
                _ => std::array::from_fn(|j| y[j] + weighted(&PLACES[i - 1], &stages, j)),
            };
            let (slope, coupling) =
                (self.slope(&place, ratio), i.checked_sub(1).map(|before| COUPLING[before]));
            let coupled = |j: usize| coupling.map_or(0.0, |weights| weighted(&weights, &stages, j) / by);
            let right = std::array::from_fn(|j| slope[j] + coupled(j));
            stages[i] = derivatives.solve(1.0 / (GAMMA * by), right);
        }
        let error = stages[5];
        (std::array::from_fn(|j| place[j] + error[j]), error)
    }

    /// A step of the method of Dormand and Prince, of order 5, and its error.
    fn dormand_prince(&self, y: &StateVector, by: f64, ratio: f64) -> (StateVector, StateVector) {
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
            next = std::array::from_fn(|j| y[j] + by * weighted(weights, &slopes, j));
            slopes[i + 1] = self.slope(&next, ratio);
        }
        (next, std::array::from_fn(|j| by * weighted(&ERROR, &slopes, j)))
    }
}

/// A component of a weighted sum.
fn weighted(weights: &[f64], vectors: &[StateVector], j: usize) -> f64 {
    weights.iter().zip(vectors).map(|(weight, vector)| weight * vector[j]).sum()
}

/// The method of a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum StepMethod {
    DormandPrince,
    Rosenbrock,
}

impl StepMethod {
    /// The power of the step in its estimated error.
    fn order(self) -> f64 {
        match self {
            Self::DormandPrince => 5.0,
            Self::Rosenbrock => 4.0,
        }
    }
}

/// The Jacobian matrix of the slopes. State variables do not act on each other.
struct Derivatives {
    /// Of the slope of w by w.
    direct: f64,
    /// Of the slope of w by each state variable.
    by_states: [f64; 2],
    /// Of the slope of each state variable, by w and by itself.
    states: [[f64; 2]; 2],
}

impl Derivatives {
    /// About the inverse of the shortest time constant.
    fn fastest_decay(&self) -> f64 {
        -self.direct.min(self.states[0][1]).min(self.states[1][1])
    }

    /// Solves (σ − J) x = r: the state variables are eliminated.
    fn solve(&self, shift: f64, right: StateVector) -> StateVector {
        let own = self.states.map(|[_, own]| shift - own);
        let sum = |of: [f64; 2]| self.by_states[0] * of[0] / own[0] + self.by_states[1] * of[1] / own[1];
        let schur = shift - self.direct - sum([self.states[0][0], self.states[1][0]]);
        let w = (right[0] + sum([right[1], right[2]])) / schur;
        [w, (right[1] + self.states[0][0] * w) / own[0], (right[2] + self.states[1][0] * w) / own[1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn friction(law: StateLaw, stiffness: f64) -> SpringFriction {
        let states = [
            StateVariable { evolution: 0.015, distance: 1.0 },
            StateVariable { evolution: -0.004, distance: 4.0 },
        ];
        SpringFriction::new(0.01, &states, law, stiffness)
    }

    /// A step of half the length has a 32nd of the error or less, and about a 16th of the estimated one.
    #[test]
    fn rodas_is_of_order_four() {
        for law in [StateLaw::Ageing, StateLaw::Slip] {
            let friction = friction(law, 0.5);
            let start = [0.3, -0.2, 0.1];
            let end = |by: f64| {
                let half = friction.dormand_prince(&start, 0.5 * by, 2.0).0;
                friction.dormand_prince(&half, 0.5 * by, 2.0).0
            };
            let apart = |by: f64| {
                let (next, error) = friction.rosenbrock(&start, by, 2.0);
                let exact = end(by);
                let distance = |a: &StateVector| a.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                (distance(&std::array::from_fn(|j| next[j] - exact[j])), distance(&error))
            };
            let (long, short) = (apart(2e-3), apart(1e-3));
            assert!(long.0 / short.0 > 24.0, "{law:?}: {long:?} {short:?}");
            assert!((12.0..20.0).contains(&(long.1 / short.1)), "{law:?}: {long:?} {short:?}");
        }
    }

    /// Behind a very stiff spring the slider moves as the load point. By the slip law, each state variable is then
    /// u = −ln r (1 − e^{−x/D}) at a displacement x.
    #[test]
    fn a_stiff_spring_is_a_rigid_one() {
        let ratio = std::f64::consts::E;
        for stiffness in [1e4, 1e8] {
            let friction = friction(StateLaw::Slip, stiffness);
            let mut motion = friction.steady();
            for pair in [0.0, 0.3, 1.0, 5.0, 20.0].windows(2) {
                let end = pair[1];
                friction.advance(&mut motion, ratio, (end - pair[0]) / ratio).unwrap();
                let expected = friction.states.iter().fold(friction.direct, |sum, state| {
                    sum + state.evolution * (-end / state.distance).exp_m1()
                });
                // The spring stretches by F/K, and the slider lags by that: dF/dx is 0.015 at most.
                let error = (friction.force(&motion) - expected).abs();
                assert!(error < 4e-4 / stiffness + 1e-8, "{stiffness} {end}: {error:e}");
                assert!(motion.steps < 400, "{}", motion.steps);
            }
        }
    }

    /// A slider behind a very stiff spring rests in a hold; the age of its contacts grows by the time τ, and the force after it
    /// is higher by b ln(1 + τ).
    #[test]
    fn healing_behind_a_stiff_spring_is_that_of_a_rigid_one() {
        for stiffness in [1e4, 1e6, 1e8] {
            let state = [StateVariable { evolution: 0.015, distance: 1.0 }];
            let friction = SpringFriction::new(0.01, &state, StateLaw::Ageing, stiffness);
            for hold in [1.0, 30.0, 1000.0] {
                let mut motion = friction.steady();
                friction.advance(&mut motion, 0.0, hold).unwrap();
                let peak = friction.peak(motion).unwrap();
                let expected = 0.015 * (1.0 + hold).ln();
                // The spring relaxes by up to 0.1 in the hold and stretches again: the slider moves by 0.2/K, over which the age
                // falls by this part of itself. Steps have errors of 1e-7 and less.
                assert!(
                    (peak - expected).abs() < 0.015 * 0.2 / stiffness + 1e-6,
                    "{stiffness} {hold}: {peak} {expected}"
                );
            }
        }
    }
}
