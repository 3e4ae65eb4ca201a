//! The distribution of stretches at any advance of monotone motion.

use super::Stretches;
use super::renewal::RenewalSolution;
use crate::Result;
use crate::law::Atom;
use crate::monitor::{Monitor, Watch};
use crate::numerics::breakpoints::same_position;
use crate::numerics::piecewise::Piecewise;

/// Contacts that form after a free time of a distribution.
struct Formation<'a> {
    /// The rate at which they form after a free time of its density.
    rate: Piecewise,
    /// The point masses of the free time.
    delays: &'a [Atom],
}

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
        let formation = self.formation(monitor)?;
        let at = |x: f64, watch: &Watch<'_>| match &formation {
            None => self.density_at(position, x, watch),
            Some(formation) => self.formed_density_at(formation, (position, x), watch),
        };
        let atoms = self.stretch_atoms(position, &Watch::new(monitor));
        Stretches::evaluated(stretches, at, atoms, monitor)
    }

    /// How contacts form that are free for a time of a distribution before; `None` for others.
    fn formation(&self, monitor: &mut dyn Monitor) -> Result<Option<Formation<'_>>> {
        let Some((waits, delays)) = self.reformed.waits() else { return Ok(None) };
        let rate = self.solution.convolve(&Piecewise::default(), &waits, monitor)?;
        Ok(Some(Formation { rate, delays }))
    }

    /// As [`Self::density_at`], from the rate at which contacts form.
    fn formed_density_at(
        &self,
        formation: &Formation<'_>,
        (position, x): (f64, f64),
        watch: &Watch<'_>,
    ) -> f64 {
        let Formation { rate: spread, delays } = formation;
        let formed = self.reformed.formed();
        let rate = |age: f64| {
            let at = position - age;
            if at < 0.0 {
                return 0.0;
            }
            let after = |delay: &Atom| {
                let since = at - delay.position;
                if since < 0.0 { 0.0 } else { delay.weight * self.breaking_rate(since) }
            };
            spread.value_in(spread.nearest(at), at).max(0.0) + delays.iter().map(after).sum::<f64>()
        };
        let shifts = || std::iter::once(0.0).chain(delays.iter().map(|delay| delay.position));
        let places = shifts().flat_map(|by| spread.boundaries.iter().map(move |edge| edge + by));
        let cuts = places.map(|at| position - at).filter(|age| (0.0..=x).contains(age));
        let together = |(delay, birth): (&Atom, &Atom)| {
            let age = position - birth.position - delay.position;
            delay.weight * birth.weight * formed.stretch_density(x, age, watch)
        };
        let pairs =
            delays.iter().flat_map(|delay| self.solution.atoms.iter().map(move |birth| (delay, birth)));
        let single: f64 = pairs.map(together).sum();
        self.first.stretch_density(x, position, watch)
            + single
            + formed.standing_density(x, rate, cuts.chain(std::iter::once(position)), watch)
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

    fn stretch_atoms(&self, position: f64, watch: &Watch<'_>) -> Vec<Atom> {
        let mut atoms = self.first.stretch_atoms(position, watch);
        let at_once = [Atom { position: 0.0, weight: 1.0 }];
        let waits = self.reformed.waits();
        let delays = waits.as_ref().map_or(at_once.as_slice(), |waits| waits.1);
        for birth in self.simultaneous_breaks_by(position) {
            for delay in delays {
                let age = position - birth.position - delay.position;
                if delay.position > 0.0 && age < 0.0 {
                    continue;
                }
                let aged = self.reformed.formed().stretch_atoms(age.max(0.0), watch);
                let weight = birth.weight * delay.weight;
                atoms.extend(aged.into_iter().map(|a| Atom { weight: a.weight * weight, ..a }));
            }
        }
        atoms.retain(|a| a.weight > 0.0);
        Atom::sort(&mut atoms);
        atoms.dedup_by(|b, a| {
            let same =
                same_position(a.position, b.position) || (a.position - b.position).abs() < 1e-13 * position;
            a.weight += if same { b.weight } else { 0.0 };
            same
        });
        atoms
    }
}
