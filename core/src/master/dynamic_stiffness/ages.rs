//! The linear response of steady sliding by integrals over the ages and the thresholds of contacts, of contacts that re-form at once.
//!
//! A deviation δX e^{st} of the slider stretches a contact of age a, formed at t − a, by δx = (1 − e^{−sa}) δX e^{st} more. With S(a)
//! the surviving fraction of contacts of one fresh threshold, w(x, h) their breaking rate, x = va their stretch, h(a) their threshold
//! and a_b the age at which x reaches h, the fraction that survives changes by
//!
//! δS(a) = −[S(a) Q(a) + S(a_b) (1 − e^{−s a_b})/(v − h'(a_b)) δ(a − a_b)] δX e^{st}, Q(a) = ∫₀^a ∂w/∂x (1 − e^{−sa'}) e^{−s(a − a')} da'.
//!
//! The rate of formation Γ changes so that contacts stay as many: with ⟨·⟩ the mean over fresh thresholds and Γ_s = 1/⟨∫S da⟩,
//!
//! δΓ ⟨∫e^{−sa} S da⟩ = −Γ_s ⟨∫δS da⟩, F̂(s) = N_c {δΓ ⟨∫k x e^{−sa} S da⟩ + Γ_s ⟨∫k [x δS + (1 − e^{−sa}) S] da⟩}.

use num_complex::Complex64;

use super::{ImmediateResponse, LIVES, beyond};
use crate::Result;
use crate::contacts::{Ageing, Contacts, ThresholdEvolution};
use crate::law::Law;
use crate::monitor::{Monitor, Part, report};
use crate::numerics::legendre::{NODES, RULE};
use crate::numerics::roots::brent_root;

/// The integrals by the trapezoidal rule of all ages and of every second one, extrapolated (Richardson).
#[derive(Debug, Clone)]
pub(super) struct AgeIntegrals {
    rules: [TrapezoidalRule; 2],
    /// Up to which frequency ages and thresholds resolve the response.
    highest: f64,
    /// Both responses transformed at this frequency.
    at_highest: [Complex64; 2],
    /// ∫r dt of both.
    integrals: [f64; 2],
}

/// Contacts of all fresh thresholds.
#[derive(Debug, Clone)]
struct TrapezoidalRule {
    count: f64,
    /// Γ_s, per time.
    rate: f64,
    lives: Vec<ThresholdLife>,
}

/// Contacts of one fresh threshold in steady sliding, at evenly spaced ages from 0 to the last one.
#[derive(Debug, Clone)]
struct ThresholdLife {
    /// Fraction of all contacts.
    weight: f64,
    spacing: f64,
    ages: Vec<AtAge>,
    /// S(a_b)/(v − h'(a_b)).
    lost: f64,
}

/// Contacts of one age.
#[derive(Debug, Clone, Copy)]
struct AtAge {
    survival: f64,
    /// ∂w/∂x.
    slope: f64,
    stiffness: f64,
    stretch: f64,
}

/// Ages of a contact, an even number.
const AGES: usize = 2000;
/// Largest error of the trapezoidal rule, in units of N_c k, that of every second age being four times as large: as large as that
/// of a response that is followed in time. What is extrapolated is far more accurate.
const ERROR: f64 = 1e-3;
/// −ln of the surviving fraction after which contacts are not followed.
const GONE: f64 = 35.0;
/// Panels of thresholds, with 16 Gauss points each.
const PANELS: u32 = 6;
/// Fraction of thresholds beyond the panels on either side.
const BEYOND: f64 = 1e-10;
/// Highest frequency that the ages resolve, in units of v over the mean threshold.
const FINE: f64 = 300.0;
/// Change of the phase of e^{−sa} over the lives of a panel that its Gauss points resolve, in radians.
const PHASE: f64 = 25.0;
/// The least highest frequency times the mean life: below, the response of most contacts is not resolved.
const LEAST: f64 = 3.0;
/// Fraction of contacts in a panel whose phases are not resolved.
const FEW: f64 = 1e-4;
/// The frequency, in units of the highest one, at which limits for s → 0 are taken, and below which F̂ is s dF_k/dv: rounding of
/// 1 − e^{−sa} and the next terms are 1e-5 of them or less.
const SLOW: f64 = 1e-7;

impl AgeIntegrals {
    /// Of contacts that slide at `velocity`; none if they re-form stretched, if their thresholds have point masses or diffuse, or if
    /// the ages do not resolve how they break.
    ///
    /// # Errors
    /// Those of [`ThresholdEvolution::of`]; an additive hazard; stopped by the monitor.
    pub(super) fn of(contacts: &Contacts, velocity: f64, monitor: &mut dyn Monitor) -> Result<Option<Self>> {
        contacts.break_by_own_threshold()?;
        let law = contacts.thresholds.as_ref();
        let ageing = &contacts.rules.ageing;
        let diffuse = matches!(ageing, Some(Ageing::Smoluchowski { .. } | Ageing::MeanField { .. }));
        if contacts.reforming.upper_quantile(0.0) > 0.0 || !law.atoms().is_empty() || diffuse {
            return Ok(None);
        }
        let evolution = ThresholdEvolution::of_with(contacts, &mut Part::new(monitor, 0.0, 0.5))?;
        let (panels, mut lives) = (panels(contacts), [Vec::new(), Vec::new()]);
        for (done, ends) in panels.windows(2).enumerate() {
            report(monitor, 0.5 + 0.5 * done as f64 / panels.len() as f64)?;
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            for (node, weight) in RULE.nodes.iter().zip(&RULE.weights) {
                let fresh = middle + half * node;
                let weight = half * weight * law.density(fresh);
                let both = ThresholdLife::both(contacts, &evolution, [velocity, fresh], weight);
                lives.iter_mut().zip(both).for_each(|(lives, life)| lives.push(life));
            }
        }
        let highest = highest(&lives[0]).min(FINE * velocity / law.mean());
        let rules = lives.map(|lives| TrapezoidalRule::new(contacts.count, lives));
        let unit = contacts.count * contacts.stiffness.of(law.mean());
        let agree = [0.03, 0.3, 1.0].iter().all(|part| {
            let s = Complex64::new(0.0, part * highest);
            let [fine, coarse] = [0, 1].map(|rule: usize| rules[rule].transforms(s)[0]);
            (fine - coarse).norm() <= 3.0 * ERROR * unit
        });
        let known = agree && highest > LEAST * rules[0].rate;
        Ok(known.then(|| Self::new(rules, highest)))
    }

    fn new(rules: [TrapezoidalRule; 2], highest: f64) -> Self {
        let zero = [Complex64::ZERO; 2];
        let mut own = Self { rules, highest, at_highest: zero, integrals: [0.0; 2] };
        own.at_highest = own.extrapolated(Complex64::new(0.0, highest));
        let [force, breaks] = own.extrapolated(Complex64::new(0.0, own.slow()));
        own.integrals = [force.im / own.slow(), breaks.re];
        own
    }

    fn slow(&self) -> f64 {
        SLOW * self.highest
    }

    #[inline(never)]
    fn extrapolated(&self, s: Complex64) -> [Complex64; 2] {
        let [fine, coarse] = [0, 1].map(|rule: usize| self.rules[rule].transforms(s));
        [0, 1].map(|i| fine[i] + (fine[i] - coarse[i]) / 3.0)
    }
}

/// The highest frequency at which the phases of the contacts in each panel are resolved.
fn highest(lives: &[ThresholdLife]) -> f64 {
    let all: f64 = lives.iter().map(|life| life.weight).sum();
    let spread = |panel: &[ThresholdLife]| {
        let weight: f64 = panel.iter().map(|life| life.weight).sum();
        let ends = || panel.iter().map(ThresholdLife::end);
        let spread = ends().fold(0.0, f64::max) - ends().fold(f64::INFINITY, f64::min);
        if weight > FEW * all { spread } else { 0.0 }
    };
    PHASE / lives.chunks(NODES).map(spread).fold(0.0, f64::max)
}

impl TrapezoidalRule {
    fn new(count: f64, mut lives: Vec<ThresholdLife>) -> Self {
        let all: f64 = lives.iter().map(|life| life.weight).sum();
        lives.iter_mut().for_each(|life| life.weight /= all);
        let mean = lives.iter().map(|life| life.weight * life.sum(|at| at.survival)).sum::<f64>();
        Self { count, rate: 1.0 / mean, lives }
    }

    /// Both responses transformed.
    #[inline(never)]
    fn transforms(&self, s: Complex64) -> [Complex64; 2] {
        let [mut held, mut lost, mut pulls, mut force] = [Complex64::ZERO; 4];
        for life in &self.lives {
            let sums = life.response(s).map(|sum| life.weight * sum);
            held += sums[0];
            lost += sums[1];
            pulls += sums[2];
            force += sums[3];
        }
        let formed = -lost / held;
        [self.count * self.rate * (force + formed * pulls), self.rate * formed / s]
    }

    /// Both responses at the time of the step.
    #[inline(never)]
    fn at_once(&self) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for life in &self.lives {
            let last = life.last();
            let stiffness = life.sum(|at| at.stiffness * at.survival);
            sums[0] += life.weight * (stiffness - last.stiffness * last.stretch * life.lost);
            sums[1] += life.weight * life.lost;
        }
        [self.count * self.rate * sums[0], self.rate * sums[1]]
    }
}

/// Boundaries of panels of fresh thresholds.
fn panels(contacts: &Contacts) -> Vec<f64> {
    let law = contacts.thresholds.as_ref();
    let (low, high) = (law.quantile(BEYOND), law.upper_quantile(BEYOND));
    let mut borders: Vec<f64> =
        (0..=PANELS).map(|i| low + (high - low) * f64::from(i) / f64::from(PANELS)).collect();
    borders.extend(law.breakpoints().iter().map(|b| b.position).filter(|at| (low..high).contains(at)));
    borders.sort_by(f64::total_cmp);
    borders.dedup();
    let mut resolved = vec![low];
    borders.windows(2).for_each(|panel| resolve(law, (panel[0], panel[1]), &mut resolved));
    resolved
}

/// Halves a panel until Gauss nodes on each part find the fraction of contacts in it, and adds their upper ends.
fn resolve(law: &dyn Law, (low, high): (f64, f64), borders: &mut Vec<f64>) {
    /// Fraction of contacts that may be missed in a panel, far below the 1e-4 to which responses are known.
    const MISSED: f64 = 1e-7;
    /// Width of the narrowest panels, relative to their place: those around point masses.
    const NARROWEST: f64 = 1e-6;
    let found = RULE.integrate(low, high, |h| law.density(h));
    let missed = (law.survival(low) - law.survival(high) - found).abs();
    if missed <= MISSED || high - low <= NARROWEST * high {
        borders.push(high);
        return;
    }
    let middle = 0.5 * (low + high);
    resolve(law, (low, middle), borders);
    resolve(law, (middle, high), borders);
}

impl ImmediateResponse for AgeIntegrals {
    fn transforms(&self, s: Complex64) -> [Complex64; 2] {
        if s.norm() < self.slow() {
            let [force, breaks] = self.integrals;
            return [s * force, breaks.into()];
        }
        if s.norm() <= self.highest {
            return self.extrapolated(s);
        }
        beyond(s, self.highest, self.at_once(), self.at_highest)
    }

    fn at_once(&self) -> [f64; 2] {
        let [fine, coarse] = [0, 1].map(|rule: usize| self.rules[rule].at_once());
        [0, 1].map(|i| fine[i] + (fine[i] - coarse[i]) / 3.0)
    }

    fn integrals(&self) -> [f64; 2] {
        self.integrals
    }

    fn highest(&self) -> f64 {
        self.highest
    }

    fn duration(&self) -> f64 {
        LIVES / self.rules[0].rate
    }
}

impl ThresholdLife {
    /// Contacts of a fresh threshold at a velocity, at all ages and at every second one, until they have reached their threshold or
    /// none are left.
    fn both(
        contacts: &Contacts,
        evolution: &ThresholdEvolution,
        [velocity, fresh]: [f64; 2],
        weight: f64,
    ) -> [Self; 2] {
        let ahead = |age: f64| velocity * age - evolution.threshold(fresh, age);
        let mut reached = fresh / velocity;
        while ahead(reached) < 0.0 {
            reached *= 2.0;
        }
        let reached = brent_root(ahead, 0.0, reached, 0.0).unwrap_or(reached);
        let followed = |end: f64, ages: usize| {
            Self::followed(contacts, evolution, [velocity, fresh], end / ages as f64, ages)
        };
        let (mut end, (mut ages, mut hazard)) = (reached, followed(reached, AGES));
        let gone = |hazard: &[f64]| hazard.iter().position(|hazard| *hazard > GONE);
        // Where hardly any contacts are left at half of the ages, all ages are put before.
        while let Some(left) = gone(&hazard).filter(|left| 2 * left < AGES) {
            end *= (left + 1) as f64 / AGES as f64;
            (ages, hazard) = followed(end, AGES);
        }
        let speed = velocity - evolution.at(end).drift(fresh);
        [ages, followed(end, AGES / 2).0].map(|ages| {
            let count = ages.len() - 1;
            let lost = if end < reached { 0.0 } else { ages[count].survival / speed };
            Self { weight, spacing: end / count as f64, ages, lost }
        })
    }

    /// The contacts at evenly spaced ages, and their cumulative hazard.
    #[inline(never)]
    fn followed(
        contacts: &Contacts,
        evolution: &ThresholdEvolution,
        [velocity, fresh]: [f64; 2],
        spacing: f64,
        ages: usize,
    ) -> (Vec<AtAge>, Vec<f64>) {
        let Contacts { stiffness, rules, .. } = contacts;
        let (mut sum, mut before) = (0.0, 0.0);
        let at = |i: usize| {
            let age = spacing * i as f64;
            let stretch = velocity * age;
            let threshold = evolution.threshold(fresh, age).max(stretch);
            let stiffness: f64 = stiffness.of(threshold);
            let (rate, slope) = rules
                .temperature
                .map_or((0.0, 0.0), |temperature| temperature.rate_and_slope(stretch, threshold, stiffness));
            sum += if i > 0 { 0.5 * spacing * (before + rate) } else { 0.0 };
            before = rate;
            (AtAge { survival: (-sum).exp(), slope, stiffness, stretch }, sum)
        };
        (0..=ages).map(at).unzip()
    }

    fn last(&self) -> &AtAge {
        &self.ages[self.ages.len() - 1]
    }

    /// The last age.
    fn end(&self) -> f64 {
        self.spacing * (self.ages.len() - 1) as f64
    }

    /// ∫ over the ages by the trapezoidal rule.
    fn sum(&self, value: impl Fn(&AtAge) -> f64) -> f64 {
        let last = self.ages.len() - 1;
        let ends = 0.5 * (value(&self.ages[0]) + value(&self.ages[last]));
        self.spacing * (ends + self.ages[1..last].iter().map(value).sum::<f64>())
    }

    /// ∫e^{−sa} S, ∫δS, ∫k x e^{−sa} S and ∫k [x δS + (1 − e^{−sa}) S] over the ages a.
    #[inline(never)]
    fn response(&self, s: Complex64) -> [Complex64; 4] {
        let step = (-s * self.spacing).exp();
        let (mut late, mut change, mut forcing) = (Complex64::from(1.0), Complex64::ZERO, Complex64::ZERO);
        let mut sums = [Complex64::ZERO; 4];
        for (i, at) in self.ages.iter().enumerate() {
            if i > 0 {
                late *= step;
                let next = at.slope * (1.0 - late);
                change = step * (change + 0.5 * self.spacing * forcing) + 0.5 * self.spacing * next;
                forcing = next;
            }
            let weight = if i == 0 || i + 1 == self.ages.len() { 0.5 * self.spacing } else { self.spacing };
            let held = weight * at.survival;
            let pull = at.stiffness * at.stretch;
            sums[0] += held * late;
            sums[1] -= held * change;
            sums[2] += held * pull * late;
            sums[3] += held * (at.stiffness * (1.0 - late) - pull * change);
        }
        let (last, broken) = (self.last(), self.lost * (1.0 - late));
        sums[1] -= broken;
        sums[3] -= last.stiffness * last.stretch * broken;
        sums
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::{Gaussian, Mixture, Point, SharedLaw};

    #[test]
    fn panels_hold_mixtures_of_narrow_distributions() {
        let gaussian = |mean, std| -> SharedLaw { Arc::new(Gaussian::new(mean, std).unwrap()) };
        for (weak, strong) in [
            ((0.9, 1.0, 0.05), (0.1, 10.0, 0.5)),
            ((0.5, 1.0, 0.05), (0.5, 12.0, 0.2)),
            ((0.5, 0.5, 0.02), (0.5, 2.0, 0.3)),
        ] {
            let parts = [weak, strong].map(|(weight, mean, std)| (weight, gaussian(mean, std)));
            let law: SharedLaw = Arc::new(Mixture::new(parts.to_vec()).unwrap());
            let contacts = Contacts::new(law.clone(), Arc::new(Point::new(0.0).unwrap()));
            let borders = panels(&contacts);
            let moment = |order: i32| -> f64 {
                let on =
                    |panel: &[f64]| RULE.integrate(panel[0], panel[1], |h| h.powi(order) * law.density(h));
                borders.windows(2).map(on).sum()
            };
            let expected = |order: i32| -> f64 {
                let of = |(weight, mean, std): (f64, f64, f64)| {
                    weight * if order == 1 { mean } else { mean * mean + std * std }
                };
                of(weak) + of(strong)
            };
            // 1e-7 of the contacts for each panel, and 1e-10 beyond the last ones.
            assert!((moment(0) - 1.0).abs() < 1e-5, "{weak:?} {strong:?}: {}", moment(0));
            for order in [1, 2] {
                let off = moment(order) / expected(order) - 1.0;
                assert!(off.abs() < 1e-5, "{weak:?} {strong:?} {order}: {off:e}");
            }
        }
    }
}
