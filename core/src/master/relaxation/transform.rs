//! φ̂, the Laplace transform of the breaking density of re-formed contacts, and the roots of φ̂(s) = 1: the first ones by the secant
//! method and by path following, and what they miss by the argument principle.

use std::f64::consts::{FRAC_PI_4, SQRT_2, TAU};

use num_complex::Complex64;

use crate::contacts::Contacts;
use crate::life::{Continuation, Life};
use crate::monitor::Watch;
use crate::numerics::order::sort_by_number;
use crate::numerics::zeros::{Rectangle, argument_change, turns};

/// Highest frequency searched, in units of 2π/(mean life).
const HARMONICS: f64 = 40.0;

/// Steps in which changes of the argument are followed, and the distance from the real axis, in units of 1/(mean life).
const STEP: f64 = 0.8;
const REAL: f64 = 1e-9;

/// Whether an oscillation lasts, to rounding.
pub(super) fn is_undamped(s: &Complex64) -> bool {
    -s.re < 1e-12 * s.norm()
}

/// φ̂ and its zeros.
pub(super) struct Transform<'a, 'm> {
    reformed: &'a Life,
    mean: f64,
    /// φ̂ left of where the life determines it; `None` for contacts at a velocity.
    continuation: Option<Continuation>,
    /// Whether the continuation is exact everywhere: a closed form, and no contact re-forms among the
    /// thresholds.
    everywhere: bool,
    /// Whether the transform exists for Re s < 0 only by continuation: then only the pole closest to that of
    /// the Gaussian with the same mean and variance is computed.
    continued: bool,
    /// Smallest Re s for which the life, known to where S = 1e-18, determines the transform.
    known: f64,
    /// Smallest Re s for which a transform is known.
    pub leftmost: f64,
    /// −λ of thresholds whose tail falls like exp(−λx).
    decay: f64,
    watch: &'a Watch<'m>,
}

impl<'a, 'm> Transform<'a, 'm> {
    pub fn new(contacts: &'a Contacts, reformed: &'a Life, watch: &'a Watch<'m>) -> Self {
        let law = &contacts.thresholds;
        let apart = 1.0 - law.survival(contacts.reforming.upper_quantile(1e-18)) < 1e-15;
        let timed = contacts.rules.are_time_dependent();
        let continued = law.decay_rate() == 0.0 && !timed;
        // e^8 times the neglected 1e-18 is still below 1e-14.
        let known = -8.0 / reformed.breaking().curve().end();
        let continuation = (!timed).then(|| Continuation::new(contacts, known, watch));
        Self {
            reformed,
            mean: reformed.mean(),
            decay: if timed { f64::NEG_INFINITY } else { -law.decay_rate() },
            leftmost: continuation.as_ref().map_or(known, Continuation::leftmost),
            continuation,
            everywhere: apart && law.laplace_is_closed() && !timed,
            continued,
            known,
            watch,
        }
    }

    /// The continuation, where it is used instead of the life.
    fn laws(&self, s: Complex64) -> Option<&Continuation> {
        self.continuation.as_ref().filter(|_| self.everywhere || s.re < self.known)
    }

    /// φ̂(s).
    fn breaking(&self, s: Complex64) -> Complex64 {
        self.watch.value(|| {
            self.laws(s).map_or_else(|| self.reformed.breaking().transform(s).0, |laws| laws.transform(s))
        })
    }

    /// φ̂'(s); for the continuation by Cauchy's formula with eight points around s, exact to eighth order.
    pub fn slope(&self, s: Complex64) -> Complex64 {
        let Some(laws) = self.laws(s) else {
            return self.reformed.breaking().transform(s).1;
        };
        let radius = 0.02 / self.mean;
        // The trapezoidal rule on a circle converges geometrically for an analytic function (L. N.
        // Trefethen and J. A. C. Weideman, SIAM Rev. 56, 385 (2014)), while a difference quotient
        // would lose half of the digits.
        let around = (0..8).map(|k| Complex64::from_polar(radius, f64::from(k) * FRAC_PI_4));
        around.map(|h| laws.transform(s + h) / h).sum::<Complex64>() / 8.0
    }

    /// (1 − φ̂(s))/s, the transform of survival: its zeros are the roots without s = 0.
    fn survival(&self, s: Complex64) -> Complex64 {
        (1.0 - self.breaking(s)) / s
    }

    /// A frequency above which no root has Re s > `left`, or the highest one searched: |φ̂(s)| ≤ V/|s| < 1 there, V the total
    /// variation of φ(u) e^{−u Re s}.
    fn highest(&self, left: f64) -> f64 {
        /// V right of `left` is up to 3/2 of that at `left`, which is computed from single points.
        const MARGIN: f64 = 1.8;
        /// Least frequency searched, in harmonics.
        const FEWEST: f64 = 2.5;
        let harmonic = TAU / self.mean;
        let all = (HARMONICS + 0.5) * harmonic;
        let breaking = self.reformed.breaking();
        // Farther to the left the unknown end of the life may count; left of the decay rate of the thresholds φ̂ is no integral.
        let variation = if left < self.last_term().max(0.9 * self.decay) {
            self.continuation.as_ref().and_then(|laws| laws.variation(left))
        } else {
            breaking.atoms().next().is_none().then(|| breaking.curve().variation(left))
        };
        variation.map_or(all, |variation| (MARGIN * variation).clamp(FEWEST * harmonic, all))
    }

    /// Smallest Re s of terms of the expansion: amplitudes further left are below the accuracy of the lives.
    fn last_term(&self) -> f64 {
        -25.0 / self.reformed.force().curve().end()
    }

    /// The secant method for ln φ̂, which is nearly polynomial where φ̂ is large, from a guess. Returns a
    /// root in the upper half plane, left of the imaginary axis and right of `leftmost`.
    fn polish(&self, guess: Complex64) -> Option<Complex64> {
        let mut before = (guess, self.breaking(guess));
        let mut s = guess + 1e-3 / self.mean;
        for _ in 0..60 {
            let value = self.breaking(s);
            // Secant step for ln φ̂(s) = 0 (mod 2πi).
            let step = value.ln() * (s - before.0) / (value / before.1).ln();
            // Roots are about 2π/mean apart: a longer step would lead to another one, which has its
            // own guess.
            if !step.is_finite() || step.norm() > 4.0 / self.mean {
                return None;
            }
            before = (s, value);
            s -= step;
            if step.norm() < 1e-14 * s.norm() {
                break;
            }
        }
        let residue = (self.breaking(s) - 1.0).norm();
        let inside = s.im * self.mean > 1e-3 && s.re < 1e-9 / self.mean && s.re > self.leftmost;
        (inside && residue < 1e-10).then_some(s)
    }

    /// Roots with 0 < Im s ≤ Ω, [`Self::highest`], slowest first: from the minima of |1 − φ̂| on the imaginary axis, from the
    /// roots of the Gaussian with the same mean and variance, and the first ones by path following from s = 0. The argument
    /// principle tells whether a root lies to the right of the slowest, which is then searched for. `None` where no root is the
    /// slowest beyond doubt.
    pub fn roots(&self) -> Option<Vec<Complex64>> {
        /// Roots sought by path following: the first ones, where they are far from the imaginary axis.
        const FOLLOWED: usize = 3;
        if self.continued {
            return Some(self.harmonics(3).filter_map(|guess| self.polish(guess)).take(1).collect());
        }
        let top = self.highest(self.last_term()).min(HARMONICS * TAU / self.mean);
        let axis = self.minima_on_the_axis(top).into_iter().map(|s| s - 1e-3 / self.mean);
        let gaussian = self.harmonics(HARMONICS as u32).filter(|s| s.re > self.last_term());
        let mut found = self.polished(axis.chain(gaussian));
        if found.len() < FOLLOWED || !self.starts_with_slowest(&found) {
            let guesses: Vec<_> = found.into_iter().chain(self.by_path_following(FOLLOWED)).collect();
            found = self.polished(guesses.into_iter());
        }
        if self.starts_with_slowest(&found) {
            return Some(found);
        }
        let slowest = self.slowest_right_of(found.first().map_or(self.leftmost, |s| 0.999 * s.re))?;
        Some(self.polished(slowest.into_iter().chain(found)))
    }

    /// Points near the first roots, where ln φ̂ = −2πi j, as far as they are reached from s = 0 along the curve |φ̂(s)| = 1
    /// without a long step.
    fn by_path_following(&self, most: usize) -> Vec<Complex64> {
        /// Steps from one root to the next, and bisections of a step.
        const STEPS: u32 = 12;
        const BISECTIONS: i32 = 6;
        let (mut s, mut t, mut step) = (Complex64::ZERO, 0.0, 1.0 / f64::from(STEPS));
        let mut roots = Vec::new();
        while roots.len() < most && step > 2.0_f64.powi(-BISECTIONS) / f64::from(STEPS) {
            let next = (roots.len() + 1) as f64;
            let to = if t + 1.01 * step > next { next } else { t + step };
            match self.path_step(s, t, to) {
                Some(at) if at.re > self.leftmost => {
                    (s, t) = (at, to);
                    if t == next {
                        roots.push(s);
                    }
                }
                _ => step *= 0.5,
            }
        }
        roots
    }

    /// From the point s at which ln φ̂ = −2πi t to the one at which it is −2πi `to`, by a chord method. `None` where it is too
    /// far for it.
    fn path_step(&self, s: Complex64, t: f64, to: f64) -> Option<Complex64> {
        let distance = 1e-4 / self.mean;
        let [below, above] = [-distance, distance].map(|h| self.breaking(s + h));
        let slope = (above / below).ln() / (2.0 * distance);
        let step = Complex64::new(0.0, TAU * (t - to)) / slope;
        let target = Complex64::from_polar(1.0, -TAU * to);
        let mut at = s + step;
        for _ in 0..8 {
            let correction = (self.breaking(at) / target).ln() / slope;
            at -= correction;
            if !at.is_finite() || (at - s - step).norm() > 0.4 * step.norm() {
                return None;
            }
            if correction.norm() < 1e-3 * step.norm() {
                return Some(at);
            }
        }
        None
    }

    /// Whether the first of these roots is the slowest of all.
    fn starts_with_slowest(&self, found: &[Complex64]) -> bool {
        let Some(slowest) = found.first() else {
            return false;
        };
        // A line left of it counts those beside it, too, unless another root is in its way.
        let all_right_of = |left: f64| {
            let top = self.highest(left);
            let known = found.iter().filter(|s| s.re > left && s.im <= top).count();
            self.zeros_right_of(left) == Some(known as i64)
        };
        let lines = [1.001, 0.999].map(|share| share * slowest.re);
        is_undamped(slowest) || lines.into_iter().any(|left| left > self.leftmost && all_right_of(left))
    }

    /// The roots from these guesses, slowest first.
    fn polished(&self, guesses: impl Iterator<Item = Complex64>) -> Vec<Complex64> {
        let mut found: Vec<Complex64> = Vec::new();
        for guess in guesses {
            let new = |s: &Complex64| !found.iter().any(|r| (r - s).norm() < 1e-6 / self.mean);
            found.extend(self.polish(guess).filter(new));
        }
        sort_by_number(&mut found, |item| -item.re);
        found
    }

    /// The slowest roots right of `edge`, searched for at growing distances from the imaginary axis. `None` where they are not
    /// found for certain.
    fn slowest_right_of(&self, edge: f64) -> Option<Vec<Complex64>> {
        // The transform is singular at the decay rate of the thresholds.
        let edge = edge.max((1.0 - 1e-6) * self.leftmost);
        let mut right = 0.0;
        while right > edge {
            let left = edge.max((SQRT_2 * right).min(-0.5 / self.mean));
            let count = self.zeros_right_of(left)?;
            if count > 0 {
                return self.first_between(left, right, count);
            }
            right = left;
        }
        Some(Vec::new())
    }

    /// The slowest of `count` roots with `left` < Re s < `right`, right of which there is none, by bisection.
    fn first_between(&self, mut left: f64, mut right: f64, mut count: i64) -> Option<Vec<Complex64>> {
        /// Frequencies that are searched first, in harmonics: where broad distributions have roots that far to the left.
        const LOW: f64 = 3.0;
        while count > 1 && right - left > 1e-6 * right.abs() {
            let middle = 0.5 * (left + right);
            match self.zeros_right_of(middle)? {
                0 => right = middle,
                fewer => (left, count) = (middle, fewer),
            }
        }
        let survival = |s| self.survival(s);
        let (step, refine) = (STEP / self.mean, |s| self.polish(s));
        let top = self.highest(left);
        let low_top = top.min(LOW * TAU / self.mean);
        let corner = |re, im| Complex64::new(re, im);
        let below = Rectangle { low: corner(left, REAL / self.mean), high: corner(right, low_top) };
        let of_below = below.zeros(&survival, step)?;
        let mut found = below.locate(&survival, step, &refine, of_below)?;
        if of_below != count {
            let above = Rectangle { low: corner(left, low_top), high: corner(right, top) };
            found.extend(above.locate(&survival, step, &refine, count - of_below)?);
        }
        Some(found)
    }

    /// Where |1 − φ̂| is least on the imaginary axis, up to a frequency.
    fn minima_on_the_axis(&self, top: f64) -> Vec<Complex64> {
        let step = 0.3 / self.mean;
        let at = |k: usize| Complex64::new(0.0, (k + 1) as f64 * step);
        let line: Vec<f64> =
            (0..=(top / step) as usize).map(|k| (1.0 - self.breaking(at(k))).norm()).collect();
        let inner = 1..line.len().saturating_sub(1);
        inner.filter(|&k| line[k] <= line[k - 1] && line[k] < line[k + 1]).map(at).collect()
    }

    /// The first roots of the Gaussian of equal mean and variance, [x̄ − √(x̄² − 4πijσ²)]/σ².
    fn harmonics(&self, count: u32) -> impl Iterator<Item = Complex64> {
        let (mean, variance) = (self.mean, self.variance());
        (1..=count).map(move |j| {
            let argument_change = Complex64::new(0.0, 2.0 * TAU * f64::from(j) * variance);
            (mean - (mean * mean - argument_change).sqrt()) / variance
        })
    }

    /// Variance of the advance survived.
    fn variance(&self) -> f64 {
        let points = self.reformed.survival().curve().points(f64::INFINITY);
        let second: f64 = points.iter().map(|(u, weight)| 2.0 * u * weight).sum();
        (second - self.mean * self.mean).max(1e-12 * self.mean * self.mean)
    }

    /// Number of zeros of the transform of survival with Re s > `left`, 0 < Im s ≤ Ω, by the argument principle; `None` where
    /// it is not found. On the real axis the transform is real and positive, so that the path need not be closed there.
    fn zeros_right_of(&self, left: f64) -> Option<i64> {
        let (top, right) = (self.highest(left), 1.0 / self.mean);
        let right_top = Complex64::new(right, top);
        let left_top = Complex64::new(left, top);
        let [right_bottom, left_bottom] = [right, left].map(|re| Complex64::new(re, REAL / self.mean));
        let change = |a, b| argument_change(&|s| self.survival(s), a, b, STEP / self.mean);
        let sides = [change(right_top, left_top)?, change(left_top, left_bottom)?];
        turns(self.argument_change_to_the_right(right_bottom, right_top) + sides.iter().sum::<f64>())
    }

    /// Change of the argument of the transform of survival from a to b in the right half plane, where |φ̂| < 1 leaves the real
    /// part of 1 − φ̂ above 0, so that neither its argument nor that of s goes round.
    fn argument_change_to_the_right(&self, a: Complex64, b: Complex64) -> f64 {
        let argument = |s: Complex64| (1.0 - self.breaking(s)).arg() - s.arg();
        argument(b) - argument(a)
    }
}
