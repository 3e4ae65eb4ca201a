//! The stretches at which distributions are given.

use asperity::contacts::{Contacts, Initial, Start};
use asperity::law::Law;

/// Share of contacts that may lie above the last stretch.
const BEYOND: f64 = 1e-6;
/// Fewest and most even steps up to the last stretch.
const STEPS: (f64, f64) = (400.0, 8000.0);
/// Steps per length over which a density varies.
const FINENESS: f64 = 8.0;
/// Fewest and most bins of a histogram of many contacts.
const BINS: (f64, f64) = (120.0, 400.0);
/// Bins of a histogram of few contacts.
const COARSE: f64 = 20.0;

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

    /// Number of bins of histograms of `size` contacts: fine where many are counted.
    pub fn bins(&self, size: usize) -> usize {
        let fine = (2.5 * self.top / self.resolution).clamp(BINS.0, BINS.1);
        fine.min((size as f64).sqrt()).max(COARSE) as usize
    }

    /// Edges of the bins, even from 0 up to the last stretch.
    pub fn edges(&self, size: usize) -> Vec<f64> {
        let bins = self.bins(size);
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

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use asperity::law::{Gaussian, Point, Rectangular, SharedLaw};

    use super::*;

    fn grid(thresholds: SharedLaw, initial: SharedLaw, snapshots: &[f64]) -> Grid {
        let reforming = Arc::new(Point::new(0.0).unwrap());
        let contacts = Contacts::new(thresholds, reforming);
        Grid::new(&contacts, &Initial { law: initial, start: Start::Conditional }, snapshots)
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
