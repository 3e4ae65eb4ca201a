//! Thresholds that follow from the age of a contact: who is left is told by their newborn thresholds.
//!
//! A contact born with the threshold h_0 ~ P_ci, above its stretch then, is left with the probability e^{−A}, A = ∫w dt,
//! while its present threshold has stayed above its stretch: while h_0 > c, the largest newborn threshold that the stretch
//! has met. The share left is ∫_c^∞ P_ci e^{−A} dh_0 over that at birth. A is kept at Gauss points of panels; on the panel
//! where c lies ln A is the polynomial through its values there, for which the rate is continued past y = 1.

use serde::{Deserialize, Serialize};

use super::cohort::Place;
use super::panels::{Panel, panels};
use super::path::Path;
use super::seeds::Seed;
use crate::contacts::{Barrier, Contacts, Stiffness, Strength, Temperature};
use crate::law::{Atom, Law, SharedLaw};
use crate::numerics::legendre::NODES;
use crate::numerics::roots::brent_root;
use crate::{Error, Result};

/// Thresholds that follow from age.
#[derive(Debug)]
pub(super) struct Ranks {
    law: SharedLaw,
    strength: Strength,
    temperature: Option<Temperature>,
    stiffness: Stiffness,
    /// By how much ln w may change in a part of a time step that one of the [`RULES`] is to sum.
    most_change: [f64; RULES.len()],
    panels: Vec<Panel>,
    /// Newborn thresholds at the Gauss points of the panels, then the atoms' …
    labels: Vec<f64>,
    /// … and the share of the newborn at each.
    weights: Vec<f64>,
    atoms: Vec<Atom>,
    /// How many labels stand for the density, …
    spread: usize,
    /// … and the share of the newborn at each label of these and above.
    above: Vec<f64>,
}

/// Who is left of a place.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Left {
    /// c.
    met: f64,
    /// The share of each atom whose cell has not been passed by its threshold.
    atoms: Vec<f64>,
    /// A at each label; empty where nothing breaks below its threshold.
    exponents: Vec<f64>,
    /// From this label of the density on, A = 0.
    reached: usize,
    /// The share of P_ci above the stretch at birth.
    newborn: f64,
}

/// Gauss rules on [0, 1], as points and weights.
const RULES: [&[(f64, f64)]; 3] = [
    &[(0.211_324_865_405_187_13, 0.5), (0.788_675_134_594_812_9, 0.5)],
    &[(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)],
    &[
        (0.069_431_844_202_973_71, 0.173_927_422_568_726_92),
        (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
        (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
        (0.930_568_155_797_026_3, 0.173_927_422_568_726_92),
    ],
];

/// Contacts with a larger A are gone; what adds less is nothing.
const GONE: f64 = 60.0;
const NOTHING: f64 = 1e-15;

/// Lumps meet a threshold this near.
const MET: f64 = 1e-12;

/// The width of a panel with this upper end, by the e-folds that a rate may fall by on it: no more than E_0/T grows by.
fn widest(contacts: &Contacts, temperature: &Temperature, high: f64) -> f64 {
    let folds = match temperature.barrier {
        // Sixteen points integrate exp(−e^{−t}) over three to 1e-12.
        Barrier::Elastic | Barrier::Bell => 3.0,
        // Its rate has a weak singularity where the threshold is met.
        Barrier::Catastrophe => 1.0,
    };
    let steeper = match contacts.stiffness {
        Stiffness::Equal(_) => 1.0,
        Stiffness::PerThreshold(_) => 1.5,
    };
    folds * temperature.energy / (steeper * contacts.stiffness.of(high) * high)
}

/// Whether temperature moves places of breaking by more than the tolerance, in mean thresholds: by T/(k x̄) for every e-fold
/// of time over 1/ω, of which there are no more than `MOST`.
fn is_felt(contacts: &Contacts, temperature: &Temperature, tolerance: f64) -> bool {
    const MOST: f64 = 50.0;
    let mean = contacts.thresholds.mean();
    let blur = temperature.energy / (contacts.stiffness.of(mean) * mean * mean);
    MOST * blur > tolerance
}

/// The fraction of the contacts, over the tolerance, whose thresholds are so high that they need not be told apart finely.
const RARE: f64 = 0.1;

/// Refuses panels of which each cohort would have to keep more numbers than it may.
fn affordable(law: &dyn Law, widest: f64, rare: f64) -> Result<()> {
    /// Per cohort, of which there are about a thousand.
    const BYTES: u64 = 1 << 20;
    let range = law.upper_quantile(rare) - law.quantile(rare);
    let needed = (range / widest * (NODES * size_of::<f64>()) as f64) as u64;
    if needed <= BYTES {
        return Ok(());
    }
    let what = "following contacts at a temperature that blurs thresholds so little";
    Err(Error::TooLarge {
        key: "contacts.temperature.energy".into(),
        what: what.into(),
        needed,
        allowed: BYTES,
    })
}

/// The change c of ln w over which a rule of n points misses the tolerance: ∫₀¹ e^{cs} ds to c²ⁿ (n!)⁴/[(2n + 1)((2n)!)³].
fn most_change(rule: &[(f64, f64)], tolerance: f64) -> f64 {
    let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
    let n = rule.len();
    let error = factorial(n).powi(4) / ((2 * n + 1) as f64 * factorial(2 * n).powi(3));
    (tolerance / error).powf(0.5 / n as f64)
}

impl Ranks {
    pub(super) fn new(contacts: &Contacts, tolerance: f64) -> Result<Self> {
        let law = contacts.thresholds.clone();
        let temperature = contacts.rules.temperature.filter(|t| is_felt(contacts, t, tolerance));
        let widest = |high: f64| temperature.map_or(f64::INFINITY, |t| widest(contacts, &t, high));
        let rare = RARE * tolerance;
        affordable(law.as_ref(), widest(law.upper_quantile(rare)), rare)?;
        let panels = panels(law.as_ref(), widest, rare);
        let points = panels.iter().flat_map(|panel| panel.points());
        let (mut labels, mut weights): (Vec<_>, Vec<_>) =
            points.map(|(h, width)| (h, width * law.density(h))).unzip();
        let (atoms, spread) = (law.atoms(), labels.len());
        let mut above = vec![0.0; spread + 1];
        (0..spread).rev().for_each(|i| above[i] = above[i + 1] + weights[i]);
        labels.extend(atoms.iter().map(|atom| atom.position));
        weights.extend(atoms.iter().map(|atom| atom.weight));
        let strength = Strength::of(contacts)?;
        Ok(Self {
            law,
            strength,
            temperature,
            stiffness: contacts.stiffness,
            most_change: RULES.map(|rule| most_change(rule, tolerance)),
            panels,
            labels,
            weights,
            atoms,
            spread,
            above,
        })
    }

    /// How many numbers a step of a cohort goes through.
    pub(super) fn cells(&self) -> usize {
        if self.temperature.is_some() { self.labels.len() } else { 1 }
    }

    pub(super) fn newborn(&self, seed: &Seed) -> Left {
        let exponents = if self.temperature.is_some() { vec![0.0; self.labels.len()] } else { Vec::new() };
        let above = |atom: &Atom| uncovered(atom.position, seed.stretch, seed.below, seed.above);
        let atoms = self.atoms.iter().map(above).collect();
        let mut left = Left { met: seed.stretch.abs(), atoms, exponents, reached: 0, newborn: 1.0 };
        left.newborn = self.count(&left);
        left
    }

    /// Whether there is a share of each atom and an exponent at each label that has one.
    pub(super) fn fits(&self, left: &Left) -> bool {
        let exponents = if self.temperature.is_some() { self.labels.len() } else { 0 };
        (left.atoms.len(), left.exponents.len()) == (self.atoms.len(), exponents)
            && left.reached <= self.spread
    }

    /// Time passes: thermal breaks, and thresholds that are met. By how much ageing makes the others stiffer.
    pub(super) fn advance(&self, place: Place, left: &mut Left, path: &Path, ends: (f64, f64)) -> f64 {
        let older = place.age + path.duration * (ends.1 - ends.0);
        let before = self.stiffening(left, place.age, older);
        self.go(place, left, path, ends);
        0.5 * (before + self.stiffening(left, place.age, older))
    }

    /// By how much these contacts get stiffer from one age to another.
    fn stiffening(&self, left: &Left, age: f64, older: f64) -> f64 {
        if self.strength.is_constant() || matches!(self.stiffness, Stiffness::Equal(_)) {
            return 0.0;
        }
        self.measure(left, older).1 - self.measure(left, age).1
    }

    fn go(&self, place: Place, left: &mut Left, path: &Path, (from, to): (f64, f64)) {
        if let Some(temperature) = &self.temperature {
            self.accumulate(temperature, place, left, path, (from, to));
        }
        let stretch = (place.stretch + path.advance(from, to)).abs();
        let aged = self.strength.at(place.age + path.duration * (to - from));
        left.met = left.met.max(aged.newborn(stretch));
        let (below, above) = (place.below, place.above);
        for (share, atom) in left.atoms.iter_mut().zip(&self.atoms) {
            *share = share.min(uncovered(aged.threshold(atom.position), stretch, below, above));
        }
    }

    /// Adds ∫w dt to the exponents, by a Gauss rule on each part in which ln w changes little.
    fn accumulate(
        &self,
        temperature: &Temperature,
        place: Place,
        left: &mut Left,
        path: &Path,
        (from, to): (f64, f64),
    ) {
        let (rule, parts) = self.rule(temperature, place, path, (from, to));
        let gone = left.exponents.partition_point(|&exponent| exponent > GONE);
        // On a panel with some that are not gone, all are followed: A is interpolated on it.
        let first =
            (self.first(left.met) * NODES).min(self.spread).max(gone.min(self.spread) / NODES * NODES);
        for part in 0..parts {
            let width = (to - from) / f64::from(parts);
            let start = from + width * f64::from(part);
            for (point, weight) in rule {
                let s = start + point * width;
                let stretch = (place.stretch + path.advance(from, s)).abs();
                let aged = self.strength.at(place.age + path.duration * (s - from));
                let time = weight * path.duration * width;
                let added = |label: f64| {
                    time * self.rate(temperature, stretch, aged.threshold(label).max(f64::MIN_POSITIVE))
                };
                for label in first..self.spread {
                    let exponent = added(self.labels[label]);
                    // The stronger a contact the lower its rate.
                    if exponent < NOTHING {
                        break;
                    }
                    left.exponents[label] += exponent;
                    left.reached = left.reached.max(label + 1);
                }
                for label in self.spread..self.labels.len() {
                    left.exponents[label] += added(self.labels[label]);
                }
            }
        }
    }

    /// The rate, continued past the threshold.
    #[inline]
    fn rate(&self, temperature: &Temperature, stretch: f64, threshold: f64) -> f64 {
        let whole = 0.5 * self.stiffness.of(threshold) * threshold * threshold;
        let missing = temperature.barrier.continued(stretch / threshold);
        temperature.attempt_rate * (-whole / temperature.energy * missing).exp()
    }

    /// The rule that needs the fewest points in all, and in how many parts ln w changes little enough for it.
    fn rule(
        &self,
        temperature: &Temperature,
        place: Place,
        path: &Path,
        (from, to): (f64, f64),
    ) -> (&'static [(f64, f64)], u32) {
        /// Enough for any rate.
        const MOST: f64 = 256.0;
        let newborn = self.panels.last().map_or(0.0, |panel| panel.high);
        let newborn = self.atoms.last().map_or(newborn, |atom| newborn.max(atom.position));
        let (age, time) = (place.age, path.duration * (to - from));
        let (before, after) =
            (self.strength.threshold(newborn, age), self.strength.threshold(newborn, age + time));
        let top = before.max(after);
        let moved = path.advance(from, to).abs() + (after - before).abs();
        let change = self.stiffness.of(top) * top * moved / temperature.energy;
        let parts = |most: f64| (change / most).ceil().clamp(1.0, MOST) as u32;
        let rules = RULES.into_iter().zip(self.most_change.map(parts));
        rules.min_by_key(|(rule, parts)| rule.len() as u32 * parts).unwrap_or((RULES[0], 1))
    }

    /// The first panel that reaches above a label.
    fn first(&self, label: f64) -> usize {
        self.panels.partition_point(|panel| panel.high <= label)
    }

    /// The share that is left, and its stiffness.
    pub(super) fn measure(&self, left: &Left, age: f64) -> (f64, f64) {
        let count = self.count(left) / left.newborn;
        let stiffness = match self.stiffness {
            Stiffness::Equal(_) => count,
            Stiffness::PerThreshold(_) => {
                let aged = self.strength.at(age);
                self.sum(left, self.spread, |h| aged.threshold(h)) / left.newborn
            }
        };
        (count, stiffness)
    }

    fn count(&self, left: &Left) -> f64 {
        if self.temperature.is_some() {
            let reached = left.reached.max(self.first(left.met) * NODES + NODES).min(self.spread);
            return self.sum(left, reached, |_| 1.0) + self.above[reached];
        }
        let beyond = |atom: &&Atom| atom.position > left.met;
        let atoms: f64 = self.atoms.iter().filter(beyond).map(|atom| atom.weight).sum();
        (self.law.survival(left.met) - atoms).max(0.0) + self.in_atoms(left, &|_| 1.0)
    }

    /// ∫ P_ci `weight`(h_0) e^{−A} dh_0 from c up to a label of the density, and that of the atoms.
    fn sum(&self, left: &Left, end: usize, weight: impl Fn(f64) -> f64) -> f64 {
        let first = self.first(left.met);
        let split = self.panels.get(first).is_some_and(|panel| panel.low < left.met);
        let whole = (first + usize::from(split)) * NODES..end;
        let mut sum = self.in_atoms(left, &weight);
        for i in whole {
            sum += self.weights[i] * weight(self.labels[i]) * kept(left, i);
        }
        if split {
            let label = |k: usize| left.exponents.get(first * NODES + k).copied().unwrap_or(0.0);
            let exponents = std::array::from_fn(label);
            sum += self.panels[first].above(left.met, &exponents, |h| self.law.density(h) * weight(h));
        }
        sum
    }

    fn in_atoms(&self, left: &Left, weight: &impl Fn(f64) -> f64) -> f64 {
        let first = self.labels.len() - self.atoms.len();
        let term = |(k, atom): (usize, &Atom)| {
            atom.weight * weight(atom.position) * left.atoms[k] * kept(left, first + k)
        };
        self.atoms.iter().enumerate().map(term).sum()
    }

    /// When a lump that moves at `velocity` meets the next threshold that many share, up to `limit`.
    pub(super) fn strikes(&self, place: Place, left: &Left, velocity: f64, limit: f64) -> Option<f64> {
        let ahead = |atom: &Atom, time: f64| {
            self.strength.threshold(atom.position, place.age + time) - (place.stretch + velocity * time).abs()
        };
        let standing = self.atoms.iter().zip(&left.atoms).filter(|(_, share)| **share > 0.0);
        let times = standing.filter_map(|(atom, _)| {
            if self.strength.is_constant() {
                let time = (atom.position - place.stretch) / velocity;
                return (time >= 0.0 && time <= limit).then_some(time);
            }
            if ahead(atom, limit) > 0.0 {
                return None;
            }
            brent_root(|time| ahead(atom, time), 0.0, limit, 0.0)
        });
        times.reduce(f64::min)
    }

    /// Lets the atoms go that a lump has met.
    pub(super) fn strike(&self, place: Place, left: &mut Left) -> bool {
        let aged = self.strength.at(place.age);
        for (share, atom) in left.atoms.iter_mut().zip(&self.atoms) {
            if place.stretch.abs() >= aged.threshold(atom.position) * (1.0 - MET) {
                *share = 0.0;
            }
        }
        !self.atoms.is_empty()
    }
}

/// e^{−A}.
fn kept(left: &Left, label: usize) -> f64 {
    left.exponents.get(label).map_or(1.0, |exponent| (-exponent).exp())
}

/// The share of a cell around a stretch that lies below a threshold; of a lump, all until it has passed.
fn uncovered(threshold: f64, stretch: f64, below: f64, above: f64) -> f64 {
    if below + above > 0.0 {
        return ((threshold - (stretch - below)) / (below + above)).clamp(0.0, 1.0);
    }
    if stretch > threshold * (1.0 + MET) { 0.0 } else { 1.0 }
}
