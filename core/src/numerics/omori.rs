//! Maximum-likelihood fits of the modified Omori law, n(t) = K/(t + c)^p + B, to times after main shocks.
//!
//! After Y. Ogata, *Estimation of the parameters in the modified Omori formula for aftershock frequencies by the maximum
//! likelihood procedure*, J. Phys. Earth 31, 115 (1983), doi:10.4294/jpe1952.31.115. The times are those of a Poisson process
//! of the rate n(t); given their number they are independent, with a density in proportion to n(t), from which K follows.

use super::nelder_mead::nelder_mead;

/// Smallest number of times in a fit.
const FEWEST: usize = 30;
/// Of more times than this, quantiles are fitted, each with the weight of those beside it.
const MOST: usize = 4096;
/// Change of the logarithm of the likelihood at which the search ends.
const TOLERANCE: f64 = 1e-10;
/// Step of the second differences of the log-likelihood by p, ln c and the logit of the fraction of aftershocks.
const STEP: f64 = 1e-3;
/// Exponents are searched for in [0, 10].
const STEEPEST: f64 = 10.0;
/// ln c is searched for from this much below the earliest time; no later time tells smaller ones from 0.
const EARLIEST: f64 = 7.0;

/// A fitted modified Omori law.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct OmoriFit {
    /// Exponent p.
    pub exponent: f64,
    /// Standard error of p for independent times; too small where sequences trigger others.
    pub error: f64,
    /// Delay c.
    pub delay: f64,
    /// Background B, as the fraction of the times that it accounts for; 0 where Akaike's criterion prefers none.
    pub background: f64,
    /// Number of times.
    pub count: usize,
}

/// Fits times in (0, `window`]; others are left out. `None` for fewer than 30, and where the likelihood has no maximum with
/// 0 < p < 10, or no curvature there.
pub fn fit_omori(times: &[f64], window: f64) -> Option<OmoriFit> {
    let mut inside: Vec<f64> = times.iter().copied().filter(|&t| t > 0.0 && t <= window).collect();
    let count = inside.len();
    if count < FEWEST {
        return None;
    }
    inside.sort_by(f64::total_cmp);
    let kept = count.min(MOST);
    let quantile = |i: usize| inside[(2 * i + 1) * count / (2 * kept)];
    let likelihood = OmoriLikelihood {
        times: (0..kept).map(quantile).collect(),
        weight: count as f64 / kept as f64,
        window,
    };
    // Akaike's criterion: a parameter pays if the log-likelihood rises by more than 1.
    let alone = likelihood.maximum(&[1.0, (0.01 * window).ln()]);
    let with = likelihood.maximum(&[1.0, (0.01 * window).ln(), 1.0]);
    let (place, value) = if with.1 > alone.1 + 1.0 { with } else { alone };
    likelihood.estimates(&place, value, count)
}

/// Times, each of which stands for `weight` of them.
struct OmoriLikelihood {
    times: Vec<f64>,
    weight: f64,
    window: f64,
}

impl OmoriLikelihood {
    /// The log-likelihood of p, ln c and, with a background, the logit of the fraction of aftershocks.
    fn value(&self, place: &[f64]) -> f64 {
        let (p, delay) = (place[0], place[1].exp());
        let earliest = self.times[0].ln() - EARLIEST;
        if !(0.0..=STEEPEST).contains(&p) || !(earliest..=self.window.ln() + EARLIEST).contains(&place[1]) {
            return f64::NEG_INFINITY;
        }
        let fraction = place.get(2).map_or(1.0, |logit| 1.0 / (1.0 + (-logit).exp()));
        // ∫(t + c)^{−p} dt over the window, of which the limit p → 1 is a logarithm.
        let (decades, q) = ((self.window / delay).ln_1p(), 1.0 - p);
        let ratio = if (q * decades).abs() < 1e-9 { decades } else { (q * decades).exp_m1() / q };
        let ln_whole = q * place[1] + ratio.ln();
        let density = |t: &f64| {
            let omori = (-p * (t + delay).ln() - ln_whole).exp();
            (fraction * omori + (1.0 - fraction) / self.window).ln()
        };
        self.weight * self.times.iter().map(density).sum::<f64>()
    }

    /// Where the likelihood is largest, and its logarithm.
    fn maximum(&self, start: &[f64]) -> (Vec<f64>, f64) {
        let mut best = (start.to_vec(), f64::NEG_INFINITY);
        // The search is repeated from where it ended, with a new simplex.
        for step in [0.5, 0.2, 0.05, 0.01] {
            let (place, least) = nelder_mead(|place| -self.value(place), &best.0, step, TOLERANCE);
            if -least > best.1 {
                best = (place, -least);
            }
        }
        best
    }

    /// The estimates with their standard errors, from the inverse of the observed information.
    fn estimates(&self, place: &[f64], value: f64, count: usize) -> Option<OmoriFit> {
        let moved = |moves: &[(usize, f64)]| {
            let mut place = place.to_vec();
            moves.iter().for_each(|&(i, by)| place[i] += by);
            self.value(&place)
        };
        let information = |i: usize, j: usize| {
            if i == j {
                return -(moved(&[(i, STEP)]) - 2.0 * value + moved(&[(i, -STEP)])) / (STEP * STEP);
            }
            let corner = |a: f64, b: f64| moved(&[(i, a * STEP), (j, b * STEP)]);
            -(corner(1.0, 1.0) - corner(1.0, -1.0) - corner(-1.0, 1.0) + corner(-1.0, -1.0))
                / (4.0 * STEP * STEP)
        };
        let n = place.len();
        let matrix: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| information(i, j)).collect()).collect();
        let edge = place[0] < 2.0 * STEP || place[0] > STEEPEST - 2.0 * STEP;
        if edge || !value.is_finite() {
            return None;
        }
        // Where the times do not tell c from 0, its row is 0, or infinite at the smallest c: p is estimated for c = 0.
        let flat = !matrix[1][1].is_finite() || matrix[1][1] <= 1e-6;
        let known: Vec<usize> = (0..n).filter(|&i| i != 1 || !flat).collect();
        let variances = inverse_diagonal(&matrix, &known)?;
        let background = place.get(2).map_or(0.0, |logit| 1.0 / (1.0 + logit.exp()));
        Some(OmoriFit {
            exponent: place[0],
            error: variances[0].sqrt(),
            delay: place[1].exp(),
            background,
            count,
        })
    }
}

/// The diagonal of the inverse of a symmetric matrix of the rows and columns `known`; `None` unless it is positive definite.
fn inverse_diagonal(matrix: &[Vec<f64>], known: &[usize]) -> Option<Vec<f64>> {
    let n = known.len();
    let mut rows: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let unit = (0..n).map(|j| if i == j { 1.0 } else { 0.0 });
            known.iter().map(|&j| matrix[known[i]][j]).chain(unit).collect()
        })
        .collect();
    // Gauss–Jordan elimination; the pivots of a positive definite matrix are above 0.
    for pivot in 0..n {
        let by = rows[pivot][pivot];
        if by.is_nan() || by <= 0.0 {
            return None;
        }
        rows[pivot].iter_mut().for_each(|value| *value /= by);
        let row = rows[pivot].clone();
        for (_, other) in rows.iter_mut().enumerate().filter(|(i, _)| *i != pivot) {
            let by = other[pivot];
            other.iter_mut().zip(&row).for_each(|(value, own)| *value -= by * own);
        }
    }
    let diagonal: Vec<f64> = (0..n).map(|i| rows[i][n + i]).collect();
    diagonal.iter().all(|&variance| variance > 0.0).then_some(diagonal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    /// Times of the modified Omori law by inversion of its integral, and of a background.
    fn synthetic(
        (p, c, window): (f64, f64, f64),
        [aftershocks, background]: [usize; 2],
        index: u64,
    ) -> Vec<f64> {
        let mut stream = Stream::new(5, Purpose::Sample, index);
        let mut uniform = || stream.uniform();
        let of = |u: f64| {
            let q = 1.0 - p;
            if q == 0.0 {
                c * (u * (1.0 + window / c).ln()).exp() - c
            } else {
                let whole = (window + c).powf(q) - c.powf(q);
                (u * whole + c.powf(q)).powf(q.recip()) - c
            }
        };
        let mut times: Vec<f64> = (0..aftershocks).map(|_| of(uniform())).collect();
        times.extend((0..background).map(|_| window * uniform()));
        times
    }

    /// Times without a delay, whose likelihood is largest at the smallest c that is looked for, in some of these catalogues: p is
    /// then estimated for c = 0.
    #[test]
    fn exponents_without_a_delay_are_found() {
        let p = 0.6;
        let fits = (0..12).filter_map(|index| fit_omori(&synthetic((p, 0.0, 100.0), [50, 0], index), 100.0));
        let fits: Vec<OmoriFit> = fits.collect();
        assert!(fits.len() >= 10, "{}", fits.len());
        // Fits of 12 catalogues within 4 standard errors.
        assert!(fits.iter().all(|fit| (fit.exponent - p).abs() < 4.0 * fit.error), "{fits:?}");
    }

    /// Over 40 catalogues of known p the estimates scatter by their standard errors: their normalised deviations have the mean 0
    /// and the variance 1, within 4 standard errors of these.
    #[test]
    fn known_exponents_are_found_within_their_errors() {
        for (index, (law, counts)) in [
            ((1.0, 0.01, 100.0), [2000, 0]),
            ((0.7, 0.1, 100.0), [2000, 0]),
            ((1.4, 0.01, 10.0), [2000, 0]),
            ((1.1, 0.01, 100.0), [2000, 1000]),
            ((1.0, 0.01, 100.0), [4000, 0]),
        ]
        .into_iter()
        .enumerate()
        {
            let deviation = |k: u64| {
                let fit = fit_omori(&synthetic(law, counts, 100 * index as u64 + k), law.2).unwrap();
                // Akaike's criterion prefers a background where there is none once in ten times.
                assert!(counts[1] == 0 || fit.background > 0.0);
                (fit.exponent - law.0) / fit.error
            };
            let found: Vec<f64> = (0..40).map(deviation).collect();
            let mean = found.iter().sum::<f64>() / 40.0;
            let variance = found.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / 39.0;
            // √(1/40) and √(2/39), times 4.
            assert!(mean.abs() < 0.63 && (variance - 1.0).abs() < 0.91, "{law:?}: {mean} {variance}");
        }
    }

    /// Of fewer than 30 times, and of times without aftershocks.
    #[test]
    fn without_aftershocks_or_times_there_is_no_law() {
        assert_eq!(fit_omori(&[1.0; 29], 2.0), None);
        let mut stream = Stream::new(6, Purpose::Sample, 0);
        let even: Vec<f64> = (0..2000).map(|_| stream.uniform()).collect();
        // Even times have p = 0, which no aftershocks have, or a p that is not known.
        assert!(fit_omori(&even, 1.0).is_none_or(|fit| fit.exponent < 4.0 * fit.error));
    }
}
