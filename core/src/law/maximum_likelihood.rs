//! The member of a parametric family under which a sample is most likely.

use super::incomplete_gamma::ln_minus_digamma;
use super::{Gaussian, Law as _, not_negative, positive, range};
use crate::monitor::{Monitor, Watch};
use crate::numerics::roots::brent_root;
use crate::{Error, Result};

/// Values after which the monitor is asked, in some milliseconds.
const PIECE: usize = 1 << 16;

/// Relative tolerance of shapes.
const TOLERANCE: f64 = 1e-14;

/// The maximum-likelihood estimate of the parameters of a family, by its name in a scenario, from a sample of values ≥ 0;
/// in the order in which they are declared.
///
/// Gaussian distributions are truncated at 0: their mean and variance after truncation are those of the sample, as far
/// as the mean before truncation is not below 0. The gamma shape k solves ln k − ψ(k) = ln x̄ − ⟨ln x⟩, the Weibull shape
/// ⟨xᵏ ln x⟩/⟨xᵏ⟩ − 1/k = ⟨ln x⟩ (N. L. Johnson, S. Kotz and N. Balakrishnan, Continuous Univariate Distributions, vol. 1,
/// 1994); all others are closed.
///
/// # Errors
/// No value, one that is below 0 or not finite (or 0, for a density that vanishes or diverges there); values that are all
/// equal, except for a point mass, which needs them; a family without parameters.
pub fn maximum_likelihood(family: &str, samples: &[f64]) -> Result<Vec<f64>> {
    maximum_likelihood_with(family, samples, &mut ())
}

/// The same with a monitor.
///
/// # Errors
/// Those of [`maximum_likelihood`]; stopped by the monitor.
pub fn maximum_likelihood_with(family: &str, samples: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
    if samples.is_empty() {
        return Err(Error::invalid("samples", "at least one sample", 0));
    }
    let from_zero = matches!(family, "gaussian" | "rectangular" | "point" | "exponential");
    let check = if from_zero { not_negative } else { positive };
    samples.iter().try_for_each(|&x| check("samples", x).map(drop))?;
    let (lowest, highest) = samples.iter().fold((f64::INFINITY, 0.0), |(a, b), &x| (x.min(a), x.max(b)));
    // Squares of the values are numbers.
    [lowest, highest].iter().try_for_each(|&x| range::length_or_zero("samples", x).map(drop))?;
    let watch = &Watch::new(monitor);
    let sample = Sample { values: samples, mean: mean(samples, |x| x, watch)?, highest, watch };
    let equal = lowest == highest;
    match family {
        "point" if equal => return Ok(vec![lowest]),
        "point" => {
            return Err(Error::invalid(
                "samples",
                "equal values for a point mass",
                format!("{lowest} to {highest}"),
            ));
        }
        "exponential" => return positive("samples", sample.mean).map(|mean| vec![mean]),
        _ if equal => return Err(Error::invalid("samples", "values that differ", format!("only {lowest}"))),
        _ => {}
    }
    let found = match family {
        "gaussian" => sample.gaussian(),
        "rectangular" => Ok(vec![lowest, highest]),
        "lognormal" => sample.lognormal(),
        "gamma" => sample.gamma(),
        "weibull" => sample.weibull(),
        _ => Err(Error::invalid("family", "a distribution with parameters", family)),
    }?;
    if found.iter().all(|value| value.is_finite()) { Ok(found) } else { Err(unbounded("finite parameters")) }
}

fn mean(values: &[f64], f: impl Fn(f64) -> f64, watch: &Watch<'_>) -> Result<f64> {
    let mut sum = 0.0;
    for piece in values.chunks(PIECE) {
        sum = piece.iter().fold(sum, |sum, &x| sum + f(x));
        watch.check()?;
    }
    Ok(sum / values.len() as f64)
}

fn unbounded(what: &str) -> Error {
    Error::invalid("samples", "values that differ by more than rounding", format!("ones without {what}"))
}

struct Sample<'a, 'm> {
    values: &'a [f64],
    mean: f64,
    highest: f64,
    watch: &'a Watch<'m>,
}

impl Sample<'_, '_> {
    fn average(&self, f: impl Fn(f64) -> f64) -> Result<f64> {
        mean(self.values, f, self.watch)
    }

    fn std(&self) -> Result<f64> {
        self.average(|x| (x - self.mean).powi(2)).map(f64::sqrt)
    }

    /// Mean and standard deviation before truncation, from the coefficient of variation after it, which falls from √(π/2 −
    /// 1) for a mean of 0.
    fn gaussian(&self) -> Result<Vec<f64>> {
        let std = self.std()?;
        let width = std / self.mean;
        range::width(self.mean, std).map_err(|_| unbounded("a width that numbers resolve"))?;
        let excess = |alpha: f64| {
            let law = Gaussian::new(alpha, 1.0).expect("a mean of 0 or above");
            law.std() / law.mean() - width
        };
        let half_normal = excess(0.0) <= 0.0;
        if half_normal {
            return Ok(vec![0.0, self.average(|x| x * x)?.sqrt()]);
        }
        // Truncation narrows the distribution and raises its mean.
        let Some(alpha) = brent_root(excess, 0.0, 1.0 / width, TOLERANCE / width) else {
            return Ok(vec![self.mean, std]);
        };
        let std = self.mean / Gaussian::new(alpha, 1.0).expect("a mean of 0 or above").mean();
        Ok(vec![alpha * std, std])
    }

    fn lognormal(&self) -> Result<Vec<f64>> {
        let place = self.average(f64::ln)?;
        let variance = self.average(|x| (x.ln() - place).powi(2))?;
        let mean = (place + 0.5 * variance).exp();
        Ok(vec![mean, mean * variance.exp_m1().sqrt()])
    }

    fn gamma(&self) -> Result<Vec<f64>> {
        // ln x̄ − ⟨ln x⟩ without the cancellation of narrow distributions.
        let level = -self.average(|x| ((x - self.mean) / self.mean).ln_1p())?;
        // 1/2k < ln k − ψ(k) < 1/k.
        let (low, high) = ((0.5 / level).ln() - 1.0, (1.0 / level).ln() + 1.0);
        let excess = |ln_shape: f64| (ln_minus_digamma(ln_shape.exp()) / level).ln();
        let ln_shape = brent_root(excess, low, high, TOLERANCE).ok_or_else(|| unbounded("a finite shape"))?;
        Ok(vec![self.mean, self.mean * (-0.5 * ln_shape).exp()])
    }

    fn weibull(&self) -> Result<Vec<f64>> {
        let mut logs = Vec::with_capacity(self.values.len());
        for piece in self.values.chunks(PIECE) {
            logs.extend(piece.iter().map(|x| (x / self.highest).ln()));
            self.watch.check()?;
        }
        let average = |f: &dyn Fn(f64) -> f64| mean(&logs, f, self.watch);
        let place = average(&|l| l)?;
        // Rises from −∞ to that of the highest value, −place.
        let excess = |ln_shape: f64| -> Result<f64> {
            let shape = ln_shape.exp();
            let powers = |l: f64| (shape * l).exp();
            Ok(average(&|l| l * powers(l))? / average(&powers)? - 1.0 / shape - place)
        };
        // The shape of a distribution of logarithms with this standard deviation is π/(√6 std).
        let guess = -average(&|l| (l - place).powi(2))?.sqrt().ln();
        // Where the monitor stops the work, the search ends at a value of 0.
        let stopped_or = |ln_shape: f64| excess(ln_shape).unwrap_or(0.0);
        let found = brent_root(stopped_or, guess - 5.0, guess + 5.0, TOLERANCE);
        self.watch.check()?;
        let shape = found.ok_or_else(|| unbounded("a finite shape"))?.exp();
        let scale = self.highest * (average(&|l| (shape * l).exp())?.ln() / shape).exp();
        Ok(vec![shape, scale])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Exponential, Gamma, Lognormal, SharedLaw, Weibull, shared};
    use crate::random::{Purpose, Stream};

    fn likelihood(law: &SharedLaw, samples: &[f64]) -> f64 {
        samples.iter().map(|&x| law.ln_density(x)).sum()
    }

    /// The likelihood is highest at the estimate: lower at parameters moved either way, and not below that of the
    /// distribution that was sampled.
    #[test]
    fn it_is_a_maximum() {
        let laws = [
            shared(Gaussian::new(1.0, 0.01)),
            shared(Gaussian::new(1.0, 0.7)),
            shared(Gaussian::new(0.0, 0.7)),
            shared(Gamma::new(1.0, 0.01)),
            shared(Gamma::new(1.0, 1.7)),
            shared(Lognormal::new(1.0, 0.01)),
            shared(Lognormal::new(1.0, 1.7)),
            shared(Exponential::new(2.0)),
            shared(Weibull::new(0.6, 1.0)),
            shared(Weibull::new(100.0, 1.0)),
        ];
        for truth in laws.map(Result::unwrap) {
            let mut samples = vec![0.0; 400];
            truth.fill(&mut Stream::new(5, Purpose::Sample, 0), &mut samples);
            let found = maximum_likelihood(truth.name(), &samples).unwrap();
            let parameters = truth.parameters();
            assert_eq!(parameters.len(), found.len());
            let member = |values: &[f64]| {
                let named: Vec<(&str, f64)> =
                    parameters.iter().map(|parameter| &*parameter.name).zip(values.iter().copied()).collect();
                truth.with_parameters(&named)
            };
            let best = likelihood(&member(&found).unwrap(), &samples);
            // Roundings of 400 logarithms.
            let slack = 1e-9 * best.abs().max(1.0);
            assert!(best >= likelihood(&truth, &samples) - slack, "{truth:?}");
            for moved in 0..found.len() {
                for factor in [0.999, 1.001] {
                    let mut other = found.clone();
                    other[moved] *= factor;
                    assert!(likelihood(&member(&other).unwrap(), &samples) <= best + slack, "{truth:?}");
                }
            }
        }
    }

    #[test]
    fn bad_samples_are_refused() {
        let message = |family, samples: &[f64]| maximum_likelihood(family, samples).unwrap_err().to_string();
        assert!(message("gamma", &[]).contains("samples"));
        assert!(message("gamma", &[0.0, 1.0]).contains("samples"));
        assert!(message("gaussian", &[1.0, 1.0]).contains("differ"));
        assert!(message("point", &[1.0, 2.0]).contains("equal"));
        assert!(message("series", &[1.0, 2.0]).contains("family"));
        assert_eq!(maximum_likelihood("point", &[2.0, 2.0]).unwrap(), [2.0]);
        assert_eq!(maximum_likelihood("rectangular", &[0.7, 0.5, 1.5]).unwrap(), [0.5, 1.5]);
        // Narrow to the last digits: refused or right, never a panic.
        let _ = maximum_likelihood("weibull", &[1.0, 1.0 + f64::EPSILON]);
        let _ = maximum_likelihood("gamma", &[1.0, 1.0 + f64::EPSILON]);
    }
}
