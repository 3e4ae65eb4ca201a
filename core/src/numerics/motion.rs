//! Motion of a body in time under a force that depends on where it is, and viscous damping: M ü = f(u) − γ u̇.
//!
//! Where f is smooth, collocation at the Gauss points of a step, of order 32 and stable whatever the damping
//! (E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I*, 1993, II.7 and II.14);
//! where f is a straight line, the power series of u in time.

use std::sync::LazyLock;

use super::legendre::{NODES, Nodal, RULE, dot, series};
use super::linear::solve;
use super::roots::brent_root;

/// M and γ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// M > 0.
    pub mass: f64,
    /// γ ≥ 0, force per speed.
    pub damping: f64,
}

/// A step in time from u = `place` at `speed`; the acceleration is a polynomial of degree 15.
#[derive(Debug, Clone, PartialEq)]
pub struct Step {
    /// Its duration.
    pub time: f64,
    /// u at the beginning.
    pub place: f64,
    /// u̇ at the beginning.
    pub speed: f64,
    /// ü at the Gauss points.
    pub acceleration: Nodal,
}

/// Integrals of the cardinal polynomials of the Gauss points c_i of `[0, 1]`: `once[i][j]` = ∫_0^{c_i} l_j and
/// `twice[i][j]` = ∫_0^{c_i} (c_i − s) l_j.
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

/// Gauss point of `[0, 1]`.
fn point(i: usize) -> f64 {
    0.5 * (1.0 + RULE.nodes[i])
}

/// Iterations after which a step is taken to be too long.
const MOST_ITERATIONS: usize = 12;

impl Body {
    /// The step of that duration, `force` giving f and f'; `None` where Newton's method does not converge, or the
    /// step leaves out more than `tolerance` of the speed.
    pub fn step(
        &self,
        (place, speed): (f64, f64),
        time: f64,
        tolerance: f64,
        force: impl Fn(f64) -> (f64, f64),
    ) -> Option<Step> {
        let Self { mass, damping } = *self;
        let begin = (force(place).0 - damping * speed) / mass;
        let mut step = Step { time, place, speed, acceleration: [begin; NODES] };
        for _ in 0..MOST_ITERATIONS {
            let (places, speeds) = (step.places(), step.speeds());
            let mut matrix = [[0.0; NODES]; NODES];
            let mut right = [0.0; NODES];
            for i in 0..NODES {
                let (f, slope) = force(places[i]);
                right[i] = f - damping * speeds[i] - mass * step.acceleration[i];
                for j in 0..NODES {
                    let damped = damping * time * INTEGRALS.once[i][j];
                    matrix[i][j] = damped - slope * time * time * INTEGRALS.twice[i][j];
                }
                matrix[i][i] += mass;
            }
            let change = solve(matrix, right)?;
            for (a, change) in step.acceleration.iter_mut().zip(&change) {
                *a += change;
            }
            // The next change would be smaller than the square of this one.
            if time * change.iter().fold(0.0, |most: f64, a| most.max(a.abs())) <= tolerance {
                return (step.error() <= tolerance).then_some(step);
            }
        }
        None
    }
}

impl Step {
    /// u at the Gauss points.
    pub fn places(&self) -> Nodal {
        let path = |i: usize| dot(&INTEGRALS.twice[i], &self.acceleration);
        std::array::from_fn(|i| self.place + self.time * (point(i) * self.speed + self.time * path(i)))
    }

    /// u̇ at the Gauss points.
    pub fn speeds(&self) -> Nodal {
        std::array::from_fn(|i| self.speed + self.time * dot(&INTEGRALS.once[i], &self.acceleration))
    }

    /// Times of the Gauss points since the beginning.
    pub fn times(&self) -> Nodal {
        std::array::from_fn(|i| self.time * point(i))
    }

    /// u and u̇ after the fraction s of the step.
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

    /// What the polynomial leaves out of the speed.
    fn error(&self) -> f64 {
        self.time * super::piecewise::tail(&RULE.coefficients(&self.acceleration))
    }
}

/// What a body does on a straight piece of force, until it comes to its end or to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// Time taken.
    pub time: f64,
    /// Way gone.
    pub way: f64,
    /// Speed at the end, exactly 0 at rest.
    pub speed: f64,
    /// ∫u̇² dt.
    pub squared: f64,
}

/// Most terms of the power series of a passage.
const TERMS: usize = 20;

impl Body {
    /// The motion at `speed` ≥ 0 over up to `length` (which may be infinite), against the excess of force `excess` −
    /// `resistance` × way; not for longer than the series converges well, half the shortest time of the motion.
    pub fn passage(&self, speed: f64, excess: f64, resistance: f64, length: f64) -> Passage {
        let rate = self.damping / self.mass;
        let stiffness = resistance / self.mass;
        let begin = (excess - self.damping * speed) / self.mass;
        let most = 0.5 / rate.max(stiffness.abs().sqrt());
        let time = most.min(2.0 * uniform(speed, begin, length));
        // Coefficients of (t/time)^n in u.
        let mut u = [0.0; TERMS];
        (u[1], u[2]) = (speed * time, 0.5 * begin * time * time);
        for n in 1..TERMS - 2 {
            let above = rate * time * (n + 1) as f64 * u[n + 1] + stiffness * time * time * u[n];
            u[n + 2] = -above / ((n + 1) * (n + 2)) as f64;
        }
        let slope = |s: f64| (1..TERMS).rev().fold(0.0, |sum, n| sum * s + n as f64 * u[n]);
        let place = |s: f64| (1..TERMS).rev().fold(0.0, |sum, n| (sum + u[n]) * s);
        let rest =
            if slope(1.0) < 0.0 { brent_root(slope, 0.0, 1.0, 0.0).filter(|s| *s > 0.0) } else { None };
        let last = rest.unwrap_or(1.0);
        let arrives = place(last) >= length;
        let end =
            if arrives { brent_root(|s| place(s) - length, 0.0, last, 0.0).unwrap_or(last) } else { last };
        let square = |s: f64| slope(s) * slope(s) / time;
        let squared = if self.damping > 0.0 { RULE.integrate(0.0, end, square) } else { 0.0 };
        Passage {
            time: end * time,
            way: if arrives { length } else { place(end) },
            speed: if rest.is_some() && !arrives { 0.0 } else { slope(end).max(0.0) / time },
            squared,
        }
    }
}

/// The time to go `length`, or to come to rest before, at uniform acceleration; infinite where neither happens.
pub fn uniform(speed: f64, acceleration: f64, length: f64) -> f64 {
    let square = speed * speed + 2.0 * acceleration * length;
    if acceleration < 0.0 && !(square > 0.0) {
        return -speed / acceleration;
    }
    2.0 * length / (speed + square.sqrt())
}
