//! Contacts born on one leg of motion: where they are, and how far they have been stretched.

use serde::{Deserialize, Serialize};

use super::cells::{Detail, edges, scale, top, with_atoms};
use crate::contacts::Contacts;
use crate::law::{Atom, Break, Law};
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::Piecewise;

/// A layer of contacts at stretches x, seen along the way that the slider now goes.
///
/// While the slider stood up to `ahead` further along its way, and as far as `behind` back on it, a contact now at x was
/// at x + `ahead` and at x − `behind`. The largest |x| that it has known is therefore a function of x alone,
///
/// y(x) = max(x + `ahead`, `behind` − x),
///
/// and of the density ν of contacts that were placed here, ν(x) S(y(x)) are unbroken. Births have both at 0: the stretch
/// at which a contact forms is the largest that its threshold is known to exceed.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Layer {
    /// ν: its density, …
    pub(super) density: Piecewise,
    /// … its atoms, …
    pub(super) lumps: Vec<PointMass>,
    /// … and where the density is not smooth.
    pub(super) breaks: Vec<Break>,
    /// A length over which ν varies little between its breaks.
    pub(super) resolution: f64,
    pub(super) ahead: f64,
    pub(super) behind: f64,
}

/// Contacts at one and the same stretch, an atom of ν.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct PointMass {
    pub(super) position: f64,
    pub(super) weight: f64,
    /// Up to which threshold shared by many they have gone: those have broken, however y is rounded.
    pub(super) passed: f64,
}

impl PointMass {
    pub(super) fn new(position: f64, weight: f64) -> Self {
        Self { position, weight, passed: 0.0 }
    }
}

/// Lengths that differ by less, relative to a mean threshold, differ by rounding.
pub(super) const SAME: f64 = 1e-13;

impl Layer {
    /// Contacts placed at stretches drawn from `starts`.
    ///
    /// With `conditional`, the threshold of a contact that starts at r is drawn from P_c given x_s > r (ν = R/S);
    /// otherwise stretch and threshold are independent.
    pub(super) fn placed(contacts: &Contacts, starts: &dyn Law, conditional: bool, detail: Detail) -> Self {
        let thresholds = contacts.thresholds.as_ref();
        let over = |r: f64| if conditional { thresholds.survival(r) } else { 1.0 };
        let all = top(starts, detail.negligible);
        // Contacts above every threshold are not there, or have broken at once.
        let held = if conditional { contacts.highest_start() } else { top(thresholds, detail.negligible) };
        let end = all.min(held);
        let lumps =
            starts.atoms().into_iter().map(|a| PointMass::new(a.position, a.weight / over(a.position)));
        let mut breaks: Vec<_> = starts.breaks();
        breaks.iter_mut().for_each(|b| b.amplitude /= over(b.position));
        if conditional {
            // Dividing by S adds its own where thresholds overlap.
            breaks.extend(with_atoms(thresholds).into_iter().filter_map(|b| {
                let survival = thresholds.survival(b.position);
                let amplitude = b.amplitude * starts.density(b.position) / (survival * survival);
                let met = Break { exponent: b.exponent + 1.0, amplitude, ..b };
                (survival > 0.0 && amplitude != 0.0).then_some(met)
            }));
        }
        let mut density = Piecewise::default();
        if !starts.zones().is_empty() {
            let stops: Vec<f64> = breaks.iter().map(|b| b.position).chain(detail.seams(starts)).collect();
            let edges = edges(&starts.zones(), &stops, end);
            density = Piecewise::resolve(|r| starts.density(r) / over(r), &edges, end, detail.resolution);
            density = density.part(starts.quantile(0.0), end);
        }
        Self { density, lumps: lumps.collect(), breaks, resolution: scale(starts), ..Self::default() }
    }

    /// ν(x), its density part.
    pub(super) fn density_at(&self, x: f64) -> f64 {
        self.density.value(x).max(0.0)
    }

    /// Breaks of ν, atoms among them.
    pub(super) fn all_breaks(&self) -> Vec<Break> {
        let lumps = self.lumps.iter().map(|l| Atom { position: l.position, weight: l.weight }.into());
        self.breaks.iter().copied().chain(lumps).collect()
    }

    /// Whether ν is all atoms.
    pub(super) fn is_pointed(&self) -> bool {
        self.density.coefficients.is_empty()
    }

    /// ∫_{r ≤ x} ν(r) f(r) dr, atoms included; f is not smooth at `cuts`.
    pub(super) fn sum_below(&self, x: f64, f: impl Fn(f64) -> f64, cuts: &[f64]) -> f64 {
        let lumps = self.lumps.iter().filter(|l| l.position <= x);
        let together: f64 = lumps.map(|l| l.weight * f(l.position)).sum();
        together + self.spread_below(x, f, cuts)
    }

    /// The same without atoms.
    pub(super) fn spread_below(&self, x: f64, f: impl Fn(f64) -> f64, cuts: &[f64]) -> f64 {
        let (low, high) = (self.density.start(), x.min(self.density.end()));
        if high <= low {
            return 0.0;
        }
        let mut edges = [self.density.boundaries.as_slice(), cuts, &[low, high]].concat();
        edges.retain(|&r| r >= low && r <= high);
        edges.sort_by(f64::total_cmp);
        let integrand = |r: f64| self.density_at(r) * f(r);
        edges.windows(2).map(|pair| RULE.integrate(pair[0], pair[1], integrand)).sum::<f64>()
    }

    /// The density of the unbroken contacts at stretch x.
    pub(crate) fn unbroken_density(&self, x: f64, thresholds: &dyn Law) -> f64 {
        self.density_at(x) * thresholds.survival(self.largest(x, 0.0))
    }

    /// Stretches that many unbroken contacts share, with the fraction of contacts at each; many share the `walls`.
    pub(crate) fn unbroken_atoms(&self, thresholds: &dyn Law, walls: &[f64]) -> impl Iterator<Item = Atom> {
        self.lumps.iter().map(move |lump| Atom {
            position: lump.position,
            weight: lump.weight * thresholds.survival(self.exceeded(lump, 0.0, walls)),
        })
    }

    /// y(x), once the slider has gone on by `advance`; x is the stretch before.
    pub(super) fn largest(&self, x: f64, advance: f64) -> f64 {
        (x + self.ahead.max(advance)).max(self.behind - x)
    }

    /// What the thresholds of a point mass exceed, once the slider has gone on by `advance`, where many share the `walls`. One
    /// that y equals but for rounding is above, unless it has been passed; after an advance, it is not.
    pub(super) fn exceeded(&self, lump: &PointMass, advance: f64, walls: &[f64]) -> f64 {
        let y = self.largest(lump.position, advance);
        let near = |wall: &&f64| (y - **wall).abs() <= SAME * y;
        let side = |wall: &f64| if advance > 0.0 { *wall } else { wall.next_down() };
        walls.iter().find(near).map_or(y, side).max(lump.passed)
    }

    /// Lets point masses pass the walls that they reached when the slider was `since` back on its way, or before.
    pub(crate) fn pass(&mut self, walls: &[f64], since: f64) {
        for lump in &mut self.lumps {
            let reached = lump.position - since;
            let passed = walls.iter().filter(|&&wall| wall <= reached + SAME * wall);
            lump.passed = passed.copied().fold(lump.passed, f64::max);
        }
    }

    /// Where y stops to fall with x and rises.
    pub(super) fn lowest(&self, advance: f64) -> f64 {
        0.5 * (self.behind - self.ahead.max(advance))
    }

    /// The lowest and highest stretch; `None` if there are no contacts.
    pub(crate) fn range(&self) -> Option<(f64, f64)> {
        let density = [self.density.start(), self.density.end()].into_iter();
        let density = density.take(2 * self.density.coefficients.len());
        let all = density.chain(self.lumps.iter().map(|l| l.position));
        all.fold(None, |range, x| match range {
            None => Some((x, x)),
            Some((low, high)) => Some((f64::min(low, x), f64::max(high, x))),
        })
    }

    /// ν and its weights scaled.
    #[must_use]
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.density = self.density.scaled(factor);
        self.lumps.iter_mut().for_each(|l| l.weight *= factor);
        self.breaks.iter_mut().for_each(|b| b.amplitude *= factor);
        self
    }

    /// The layer when the slider has gone on by `by` ≥ 0.
    #[must_use]
    pub(crate) fn advanced(&self, by: f64) -> Self {
        Self {
            density: self.density.shifted(by),
            lumps: self.lumps.iter().map(|l| PointMass { position: l.position + by, ..*l }).collect(),
            breaks: self.breaks.iter().map(|b| Break { position: b.position + by, ..*b }).collect(),
            ahead: (self.ahead - by).max(0.0),
            behind: self.behind + by,
            ..*self
        }
    }

    /// The layer seen along the opposite way.
    #[must_use]
    pub(crate) fn mirrored(&self) -> Self {
        Self {
            density: self.density.mirrored(),
            lumps: self.lumps.iter().rev().map(|l| PointMass { position: -l.position, ..*l }).collect(),
            breaks: self.breaks.iter().rev().map(|b| b.mirrored()).collect(),
            ahead: self.behind,
            behind: self.ahead,
            ..*self
        }
    }
}
