//! The stretches at which distributions are evaluated.

use crate::contacts::{Ageing, Initial, Start};
use crate::law::Law;
use crate::master::MasterEquation;

/// Largest fraction of contacts above the last stretch.
const BEYOND: f64 = 1e-6;
/// Smallest and largest number of even steps up to the last stretch.
const STEPS: (f64, f64) = (400.0, 8000.0);
/// Steps per length on which a density varies.
const FINENESS: f64 = 8.0;
/// Smallest and largest number of bins of a histogram of many contacts.
const BINS: (f64, f64) = (120.0, 400.0);
/// Bins of a histogram of few contacts.
const COARSE: f64 = 20.0;

/// Stretches from 0 to where hardly any contact is attached, fine enough to resolve every density.
#[derive(Debug)]
pub struct Grid {
    /// In ascending order. Each possible jump of a density lies between two neighbouring numbers of the list.
    pub stretches: Vec<f64>,
    top: f64,
    resolution: f64,
}

impl Grid {
    /// Stretches for the distributions at X = `snapshots` and in steady sliding. The lives of time-dependent contacts set
    /// the range, because thresholds that change with age may exceed those of fresh contacts.
    pub fn new(equation: &MasterEquation, initial: &Initial, snapshots: &[f64]) -> Self {
        let contacts = equation.contacts();
        let (thresholds, reforming) = (contacts.thresholds.as_ref(), contacts.reforming.as_ref());
        let mut laws = vec![thresholds, reforming];
        if initial.start == Start::Conditional {
            laws.push(initial.law.as_ref());
        }
        let farthest = |law: &dyn Law| law.upper_quantile(BEYOND);
        let reach = if contacts.rules.are_time_dependent() {
            let first = farthest(initial.law.as_ref()) + equation.first_life().longest(BEYOND);
            first.max(farthest(reforming) + equation.life().longest(BEYOND))
        } else {
            laws.iter().map(|&law| farthest(law)).fold(0.0, f64::max).min(thresholds.quantile(1.0))
        };
        let top = 1.05 * reach;
        // Mature thresholds may vary on a shorter length than fresh ones.
        laws.extend(contacts.rules.ageing.as_ref().and_then(Ageing::mature).map(AsRef::as_ref));
        let widths = laws.iter().flat_map(|law| law.zones()).map(|zone| zone.resolution);
        let resolution = widths.fold(top, f64::min);
        let steps = (FINENESS * top / resolution).clamp(STEPS.0, STEPS.1).ceil();
        let even = (0..=steps as usize).map(|i| top * (i as f64 / steps));
        let jumps = jumps(thresholds, reforming, initial.law.as_ref(), snapshots);
        let jumps = jumps.filter(|&x| x > 0.0 && x < top).flat_map(|x| [x.next_down(), x]);
        let mut stretches: Vec<f64> = even.chain(jumps).collect();
        stretches.sort_by(f64::total_cmp);
        stretches.dedup();
        Self { stretches, top, resolution }
    }

    /// Number of bins of histograms of `size` contacts; more contacts give more bins.
    pub fn bins(&self, size: usize) -> usize {
        let fine = (2.5 * self.top / self.resolution).clamp(BINS.0, BINS.1);
        fine.min((size as f64).sqrt()).max(COARSE) as usize
    }

    /// Edges of the bins, evenly spaced from 0 to the last stretch.
    pub fn edges(&self, size: usize) -> Vec<f64> {
        let bins = self.bins(size);
        (0..=bins).map(|i| self.top * (i as f64 / bins as f64)).collect()
    }
}

/// Stretches at which densities may jump: the breakpoints of the laws, those of the initial distribution advanced to the
/// snapshots, and those of the first generation that re-formed.
fn jumps<'a>(
    thresholds: &'a dyn Law,
    reforming: &'a dyn Law,
    initial: &'a dyn Law,
    snapshots: &'a [f64],
) -> impl Iterator<Item = f64> + 'a {
    let at = |law: &'a dyn Law| law.breakpoints().into_iter().map(|b| b.position);
    let carried = snapshots.iter().flat_map(move |x| at(initial).chain([0.0]).map(move |y| x + y));
    let left = snapshots.iter().flat_map(move |x| at(thresholds).map(move |y| x - y));
    at(thresholds).chain(at(reforming)).chain(carried).chain(left)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crate::contacts::{Contacts, Rules};
    use crate::law::{Gaussian, Point, Rectangular, SharedLaw};

    use super::*;

    fn grid(thresholds: SharedLaw, initial: SharedLaw, snapshots: &[f64]) -> Grid {
        let reforming = Arc::new(Point::new(0.0).unwrap());
        let initial = Initial { law: initial, start: Start::Conditional };
        Grid::new(&equation(Contacts::new(thresholds, reforming), &initial), &initial, snapshots)
    }

    fn equation(contacts: Contacts, initial: &Initial) -> MasterEquation {
        MasterEquation::at(contacts, initial, 1e-2).unwrap()
    }

    #[test]
    fn contacts_that_strengthen_stretch_beyond_the_fresh_thresholds() {
        let thresholds = Arc::new(Gaussian::new(0.5, 0.1).unwrap());
        let zero = Arc::new(Point::new(0.0).unwrap());
        let mature: SharedLaw = Arc::new(Gaussian::new(1.0, 0.05).unwrap());
        let rules = Rules { ageing: Some(Ageing::FrozenRank { mature, time: 1.0 }), ..Rules::default() };
        let contacts = Contacts { rules, ..Contacts::new(thresholds, zero.clone()) };
        let initial = Initial { law: zero, start: Start::Conditional };
        let top = Grid::new(&equation(contacts, &initial), &initial, &[]).top;
        // Where one mature contact in a million holds, 4.75 standard deviations up.
        assert!((top / 1.05 - (1.0 + 4.75 * 0.05)).abs() < 1e-3, "{top}");
    }

    #[test]
    fn stretches_rise_and_straddle_every_jump() {
        let thresholds = Arc::new(Rectangular::new(0.75, 1.25).unwrap());
        let initial = Arc::new(Rectangular::new(0.1, 0.2).unwrap());
        let stretches = grid(thresholds, initial, &[0.5]).stretches;
        assert!(stretches.is_sorted_by(|a, b| a < b));
        for jump in [0.75, 1.25, 0.1 + 0.5, 0.2 + 0.5, 0.5] {
            assert!(stretches.contains(&jump) && stretches.contains(&jump.next_down()), "{jump}");
        }
        assert!(*stretches.last().unwrap() > 1.25);
    }

    #[test]
    fn narrow_laws_are_resolved() {
        let narrow = Arc::new(Gaussian::new(1.0, 0.005).unwrap());
        let stretches = grid(narrow, Arc::new(Point::new(0.0).unwrap()), &[]).stretches;
        assert!(stretches.windows(2).all(|pair| pair[1] - pair[0] < 0.001));
        assert!(stretches.len() < 10_000);
    }
}
