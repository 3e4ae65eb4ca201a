//! Free contacts that re-form after a time of a distribution.
//!
//! Of contacts that broke at the rate n(t'), U(t) = ∫n(t') D̄(t − t') dt' are free, D̄ the survival of the free time. Between
//! two times as many form as break, less the change of U. With R(a) = ∫_a^∞ D̄, the integral of U over a step from t₀ to t₁ is
//! ∫n(t') [R(t₀ − t') − R(t₁ − t')] dt'.

use std::sync::Arc;

use crate::law::{Atom, SharedLaw};
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::{Piecewise, Resolution};

/// The distribution of free times.
#[derive(Debug)]
pub(super) struct FreeTimes {
    law: SharedLaw,
    /// D̄ and R.
    left: Piecewise,
    after: Piecewise,
    /// The same without point masses of the free time.
    spread: Piecewise,
    after_spread: Piecewise,
    /// Ages at which D̄ is not smooth.
    pub(super) edges: Vec<f64>,
    /// Age within which D̄ varies little.
    resolution: f64,
    pub(super) longest: f64,
}

/// U at the end of a step, and its integral over the step.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct FreeAfter {
    pub(super) end: f64,
    pub(super) integral: f64,
}

impl FreeAfter {
    pub(super) fn plus(self, other: Self) -> Self {
        Self { end: self.end + other.end, integral: self.integral + other.integral }
    }
}

/// A step in time.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepInterval {
    pub(super) start: f64,
    pub(super) duration: f64,
}

/// Free contacts below this fraction have re-formed.
const NEGLIGIBLE: f64 = 1e-16;

/// Truncation error of D̄ and of R per mean.
const RESOLUTION: f64 = 1e-15;

impl FreeTimes {
    pub(super) fn new(law: &SharedLaw) -> Arc<Self> {
        let end = law.upper_quantile(0.0);
        let atoms = law.atoms();
        let far = if end.is_finite() { end } else { law.upper_quantile(NEGLIGIBLE) };
        let longest = atoms.iter().map(|atom| atom.position).fold(far, f64::max);
        let mut edges: Vec<f64> = law.breakpoints().into_iter().map(|b| b.position).collect();
        edges.extend(atoms.iter().map(|atom| atom.position));
        edges.retain(|&edge| edge > 0.0 && edge < longest);
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        let zones = law.zones();
        let widths = zones.iter().map(|zone| zone.resolution.min(0.5 * (zone.high - zone.low)));
        let resolution = widths.fold(longest, f64::min);
        let points = |age: f64| -> f64 {
            atoms.iter().filter(|atom| atom.position > age).map(|atom| atom.weight).sum()
        };
        let within: Vec<f64> =
            zones.iter().flat_map(|zone| [zone.low, zone.high]).chain(edges.clone()).collect();
        let table = |of: &dyn Fn(f64) -> f64| {
            Piecewise::resolve(of, &within, longest, Resolution::Mean(RESOLUTION * law.mean()))
        };
        let left = table(&|age| law.survival(age));
        let spread = table(&|age| (law.survival(age) - points(age)).max(0.0));
        let [after, after_spread] = [&left, &spread].map(|curve| curve.integrated_from_end(0.0, &[]));
        Arc::new(Self { law: law.clone(), left, after, spread, after_spread, edges, resolution, longest })
    }

    /// The point masses of the free time.
    pub(super) fn atoms(&self) -> Vec<Atom> {
        self.law.atoms()
    }

    pub(super) fn mean(&self) -> f64 {
        self.law.mean()
    }

    /// Of so many free contacts at the start of a step, those that are free, if it does not matter when they broke: without memory
    /// all re-form at one rate.
    pub(super) fn free_without_memory(&self, free: f64, duration: f64) -> Option<FreeAfter> {
        let rate = self.law.constant_hazard()?;
        let formed = -(-rate * duration).exp_m1();
        Some(FreeAfter { end: free * (1.0 - formed), integral: free * formed / rate })
    }

    /// Whether free times have no memory.
    pub(super) fn is_memoryless(&self) -> bool {
        self.law.constant_hazard().is_some()
    }

    /// Of contacts that broke in a past step, or up to the end of the present one, those that are free, relative to the start
    /// of the present step `now`.
    ///
    /// `rate` is dN/ds at the fraction s of the past step.
    pub(super) fn free(&self, past: StepInterval, rate: impl Fn(f64) -> f64, now: StepInterval) -> FreeAfter {
        let mut sum = FreeAfter::default();
        let begun = past.start - now.start;
        // Ages at the end of the step.
        let age = |s: f64| now.duration - begun - s * past.duration;
        let (youngest, oldest) = (age(1.0), age(0.0));
        if youngest >= self.longest + now.duration {
            return sum;
        }
        // D̄ is smooth in between, as seen from the start and from the end of the step.
        let edges = self.edges.iter().chain([&self.longest]);
        let mut cuts: Vec<f64> = edges.flat_map(|&edge| [edge, edge + now.duration]).collect();
        // A long past, as that of steady sliding, is divided into the cells that resolve D̄.
        let long = oldest - youngest > self.resolution;
        if long {
            cuts.extend(self.left.boundaries.iter().flat_map(|&edge| [edge, edge + now.duration]));
        }
        // What breaks in the step itself is not there at its start.
        cuts.push(now.duration);
        cuts.retain(|&cut| cut > youngest && cut < oldest);
        cuts.extend([youngest, oldest]);
        cuts.sort_by(f64::total_cmp);
        for ends in cuts.windows(2).filter(|ends| ends[1] > ends[0]) {
            let part = ends[1] - ends[0];
            let mut add = |node: f64, weight: f64| {
                let old = ends[0] + part * (0.5 * (1.0 + node));
                let s = (now.duration - begun - old) / past.duration;
                let broken = 0.5 * part * weight * rate(s) / past.duration;
                let before = (old - now.duration).max(0.0);
                sum.end += broken * self.left.value(old);
                sum.integral += broken * (self.after.value(before) - self.after.value(old));
            };
            if long {
                RULE.nodes.iter().zip(&RULE.weights).for_each(|(node, weight)| add(*node, *weight));
            } else {
                GAUSS_3.iter().for_each(|&(node, weight)| add(node, weight));
            }
        }
        sum
    }

    /// The same of a unit of contacts that broke together at `time`, and do not re-form together.
    pub(super) fn free_of(&self, time: f64, now: StepInterval) -> FreeAfter {
        let before = (now.start - time).max(0.0);
        let old = before + now.duration;
        let integral = self.after_spread.value(before) - self.after_spread.value(old);
        FreeAfter { end: self.spread.value(old), integral }
    }
}

/// Nodes and weights of the Gauss rule with three points on [−1, 1].
const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];
