//! Contacts born on one leg of motion: where they are, and how far they have been stretched.

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
#[derive(Debug, Clone, Default)]
pub(crate) struct Layer {
    /// ν: its density, …
    pub(super) density: Piecewise,
    /// … its atoms, …
    pub(super) atoms: Vec<Atom>,
    /// … and where the density is not smooth.
    pub(super) breaks: Vec<Break>,
    /// A length over which ν varies little between its breaks.
    pub(super) resolution: f64,
    pub(super) ahead: f64,
    pub(super) behind: f64,
}

impl Layer {
    /// Contacts placed at stretches drawn from `starts`.
    ///
    /// With `conditional`, the threshold of a contact that starts at r is drawn from P_c given x_s > r (ν = R/S);
    /// otherwise stretch and threshold are independent.
    pub(super) fn placed(contacts: &Contacts, starts: &dyn Law, conditional: bool, detail: Detail) -> Self {
        let thresholds = contacts.thresholds.as_ref();
        let over = |r: f64| if conditional { thresholds.survival(r) } else { 1.0 };
        let all = top(starts, detail.negligible);
        let end = if conditional { all.min(contacts.highest_start()) } else { all };
        let atoms =
            starts.atoms().into_iter().map(|a| Atom { weight: a.weight / over(a.position), ..a }).collect();
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
            let stops: Vec<f64> = breaks.iter().map(|b| b.position).collect();
            let edges = edges(&starts.zones(), &stops, end);
            density = Piecewise::resolve(|r| starts.density(r) / over(r), &edges, end, detail.resolution);
            density = density.part(starts.quantile(0.0), end);
        }
        Self { density, atoms, breaks, resolution: scale(starts), ..Self::default() }
    }

    /// ν(x), its density part.
    pub(super) fn density_at(&self, x: f64) -> f64 {
        self.density.value(x).max(0.0)
    }

    /// Whether ν is all atoms.
    pub(super) fn is_pointed(&self) -> bool {
        self.density.coefficients.is_empty()
    }

    /// ∫_{r ≤ x} ν(r) f(r) dr, atoms included; f is not smooth at `cuts`.
    pub(super) fn sum_below(&self, x: f64, f: impl Fn(f64) -> f64, cuts: &[f64]) -> f64 {
        let atoms = self.atoms.iter().filter(|a| a.position <= x);
        let together: f64 = atoms.map(|a| a.weight * f(a.position)).sum();
        let (low, high) = (self.density.start(), x.min(self.density.end()));
        if high <= low {
            return together;
        }
        let mut edges = [self.density.boundaries.as_slice(), cuts, &[low, high]].concat();
        edges.retain(|&r| r >= low && r <= high);
        edges.sort_by(f64::total_cmp);
        let integrand = |r: f64| self.density_at(r) * f(r);
        together + edges.windows(2).map(|pair| RULE.integrate(pair[0], pair[1], integrand)).sum::<f64>()
    }

    /// y(x), once the slider has gone on by `advance`; x is the stretch before.
    pub(super) fn largest(&self, x: f64, advance: f64) -> f64 {
        (x + self.ahead.max(advance)).max(self.behind - x)
    }

    /// Where y stops to fall with x and rises.
    pub(super) fn lowest(&self, advance: f64) -> f64 {
        0.5 * (self.behind - self.ahead.max(advance))
    }

    /// The lowest and highest stretch; `None` if there are no contacts.
    pub(crate) fn range(&self) -> Option<(f64, f64)> {
        let density = [self.density.start(), self.density.end()].into_iter();
        let density = density.take(2 * self.density.coefficients.len());
        let all = density.chain(self.atoms.iter().map(|a| a.position));
        all.fold(None, |range, x| match range {
            None => Some((x, x)),
            Some((low, high)) => Some((f64::min(low, x), f64::max(high, x))),
        })
    }

    /// ν and its weights scaled.
    #[must_use]
    pub(crate) fn scaled(mut self, factor: f64) -> Self {
        self.density = self.density.scaled(factor);
        self.atoms.iter_mut().for_each(|a| a.weight *= factor);
        self.breaks.iter_mut().for_each(|b| b.amplitude *= factor);
        self
    }

    /// The layer when the slider has gone on by `by` ≥ 0.
    #[must_use]
    pub(crate) fn advanced(&self, by: f64) -> Self {
        Self {
            density: self.density.shifted(by),
            atoms: self.atoms.iter().map(|a| Atom { position: a.position + by, ..*a }).collect(),
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
            atoms: self.atoms.iter().rev().map(|a| Atom { position: -a.position, ..*a }).collect(),
            breaks: self.breaks.iter().rev().map(|b| b.mirrored()).collect(),
            ahead: self.behind,
            behind: self.ahead,
            ..*self
        }
    }
}
