//! How well chains of draws agree, and how many independent draws they are worth.
//!
//! A. Vehtari, A. Gelman, D. Simpson, B. Carpenter and P.-C. Bürkner, *Bayesian Analysis* **16**, 667 (2021), doi:10.1214/20-BA1221.

use asperity::law::{Gaussian, Law};

/// r̂ of `values`, chain after chain: the larger of those of the rank-normalised halves of chains, and of their distances from the
/// median. Near 1 where chains agree; above 1.01 they have not been long enough. NaN for fewer than 4 draws of a chain, and for
/// draws that are all the same.
pub fn r_hat(values: &[f64], chains: usize) -> f64 {
    let middle = median(values);
    let folded: Vec<f64> = values.iter().map(|value| (value - middle).abs()).collect();
    let of = |values: &[f64]| Variances::of(&halves(&rank_normalised(values), chains)).r_hat();
    of(values).max(of(&folded))
}

/// The effective number of draws of `values`, chain after chain: that of the rank-normalised halves of chains ("bulk"). NaN as for
/// [`r_hat`].
pub fn effective_size(values: &[f64], chains: usize) -> f64 {
    effective(&halves(&rank_normalised(values), chains))
}

/// The halves of the chains; the middle draw of an odd number is left out.
fn halves(values: &[f64], chains: usize) -> Vec<&[f64]> {
    let draws = values.len() / chains;
    let half = draws / 2;
    values.chunks_exact(draws).flat_map(|chain| [&chain[..half], &chain[draws - half..]]).collect()
}

/// Φ⁻¹((r − 3/8)/(S + 1/4)) of the ranks r of S values; equal values share the mean of their ranks.
fn rank_normalised(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&i, &j| values[i].total_cmp(&values[j]));
    let mut scores = vec![0.0; values.len()];
    for equal in order.chunk_by(|&i, &j| values[i] == values[j]).scan(0, |before, equal| {
        let first = *before;
        *before += equal.len();
        Some((first, equal))
    }) {
        let (first, equal) = equal;
        let rank = first as f64 + 0.5 * (equal.len() + 1) as f64;
        let score = normal_quantile((rank - 0.375) / (values.len() as f64 + 0.25));
        equal.iter().for_each(|&i| scores[i] = score);
    }
    scores
}

/// Φ⁻¹(p).
fn normal_quantile(p: f64) -> f64 {
    /// Laws are truncated at 0: so far above it, nothing of this one is.
    const MEAN: f64 = 40.0;
    Gaussian::new(MEAN, 1.0).expect("a normal distribution").quantile(p) - MEAN
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len();
    0.5 * (sorted[(n - 1) / 2] + sorted[n / 2])
}

/// Variances of chains of one length n.
#[derive(Debug)]
struct Variances {
    /// Mean variance within a chain.
    within: f64,
    /// (n − 1)/n of it, and the variance of the means of chains.
    all: f64,
}

impl Variances {
    fn of(chains: &[&[f64]]) -> Self {
        let n = chains[0].len() as f64;
        let means: Vec<f64> = chains.iter().map(|chain| mean(chain)).collect();
        let within: Vec<f64> = chains.iter().map(|chain| variance(chain)).collect();
        let within = mean(&within);
        Self { within, all: (n - 1.0) / n * within + variance(&means) }
    }

    fn r_hat(&self) -> f64 {
        (self.all / self.within).sqrt()
    }
}

/// The effective number of draws of chains of one length, by Geyer's initial monotone sequence of the autocorrelations ρ_t.
fn effective(chains: &[&[f64]]) -> f64 {
    let n = chains[0].len();
    let all = (n * chains.len()) as f64;
    let variances = Variances::of(chains);
    let means: Vec<f64> = chains.iter().map(|chain| mean(chain)).collect();
    let covariance = |lag: usize| {
        let of = |(chain, mean): (&&[f64], &f64)| {
            let products = chain.iter().zip(&chain[lag..]).map(|(a, b)| (a - mean) * (b - mean));
            products.sum::<f64>() / n as f64
        };
        chains.iter().zip(&means).map(of).sum::<f64>() / chains.len() as f64
    };
    let correlation = |lag: usize| {
        if lag == 0 { 1.0 } else { 1.0 - (variances.within - covariance(lag)) / variances.all }
    };
    // Sums of neighbouring correlations are above 0 and fall, for every reversible chain.
    let (mut total, mut lowest) = (0.0, f64::INFINITY);
    for pair in 0..n / 2 {
        let even = correlation(2 * pair);
        let both = even + correlation(2 * pair + 1);
        if both <= 0.0 {
            // Less is left out where draws are anticorrelated (A. Vehtari et al., Bayesian Anal. 16, 667 (2021), as Stan and ArviZ have
            // it).
            total += 0.5 * even.max(0.0);
            break;
        }
        lowest = both.min(lowest);
        total += lowest;
    }
    // −1 + 2 Σ over the pairs; bounded where draws are anticorrelated.
    let time = (2.0 * total - 1.0).max(1.0 / all.log10());
    if variances.all.is_finite() && variances.all > 0.0 { all / time } else { f64::NAN }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn variance(values: &[f64]) -> f64 {
    let mean = mean(values);
    values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / (values.len() as f64 - 1.0)
}

#[cfg(test)]
mod tests {
    use asperity::random::{Purpose, Stream};

    use super::*;

    /// Chains x' = φx + √(1 − φ²)ξ of variance 1, chain after chain.
    fn autoregressive(phi: f64, chains: usize, draws: usize) -> Vec<f64> {
        let mut stream = Stream::new(1, Purpose::Sample, 0);
        let mut values = Vec::new();
        for _ in 0..chains {
            let mut x = normal_quantile(stream.uniform());
            for _ in 0..draws {
                values.push(x);
                x = phi * x + (1.0 - phi * phi).sqrt() * normal_quantile(stream.uniform());
            }
        }
        values
    }

    #[test]
    fn autoregressive_chains_are_worth_the_known_number_of_draws() {
        for phi in [-0.4_f64, 0.0, 0.5, 0.9] {
            let (chains, draws) = (4, 20_000);
            let found = effective_size(&autoregressive(phi, chains, draws), chains);
            let expected = (chains * draws) as f64 * (1.0 - phi) / (1.0 + phi);
            // The sum of 1/(1 − φ) correlations has relative errors of a few of √(1/((1 − φ) 80000)), below 1 %, and the
            // truncation and the normal scores of ranks change it by as much.
            assert!((found / expected - 1.0).abs() < 0.08, "{phi}: {found} {expected}");
        }
    }

    #[test]
    fn r_hat_is_near_1_where_chains_agree_and_above_it_where_they_differ() {
        let draws = 2000;
        let same = autoregressive(0.3, 4, draws);
        // Of order 1/draws above 1.
        assert!((r_hat(&same, 4) - 1.0).abs() < 0.005, "{}", r_hat(&same, 4));
        let apart: Vec<f64> =
            same.iter().enumerate().map(|(i, x)| if i < draws { x + 2.0 } else { *x }).collect();
        assert!(r_hat(&apart, 4) > 1.1);
        // The same mean but another width: only the distances from the median show it.
        let wide: Vec<f64> =
            same.iter().enumerate().map(|(i, x)| if i < draws { 4.0 * x } else { *x }).collect();
        assert!(r_hat(&wide, 4) > 1.1);
        // A trend within each chain makes its halves differ.
        let drifting: Vec<f64> =
            same.iter().enumerate().map(|(i, x)| x + 3.0 * (i % draws) as f64 / draws as f64).collect();
        assert!(r_hat(&drifting, 4) > 1.1);
    }

    #[test]
    fn the_variances_are_those_of_a_case_by_hand() {
        // Two chains of two: means 1 and 3, variances within 2 and 2: W = 2, var⁺ = ½·2 + 2 = 3.
        let variances = Variances::of(&[&[0.0, 2.0], &[2.0, 4.0]]);
        assert_eq!((variances.within, variances.all), (2.0, 3.0));
        // Ranks 1, 2.5, 2.5, 4 of four values.
        let scores = rank_normalised(&[0.1, 5.0, 5.0, 9.0]);
        assert_eq!(scores[1], scores[2]);
        // Rounding of numbers near 40.
        assert!(scores[1].abs() < 1e-13 && (scores[0] + scores[3]).abs() < 1e-13);
        // Φ⁻¹(0.975), from tables.
        assert!((normal_quantile(0.975) - 1.959_963_984_540_054).abs() < 1e-13);
    }
}
