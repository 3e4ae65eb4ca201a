//! Motion of a body under a linear force: in closed form without damping, as a power series in time with
//! damping.

use super::Body;
use crate::numerics::roots::brent_root;

/// The motion under a linear force up to the end of the given interval, or to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearPassage {
    /// Duration.
    pub time: f64,
    /// Distance.
    pub distance: f64,
    /// Velocity at the end; exactly 0 at rest.
    pub speed: f64,
    /// ∫u̇² dt with damping, else 0.
    pub squared: f64,
}

/// Reciprocals of whole numbers.
static INVERSE: [f64; 48] = {
    let mut inverse = [0.0; 48];
    let mut n = 1;
    while n < 48 {
        inverse[n] = 1.0 / n as f64;
        n += 1;
    }
    inverse
};

/// Largest number of terms of the power series.
const TERMS: usize = 24;

/// Longest passage in units of the shortest time scale of the motion: the last term is then 1e-19, and a
/// motion from rest to rest takes two passages.
const LONGEST: f64 = 1.6;

/// Terms below this, relative to the first ones, are dropped.
const NEGLIGIBLE: f64 = 1e-17;

/// Relative size of the last Newton step: the next one would be its square.
const LAST: f64 = 1e-9;

/// Newton steps before Brent's method is used.
const MOST_STEPS: usize = 8;

impl Body {
    /// The motion from velocity `speed` ≥ 0 over a distance of at most `length` (which may be infinite) under
    /// the force `excess` − `resistance` × distance. With damping it ends early where the series would
    /// converge slowly.
    pub fn passage(&self, speed: f64, excess: f64, resistance: f64, length: f64) -> LinearPassage {
        if speed == 0.0 && excess <= 0.0 {
            LinearPassage { time: 0.0, distance: 0.0, speed: 0.0, squared: 0.0 }
        } else if self.damping > 0.0 {
            self.damped(speed, excess, resistance, length)
        } else {
            self.undamped(speed, excess, resistance, length)
        }
    }

    /// Without damping Mu̇² + ru² − 2gu is conserved (g the excess, r the resistance), which gives the
    /// distance to rest and the velocity at the end. u̇ is a sine with ω² = r/M, so that tan(ωt/2) = ωu/(u̇
    /// before + u̇ after) for any distance u.
    fn undamped(&self, speed: f64, excess: f64, resistance: f64, length: f64) -> LinearPassage {
        let energy = self.mass * speed * speed;
        // Not a number if the body does not come to rest.
        let root = (excess * excess + resistance * energy).sqrt();
        let rest =
            if excess > 0.0 { (excess + root) / resistance.max(0.0) } else { energy / (root - excess) };
        let (distance, end) = if rest < length {
            (rest, 0.0)
        } else {
            // Rounding may put the kinetic energy at the end slightly below 0, where the body just
            // reaches the end.
            let left = energy + length * (2.0 * excess - resistance * length);
            (length, (left.max(0.0) / self.mass).sqrt())
        };
        let time = 2.0 * arc(distance, speed + end, resistance / self.mass);
        LinearPassage { time, distance, speed: end, squared: 0.0 }
    }

    fn damped(&self, speed: f64, excess: f64, resistance: f64, length: f64) -> LinearPassage {
        let (rate, stiffness) = (self.damping / self.mass, resistance / self.mass);
        let begin = (excess - self.damping * speed) / self.mass;
        let fastest = rate.max(stiffness.abs().sqrt());
        let (unit, guess) = (1.0 / fastest, uniform(speed, begin, length) * fastest);
        let first = [speed * unit, begin * unit * unit];
        // The scaled equation ü = a u̇ + b u has |a|, |b| ≤ 1, so that every term of the series has
        // a bound that does not depend on the parameters, and the number of terms is fixed.
        let series =
            PassageSeries::new(first, [-rate * unit, -stiffness * unit * unit], LONGEST.min(1.5 * guess));
        // u̇ = e^{−βt} [u̇₀ cos ωt + (ü₀ + βu̇₀)/ω sin ωt], 2β = γ/M, ω² = r/M − β².
        // Rest is known in closed form; the arrival at `length` is not, with damping.
        let beta = 0.5 * rate;
        let rest = arc(speed, -(begin + beta * speed), stiffness - beta * beta) * fastest;
        let PassageEnd { time, distance, speed } = series.end(length, guess, rest);
        LinearPassage {
            time: time * unit,
            distance,
            speed: speed * fastest,
            squared: series.squared(time) * fastest,
        }
    }
}

/// The smallest t ≥ 0 with tan(√s t)/√s = y/x, y ≥ 0. For s < 0 with tanh and √−s; negative or not a number
/// if there is none.
fn arc(y: f64, x: f64, s: f64) -> f64 {
    let root = s.abs().sqrt();
    match s {
        _ if y == 0.0 => 0.0,
        s if s > 0.0 => (root * y).atan2(x) / root,
        s if s < 0.0 => (root * y / x).atanh() / root,
        _ => y / x,
    }
}

/// The motion as a power series Σ d_n sⁿ/n! in time, in units of the shortest time scale.
struct PassageSeries {
    derivatives: [f64; TERMS],
    count: usize,
    /// ∂ü/∂u̇ and ∂ü/∂u.
    slopes: [f64; 2],
    /// Largest s.
    longest: f64,
}

/// Time, distance and velocity at the end of a motion.
struct PassageEnd {
    time: f64,
    distance: f64,
    speed: f64,
}

impl PassageSeries {
    /// The series from the first and second derivatives. No slope is above 1 in magnitude.
    fn new([first, second]: [f64; 2], slopes: [f64; 2], longest: f64) -> Self {
        let mut derivatives = [0.0; TERMS];
        (derivatives[1], derivatives[2]) = (first, second);
        let (mut before, mut last, mut count) = (first, second, 3);
        // Terms are bounded by longestⁿ/n!.
        let mut bound = 1.0;
        for (derivative, inverse) in derivatives[3..].iter_mut().zip(&INVERSE[3..]) {
            if bound <= NEGLIGIBLE {
                break;
            }
            (before, last) = (last, slopes[0] * last + slopes[1] * before);
            *derivative = last;
            bound *= longest * inverse;
            count += 1;
        }
        Self { derivatives, count, slopes, longest }
    }

    /// Distance and velocity at s.
    fn motion(&self, s: f64) -> (f64, f64) {
        let terms = self.derivatives[1..self.count].iter().zip(&INVERSE[1..]).rev();
        terms.fold((0.0, 0.0), |(place, speed), (d, inverse)| {
            let factor = s * inverse;
            ((place + d) * factor, d + speed * factor)
        })
    }

    /// The end of the motion: at the distance `length`, or at the time `rest` > 0 of rest, or where the
    /// series ends.
    fn end(&self, length: f64, guess: f64, rest: f64) -> PassageEnd {
        let rests = rest > 0.0 && rest <= self.longest;
        let last = if rests { rest } else { self.longest };
        let (distance, speed) = self.motion(last);
        if distance >= length {
            return self.arrival(length, guess.min(last), last);
        }
        PassageEnd { time: last, distance, speed: if rests { 0.0 } else { speed.max(0.0) } }
    }

    /// The time at which the distance, rising up to `last`, reaches `length`: Newton's method, then Brent's.
    fn arrival(&self, length: f64, guess: f64, last: f64) -> PassageEnd {
        let mut time = guess;
        for _ in 0..MOST_STEPS {
            let (place, speed) = self.motion(time);
            let step = (length - place) / speed;
            time = (time + step).clamp(0.0, last);
            if step.abs() <= LAST * time {
                // The velocity at the new time, to first order in the last step, whose square is
                // below rounding.
                let speed = speed + step * self.acceleration(place, speed);
                return PassageEnd { time, distance: length, speed: speed.max(0.0) };
            }
        }
        let time = brent_root(|s| self.motion(s).0 - length, 0.0, last, 0.0).unwrap_or(last);
        PassageEnd { time, distance: length, speed: self.motion(time).1.max(0.0) }
    }

    fn acceleration(&self, place: f64, speed: f64) -> f64 {
        let [_, first, second, ..] = self.derivatives;
        second + self.slopes[0] * (speed - first) + self.slopes[1] * place
    }

    /// ∫u̇² dt up to s, from the Taylor series of u̇², u̇ü and ü² at 0.
    fn squared(&self, s: f64) -> f64 {
        let [_, first, second, ..] = self.derivatives;
        let [by_speed, by_place] = self.slopes;
        let [mut p, mut q, mut r] = [first * first, first * second, second * second];
        let (mut sum, mut power, mut bound) = (0.0, s, 1.0);
        for inverse in &INVERSE[2..] {
            sum += p * power;
            power *= s * inverse;
            bound *= 2.0 * s * inverse;
            // u̇², u̇ü and ü² satisfy a linear system of equations, since ü is linear in u̇ and u:
            // their derivatives of all orders follow without products of series.
            [p, q, r] = [2.0 * q, r + by_speed * q + by_place * p, 2.0 * by_speed * r + 2.0 * by_place * q];
            if bound <= NEGLIGIBLE {
                break;
            }
        }
        sum
    }
}

/// The time to cover `length`, or to come to rest before, at constant acceleration; infinite if neither
/// happens.
pub fn uniform(speed: f64, acceleration: f64, length: f64) -> f64 {
    let square = speed * speed + 2.0 * acceleration * length;
    if acceleration < 0.0 && square <= 0.0 {
        return -speed / acceleration;
    }
    2.0 * length / (speed + square.sqrt())
}
