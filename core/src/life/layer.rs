//! Contacts formed during one motion: where they are, and how far they have been stretched.

use serde::{Deserialize, Serialize};

use super::cells::{Detail, edges, scale, top, with_atoms};
use crate::contacts::Contacts;
use crate::law::{Atom, Breakpoint, Law};
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::Piecewise;

/// A layer of contacts at stretches x, seen in the present direction of motion.
///
/// The slider was up to `ahead` further in this direction, and up to `behind` further back: a contact now at
/// x was at x + `ahead` and at x − `behind`. The largest |x| that it has reached is therefore a function of x
/// alone,
///
/// y(x) = max(x + `ahead`, `behind` − x),
///
/// and ν(x) S(y(x)) of the density ν of contacts placed here are unbroken. Contacts that have just formed
/// have both at 0: the stretch at which a contact forms is the largest that its threshold is known to exceed.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct Layer {
    /// The density of ν.
    pub(super) density: Piecewise,
    /// The point masses of ν.
    pub(super) point_masses: Vec<PointMass>,
    /// The breakpoints of the density.
    pub(super) breakpoints: Vec<Breakpoint>,
    /// A length over which ν varies little between its breakpoints.
    pub(super) resolution: f64,
    pub(super) ahead: f64,
    pub(super) behind: f64,
}

/// Contacts at one stretch, a point mass of ν.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct PointMass {
    pub(super) position: f64,
    pub(super) weight: f64,
    /// Highest threshold atom already passed: makes the outcome independent of rounding in y.
    pub(super) passed: f64,
}

impl PointMass {
    pub(super) fn new(position: f64, weight: f64) -> Self {
        Self { position, weight, passed: 0.0 }
    }
}

/// Lengths that differ by less, relative to the mean threshold, are equal up to rounding.
pub(super) const SAME: f64 = 1e-13;

impl Layer {
    /// Contacts placed at stretches drawn from `starts`.
    ///
    /// With `conditional`, the threshold of a contact that starts at r is drawn from P_c given x_s > r (ν =
    /// R/S); otherwise stretch and threshold are independent.
    pub(super) fn placed(contacts: &Contacts, starts: &dyn Law, conditional: bool, detail: Detail) -> Self {
        let thresholds = contacts.thresholds.as_ref();
        let over = |r: f64| if conditional { thresholds.survival(r) } else { 1.0 };
        let all = top(starts, detail.negligible);
        // Contacts above every threshold do not exist, or have broken at once.
        let held = if conditional { contacts.highest_start() } else { top(thresholds, detail.negligible) };
        let end = all.min(held);
        let point_masses =
            starts.atoms().into_iter().map(|a| PointMass::new(a.position, a.weight / over(a.position)));
        let mut breakpoints: Vec<_> = starts.breakpoints();
        breakpoints.iter_mut().for_each(|b| b.amplitude /= over(b.position));
        if conditional {
            // Division by S adds the breakpoints of S where thresholds overlap.
            breakpoints.extend(with_atoms(thresholds).into_iter().filter_map(|b| {
                let survival = thresholds.survival(b.position);
                let amplitude = b.amplitude * starts.density(b.position) / (survival * survival);
                let met = Breakpoint { exponent: b.exponent + 1.0, amplitude, ..b };
                (survival > 0.0 && amplitude != 0.0).then_some(met)
            }));
        }
        let mut density = Piecewise::default();
        if !starts.zones().is_empty() {
            let stops: Vec<f64> =
                breakpoints.iter().map(|b| b.position).chain(detail.seams(starts)).collect();
            let edges = edges(&starts.zones(), &stops, end);
            density = Piecewise::resolve(|r| starts.density(r) / over(r), &edges, end, detail.resolution);
            density = density.part(starts.quantile(0.0), end);
        }
        Self {
            density,
            point_masses: point_masses.collect(),
            breakpoints,
            resolution: scale(starts),
            ..Self::default()
        }
    }

    /// The density of ν at x.
    pub(super) fn density_at(&self, x: f64) -> f64 {
        self.density.value(x).max(0.0)
    }

    /// Breakpoints of ν, point masses among them.
    pub(super) fn all_breaks(&self) -> Vec<Breakpoint> {
        let point_masses =
            self.point_masses.iter().map(|l| Atom { position: l.position, weight: l.weight }.into());
        self.breakpoints.iter().copied().chain(point_masses).collect()
    }

    /// Whether ν consists of point masses only.
    pub(super) fn is_pointed(&self) -> bool {
        self.density.coefficients.is_empty()
    }

    /// ∫_{r ≤ x} ν(r) f(r) dr, point masses included; f is not smooth at `cuts`.
    pub(super) fn sum_below(&self, x: f64, f: impl Fn(f64) -> f64, cuts: &[f64]) -> f64 {
        let point_masses = self.point_masses.iter().filter(|l| l.position <= x);
        let together: f64 = point_masses.map(|l| l.weight * f(l.position)).sum();
        together + self.spread_below(x, f, cuts)
    }

    /// The same without point masses.
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

    /// Stretches that many unbroken contacts share, with the fraction of contacts at each; `threshold_atoms` are the thresholds that many share.
    pub(crate) fn unbroken_atoms(
        &self,
        thresholds: &dyn Law,
        threshold_atoms: &[f64],
    ) -> impl Iterator<Item = Atom> {
        self.point_masses.iter().map(move |mass| Atom {
            position: mass.position,
            weight: mass.weight * thresholds.survival(self.exceeded(mass, 0.0, threshold_atoms)),
        })
    }

    /// y(x) after a further `advance` of the slider; x is the stretch before it.
    pub(super) fn largest(&self, x: f64, advance: f64) -> f64 {
        (x + self.ahead.max(advance)).max(self.behind - x)
    }

    /// What the thresholds of a point mass are known to exceed after a further `advance`. A threshold atom
    /// that equals y up to rounding counts as not exceeded before an advance, unless it has been passed, and
    /// as exceeded after one.
    pub(super) fn exceeded(&self, point_mass: &PointMass, advance: f64, threshold_atoms: &[f64]) -> f64 {
        let y = self.largest(point_mass.position, advance);
        let near = |atom: &&f64| (y - **atom).abs() <= SAME * y;
        let side = |atom: &f64| if advance > 0.0 { *atom } else { atom.next_down() };
        threshold_atoms.iter().find(near).map_or(y, side).max(point_mass.passed)
    }

    /// Marks the threshold atoms that point masses had reached when the slider was `since` back, or before.
    pub(crate) fn mark_passed(&mut self, threshold_atoms: &[f64], since: f64) {
        for point_mass in &mut self.point_masses {
            let reached = point_mass.position - since;
            let passed = threshold_atoms.iter().filter(|&&atom| atom <= reached + SAME * atom);
            point_mass.passed = passed.copied().fold(point_mass.passed, f64::max);
        }
    }

    /// The x at which y is smallest.
    pub(super) fn lowest(&self, advance: f64) -> f64 {
        0.5 * (self.behind - self.ahead.max(advance))
    }

    /// The lowest and highest stretch; `None` if there are no contacts.
    pub(crate) fn range(&self) -> Option<(f64, f64)> {
        let density = [self.density.start(), self.density.end()].into_iter();
        let density = density.take(2 * self.density.coefficients.len());
        let all = density.chain(self.point_masses.iter().map(|l| l.position));
        all.fold(None, |range, x| match range {
            None => Some((x, x)),
            Some((low, high)) => Some((f64::min(low, x), f64::max(high, x))),
        })
    }

    /// The layer times a factor.
    #[must_use]
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.density = self.density.scaled(factor);
        self.point_masses.iter_mut().for_each(|l| l.weight *= factor);
        self.breakpoints.iter_mut().for_each(|b| b.amplitude *= factor);
        self
    }

    /// The layer after the slider has advanced by `by` ≥ 0.
    #[must_use]
    pub(crate) fn advanced(&self, by: f64) -> Self {
        Self {
            density: self.density.shifted(by),
            point_masses: self
                .point_masses
                .iter()
                .map(|l| PointMass { position: l.position + by, ..*l })
                .collect(),
            breakpoints: self
                .breakpoints
                .iter()
                .map(|b| Breakpoint { position: b.position + by, ..*b })
                .collect(),
            ahead: (self.ahead - by).max(0.0),
            behind: self.behind + by,
            ..*self
        }
    }

    /// The layer seen in the opposite direction.
    #[must_use]
    pub(crate) fn mirrored(&self) -> Self {
        Self {
            density: self.density.mirrored(),
            point_masses: self
                .point_masses
                .iter()
                .rev()
                .map(|l| PointMass { position: -l.position, ..*l })
                .collect(),
            breakpoints: self.breakpoints.iter().rev().map(|b| b.mirrored()).collect(),
            ahead: self.behind,
            behind: self.ahead,
            ..*self
        }
    }
}
