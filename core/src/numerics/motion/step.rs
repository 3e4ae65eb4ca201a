//! A time step of a motion under a smooth force, by Gauss collocation.

use std::sync::LazyLock;

use super::Body;
use crate::numerics::legendre::{NODES, Nodal, RULE, dot, series};
use crate::numerics::linear::solve;
use crate::numerics::piecewise::tail;

/// A time step from u = `place` with velocity `speed`; the acceleration is a polynomial of degree 15 in time.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionStep {
    /// Duration.
    pub time: f64,
    /// u at the start.
    pub place: f64,
    /// u̇ at the start.
    pub speed: f64,
    /// ü at the Gauss points.
    pub acceleration: Nodal,
}

/// Integrals of the cardinal polynomials l_j of the Gauss points c_i of `[0, 1]`: `once[i][j]` = ∫_0^{c_i}
/// l_j, the Butcher matrix of the method, and `twice[i][j]` = ∫_0^{c_i} (c_i − s) l_j.
struct Integrals {
    once: [Nodal; NODES],
    twice: [Nodal; NODES],
}

static INTEGRALS: LazyLock<Integrals> = LazyLock::new(|| {
    let moment = |i: usize, j: usize, weight: &dyn Fn(f64) -> f64| {
        RULE.integrate(0.0, point(i), |s| weight(point(i) - s) * RULE.cardinals(2.0 * s - 1.0)[j])
    };
    let matrix =
        |weight: &dyn Fn(f64) -> f64| std::array::from_fn(|i| std::array::from_fn(|j| moment(i, j, weight)));
    Integrals { once: matrix(&|_| 1.0), twice: matrix(&|gap| gap) }
});

/// Gauss point on `[0, 1]`.
fn point(i: usize) -> f64 {
    0.5 * (1.0 + RULE.nodes[i])
}

/// Newton iterations before a step counts as too long.
const MOST_ITERATIONS: usize = 12;

impl Body {
    /// A step of the given duration; `force` returns f and f'. `None` if Newton's method does not converge,
    /// or the truncation error of the velocity exceeds `tolerance`.
    pub fn step(
        &self,
        (place, speed): (f64, f64),
        time: f64,
        tolerance: f64,
        force: impl Fn(f64) -> (f64, f64),
    ) -> Option<MotionStep> {
        let Self { mass, damping } = *self;
        let begin = (force(place).0 - damping * speed) / mass;
        let mut step = MotionStep { time, place, speed, acceleration: [begin; NODES] };
        for _ in 0..MOST_ITERATIONS {
            let (places, speeds) = (step.places(), step.speeds());
            let mut matrix = [[0.0; NODES]; NODES];
            let mut right = [0.0; NODES];
            for i in 0..NODES {
                let (f, slope) = force(places[i]);
                right[i] = f - damping * speeds[i] - mass * step.acceleration[i];
                for j in 0..NODES {
                    // Jacobian of the collocation equations for the accelerations at the Gauss points.
                    let damped = damping * time * INTEGRALS.once[i][j];
                    matrix[i][j] = damped - slope * time * time * INTEGRALS.twice[i][j];
                }
                matrix[i][i] += mass;
            }
            let change = solve(matrix, right)?;
            for (a, change) in step.acceleration.iter_mut().zip(&change) {
                *a += change;
            }
            // Quadratic convergence: the next change would be smaller than the square of this one.
            if time * change.iter().fold(0.0, |most: f64, a| most.max(a.abs())) <= tolerance {
                // Gauss collocation has order 32, is symmetric and conserves quadratic invariants
                // (E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration, Springer
                // 2006, § IV.2): long swings do not drift in energy.
                return (step.error() <= tolerance).then_some(step);
            }
        }
        None
    }
}

impl MotionStep {
    /// u at the Gauss points.
    pub fn places(&self) -> Nodal {
        let path = |i: usize| dot(&INTEGRALS.twice[i], &self.acceleration);
        std::array::from_fn(|i| self.place + self.time * (point(i) * self.speed + self.time * path(i)))
    }

    /// u̇ at the Gauss points.
    pub fn speeds(&self) -> Nodal {
        std::array::from_fn(|i| self.speed + self.time * dot(&INTEGRALS.once[i], &self.acceleration))
    }

    /// Times of the Gauss points since the start.
    pub fn times(&self) -> Nodal {
        std::array::from_fn(|i| self.time * point(i))
    }

    /// u and u̇ at the fraction s of the step.
    pub fn at(&self, s: f64) -> (f64, f64) {
        let coefficients = RULE.coefficients(&self.acceleration);
        let a = |r: f64| series(&coefficients, 2.0 * r - 1.0);
        let gained = RULE.integrate(0.0, s, a);
        let path = RULE.integrate(0.0, s, |r| (s - r) * a(r));
        (self.place + self.time * (s * self.speed + self.time * path), self.speed + self.time * gained)
    }

    /// ∫u̇² dt.
    pub fn squared(&self) -> f64 {
        0.5 * self.time * dot(&RULE.weights, &self.speeds().map(|v| v * v))
    }

    /// Truncation error of the velocity.
    fn error(&self) -> f64 {
        self.time * tail(&RULE.coefficients(&self.acceleration))
    }
}
