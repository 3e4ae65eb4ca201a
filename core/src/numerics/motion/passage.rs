//! A motion over a straight piece of force, by the power series in time.

use super::Body;
use crate::numerics::roots::brent_root;

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
    if acceleration < 0.0 && square <= 0.0 {
        return -speed / acceleration;
    }
    2.0 * length / (speed + square.sqrt())
}
