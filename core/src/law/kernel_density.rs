//! Kernel density estimates: a smooth distribution from a sample of any size.

use super::{Point, Series, SharedLaw, not_negative, positive, shared};
use crate::monitor::{Monitor, Part, report, report_at};
use crate::numerics::legendre::{Nodal, RULE};
use crate::numerics::piecewise::Piecewise;
use crate::numerics::sorting::sorted;
use crate::{Error, Result};

/// The kernels vanish at this many bandwidths: 3e-18 of their maximum.
const REACH: f64 = 9.0;

/// Width of a cell in bandwidths: 16 terms represent a kernel to rounding, relative to its lowest value on the cell, also at
/// nine bandwidths, where it changes by a factor of 80 over this width. Lives of contacts need these digits.
const CELL: f64 = 0.5;

/// Narrowest kernels and samples, relative to the highest value.
const NARROWEST: f64 = 1e-9;

/// Largest number of cells.
const MOST_CELLS: usize = 20_000;

/// Terms of the expansion of the kernels of a group around its middle.
const TERMS: usize = 16;

/// Half the width of a group in bandwidths: 16 terms of its expansion leave 3e-13 of a kernel at nine bandwidths, far
/// less nearer to it.
const HALF_GROUP: f64 = 0.125;

/// The exponential underflows beyond this many bandwidths.
const UNDERFLOW: f64 = 38.6;

/// The kernel density estimate of a sample x_i of n values ≥ 0, in any order: p(x) = Σ_i \[φ_h(x − c_i) + φ_h(x +
/// c_i)\]/n for x ≥ 0, where φ_h is the normal density of standard deviation h.
///
/// The centres are c_i = m + λ(x_i − m) and the width is h = λb, with the `bandwidth` b, the mean m and the standard
/// deviation s (divisor n) of the sample, and λ = 1/√(1 + b²/s²). The estimate has the mean and the standard deviation of
/// the sample as long as no value is within nine bandwidths of 0, while an estimate without λ is wider than the sample (M.
/// C. Jones, "On correcting for variance inflation in kernel density estimation", Comput. Stat. Data Anal. 11, 3, 1991).
/// The second kernel reflects the estimate at 0, so that a density that does not vanish there is not halved.
///
/// Without a bandwidth it is that of B. W. Silverman (Density Estimation for Statistics and Data Analysis, 1986, Eq. 3.31),
/// b = 0.9 min(s, IQR/1.34) n^(−1/5), with the distance IQR of the quartiles (where it is 0, s alone). Sums of kernels are
/// computed by the fast Gauss transform (L. Greengard and J. Strain, SIAM J. Sci. Stat. Comput. 12, 79, 1991), and
/// represented by a [`Series`] to rounding. Equal values only become a point mass.
///
/// # Errors
/// No value, one that is below 0 or not finite; a bandwidth that is not above 0 and finite; values that differ by less
/// than 1e-9 of the highest, or are so far apart in bandwidths that the series has more than twenty thousand cells.
pub fn kernel_density(samples: &[f64], bandwidth: Option<f64>) -> Result<SharedLaw> {
    kernel_density_with(samples, bandwidth, &mut ())
}

/// The same with a monitor.
///
/// # Errors
/// Those of [`kernel_density`]; stopped by the monitor.
pub fn kernel_density_with(
    samples: &[f64],
    bandwidth: Option<f64>,
    monitor: &mut dyn Monitor,
) -> Result<SharedLaw> {
    if samples.is_empty() {
        return Err(Error::invalid("samples", "at least one sample", 0));
    }
    samples.iter().try_for_each(|&x| not_negative("samples", x).map(drop))?;
    let bandwidth = bandwidth.map(|b| positive("bandwidth", b)).transpose()?;
    let sorted = sorted(samples, &mut Part::new(monitor, 0.0, 0.4))?;
    let sample = SampleMoments::of(&sorted, &mut Part::new(monitor, 0.4, 0.1))?;
    if sorted[0] == sorted[sorted.len() - 1] {
        return shared(Point::new(sorted[0]));
    }
    let bandwidth = bandwidth.unwrap_or_else(|| silverman(&sorted, sample.std));
    let highest = sorted[sorted.len() - 1];
    if !(sample.std.is_finite() && bandwidth.min(sample.std) > NARROWEST * highest) {
        let expected =
            format!("values up to 1e150 that differ by more than {NARROWEST:e} of them, or equal ones");
        return Err(Error::invalid("samples", expected, format!("{} to {highest}", sorted[0])));
    }
    let estimate = Kernels::new(&sorted, &sample, bandwidth, &mut Part::new(monitor, 0.5, 0.4))?;
    let boundaries = estimate.boundaries(&mut Part::new(monitor, 0.9, 0.01))?;
    let coefficients = estimate.cells(&boundaries, &mut Part::new(monitor, 0.91, 0.04))?;
    shared(Series::scaled(Piecewise { boundaries, coefficients }, 0.0, &mut Part::new(monitor, 0.95, 0.05)))
}

/// Mean and standard deviation.
struct SampleMoments {
    mean: f64,
    std: f64,
}

impl SampleMoments {
    /// # Errors
    /// Stopped by the monitor.
    fn of(sorted: &[f64], monitor: &mut dyn Monitor) -> Result<Self> {
        let mut average = |part: f64, f: &dyn Fn(f64) -> f64| {
            let mut sum = 0.0;
            for (i, &x) in sorted.iter().enumerate() {
                report_at(&mut Part::new(monitor, part, 0.5), i, sorted.len())?;
                sum += f(x);
            }
            Ok(sum / sorted.len() as f64)
        };
        let mean = average(0.0, &|x| x)?;
        let std = average(0.5, &|x| (x - mean).powi(2))?.sqrt();
        Ok(Self { mean, std })
    }
}

/// Silverman's bandwidth of a sorted sample.
fn silverman(sorted: &[f64], std: f64) -> f64 {
    let quartiles = (quantile(sorted, 0.75) - quantile(sorted, 0.25)) / 1.34;
    let spread = if quartiles > 0.0 { std.min(quartiles) } else { std };
    0.9 * spread * (sorted.len() as f64).powf(-0.2)
}

/// The quantile of a sorted sample, linear between its values.
fn quantile(sorted: &[f64], p: f64) -> f64 {
    let place = p * (sorted.len() - 1) as f64;
    let (below, above) = (sorted[place as usize], sorted[place.ceil() as usize]);
    below + place.fract() * (above - below)
}

/// A sum of normal kernels of one width.
struct Kernels {
    bandwidth: f64,
    width: f64,
    centres: Vec<f64>,
    groups: Vec<Group>,
    /// What makes the integral of the sum 1.
    factor: f64,
}

/// Kernels whose centres lie close together: Σ_i e^{−(x − c_i)²/2h²} = e^{−y²/2} Σ_k a_k He_k(y), where y = (x − middle)/h
/// and a_k = Σ_i ((c_i − middle)/h)^k/k!.
struct Group {
    middle: f64,
    terms: [f64; TERMS],
}

impl Kernels {
    /// Groups of the kernels.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn new(
        sorted: &[f64],
        sample: &SampleMoments,
        bandwidth: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let shrink = 1.0 / (bandwidth / sample.std).hypot(1.0);
        let width = shrink * bandwidth;
        let mut centres = Vec::with_capacity(sorted.len());
        let mut groups: Vec<Group> = Vec::new();
        for (i, x) in sorted.iter().enumerate() {
            report_at(monitor, i, sorted.len())?;
            let centre = sample.mean + shrink * (x - sample.mean);
            centres.push(centre);
            if groups.last().is_none_or(|group| centre - group.middle > HALF_GROUP * width) {
                groups.push(Group { middle: centre + HALF_GROUP * width, terms: [0.0; TERMS] });
            }
            let group = groups.last_mut().expect("the group of this centre");
            group.add((centre - group.middle) / width);
        }
        let factor = 1.0 / (std::f64::consts::TAU.sqrt() * width * sorted.len() as f64);
        Ok(Self { bandwidth, width, centres, groups, factor })
    }

    /// The estimate at x ≥ 0.
    fn density(&self, x: f64) -> f64 {
        (self.factor * (self.sum(x) + self.sum(-x))).max(0.0)
    }

    fn sum(&self, x: f64) -> f64 {
        let from = self.groups.partition_point(|group| group.middle < x - UNDERFLOW * self.width);
        let near = self.groups[from..].iter().take_while(|group| group.middle < x + UNDERFLOW * self.width);
        near.map(|group| group.sum((x - group.middle) / self.width)).sum()
    }

    /// The series of the estimate on a cell.
    fn series(&self, low: f64, high: f64) -> Nodal {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        RULE.coefficients(&RULE.nodes.map(|t| self.density(middle + half * t)))
    }

    /// The series of the estimate on all cells.
    ///
    /// # Errors
    /// Stopped by the monitor.
    fn cells(&self, boundaries: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<Nodal>> {
        let of = |(i, ends): (usize, &[f64])| {
            report(monitor, i as f64 / boundaries.len() as f64)?;
            Ok(self.series(ends[0], ends[1]))
        };
        boundaries.windows(2).enumerate().map(of).collect()
    }

    /// Boundaries of cells that resolve every kernel, and of the gaps between kernels that are far apart.
    ///
    /// # Errors
    /// More cells than there may be; stopped by the monitor.
    fn boundaries(&self, monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        let (reach, cell) = (REACH * self.width, CELL * self.width);
        let mut boundaries = vec![(self.centres[0] - reach).max(0.0)];
        let mut start = boundaries[0];
        for (i, &centre) in self.centres.iter().enumerate() {
            report_at(monitor, i, self.centres.len())?;
            let end = centre + reach;
            let next = self.centres.get(i + 1).map(|next| next - reach);
            if next.is_some_and(|next| next <= end + cell) {
                continue;
            }
            let count = ((end - start) / cell).ceil();
            if boundaries.len() as f64 + count > MOST_CELLS as f64 {
                let range = self.centres[self.centres.len() - 1] - self.centres[0];
                let expected = format!("one that is not so small beside the range of the sample, {range}");
                return Err(Error::invalid("bandwidth", expected, self.bandwidth));
            }
            boundaries.extend((1..=count as usize).map(|k| start + (end - start) * (k as f64 / count)));
            boundaries.extend(next);
            start = next.unwrap_or(end);
        }
        Ok(boundaries)
    }
}

impl Group {
    fn add(&mut self, offset: f64) {
        let mut term = 1.0;
        for (k, sum) in self.terms.iter_mut().enumerate() {
            *sum += term;
            term *= offset / (k + 1) as f64;
        }
    }

    /// The sum at y, by the recurrence He_{k+1} = y He_k − k He_{k−1}.
    fn sum(&self, y: f64) -> f64 {
        let (mut sum, mut before, mut here) = (0.0, 0.0, 1.0);
        for (k, term) in self.terms.iter().enumerate() {
            sum += term * here;
            (before, here) = (here, y * here - k as f64 * before);
        }
        sum * (-0.5 * y * y).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Gamma, Law};
    use crate::random::{Purpose, Stream};

    fn sample(count: usize) -> Vec<f64> {
        let mut values = vec![0.0; count];
        Gamma::new(1.0, 0.2).unwrap().fill(&mut Stream::new(3, Purpose::Sample, 0), &mut values);
        values
    }

    /// The sum of the kernels itself, term by term.
    fn direct(samples: &[f64], bandwidth: f64, x: f64) -> f64 {
        let n = samples.len() as f64;
        let mean = samples.iter().sum::<f64>() / n;
        let variance = samples.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
        let shrink = (1.0 + bandwidth * bandwidth / variance).sqrt().recip();
        let normal = |u: f64| (-0.5 * u * u).exp() / (std::f64::consts::TAU.sqrt() * shrink * bandwidth);
        let kernel = |c: f64| normal((x - c) / (shrink * bandwidth)) + normal((x + c) / (shrink * bandwidth));
        samples.iter().map(|x| kernel(mean + shrink * (x - mean))).sum::<f64>() / n
    }

    #[test]
    fn it_is_the_sum_of_its_kernels() {
        for (samples, bandwidth) in [
            (sample(300), 0.06),
            (vec![1.0, 1.25], 0.1),
            // Kernels far apart, and some that reach below 0.
            (vec![0.01, 0.2, 0.9, 7.0, 7.01], 0.05),
        ] {
            let law = kernel_density(&samples, Some(bandwidth)).unwrap();
            let most = (0..400).map(|i| direct(&samples, bandwidth, 0.02 * f64::from(i))).fold(0.0, f64::max);
            for i in 0..400 {
                let x = 0.02 * f64::from(i);
                // Truncation of the series, and of the expansion of the kernels.
                assert!((law.density(x) - direct(&samples, bandwidth, x)).abs() < 1e-12 * most, "{x}");
            }
        }
    }

    #[test]
    fn mean_and_std_are_those_of_the_sample() {
        for count in [2, 10, 500, 100_000] {
            let samples = sample(count);
            let sample = SampleMoments::of(&samples, &mut ()).unwrap();
            let law = kernel_density(&samples, None).unwrap();
            // The truncation error of the series, and what the kernels lose at nine bandwidths.
            assert!((law.mean() / sample.mean - 1.0).abs() < 1e-12, "{count}");
            assert!((law.std() / sample.std - 1.0).abs() < 1e-11, "{count}");
            assert_eq!(law.breakpoints(), [], "{count}");
        }
    }

    #[test]
    fn it_approaches_the_distribution_of_the_sample() {
        // The largest distance of the distribution functions is that of the sample, of order 0.6/√n (Kolmogorov), and
        // the bias of the kernels, of order h² = n^(−2/5) of the width.
        let gamma = Gamma::new(1.0, 0.2).unwrap();
        for (count, bound) in [(100, 0.1), (10_000, 0.012)] {
            let law = kernel_density(&sample(count), None).unwrap();
            let apart =
                |i: i32| (law.survival(0.01 * f64::from(i)) - gamma.survival(0.01 * f64::from(i))).abs();
            assert!((0..300).map(apart).fold(0.0, f64::max) < bound, "{count}");
        }
    }

    #[test]
    fn bad_samples_are_refused() {
        let message = |samples: &[f64], b| kernel_density(samples, b).unwrap_err().to_string();
        assert!(message(&[], None).contains("samples"));
        assert!(message(&[1.0, f64::NAN], None).contains("samples"));
        assert!(message(&[-1.0, 1.0], None).contains("samples"));
        assert!(message(&[1.0, 2.0], Some(0.0)).contains("bandwidth"));
        let wide: Vec<f64> = (0..4000).map(f64::from).collect();
        assert!(message(&wide, Some(1e-3)).contains("bandwidth"));
        assert!(message(&[1e300, 2e300], None).contains("samples"));
        assert!(message(&[0.0, 5e-324], None).contains("samples"));
        assert!(message(&[1.0, 1.0 + 1e-14], None).contains("samples"));
        assert_eq!(kernel_density(&[0.3, 0.3], None).unwrap().name(), "point");
    }
}
