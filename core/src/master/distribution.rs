//! The distribution of stretches at any advance of monotone motion.

use super::Stretches;
use super::renewal::RenewalSolution;
use crate::Result;
use crate::law::Atom;
use crate::monitor::{Monitor, Watch};
use crate::numerics::breakpoints::same_position;

impl RenewalSolution {
    /// The density part of Γ.
    pub(super) fn breaking_rate(&self, position: f64) -> f64 {
        let rate = &self.solution.density;
        rate.value_in(rate.nearest(position), position).max(0.0)
    }

    /// Q(x; X) at the given stretches, and its point masses.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn stretch_density(
        &self,
        position: f64,
        stretches: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Stretches> {
        let at = |x: f64, watch: &Watch<'_>| self.density_at(position, x, watch);
        Stretches::evaluated(stretches, at, self.stretch_atoms(position), monitor)
    }

    fn density_at(&self, position: f64, x: f64, watch: &Watch<'_>) -> f64 {
        // Initial contacts, contacts re-formed at point masses of Γ, and those re-formed continuously.
        let past = self.simultaneous_breaks_by(position);
        let (first, reformed) = (&self.first, &self.reformed);
        let since = |birth: &Atom| reformed.stretch_density(x, position - birth.position, watch);
        let single: f64 = past.iter().map(|birth| birth.weight * since(birth)).sum();
        let rate = |u: f64| if u > position { 0.0 } else { self.breaking_rate(position - u) };
        let edges = &self.solution.density.boundaries;
        let recent = edges.partition_point(|&b| b < position - x);
        let cuts = edges[recent..].iter().take_while(|&&b| b < position).map(|b| position - b);
        let cuts = cuts.chain(std::iter::once(position));
        first.stretch_density(x, position, watch) + single + reformed.standing_density(x, rate, cuts, watch)
    }

    /// Point masses of Γ at or before `position` whose contacts may still be unbroken there.
    fn simultaneous_breaks_by(&self, position: f64) -> &[Atom] {
        let end = self.reformed.survival().curve().end();
        let last = self.solution.atoms.partition_point(|a| a.position <= position * (1.0 + 1e-12));
        let first = self.solution.atoms.partition_point(|a| a.position < position - end);
        &self.solution.atoms[first.min(last)..last]
    }

    fn stretch_atoms(&self, position: f64) -> Vec<Atom> {
        let mut atoms = self.first.stretch_atoms(position);
        for birth in self.simultaneous_breaks_by(position) {
            let aged = self.reformed.stretch_atoms((position - birth.position).max(0.0));
            atoms.extend(aged.into_iter().map(|a| Atom { weight: a.weight * birth.weight, ..a }));
        }
        atoms.retain(|a| a.weight > 0.0);
        atoms.sort_by(|a, b| a.position.total_cmp(&b.position));
        atoms.dedup_by(|b, a| {
            let same =
                same_position(a.position, b.position) || (a.position - b.position).abs() < 1e-13 * position;
            a.weight += if same { b.weight } else { 0.0 };
            same
        });
        atoms
    }
}
