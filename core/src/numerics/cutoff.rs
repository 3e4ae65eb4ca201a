//! Maximum-likelihood fits of power laws with an exponential cut-off, p(x) ∝ x^{−τ} e^{−x/ξ} for x ≥ x₀: τ, ξ
//! and x₀ are all found. For a fit within a given window see [`super::powerlaw`].
//!
//! At the maximum of the likelihood the means of ln x and of x under p are those of the data. ξ is infinite
//! if a pure power law has no larger mean than the data. x₀ is the datum from which on the fit has the
//! smallest Kolmogorov–Smirnov distance, after A. Clauset, C. R. Shalizi and M. E. J. Newman, *Power-law
//! distributions in empirical data*, SIAM Rev. 51, 661 (2009), doi:10.1137/070710111.
//!
//! Sums over integers are integrals from x₀ − ½ on with the first correction of the midpoint rule (Euler and Maclaurin),
//! Σ f(k) = ∫ f dx + f'(x₀ − ½)/24.

use super::legendre::RULE;

/// Smallest number of data in a fit.
const FEWEST: usize = 50;
/// Ratio of the numbers of data above two successive trial values of x₀.
const SHRINK: f64 = 0.8;
/// Integers are fitted from here on. What is left out of sums is then about 7 (τ + x/ξ)³/5760x⁴ of x f(x), less than 1e-4 for
/// τ + x/ξ up to 4.
const WHOLE: f64 = 6.0;
/// Number of points at which the distribution functions are compared.
const KNOTS: usize = 256;
/// Densities below e^{−60} are neglected.
const NEGLIGIBLE: f64 = 60.0;
/// Width in ln x over which the 16-point Gauss rule is exact to rounding, for any cut-off.
const PANEL: f64 = 0.5;
/// Largest number of Newton steps.
const ITERATIONS: usize = 200;

/// A fitted power law with exponential cut-off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutOff {
    /// Exponent τ.
    pub exponent: f64,
    /// Standard error of τ for independent data and the given x₀.
    pub error: f64,
    /// Cut-off ξ, or infinity.
    pub scale: f64,
    /// Standard error of ξ; infinite if ξ is.
    pub scale_error: f64,
    /// Lower end x₀ of the fit.
    pub low: f64,
    /// Number of data from x₀ on.
    pub count: usize,
    /// Kolmogorov–Smirnov distance between fit and data.
    pub distance: f64,
}

/// Fits integers. `None` if fewer than 50 are 6 or above, or all of these are equal.
pub fn fit_whole(values: &[f64]) -> Option<CutOff> {
    fit(values.iter().copied().filter(|&x| x >= WHOLE).collect(), 0.5)
}

/// Fits positive real numbers. `None` if there are fewer than 50, or all are equal.
pub fn fit_real(values: &[f64]) -> Option<CutOff> {
    fit(values.iter().copied().filter(|&x| x > 0.0 && x.is_finite()).collect(), 0.0)
}

/// The best fit over trial values of x₀. `half` is half the spacing of the possible values: ½ for integers, 0
/// for real numbers.
fn fit(mut values: Vec<f64>, half: f64) -> Option<CutOff> {
    values.sort_by(f64::total_cmp);
    let mut best: Option<CutOff> = None;
    let mut kept = values.len();
    let mut last = f64::NAN;
    // Trial values of x₀ are a fifth of the remaining data apart: the number of fits grows with the
    // logarithm of the number of data.
    while kept >= FEWEST {
        let low = values[values.len() - kept];
        if low != last {
            let tail = &values[values.partition_point(|&x| x < low)..];
            let fit = above(tail, half);
            best = [best, fit].into_iter().flatten().min_by(|a, b| a.distance.total_cmp(&b.distance));
            last = low;
        }
        kept = (SHRINK * kept as f64) as usize;
    }
    best
}

/// The distribution on x ≥ x₀ in terms of u = ln(x/x₀), y = x/x₀ and λ = x₀/ξ: p(u) ∝ e^{(1−τ)u − λ e^u}.
#[derive(Debug, Clone, Copy)]
struct CutoffDistribution {
    exponent: f64,
    rate: f64,
    /// The distance of possible values of y: 0 for real numbers.
    spacing: f64,
}

/// The fit to a sorted `tail` of the data, with its standard errors from the inverse Fisher information.
fn above(tail: &[f64], half: f64) -> Option<CutOff> {
    let (low, count) = (tail[0] - half, tail.len());
    if tail[count - 1] == tail[0] {
        return None;
    }
    let mean = |of: fn(f64) -> f64| tail.iter().map(|x| of(x / low)).sum::<f64>() / count as f64;
    let means = [mean(f64::ln), mean(|y| y)];
    let law = CutoffDistribution::with_means(means, 2.0 * half / low)?;
    // u and y are the sufficient statistics, so that their covariance is the Fisher information per
    // datum.
    let [own, mixed, other] = law.moments().covariance();
    let (n, determinant) = (count as f64, own * other - mixed * mixed);
    let pure = law.rate == 0.0;
    let error = if pure { (n * own).sqrt().recip() } else { (other / (n * determinant)).sqrt() };
    let scale = low / law.rate;
    let scale_error = if pure { f64::INFINITY } else { scale / law.rate * (own / (n * determinant)).sqrt() };
    let distance = law.distance(tail, low, half);
    Some(CutOff { exponent: law.exponent, error, scale, scale_error, low: tail[0], count, distance })
}

impl CutoffDistribution {
    /// The distribution with the given means of ln y and y: damped Newton iteration on the log-likelihood,
    /// which is concave.
    fn with_means(means: [f64; 2], spacing: f64) -> Option<Self> {
        let pure = Self::without_end(means[0], spacing);
        if pure.has_no_larger_mean(means[1]) {
            return Some(pure);
        }
        // Any start converges, since the log-likelihood of an exponential family is concave; this
        // one is of the right order.
        let mut law = Self { exponent: 1.5_f64.min(pure.exponent), rate: means[1].recip(), spacing };
        let mut moments = law.moments();
        for _ in 0..ITERATIONS {
            // Newton step: the Hessian of the log-likelihood is minus the covariance matrix.
            let off = [moments.mean(1) - means[0], moments.mean(2) - means[1]];
            let [own, mixed, other] = moments.covariance();
            let determinant = own * other - mixed * mixed;
            let step = [
                (other * off[0] - mixed * off[1]) / determinant,
                (own * off[1] - mixed * off[0]) / determinant,
            ];
            if step[0].abs() < 1e-10 && step[1].abs() < 1e-10 * law.rate {
                return Some(law);
            }
            (law, moments) = law.towards(step, &moments, means)?;
        }
        None
    }

    /// The maximum-likelihood estimate (Hill, 1975) without a cut-off, ξ = ∞, from the mean of u.
    fn without_end(mean: f64, spacing: f64) -> Self {
        /// Of the error each one leaves about spacing²/24 over the square of the mean.
        const ITERATIONS: usize = 12;
        let correction = spacing * spacing / 24.0;
        // ⟨u⟩ = (n² + c)/(n − cτ), n = 1/(τ − 1), with the correction c.
        let mut inverse = mean;
        for _ in 0..ITERATIONS {
            let off = correction * (mean * (1.0 + inverse.recip()) + 1.0) / inverse;
            inverse = (mean - off).max(0.5 * mean);
        }
        Self { exponent: 1.0 + inverse.recip(), rate: 0.0, spacing }
    }

    /// Whether a pure power law has a mean of y, at most this: ⟨y⟩ = (τ − 1)/(τ − 2) for real numbers.
    fn has_no_larger_mean(self, mean: f64) -> bool {
        let (exponent, correction) = (self.exponent, self.spacing * self.spacing / 24.0);
        let whole = (exponent - 1.0).recip() - correction * exponent;
        let first = (exponent - 2.0).recip() + correction * (1.0 - exponent);
        exponent > 2.0 && first <= mean * whole
    }

    /// The longest of the steps `step`, `step`/2, `step`/4 … that increases the likelihood.
    fn towards(self, step: [f64; 2], here: &Moments, means: [f64; 2]) -> Option<(Self, Moments)> {
        let likelihood = |law: Self, moments: &Moments| {
            -law.exponent * means[0] - law.rate * (means[1] - 1.0) - moments.0[0].ln()
        };
        let now = likelihood(self, here);
        let mut fraction = 1.0;
        while fraction > 1e-9 {
            let exponent = self.exponent + fraction * step[0];
            let law = Self { exponent, rate: self.rate + fraction * step[1], ..self };
            if law.rate > 0.0 {
                let moments = law.moments();
                // Close to the maximum likelihoods differ by rounding only.
                if likelihood(law, &moments) >= now - 1e-13 * now.abs() {
                    return Some((law, moments));
                }
            }
            fraction *= 0.5;
        }
        None
    }

    fn density(self, u: f64) -> f64 {
        ((1.0 - self.exponent) * u - self.rate * (u.exp() - 1.0)).exp()
    }

    /// u beyond which the density is negligible.
    fn end(self) -> f64 {
        let pure = NEGLIGIBLE / (self.exponent - 1.0).max(1e-3);
        if self.rate == 0.0 { pure } else { (1.0 + NEGLIGIBLE / self.rate).ln() }
    }

    /// Integrals, or sums over integers, of 1, u, y, u², uy, y² with the unnormalised density.
    fn moments(self) -> Moments {
        let powers = |u: f64| {
            let y = u.exp();
            [1.0, u, y, u * u, u * y, y * y]
        };
        let panels = (self.end() / PANEL).ceil();
        let width = self.end() / panels;
        // Derivatives by y at y = 1 of y^{−τ} e^{−λ(y − 1)} times each of them.
        let slope = -self.exponent - self.rate;
        let corrections = [slope, 1.0, 1.0 + slope, 0.0, 1.0, 2.0 + slope];
        let mut moments = corrections.map(|derivative| self.spacing * self.spacing / 24.0 * derivative);
        for panel in 0..panels as usize {
            let from = panel as f64 * width;
            for (n, moment) in moments.iter_mut().enumerate() {
                *moment += RULE.integrate(from, from + width, |u| self.density(u) * powers(u)[n]);
            }
        }
        Moments(moments)
    }

    /// Kolmogorov–Smirnov distance to a sorted `tail` that begins at `low`.
    fn distance(self, tail: &[f64], low: f64, half: f64) -> f64 {
        let weight = |from: f64, to: f64| {
            let to = to.min(self.end()).max(from);
            let panels = ((to - from) / PANEL).ceil().max(1.0);
            let width = (to - from) / panels;
            let piece = |i: usize| {
                let from = from + i as f64 * width;
                RULE.integrate(from, from + width, |u| self.density(u))
            };
            (0..panels as usize).map(piece).sum::<f64>()
        };
        let all = weight(0.0, self.end());
        let (mut from, mut law, mut largest) = (0.0, 0.0, 0.0_f64);
        for knot in 1..=KNOTS.min(tail.len()) {
            let x = tail[knot * tail.len() / KNOTS.min(tail.len()) - 1];
            let to = ((x + half) / low).ln();
            law += weight(from, to) / all;
            from = to.max(from);
            let data = tail.partition_point(|&other| other <= x) as f64 / tail.len() as f64;
            largest = largest.max((law - data).abs());
        }
        largest
    }
}

/// Integrals or sums of 1, u, y, u², uy, y² with the unnormalised density.
struct Moments([f64; 6]);

impl Moments {
    fn mean(&self, n: usize) -> f64 {
        self.0[n] / self.0[0]
    }

    /// Var u, Cov(u, y), Var y.
    fn covariance(&self) -> [f64; 3] {
        let (u, y) = (self.mean(1), self.mean(2));
        [self.mean(3) - u * u, self.mean(4) - u * y, self.mean(5) - y * y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Purpose, Stream};

    /// Draws of x^{−τ} e^{−x/ξ} from 1 on: of the power law, those kept that the cut-off lets through.
    fn draws(exponent: f64, scale: f64, number: usize) -> Vec<f64> {
        let mut stream = Stream::new(3, Purpose::Sample, 0);
        let draw = || {
            let x = (1.0 - stream.uniform()).powf((1.0 - exponent).recip());
            (x, stream.uniform() < (-x / scale).exp())
        };
        std::iter::repeat_with(draw).filter(|draw| draw.1).map(|draw| draw.0).take(number).collect()
    }

    /// Exponent and cut-off within 4 errors; √n times the distance below 1.95, as 999 of 1000 are.
    #[test]
    fn draws_give_back_exponent_and_cut_off() {
        for (exponent, scale) in [(1.5, 300.0), (1.8, 40.0), (2.5, 100.0)] {
            let fit = above(&sorted(draws(exponent, scale, 20_000)), 0.0).unwrap();
            assert!((fit.exponent - exponent).abs() < 4.0 * fit.error, "{fit:?}");
            assert!((fit.scale - scale).abs() < 4.0 * fit.scale_error, "{fit:?}");
            assert!((fit.count as f64).sqrt() * fit.distance < 1.95, "{fit:?}");
        }
    }

    /// Whole numbers have their own means: those of the fitted law, summed one by one, are those of the data.
    #[test]
    fn whole_numbers_are_fitted_by_sums() {
        for (exponent, scale) in [(0.6_f64, 7.0), (1.3, 60.0), (1.8, 30.0)] {
            // As many of each as the law has, so that the fit must give it back.
            let weight = |k: f64| k.powf(-exponent) * (-k / scale).exp();
            let whole: f64 = (6..4000).map(|k| weight(f64::from(k))).sum();
            let of = |k: i32| (1e6 * weight(f64::from(k)) / whole).round() as usize;
            let tail: Vec<f64> = (6..4000).flat_map(|k| std::iter::repeat_n(f64::from(k), of(k))).collect();
            let fit = above(&tail, 0.5).unwrap();
            // Half of the errors of a million data: of rounding, the rarest numbers are fewer by some tens.
            assert!((fit.exponent - exponent).abs() < 0.5 * fit.error, "{exponent} {fit:?}");
            assert!((fit.scale - scale).abs() < 0.5 * fit.scale_error, "{scale} {fit:?}");
        }
    }

    /// Errors are the scatter of fits to independent data: of 200 exponents to 20 %, four errors of a standard deviation.
    #[test]
    fn errors_are_the_scatter_of_fits() {
        let all = draws(1.5, 100.0, 200 * 500);
        let fits: Vec<CutOff> =
            all.chunks(500).map(|part| above(&sorted(part.to_vec()), 0.0).unwrap()).collect();
        let mean = fits.iter().map(|fit| fit.exponent).sum::<f64>() / 200.0;
        let scatter = (fits.iter().map(|fit| (fit.exponent - mean).powi(2)).sum::<f64>() / 199.0).sqrt();
        let error = fits.iter().map(|fit| fit.error).sum::<f64>() / 200.0;
        assert!((scatter / error - 1.0).abs() < 0.2, "{scatter} {error}");
    }

    /// Numbers below the law's beginning are left out, and whole numbers count as such.
    #[test]
    fn the_lowest_number_is_found() {
        let law = draws(1.6, 500.0, 40_000);
        let low = (0..20_000).map(|i| 10.0 * f64::from(i) / 20_000.0 + 0.01);
        let fit = fit_real(&law.iter().map(|x| 10.0 * x).chain(low).collect::<Vec<_>>()).unwrap();
        assert!((9.0..40.0).contains(&fit.low), "{fit:?}");
        assert!((fit.exponent - 1.6).abs() < 4.0 * fit.error, "{fit:?}");
        let whole: Vec<f64> = law.iter().map(|x| (10.0 * x).round()).collect();
        let fit = fit_whole(&whole).unwrap();
        assert!((fit.exponent - 1.6).abs() < 4.0 * fit.error, "{fit:?}");
    }

    /// The exponent of a law without end is 1 + 1/⟨ln y⟩.
    #[test]
    fn a_law_may_have_no_end() {
        let tail = sorted((0..1000).map(|i| (1.0 - f64::from(i) / 1000.0).powf(-1.0 / 2.0)).collect());
        let heavy = [&tail[..], &[1e6]].concat();
        let fit = above(&heavy, 0.0).unwrap();
        assert_eq!((fit.scale, fit.scale_error), (f64::INFINITY, f64::INFINITY));
        let mean = heavy.iter().map(|x| x.ln()).sum::<f64>() / 1001.0;
        assert!((fit.exponent - 1.0 - mean.recip()).abs() < 1e-12, "{fit:?}");
    }

    /// The same of whole numbers: 1e5 quantiles of k^(−5/2), the largest of which are far larger than its cut-off would let expect.
    #[test]
    fn a_law_of_whole_numbers_may_have_no_end() {
        let mut whole = 0.0;
        let mut beyond = Vec::new();
        for k in (6..1_000_000).rev() {
            whole += f64::from(k).powf(-2.5);
            beyond.push(whole);
        }
        // How many are at least this large.
        let ranks: Vec<usize> = beyond.iter().map(|sum| (1e5 * sum / whole).round() as usize).collect();
        let sizes = ranks.windows(2).zip((6..999_999).rev());
        let mut tail: Vec<f64> =
            sizes.flat_map(|(n, k)| std::iter::repeat_n(f64::from(k), n[1] - n[0])).collect();
        tail.reverse();
        let fit = above(&[&tail[..], &[1e6]].concat(), 0.5).unwrap();
        assert_eq!((fit.scale, fit.scale_error), (f64::INFINITY, f64::INFINITY));
        // Ranks are rounded to one of 1e5, which moves the mean of ln x by less than a tenth of its error.
        assert!((fit.exponent - 2.5).abs() < 0.1 * fit.error, "{fit:?}");
    }

    #[test]
    fn few_or_equal_numbers_are_no_law() {
        assert_eq!(fit_real(&[1.0; 1000]), None);
        assert_eq!(fit_real(&draws(1.5, 10.0, FEWEST - 1)), None);
        assert_eq!(fit_whole(&[5.0; 1000]), None);
    }

    fn sorted(mut values: Vec<f64>) -> Vec<f64> {
        values.sort_by(f64::total_cmp);
        values
    }
}
