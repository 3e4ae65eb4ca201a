//! Maximum-likelihood fits of power laws p(x) ∝ x^{−τ} within a given window, whatever the cut-off outside of
//! it. To fit the cut-off see [`super::cutoff`].
//!
//! After A. Clauset, C. R. Shalizi and M. E. J. Newman, *Power-law distributions in empirical data*, SIAM
//! Rev. 51, 661 (2009), doi:10.1137/070710111: at the maximum of the likelihood the mean of ln x is that of
//! the data.

use super::legendre::RULE;
use super::roots::brent_root;

/// Exponents are searched for in [−30, 30].
const STEEPEST: f64 = 30.0;

/// Terms of a sum over integers before the rest is replaced by an integral.
const TERMS: f64 = 1000.0;

/// A fitted power law.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct PowerLawFit {
    /// Exponent τ of p(x) ∝ x^{−τ}.
    pub exponent: f64,
    /// Standard error of τ for independent data, 1/√(n Var ln x); too small for correlated data.
    pub error: f64,
    /// Number n of data in the window.
    pub count: u64,
    /// Kolmogorov–Smirnov distance between data and fit.
    pub distance: f64,
}

/// Fits integers, given as (number, count) by rising number. `None` if the window contains fewer than two
/// different numbers. Sums over the distribution are right to 1e-7.
pub fn fit_counts(counts: &[(u64, u64)], low: u64, high: u64) -> Option<PowerLawFit> {
    let low = low.max(1);
    let inside = counts.iter().filter(|count| (low..=high).contains(&count.0));
    let inside: Vec<_> = inside.map(|&(number, times)| (number as f64, times)).collect();
    let window = Window { low: low as f64, below: low as f64 - 1.0, high: high as f64, moments: whole };
    window.fit(&inside)
}

/// Fits positive real numbers. `None` if the window contains fewer than two different numbers.
pub fn fit_values(values: &[f64], low: f64, high: f64) -> Option<PowerLawFit> {
    let inside = values.iter().copied().filter(|&x| x > 0.0 && (low..=high).contains(&x));
    let mut inside: Vec<f64> = inside.collect();
    inside.sort_by(f64::total_cmp);
    let counts: Vec<_> = inside.chunk_by(|a, b| a == b).map(|run| (run[0], run.len() as u64)).collect();
    Window { low, below: low, high, moments: real }.fit(&counts)
}

/// The support of the distribution: above `below`, up to `high`.
struct Window {
    low: f64,
    below: f64,
    high: f64,
    /// ∑ or ∫ of y^{−τ} lnⁿ y, y = x/low, n = 0, 1, 2, over a < x ≤ b, as a function of τ, low, a, b.
    moments: fn(f64, f64, f64, f64) -> [f64; 3],
}

impl Window {
    fn fit(&self, counts: &[(f64, u64)]) -> Option<PowerLawFit> {
        if counts.len() < 2 {
            return None;
        }
        let count: u64 = counts.iter().map(|c| c.1).sum();
        let logarithms = counts.iter().map(|&(x, times)| times as f64 * (x / self.low).ln());
        let mean = logarithms.sum::<f64>() / count as f64;
        let off = |exponent: f64| self.logarithm(exponent).0 - mean;
        // The mean of ln x falls with τ, since its derivative is −Var ln x: the root is unique.
        let exponent = brent_root(off, -STEEPEST, STEEPEST, 1e-12)?;
        let error = (count as f64 * self.logarithm(exponent).1).sqrt().recip();
        Some(PowerLawFit { exponent, error, count, distance: self.distance(exponent, counts) })
    }

    /// Mean and variance of ln y.
    fn logarithm(&self, exponent: f64) -> (f64, f64) {
        let [all, first, second] = (self.moments)(exponent, self.low, self.below, self.high);
        let mean = first / all;
        (mean, second / all - mean * mean)
    }

    fn distance(&self, exponent: f64, counts: &[(f64, u64)]) -> f64 {
        let weight = |from, to| (self.moments)(exponent, self.low, from, to)[0];
        let (all, count) = (weight(self.below, self.high), counts.iter().map(|c| c.1).sum::<u64>() as f64);
        let discrete = self.below < self.low;
        let (mut from, mut law, mut data, mut largest) = (self.below, 0.0, 0.0, 0.0_f64);
        for &(x, times) in counts {
            // Just below x the distribution function of integers has not jumped yet.
            let before = weight(from, if discrete { x - 1.0 } else { x }) / all;
            largest = largest.max((law + before - data).abs());
            law += weight(from, x) / all;
            data += times as f64 / count;
            largest = largest.max((law - data).abs());
            from = x;
        }
        largest
    }
}

/// Sums over integers. Beyond the first thousand terms the midpoint rule replaces the sum by an integral,
/// right to τ²/24x².
fn whole(exponent: f64, low: f64, above: f64, to: f64) -> [f64; 3] {
    let summed = to.min(low + TERMS).max(above);
    let mut moments = [0.0; 3];
    let mut x = above + 1.0;
    while x <= summed {
        add(&mut moments, exponent, (x / low).ln());
        x += 1.0;
    }
    let rest = integral(exponent, ((summed + 0.5) / low).ln(), ((to + 0.5) / low).ln());
    [0, 1, 2].map(|n| moments[n] + low * rest[n])
}

/// Integrals over real numbers.
fn real(exponent: f64, low: f64, above: f64, to: f64) -> [f64; 3] {
    integral(exponent, (above / low).ln(), (to / low).ln())
}

/// ∫ y^{−τ} lnⁿ y dy over a ≤ ln y ≤ b, to rounding.
fn integral(exponent: f64, a: f64, b: f64) -> [f64; 3] {
    let panels = (b - a).ceil().max(1.0);
    let width = (b - a) / panels;
    let mut moments = [0.0; 3];
    for panel in 0..panels as usize {
        let from = a + panel as f64 * width;
        for (n, moment) in moments.iter_mut().enumerate() {
            *moment +=
                RULE.integrate(from, from + width, |u| ((1.0 - exponent) * u).exp() * u.powi(n as i32));
        }
    }
    moments
}

/// Adds a term y^{−τ} lnⁿ y.
fn add(moments: &mut [f64; 3], exponent: f64, logarithm: f64) {
    let weight = (-exponent * logarithm).exp();
    moments.iter_mut().enumerate().for_each(|(n, moment)| *moment += weight * logarithm.powi(n as i32));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    /// Shares that are those of a law, in whole events of 10¹²: rounding moves τ by 1e-9, the midpoint rule by as much.
    #[test]
    fn counts_of_a_law_give_it_back() {
        for (exponent, low, high) in [(1.25, 1, 300_u64), (1.0, 7, 40_000), (2.5, 3, 5000), (0.0, 1, 90)] {
            let shares: Vec<f64> = (low..=high).map(|x| (x as f64).powf(-exponent)).collect();
            let all: f64 = shares.iter().sum();
            let number = |share: f64| (1e12 * share / all).round() as u64;
            let counts: Vec<_> = (low..=high).zip(shares.into_iter().map(number)).collect();
            let fit = fit_counts(&counts, low, high).unwrap();
            assert!((fit.exponent - exponent).abs() < 1e-7, "{exponent}: {fit:?}");
            assert!(fit.distance < 1e-7);
        }
    }

    /// Draws by inversion: τ within 4 errors, and √n times the distance below 1.95, as 999 of 1000 are.
    #[test]
    fn draws_give_back_the_exponent() {
        let (exponent, low, high) = (1.8_f64, 2.0_f64, 500.0_f64);
        let mut stream = Stream::new(4, Purpose::Sample, 0);
        let [a, b] = [low, high].map(|x| x.powf(1.0 - exponent));
        let draws = (0..40_000).map(|_| (a + (b - a) * stream.uniform()).powf((1.0 - exponent).recip()));
        // What is outside of the window is left out.
        let draws: Vec<f64> = draws.chain([1.0, 600.0]).collect();
        let fit = fit_values(&draws, low, high).unwrap();
        assert_eq!(fit.count, 40_000);
        assert!((fit.exponent - exponent).abs() < 4.0 * fit.error, "{fit:?}");
        assert!(200.0 * fit.distance < 1.95, "{fit:?}");
        // The error of a law without an upper end is (τ − 1)/√n; the window makes it somewhat larger.
        assert!((0.8 / 200.0..1.2 / 200.0).contains(&fit.error), "{fit:?}");
    }

    #[test]
    fn one_number_is_no_law() {
        assert_eq!(fit_counts(&[(3, 10)], 1, 100), None);
        assert_eq!(fit_counts(&[(3, 10), (101, 4)], 1, 100), None);
        assert_eq!(fit_values(&[], 1.0, 2.0), None);
    }
}
