//! What temperature does to contacts on a way at constant velocity: their breaking rate, summed along it.

use crate::contacts::{Aged, Barrier, Contacts, Stiffness, Strength, Temperature};
use crate::numerics::dawson::dawson;
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::{Piecewise, Resolution};

/// Thermal breaking at a velocity v.
#[derive(Debug, Clone)]
pub(super) struct Exposure {
    temperature: Temperature,
    stiffness: Stiffness,
    strength: Strength,
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
    aged: Aged<'a>,
    /// ∫_r^x e^{k(ξ² − x²)/2T} dξ, where it is the same for all.
    common: Option<f64>,
}

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
        strength: Strength,
        velocity: f64,
    ) -> Self {
        Self { temperature, stiffness: contacts.stiffness, strength, velocity }
    }

    /// The contacts formed at `start`, after an advance.
    pub(super) fn at(&self, start: f64, advance: f64) -> Exposed<'_> {
        let stretch = start + advance;
        let common = match (self.temperature.barrier, self.stiffness) {
            (Barrier::Elastic, Stiffness::Equal(stiffness)) if self.strength.is_constant() => {
                Some(elastic(0.5 * stiffness / self.temperature.energy, start, stretch))
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

    /// ω/v.
    fn attempts(&self) -> f64 {
        self.temperature.attempt_rate / self.velocity
    }

    /// Whether A has no closed form that is cheap.
    pub(super) fn is_costly(&self) -> bool {
        let cheap = match self.temperature.barrier {
            Barrier::Elastic => matches!(self.stiffness, Stiffness::Equal(_)),
            Barrier::Bell => true,
            Barrier::Catastrophe => false,
        };
        !(cheap && self.strength.is_constant())
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

    /// ΔE/T of a contact at the stretch x with the present threshold h.
    fn exponent(&self, stretch: f64, threshold: f64) -> f64 {
        if threshold <= 0.0 {
            return 0.0;
        }
        let whole = 0.5 * self.stiffness(threshold) * threshold * threshold / self.temperature.energy;
        whole * self.temperature.barrier.height(stretch / threshold)
    }
}

impl Exposed<'_> {
    /// Whether the rates of two contacts have the same ratio at any stretch.
    pub(super) fn is_separable(&self) -> bool {
        self.common.is_some()
    }

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

    /// A of contacts with the newborn threshold, as a function of the advance up to `end`.
    pub(super) fn history(&self, newborn: f64, end: f64) -> Piecewise {
        /// What a contact may break by without being missed.
        const NEGLIGIBLE: f64 = 1e-18;
        let exposure = self.exposure;
        let rate = |u: f64| {
            let threshold = exposure.strength.threshold(newborn, u / exposure.velocity);
            exposure.attempts() * (-exposure.exponent(self.start + u, threshold)).exp()
        };
        let resolution = Resolution::Relative { fraction: 1e-13, negligible: NEGLIGIBLE / end };
        let rate = Piecewise::resolve(rate, &[], end, resolution);
        rate.mirrored().integrated_from_end(0.0, &[]).mirrored()
    }

    /// A, and w/v now, of contacts with the newborn threshold, of which the history of A is known.
    pub(super) fn known_risk(&self, newborn: f64, history: &Piecewise) -> (f64, f64) {
        let rate = self.exposure.attempts() * (-self.exponent(newborn)).exp();
        (history.value_in(history.nearest(self.advance), self.advance), rate)
    }

    /// A, and w/v now, of contacts with the newborn threshold.
    #[inline]
    pub(super) fn risk(&self, newborn: f64) -> (f64, f64) {
        let rate = self.exposure.attempts() * (-self.exponent(newborn)).exp();
        let way = if let Some(common) = self.common {
            common
        } else if self.exposure.strength.is_constant() {
            self.way(newborn)
        } else {
            return (self.summed(newborn), rate);
        };
        (rate * way, rate)
    }

    /// ∫_r^x e^{(ΔE(x) − ΔE(ξ))/T} dξ for a threshold h that does not change.
    fn way(&self, threshold: f64) -> f64 {
        let Exposure { temperature, .. } = self.exposure;
        let stiffness = self.exposure.stiffness(threshold);
        let half = 0.5 * stiffness / temperature.energy;
        match temperature.barrier {
            Barrier::Elastic => elastic(half, self.start, self.stretch),
            Barrier::Bell => {
                let slope = half * threshold;
                -(-slope * self.advance).exp_m1() / slope
            }
            Barrier::Catastrophe => {
                let missing = |x: f64| (1.0 - x / threshold).max(0.0).sqrt();
                let (near, far) = (missing(self.stretch), missing(self.start));
                threshold * catastrophe(half * threshold * threshold, near, far)
            }
        }
    }

    /// A where thresholds age, by quadrature over the way.
    fn summed(&self, newborn: f64) -> f64 {
        let Exposure { strength, velocity, .. } = self.exposure;
        let exponent = |u: f64| {
            let threshold = strength.threshold(newborn, u / velocity);
            self.exposure.exponent(self.start + u, threshold)
        };
        let ends = [0.0, self.advance].map(|u| (u, exponent(u)));
        self.exposure.attempts() * halved(&exponent, ends, (ends[0].1.min(ends[1].1), 0))
    }
}

/// ∫_r^x e^{b(ξ² − x²)} dξ = [D(√b x) − e^{b(r² − x²)} D(√b r)]/√b with Dawson's function D.
fn elastic(b: f64, from: f64, to: f64) -> f64 {
    let fall = b * (to - from) * (to + from);
    if fall < ONE_RULE {
        return RULE.integrate(from, to, |x| (b * (x - to) * (x + to)).exp());
    }
    let root = b.sqrt();
    (dawson(root * to) - (-fall).exp() * dawson(root * from)) / root
}

/// ∫ e^{b(q³ − t³)} 2t dt over t from q to f: of e^{−b y^{3/2}}, with y = t², relative to its value at y = q².
fn catastrophe(b: f64, near: f64, far: f64) -> f64 {
    let (cube, mut low, mut sum) = (near * near * near, near, 0.0);
    while low < far && b * (low * low * low - cube) < NOTHING {
        let next = (low * low * low + ONE_RULE / b).cbrt().min(far);
        sum += RULE.integrate(low, next, |t| 2.0 * t * (b * (cube - t * t * t)).exp());
        low = next;
    }
    sum
}

/// ∫e^{−E} over an interval, halved until E is nearly straight on its parts and falls little; `least` is the least E known.
fn halved(exponent: &impl Fn(f64) -> f64, [a, b]: [(f64, f64); 2], (least, depth): (f64, u32)) -> f64 {
    let middle = 0.5 * (a.0 + b.0);
    let at = exponent(middle);
    let least = least.min(at);
    if a.1.min(at).min(b.1) > least + NOTHING {
        return 0.0;
    }
    let bent = (at - 0.5 * (a.1 + b.1)).abs();
    if ((a.1 - b.1).abs() < ONE_RULE && bent < 0.5) || depth > MOST_HALVINGS {
        return RULE.integrate(a.0, b.0, |u| (-exponent(u)).exp());
    }
    // The later half first: as a rule that is where contacts are about to break.
    let late = halved(exponent, [(middle, at), b], (least, depth + 1));
    late + halved(exponent, [a, (middle, at)], (least.min(b.1), depth + 1))
}
