//! Thermal breaking during motion at constant velocity: the breaking rate and its integral (the cumulative
//! hazard).

use super::constant_threshold::{ConstantThreshold, ConstantThresholds};
use crate::contacts::{
    Barrier, Contacts, Label, NodalLabels, Stiffness, Temperature, ThresholdEvolution, ThresholdTrajectory,
    ThresholdsAtAge,
};
use crate::law::Law;
use crate::numerics::exponential::exp;
use crate::numerics::legendre::{NODES, Nodal, RULE, dot_in_lanes, gauss_points};
use crate::numerics::piecewise::{Piecewise, Resolution};
use crate::numerics::wide::vectorised;

/// Thermal breaking at a velocity v.
#[derive(Debug, Clone)]
pub(super) struct ThermalHazard {
    temperature: Temperature,
    stiffness: Stiffness,
    evolution: ThresholdEvolution,
    velocity: f64,
}

/// The breaking rates of contacts formed at a stretch r that are now at x = r + u.
///
/// A(h_0) = (1/v) ∫_r^x w dξ is the cumulative hazard of contacts with fresh threshold h_0: the fraction
/// e^{−A} survives.
#[derive(Debug)]
pub(super) struct ThermalHazardAt<'a> {
    thermal: &'a ThermalHazard,
    start: f64,
    advance: f64,
    stretch: f64,
    aged: ThresholdsAtAge<'a>,
    /// ∫_r^x e^{k(ξ² − x²)/2T} dξ, if it is the same for all thresholds.
    common: Option<f64>,
}

/// Cumulative hazard A and hazard w/v per length.
pub(super) type Hazards = (f64, f64);

/// One cell of a Legendre series is enough if exponents differ by less, and their middle from their mean by less than `BENT`.
const ONE_CELL: f64 = 4.0;
const BENT: f64 = 0.5;

/// One Gauss rule, whose degree is twice that of the series, is enough for so much: for e^{−E}, E linear and falling by 12, it
/// misses 1e-19.
const ONE_RULE: f64 = 10.0;
const RULE_BENT: f64 = 0.75;

/// Contributions this far below the largest exponent are neglected.
const NOTHING: f64 = 40.0;

/// Largest number of bisections.
const MOST_HALVINGS: u32 = 40;

/// T/(k x̄): the length of stretch over which temperature blurs the breaking of contacts.
pub(super) fn blur(contacts: &Contacts, temperature: &Temperature) -> f64 {
    let mean = contacts.thresholds.mean();
    temperature.energy / (contacts.stiffness.of(mean) * mean)
}

impl ThermalHazard {
    pub(super) fn new(
        contacts: &Contacts,
        temperature: Temperature,
        evolution: ThresholdEvolution,
        velocity: f64,
    ) -> Self {
        Self { temperature, stiffness: contacts.stiffness.clone(), evolution, velocity }
    }

    /// The contacts formed at `start`, after an advance.
    pub(super) fn at(&self, start: f64, advance: f64) -> ThermalHazardAt<'_> {
        let stretch = start + advance;
        // ΔE = ½k(h² − x²): thresholds enter as the factor e^{−kh²/2T} only, and one integral
        // serves all contacts.
        let common = match (self.temperature.barrier, &self.stiffness) {
            (Barrier::Elastic, Stiffness::Equal(stiffness)) if self.evolution.is_constant() => {
                let whole = 0.5 * stiffness * stretch * stretch / self.temperature.energy;
                let sum = || ConstantThreshold::new(Barrier::Elastic, stretch, whole, start).at(advance).0;
                Some(if advance > 0.0 { sum() } else { 0.0 })
            }
            _ => None,
        };
        let aged = self.evolution.at(advance / self.velocity);
        ThermalHazardAt { thermal: self, start, advance, stretch, aged, common }
    }

    /// The threshold above which contacts are negligible: their contribution to ∫u² U du is, for any
    /// lifetime.
    ///
    /// A contact survives at most until it reaches its threshold, and usually not longer than the v/w with
    /// which it starts; hence the strongest contacts dominate in creep. Survival is scanned in steps of a
    /// hundredth.
    pub(super) fn highest(&self, law: &dyn Law, negligible: f64) -> f64 {
        const LEAST: f64 = 1e-300;
        let longest = |h: f64| h.min((self.exponent(0.0, h).min(700.0)).exp() / self.attempts());
        let lived = |h: f64| {
            let aged = self.evolution.threshold(h, h / self.velocity).max(h);
            longest(aged).powi(3)
        };
        let steps =
            std::iter::successors(Some(1.0), |left: &f64| Some(0.01 * left).filter(|&left| left > LEAST));
        let places: Vec<(f64, f64)> = steps
            .map(|left| law.upper_quantile(left))
            .map(|h| (h, law.survival(h.next_down()) * lived(h)))
            .collect();
        let most = places.iter().fold(0.0, |most, place| f64::max(most, place.1));
        let above = places.iter().rposition(|place| place.1 > negligible * most).unwrap_or(0);
        places[(above + 1).min(places.len() - 1)].0
    }

    /// Whether ΔE is a smooth function of the stretch and the threshold, also where the stretch exceeds the threshold.
    pub(super) fn is_smooth(&self) -> bool {
        self.temperature.barrier != Barrier::Catastrophe && !matches!(self.stiffness, Stiffness::Tabulated(_))
    }

    /// ΔE/T of contacts formed at `start` after an advance, if it is smooth; continued to stretches above thresholds.
    #[inline(always)]
    pub(super) fn exponents(&self, start: f64, advance: f64, labels: &NodalLabels) -> Nodal {
        let thresholds = self.evolution.at(advance / self.velocity).thresholds_of(labels);
        self.smooth_exponents(start + advance, &thresholds)
    }

    #[inline(always)]
    fn smooth_exponents(&self, stretch: f64, thresholds: &Nodal) -> Nodal {
        let (thresholds, mut out) = (*thresholds, [0.5 / self.temperature.energy; NODES]);
        match self.stiffness {
            Stiffness::PerThreshold(factor) => {
                out.iter_mut().zip(&thresholds).for_each(|(half, h)| *half *= factor * h);
            }
            _ => out.iter_mut().for_each(|half| *half *= self.stiffness.of(1.0)),
        }
        if self.temperature.barrier == Barrier::Elastic {
            for i in 0..NODES {
                out[i] *= (thresholds[i] - stretch) * (thresholds[i] + stretch);
            }
        } else {
            for i in 0..NODES {
                out[i] *= (thresholds[i] - stretch) * thresholds[i];
            }
        }
        out
    }

    /// Rounding of ΔE/T and noise of thresholds from a table, as a fraction of ΔE/T.
    pub(super) fn roughness(&self) -> f64 {
        16.0 * f64::EPSILON + self.evolution.error()
    }

    /// Whether contacts with this fresh threshold, formed at `start`, are stretched to their threshold after an advance.
    pub(super) fn has_reached(&self, start: f64, advance: f64, fresh: f64) -> bool {
        start + advance >= self.evolution.threshold(fresh, advance / self.velocity)
    }

    /// The advance on the scale of which, added to the advance, thresholds change.
    pub(super) fn time_scale(&self) -> f64 {
        self.velocity * self.evolution.time_scale()
    }

    /// ω/v.
    pub(super) fn attempts(&self) -> f64 {
        self.temperature.attempt_rate / self.velocity
    }

    /// The largest difference of the exponents of two fresh thresholds at zero stretch, up to an age.
    pub(super) fn apart(&self, fresh: [f64; 2], age: f64) -> f64 {
        let at = |age: f64| {
            let aged = self.evolution.at(age);
            let [low, high] = fresh.map(|h| self.exponent(0.0, aged.threshold(h)));
            (high - low).abs()
        };
        at(0.0).max(at(age))
    }

    /// ΔE/T of a contact formed at `start` with this fresh threshold, as a function of the advance.
    fn ahead(&self, start: f64, fresh: f64) -> impl Fn(f64) -> f64 {
        let contact = self.evolution.followed(fresh);
        move |u| self.exponent(start + u, contact.threshold(u / self.velocity))
    }

    /// ∫e^{−ΔE/T} du between two advances of a contact formed at `start`, by one Gauss rule; its loops vectorise.
    #[inline(always)]
    fn sum(&self, contact: &ThresholdTrajectory<'_>, start: f64, [low, high]: [f64; 2]) -> f64 {
        let advances = gauss_points(0.5 * (low + high), 0.5 * (high - low));
        let mut ages = advances;
        ages.iter_mut().for_each(|u| *u /= self.velocity);
        let thresholds = contact.thresholds(&ages);
        let mut whole = [0.0; NODES];
        for i in 0..NODES {
            whole[i] = 0.5 / self.temperature.energy * thresholds[i] * thresholds[i];
        }
        match &self.stiffness {
            Stiffness::Equal(stiffness) => whole.iter_mut().for_each(|whole| *whole *= stiffness),
            Stiffness::PerThreshold(factor) => {
                whole.iter_mut().zip(&thresholds).for_each(|(whole, h)| *whole *= factor * h);
            }
            Stiffness::Tabulated(table) => {
                whole.iter_mut().zip(&thresholds).for_each(|(whole, h)| *whole *= table.at(*h));
            }
        }
        let terms = match self.temperature.barrier {
            Barrier::Elastic => {
                survivals(&whole, &thresholds, &advances, start, |missing, y| missing * (1.0 + y))
            }
            Barrier::Bell => survivals(&whole, &thresholds, &advances, start, |missing, _| missing),
            Barrier::Catastrophe => {
                survivals(&whole, &thresholds, &advances, start, |missing, _| missing * missing.sqrt())
            }
        };
        0.5 * (high - low) * dot_in_lanes(&terms, &RULE.weights)
    }

    /// ΔE/T of a contact of stretch x and present threshold h.
    fn exponent(&self, stretch: f64, threshold: f64) -> f64 {
        if threshold <= 0.0 {
            return 0.0;
        }
        let whole = 0.5 * self.stiffness.of(threshold) * threshold * threshold / self.temperature.energy;
        whole * self.temperature.barrier.height_at(stretch, threshold)
    }
}

impl ThermalHazardAt<'_> {
    /// The advance.
    pub(super) fn advance(&self) -> f64 {
        self.advance
    }

    /// ΔE/T now.
    #[inline]
    pub(super) fn exponent(&self, fresh: f64) -> f64 {
        self.thermal.exponent(self.stretch, self.aged.threshold(fresh))
    }

    /// The present threshold of contacts with this fresh threshold.
    pub(super) fn threshold(&self, fresh: f64) -> f64 {
        self.aged.threshold(fresh)
    }

    /// ΔE/T at formation.
    pub(super) fn exponent_at_start(&self, fresh: f64) -> f64 {
        self.thermal.exponent(self.start, fresh)
    }

    /// ΔE/T now of contacts with a label.
    pub(super) fn exponent_of(&self, label: Label<'_>) -> f64 {
        self.thermal.exponent(self.stretch, self.aged.threshold_of(label))
    }

    /// The present thresholds of contacts with these labels.
    #[inline(always)]
    pub(super) fn thresholds_of(&self, labels: &NodalLabels) -> Nodal {
        self.aged.thresholds_of(labels)
    }

    /// w/v now of contacts with these present thresholds, if ΔE is smooth.
    #[inline(always)]
    pub(super) fn rates_of(&self, thresholds: &Nodal) -> Nodal {
        let (exponents, mut out) = (self.thermal.smooth_exponents(self.stretch, thresholds), [0.0; NODES]);
        let attempts = self.thermal.attempts();
        for i in 0..NODES {
            out[i] = attempts * exp(-exponents[i]);
        }
        out
    }

    /// A, and w/v now, of contacts with this fresh threshold.
    #[inline]
    pub(super) fn hazards(&self, fresh: f64) -> Hazards {
        if let Some(common) = self.common {
            let rate = self.rate(fresh);
            return (rate * common, rate);
        }
        if self.thermal.evolution.is_constant() {
            let ((sum, now), attempts) = (self.constant(fresh).at(self.advance), self.thermal.attempts());
            return (attempts * sum, attempts * now);
        }
        (self.cumulative_hazard(fresh), self.rate(fresh))
    }

    /// Sixteen constant thresholds.
    pub(super) fn constants(&self, thresholds: Nodal) -> ConstantThresholds {
        let wholes = thresholds.map(|h| self.thermal.exponent(0.0, h));
        ConstantThresholds::new(self.thermal.temperature.barrier, thresholds, wholes)
    }

    /// A, and w/v now, of contacts with sixteen constant thresholds.
    #[inline(always)]
    pub(super) fn hazards_of(&self, constants: &ConstantThresholds) -> [Nodal; 2] {
        if let Some(common) = self.common {
            let rates = self.rates_of(&constants.thresholds);
            let mut broken = rates;
            broken.iter_mut().for_each(|rate| *rate *= common);
            return [broken, rates];
        }
        let ([mut broken, mut rates], attempts) =
            (constants.at(self.start, self.advance), self.thermal.attempts());
        for i in 0..NODES {
            broken[i] *= attempts;
            rates[i] *= attempts;
        }
        [broken, rates]
    }

    /// A, and w/v now, if A is known as a function of the advance.
    #[inline]
    pub(super) fn interpolated_hazards(&self, fresh: f64, broken: &Piecewise) -> Hazards {
        (broken.value_in(broken.nearest(self.advance), self.advance), self.rate(fresh))
    }

    fn constant(&self, threshold: f64) -> ConstantThreshold {
        let ThermalHazard { temperature, .. } = self.thermal;
        let whole = self.thermal.exponent(0.0, threshold);
        ConstantThreshold::new(temperature.barrier, threshold, whole, self.start)
    }

    /// w/v now.
    #[inline]
    fn rate(&self, fresh: f64) -> f64 {
        self.rate_of(self.exponent(fresh))
    }

    /// w/v of contacts with the exponent ΔE/T.
    pub(super) fn rate_of(&self, exponent: f64) -> f64 {
        self.thermal.attempts() * (-exponent).exp()
    }

    /// A of contacts with this fresh threshold as a function of the advance up to `end`.
    pub(super) fn history(&self, fresh: f64, end: f64) -> Piecewise {
        /// Broken fraction of a contact that is negligible.
        const NEGLIGIBLE: f64 = 1e-18;
        let thermal = self.thermal;
        let exponent = thermal.ahead(self.start, fresh);
        let rate = |u: f64| thermal.attempts() * (-exponent(u)).exp();
        // Exponents above this contribute less than the negligible part to A over the whole
        // advance.
        let most = (thermal.attempts() * end / NEGLIGIBLE).ln();
        let mut edges = Vec::new();
        split(&exponent, [0.0, end].map(|u| (u, exponent(u))), (most, 0), &mut edges);
        // Rounding of E is felt in e^{−E}.
        let fraction = 1e-13_f64.max(16.0 * f64::EPSILON * exponent(0.0).max(exponent(end)));
        let resolution = Resolution::Relative { fraction, negligible: NEGLIGIBLE / end };
        let rate = Piecewise::resolve(rate, &edges, end, resolution);
        // The integral from 0 to u, as that from u to the end of the mirrored function.
        rate.mirrored().integrated_from_end(0.0, &[]).mirrored()
    }

    /// A by quadrature, for thresholds that age.
    fn cumulative_hazard(&self, fresh: f64) -> f64 {
        /// Sixteen Gauss points integrate to 1e-12 over five times the distance of a singularity: they gain 2.4³².
        const WIDEST: f64 = 5.0;
        /// The same where singularities are only estimated: that of a barrier that is a half power of the distance to the threshold,
        /// from this distance at both ends, and those of thresholds from a table of ranks.
        const NARROWER: f64 = 1.5;
        /// A half power of the distance to the threshold does not matter nearer than this, in thresholds.
        const NEAREST: f64 = 1e-4;
        let ThermalHazard { temperature, evolution, velocity, .. } = self.thermal;
        let exponent = self.thermal.ahead(self.start, fresh);
        let contact = evolution.followed(fresh);
        let ends = [0.0, self.advance].map(|u| (u, exponent(u)));
        // Thresholds are singular functions of the age at −τ, and the barrier of the distance to the threshold at 0.
        let before = velocity * evolution.time_scale();
        let rooted = temperature.barrier == Barrier::Catastrophe;
        let widest = if rooted || evolution.error() > 0.0 { NARROWER } else { WIDEST };
        let cut = |low: f64, high: f64| {
            let near = low + widest * (low + before);
            if near < high {
                return Some(near);
            }
            let is_far = || {
                let h = [low, high].map(|u| contact.threshold(u / velocity));
                let left = [h[0] - self.start - low, h[1] - self.start - high];
                (left[1] - left[0]).abs() <= widest * left[0].min(left[1]).max(NEAREST * h[1])
            };
            (rooted && !is_far()).then_some(0.5 * (low + high))
        };
        let sum = |low: f64, high: f64| {
            vectorised(
                #[inline(always)]
                || self.thermal.sum(&contact, self.start, [low, high]),
            )
        };
        let integral = AdaptiveIntegral { exponent: &exponent, cut: &cut, sum: &sum };
        self.thermal.attempts() * integral.between(ends, (ends[0].1.min(ends[1].1), 0))
    }
}

/// Boundaries on an interval, bisected until E is nearly linear on each part and falls little, or is above
/// `most`.
fn split(
    exponent: &impl Fn(f64) -> f64,
    [a, b]: [(f64, f64); 2],
    (most, depth): (f64, u32),
    edges: &mut Vec<f64>,
) {
    let middle = 0.5 * (a.0 + b.0);
    let at = exponent(middle);
    if a.1.min(at).min(b.1) > most || is_even([a.1, at, b.1]) || depth > MOST_HALVINGS {
        return;
    }
    split(exponent, [a, (middle, at)], (most, depth + 1), edges);
    edges.push(middle);
    split(exponent, [(middle, at), b], (most, depth + 1), edges);
}

/// Whether E, given at both ends and in the middle of an interval, is nearly linear and falls little.
fn is_even([a, middle, b]: [f64; 3]) -> bool {
    (a - b).abs() < ONE_CELL && (middle - 0.5 * (a + b)).abs() < BENT
}

/// e^{−ΔE/T} of sixteen contacts at the stretches `start` + advance with the barriers `whole` × `height`, a function of 1 − y
/// and y.
#[inline(always)]
fn survivals(
    whole: &Nodal,
    thresholds: &Nodal,
    advances: &Nodal,
    start: f64,
    height: impl Fn(f64, f64) -> f64,
) -> Nodal {
    let (whole, thresholds, advances, mut out) = (*whole, *thresholds, *advances, [0.0; NODES]);
    for i in 0..NODES {
        let (h, x) = (thresholds[i], start + advances[i]);
        let missing = ((h - x) / h).max(0.0);
        let exponent = if h > 0.0 { -whole[i] * height(missing, x / h) } else { 0.0 };
        out[i] = exp(exponent);
    }
    out
}

/// ∫e^{−E} by adaptive Gauss–Legendre quadrature, one rule of which is `sum`. Intervals are divided where `cut` says, and bisected
/// until E is nearly linear on each and falls little.
struct AdaptiveIntegral<'a, E, C, S> {
    exponent: &'a E,
    cut: &'a C,
    sum: &'a S,
}

impl<E: Fn(f64) -> f64, C: Fn(f64, f64) -> Option<f64>, S: Fn(f64, f64) -> f64>
    AdaptiveIntegral<'_, E, C, S>
{
    /// The integral between two advances with known E; `least` is the smallest E known.
    fn between(&self, [a, b]: [(f64, f64); 2], (least, depth): (f64, u32)) -> f64 {
        let cut = (self.cut)(a.0, b.0);
        let middle = cut.unwrap_or(0.5 * (a.0 + b.0));
        let at = (self.exponent)(middle);
        let least = least.min(at);
        if a.1.min(at).min(b.1) > least + NOTHING {
            return 0.0;
        }
        let straight = (at - 0.5 * (a.1 + b.1)).abs() < RULE_BENT;
        let even = cut.is_none() && straight && (a.1 - b.1).abs() < ONE_RULE;
        if even || depth > MOST_HALVINGS {
            return (self.sum)(a.0, b.0);
        }
        // The later half first: contacts are usually about to break there, which makes the earlier half
        // negligible.
        let late = self.between([(middle, at), b], (least, depth + 1));
        late + self.between([a, (middle, at)], (least.min(b.1), depth + 1))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::Ageing;
    use crate::law::{Gamma, Gaussian, Point, SharedLaw};

    /// A, by a composite Gauss rule on intervals that become shorter by a fifth towards both ends.
    fn composite(thermal: &ThermalHazard, start: f64, advance: f64, fresh: f64) -> f64 {
        let parts = || std::iter::successors(Some(0.5 * advance), |u: &f64| Some(u / 1.2)).take(140);
        let edges = parts().chain(parts().map(|u| advance - u)).chain([0.0, advance]);
        let mut edges: Vec<f64> = edges.collect();
        edges.sort_by(f64::total_cmp);
        let exponent = thermal.ahead(start, fresh);
        let rule = |pair: &[f64]| RULE.integrate(pair[0], pair[1], |u| (-exponent(u)).exp());
        thermal.attempts() * edges.windows(2).map(rule).sum::<f64>()
    }

    /// The largest error of A of contacts that have not reached their thresholds, as a fraction of A or of 1.
    fn error(contacts: &Contacts, start: f64, velocity: f64) -> f64 {
        let evolution = ThresholdEvolution::of(contacts).unwrap();
        let temperature = contacts.rules.temperature.unwrap();
        let thermal = ThermalHazard::new(contacts, temperature, evolution, velocity);
        let mut largest = 0.0_f64;
        for fresh in (0..60).map(|k| start + 0.003 + 0.03 * f64::from(k)) {
            let breaks = |u: f64| thermal.evolution.threshold(fresh, u / velocity) <= start + u;
            if contacts.thresholds.cumulative(fresh) < 1e-10 {
                continue;
            }
            for advance in (1..120).map(|k| 0.011 * f64::from(k)).take_while(|&u| !breaks(u)).step_by(9) {
                let exact = composite(&thermal, start, advance, fresh);
                let found = thermal.at(start, advance).hazards(fresh).0;
                // Of these contacts some have broken, and some are left.
                if (1e-15..50.0).contains(&exact) {
                    largest = largest.max((found / exact - 1.0).abs() * exact.min(1.0));
                }
            }
        }
        largest
    }

    #[test]
    fn hazards_of_contacts_that_age_are_those_of_a_composite_rule() {
        let gaussian = |mean, std| -> SharedLaw { Arc::new(Gaussian::new(mean, std).unwrap()) };
        let gamma = |mean, std| -> SharedLaw { Arc::new(Gamma::new(mean, std).unwrap()) };
        let logarithmic = |growth| Ageing::Logarithmic { growth, time: 1.0 };
        let ranked = |mature| Ageing::FrozenRank { mature, time: 1.0 };
        let cases = [
            (gaussian(1.0, 0.1), logarithmic(0.05)),
            (gaussian(1.0, 0.3), logarithmic(0.3)),
            (gaussian(1.0, 0.1), ranked(gaussian(1.5, 0.15))),
            (gaussian(1.0, 0.2), ranked(gaussian(0.6, 0.05))),
            (gaussian(1.0, 0.1), ranked(gaussian(0.5, 0.3))),
            (gamma(1.0, 0.2), ranked(gamma(1.4, 0.2))),
        ];
        // Each rule of ageing with each barrier; temperatures, velocities and starts take turns.
        let settings =
            [(0.02, 0.01, 0.0), (0.02, 1.0, 0.3), (0.1, 0.1, 0.0), (0.02, 0.01, 0.3), (0.02, 1.0, 0.0)];
        let mut settings = settings.into_iter().cycle();
        for (thresholds, ageing) in cases {
            for barrier in [Barrier::Elastic, Barrier::Bell, Barrier::Catastrophe] {
                for (energy, velocity, start) in settings.by_ref().take(2) {
                    let mut contacts = Contacts::new(thresholds.clone(), Arc::new(Point::new(0.0).unwrap()));
                    contacts.rules.ageing = Some(ageing.clone());
                    contacts.rules.temperature =
                        Some(Temperature { barrier, ..Temperature::new(energy, 1.0) });
                    // Rounding of exponents of some hundreds, and what rules leave out. A table of ranks is another polynomial
                    // between each two of its ages: jumps of 1e-11 in a threshold h are h/T times that in A.
                    let table = ThresholdEvolution::of(&contacts).unwrap().error() > 0.0;
                    let allowed = if table { 1e-8 } else { 1e-11 };
                    let error = error(&contacts, start, velocity);
                    assert!(
                        error < allowed,
                        "{ageing:?}, {barrier:?}, T = {energy}, v = {velocity}, start {start}: {error:e}"
                    );
                }
            }
        }
    }
}
