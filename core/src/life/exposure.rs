//! What temperature does to contacts on a way at constant velocity: their breaking rate, summed along it.

use super::constant::Constant;
use crate::contacts::{Barrier, Contacts, Stiffness, Temperature, ThresholdEvolution, ThresholdsAtAge};
use crate::law::Law;
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::{Piecewise, Resolution};

/// Thermal breaking at a velocity v.
#[derive(Debug, Clone)]
pub(super) struct Exposure {
    temperature: Temperature,
    stiffness: Stiffness,
    strength: ThresholdEvolution,
    velocity: f64,
}

/// The breaking rates of contacts formed at a stretch r that are now at x = r + u.
///
/// A(h_0) = (1/v) ∫_r^x w dξ is what has broken of those with the newborn threshold h_0, as −ln of what is left.
#[derive(Debug)]
pub(super) struct Exposed<'a> {
    exposure: &'a Exposure,
    start: f64,
    advance: f64,
    stretch: f64,
    aged: ThresholdsAtAge<'a>,
    /// ∫_r^x e^{k(ξ² − x²)/2T} dξ, where it is the same for all.
    common: Option<f64>,
}

/// A and w/v.
pub(super) type Risk = (f64, f64);

/// Exponents that differ by less are left to one Gauss rule.
const ONE_RULE: f64 = 4.0;

/// What lies this far below the largest exponent is not summed.
const NOTHING: f64 = 40.0;

/// Halvings of a way on which the exponent varies.
const MOST_HALVINGS: u32 = 40;

/// T/(k x̄): the length of stretch on which temperature blurs where contacts break.
pub(super) fn blur(contacts: &Contacts, temperature: &Temperature) -> f64 {
    let mean = contacts.thresholds.mean();
    let stiffness = match contacts.stiffness {
        Stiffness::Equal(stiffness) => stiffness,
        Stiffness::PerThreshold(factor) => factor * mean,
    };
    temperature.energy / (stiffness * mean)
}

impl Exposure {
    pub(super) fn new(
        contacts: &Contacts,
        temperature: Temperature,
        strength: ThresholdEvolution,
        velocity: f64,
    ) -> Self {
        Self { temperature, stiffness: contacts.stiffness, strength, velocity }
    }

    /// The contacts formed at `start`, after an advance.
    pub(super) fn at(&self, start: f64, advance: f64) -> Exposed<'_> {
        let stretch = start + advance;
        let common = match (self.temperature.barrier, self.stiffness) {
            (Barrier::Elastic, Stiffness::Equal(stiffness)) if self.strength.is_constant() => {
                let whole = 0.5 * stiffness * stretch * stretch / self.temperature.energy;
                let sum = || Constant::new(Barrier::Elastic, stretch, whole, start).at(advance).0;
                Some(if advance > 0.0 { sum() } else { 0.0 })
            }
            _ => None,
        };
        let aged = self.strength.at(advance / self.velocity);
        Exposed { exposure: self, start, advance, stretch, aged, common }
    }

    /// k of a contact with the present threshold h.
    fn stiffness(&self, threshold: f64) -> f64 {
        match self.stiffness {
            Stiffness::Equal(stiffness) => stiffness,
            Stiffness::PerThreshold(factor) => factor * threshold,
        }
    }

    /// The threshold above which contacts are negligible: what they add to ∫u² U du is, however long they live.
    ///
    /// A contact lives for no longer than its way to its threshold, nor, as a rule, than the v/w with which it starts; so
    /// that where contacts flow the strongest weigh most. Survival is looked at in steps of a hundredth.
    pub(super) fn highest(&self, law: &dyn Law, negligible: f64) -> f64 {
        const LEAST: f64 = 1e-300;
        let longest = |h: f64| h.min((self.exponent(0.0, h).min(700.0)).exp() / self.attempts());
        let lived = |h: f64| {
            let aged = self.strength.threshold(h, h / self.velocity).max(h);
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

    /// ω/v.
    fn attempts(&self) -> f64 {
        self.temperature.attempt_rate / self.velocity
    }

    /// The most by which the exponents of two newborn thresholds differ, of contacts without stretch, up to an age.
    pub(super) fn apart(&self, newborn: [f64; 2], age: f64) -> f64 {
        let at = |age: f64| {
            let aged = self.strength.at(age);
            let [low, high] = newborn.map(|h| self.exponent(0.0, aged.threshold(h)));
            (high - low).abs()
        };
        at(0.0).max(at(age))
    }

    /// ΔE/T of a contact formed at `start` with the newborn threshold, as a function of the advance.
    fn ahead(&self, start: f64, newborn: f64) -> impl Fn(f64) -> f64 {
        let contact = self.strength.followed(newborn);
        move |u| self.exponent(start + u, contact.threshold(u / self.velocity))
    }

    /// ΔE/T of a contact at the stretch x with the present threshold h.
    fn exponent(&self, stretch: f64, threshold: f64) -> f64 {
        if threshold <= 0.0 {
            return 0.0;
        }
        let whole = 0.5 * self.stiffness(threshold) * threshold * threshold / self.temperature.energy;
        whole * self.temperature.barrier.height_at(stretch, threshold)
    }
}

impl Exposed<'_> {
    /// ΔE/T now.
    #[inline]
    pub(super) fn exponent(&self, newborn: f64) -> f64 {
        self.exposure.exponent(self.stretch, self.aged.threshold(newborn))
    }

    /// How much the exponents of two newborn thresholds differ, now or when they formed.
    pub(super) fn apart(&self, newborn: [f64; 2]) -> f64 {
        let [now, then] = [self.stretch, self.start].map(|x| {
            let [low, high] = newborn.map(|h| if x == self.stretch { self.aged.threshold(h) } else { h });
            (self.exposure.exponent(x, high) - self.exposure.exponent(x, low)).abs()
        });
        now.max(then)
    }

    /// A, and w/v now, of contacts with the newborn threshold.
    #[inline]
    pub(super) fn risk(&self, newborn: f64) -> Risk {
        if let Some(common) = self.common {
            let rate = self.rate(newborn);
            return (rate * common, rate);
        }
        if self.exposure.strength.is_constant() {
            let ((sum, now), attempts) = (self.constant(newborn).at(self.advance), self.exposure.attempts());
            return (attempts * sum, attempts * now);
        }
        (self.summed(newborn), self.rate(newborn))
    }

    /// The same where A is known as a function of the advance.
    #[inline]
    pub(super) fn known_risk(&self, newborn: f64, broken: &Piecewise) -> Risk {
        (broken.value_in(broken.nearest(self.advance), self.advance), self.rate(newborn))
    }

    fn constant(&self, threshold: f64) -> Constant {
        let Exposure { temperature, .. } = self.exposure;
        let whole = self.exposure.exponent(0.0, threshold);
        Constant::new(temperature.barrier, threshold, whole, self.start)
    }

    /// w/v now.
    #[inline]
    fn rate(&self, newborn: f64) -> f64 {
        self.exposure.attempts() * (-self.exponent(newborn)).exp()
    }

    /// A of contacts with the newborn threshold, as a function of the advance up to `end`.
    pub(super) fn history(&self, newborn: f64, end: f64) -> Piecewise {
        /// What a contact may break by without being missed.
        const NEGLIGIBLE: f64 = 1e-18;
        let exposure = self.exposure;
        let exponent = exposure.ahead(self.start, newborn);
        let rate = |u: f64| exposure.attempts() * (-exponent(u)).exp();
        let most = (exposure.attempts() * end / NEGLIGIBLE).ln();
        let mut edges = Vec::new();
        split(&exponent, [0.0, end].map(|u| (u, exponent(u))), (most, 0), &mut edges);
        // Rounding of E is felt in e^{−E}.
        let fraction = 1e-13_f64.max(16.0 * f64::EPSILON * exponent(0.0).max(exponent(end)));
        let resolution = Resolution::Relative { fraction, negligible: NEGLIGIBLE / end };
        let rate = Piecewise::resolve(rate, &edges, end, resolution);
        rate.mirrored().integrated_from_end(0.0, &[]).mirrored()
    }

    /// A where thresholds age, by quadrature over the way.
    fn summed(&self, newborn: f64) -> f64 {
        let exponent = self.exposure.ahead(self.start, newborn);
        let ends = [0.0, self.advance].map(|u| (u, exponent(u)));
        self.exposure.attempts() * halved(&exponent, ends, (ends[0].1.min(ends[1].1), 0))
    }
}

/// Places that cut an interval, halved until E is nearly straight on its parts and falls little, or is above `most`.
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

/// Whether E, at both ends and in the middle of an interval, is nearly straight and falls little.
fn is_even([a, middle, b]: [f64; 3]) -> bool {
    (a - b).abs() < ONE_RULE && (middle - 0.5 * (a + b)).abs() < 0.5
}

/// ∫e^{−E} over an interval, halved until E is nearly straight on its parts and falls little; `least` is the least E known.
fn halved(exponent: &impl Fn(f64) -> f64, [a, b]: [(f64, f64); 2], (least, depth): (f64, u32)) -> f64 {
    let middle = 0.5 * (a.0 + b.0);
    let at = exponent(middle);
    let least = least.min(at);
    if a.1.min(at).min(b.1) > least + NOTHING {
        return 0.0;
    }
    if is_even([a.1, at, b.1]) || depth > MOST_HALVINGS {
        return RULE.integrate(a.0, b.0, |u| (-exponent(u)).exp());
    }
    // The later half first: as a rule that is where contacts are about to break.
    let late = halved(exponent, [(middle, at), b], (least, depth + 1));
    late + halved(exponent, [a, (middle, at)], (least.min(b.1), depth + 1))
}
