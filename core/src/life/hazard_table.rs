//! The cumulative hazard of contacts formed at one stretch as a polynomial of their fresh threshold.

use super::thermal_hazard::ThermalHazard;
use crate::contacts::NodalLabels;
use crate::numerics::exponential::exp;
use crate::numerics::legendre::{CUMULATIVE, NODES, Nodal, RULE, polynomials, series, series_at};
use crate::numerics::piecewise::tail;
use crate::numerics::wide::vectorised;

/// The cumulative hazard A of contacts with fresh thresholds in an interval, as J = A v/w in units of length.
///
/// A grows as steeply as e^{−ΔE/T}; J is the length for which contacts have broken at the present rate, and varies little with
/// the threshold: dJ/du = 1 + J d(ΔE/T)/du. It is a Legendre series in h_0 and in u on each of its cells.
#[derive(Debug)]
pub(super) struct HazardTable {
    interval: FreshInterval,
    /// Ends of the cells in u.
    boundaries: Vec<f64>,
    /// For each cell the coefficients `[n][m]` of P_n(u) P_m(h_0).
    cells: Vec<[Nodal; NODES]>,
}

/// An interval of fresh thresholds.
#[derive(Debug, Clone, Copy)]
struct FreshInterval {
    middle: f64,
    half: f64,
}

/// J at an advance as a Legendre series in h_0, or nothing where no contact of the interval is left.
#[derive(Debug, Clone, Copy)]
pub(super) struct HazardSeries {
    interval: FreshInterval,
    coefficients: Option<Nodal>,
}

/// Contacts of sixteen fresh thresholds, for the advance up to which a table has come.
struct HazardMarch<'a> {
    thermal: &'a ThermalHazard,
    start: f64,
    labels: &'a NodalLabels,
    /// The highest fresh threshold.
    highest: f64,
    /// The exponents, and J.
    exponents: Nodal,
    lengths: Nodal,
}

/// Exponents may differ by this much on a cell, and their middle from their mean by `BENT`.
const ONE_CELL: f64 = 4.0;
const BENT: f64 = 0.5;

impl HazardTable {
    /// The table for contacts formed at `start` with fresh thresholds between `ends`, `labels` those at the Gauss points; `None`
    /// if polynomials of degree 15 in h_0 do not represent them.
    pub(super) fn new(
        thermal: &ThermalHazard,
        start: f64,
        ends: [f64; 2],
        labels: &NodalLabels,
    ) -> Option<Self> {
        /// More cells than any advance needs whose hazards can be told from 0.
        const MOST_CELLS: usize = 400;
        let interval = FreshInterval { middle: 0.5 * (ends[0] + ends[1]), half: 0.5 * (ends[1] - ends[0]) };
        let mut table = Self { interval, boundaries: vec![0.0], cells: Vec::new() };
        let exponents = thermal.exponents(start, 0.0, labels);
        let mut march =
            HazardMarch { thermal, start, labels, highest: ends[1], exponents, lengths: [0.0; NODES] };
        let mut at = 0.0;
        while !march.is_over(at) {
            if table.cells.len() == MOST_CELLS {
                return None;
            }
            let to = march.next(at);
            table.cells.push(vectorised(
                #[inline(always)]
                || march.cell(at, to),
            )?);
            table.boundaries.push(to);
            at = to;
        }
        Some(table)
    }

    /// The series at an advance.
    pub(super) fn at(&self, advance: f64) -> HazardSeries {
        let interval = self.interval;
        // Just before formation the first cell is continued.
        let above = self.boundaries.partition_point(|&end| end <= advance).max(1);
        let Some(cell) = self.cells.get(above - 1) else {
            return HazardSeries { interval, coefficients: None };
        };
        let [low, high] = [self.boundaries[above - 1], self.boundaries[above]];
        let weights = polynomials((2.0 * advance - (low + high)) / (high - low));
        let contracted = vectorised(
            #[inline(always)]
            || contracted(&weights, cell),
        );
        HazardSeries { interval, coefficients: Some(contracted) }
    }

    /// How many numbers it consists of.
    pub(super) fn size(&self) -> usize {
        NODES * NODES * self.cells.len()
    }
}

impl HazardSeries {
    /// The cumulative hazard of contacts that nothing survives.
    const GONE: f64 = 1e4;

    /// A of contacts with this fresh threshold and the hazard w/v.
    pub(super) fn broken(&self, fresh: f64, rate: f64) -> f64 {
        let place = (fresh - self.interval.middle) / self.interval.half;
        self.coefficients.map_or(Self::GONE, |coefficients| rate * series(&coefficients, place))
    }

    /// The same for sixteen fresh thresholds.
    #[inline(always)]
    pub(super) fn broken_of(&self, fresh: &Nodal, rates: &Nodal) -> Nodal {
        let Some(coefficients) = self.coefficients else { return [Self::GONE; NODES] };
        let mut places = *fresh;
        places.iter_mut().for_each(|h| *h = (*h - self.interval.middle) / self.interval.half);
        let mut broken = series_at(&coefficients, &places);
        broken.iter_mut().zip(rates).for_each(|(length, rate)| *length *= rate);
        broken
    }
}

impl HazardMarch<'_> {
    /// Whether all contacts have broken, those with the highest threshold included.
    fn is_over(&self, at: f64) -> bool {
        /// Above this cumulative hazard nothing survives, also at the upper end of the interval.
        const GONE: f64 = 1400.0;
        let reached = || self.thermal.has_reached(self.start, at, self.highest);
        let broken =
            |(length, exponent): (&f64, &f64)| self.thermal.attempts() * (-exponent).exp() * length > GONE;
        self.lengths.iter().zip(&self.exponents).all(broken) || reached()
    }

    /// The end of a cell from an advance on.
    fn next(&self, at: f64) -> f64 {
        /// Sixteen terms represent ln(u + s) to 1e-14 on cells of this width, in distances u + s to its singularity.
        const NARROW: f64 = 0.75;
        // In the first cell the hazard is of order 1 at most, and from there on cells grow with the advance.
        let least = self.exponents.iter().copied().fold(f64::INFINITY, f64::min);
        let first = least.min(700.0).exp() / self.thermal.attempts();
        let widest = NARROW * (at + self.thermal.time_scale());
        let mut width = widest.min(first.max(2.0 * at)).min(self.highest);
        let exponents = |u: f64| self.thermal.exponents(self.start, u, self.labels);
        loop {
            let [middle, end] = [0.5 * width, width].map(|width| exponents(at + width));
            let negligible = |exponents: &Nodal| exponents.iter().all(|&e| e > self.most());
            let even = || {
                let of = |i: usize| [self.exponents[i], middle[i], end[i]];
                (0..NODES).all(|i| is_even(of(i)))
            };
            if self.is_unbroken() && [&self.exponents, &middle, &end].into_iter().all(negligible) || even() {
                return at + width;
            }
            width *= 0.5;
        }
    }

    /// Exponents above this break a fraction of 1e-18 over an advance as long as thresholds.
    fn most(&self) -> f64 {
        (1e18 * self.thermal.attempts() * self.highest).ln()
    }

    fn is_unbroken(&self) -> bool {
        self.lengths.iter().all(|&length| length == 0.0)
    }

    /// The coefficients of a cell, at whose end the march then is; `None` if they do not represent J.
    #[inline(always)]
    fn cell(&mut self, low: f64, high: f64) -> Option<[Nodal; NODES]> {
        /// Tolerance of A as a fraction of A, or of `FEW` where A is smaller.
        const FRACTION: f64 = 1e-13;
        const FEW: f64 = 1e-3;
        /// A length beyond the range of numbers, before rates fall by as much.
        const MOST: f64 = 1e280;
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let exponents = |u: f64| self.thermal.exponents(self.start, u, self.labels);
        let end = exponents(high);
        let most = self.most();
        if self.is_unbroken() && self.exponents.iter().chain(&end).all(|&exponent| exponent > most) {
            self.exponents = end;
            return Some([[0.0; NODES]; NODES]);
        }
        // e^{E(a) − E(u)} at the Gauss points u, a the lower end of the cell.
        let mut factors = [[0.0; NODES]; NODES];
        let mut largest = 0.0_f64;
        for i in 0..NODES {
            let here = exponents(middle + half * RULE.nodes[i]);
            for j in 0..NODES {
                factors[i][j] = exp(self.exponents[j] - here[j]);
            }
            largest = here.iter().fold(largest, |largest, e| largest.max(e.abs()));
        }
        let tolerance = FRACTION.max(self.thermal.roughness() * largest);
        let attempts = self.thermal.attempts();
        let mut rates = [0.0; NODES];
        for j in 0..NODES {
            rates[j] = attempts * exp(-self.exponents[j]);
        }
        let mut in_thresholds = [[0.0; NODES]; NODES];
        for i in 0..NODES {
            let lengths = self.lengths_at(&CUMULATIVE[i], half, &factors, &factors[i]);
            let coefficients = RULE.coefficients(&lengths);
            let mut smallest = f64::INFINITY;
            for j in 0..NODES {
                // ΔE/T at the Gauss point is that at the lower end less the logarithm of the factor.
                smallest = smallest.min(lengths[j].max(FEW / (rates[j] * factors[i][j])));
            }
            let is_resolved = tail(&coefficients) <= tolerance * smallest;
            if !is_resolved || lengths.iter().any(|&length| length > MOST) {
                return None;
            }
            in_thresholds[i] = coefficients;
        }
        let mut at_end = [0.0; NODES];
        for j in 0..NODES {
            at_end[j] = exp(self.exponents[j] - end[j]);
        }
        self.lengths = self.lengths_at(&RULE.weights, half, &factors, &at_end);
        self.exponents = end;
        Some(RULE.coefficients_of_rows(&in_thresholds))
    }

    /// J where the factors are `here`, from those at the Gauss points and the `weights` of their integral up to there.
    #[inline(always)]
    fn lengths_at(&self, weights: &Nodal, half: f64, factors: &[Nodal; NODES], here: &Nodal) -> Nodal {
        let mut sum = [0.0; NODES];
        for k in 0..NODES {
            for j in 0..NODES {
                sum[j] += weights[k] * factors[k][j];
            }
        }
        for j in 0..NODES {
            sum[j] = (self.lengths[j] + half * sum[j]) / here[j];
        }
        sum
    }
}

/// Whether E, given at both ends and in the middle of an interval, is nearly linear and changes little.
fn is_even([a, middle, b]: [f64; 3]) -> bool {
    (a - b).abs() < ONE_CELL && (middle - 0.5 * (a + b)).abs() < BENT
}

/// Σ_n `weights[n]` `rows[n]`.
#[inline(always)]
fn contracted(weights: &Nodal, rows: &[Nodal; NODES]) -> Nodal {
    let mut sum = [0.0; NODES];
    for n in 0..NODES {
        for m in 0..NODES {
            sum[m] += weights[n] * rows[n][m];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::contacts::{Ageing, Barrier, Contacts, Temperature, ThresholdEvolution};
    use crate::law::{Gaussian, Point, SharedLaw};

    /// (1/v) ∫₀ᵘ w du' by Simpson's rule.
    fn simpson(rate: impl Fn(f64) -> f64, advance: f64) -> f64 {
        let steps = 10_000;
        let term = |k: u32| {
            let weight = if k == 0 || k == steps { 1.0 } else { 2.0 + 2.0 * f64::from(k % 2) };
            weight * rate(advance * f64::from(k) / f64::from(steps))
        };
        (0..=steps).map(term).sum::<f64>() * advance / (3.0 * f64::from(steps))
    }

    #[test]
    fn series_are_the_integrals_of_the_hazard() {
        let gaussian = |mean, std| -> SharedLaw { Arc::new(Gaussian::new(mean, std).unwrap()) };
        let ages = [
            Ageing::Logarithmic { growth: 0.05, time: 1.0 },
            Ageing::Logarithmic { growth: 0.3, time: 0.5 },
            Ageing::FrozenRank { mature: gaussian(1.3, 0.15), time: 1.0 },
        ];
        let (ends, mut compared) = ([0.97, 1.03], 0);
        for (ageing, barrier) in ages.iter().flat_map(|a| [Barrier::Elastic, Barrier::Bell].map(|b| (a, b))) {
            for (start, velocity) in [(0.0, 1.0), (0.3, 0.2), (0.1, 10.0)] {
                let temperature = Temperature { barrier, ..Temperature::new(0.03, 2.0) };
                let mut contacts = Contacts::new(gaussian(1.0, 0.1), Arc::new(Point::new(0.0).unwrap()));
                contacts.rules.ageing = Some(ageing.clone());
                let evolution = ThresholdEvolution::of(&contacts).unwrap();
                let thermal = ThermalHazard::new(&contacts, temperature, evolution.clone(), velocity);
                let labels = evolution.labels(RULE.nodes.map(|t| 1.0 + 0.03 * t), true);
                let table = HazardTable::new(&thermal, start, ends, &labels).unwrap();
                for fresh in [0.97, 0.991, 1.03] {
                    let threshold = |u: f64| evolution.threshold(fresh, u / velocity);
                    let rate = |u: f64| temperature.rate(start + u, threshold(u), 1.0) / velocity;
                    let holds = |u: &f64| start + u < threshold(*u);
                    for advance in (1..40).map(|k| 0.04 * f64::from(k)).take_while(holds) {
                        let exact = simpson(rate, advance);
                        let found = table.at(advance).broken(fresh, rate(advance));
                        // Simpson's rule leaves out (step × slope of ΔE/T)⁴/180: 2e-11 at a slope of 50.
                        let error = (found - exact).abs() / exact.max(1e-3);
                        assert!(
                            error < 1e-10,
                            "{ageing:?} {barrier:?} {velocity} {fresh} {advance}: {error:e}"
                        );
                        compared += 1;
                    }
                }
            }
        }
        assert!(compared > 500, "{compared}");
    }
}
