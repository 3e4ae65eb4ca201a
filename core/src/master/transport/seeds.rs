//! Quadrature of a distribution of starting stretches: cells that each represent a fraction of the contacts.

use super::panels::panels;
use crate::law::{Atom, Law};
use crate::numerics::gauss;
use crate::rate_dependent::StretchInterval;

/// Contacts that start together: a fraction at one stretch, spread evenly over a cell around it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seed {
    pub(super) stretch: f64,
    pub(super) weight: f64,
    /// Extent of the cell below the stretch.
    pub(super) below: f64,
    /// Extent of the cell above the stretch; both are 0 for a point mass.
    pub(super) above: f64,
    /// Its index among the seeds of contacts that re-form.
    pub(super) number: Option<u32>,
}

/// Fractions below this are dropped.
const NEGLIGIBLE: f64 = 1e-14;

/// The seeds of a distribution below `top`, on panels no wider than `widest` that end at the `cuts`, each weighted by `held` at its
/// stretch: so many that they show the density.
///
/// Cells of a panel end at the partial sums of the Gauss weights, between which the nodes lie (P. L.
/// Chebyshev, A. A. Markov and T. J. Stieltjes).
pub(super) fn seeds(
    law: &dyn Law,
    top: f64,
    (widest, cuts): (f64, &[f64]),
    held: impl Fn(f64) -> f64,
) -> Vec<Seed> {
    let point_mass =
        |a: Atom| Seed { stretch: a.position, weight: a.weight, below: 0.0, above: 0.0, number: None };
    let mut seeds: Vec<Seed> = law.atoms().into_iter().map(point_mass).collect();
    for panel in panels(law, widest).into_iter().flat_map(|panel| panel.cut(cuts)) {
        let mut edge = panel.low;
        for (stretch, width) in panel.points() {
            let (below, above) = (stretch - edge, edge + width - stretch);
            seeds.push(Seed { stretch, weight: width * law.density(stretch), below, above, number: None });
            edge += width;
        }
    }
    seeds.retain(|seed| seed.stretch < top && seed.weight > NEGLIGIBLE);
    let whole: f64 = seeds.iter().map(|seed| seed.weight).sum();
    seeds.iter_mut().for_each(|seed| seed.weight *= held(seed.stretch) / whole);
    seeds.retain(|seed| seed.weight > 0.0);
    seeds
}

/// The fewest seeds of a distribution below `top` that integrate functions varying over `length` to `error`,
/// none of them representing an interval longer than `widest`.
///
/// They are the nodes of Gauss rules for the distribution itself, one rule on each such interval. Their cells
/// end where the distribution function equals the partial sums of the weights, between which the nodes lie;
/// the outer cells extend as far outward as inward. Each seed comes with the cells of the distribution that
/// it represents, relative to its stretch, as fractions of it.
pub(super) fn fewest(
    law: &dyn Law,
    top: f64,
    widest: f64,
    length: f64,
    error: f64,
) -> Vec<(Seed, Vec<StretchInterval>)> {
    let fine = seeds(law, top, (widest, &[]), |_| 1.0);
    let (points, spread): (Vec<Seed>, Vec<Seed>) =
        fine.into_iter().partition(|seed| seed.below + seed.above == 0.0);
    let mut seeds: Vec<_> = points.into_iter().map(|seed| (seed, Vec::new())).collect();
    let mut rest = &spread[..];
    while let Some(first) = rest.first() {
        let end = first.stretch - first.below + widest;
        let count = rest.partition_point(|seed| seed.stretch + seed.above <= end).max(1);
        seeds.extend(merged(&rest[..count], length, error));
        rest = &rest[count..];
    }
    seeds
}

/// Neighbouring seeds merged into the fewest that integrate functions varying over `length` to `error`.
fn merged(fine: &[Seed], length: f64, error: f64) -> Vec<(Seed, Vec<StretchInterval>)> {
    let points: Vec<_> = fine.iter().map(|seed| (seed.stretch, seed.weight)).collect();
    // A Gauss rule for the distribution itself integrates polynomials of twice its number of nodes
    // exactly, and its weights are positive: no other choice of as many cohorts represents more
    // moments of the distribution.
    let rule = gauss::fewest(&points, length, error);
    if rule.len() == fine.len() {
        return fine.iter().map(|seed| (*seed, Vec::new())).collect();
    }
    let mut seeds: Vec<(Seed, Vec<StretchInterval>)> = Vec::new();
    let (mut low, mut sum, mut passed) = (fine[0].stretch - fine[0].below, 0.0, 0.0);
    let mut fine = fine.iter().peekable();
    for &(stretch, weight) in &rule {
        let (begun, mut cells) = (low, Vec::new());
        let mut until = |seed: &Seed, high: f64, fraction: f64| {
            let from = low.max(seed.stretch - seed.below);
            cells.push(StretchInterval {
                low: from - stretch,
                high: high - stretch,
                fraction: fraction / weight,
            });
            low = high;
        };
        let before = sum;
        sum += weight;
        while let Some(seed) = fine.next_if(|seed| passed + seed.weight <= sum) {
            until(seed, seed.stretch + seed.above, (passed + seed.weight) - passed.max(before));
            passed += seed.weight;
        }
        // The cell in which the partial sum is reached is divided in proportion.
        if let Some(seed) = fine.peek() {
            let part = (sum - passed) / seed.weight;
            until(
                seed,
                seed.stretch - seed.below + (seed.below + seed.above) * part,
                sum - passed.max(before),
            );
        }
        seeds.push((
            Seed { stretch, weight, below: stretch - begun, above: low - stretch, number: None },
            cells,
        ));
    }
    if let [(seed, _)] = &mut seeds[..] {
        // A single seed is as wide as the standard deviation requires.
        let square: f64 = points.iter().map(|(x, weight)| weight * (x - seed.stretch).powi(2)).sum();
        (seed.below, seed.above) = ((3.0 * square / seed.weight).sqrt(), (3.0 * square / seed.weight).sqrt());
    } else if let [(first, _), .., (last, _)] = &mut seeds[..] {
        first.below = first.below.min(first.above);
        last.above = last.above.min(last.below);
    }
    seeds
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::law::{Exponential, Gamma, Gaussian, Lognormal, Mixture, Point, Rectangular, SharedLaw};

    fn laws() -> Vec<SharedLaw> {
        let two: Vec<(f64, SharedLaw)> = vec![
            (0.4, Arc::new(Point::new(0.1).unwrap())),
            (0.6, Arc::new(Rectangular::new(0.2, 0.3).unwrap())),
        ];
        vec![
            Arc::new(Gaussian::new(0.2, 0.002).unwrap()),
            Arc::new(Gamma::new(0.01, 0.001).unwrap()),
            Arc::new(Exponential::new(0.3).unwrap()),
            Arc::new(Lognormal::new(0.2, 0.4).unwrap()),
            Arc::new(Mixture::new(two).unwrap()),
        ]
    }

    #[test]
    fn few_seeds_give_sums_to_the_error_and_lie_in_their_cells() {
        for law in laws() {
            for error in [1e-4, 1e-7, 1e-10] {
                let (length, widest, top) = (1.0, 4.0, f64::INFINITY);
                let few: Vec<Seed> = fewest(law.as_ref(), top, widest, length, error)
                    .into_iter()
                    .map(|(seed, _)| seed)
                    .collect();
                let all = seeds(law.as_ref(), top, (widest, &[]), |_| 1.0);
                for centre in [0.0, 0.2, 0.5, 1.0, 2.0] {
                    let sum = |seeds: &[Seed]| -> f64 {
                        let term = |s: &Seed| s.weight * (-((s.stretch - centre) / length).powi(2)).exp();
                        seeds.iter().map(term).sum()
                    };
                    let off = (sum(&few) - sum(&all)).abs();
                    // On each of some tens of stretches.
                    assert!(off <= 3.0 * error, "{} {error:e} {centre}: {off:e}", law.name());
                }
                assert!(few.iter().all(|seed| seed.below >= 0.0 && seed.above >= 0.0), "{few:?}");
                assert!(few.len() < all.len().div_ceil(4), "{}: {} of {}", law.name(), few.len(), all.len());
            }
        }
    }

    #[test]
    fn the_cells_of_few_seeds_are_those_of_the_law() {
        for law in laws() {
            let few = fewest(law.as_ref(), f64::INFINITY, 4.0, 1.0, 1e-6);
            let held = |(seed, cells): &(Seed, Vec<StretchInterval>)| -> Vec<StretchInterval> {
                let at = |cell: &StretchInterval| StretchInterval {
                    low: seed.stretch + cell.low,
                    high: seed.stretch + cell.high,
                    fraction: seed.weight * cell.fraction,
                };
                cells.iter().map(at).collect()
            };
            let cells: Vec<StretchInterval> = few.iter().flat_map(held).collect();
            assert!(cells.len() > few.len(), "{}: {}", law.name(), cells.len());
            let atoms: f64 = law.atoms().iter().map(|atom| atom.weight).sum();
            let whole: f64 = cells.iter().map(|cell| cell.fraction).sum();
            assert!((whole + atoms - 1.0).abs() < 1e-12, "{}: {whole}", law.name());
            for pair in cells.windows(2) {
                // What rounding of stretches lets overlap; parts of a mixture have a gap between them.
                assert!(pair[1].low - pair[0].high > -1e-14, "{}: {pair:?}", law.name());
            }
            for cell in &cells {
                let inside = law.survival(cell.low) - law.survival(cell.high);
                // Cells end at partial sums of Gauss weights: between a point and the next the law may lie on either side.
                let neighbours = law.survival(cell.low - 2.0 * (cell.high - cell.low))
                    - law.survival(cell.high + 2.0 * (cell.high - cell.low));
                assert!(
                    cell.fraction >= 0.0 && cell.fraction <= neighbours + 1e-13,
                    "{} {cell:?} {inside}",
                    law.name()
                );
            }
        }
    }

    #[test]
    fn no_few_seed_stands_for_more_than_is_widest() {
        let law = Gaussian::new(1.0, 0.2).unwrap();
        let few: Vec<Seed> = fewest(&law, 1.5, 0.05, 0.1, 1e-3).into_iter().map(|(seed, _)| seed).collect();
        // The widest that is asked for, 0.05, and its rounding.
        assert!(few.iter().all(|seed| seed.below + seed.above <= 0.05 * (1.0 + 1e-12)), "{few:?}");
        let whole: f64 = few.iter().map(|seed| seed.weight).sum();
        assert!((whole - 1.0).abs() < 1e-14 && few.iter().all(|seed| seed.stretch < 1.5));
    }
}
