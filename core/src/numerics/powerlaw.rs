//! Maximum-likelihood fits of power laws p(x) ∝ x^{−τ} of integers within a given window, whatever the cut-off outside of
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
/// different numbers, more than can be counted, or numbers of 2⁵² and more, which are not apart from their neighbours. Sums over the
/// distribution are right to 1e-7.
pub fn fit_counts(counts: &[(u64, u64)], low: u64, high: u64) -> Option<PowerLawFit> {
    let low = low.max(1);
    if low >= 1 << 52 {
        return None;
    }
    let inside = counts.iter().filter(|count| (low..=high).contains(&count.0));
    let inside: Vec<_> = inside.map(|&(number, times)| (number as f64, times)).collect();
    let window = Window { low: low as f64, below: low as f64 - 1.0, high: high as f64 };
    window.fit(&inside)
}

/// The support of the distribution: above `below`, up to `high`.
struct Window {
    low: f64,
    below: f64,
    high: f64,
}

impl Window {
    fn fit(&self, counts: &[(f64, u64)]) -> Option<PowerLawFit> {
        if counts.len() < 2 {
            return None;
        }
        let count = counts.iter().try_fold(0_u64, |sum, c| sum.checked_add(c.1))?;
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
        let [all, first, second] = power_sums(exponent, self.low, self.below, self.high);
        let mean = first / all;
        (mean, second / all - mean * mean)
    }

    fn distance(&self, exponent: f64, counts: &[(f64, u64)]) -> f64 {
        let weight = |from, to| power_sums(exponent, self.low, from, to)[0];
        let (all, count) = (weight(self.below, self.high), counts.iter().map(|c| c.1).sum::<u64>() as f64);
        let (mut from, mut law, mut data, mut largest) = (self.below, 0.0, 0.0, 0.0_f64);
        for &(x, times) in counts {
            // Just below x the distribution function of integers has not jumped yet.
            let before = weight(from, x - 1.0) / all;
            largest = largest.max((law + before - data).abs());
            law += weight(from, x) / all;
            data += times as f64 / count;
            largest = largest.max((law - data).abs());
            from = x;
        }
        largest
    }
}

/// ∑ y^{−τ} lnⁿ y, y = x/low, n = 0, 1, 2, over integers above < x ≤ to. Beyond the first thousand terms the midpoint rule replaces the sum by an integral,
/// right to τ²/24x².
fn power_sums(exponent: f64, low: f64, above: f64, to: f64) -> [f64; 3] {
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

    #[test]
    fn numbers_that_are_not_apart_are_not_fitted() {
        let far = 1 << 53;
        assert_eq!(fit_counts(&[(far, 1), (far + 2, 1)], far, u64::MAX), None);
    }

    #[test]
    fn one_number_is_no_law() {
        assert_eq!(fit_counts(&[(3, 10)], 1, 100), None);
        assert_eq!(fit_counts(&[(3, 10), (101, 4)], 1, 100), None);
    }
}
