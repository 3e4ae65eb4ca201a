//! Two cohorts of ranked thresholds as one: how far apart they break, and their common thresholds.
//!
//! At each fresh threshold the numbers of survivors add up. For contacts at one stretch and of one age this is exact; otherwise
//! their stretches, ages and thresholds reached become their means.

use super::path::Place;
use super::ranked::{Band, RankedThresholds, SurvivingRanks};
use crate::numerics::legendre::Nodal;

/// A group of contacts by their thresholds, and how many of all fresh contacts it is made of.
#[derive(Debug, Clone, Copy)]
pub(super) struct MergedPart<'a> {
    pub(super) left: &'a SurvivingRanks,
    /// The fraction of all contacts that formed with it.
    pub(super) mass: f64,
}

impl MergedPart<'_> {
    /// The number of fresh contacts of which those above the stretch of formation are the group.
    fn fresh(&self) -> f64 {
        self.mass / self.left.fresh
    }
}

impl RankedThresholds {
    /// The distance between the stretches at which two groups of contacts break. `None` for groups that stay apart: those at
    /// one stretch, or between whose stretches there is a point mass of thresholds, which break together there; and without
    /// temperature densities with jumps, where the error is of first order in the distance, or stiffnesses that depend on the
    /// threshold.
    pub(super) fn distance(
        &self,
        (first, at): (&SurvivingRanks, Place),
        (second, then): (&SurvivingRanks, Place),
    ) -> Option<f64> {
        // Cells that a point mass divides are not merged either.
        let alike = |(one, other): (&(f64, f64), &(f64, f64))| one.0 == other.0 && one.0.fract() == 0.0;
        let can = if self.is_thermal() {
            let together = self.has_atoms() && (at.is_point() || then.is_point());
            !together && first.atoms.iter().zip(&second.atoms).all(alike)
        } else {
            self.is_plain() && self.is_tabulated()
        };
        // Contacts break where the stretch meets the present threshold: at stretches as far apart as the stretches now, and as
        // thresholds are by age. What has broken already shows in c.
        let aged = [at.age, then.age].map(|age| self.mean_threshold(age));
        let distance = (at.stretch - then.stretch).abs() + (aged[0] - aged[1]).abs();
        can.then(|| distance.max((first.met - second.met).abs()))
    }

    /// The thresholds of two groups as one, `part` of whose attached contacts are of the second.
    pub(super) fn merged(&self, first: MergedPart<'_>, second: MergedPart<'_>, part: f64) -> SurvivingRanks {
        let whole = first.fresh() + second.fresh();
        let parts = [first, second].map(|group| group.fresh() / whole);
        let lefts = [first, second].map(|group| group.left);
        let both = |(one, other): (&(f64, f64), &(f64, f64))| (one.0, mixed(parts, [one.1, other.1]));
        let met = lefts[0].met + part * (lefts[1].met - lefts[0].met);
        SurvivingRanks {
            met,
            atoms: lefts[0].atoms.iter().zip(&lefts[1].atoms).map(both).collect(),
            band: self.merged_band(lefts, parts, met),
            fresh: lefts[0].fresh,
        }
    }

    /// A on the panels on which some contacts of either group have broken and some have not, of those that reach above the
    /// threshold met.
    fn merged_band(&self, lefts: [&SurvivingRanks; 2], parts: [f64; 2], met: f64) -> Option<Band> {
        /// A where no contact is left.
        const NONE_LEFT: f64 = 1e3;
        let [Some(one), Some(other)] = lefts.map(|left| left.band.as_ref()) else { return None };
        if one.is_empty() && other.is_empty() {
            return Some(Band::default());
        }
        let firsts = [0, 1].map(|i| self.first_panel(lefts[i]));
        let first = firsts[0].min(firsts[1]).max(self.panel_above(met));
        let at = |band: &Band, begin: u64, number: u64| -> Nodal {
            let none = if number < begin { NONE_LEFT } else { 0.0 };
            let known = number.checked_sub(begin).and_then(|place| band.exponents.get(place as usize));
            known.copied().unwrap_or([none; _])
        };
        let panel = |number: u64| -> Nodal {
            let (a, b) = (at(one, firsts[0], number), at(other, firsts[1], number));
            std::array::from_fn(|i| mixed(parts, [a[i], b[i]]))
        };
        let end = one.end().max(other.end());
        Some(Band { first, exponents: (first..end).map(panel).collect() })
    }
}

/// A of a mixture: e^{−A} is the mean. Not below the smaller of the two, whatever rounding does.
fn mixed(parts: [f64; 2], exponents: [f64; 2]) -> f64 {
    let [(low, _), (high, more)] = if exponents[0] <= exponents[1] {
        [(exponents[0], parts[0]), (exponents[1], parts[1])]
    } else {
        [(exponents[1], parts[1]), (exponents[0], parts[0])]
    };
    // e^{−low} [1 − more (1 − e^{low − high})]
    low - (more * (low - high).exp_m1()).ln_1p()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::{Barrier, Contacts, Rules, Stiffness, Temperature, ThresholdEvolution};
    use crate::law::{Gaussian, Point, SharedLaw};
    use crate::master::transport::path::Path;
    use crate::master::transport::seeds::Seed;
    use crate::monitor::Watch;

    /// Two groups that formed at different stretches and held for different times before they came to one stretch break, as
    /// one, as both together do.
    #[test]
    fn groups_at_one_stretch_break_as_both_do() {
        let laws: [SharedLaw; 2] =
            [Arc::new(Gaussian::new(1.0, 0.1).unwrap()), Arc::new(Point::new(1.0).unwrap())];
        let stiffnesses = [Stiffness::Equal(1.0), Stiffness::PerThreshold(1.0)];
        for (law, stiffness) in laws.iter().flat_map(|law| stiffnesses.each_ref().map(|k| (law, k))) {
            for (barrier, energy) in [(Barrier::Elastic, 0.1), (Barrier::Bell, 0.02)] {
                let temperature = Some(Temperature { barrier, ..Temperature::new(energy, 1.0) });
                let rules = Rules { temperature, ..Rules::default() };
                let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
                let contacts =
                    Contacts { rules, stiffness: stiffness.clone(), ..Contacts::new(law.clone(), relaxed) };
                let ranks =
                    RankedThresholds::new(&contacts, ThresholdEvolution::of(&contacts).unwrap(), 1e-6);
                let monitor = &mut ();
                let watch = &Watch::new(monitor);
                let step = |left: &mut SurvivingRanks, from: f64, by: f64, duration: f64| {
                    let place = Place { stretch: from, below: 0.0, above: 0.0, age: 0.0 };
                    ranks.advance(place, left, &Path { duration, by }, (0.0, 1.0), watch);
                };
                let group = |start: f64, hold: f64| {
                    let seed = Seed { stretch: start, weight: 1.0, below: 0.0, above: 0.0, number: None };
                    let mut left = ranks.fresh(&seed);
                    step(&mut left, start, 0.7 - start, hold);
                    left
                };
                let masses = [0.3, 0.1];
                let mut groups = [group(0.0, 20.0), group(0.6, 2.0)];
                let [one, two] = [0, 1].map(|i| MergedPart { left: &groups[i], mass: masses[i] });
                let attached = |left: &SurvivingRanks, mass: f64| mass * ranks.measure(left, 0.0, watch).0;
                let mut merged = ranks.merged(one, two, 0.5);
                let all: f64 = (0..2).map(|i| attached(&groups[i], masses[i])).sum();
                let mass = all / attached(&merged, 1.0);
                for _ in 0..3 {
                    groups.iter_mut().for_each(|left| step(left, 0.7, 0.05, 3.0));
                    step(&mut merged, 0.7, 0.05, 3.0);
                    let sums = [0, 1].map(|number| {
                        let of = |left: &SurvivingRanks| ranks.measure(left, 0.0, watch);
                        let pick =
                            |(count, stiffness): (f64, f64)| if number == 0 { count } else { stiffness };
                        let both: f64 = (0..2).map(|i| masses[i] * pick(of(&groups[i]))).sum();
                        (mass * pick(of(&merged)) - both).abs() / all
                    });
                    // Of sixteen points on each panel, and of rules in time that are chosen for each group: a tenth of the
                    // tolerance.
                    assert!(sums.iter().all(|&off| off < 1e-7), "{law:?} {barrier:?} {sums:?}");
                    assert!(all > 0.0 && attached(&merged, mass) < all, "something breaks");
                }
            }
        }
    }
}
