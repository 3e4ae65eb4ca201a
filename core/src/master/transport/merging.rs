//! Merging of cohorts under error control.
//!
//! Each step adds cohorts, and an interface makes far more steps than the contacts of one cell need. Two cohorts of attached
//! fractions a and b that break at a distance Δ from each other become one at their centre. To second order the number of
//! breaks and the force then change by ab/(a + b) Δ²/2 times the change of the density of thresholds per length, at most
//! 0.24/σ² for a Gaussian, and with both signs in the life of a contact, so that changes of successive cohorts cancel.
//! The sum of ab/(a + b) Δ² of all that has been merged, the *spread* of a cohort, is limited.

use std::sync::Arc;

use super::Transport;
use super::step_control::scale;
use crate::contacts::Contacts;

/// Largest spread of a cohort, in units of the tolerance times the square of the length on which lives vary.
const SPREAD: f64 = 0.02;

/// Largest spread of a cohort, fraction × length².
pub(super) fn largest_spread(contacts: &Contacts, tolerance: f64) -> f64 {
    SPREAD * tolerance * scale(contacts).powi(2)
}

impl Transport {
    /// Merges cohorts that formed at the same seed one after the other, as far as the tolerance allows.
    pub(super) fn merge_cohorts(&mut self) {
        let Self { cohorts, seeds, model, spent, spread, .. } = self;
        let cohorts = Arc::make_mut(cohorts);
        // The last cohort of each seed that stays.
        let mut last: Vec<Option<usize>> = vec![None; seeds.len()];
        let mut kept = 0;
        for next in 0..cohorts.len() {
            let seed = cohorts[next].seed().map(|seed| seed as usize);
            if let Some(before) = seed.and_then(|seed| last[seed]) {
                let (stay, come) = cohorts.split_at_mut(next);
                if let Some(lost) = stay[before].absorb(&come[0], model, *spread) {
                    spent.lost += lost;
                    continue;
                }
            }
            if let Some(seed) = seed {
                last[seed] = Some(kept);
            }
            cohorts.swap(kept, next);
            kept += 1;
        }
        cohorts.truncate(kept);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contacts::{Ageing, Initial, Rules, Start};
    use crate::law::{Gaussian, Point};

    #[test]
    fn merged_cohorts_have_the_same_force() {
        let relaxed = Arc::new(Point::new(0.0).unwrap());
        let ageing = Some(Ageing::Logarithmic { growth: 0.05, time: 1.0 });
        let rules = Rules { ageing, ..Rules::default() };
        let law = Arc::new(Gaussian::new(1.0, 0.1).unwrap());
        let contacts = Contacts { rules, ..Contacts::new(law, relaxed.clone()) };
        let start = Initial { law: relaxed, start: Start::Conditional };
        let tolerance = 1e-3;
        let mut whole = Transport::new_with(contacts.clone(), &start, tolerance, &mut ()).unwrap();
        whole.rough = None;
        let mut merged = whole.clone();
        // Steps far shorter than contacts need; every fifth is ten times as slow.
        for number in 0..2000 {
            let during = if number % 5 == 0 { 1.0 } else { 0.1 };
            whole.step(2e-3, during, &mut ()).unwrap();
            merged.step(2e-3, during, &mut ()).unwrap();
            let before = merged.force();
            merged.merge_cohorts();
            assert!((merged.force() - before).abs() < 1e-13);
            // The unit of force is N_c⟨k⟩ times the mean threshold, 1.
            let off = merged.force() - whole.force();
            assert!(off.abs() < tolerance, "{tolerance} {number}: {off:e}");
        }
        let [few, many] = [&merged, &whole].map(|transport| transport.cohorts.len());
        assert!(4 * few < many, "{tolerance}: {few} of {many}");
        // Both lose the same energy but for the differences of stretch that merging removes: spreads over the square of
        // the width, a fiftieth of the tolerance each, times the square of the width and ½, in each of some hundred cohorts.
        let lost = merged.energies().lost - whole.energies().lost;
        assert!(lost.abs() < tolerance, "{lost:e}");
    }
}
