//! What temperature adds to the exponents A = ∫w dt of contacts in a part of a time step.
//!
//! Where ln w changes little in it, Gauss–Legendre rules on time do for all contacts alike. Else w falls about exponentially
//! from one end, by a rate that depends on the threshold: the [`fitted`] rule does for contacts of similar thresholds, on
//! halves of the step where w falls otherwise.

use super::fitted::fitted;
use super::path::Path;
use crate::contacts::{Contacts, Label, Stiffness, Temperature, ThresholdEvolution, ThresholdsAtAge};
use crate::numerics::legendre::{NODES, Nodal};

/// Breaking by temperature.
#[derive(Debug)]
pub(super) struct ThermalBreaking {
    temperature: Temperature,
    stiffness: Stiffness,
    /// By how much ln w may change in a step that one of the [`RULES`] is to sum.
    most_change: [f64; RULES.len()],
    /// By how much ln w may differ from a straight line at a point of the fitted rule.
    most_bend: f64,
    /// What adds less to A is nothing.
    pub(super) nothing: f64,
}

/// A part of a time step of contacts of one age.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepPassage<'a> {
    pub(super) strength: &'a ThresholdEvolution,
    pub(super) stretch: f64,
    pub(super) age: f64,
    pub(super) path: &'a Path,
    pub(super) ends: (f64, f64),
}

/// A point of a rule on time.
#[derive(Debug, Clone, Copy)]
pub(super) struct QuadratureMoment<'a> {
    stretch: f64,
    aged: ThresholdsAtAge<'a>,
    /// The time that it stands for.
    time: f64,
}

/// Gauss rules on [0, 1], as points and weights.
const RULES: [&[(f64, f64)]; 2] = [
    &[(0.211_324_865_405_187_13, 0.5), (0.788_675_134_594_812_9, 0.5)],
    &[(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)],
];

/// The change c of ln w over which a rule of n points misses the tolerance: ∫₀¹ e^{cs} ds to c²ⁿ (n!)⁴/[(2n + 1)((2n)!)³].
fn most_change(rule: &[(f64, f64)], tolerance: f64) -> f64 {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let n = rule.len();
    let error = factorial(n).powi(4) / ((2 * n + 1) as f64 * factorial(2 * n).powi(3));
    (tolerance / error).powf(0.5 / n as f64)
}

impl<'a> StepPassage<'a> {
    /// Where contacts are, and how strong, at a fraction of the step.
    pub(super) fn at(&self, s: f64) -> (f64, ThresholdsAtAge<'a>) {
        let stretch = (self.stretch + self.path.advance(self.ends.0, s)).abs();
        (stretch, self.strength.at(self.age + self.path.duration * (s - self.ends.0)))
    }

    fn moment(&self, s: f64, weight: f64) -> QuadratureMoment<'a> {
        let (stretch, aged) = self.at(s);
        QuadratureMoment { stretch, aged, time: weight * self.path.duration }
    }
}

impl ThermalBreaking {
    /// The temperature of these contacts, which moves places of breaking by about `blur` mean thresholds per e-fold of time.
    pub(super) fn new(contacts: &Contacts, temperature: Temperature, blur: f64, tolerance: f64) -> Self {
        /// The fitted rule misses this times the square of the bend at its farther point: e^{qz²} to 2q², z = 3.4.
        const MISSED: f64 = 0.015;
        /// The error of A that never matters.
        const ROUGH: f64 = 0.01;
        /// The error of A in tolerances that does not matter where many steps add it to all, and the least that is told.
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

    /// The moments of a rule that does for all labels up to `top`, if one of the [`RULES`] does.
    pub(super) fn shared<'a>(
        &self,
        passage: &StepPassage<'a>,
        top: Label<'_>,
    ) -> Option<Vec<QuadratureMoment<'a>>> {
        let &StepPassage { strength, age, path, ends: (from, to), .. } = passage;
        let time = path.duration * (to - from);
        let [before, after] = [age, age + time].map(|age| strength.at(age).threshold_of(top));
        let moved = path.advance(from, to).abs() + (after - before).abs();
        let top = before.max(after);
        let change = self.stiffness.of(top) * top * moved / self.temperature.energy;
        let does = |(_, most): &(&[(f64, f64)], f64)| change <= *most;
        let (rule, _) = RULES.into_iter().zip(self.most_change).find(does)?;
        let moment =
            |&(point, weight): &(f64, f64)| passage.moment(from + (to - from) * point, (to - from) * weight);
        Some(rule.iter().map(moment).collect())
    }

    /// The moments of a rule that does for labels like this one.
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

    /// The fitted rule on a part, or on its halves, which may be halved so many times.
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
        // From the end where the rate is higher, z from 0 to 1.
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

    /// What the moments add to A of a label.
    pub(super) fn added_to(&self, moments: &[QuadratureMoment], label: Label<'_>) -> f64 {
        moments.iter().map(|moment| self.over(moment, label)).sum()
    }

    #[inline]
    fn over(&self, moment: &QuadratureMoment, label: Label<'_>) -> f64 {
        /// Contacts far below the stretch are gone, with exponents that can be counted with.
        const MOST: f64 = 1e300;
        let rate = self.ln_rate(moment.stretch, moment.aged.threshold_of(label)).exp();
        (moment.time * self.temperature.attempt_rate * rate).min(MOST)
    }

    /// ln(w/ω), continued past the threshold.
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

/// How often a step is halved at most.
const DEEPEST: u32 = 30;

/// Where the rate is lower by so many e-folds, it adds nothing.
const GONE_BY: f64 = 16.0;

/// At the far end, the bend may be larger by this: there it is largest, and the rule knows parabolas.
const FARTHER: f64 = 4.0;
