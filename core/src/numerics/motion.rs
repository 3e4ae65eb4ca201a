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
const TERMS: usize = 24;

/// How long a passage may be, in the shortest time of the motion: the last term is then 1e-19, and a motion from
/// rest to rest takes two of them.
const LONGEST: f64 = 1.6;

/// A term of the power series, of the first ones, that is left out.
const NEGLIGIBLE: f64 = 1e-17;

/// Newton steps after which a zero is searched for otherwise.
const MOST_STEPS: usize = 8;

impl Body {
    /// The motion at `speed` ≥ 0 over up to `length` (which may be infinite), against the excess of force `excess` −
    /// `resistance` × way; not for longer than the series converges well.
    pub fn passage(&self, speed: f64, excess: f64, resistance: f64, length: f64) -> Passage {
        let (rate, stiffness) = (self.damping / self.mass, resistance / self.mass);
        let begin = (excess - self.damping * speed) / self.mass;
        let fastest = rate.max(stiffness.abs().sqrt());
        let time = (LONGEST / fastest).min(1.5 * uniform(speed, begin, length));
        let series = Series::new(speed, begin, rate, stiffness, time, fastest * time);
        let rest = if series.slope(1.0) < 0.0 { series.rest() } else { None };
        let last = rest.unwrap_or(1.0);
        let arrives = series.place(last) >= length;
        let end = if arrives { series.arrival(length, last) } else { last };
        Passage {
            time: end * time,
            way: if arrives { length } else { series.place(end) },
            speed: if rest.is_some() && !arrives { 0.0 } else { series.slope(end).max(0.0) / time },
            squared: if rate > 0.0 { series.squared(end) / time } else { 0.0 },
        }
    }
}

/// The way u(s) as a power series in the share s of a time; the term of s⁰ is 0.
struct Series {
    terms: [f64; TERMS],
    count: usize,
}

impl Series {
    /// ü + rate u̇ + stiffness u = const, from ü = `begin` at `speed`; terms fall as ratioⁿ/n!.
    fn new(speed: f64, begin: f64, rate: f64, stiffness: f64, time: f64, ratio: f64) -> Self {
        let mut terms = [0.0; TERMS];
        (terms[1], terms[2]) = (speed * time, 0.5 * begin * time * time);
        let (rate, stiffness) = (rate * time, stiffness * time * time);
        let (mut bound, mut count) = (1.0, 3);
        while bound > NEGLIGIBLE && count < TERMS {
            let n = count as f64;
            terms[count] =
                -(rate * (n - 1.0) * terms[count - 1] + stiffness * terms[count - 2]) / (n * (n - 1.0));
            bound *= ratio / n;
            count += 1;
        }
        Self { terms, count }
    }

    fn place(&self, s: f64) -> f64 {
        self.terms[1..self.count].iter().rev().fold(0.0, |sum, u| (sum + u) * s)
    }

    fn slope(&self, s: f64) -> f64 {
        (1..self.count).rev().fold(0.0, |sum, n| sum * s + n as f64 * self.terms[n])
    }

    /// Where the slope, negative at 1, has its zero.
    fn rest(&self) -> Option<f64> {
        brent_root(|s| self.slope(s), 0.0, 1.0, 0.0).filter(|s| *s > 0.0)
    }

    /// Where the way, rising up to `last`, comes to `length`.
    fn arrival(&self, length: f64, last: f64) -> f64 {
        let mut s = 0.5 * last;
        for _ in 0..MOST_STEPS {
            let step = (length - self.place(s)) / self.slope(s);
            s = (s + step).clamp(0.0, last);
            if step.abs() <= 2.0 * f64::EPSILON * s {
                return s;
            }
        }
        brent_root(|s| self.place(s) - length, 0.0, last, 0.0).unwrap_or(last)
    }

    /// ∫_0^s (du/ds)² ds.
    fn squared(&self, s: f64) -> f64 {
        let slopes: [f64; TERMS] = std::array::from_fn(|n| n as f64 * self.terms[n]);
        let (mut sum, mut power) = (0.0, s);
        for degree in 2..2 * self.count - 1 {
            let first = (degree + 1).saturating_sub(self.count).max(1);
            let product: f64 = (first..self.count.min(degree)).map(|n| slopes[n] * slopes[degree - n]).sum();
            sum += product * power / (degree - 1) as f64;
            power *= s;
        }
        sum
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Place and speed of ü + 2βu̇ + ω²u = g from rest at 0.
    fn oscillator(beta: f64, square: f64, push: f64, time: f64) -> (f64, f64) {
        let (omega, away) = ((square - beta * beta).sqrt(), push / square);
        let (sin, cos) = (omega * time).sin_cos();
        let decay = (-beta * time).exp();
        let place = away * (1.0 - decay * (cos + beta / omega * sin));
        (place, away * decay * square / omega * sin)
    }

    const BODY: Body = Body { mass: 2.0, damping: 0.4 };
    const PUSH: f64 = 1.5;
    const RESISTANCE: f64 = 3.0;

    #[test]
    fn a_step_follows_a_damped_oscillator() {
        let force = |u: f64| (PUSH - RESISTANCE * u, -RESISTANCE);
        let step = BODY.step((0.0, 0.0), 2.0, 1e-13, force).unwrap();
        for s in [0.3, 1.0] {
            let (place, speed) = oscillator(0.1, 1.5, 0.75, 2.0 * s);
            let found = step.at(s);
            // Rounding of sums over 16 points.
            assert!((found.0 - place).abs() < 1e-14 && (found.1 - speed).abs() < 1e-14, "{found:?}");
        }
        // Work done against the damping: what the force gave less what is stored and moves.
        let (place, speed) = step.at(1.0);
        let lost = PUSH * place - 0.5 * RESISTANCE * place * place - 0.5 * BODY.mass * speed * speed;
        assert!((BODY.damping * step.squared() - lost).abs() < 1e-14);
        assert_eq!(BODY.step((0.0, 0.0), 40.0, 1e-13, force), None);
    }

    #[test]
    fn passages_add_up_to_the_first_rest_of_a_damped_oscillator() {
        let (mut place, mut speed, mut time, mut squared) = (0.0, 0.0, 0.0, 0.0);
        loop {
            let passage = BODY.passage(speed, PUSH - RESISTANCE * place, RESISTANCE, 0.07);
            (place, speed, time) = (place + passage.way, passage.speed, time + passage.time);
            squared += passage.squared;
            if speed == 0.0 {
                break;
            }
            let exact = oscillator(0.1, 1.5, 0.75, time);
            // Rounding of some twenty passages, and of a time that a slow beginning magnifies.
            assert!((place - exact.0).abs() < 1e-13 && (speed - exact.1).abs() < 1e-13, "{time} {exact:?}");
        }
        let rest = std::f64::consts::PI / (1.5_f64 - 0.01).sqrt();
        // The way is flat where it ends: time is known to the root of its rounding.
        assert!((time - rest).abs() < 1e-7 && (place - oscillator(0.1, 1.5, 0.75, rest).0).abs() < 1e-13);
        let lost = PUSH * place - 0.5 * RESISTANCE * place * place;
        assert!((BODY.damping * squared - lost).abs() < 1e-13);
    }

    #[test]
    fn a_body_runs_on_where_nothing_resists() {
        let passage = Body { mass: 1.0, damping: 0.0 }.passage(1.0, 0.0, 0.0, 3.0);
        assert_eq!((passage.time, passage.way, passage.speed), (3.0, 3.0, 1.0));
    }
}
