//! Thermal breaking in a part of a time step: quadrature of A = ∫w dt.
//!
//! If ln w changes by a few units at most, one Gauss–Legendre rule in time serves all contacts, with as many nodes as the
//! change requires. Otherwise w falls about exponentially from one end, at a rate that depends on the threshold: the
//! [`fitted`] rule then serves contacts of similar thresholds, on halves of the step where w does not fall exponentially.

use super::fitted::fitted;
use super::path::Path;
use crate::contacts::{
    Barrier, Contacts, Label, NodalLabels, Stiffness, Temperature, ThresholdEvolution, ThresholdsAtAge,
};
use crate::numerics::exponential::exp;
use crate::numerics::legendre::{NODES, Nodal};
use crate::numerics::wide::vectorised;

/// Thermal breaking.
#[derive(Debug)]
pub(super) struct ThermalBreaking {
    temperature: Temperature,
    stiffness: Stiffness,
    /// Whether w is a function of the stretch times one of the threshold.
    separable: bool,
    /// Largest change of ln w in a step that each of the [`RULES`] integrates.
    most_change: [f64; RULES.len()],
    /// The same for Simpson's rule.
    most_change_simpson: f64,
    /// Largest relative error of A of one node in place of several.
    most_missed: f64,
    /// Largest deviation of ln w from a straight line: at a node of the fitted rule, and in the middle for a shared one.
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
    /// The fraction of the step.
    s: f64,
    stretch: f64,
    aged: ThresholdsAtAge<'a>,
    /// Its weight.
    time: f64,
}

/// How A is integrated over a step.
#[derive(Debug)]
pub(super) enum StepRule<'a> {
    /// Nothing breaks.
    Nothing,
    /// At these nodes, for all contacts.
    Shared(Vec<QuadratureMoment<'a>>),
    /// At nodes that are fitted to similar thresholds.
    Fitted,
}

/// Gauss rules on [0, 1], as points and weights.
const RULES: [&[(f64, f64)]; 5] = [
    &[(0.211_324_865_405_187_1, 0.5), (0.788_675_134_594_812_9, 0.5)],
    &[(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)],
    &[
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_92),
        (0.330_009_478_207_571_87, 0.326_072_577_431_273_05),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_05),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_92),
    ],
    &[
        (0.046_910_077_030_668_004, 0.118_463_442_528_094_54),
        (0.230_765_344_947_158_45, 0.239_314_335_249_683_24),
        (0.5, 0.284_444_444_444_444_44),
        (0.769_234_655_052_841_5, 0.239_314_335_249_683_24),
        (0.953_089_922_969_332, 0.118_463_442_528_094_54),
    ],
    &[
        (0.033_765_242_898_423_99, 0.085_662_246_189_585_18),
        (0.169_395_306_766_867_73, 0.180_380_786_524_069_3),
        (0.380_690_406_958_401_56, 0.233_956_967_286_345_52),
        (0.619_309_593_041_598_5, 0.233_956_967_286_345_52),
        (0.830_604_693_233_132_2, 0.180_380_786_524_069_3),
        (0.966_234_757_101_576, 0.085_662_246_189_585_18),
    ],
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
        QuadratureMoment { s, stretch, aged, time: weight * self.path.duration }
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
        /// the smallest and the largest value used.
        const FAINT: f64 = 1e-4;
        const LEAST: f64 = 1e-15;
        const MOST: f64 = 1e-6;
        /// Error of A that the steps of a shared rule may add, in tolerances over the blur.
        const SHARE: f64 = 0.3;
        /// Part of it that one node in place of several may add: this error has one sign in all steps, and a slider behind a
        /// soft spring amplifies it.
        const ONE_NODE: f64 = 0.03;
        // Only contacts inside the blur see errors.
        let allowed = (tolerance / blur).min(ROUGH);
        let separable = temperature.barrier == Barrier::Elastic
            && contacts.stiffness.is_equal()
            && contacts.rules.ageing.is_none();
        Self {
            temperature,
            stiffness: contacts.stiffness.clone(),
            separable,
            most_change: RULES.map(|rule| most_change(rule, SHARE * allowed)),
            // Its error of ∫₀¹ e^{cs} ds is c⁴/2880.
            most_change_simpson: (SHARE * allowed * 2880.0).powf(0.25),
            most_missed: ONE_NODE * SHARE * allowed,
            most_bend: (allowed / MISSED).sqrt(),
            nothing: (FAINT * tolerance / blur).clamp(LEAST, MOST),
        }
    }

    /// Whether [`Self::rule`] would be to add nothing, whatever the labels: the rate of contacts that the stretch has not reached
    /// is at most that of attempts, and larger by `folds` factors of e at most for those that share a panel with them.
    pub(super) fn is_idle(&self, passage: &StepPassage<'_>, folds: f64) -> bool {
        let &StepPassage { path, ends: (from, to), .. } = passage;
        self.temperature.attempt_rate * path.duration * (to - from) * folds.exp() < self.nothing
    }

    /// How to integrate A of contacts with labels between these two, of which the first breaks earlier, among them `middle`.
    pub(super) fn rule<'a>(
        &self,
        passage: &StepPassage<'a>,
        between: [Label<'_>; 2],
        middle: Label<'_>,
    ) -> StepRule<'a> {
        let &StepPassage { path, ends: (from, to), .. } = passage;
        let moments = [from, 0.5 * (from + to), to].map(|s| passage.at(s));
        let ln_rates = between.map(|label| {
            moments.each_ref().map(|(stretch, aged)| self.ln_rate(*stretch, aged.threshold_of(label)))
        });
        let highest = ln_rates[0].into_iter().fold(f64::NEG_INFINITY, f64::max);
        if self.temperature.attempt_rate * path.duration * (to - from) * highest.exp() < self.nothing {
            return StepRule::Nothing;
        }
        let change = |[a, b, c]: [f64; 3]| (b - a).abs() + (c - b).abs();
        let bend = |[a, b, c]: [f64; 3]| (b - 0.5 * (a + c)).abs();
        if ln_rates.into_iter().any(|at| bend(at) > self.most_bend) {
            return StepRule::Fitted;
        }
        let change = ln_rates.map(change).into_iter().fold(0.0, f64::max);
        let does = |(_, most): &(&[(f64, f64)], f64)| change <= *most;
        let Some((rule, _)) = RULES.into_iter().zip(self.most_change).find(does) else {
            return StepRule::Fitted;
        };
        let moment =
            |&(point, weight): &(f64, f64)| passage.moment(from + (to - from) * point, (to - from) * weight);
        let mut nodes: Vec<_> = rule.iter().map(moment).collect();
        if self.separable {
            self.unite(&mut nodes);
        } else if let Some(one) = self.united(passage, &nodes, (between, middle)) {
            nodes.clear();
            nodes.push(one);
        }
        StepRule::Shared(nodes)
    }

    /// What a part of a step adds to A of one label: where w changes little by Simpson's rule, on the three rates that decide
    /// on the rule.
    pub(super) fn added_in(&self, passage: &StepPassage<'_>, label: Label<'_>) -> f64 {
        let &StepPassage { path, ends: (from, to), .. } = passage;
        let ln_rates = [from, 0.5 * (from + to), to].map(|s| {
            let (stretch, aged) = passage.at(s);
            self.ln_rate(stretch, aged.threshold_of(label))
        });
        let change = (ln_rates[1] - ln_rates[0]).abs() + (ln_rates[2] - ln_rates[1]).abs();
        if change <= self.most_change_simpson {
            let [first, middle, last] = ln_rates.map(f64::exp);
            let attempts = self.temperature.attempt_rate * path.duration * (to - from);
            return (attempts / 6.0 * (first + 4.0 * middle + last)).min(MOST);
        }
        match self.rule(passage, [label; 2], label) {
            StepRule::Nothing => 0.0,
            StepRule::Shared(nodes) => self.added_to(&nodes, label),
            StepRule::Fitted => {
                let mut nodes = Vec::new();
                self.fit(passage, label, &mut nodes);
                self.added_to(&nodes, label)
            }
        }
    }

    /// ln w = −kh²/2T + kx²/2T with constant thresholds: nodes at the largest stretch, weighted for that, do for all
    /// thresholds, and are one.
    fn unite(&self, nodes: &mut Vec<QuadratureMoment<'_>>) {
        let unit = 0.5 * self.stiffness.of(1.0) / self.temperature.energy;
        let Some(most) = nodes.iter().copied().max_by(|a, b| a.stretch.total_cmp(&b.stretch)) else { return };
        let lower = |node: &QuadratureMoment<'_>| {
            unit * (node.stretch - most.stretch) * (node.stretch + most.stretch)
        };
        let time = nodes.iter().map(|node| node.time * lower(node).exp()).sum();
        nodes.clear();
        nodes.push(QuadratureMoment { time, ..most });
    }

    /// One node in place of several, at the mean time of breaking, with the weight that gives A of the middle label; if it
    /// gives A of the labels at both ends, too. It does where rates of different labels rise alike: the error is the square of
    /// how their ratio changes in the step, over 24.
    fn united<'a>(
        &self,
        passage: &StepPassage<'a>,
        nodes: &[QuadratureMoment<'a>],
        (between, middle): ([Label<'_>; 2], Label<'_>),
    ) -> Option<QuadratureMoment<'a>> {
        let (mut whole, mut first) = (0.0, 0.0);
        for node in nodes {
            let term = node.time * self.factor(node, middle);
            whole += term;
            first += node.s * term;
        }
        if whole <= 0.0 {
            return None;
        }
        let mut one = passage.moment(first / whole, 1.0);
        one.time = whole / self.factor(&one, middle);
        let serves = |label: Label<'_>| {
            let all: f64 = nodes.iter().map(|node| node.time * self.factor(node, label)).sum();
            (one.time * self.factor(&one, label) - all).abs() <= self.most_missed * all
        };
        between.into_iter().all(serves).then_some(one)
    }

    /// w/ω at a node.
    fn factor(&self, node: &QuadratureMoment<'_>, label: Label<'_>) -> f64 {
        self.ln_rate(node.stretch, node.aged.threshold_of(label)).exp()
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
    pub(super) fn added(&self, moments: &[QuadratureMoment], labels: &NodalLabels) -> Nodal {
        vectorised(
            #[inline(always)]
            || self.sum_over(moments, labels),
        )
    }

    #[inline(always)]
    fn sum_over(&self, moments: &[QuadratureMoment], labels: &NodalLabels) -> Nodal {
        let mut sum = Nodal::default();
        let unit = -0.5 * self.stiffness.of(1.0) / self.temperature.energy;
        for moment in moments {
            let (x, time) = (moment.stretch, moment.time * self.temperature.attempt_rate);
            let thresholds = moment.aged.thresholds_of(labels);
            // −ΔE/T of each barrier in units that depend on x and h only; one loop for each, which vectorises.
            let catastrophe = |h: f64| (1.0 - x / h) * (1.0 - x / h).abs().sqrt();
            match (self.temperature.barrier, &self.stiffness) {
                (Barrier::Elastic, Stiffness::Equal(_)) => {
                    add_rates(&mut sum, &thresholds, (x, time), |h| unit * ((h - x) * (h + x)));
                }
                (Barrier::Elastic, Stiffness::PerThreshold(_)) => {
                    add_rates(&mut sum, &thresholds, (x, time), |h| unit * h * ((h - x) * (h + x)));
                }
                (Barrier::Bell, Stiffness::Equal(_)) => {
                    add_rates(&mut sum, &thresholds, (x, time), |h| unit * h * (h - x));
                }
                (Barrier::Bell, Stiffness::PerThreshold(_)) => {
                    add_rates(&mut sum, &thresholds, (x, time), |h| unit * (h * h) * (h - x));
                }
                (Barrier::Catastrophe, Stiffness::Equal(_)) => {
                    add_rates(&mut sum, &thresholds, (x, time), |h| unit * (h * h) * catastrophe(h));
                }
                (Barrier::Catastrophe, Stiffness::PerThreshold(_)) => {
                    add_rates(&mut sum, &thresholds, (x, time), |h| unit * (h * h * h) * catastrophe(h));
                }
                (_, Stiffness::Tabulated(table)) => {
                    let exponent = |h: f64| -self.temperature.exponent(x, h, table.at(h));
                    add_rates(&mut sum, &thresholds, (x, time), exponent);
                }
            }
        }
        sum
    }

    /// Contribution of the nodes to A of one label.
    pub(super) fn added_to(&self, moments: &[QuadratureMoment], label: Label<'_>) -> f64 {
        moments.iter().map(|moment| self.over(moment, label)).sum()
    }

    #[inline]
    fn over(&self, moment: &QuadratureMoment, label: Label<'_>) -> f64 {
        let rate = self.ln_rate(moment.stretch, moment.aged.threshold_of(label)).exp();
        (moment.time * self.temperature.attempt_rate * rate).min(MOST)
    }

    /// ln(w/ω), continued beyond the threshold.
    #[inline]
    fn ln_rate(&self, stretch: f64, threshold: f64) -> f64 {
        if threshold * FAR <= stretch || threshold <= 0.0 {
            return 0.0;
        }
        let whole = 0.5 * self.stiffness.of(threshold) * threshold * threshold;
        -whole / self.temperature.energy * self.temperature.barrier.continued(stretch / threshold)
    }
}

/// Adds `time` e^{`ln_rate`} at sixteen thresholds and a stretch, where there is a barrier.
#[inline(always)]
fn add_rates(sum: &mut Nodal, thresholds: &Nodal, (stretch, time): (f64, f64), ln_rate: impl Fn(f64) -> f64) {
    let (thresholds, mut out) = (*thresholds, *sum);
    for i in 0..NODES {
        let h = thresholds[i];
        let exponent = if h * FAR <= stretch { 0.0 } else { ln_rate(h) };
        out[i] += time * exp(exponent);
    }
    *sum = out;
}

/// Contacts far below the stretch have broken; their exponents must not overflow.
const MOST: f64 = 1e300;

/// Where the stretch is so many thresholds there is no barrier, and its continuation overflows.
const FAR: f64 = 1e100;

/// Largest number of bisections of a step.
const DEEPEST: u32 = 30;

/// Where ln w is lower by this, the contribution is negligible.
const GONE_BY: f64 = 16.0;

/// At the far end the deviation may be larger by this factor: it is largest there, and the rule is exact for
/// parabolas.
const FARTHER: f64 = 4.0;
