//! Maximum-likelihood fits of power laws with an exponential cut-off, p(x) ∝ x^{−τ} e^{−x/ξ} for x ≥ x₀: τ, ξ
//! and x₀ are all found. For a fit within a given window see [`super::powerlaw`].
//!
//! At the maximum of the likelihood the means of ln x and of x under p are those of the data. ξ is infinite
//! if a pure power law has no larger mean than the data. x₀ is the datum from which on the fit has the
//! smallest Kolmogorov–Smirnov distance, after A. Clauset, C. R. Shalizi and M. E. J. Newman, *Power-law
//! distributions in empirical data*, SIAM Rev. 51, 661 (2009), doi:10.1137/070710111.
//!
//! Sums over integers k have their first terms one by one. From k = 12 on they are integrals from k − ½ on with the first
//! correction of the midpoint rule (Euler and Maclaurin), Σ f(k) = ∫ f dx + f'(k − ½)/24.

use super::legendre::RULE;

/// Smallest number of data in a fit.
const FEWEST: usize = 50;
/// Ratio of the numbers of data above two successive trial values of x₀, where these are not all different values.
const SHRINK: f64 = 0.95;
/// Sums over integers are integrals from here on. What is left out of them is then about 7 (τ + x/ξ)³/5760x⁴ of x f(x), less
/// than 1e-5 for τ + x/ξ up to 4.
const WHOLE: f64 = 12.0;
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

/// Fits positive integers. `None` if there are fewer than 50, or all are equal.
pub fn fit_whole(values: &[f64]) -> Option<CutOff> {
    fit(values.iter().copied().filter(|&x| x >= 1.0 && x.is_finite()).collect(), 0.5)
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
    // Trial values of x₀ are at least a twentieth of the remaining data apart: the number of fits grows with the logarithm of
    // the number of data.
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

/// The distribution on x ≥ x₀ in terms of u = ln(x/x₀), y = x/x₀ and λ = x₀/ξ: p(u) ∝ e^{(1−τ)u − λ e^u}. For integers x₀ is
/// half below the smallest one.
#[derive(Debug, Clone, Copy)]
struct CutoffDistribution {
    exponent: f64,
    rate: f64,
    values: PossibleValues,
}

/// The possible values of y.
#[derive(Debug, Clone, Copy)]
struct PossibleValues {
    /// Their distance: 0 for real numbers.
    spacing: f64,
    /// How many of them are summed one by one.
    single: usize,
}

impl PossibleValues {
    /// Values x/`low` from the smallest, `first`, on.
    fn new(first: f64, low: f64) -> Self {
        let spacing = 2.0 * (first - low) / low;
        Self { spacing, single: if spacing > 0.0 { (WHOLE - first).max(0.0) as usize } else { 0 } }
    }

    /// Those that are summed one by one.
    fn singles(self) -> impl Iterator<Item = f64> {
        (0..self.single).map(move |i| 1.0 + (i as f64 + 0.5) * self.spacing)
    }

    /// From here on sums are integrals.
    fn integrated_from(self) -> f64 {
        1.0 + self.single as f64 * self.spacing
    }

    /// The factor of f' in sums that are integrals.
    fn correction(self) -> f64 {
        self.spacing * self.spacing / 24.0
    }
}

/// The fit to a sorted `tail` of the data, with its standard errors from the inverse Fisher information.
fn above(tail: &[f64], half: f64) -> Option<CutOff> {
    let (low, count) = (tail[0] - half, tail.len());
    if tail[count - 1] == tail[0] {
        return None;
    }
    let mean = |of: fn(f64) -> f64| tail.iter().map(|x| of(x / low)).sum::<f64>() / count as f64;
    let means = [mean(f64::ln), mean(|y| y)];
    let law = CutoffDistribution::with_means(means, PossibleValues::new(tail[0], low))?;
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
    fn with_means(means: [f64; 2], values: PossibleValues) -> Option<Self> {
        let pure = Self::without_end(means[0], values);
        if pure.has_no_larger_mean(means[1]) {
            return Some(pure);
        }
        // Any start converges, since the log-likelihood of an exponential family is concave; this
        // one is of the right order.
        let mut law = Self { exponent: 1.5_f64.min(pure.exponent), rate: means[1].recip(), values };
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

    /// The maximum-likelihood estimate (Hill, 1975) without a cut-off, ξ = ∞, from the mean of u: Newton iteration on the
    /// log-likelihood, which is concave. For real numbers its start, τ = 1 + 1/⟨u⟩, is exact.
    fn without_end(mean: f64, values: PossibleValues) -> Self {
        let mut exponent = 1.0 + mean.recip();
        for _ in 0..ITERATIONS {
            let law = Self { exponent, rate: 0.0, values };
            let [whole, first, second] = law.sums_without_end(0);
            let expected = first / whole;
            let step = (expected - mean) / (second / whole - expected * expected);
            exponent = (exponent + step).max(0.5 * (1.0 + exponent));
            if step.abs() < 1e-13 * exponent {
                break;
            }
        }
        Self { exponent, rate: 0.0, values }
    }

    /// Whether a pure power law has a mean of y, at most this.
    fn has_no_larger_mean(self, mean: f64) -> bool {
        self.exponent > 2.0 && self.sums_without_end(1)[0] <= mean * self.sums_without_end(0)[0]
    }

    /// Integrals, or sums over integers, of uⁿ y^{`power` − τ} over y for n = 0, 1, 2, if `power` − τ is below −1.
    fn sums_without_end(self, power: i32) -> [f64; 3] {
        let decay = self.exponent - f64::from(power);
        let mut sums = [0.0; 3];
        for y in self.values.singles() {
            let (u, weight) = (y.ln(), self.values.spacing * y.powf(-decay));
            add(&mut sums, weight, [1.0, u, u * u]);
        }
        let (y, inverse) = (self.values.integrated_from(), (decay - 1.0).recip());
        let u = y.ln();
        let integrals = [1.0, u + inverse, u * u + 2.0 * inverse * (u + inverse)];
        add(&mut sums, y.powf(1.0 - decay) * inverse, integrals);
        let slopes = [-decay, 1.0 - decay * u, 2.0 * u - decay * u * u];
        add(&mut sums, self.values.correction() * y.powf(-decay - 1.0), slopes);
        sums
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
        let mut moments = [0.0; 6];
        for y in self.values.singles() {
            add(&mut moments, self.term(y), powers(y.ln()));
        }
        let y = self.values.integrated_from();
        let from = y.ln();
        // Derivatives by y of each of them.
        let slopes = [0.0, 1.0 / y, 1.0, 2.0 * from / y, from + 1.0, 2.0 * y];
        let density = self.values.correction() * self.density(from) / y;
        add(&mut moments, density * self.steepness(y), powers(from));
        add(&mut moments, density, slopes);
        for [from, to] in panels(from, self.end()) {
            for (n, moment) in moments.iter_mut().enumerate() {
                *moment += RULE.integrate(from, to, |u| self.density(u) * powers(u)[n]);
            }
        }
        Moments(moments)
    }

    /// The weight of one possible value y, in the unit of integrals over y.
    fn term(self, y: f64) -> f64 {
        self.values.spacing * self.density(y.ln()) / y
    }

    /// The logarithmic derivative of the density of y.
    fn steepness(self, y: f64) -> f64 {
        -self.exponent / y - self.rate
    }

    /// Kolmogorov–Smirnov distance to a sorted `tail` that begins at `low`.
    fn distance(self, tail: &[f64], low: f64, half: f64) -> f64 {
        let begin = self.values.integrated_from();
        // What sums have beyond their integrals up to y.
        let correction = |y: f64| self.values.correction() * self.density(y.ln()) / y * self.steepness(y);
        let integral = |from: f64, to: f64| -> f64 {
            let pieces = panels(from, to.min(self.end()));
            pieces.map(|[from, to]| RULE.integrate(from, to, |u| self.density(u))).sum()
        };
        let singles =
            |to: f64| -> f64 { self.values.singles().filter(|y| *y < to).map(|y| self.term(y)).sum() };
        let all = singles(f64::INFINITY) + correction(begin) + integral(begin.ln(), f64::INFINITY);
        let (mut from, mut integrated, mut largest) = (begin.ln(), 0.0, 0.0_f64);
        for knot in 1..=KNOTS.min(tail.len()) {
            let x = tail[knot * tail.len() / KNOTS.min(tail.len()) - 1];
            let y = (x + half) / low;
            let mut law = singles(y);
            if y > begin {
                integrated += integral(from, y.ln());
                from = from.max(y.ln());
                law += integrated + correction(begin) - correction(y);
            }
            let data = tail.partition_point(|&other| other <= x) as f64 / tail.len() as f64;
            largest = largest.max((law / all - data).abs());
        }
        largest
    }
}

/// Equal parts of an interval of u that are not wider than [`PANEL`].
fn panels(from: f64, to: f64) -> impl Iterator<Item = [f64; 2]> {
    let number = ((to - from) / PANEL).ceil().max(0.0);
    let width = (to - from) / number;
    (0..number as usize).map(move |i| [from + i as f64 * width, from + (i + 1) as f64 * width])
}

/// Adds a multiple of `terms` to `sums`.
fn add<const N: usize>(sums: &mut [f64; N], factor: f64, terms: [f64; N]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        *sum += factor * term;
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
        for (low, exponent, scale) in
            [(12, 0.6_f64, 7.0), (12, 1.3, 60.0), (1, 1.3, 60.0), (1, 2.2, 3.0), (3, 1.8, 30.0)]
        {
            // As many of each as the law has, so that the fit must give it back.
            let weight = |k: f64| k.powf(-exponent) * (-k / scale).exp();
            let whole: f64 = (low..4000).map(|k| weight(f64::from(k))).sum();
            let of = |k: i32| (4e6 * weight(f64::from(k)) / whole).round() as usize;
            let tail: Vec<f64> = (low..4000).flat_map(|k| std::iter::repeat_n(f64::from(k), of(k))).collect();
            let fit = above(&tail, 0.5).unwrap();
            // Half of the errors of four million data: of rounding, the rarest numbers are fewer by some tens.
            assert!((fit.exponent - exponent).abs() < 0.5 * fit.error, "{exponent} {fit:?}");
            assert!((fit.scale - scale).abs() < 0.5 * fit.scale_error, "{scale} {fit:?}");
            // A fifth of the distance 1/√n of four million draws: half of an error of the numbers moves it about that much.
            assert!(fit.distance < 1e-4, "{fit:?}");
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
        for low in [1, 12] {
            let mut whole = 0.0;
            let mut beyond = Vec::new();
            for k in (low..1_000_000).rev() {
                whole += f64::from(k).powf(-2.5);
                beyond.push(whole);
            }
            // How many are at least this large.
            let ranks: Vec<usize> = beyond.iter().map(|sum| (1e5 * sum / whole).round() as usize).collect();
            let sizes = ranks.windows(2).zip((low..999_999).rev());
            let mut tail: Vec<f64> =
                sizes.flat_map(|(n, k)| std::iter::repeat_n(f64::from(k), n[1] - n[0])).collect();
            tail.reverse();
            let fit = above(&[&tail[..], &[1e6]].concat(), 0.5).unwrap();
            assert_eq!((fit.scale, fit.scale_error), (f64::INFINITY, f64::INFINITY));
            // Ranks are rounded to one of 1e5, which moves the mean of ln x by less than a tenth of its error.
            assert!((fit.exponent - 2.5).abs() < 0.1 * fit.error, "{fit:?}");
        }
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
