//! The distribution of the drives at which contacts break for the first time, as measured on coupled
//! contacts.

use crate::law::Law;

/// The fraction of contacts that have broken at least once, against the drive. For uncoupled contacts that
/// start relaxed it is the distribution function of their thresholds; for coupled ones that of the
/// renormalised thresholds.
///
/// Piecewise linear between points (drive, fraction), vertical where contacts break at one drive.
///
/// ```
/// use asperity::first_breaks::FirstBreaks;
///
/// let breaks = FirstBreaks::of_contacts(&[0.9, 1.1, 1.0, 1.2]);
/// assert_eq!((breaks.fraction(0.5), breaks.fraction(1.05), breaks.fraction(2.0)), (0.0, 0.5, 1.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FirstBreaks {
    points: Vec<(f64, f64)>,
}

/// The fraction of broken contacts in cells j of many contacts with thresholds s_j x_s: the mean of the
/// distribution function at X_j/s_j, for cells with the largest displacement X_j and contacts that started
/// relaxed.
pub fn broken(thresholds: &dyn Law, advances: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = advances.len() as f64;
    advances.map(|advance| thresholds.cumulative(advance)).sum::<f64>() / count
}

impl FirstBreaks {
    /// For contacts that break at these drives, in any order: their empirical distribution function.
    pub fn of_contacts(drives: &[f64]) -> Self {
        let mut sorted = drives.to_vec();
        sorted.sort_by(f64::total_cmp);
        let fraction = |count: usize| count as f64 / sorted.len() as f64;
        let step =
            |(before, &drive): (usize, &f64)| [(drive, fraction(before)), (drive, fraction(before + 1))];
        Self { points: sorted.iter().enumerate().flat_map(step).collect() }
    }

    /// From fractions broken at rising drives, such as those of cells ([`broken`]); linear in between.
    pub fn of_fractions(points: Vec<(f64, f64)>) -> Self {
        Self { points }
    }

    /// The mean of several runs with the same number of contacts.
    pub fn together(runs: &[Self]) -> Self {
        let mut drives: Vec<f64> =
            runs.iter().flat_map(|run| run.points.iter().map(|point| point.0)).collect();
        drives.sort_by(f64::total_cmp);
        drives.dedup();
        let mean = |fraction: fn(&Self, f64) -> f64, drive: f64| {
            runs.iter().map(|run| fraction(run, drive)).sum::<f64>() / runs.len() as f64
        };
        let step =
            |drive: f64| [(drive, mean(Self::fraction_below, drive)), (drive, mean(Self::fraction, drive))];
        Self { points: drives.into_iter().flat_map(step).collect() }
    }

    /// The fraction of contacts that have broken up to a drive.
    pub fn fraction(&self, drive: f64) -> f64 {
        self.before(self.points.partition_point(|point| point.0 <= drive), drive)
    }

    /// The fraction before the breaks at the drive itself.
    fn fraction_below(&self, drive: f64) -> f64 {
        self.before(self.points.partition_point(|point| point.0 < drive), drive)
    }

    /// The fraction at a drive on the line to a point from the one before.
    fn before(&self, after: usize, drive: f64) -> f64 {
        let Some(&(low, below)) = after.checked_sub(1).map(|i| &self.points[i]) else { return 0.0 };
        let Some(&(high, above)) = self.points.get(after) else { return below };
        below + (above - below) * ((drive - low) / (high - low))
    }

    /// The mean drive of broken contacts.
    pub fn mean(&self) -> f64 {
        self.average(|low, high| 0.5 * (low + high))
    }

    /// The standard deviation for broken contacts.
    pub fn std(&self) -> f64 {
        let mean = self.mean();
        // Breaks are uniform on each piece, with the variance (high − low)²/12 about its middle.
        self.average(|low, high| (0.5 * (low + high) - mean).powi(2) + (high - low).powi(2) / 12.0).sqrt()
    }

    /// The mean over breaks of a function given by its mean over intervals of the drive.
    fn average(&self, over: impl Fn(f64, f64) -> f64) -> f64 {
        let parts = self.points.windows(2).map(|pair| (pair[1].1 - pair[0].1, over(pair[0].0, pair[1].0)));
        let (whole, sum) = parts
            .fold((0.0, 0.0), |(whole, sum), (fraction, value)| (whole + fraction, sum + fraction * value));
        sum / whole
    }

    /// Kolmogorov–Smirnov distance from a distribution.
    pub fn distance(&self, law: &dyn Law) -> f64 {
        self.points
            .iter()
            .map(|&(drive, fraction)| (fraction - law.cumulative(drive)).abs())
            .fold(0.0, f64::max)
    }

    /// The drives below and above which at most the fraction `tail` breaks.
    pub fn range(&self, tail: f64) -> (f64, f64) {
        let at = |fraction: f64| {
            let after = self.points.partition_point(|point| point.1 <= fraction);
            self.points.get(after).or(self.points.last()).map_or(f64::NAN, |point| point.0)
        };
        (at(tail), at(1.0 - tail))
    }

    /// The mean density between neighbouring edges, which rise.
    pub fn densities(&self, edges: &[f64]) -> Vec<f64> {
        let density = |pair: &[f64]| (self.fraction(pair[1]) - self.fraction(pair[0])) / (pair[1] - pair[0]);
        edges.windows(2).map(density).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Exponential, Rectangular};

    #[test]
    fn contacts_make_steps() {
        let breaks = FirstBreaks::of_contacts(&[3.0, 1.0, 1.0, 2.0]);
        assert_eq!([0.9, 1.0, 1.5, 2.0, 4.0].map(|x| breaks.fraction(x)), [0.0, 0.5, 0.5, 0.75, 1.0]);
        assert_eq!((breaks.mean(), breaks.std()), (1.75, 0.6875_f64.sqrt()));
        assert_eq!(breaks.densities(&[0.0, 1.0, 3.0]), [0.5, 0.25]);
        assert_eq!(breaks.range(0.1), (1.0, 3.0));
        // Uniform on [0, 4]: farthest after the break at 1 and 3, by ¼.
        assert_eq!(breaks.distance(&Rectangular::new(0.0, 4.0).unwrap()), 0.25);
    }

    #[test]
    fn cells_that_move_alike_have_the_law_of_their_thresholds() {
        let law = Exponential::new(0.7).unwrap();
        let at = |i: u32| f64::from(i) * 0.01;
        let fraction = |x: f64| broken(&law, [x; 3].into_iter());
        let breaks = FirstBreaks::of_fractions((0..=2000).map(|i| (at(i), fraction(at(i)))).collect());
        // Chords of steps of 1/70 of the mean; 1e-12 has not broken.
        assert!((breaks.mean() - 0.7).abs() < 2e-5 && (breaks.std() - 0.7).abs() < 2e-5);
        assert!(breaks.distance(&law) < 1e-15);
        // One cell that is there, one that has gone half as far, one all of whose contacts have broken.
        let three = broken(&law, [1.0, 0.5, f64::INFINITY].into_iter());
        assert_eq!(three, (law.cumulative(1.0) + law.cumulative(0.5) + 1.0) / 3.0);
    }

    #[test]
    fn runs_add_up() {
        // Contacts one by one: as if they were of one run.
        let drives = [[3.0, 1.0, 1.0, 2.0], [0.5, 1.0, 2.5, 7.0]];
        let runs = drives.map(|drives| FirstBreaks::of_contacts(&drives));
        let (together, all) = (FirstBreaks::together(&runs), FirstBreaks::of_contacts(&drives.concat()));
        for x in [0.0, 0.5, 0.7, 1.0, 2.2, 2.5, 6.0, 7.0, 8.0] {
            assert_eq!(
                (together.fraction(x), together.fraction_below(x)),
                (all.fraction(x), all.fraction_below(x))
            );
        }
        assert_eq!((together.mean(), together.std()), (all.mean(), all.std()));
        // Half from 0 to 2, the rest at 2; and all from 1 to 3.
        let fractions = [vec![(0.0, 0.0), (2.0, 0.5), (2.0, 1.0)], vec![(1.0, 0.0), (3.0, 1.0)]];
        let together = FirstBreaks::together(&fractions.map(FirstBreaks::of_fractions));
        assert_eq!([0.5, 1.0, 1.5].map(|x| together.fraction(x)), [0.0625, 0.125, 0.3125]);
        assert_eq!(
            [together.fraction_below(2.0), together.fraction(2.0), together.fraction(2.5)],
            [0.5, 0.75, 0.875]
        );
        assert_eq!(together.mean(), 0.5 * (0.5 * 1.0 + 0.5 * 2.0) + 0.5 * 2.0);
    }
}
