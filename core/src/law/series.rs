//! The law of a density that has been solved for: Legendre series on cells.

use num_complex::Complex64;

use super::{Break, Law, Parameter, SharedLaw, Zone, crossing, unknown};
use crate::Result;
use crate::numerics::legendre::RULE;
use crate::numerics::piecewise::Piecewise;
use crate::random::Stream;

/// Moments kept above each cell, the mass among them.
const MOMENTS: usize = 5;

/// A density given cell by cell, scaled to total mass 1. It is as accurate as it was solved for; moments of higher order
/// than 4 are sums over all cells above.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    density: Piecewise,
    breaks: Vec<Break>,
    resolution: f64,
    /// Moments of what is above each cell.
    above: Vec<[f64; MOMENTS]>,
    /// Mass below each cell.
    below: Vec<f64>,
}

impl Series {
    /// The law of a `density` that is nowhere below 0, not smooth at `breaks`, and varies on the length `resolution`.
    pub fn new(mut density: Piecewise, breaks: Vec<Break>, resolution: f64) -> Self {
        let total = density.integral();
        density.coefficients.iter_mut().flatten().for_each(|c| *c /= total);
        let cells = density.coefficients.len();
        let mass = |cell: usize| 2.0 * density.cell(cell).1 * density.coefficients[cell][0];
        let below =
            (0..cells).scan(0.0, |sum, cell| Some(std::mem::replace(sum, *sum + mass(cell)))).collect();
        let mut law = Self { density, breaks, resolution, above: vec![[0.0; MOMENTS]; cells], below };
        for cell in (1..cells).rev() {
            let start = law.density.boundaries[cell];
            law.above[cell - 1] =
                std::array::from_fn(|n| law.above[cell][n] + law.moment(cell, start, n as u32));
        }
        law
    }

    /// ∫ξⁿp from x to the end of a cell.
    fn moment(&self, cell: usize, x: f64, order: u32) -> f64 {
        let end = self.density.boundaries[cell + 1];
        RULE.integrate(x, end, |x| x.powi(order as i32) * self.density.value_in(cell, x))
    }

    /// P(ξ ≤ x).
    fn mass_below(&self, x: f64) -> f64 {
        let Some(cell) = self.density.find(x) else { return if x < self.density.end() { 0.0 } else { 1.0 } };
        let start = self.density.boundaries[cell];
        self.below[cell] + RULE.integrate(start, x, |x| self.density.value_in(cell, x))
    }
}

impl Law for Series {
    fn name(&self) -> &'static str {
        "series"
    }

    fn parameters(&self) -> Vec<Parameter> {
        Vec::new()
    }

    fn with_parameter(&self, name: &str, _value: f64) -> Result<SharedLaw> {
        Err(unknown(self, name))
    }

    fn density(&self, x: f64) -> f64 {
        self.density.value(x).max(0.0)
    }

    fn survival(&self, x: f64) -> f64 {
        self.upper_moment(0, x).clamp(0.0, 1.0)
    }

    fn ln_survival(&self, x: f64) -> f64 {
        let below = self.mass_below(x);
        if below < 0.5 { (-below.max(0.0)).ln_1p() } else { self.survival(x).ln() }
    }

    fn cumulative(&self, x: f64) -> f64 {
        self.mass_below(x).clamp(0.0, 1.0)
    }

    fn hazard(&self, x: f64) -> f64 {
        let survival = self.survival(x);
        if survival > 0.0 { self.density(x) / survival } else { f64::INFINITY }
    }

    fn quantile(&self, p: f64) -> f64 {
        if p >= 1.0 { self.density.end() } else { crossing(|x| self.ln_survival(x), (-p).ln_1p()) }
    }

    fn upper_quantile(&self, q: f64) -> f64 {
        crossing(|x| self.ln_survival(x), q.ln()).min(self.density.end())
    }

    fn upper_moment(&self, order: u32, x: f64) -> f64 {
        let Some(cell) = self.density.find(x.max(self.density.start())) else { return 0.0 };
        let here = self.moment(cell, x.max(self.density.boundaries[cell]), order);
        let known = self.above[cell].get(order as usize);
        let above = |cell: usize| self.moment(cell, self.density.boundaries[cell], order);
        here + known.copied().unwrap_or_else(|| (cell + 1..self.below.len()).map(above).sum())
    }

    fn std(&self) -> f64 {
        let mean = self.mean();
        let square = |cell: usize| {
            let (low, high) = (self.density.boundaries[cell], self.density.boundaries[cell + 1]);
            RULE.integrate(low, high, |x| (x - mean).powi(2) * self.density.value_in(cell, x))
        };
        (0..self.below.len()).map(square).sum::<f64>().sqrt()
    }

    fn breaks(&self) -> Vec<Break> {
        self.breaks.clone()
    }

    fn zones(&self) -> Vec<Zone> {
        vec![Zone { low: self.density.start(), high: self.density.end(), resolution: self.resolution }]
    }

    fn laplace(&self, s: Complex64) -> Complex64 {
        self.density.transform(s).0
    }

    fn fill(&self, stream: &mut Stream, out: &mut [f64]) {
        out.fill_with(|| self.quantile(stream.uniform()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Gaussian;
    use crate::numerics::piecewise::Resolution;

    #[test]
    fn the_series_of_a_gaussian_is_that_gaussian() {
        let exact = Gaussian::new(1.0, 0.1).unwrap();
        let mut density = Piecewise::resolve(|x| exact.density(x), &[0.5], 1.8, Resolution::Mean(1e-15));
        // Any scale will do.
        density.coefficients.iter_mut().flatten().for_each(|c| *c *= 3.0);
        let law = Series::new(density, Vec::new(), 0.1);
        for x in [0.6, 0.9, 1.0, 1.3] {
            // Rounding of a density of height 4.
            assert!((law.density(x) - exact.density(x)).abs() < 1e-13);
            assert!((law.survival(x) - exact.survival(x)).abs() < 1e-14);
            assert!((law.upper_moment(2, x) - exact.upper_moment(2, x)).abs() < 1e-14);
            // Beyond 1.8 there is 6e-16 of the law, and 1.8⁵ times that of the moment.
            assert!((law.upper_moment(5, x) - exact.upper_moment(5, x)).abs() < 1e-13);
        }
        assert!((law.std() - 0.1).abs() < 1e-14);
        assert!((law.quantile(0.3) - exact.quantile(0.3)).abs() < 1e-13);
        assert!((law.upper_quantile(0.01) - exact.upper_quantile(0.01)).abs() < 1e-13);
    }
}
