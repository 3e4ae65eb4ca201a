//! A distribution whose logarithmic density is a sum of Gaussian kernels: any smooth shape between two ends.

use num_complex::Complex64;

use super::series::Series;
use super::{Breakpoint, Law, Parameter, SharedLaw, SurvivalDerivative, Zone, shared, unknown};
use crate::numerics::legendre::{NODES, RULE};
use crate::numerics::piecewise::Piecewise;
use crate::random::Stream;
use crate::{Error, Result};

/// p(x) = exp(Σ_i θ_i B_i(x))/Z between two ends and 0 outside, with kernels B_i(x) = exp(−((x − x_i)/h)²/2)/√(2π) at equal
/// distances h.
///
/// The kernels add up to 1 but for 2e^{−2π²} = 5e-9 (1.4e-4 at the ends, beyond which there are three more), and coefficients
/// that are values of a polynomial of second degree give that polynomial and a constant: they serve as B-splines do, with a
/// density that has all derivatives. The parameters are the coefficients θ_i, `coefficient_0`, `coefficient_1`, …; a constant
/// added to all of them changes nothing. A Gaussian has coefficients whose third differences are 0.
#[derive(Debug, Clone)]
pub struct LogKernels {
    ends: [f64; 2],
    coefficients: Vec<f64>,
    series: Series,
}

/// Smallest number of coefficients.
const FEWEST: usize = 2 * BEYOND + 4;

/// Kernels beyond either end.
const BEYOND: usize = 3;

/// How far below its maximum a logarithmic density is followed.
const DEEP: f64 = 50.0;

/// Before the number of a coefficient in the name of a parameter.
const COEFFICIENT: &str = "coefficient_";

impl LogKernels {
    /// The distribution between two ends with these coefficients, of which three at either side belong to kernels beyond the end.
    ///
    /// # Errors
    /// Ends that do not rise from 0 or above; fewer than 10 coefficients, or some that are not finite.
    pub fn new(ends: [f64; 2], coefficients: Vec<f64>) -> Result<Self> {
        let [low, high] = ends;
        if !(low >= 0.0 && high > low && high.is_finite()) {
            return Err(Error::invalid("ends", "two lengths, 0 or above, that rise", format!("{ends:?}")));
        }
        if coefficients.len() < FEWEST || coefficients.iter().any(|c| !c.is_finite()) {
            let expected = format!("{FEWEST} finite numbers or more");
            return Err(Error::invalid("coefficients", expected, format!("{coefficients:?}")));
        }
        let cells = cells(coefficients.len());
        let boundaries: Vec<f64> =
            (0..=cells).map(|k| low + (high - low) * (k as f64 / cells as f64)).collect();
        let logarithm = |place: f64| {
            let kernels = coefficients.iter().enumerate();
            kernels.map(|(i, coefficient)| coefficient * kernel(i, place)).sum::<f64>()
        };
        let logarithms: Vec<_> = (0..cells).map(|cell| places(cell).map(logarithm)).collect();
        let highest = logarithms.iter().flatten().fold(f64::NEG_INFINITY, |most: f64, l| most.max(*l));
        let density = logarithms.iter().map(|values| RULE.coefficients(&values.map(|l| (l - highest).exp())));
        let density = density.map(|cell| cell.to_vec()).collect::<Vec<_>>();
        let series = Series::new(&boundaries, &density, 0.0)?;
        Ok(Self { ends, coefficients, series })
    }

    /// The distribution with `count` coefficients near `law`, over `reach` standard deviations to both sides of the mean;
    /// where its density is below e^−50 of the largest, that.
    ///
    /// # Errors
    /// Those of [`Self::new`].
    pub fn near(law: &dyn Law, reach: f64, count: usize) -> Result<Self> {
        let (mean, std, count) = (law.mean(), law.std(), count.max(FEWEST));
        let ends = [(mean - reach * std).max(0.0), mean + reach * std];
        let width = (ends[1] - ends[0]) / cells(count) as f64;
        let place = |i: usize| ends[0] + (i as f64 - BEYOND as f64) * width;
        let values: Vec<f64> = (0..count).map(|i| law.density(place(i)).ln()).collect();
        let highest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self::new(ends, values.into_iter().map(|value| value.max(highest - DEEP)).collect())
    }

    /// The coefficients θ_i.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// The middle x_i of a kernel.
    pub fn place(&self, number: usize) -> f64 {
        let [low, high] = self.ends;
        low + (number as f64 - BEYOND as f64) * (high - low) / cells(self.coefficients.len()) as f64
    }

    /// The same distribution as a series of Legendre polynomials on each cell.
    pub fn series(&self) -> &Series {
        &self.series
    }

    /// B_i(x) of all coefficients.
    pub fn kernels(&self, x: f64) -> Vec<f64> {
        let [low, high] = self.ends;
        let place = (x - low) / (high - low) * cells(self.coefficients.len()) as f64;
        (0..self.coefficients.len()).map(|i| kernel(i, place)).collect()
    }

    /// ∫_x^∞ p B_i dξ.
    fn weighted(&self, number: usize) -> Piecewise {
        let boundaries = self.series.boundaries();
        let cell = |cell: usize| {
            let (middle, half) = (
                0.5 * (boundaries[cell] + boundaries[cell + 1]),
                0.5 * (boundaries[cell + 1] - boundaries[cell]),
            );
            let mut values = [0.0; NODES];
            for ((value, t), place) in values.iter_mut().zip(&RULE.nodes).zip(places(cell)) {
                *value = self.series.density(middle + half * t) * kernel(number, place);
            }
            RULE.coefficients(&values)
        };
        let coefficients = (0..boundaries.len() - 1).map(cell).collect();
        Piecewise { boundaries: boundaries.to_vec(), coefficients }.integrated_from_end(0.0, &[])
    }

    /// The number of a coefficient by its name.
    fn number(&self, name: &str) -> Result<usize> {
        let number = name.strip_prefix(COEFFICIENT).and_then(|number| number.parse().ok());
        number.filter(|number| *number < self.coefficients.len()).ok_or_else(|| unknown(self, name))
    }
}

/// Number of cells for this many coefficients.
fn cells(count: usize) -> usize {
    count - 2 * BEYOND - 1
}

/// The Gauss points of a cell, in cells from the lower end.
fn places(cell: usize) -> [f64; NODES] {
    RULE.nodes.map(|t| cell as f64 + 0.5 * (1.0 + t))
}

/// B_i at `place`, in cells from the lower end.
fn kernel(number: usize, place: f64) -> f64 {
    let distance = place - (number as f64 - BEYOND as f64);
    (-0.5 * distance * distance).exp() / std::f64::consts::TAU.sqrt()
}

impl Law for LogKernels {
    fn name(&self) -> &'static str {
        "log_kernels"
    }

    fn parameters(&self) -> Vec<Parameter> {
        let named =
            |(i, &value): (usize, &f64)| Parameter { name: format!("{COEFFICIENT}{i}").into(), value };
        self.coefficients.iter().enumerate().map(named).collect()
    }

    fn with_parameter(&self, name: &str, value: f64) -> Result<SharedLaw> {
        self.with_parameters(&[(name, value)])
    }

    /// At once: a distribution is made only of all of them.
    fn with_parameters(&self, values: &[(&str, f64)]) -> Result<SharedLaw> {
        let mut coefficients = self.coefficients.clone();
        for (name, value) in values {
            coefficients[self.number(name)?] = *value;
        }
        shared(Self::new(self.ends, coefficients))
    }

    /// ∂S/∂θ_i = ∫_x^∞ p B_i dξ − S ∫ p B_i dξ.
    fn survival_derivative(&self, name: &str) -> Result<SurvivalDerivative> {
        let above = self.weighted(self.number(name)?);
        let (whole, series, low) = (above.value(self.ends[0]), self.series.clone(), self.ends[0]);
        Ok(Box::new(move |x| above.value(x.max(low)) - series.survival(x) * whole))
    }

    fn density(&self, x: f64) -> f64 {
        self.series.density(x)
    }

    fn survival(&self, x: f64) -> f64 {
        self.series.survival(x)
    }

    fn ln_survival(&self, x: f64) -> f64 {
        self.series.ln_survival(x)
    }

    fn cumulative(&self, x: f64) -> f64 {
        self.series.cumulative(x)
    }

    fn hazard(&self, x: f64) -> f64 {
        self.series.hazard(x)
    }

    fn quantile(&self, p: f64) -> f64 {
        self.series.quantile(p)
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        self.series.upper_quantile(q)
    }

    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        self.series.upper_moment(order, x)
    }

    fn std(&self) -> f64 {
        self.series.std()
    }

    fn breakpoints(&self) -> Vec<Breakpoint> {
        self.series.breakpoints()
    }

    fn zones(&self) -> Vec<Zone> {
        self.series.zones()
    }

    fn seams(&self) -> Vec<f64> {
        self.series.seams()
    }

    fn laplace_is_closed(&self) -> bool {
        self.series.laplace_is_closed()
    }

    fn laplace(&self, s: Complex64) -> Complex64 {
        self.series.laplace(s)
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        self.series.fill(stream, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Gaussian;

    #[test]
    fn a_gaussian_is_one_to_its_ends() {
        let gaussian = Gaussian::new(1.0, 0.1).unwrap();
        let law = LogKernels::near(&gaussian, 8.0, 40).unwrap();
        for k in 0..=40 {
            let x = 0.6 + 0.02 * f64::from(k);
            // 5e-9 of coefficients down to −36.
            assert!((law.survival(x) - gaussian.survival(x)).abs() < 1e-7, "{x}");
            assert!((law.density(x) / gaussian.density(x) - 1.0).abs() < 1e-5, "{x}");
        }
        assert!(law.breakpoints().iter().all(|b| b.amplitude.abs() < 1e-9), "{:?}", law.breakpoints());
    }

    #[test]
    fn derivatives_of_the_survival_are_its_differences() {
        let coefficients = [-9.0, -5.0, -3.0, -1.0, 0.5, 0.2, 0.9, -0.5, -2.0, -4.0, -8.0].to_vec();
        let law = LogKernels::new([0.4, 1.9], coefficients.clone()).unwrap();
        for i in 0..coefficients.len() {
            let name = format!("coefficient_{i}");
            let closed = law.survival_derivative(&name).unwrap();
            let step = 1e-4;
            let [above, below] =
                [step, -step].map(|d| law.with_parameter(&name, coefficients[i] + d).unwrap());
            for k in 0..=20 {
                let x = 0.3 + 0.085 * f64::from(k);
                let difference = (above.survival(x) - below.survival(x)) / (2.0 * step);
                // The third derivative times the square of the step, 1e-9, and rounding over the step.
                assert!((closed(x) - difference).abs() < 1e-8, "{name} at {x}: {} {difference}", closed(x));
            }
        }
        assert!(law.survival_derivative("mean").is_err());
    }
}
