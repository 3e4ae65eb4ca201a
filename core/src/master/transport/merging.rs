//! Merging of cohorts under error control.
//!
//! Each step adds cohorts, and an interface makes far more steps than the contacts of one cell need. Two cohorts of attached
//! fractions a and b that break at a distance Δ from each other become one at their centre. To second order the number of
//! breaks and the force then change by ab/(a + b) Δ²/2 times the change of the density of thresholds per length, at most
//! 0.24/σ² for a Gaussian, and with both signs in the life of a contact, so that changes of successive cohorts cancel.
//! The sum of ab/(a + b) Δ² of all that has been merged, the *spread* of a cohort, is limited.
//!
//! Contacts whose thresholds do not change with age have the same future at the same stretch, wherever and whenever they formed:
//! neighbours in stretch are merged. Others are merged with those that formed next at the same seed. Diffusing thresholds move
//! with the cells of a cohort to the mean stretch, those of either cohort in opposite directions.

use std::sync::Arc;

use super::Transport;
use super::cohort::Cohort;
use crate::monitor::Watch;
use crate::numerics::order::sort_by_number;

/// Whether cohorts are merged within a motion as soon as they are many.
#[derive(Debug, Clone, Copy)]
pub(super) enum MergingRule {
    Never,
    WhenMany,
}

impl Transport {
    /// Merges cohorts if they have become twice as many as after the last merging, so that merging takes no longer than the
    /// steps. Returns the number after the last merging. Where age matters, merging joins too few to repay it.
    pub(super) fn merge_many(&mut self, rule: MergingRule, few: usize) -> usize {
        let many = matches!(rule, MergingRule::WhenMany) && self.cohorts.len() > 2 * few;
        if !many || !self.model.ignores_age() {
            return few;
        }
        self.merge_cohorts();
        self.cohorts.len()
    }

    /// Merges neighbouring cohorts as far as the tolerance allows.
    pub(super) fn merge_cohorts(&mut self) {
        let Self { cohorts, seeds, model, spent, merging, .. } = self;
        let cohorts = Arc::make_mut(cohorts);
        let all_together = model.ignores_age();
        if all_together {
            sort_by_number(cohorts, |item| item.place.stretch);
        }
        let group = |cohort: &Cohort| match cohort.seed() {
            _ if all_together => Some(0),
            seed => seed.map(|seed| seed as usize),
        };
        // The last cohort of each group that stays.
        let mut last: Vec<Option<usize>> = vec![None; seeds.len().max(1)];
        let mut kept = 0;
        let (monitor, mut energy) = (&mut (), 0.0);
        let watch = Watch::new(monitor);
        for next in 0..cohorts.len() {
            let group = group(&cohorts[next]);
            if let Some(before) = group.and_then(|group| last[group]) {
                let (stay, come) = cohorts.split_at_mut(next);
                if let Some(lost) = stay[before].absorb(&come[0], model, *merging, &watch) {
                    energy += lost;
                    continue;
                }
            }
            if let Some(group) = group {
                last[group] = Some(kept);
            }
            cohorts.swap(kept, next);
            kept += 1;
        }
        spent.lost += energy;
        cohorts.truncate(kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contacts::{Ageing, Contacts, Initial, Rules, Start, Stiffness, Temperature};
    use crate::law::{Gaussian, Point, Rectangular, SharedLaw};

    /// The same contacts with and without merging, after steps far shorter than they need, of which every fifth is ten
    /// times as slow; the merged ones keep their force and have few cohorts.
    fn with_and_without_merging(contacts: &Contacts, tolerance: f64, by: f64, count: i32) -> [Transport; 2] {
        let start = Initial { law: Arc::new(Point::new(0.0).unwrap()), start: Start::Conditional };
        let mut whole = Transport::new_with(contacts.clone(), &start, tolerance, &mut ()).unwrap();
        whole.rough = None;
        let mut merged = whole.clone();
        for number in 0..count {
            let during = if number % 5 == 0 { 1.0 } else { 0.1 };
            whole.step(by, during, &mut ()).unwrap();
            merged.step(by, during, &mut ()).unwrap();
            let before = [merged.force(), merged.attached()];
            merged.merge_cohorts();
            let after = [merged.force(), merged.attached()];
            let changes = [0, 1].map(|i| (after[i] - before[i]).abs());
            // Rounding of some hundred terms.
            assert!(changes.iter().all(|&change| change < 1e-13), "{changes:?}");
            // The unit of force is N_c⟨k⟩ times the mean threshold, 1.
            let off = merged.force() - whole.force();
            assert!(off.abs() < tolerance, "{tolerance} {number}: {off:e}");
        }
        // Both lose the same energy but for the differences of stretch that merging removes: spreads over the square of
        // the width, a fiftieth of the tolerance each, times the square of the width and ½, in each of some hundred cohorts.
        let lost = merged.energies().lost - whole.energies().lost;
        assert!(lost.abs() < tolerance, "{lost:e}");
        [whole, merged]
    }

    fn contacts(rules: Rules) -> Contacts {
        let [thresholds, relaxed]: [SharedLaw; 2] =
            [Arc::new(Gaussian::new(1.0, 0.1).unwrap()), Arc::new(Point::new(0.0).unwrap())];
        Contacts { rules, ..Contacts::new(thresholds, relaxed) }
    }

    #[test]
    fn merged_cohorts_have_the_same_force() {
        let ageing = Some(Ageing::Logarithmic { growth: 0.05, time: 1.0 });
        let cold = contacts(Rules { ageing, ..Rules::default() });
        let [many, few] =
            with_and_without_merging(&cold, 1e-4, 2e-3, 2000).map(|transport| transport.cohorts.len());
        assert!(2 * few < many, "{few} of {many}");
    }

    #[test]
    fn merged_cohorts_of_weak_contacts_have_the_same_force() {
        let temperature = Some(Temperature::new(0.05, 1.0));
        let thresholds: SharedLaw = Arc::new(Gaussian::new(1.0, 0.25).unwrap());
        let weak = Contacts { thresholds, ..contacts(Rules { temperature, ..Rules::default() }) };
        with_and_without_merging(&weak, 1e-3, 2e-3, 200);
    }

    #[test]
    fn merged_cohorts_with_temperature_have_the_same_force() {
        // Contacts break over some energies, before and at their thresholds.
        for energy in [0.005, 0.1] {
            let temperature = Some(Temperature::new(energy, 1.0));
            let (ageing, warm) = (
                Some(Ageing::Logarithmic { growth: 0.05, time: 1.0 }),
                Rules { temperature, ..Rules::default() },
            );
            let ages = contacts(Rules { ageing, ..warm.clone() });
            let stiffer = Contacts { stiffness: Stiffness::PerThreshold(1.0), ..contacts(warm.clone()) };
            let identical =
                Contacts { thresholds: Arc::new(Point::new(1.0).unwrap()), ..contacts(warm.clone()) };
            for contacts in [contacts(warm), ages, stiffer, identical] {
                let [many, few] = with_and_without_merging(&contacts, 1e-3, 4e-3, 400)
                    .map(|transport| transport.cohorts.len());
                assert!(3 * few < 2 * many, "{energy}: {few} of {many}");
            }
        }
    }

    #[test]
    fn merged_cohorts_of_diffusing_thresholds_have_the_same_force() {
        let mature: SharedLaw = Arc::new(Gaussian::new(1.3, 0.1).unwrap());
        for (temperature, stiffness) in
            [(None, Stiffness::Equal(1.0)), (Some(0.02), Stiffness::PerThreshold(1.0))]
        {
            let ageing = Some(Ageing::Smoluchowski { mature: mature.clone(), diffusion: 0.02 });
            let temperature = temperature.map(|energy| Temperature::new(energy, 1.0));
            let contacts =
                Contacts { stiffness, ..contacts(Rules { ageing, temperature, ..Rules::default() }) };
            let [many, few] =
                with_and_without_merging(&contacts, 1e-3, 2e-3, 400).map(|transport| transport.cohorts.len());
            assert!(3 * few < 2 * many, "{few} of {many}");
        }
    }

    #[test]
    fn contacts_that_form_at_different_stretches_are_merged_where_age_does_not_matter() {
        let reforming: SharedLaw = Arc::new(Rectangular::new(0.0, 0.4).unwrap());
        for energy in [0.005, 0.1] {
            let rules = Rules { temperature: Some(Temperature::new(energy, 1.0)), ..Rules::default() };
            let spread = Contacts { reforming: reforming.clone(), ..contacts(rules) };
            let [whole, merged] = with_and_without_merging(&spread, 1e-3, 3e-3, 533);
            // Fewer cohorts than contacts of a single stretch leave without merging, which have as many for each seed.
            let [few, many] = [&merged, &whole].map(|transport| transport.cohorts.len());
            assert!(few * whole.seeds.len() < many, "{few} of {many}");
        }
    }
}
