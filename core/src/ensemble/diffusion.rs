//! Contacts whose thresholds diffuse, dh = −D U'(h) dt + √(2D) dW with U = −ln P_cf, up to the first passage
//! through the stretch.
//!
//! On a step Δ the drift is linearised in h, with its curvature in the mean only (local linearisation): the
//! transition is Gaussian, and exact for a Gaussian P_cf (T. Ozaki, Stat. Sin. 2, 113 (1992)). Between its
//! ends the threshold is a Brownian bridge. It crosses the stretch, a straight line, with probability exp(−2
//! d_0 d_1/s²) (d_0, d_1 the gaps at the ends, s² the variance), for the first time after a fraction f of the
//! step for which f/(1 − f) has an inverse Gaussian distribution of mean d_0/|d_1| and shape d_0²/s². Steps
//! are long where no crossing is possible.

use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::ASK;
use super::attached::{AttachedContact, Segment, segments};
use super::contact::TOGETHER;
use crate::contacts::{Contacts, Stiffness, Temperature};
use crate::history::History;
use crate::law::Law;
use crate::monitor::Watch;
use crate::random::Stream;

/// Nodes in the table of a drift: per length over which P_cf changes, and the smallest and largest number.
const PER_RESOLUTION: f64 = 64.0;
const NODES: (f64, f64) = (1024.0, 1e6);

/// Largest displacement of thresholds on a step where they may meet the stretch, in units of the length
/// 1/√|U''|: breaking stretches are then right on average to 1e-3 of that length.
const FINEST: f64 = 0.25;

/// Standard deviations that a step does not exceed: once in 10⁹.
const REACH: f64 = 6.0;

/// Largest growth of the breaking rate on a step, for a threshold that falls by two standard deviations:
/// Simpson's rule is then right to 4e-4.
const GROWTH: f64 = std::f64::consts::E;

/// Below this breaking probability on a step that limit holds only on average; below `UNLIKELY` not at all.
const SELDOM: f64 = 1e-2;
const UNLIKELY: f64 = 1e-7;

/// Exponent of a probability that is taken as 0.
const NEVER: f64 = 45.0;

/// Simulates contacts whose thresholds diffuse.
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

/// The present threshold of a contact.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct DiffusingThreshold {
    time: f64,
    threshold: f64,
    /// The last step.
    step: f64,
}

impl DiffusingThreshold {
    /// The threshold of a contact that has just formed.
    pub(super) fn fresh(threshold: f64) -> Self {
        Self { time: 0.0, threshold, step: f64::INFINITY }
    }

    /// The threshold now, or when the contact broke.
    pub(super) fn threshold(&self) -> f64 {
        self.threshold
    }
}

/// A step of a threshold.
#[derive(Debug, Clone, Copy)]
struct WalkStep {
    span: f64,
    /// Mean and standard deviation at the end.
    mean: f64,
    std: f64,
    /// Variance of the Brownian bridge.
    bridge: f64,
    /// Whether it cannot reach the stretch.
    free: bool,
}

/// The stretch of a contact and its velocity.
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
        let Contacts { stiffness, rules, .. } = contacts;
        Self {
            rate,
            drift,
            low,
            high,
            resolution,
            temperature: rules.temperature,
            stiffness: stiffness.clone(),
        }
    }

    /// The time at which a contact with the hazard `remaining_hazard` left breaks, if before the last of the
    /// `marks`, which rise; else infinite, also once the monitor has stopped it. If stiffness depends on the threshold,
    /// `thresholds` are those at the marks.
    pub(super) fn end(
        &self,
        held: &AttachedContact,
        history: &History,
        marks: &[f64],
        (mut remaining_hazard, stream): (f64, &mut Stream),
        thresholds: &mut Vec<f64>,
        watch: &Watch<'_>,
    ) -> f64 {
        let mut steps: u32 = 0;
        let until = marks[marks.len() - 1];
        // Otherwise steps, and hence the random paths, do not depend on the marks.
        let marks = if self.stiffness.is_equal() { &[] } else { marks };
        let mut state = DiffusingThreshold::fresh(held.fresh);
        for segment in segments(history, held.birth..until) {
            state.time = segment.start;
            while state.time < segment.end.min(until) {
                steps = steps.wrapping_add(1);
                if steps.is_multiple_of(ASK) && watch.stops() {
                    thresholds.resize(marks.len(), state.threshold);
                    return f64::INFINITY;
                }
                let passed = marks[thresholds.len()..].iter().take_while(|mark| **mark <= state.time).count();
                thresholds.resize(thresholds.len() + passed, state.threshold);
                let mark = marks.get(thresholds.len()).copied().unwrap_or(f64::INFINITY);
                let path = StretchPath {
                    stretch: segment.position(state.time) - held.origin,
                    velocity: segment.velocity,
                };
                let begun = state.time;
                if let Some(span) =
                    self.advance(&mut state, path, segment.end.min(mark), &mut remaining_hazard, stream)
                {
                    return begun + span;
                }
            }
        }
        thresholds.resize(marks.len(), state.threshold);
        f64::INFINITY
    }

    pub(super) fn is_thermal(&self) -> bool {
        self.temperature.is_some()
    }

    /// The time at which a contact with the hazard `remaining_hazard` left breaks on a segment, if it does and the monitor does not
    /// stop it before. The work ∫½x² dk done by diffusion on a contact that becomes stiffer is added to `strengthening`, with
    /// thresholds linear on each step.
    pub(super) fn on(
        &self,
        held: &AttachedContact,
        state: &mut DiffusingThreshold,
        segment: &Segment,
        (remaining_hazard, stream): (&mut f64, &mut Stream),
        strengthening: &mut f64,
        watch: &Watch<'_>,
    ) -> Option<f64> {
        state.time = segment.start;
        let mut steps: u32 = 0;
        while state.time < segment.end {
            steps = steps.wrapping_add(1);
            if steps.is_multiple_of(ASK) && watch.stops() {
                return None;
            }
            let DiffusingThreshold { time, threshold, .. } = *state;
            let path =
                StretchPath { stretch: segment.position(time) - held.origin, velocity: segment.velocity };
            let ends = self.advance(state, path, segment.end, remaining_hazard, stream);
            let last = path.after(ends.unwrap_or(state.time - time));
            // The mean of x² over a step on which x is linear in time.
            let square = (path.stretch * (path.stretch + last) + last * last) / 3.0;
            let [before, after] = [threshold, state.threshold].map(|h| self.stiffness.of(h));
            *strengthening += 0.5 * square * (after - before);
            if let Some(span) = ends {
                return Some(time + span);
            }
        }
        None
    }

    /// One step, at most up to `stop`; returns the time after which the contact breaks, if it does.
    fn advance(
        &self,
        state: &mut DiffusingThreshold,
        path: StretchPath,
        stop: f64,
        remaining_hazard: &mut f64,
        stream: &mut Stream,
    ) -> Option<f64> {
        let DiffusingThreshold { time, threshold, step } = *state;
        let step = self.step(threshold, path, step, stop - time);
        let normal: f64 = StandardNormal.sample(stream);
        // Threshold and crossing are drawn one after the other: first the end of the step, then,
        // given both ends, whether the bridge between them crosses the stretch. Crossings inside a
        // step are not missed.
        let next = step.mean + step.std * normal;
        let end = path.after(step.span);
        let gaps = (threshold - path.stretch, next - end);
        // First passage: the threshold has crossed the stretch at the end of the step, or its Brownian bridge
        // has in between.
        let passed = gaps.1 <= 0.0 && end > self.low;
        let meets = passed || !step.free && bridge_reaches_zero(gaps, step.bridge, stream);
        let span = if meets { step.span * hitting_fraction(gaps, step.bridge, stream) } else { step.span };
        let after = if meets { path.after(span) } else { self.reflected(next) };
        if let Some(broken_after) =
            self.thermal_break(path, (threshold, after), span, remaining_hazard, stream)
        {
            state.threshold += (after - threshold) * broken_after / span;
            return Some(broken_after);
        }
        // Stops are reached exactly, and steps below rounding still advance.
        let time = if step.span < stop - time { (time + step.span).max(time.next_up()) } else { stop };
        *state = DiffusingThreshold { time, threshold: after, step: step.span };
        meets.then_some(span)
    }

    /// When the contact breaks thermally on a path on which its threshold changes, by Simpson's rule: rates
    /// at random points of the path of the threshold are right on average. In between the rate is taken as
    /// exponential.
    fn thermal_break(
        &self,
        path: StretchPath,
        thresholds: (f64, f64),
        span: f64,
        remaining_hazard: &mut f64,
        stream: &mut Stream,
    ) -> Option<f64> {
        self.temperature?;
        let normal: f64 = StandardNormal.sample(stream);
        let middle = 0.5 * (thresholds.0 + thresholds.1) + (0.5 * self.rate * span).sqrt() * normal;
        let first = self.breaking_rate(path.stretch, thresholds.0);
        let between = self.breaking_rate(path.after(0.5 * span), self.reflected(middle));
        let last = self.breaking_rate(path.after(span), thresholds.1);
        let used = span / 6.0 * (first + 4.0 * between + last);
        if used < *remaining_hazard {
            *remaining_hazard -= used;
            return None;
        }
        // With a rate ∝ e^{gs} the time at which the hazard is used up follows in closed form.
        let growth = (last / first).ln();
        let share = *remaining_hazard / used;
        let fraction = if growth == 0.0 { share } else { (share * growth.exp_m1()).ln_1p() / growth };
        Some(span * fraction.min(1.0))
    }

    /// Thermal breaking rate.
    fn breaking_rate(&self, stretch: f64, threshold: f64) -> f64 {
        let own = self.stiffness.of(threshold);
        self.temperature.map_or(0.0, |temperature| temperature.rate(stretch, threshold, own))
    }

    /// A step of at most `most`, after one of length `before`: as long as accurate, if it cannot reach the
    /// stretch and the drift is linear, otherwise so short that it is accurate everywhere.
    fn step(&self, threshold: f64, path: StretchPath, before: f64, most: f64) -> WalkStep {
        // Below the support no crossing is possible because of the reflection: a step ends there.
        let outside = path.stretch < self.low * (1.0 - TOGETHER);
        let most = if outside { most.min((self.low - path.stretch) / path.velocity) } else { most };
        let length = self.resolution.min(self.high - path.stretch);
        // Squares of two lengths: 1/√|U''|, and that over which P_cf changes or its support ends.
        let local = self.rate / self.drift.at(threshold).slope.abs();
        let fine = FINEST * FINEST * local.min(length * length) / (2.0 * self.rate);
        // Under a linear drift the transition is exact for any step: only crossings and breaking
        // rates limit its length.
        let mut span = if self.drift.is_straight() { most.min(2.0 * before) } else { most.min(fine) };
        loop {
            let mut step = self.drift.step(threshold, self.rate, span);
            let end = path.after(span);
            step.free = end <= self.low || end < self.lowest(threshold, &step, REACH);
            if (step.free || span <= fine) && self.rate_is_smooth(threshold, path, &step) {
                return step;
            }
            span = if span > fine { fine.max(0.5 * span) } else { 0.5 * span };
        }
    }

    /// The lowest threshold on a step that falls by so many standard deviations.
    fn lowest(&self, threshold: f64, step: &WalkStep, deviations: f64) -> f64 {
        (threshold.min(step.mean) - deviations * step.std).max(self.low)
    }

    /// Whether the breaking rate does not change too much on a step, or is negligible.
    fn rate_is_smooth(&self, threshold: f64, path: StretchPath, step: &WalkStep) -> bool {
        if self.temperature.is_none() {
            return true;
        }
        let most =
            |deviations| self.breaking_rate(path.after(step.span), self.lowest(threshold, step, deviations));
        let grown = GROWTH * self.breaking_rate(path.stretch, threshold);
        let likely = most(2.0);
        likely <= grown
            || likely * step.span <= SELDOM && most(1.0) <= grown
            || most(REACH) * step.span <= UNLIKELY
    }

    /// The threshold, reflected at the ends of the support of P_cf.
    fn reflected(&self, threshold: f64) -> f64 {
        let (above, width) = ((threshold - self.low).abs(), self.high - self.low);
        if above <= width {
            return self.low + above;
        }
        self.low + width - (above.rem_euclid(2.0 * width) - width).abs()
    }
}

/// Whether a Brownian bridge between two positive gaps reaches 0.
fn bridge_reaches_zero((first, last): (f64, f64), variance: f64, stream: &mut Stream) -> bool {
    let exponent = 2.0 * first * last / variance;
    exponent < NEVER && stream.uniform() < (-exponent).exp()
}

/// The fraction of the time after which a Brownian bridge, from a positive gap to one of either sign, first
/// reaches 0, given that it does.
///
/// Random numbers of the inverse Gaussian distribution after J. R. Michael, W. R. Schucany and R. W. Haas,
/// Am. Stat. 30, 88 (1976).
fn hitting_fraction((first, last): (f64, f64), variance: f64, stream: &mut Stream) -> f64 {
    let (mean, shape) = (first / last.abs().max(f64::MIN_POSITIVE), first * first / variance);
    let normal: f64 = StandardNormal.sample(stream);
    // The smaller root of the quadratic equation of the method, in a form without cancellation.
    let half = 0.5 * mean * normal * normal / shape;
    let smaller = mean / (1.0 + half + (half * (2.0 + half)).sqrt());
    let odds = if stream.uniform() * (mean + smaller) <= mean { smaller } else { mean / smaller * mean };
    if odds.is_finite() { odds / (1.0 + odds) } else { 1.0 }
}

/// A length over which the density changes.
fn resolution(law: &dyn Law) -> f64 {
    law.zones().iter().map(|zone| zone.resolution).fold(law.std(), f64::min)
}

/// Value and derivatives at a point.
struct Jet {
    value: f64,
    slope: f64,
    curvature: f64,
}

/// The drift −D U'(h).
#[derive(Debug, Clone)]
enum Drift {
    /// Linear: P_cf is Gaussian, or constant.
    Straight { slope: f64, zero: f64 },
    /// Tabulated at equal distances, with parabolas in between and beyond.
    Table { start: f64, density: f64, values: Vec<f64> },
}

impl Drift {
    fn new(fresh: &dyn Law, mature: &dyn Law, rate: f64) -> Self {
        let parameter = |name| mature.parameters().iter().find(|p| p.name == name).map(|p| p.value);
        match (mature.name(), parameter("mean"), parameter("std")) {
            ("gaussian", Some(zero), Some(std)) => Self::Straight { slope: -rate / (std * std), zero },
            ("rectangular", ..) => Self::Straight { slope: 0.0, zero: 0.0 },
            _ => Self::table(fresh, mature, rate),
        }
    }

    /// The table over the range of fresh and mature thresholds in which the density of mature ones does not
    /// underflow.
    fn table(fresh: &dyn Law, mature: &dyn Law, rate: f64) -> Self {
        let zones = || fresh.zones().into_iter().chain(mature.zones());
        let start = zones().map(|zone| zone.low).fold(f64::INFINITY, f64::min).max(mature.quantile(0.0));
        let end = zones().map(|zone| zone.high).fold(0.0, f64::max).min(mature.upper_quantile(0.0));
        let nodes =
            ((end - start) / resolution(mature) * PER_RESOLUTION).clamp(NODES.0, NODES.1).ceil() as usize;
        let spacing = (end - start) / nodes as f64;
        // Differences over a whole spacing, at its middle.
        let place = |node: usize| start + spacing * node as f64;
        // Differences of ln P_cf instead of a derivative: distributions need no derivative of their
        // density, and the table integrates to the right P_cf.
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

    /// A step with the drift linearised at its start, and the contribution of its curvature to the mean (I.
    /// Shoji and T. Ozaki, Stoch. Anal. Appl. 16, 733 (1998)).
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
