//! The stretches at which distributions are given.

use asperity::contacts::{Contacts, Initial, Start};
use asperity::law::Law;
use asperity::scenario::Scenario;

/// Share of contacts that may lie above the last stretch.
const BEYOND: f64 = 1e-6;
/// Fewest and most even steps up to the last stretch.
const STEPS: (f64, f64) = (400.0, 8000.0);
/// Steps per length over which a density varies.
const FINENESS: f64 = 8.0;
/// Fewest and most bins of a histogram.
const BINS: (f64, f64) = (20.0, 400.0);

/// Stretches up to where hardly any contact holds, close enough to show every density.
#[derive(Debug)]
pub struct Grid {
    /// Rising; where a density may jump there are two neighbours, one on either side.
    pub stretches: Vec<f64>,
    top: f64,
    resolution: f64,
}

impl Grid {
    /// Stretches for the distributions of these contacts at X = `snapshots` and in steady sliding.
    pub fn new(contacts: &Contacts, initial: &Initial, snapshots: &[f64]) -> Self {
        let (thresholds, reforming) = (contacts.thresholds.as_ref(), contacts.reforming.as_ref());
        let mut laws = vec![thresholds, reforming];
        if initial.start == Start::Conditional {
            laws.push(initial.law.as_ref());
        }
        let reach = laws.iter().map(|law| law.upper_quantile(BEYOND)).fold(0.0, f64::max);
        let top = 1.05 * reach.min(thresholds.quantile(1.0));
        let widths = laws.iter().map(|law| law.resolution()).filter(|&width| width > 0.0);
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

    /// Number of bins of histograms: fine where many contacts are counted.
    pub fn bins(&self, scenario: &Scenario) -> usize {
        let size = scenario.ensemble.as_ref().map_or(0.0, |ensemble| ensemble.size as f64);
        let fine = (2.5 * self.top / self.resolution).clamp(2.0 * BINS.0, BINS.1);
        fine.min(size.sqrt()).max(BINS.0) as usize
    }

    /// Edges of the bins, even from 0 up to the last stretch.
    pub fn edges(&self, scenario: &Scenario) -> Vec<f64> {
        let bins = self.bins(scenario);
        (0..=bins).map(|i| self.top * (i as f64 / bins as f64)).collect()
    }
}

/// Where densities may jump: with the laws themselves, with the start carried along, and with what
/// the first contacts left behind when they broke.
fn jumps<'a>(
    thresholds: &'a dyn Law,
    reforming: &'a dyn Law,
    initial: &'a dyn Law,
    snapshots: &'a [f64],
) -> impl Iterator<Item = f64> + 'a {
    let at = |law: &'a dyn Law| law.breaks().into_iter().map(|b| b.position);
    let carried = snapshots.iter().flat_map(move |x| at(initial).chain([0.0]).map(move |y| x + y));
    let left = snapshots.iter().flat_map(move |x| at(thresholds).map(move |y| x - y));
    at(thresholds).chain(at(reforming)).chain(carried).chain(left)
}
