//! Contacts whose thresholds diffuse: dh = −D U'(h) dt + √(2D) dW, U = −ln P_cf, until stretch and threshold meet.
//!
//! On a step Δ the drift is taken as a straight line in h, its curvature only in the mean: the transition is Gaussian, and
//! exact where P_cf is (T. Ozaki, Stat. Sin. 2, 113 (1992)). Between its ends the threshold is a Brownian bridge, which meets the stretch,
//! a straight line, with probability exp(−2 d_0 d_1/s²) (d_0, d_1 the gaps at the ends, s² the variance) and for the first
//! time after a fraction f of the step for which f/(1 − f) has an inverse Gaussian law of mean d_0/|d_1| and shape d_0²/s².
//! Steps are long where nothing can meet.

use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::passage::{AttachedContact, Segment, legs, stiffness};
use super::sweep::TOGETHER;
use crate::contacts::{Contacts, Stiffness, Temperature};
use crate::history::History;
use crate::law::Law;
use crate::random::Stream;

/// Nodes in the table of a drift: for each length over which P_cf changes, and the fewest and most in all.
const PER_RESOLUTION: f64 = 64.0;
const NODES: (f64, f64) = (1024.0, 1e6);

/// How far thresholds go on a step where they may meet the stretch, of the length 1/√|U''| over which P_cf changes:
/// stretches at which contacts break are then right on average to 1e-3 of that length.
const FINEST: f64 = 0.25;

/// Standard deviations beyond which a step does not reach: once in 10⁹.
const REACH: f64 = 6.0;

/// By how much the breaking rate may grow on a step, for a threshold that falls by two standard deviations: Simpson's rule is
/// then right to 4e-4.
const GROWTH: f64 = std::f64::consts::E;

/// A probability of breaking on a step for which that is to hold only on average, and one for which it need not.
const SELDOM: f64 = 1e-2;
const UNLIKELY: f64 = 1e-7;

/// An exponent of a probability that is never met.
const NEVER: f64 = 45.0;

/// The end of lives whose thresholds diffuse.
#[derive(Debug, Clone)]
pub(super) struct ThresholdDiffusion {
    /// D.
    rate: f64,
    drift: Drift,
    /// Support of P_cf.
    low: f64,
    high: f64,
    /// A length over which P_cf changes.
    resolution: f64,
    temperature: Option<Temperature>,
    stiffness: Stiffness,
}

/// A threshold on its way.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct DiffusingThreshold {
    time: f64,
    threshold: f64,
    /// The step last taken.
    step: f64,
}

impl DiffusingThreshold {
    /// The threshold of a contact that has just formed.
    pub(super) fn newborn(threshold: f64) -> Self {
        Self { time: 0.0, threshold, step: f64::INFINITY }
    }

    /// Where it is, or was when the contact broke.
    pub(super) fn threshold(&self) -> f64 {
        self.threshold
    }
}

/// A step that a threshold may take.
#[derive(Debug, Clone, Copy)]
struct WalkStep {
    span: f64,
    /// Mean and standard deviation at the end.
    mean: f64,
    std: f64,
    /// Variance of the bridge.
    bridge: f64,
    /// Whether it is too far from the stretch to meet it.
    free: bool,
}

/// Where a contact is and goes: its stretch and velocity.
#[derive(Clone, Copy)]
struct StretchPath {
    stretch: f64,
    velocity: f64,
}

impl StretchPath {
    fn after(&self, span: f64) -> f64 {
        self.stretch + self.velocity * span
    }
}

impl ThresholdDiffusion {
    pub(super) fn new(contacts: &Contacts, mature: &dyn Law, rate: f64) -> Self {
        let (low, high) = (mature.quantile(0.0), mature.upper_quantile(0.0));
        let resolution = resolution(mature);
        let drift = Drift::new(contacts.thresholds.as_ref(), mature, rate);
        let Contacts { stiffness, ref rules, .. } = *contacts;
        Self { rate, drift, low, high, resolution, temperature: rules.temperature, stiffness }
    }

    /// When a contact breaks that survives `endurance` = ∫w dt, if before the last of the `marks`, which rise; infinite if
    /// not. Where stiffness follows the threshold, `thresholds` are those at the marks.
    pub(super) fn end(
        &self,
        held: &AttachedContact,
        history: &History,
        marks: &[f64],
        mut remaining_hazard: f64,
        stream: &mut Stream,
        thresholds: &mut Vec<f64>,
    ) -> f64 {
        let until = marks[marks.len() - 1];
        // Else steps do not know of them, nor do the ways of thresholds.
        let marks = if let Stiffness::PerThreshold(_) = self.stiffness { marks } else { &[] };
        let mut state = DiffusingThreshold::newborn(held.newborn);
        for leg in legs(history, held.birth..until) {
            state.time = leg.start;
            while state.time < leg.end.min(until) {
                let passed = marks[thresholds.len()..].iter().take_while(|mark| **mark <= state.time).count();
                thresholds.resize(thresholds.len() + passed, state.threshold);
                let mark = marks.get(thresholds.len()).copied().unwrap_or(f64::INFINITY);
                let way =
                    StretchPath { stretch: leg.position(state.time) - held.origin, velocity: leg.velocity };
                let begun = state.time;
                if let Some(span) = self.go(&mut state, way, leg.end.min(mark), &mut remaining_hazard, stream)
                {
                    return begun + span;
                }
            }
        }
        thresholds.resize(marks.len(), state.threshold);
        f64::INFINITY
    }

    pub(super) fn is_hot(&self) -> bool {
        self.temperature.is_some()
    }

    /// When a contact breaks on a leg, if it does; what diffusion brings it meanwhile by making it stiffer, ∫½x² dk, is added
    /// to `gained`, with thresholds on straight lines.
    pub(super) fn on(
        &self,
        held: &AttachedContact,
        state: &mut DiffusingThreshold,
        leg: &Segment,
        remaining_hazard: &mut f64,
        stream: &mut Stream,
        gained: &mut f64,
    ) -> Option<f64> {
        state.time = leg.start;
        while state.time < leg.end {
            let DiffusingThreshold { time, threshold, .. } = *state;
            let way = StretchPath { stretch: leg.position(time) - held.origin, velocity: leg.velocity };
            let ends = self.go(state, way, leg.end, remaining_hazard, stream);
            let last = way.after(ends.unwrap_or(state.time - time));
            let square = (way.stretch * (way.stretch + last) + last * last) / 3.0;
            let [before, after] = [threshold, state.threshold].map(|h| stiffness(self.stiffness, h));
            *gained += 0.5 * square * (after - before);
            if let Some(span) = ends {
                return Some(time + span);
            }
        }
        None
    }

    /// One step, up to `stop` at most; after which time the contact breaks, if it does.
    fn go(
        &self,
        state: &mut DiffusingThreshold,
        way: StretchPath,
        stop: f64,
        remaining_hazard: &mut f64,
        stream: &mut Stream,
    ) -> Option<f64> {
        let DiffusingThreshold { time, threshold, step } = *state;
        let step = self.step(threshold, way, step, stop - time);
        let normal: f64 = StandardNormal.sample(stream);
        let next = step.mean + step.std * normal;
        let end = way.after(step.span);
        let gaps = (threshold - way.stretch, next - end);
        let passed = gaps.1 <= 0.0 && end > self.low;
        let meets = passed || !step.free && touches(gaps, step.bridge, stream);
        let span = if meets { step.span * meeting(gaps, step.bridge, stream) } else { step.span };
        let after = if meets { way.after(span) } else { self.reflected(next) };
        if let Some(fired) = self.fires(way, (threshold, after), span, remaining_hazard, stream) {
            state.threshold += (after - threshold) * fired / span;
            return Some(fired);
        }
        // Stops are met exactly, and steps below rounding go on.
        let time = if step.span < stop - time { (time + step.span).max(time.next_up()) } else { stop };
        *state = DiffusingThreshold { time, threshold: after, step: step.span };
        meets.then_some(span)
    }

    /// When heat breaks the contact on a way on which its threshold changes, by Simpson's rule: rates at points of the way
    /// of a threshold are right on average. Between the ends the rate is taken as an exponential.
    fn fires(
        &self,
        way: StretchPath,
        thresholds: (f64, f64),
        span: f64,
        remaining_hazard: &mut f64,
        stream: &mut Stream,
    ) -> Option<f64> {
        self.temperature?;
        let normal: f64 = StandardNormal.sample(stream);
        let middle = 0.5 * (thresholds.0 + thresholds.1) + (0.5 * self.rate * span).sqrt() * normal;
        let first = self.heat(way.stretch, thresholds.0);
        let between = self.heat(way.after(0.5 * span), self.reflected(middle));
        let last = self.heat(way.after(span), thresholds.1);
        let used = span / 6.0 * (first + 4.0 * between + last);
        if used < *remaining_hazard {
            *remaining_hazard -= used;
            return None;
        }
        let growth = (last / first).ln();
        let share = *remaining_hazard / used;
        let fraction = if growth == 0.0 { share } else { (share * growth.exp_m1()).ln_1p() / growth };
        Some(span * fraction.min(1.0))
    }

    /// Breaking rate.
    fn heat(&self, stretch: f64, threshold: f64) -> f64 {
        let own = stiffness(self.stiffness, threshold);
        self.temperature.map_or(0.0, |temperature| temperature.rate(stretch, threshold, own))
    }

    /// A step up to `most`, after one of a length `before`: as long as is right, if it is too far from the stretch to meet it
    /// and the drift is straight, or else so short that it is right everywhere.
    fn step(&self, threshold: f64, way: StretchPath, before: f64, most: f64) -> WalkStep {
        // Below the support nothing can meet, whatever is reflected: a step does not go on into it.
        let outside = way.stretch < self.low * (1.0 - TOGETHER);
        let most = if outside { most.min((self.low - way.stretch) / way.velocity) } else { most };
        let length = self.resolution.min(self.high - way.stretch);
        let local = self.rate / self.drift.at(threshold).slope.abs();
        let fine = FINEST * FINEST * local.min(length * length) / (2.0 * self.rate);
        let mut span = if self.drift.is_straight() { most.min(2.0 * before) } else { most.min(fine) };
        loop {
            let mut step = self.drift.step(threshold, self.rate, span);
            let end = way.after(span);
            step.free = end <= self.low || end < self.lowest(threshold, &step, REACH);
            if (step.free || span <= fine) && self.is_cool(threshold, way, &step) {
                return step;
            }
            span = if span > fine { fine.max(0.5 * span) } else { 0.5 * span };
        }
    }

    /// The lowest threshold on a step that goes so many standard deviations down.
    fn lowest(&self, threshold: f64, step: &WalkStep, deviations: f64) -> f64 {
        (threshold.min(step.mean) - deviations * step.std).max(self.low)
    }

    /// Whether the breaking rate does not change too much on a step, or hardly ever breaks the contact.
    fn is_cool(&self, threshold: f64, way: StretchPath, step: &WalkStep) -> bool {
        if self.temperature.is_none() {
            return true;
        }
        let most = |deviations| self.heat(way.after(step.span), self.lowest(threshold, step, deviations));
        let grown = GROWTH * self.heat(way.stretch, threshold);
        let likely = most(2.0);
        likely <= grown
            || likely * step.span <= SELDOM && most(1.0) <= grown
            || most(REACH) * step.span <= UNLIKELY
    }

    /// The threshold, folded back into the support of P_cf.
    fn reflected(&self, threshold: f64) -> f64 {
        let (above, width) = ((threshold - self.low).abs(), self.high - self.low);
        if above <= width {
            return self.low + above;
        }
        self.low + width - (above.rem_euclid(2.0 * width) - width).abs()
    }
}

/// Whether a bridge between two gaps above 0 touches 0.
fn touches((first, last): (f64, f64), variance: f64, stream: &mut Stream) -> bool {
    let exponent = 2.0 * first * last / variance;
    exponent < NEVER && stream.uniform() < (-exponent).exp()
}

/// The fraction of the time after which a bridge, from a gap above 0 to one on either side, first touches 0, given that it does.
///
/// Draws of the inverse Gaussian law after J. R. Michael, W. R. Schucany and R. W. Haas, Am. Stat. 30, 88 (1976).
fn meeting((first, last): (f64, f64), variance: f64, stream: &mut Stream) -> f64 {
    let (mean, shape) = (first / last.abs().max(f64::MIN_POSITIVE), first * first / variance);
    let normal: f64 = StandardNormal.sample(stream);
    let half = 0.5 * mean * normal * normal / shape;
    let smaller = mean / (1.0 + half + (half * (2.0 + half)).sqrt());
    let odds = if stream.uniform() * (mean + smaller) <= mean { smaller } else { mean / smaller * mean };
    if odds.is_finite() { odds / (1.0 + odds) } else { 1.0 }
}

/// A length over which the density changes, wherever it does.
fn resolution(law: &dyn Law) -> f64 {
    law.zones().iter().map(|zone| zone.resolution).fold(law.std(), f64::min)
}

/// Value and derivatives at a place.
struct Jet {
    value: f64,
    slope: f64,
    curvature: f64,
}

/// −D U'(h).
#[derive(Debug, Clone)]
enum Drift {
    /// Straight, and 0 at a place: P_cf is Gaussian, or constant.
    Straight { slope: f64, zero: f64 },
    /// At places a constant distance apart, parabolas between them and beyond.
    Table { start: f64, density: f64, values: Vec<f64> },
}

impl Drift {
    fn new(newborn: &dyn Law, mature: &dyn Law, rate: f64) -> Self {
        let parameter = |name| mature.parameters().iter().find(|p| p.name == name).map(|p| p.value);
        match (mature.name(), parameter("mean"), parameter("std")) {
            ("gaussian", Some(zero), Some(std)) => Self::Straight { slope: -rate / (std * std), zero },
            ("rectangular", ..) => Self::Straight { slope: 0.0, zero: 0.0 },
            _ => Self::table(newborn, mature, rate),
        }
    }

    /// Where thresholds are born or mature, and the density of the mature ones can be told from 0.
    fn table(newborn: &dyn Law, mature: &dyn Law, rate: f64) -> Self {
        let zones = || newborn.zones().into_iter().chain(mature.zones());
        let start = zones().map(|zone| zone.low).fold(f64::INFINITY, f64::min).max(mature.quantile(0.0));
        let end = zones().map(|zone| zone.high).fold(0.0, f64::max).min(mature.upper_quantile(0.0));
        let nodes =
            ((end - start) / resolution(mature) * PER_RESOLUTION).clamp(NODES.0, NODES.1).ceil() as usize;
        let spacing = (end - start) / nodes as f64;
        // Differences over a whole spacing, at its middle.
        let place = |node: usize| start + spacing * node as f64;
        let slope = |node: usize| (mature.density(place(node + 1)) / mature.density(place(node))).ln();
        let known = |node: &usize| slope(*node).is_finite();
        let first = (0..nodes).find(known).unwrap_or(0);
        let values = (first..nodes).map(|node| rate / spacing * slope(node)).take_while(|v| v.is_finite());
        Self::Table { start: place(first) + 0.5 * spacing, density: 1.0 / spacing, values: values.collect() }
    }

    fn is_straight(&self) -> bool {
        matches!(self, Self::Straight { .. })
    }

    fn at(&self, threshold: f64) -> Jet {
        match self {
            &Self::Straight { slope, zero } => {
                Jet { value: slope * (threshold - zero), slope, curvature: 0.0 }
            }
            Self::Table { start, density, values } => {
                let place = (threshold - start) * density;
                let node = (place as usize).min(values.len().saturating_sub(3));
                let along = place - node as f64;
                let [first, second, third] = [values[node], values[node + 1], values[node + 2]];
                let (rise, bend) = (second - first, third - 2.0 * second + first);
                Jet {
                    value: first + along * (rise + 0.5 * (along - 1.0) * bend),
                    slope: (rise + (along - 0.5) * bend) * density,
                    curvature: bend * density * density,
                }
            }
        }
    }

    /// A step with the drift at its start as a straight line, and with what its curvature adds to the mean
    /// (I. Shoji and T. Ozaki, Stoch. Anal. Appl. 16, 733 (1998)).
    fn step(&self, threshold: f64, rate: f64, span: f64) -> WalkStep {
        let Jet { value, slope, curvature } = self.at(threshold);
        let growth = slope * span;
        let mean = threshold + value * span * growth_ratio(growth) + 0.5 * rate * curvature * span * span;
        let variance = 2.0 * rate * span * growth_ratio(2.0 * growth);
        WalkStep { span, mean, std: variance.sqrt(), bridge: variance * (-growth).exp(), free: false }
    }
}

/// (eˣ − 1)/x.
fn growth_ratio(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.exp_m1() / x }
}
