//! The number of broken contacts as a function of time, and the contacts that re-form from them after the
//! delay, or after times of a distribution ([`FreeTimes`]).

use std::collections::VecDeque;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::free_contacts::{FreeAfter, FreeTimes, StepInterval};
use super::path::GAUSS;
use crate::contacts::FreeTime;
use crate::numerics::compensated::Compensated;

/// The fraction that breaks in a step: N(t) − N(t₀) in the middle and at the end of the step. N is quadratic
/// in between and rises.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct BrokenFraction {
    pub(super) middle: f64,
    pub(super) end: f64,
}

/// Contacts that form in a step: their fraction, and its first moment about the middle in units of the
/// duration.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct BirthMoments {
    pub(super) mass: f64,
    pub(super) moment: f64,
}

/// A finished step.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct BreakHistory {
    start: f64,
    duration: f64,
    /// N at its start, without simultaneous breaks.
    before: f64,
    fraction: BrokenFraction,
}

impl BreakHistory {
    fn interval(&self) -> StepInterval {
        StepInterval { start: self.start, duration: self.duration }
    }
}

/// Contacts that broke simultaneously.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct DelayedPointMass {
    pub(super) time: f64,
    pub(super) mass: f64,
}

/// N(t), the fraction of contacts broken until t, kept for the delay τ, or for the longest free time of a distribution with memory;
/// simultaneous breaks are kept separately.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(super) struct Broken {
    /// The longest time for which contacts are free.
    #[serde(skip)]
    delay: f64,
    /// The distribution of this time, if it is not the same for all.
    #[serde(skip)]
    times: Option<Arc<FreeTimes>>,
    past: VecDeque<BreakHistory>,
    waiting: VecDeque<DelayedPointMass>,
    /// Contacts that broke simultaneously, with their time, and re-form one by one.
    parted: VecDeque<DelayedPointMass>,
    /// All that broke one by one, and all that has re-formed from it.
    broken: Compensated,
    born: Compensated,
    /// All that broke simultaneously.
    struck: f64,
}

/// The fractions of the contacts formed at the two Gauss nodes of a step that break in it.
///
/// The fraction broken at an age of a steps is αa + βa² through both.
#[derive(Debug, Clone, Copy)]
pub(super) struct EarlyBreaks {
    pub(super) early: f64,
    pub(super) late: f64,
}

impl EarlyBreaks {
    /// α and β.
    pub(super) fn curve(self) -> (f64, f64) {
        let [short, long] = GAUSS;
        let (old, young) = (self.early / long, self.late / short);
        let beta = (old - young) / (long - short);
        (young - beta * short, beta)
    }
}

impl BrokenFraction {
    /// The closest fraction for which N rises throughout the step.
    pub(super) fn rising(self) -> Self {
        let end = self.end.max(0.0);
        // A parabola through 0, `middle` and `end` rises on the whole step exactly if `middle` lies
        // between these bounds.
        Self { middle: self.middle.clamp(0.25 * end, 0.75 * end), end }
    }

    /// The sum of two.
    pub(super) fn plus(self, other: Self) -> Self {
        Self { middle: self.middle + other.middle, end: self.end + other.end }
    }

    /// The same of the part of the step up to a fraction of the duration.
    pub(super) fn up_to(self, s: f64) -> Self {
        Self { middle: self.at(0.5 * s), end: self.at(s) }
    }

    /// dN/ds at the fraction s of the duration.
    pub(super) fn rate(self, s: f64) -> f64 {
        4.0 * (1.0 - 2.0 * s) * self.middle + (4.0 * s - 1.0) * self.end
    }

    /// N(t) − N(t₀) at a fraction of the duration.
    pub(super) fn at(self, s: f64) -> f64 {
        4.0 * s * (1.0 - s) * self.middle + s * (2.0 * s - 1.0) * self.end
    }

    /// dN/dt at the end of a step, of the polynomial through the known values of N in it and in the step
    /// before, if any.
    pub(super) fn slope(self, duration: f64, before: Option<(f64, Self)>) -> f64 {
        let mut points = vec![(-duration, -self.end), (-0.5 * duration, self.middle - self.end)];
        if let Some((earlier, fraction)) = before {
            let start = points[0];
            points.push((start.0 - 0.5 * earlier, start.1 + fraction.middle - fraction.end));
            points.push((start.0 - earlier, start.1 - fraction.end));
        }
        let term = |i: usize| {
            let others = (0..points.len()).filter(|&j| j != i);
            let weight: f64 = others.map(|j| points[j].0 / (points[j].0 - points[i].0)).product();
            weight * points[i].1 / points[i].0
        };
        (0..points.len()).map(term).sum()
    }
}

impl Broken {
    pub(super) fn new(delay: &FreeTime) -> Self {
        match delay {
            FreeTime::Fixed(delay) => Self { delay: *delay, ..Self::default() },
            FreeTime::Distributed(law) => {
                let times = FreeTimes::new(law);
                Self { delay: times.longest, times: Some(times), ..Self::default() }
            }
        }
    }

    /// The same with the free times of `other`, which are not serialised.
    pub(super) fn of(self, other: &Self) -> Self {
        Self { delay: other.delay, times: other.times.clone(), ..self }
    }

    /// N, simultaneous breaks included.
    pub(super) fn all(&self) -> f64 {
        self.broken.value() + self.struck
    }

    /// The fraction that has broken and has not re-formed yet.
    pub(super) fn free(&self) -> f64 {
        let waiting: f64 = self.waiting.iter().map(|point_mass| point_mass.mass).sum();
        (self.one_by_one() + waiting).max(0.0)
    }

    /// The free contacts that do not re-form simultaneously.
    fn one_by_one(&self) -> f64 {
        let mut free = self.broken;
        free.add(-self.born.value());
        free.value()
    }

    /// What contacts that broke before a step contribute to those that form in it; `None` with one delay for all.
    pub(super) fn free_before(&self, start: f64, duration: f64) -> Option<FreeAfter> {
        let (times, now) = (self.times.as_ref()?, StepInterval { start, duration });
        if let Some(free) = times.free_without_memory(self.one_by_one(), duration) {
            return Some(free);
        }
        let one_by_one =
            self.past.iter().map(|past| times.free(past.interval(), |s| past.fraction.rate(s), now));
        let parted = self.parted.iter().map(|broken| {
            let FreeAfter { end, integral } = times.free_of(broken.time, now);
            FreeAfter { end: broken.mass * end, integral: broken.mass * integral }
        });
        Some(one_by_one.chain(parted).fold(FreeAfter::default(), FreeAfter::plus))
    }

    /// Contacts that form in a step from `start`, in which `fraction` breaks; `before` is [`Self::free_before`] of the step.
    pub(super) fn births(
        &self,
        start: f64,
        duration: f64,
        fraction: BrokenFraction,
        before: Option<FreeAfter>,
    ) -> BirthMoments {
        let (Some(times), Some(before)) = (&self.times, before) else {
            return self.births_after_delay(start, duration, fraction);
        };
        let now = StepInterval { start, duration };
        let after = before.plus(times.free(now, |s| fraction.rate(s), now));
        // Contacts that are free at the start, and break in the step, less those that are free after it.
        let free = self.one_by_one();
        let mass = (free + fraction.end - after.end).max(0.0);
        let broken = (4.0 * fraction.middle + fraction.end) / 6.0;
        let formed = broken - (after.integral / duration - free);
        BirthMoments { mass, moment: (0.5 * mass - formed).clamp(-MOST * mass, MOST * mass) }
    }

    /// The same with one delay for all contacts.
    ///
    /// ∫(t − t_m) dN(t − τ) = ½h[N(t₀ − τ) + N(t₁ − τ)] − ∫N, with N counted above what has re-formed.
    fn births_after_delay(&self, start: f64, duration: f64, fraction: BrokenFraction) -> BirthMoments {
        let (from, to) = (-self.delay, duration - self.delay);
        let now = BreakHistory { start, duration, before: self.broken.value(), fraction };
        // N and what has re-formed grow without limit; their difference, the contacts that wait,
        // stays small.
        let origin = self.born.value();
        let mut integral = 0.0;
        let (mut first, mut last) = (None, 0.0);
        // Steps before the delay have re-formed, and most of those within it are too late to re-form in this step.
        let gone = self.past.partition_point(|past| past.start - start + past.duration <= from);
        let later = |past: &&BreakHistory| past.start - start < to;
        for past in self.past.range(gone..).chain([&now]).take_while(later) {
            // Times relative to the start, which keep their digits after a long history.
            let begun = past.start - start;
            let (low, high) = (begun.max(from), (begun + past.duration).min(to));
            if low >= high {
                continue;
            }
            // Simpson's rule is exact, since N is quadratic on each step.
            let [a, b, c] = [low, 0.5 * (low + high), high]
                .map(|time| past.before + past.fraction.at((time - begun) / past.duration) - origin);
            first = first.or(Some((a, low)));
            integral += (high - low) / 6.0 * (a + 4.0 * b + c);
            last = c;
        }
        let Some((begun, low)) = first else { return BirthMoments::default() };
        integral += begun * (low - from);
        let mass = last.max(0.0);
        // The bound keeps both weights of the two-point rule positive, hence cohorts of positive
        // mass.
        let moment = (0.5 * (begun + last) - integral / duration).clamp(-MOST * mass, MOST * mass);
        BirthMoments { mass, moment }
    }

    /// The longest time for which contacts are free.
    pub(super) fn longest_free(&self) -> f64 {
        self.delay
    }

    /// The time up to which no more than this fraction of contacts re-forms one by one; `None` where free times differ.
    pub(super) fn free_until(&self, fraction: f64) -> Option<f64> {
        if self.is_spread() {
            return None;
        }
        let most = self.born.value() + fraction;
        let first = self.past.partition_point(|past| past.before + past.fraction.end <= most);
        Some(self.past.get(first).map_or(f64::INFINITY, |past| past.start + self.delay))
    }

    /// Whether contacts that broke simultaneously have not re-formed.
    pub(super) fn is_pending(&self) -> bool {
        !self.waiting.is_empty() || !self.parted.is_empty()
    }

    /// As many contacts as this break, and as many re-form, at a constant rate for a time.
    pub(super) fn continue_steadily(&mut self, during: f64, broken: f64) {
        for past in &mut self.past {
            past.start += during;
            past.before += broken;
        }
        self.broken.add(broken);
        self.born.add(broken);
    }

    /// Whether contacts re-form as soon as they break.
    pub(super) fn is_immediate(&self) -> bool {
        self.delay == 0.0
    }

    /// Stores a step.
    pub(super) fn keep(&mut self, start: f64, duration: f64, fraction: BrokenFraction, born: f64) {
        let before = self.broken.value();
        if self.delay > 0.0 {
            // Without memory it does not matter when the free contacts broke.
            if !self.times.as_ref().is_some_and(|times| times.is_memoryless()) {
                self.past.push_back(BreakHistory { start, duration, before, fraction });
            }
            let horizon = start + duration - self.delay;
            while self.past.front().is_some_and(|past| past.start + past.duration < horizon) {
                self.past.pop_front();
            }
            while self.parted.front().is_some_and(|broken| broken.time < horizon) {
                self.parted.pop_front();
            }
        }
        self.broken.add(fraction.end);
        self.born.add(born);
    }

    /// Contacts break simultaneously; they re-form after the delay.
    pub(super) fn add_simultaneous(&mut self, time: f64, mass: f64) {
        self.struck += mass;
        let Some(times) = &self.times else {
            return self.waiting.push_back(DelayedPointMass { time: time + self.delay, mass });
        };
        let mut left = mass;
        for atom in times.atoms() {
            let together = DelayedPointMass { time: time + atom.position, mass: atom.weight * mass };
            let later = self.waiting.partition_point(|other| other.time <= together.time);
            self.waiting.insert(later, together);
            left -= together.mass;
        }
        if left > 0.0 {
            // Those that re-form one by one are free, though they did not break one by one.
            self.parted.push_back(DelayedPointMass { time, mass });
            self.born.add(-left);
        }
    }

    /// Whether free times are those of a distribution: what forms does not follow from what broke a delay before.
    pub(super) fn is_spread(&self) -> bool {
        self.times.is_some()
    }

    /// Times after a kink of the breaking rate at which the rate of formation has one.
    pub(super) fn kinks(&self) -> &[f64] {
        match &self.times {
            Some(times) => &times.edges,
            None if self.delay > 0.0 => std::slice::from_ref(&self.delay),
            None => &[],
        }
    }

    /// Time at which the next point mass re-forms.
    pub(super) fn next_point_mass(&self) -> Option<f64> {
        self.waiting.front().map(|point_mass| point_mass.time)
    }

    /// The next point mass that has re-formed by now.
    pub(super) fn due(&mut self, time: f64) -> Option<DelayedPointMass> {
        if self.next_point_mass()? <= time { self.waiting.pop_front() } else { None }
    }

    /// Steady breaking at a rate for the duration of the delay.
    pub(super) fn steadily(delay: &FreeTime, rate: f64) -> Self {
        let mut broken = Self::new(delay);
        let delay = broken.delay;
        if let Some(times) = broken.times.clone() {
            // All that broke so long ago has re-formed; of the rest it has but for the mean free time.
            let end = rate * delay;
            let fraction = BrokenFraction { middle: 0.5 * end, end };
            broken.keep(-delay, delay, fraction, end - rate * times.mean());
        } else if delay > 0.0 {
            let end = rate * delay;
            let fraction = BrokenFraction { middle: 0.5 * end, end };
            broken.keep(-delay, delay, fraction, 0.0);
        }
        broken
    }
}

/// The largest moment at which both points of the two-point Gauss rule keep a weight above 0.
const MOST: f64 = 0.288_675_134_594_812_9;
