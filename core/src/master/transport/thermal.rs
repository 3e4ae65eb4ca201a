//! Thermal breaking in a part of a time step: quadrature of A = ∫w dt.
//!
//! If ln w changes little, one Gauss–Legendre rule in time serves all contacts. Otherwise w falls about
//! exponentially from one end, at a rate that depends on the threshold: the [`fitted`] rule then serves
//! contacts of similar thresholds, on halves of the step where w does not fall exponentially.

use super::fitted::fitted;
use super::path::Path;
use crate::contacts::{Contacts, Label, Stiffness, Temperature, ThresholdEvolution, ThresholdsAtAge};
use crate::numerics::legendre::{NODES, Nodal};

/// Thermal breaking.
#[derive(Debug)]
pub(super) struct ThermalBreaking {
    temperature: Temperature,
    stiffness: Stiffness,
    /// Largest change of ln w in a step that each of the [`RULES`] integrates.
    most_change: [f64; RULES.len()],
    /// Largest deviation of ln w from a straight line at a node of the fitted rule.
    most_bend: f64,
    /// Contributions to A below this are neglected.
    pub(super) nothing: f64,
}

/// A part of a time step of contacts of one age.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepPassage<'a> {
    pub(super) evolution: &'a ThresholdEvolution,
    pub(super) stretch: f64,
    pub(super) age: f64,
    pub(super) path: &'a Path,
    pub(super) ends: (f64, f64),
}

/// A node of a quadrature rule in time.
#[derive(Debug, Clone, Copy)]
pub(super) struct QuadratureMoment<'a> {
    stretch: f64,
    aged: ThresholdsAtAge<'a>,
    /// Its weight.
    time: f64,
}

/// Gauss rules on [0, 1], as points and weights.
const RULES: [&[(f64, f64)]; 2] = [
    &[(0.211_324_865_405_187_13, 0.5), (0.788_675_134_594_812_9, 0.5)],
    &[(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)],
];

/// The largest change c of ln w for which a rule of n nodes meets the tolerance: its error of ∫₀¹ e^{cs} ds
/// is c²ⁿ (n!)⁴/[(2n + 1)((2n)!)³].
fn most_change(rule: &[(f64, f64)], tolerance: f64) -> f64 {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let n = rule.len();
    let error = factorial(n).powi(4) / ((2 * n + 1) as f64 * factorial(2 * n).powi(3));
    (tolerance / error).powf(0.5 / n as f64)
}

impl<'a> StepPassage<'a> {
    /// Stretch and thresholds at a fraction of the step.
    pub(super) fn at(&self, s: f64) -> (f64, ThresholdsAtAge<'a>) {
        let stretch = (self.stretch + self.path.advance(self.ends.0, s)).abs();
        (stretch, self.evolution.at(self.age + self.path.duration * (s - self.ends.0)))
    }

    fn moment(&self, s: f64, weight: f64) -> QuadratureMoment<'a> {
        let (stretch, aged) = self.at(s);
        QuadratureMoment { stretch, aged, time: weight * self.path.duration }
    }
}

impl ThermalBreaking {
    /// Thermal breaking of these contacts, which shifts breaking by about `blur` mean thresholds per factor e
    /// of time.
    pub(super) fn new(contacts: &Contacts, temperature: Temperature, blur: f64, tolerance: f64) -> Self {
        /// Error of the fitted rule over the square of the deviation at its farther node: 2q² for e^{qz²}, z
        /// = 3.4.
        const MISSED: f64 = 0.015;
        /// An error of A that never matters.
        const ROUGH: f64 = 0.01;
        /// Error of A, in tolerances, that does not matter even if many steps add it for all contacts; and
        /// the smallest value used.
        const FAINT: f64 = 1e-6;
        const LEAST: f64 = 1e-15;
        Self {
            temperature,
            stiffness: contacts.stiffness,
            most_change: RULES.map(|rule| most_change(rule, tolerance)),
            // Only contacts inside the blur see errors.
            most_bend: ((tolerance / blur).min(ROUGH) / MISSED).sqrt(),
            nothing: (FAINT * tolerance / blur).clamp(LEAST, FAINT),
        }
    }

    /// The nodes of a rule that serves all labels up to `top`, if one of the [`RULES`] does.
    pub(super) fn shared<'a>(
        &self,
        passage: &StepPassage<'a>,
        top: Label<'_>,
    ) -> Option<Vec<QuadratureMoment<'a>>> {
        let &StepPassage { evolution, age, path, ends: (from, to), .. } = passage;
        let time = path.duration * (to - from);
        let [before, after] = [age, age + time].map(|age| evolution.at(age).threshold_of(top));
        let moved = path.advance(from, to).abs() + (after - before).abs();
        let top = before.max(after);
        let change = self.stiffness.of(top) * top * moved / self.temperature.energy;
        let does = |(_, most): &(&[(f64, f64)], f64)| change <= *most;
        let (rule, _) = RULES.into_iter().zip(self.most_change).find(does)?;
        let moment =
            |&(point, weight): &(f64, f64)| passage.moment(from + (to - from) * point, (to - from) * weight);
        Some(rule.iter().map(moment).collect())
    }

    /// The nodes of a rule that serves labels like this one.
    pub(super) fn fit<'a>(
        &self,
        passage: &StepPassage<'a>,
        label: Label<'_>,
        moments: &mut Vec<QuadratureMoment<'a>>,
    ) {
        moments.clear();
        let whole = passage.ends;
        self.fit_part(passage, label, whole, DEEPEST, moments);
    }

    /// The fitted rule on a part or on its halves, bisected at most `halvings` times.
    fn fit_part<'a>(
        &self,
        passage: &StepPassage<'a>,
        label: Label<'_>,
        (from, to): (f64, f64),
        halvings: u32,
        moments: &mut Vec<QuadratureMoment<'a>>,
    ) {
        let ln_rate = |s: f64| {
            let (stretch, aged) = passage.at(s);
            self.ln_rate(stretch, aged.threshold_of(label))
        };
        let (width, ends) = (to - from, [ln_rate(from), ln_rate(to)]);
        let highest = ends[0].max(ends[1]);
        if halvings < DEEPEST
            && self.temperature.attempt_rate * passage.path.duration * width * highest.exp() < self.nothing
        {
            return;
        }
        // z from 0 to 1, from the end with the higher rate.
        let place = |z: f64| if ends[1] >= ends[0] { to - z * width } else { from + z * width };
        let fall = highest - ends[0].min(ends[1]);
        let step = if fall > 2.0 { 1.0 / fall } else { 0.5 };
        let [first, second] = [step, 2.0 * step].map(|z| ln_rate(place(z)));
        let slope = ((3.0 * highest - 4.0 * first + second) / (2.0 * step)).max(0.0);
        let rule = fitted(slope);
        let bend = |z: f64, value: f64| (value - highest + slope * z).abs();
        let straight = rule.iter().all(|&(z, _)| bend(z, ln_rate(place(z))) <= self.most_bend);
        let over = fall > GONE_BY || bend(1.0, highest - fall) <= FARTHER * self.most_bend;
        if halvings == 0 || straight && over {
            moments.extend(rule.iter().map(|&(z, weight)| passage.moment(place(z), width * weight)));
            return;
        }
        let middle = 0.5 * (from + to);
        for half in [(from, middle), (middle, to)] {
            self.fit_part(passage, label, half, halvings - 1, moments);
        }
    }

    /// What the moments add to A of these labels.
    pub(super) fn added(&self, moments: &[QuadratureMoment], labels: &[Label<'_>; NODES]) -> Nodal {
        let mut exponents = Nodal::default();
        for moment in moments {
            for (exponent, &label) in exponents.iter_mut().zip(labels) {
                *exponent += self.over(moment, label);
            }
        }
        exponents
    }

    /// Contribution of the nodes to A of one label.
    pub(super) fn added_to(&self, moments: &[QuadratureMoment], label: Label<'_>) -> f64 {
        moments.iter().map(|moment| self.over(moment, label)).sum()
    }

    #[inline]
    fn over(&self, moment: &QuadratureMoment, label: Label<'_>) -> f64 {
        /// Contacts far below the stretch have broken; their exponents must not overflow.
        const MOST: f64 = 1e300;
        let rate = self.ln_rate(moment.stretch, moment.aged.threshold_of(label)).exp();
        (moment.time * self.temperature.attempt_rate * rate).min(MOST)
    }

    /// ln(w/ω), continued beyond the threshold.
    #[inline]
    fn ln_rate(&self, stretch: f64, threshold: f64) -> f64 {
        /// Where the stretch is so many thresholds there is no barrier, and its continuation overflows.
        const FAR: f64 = 1e100;
        if threshold * FAR <= stretch || threshold <= 0.0 {
            return 0.0;
        }
        let whole = 0.5 * self.stiffness.of(threshold) * threshold * threshold;
        -whole / self.temperature.energy * self.temperature.barrier.continued(stretch / threshold)
    }
}

/// Largest number of bisections of a step.
const DEEPEST: u32 = 30;

/// Where ln w is lower by this, the contribution is negligible.
const GONE_BY: f64 = 16.0;

/// At the far end the deviation may be larger by this factor: it is largest there, and the rule is exact for
/// parabolas.
const FARTHER: f64 = 4.0;
