//! The mean-field closure: the distribution of thresholds in steady sliding.

use std::sync::Arc;

use super::ThresholdFokkerPlanck;
use crate::Result;
use crate::law::{Breakpoint, Series, SharedLaw};
use crate::monitor::{Monitor, Watch};
use crate::numerics::diffusion::Diffusion;
use crate::numerics::piecewise::{Piecewise, Resolution};
use crate::numerics::roots::brent_root;
use crate::numerics::stencil::{POINTS, Stencil};

/// Cells at the coarsest of three levels of refinement; densities are given on these.
const COARSEST: usize = 512;

/// If the mean square displacement of thresholds before they break is below this fraction of the squared
/// width of the distributions, P_c = P_ci.
const NOTHING: f64 = 1e-13;

/// P_c = ∫₀^∞ e^{−τ} P_c^{Smol}(t = τC/v) dτ with C the mean of P_c: exponentially distributed ages.
///
/// Equivalently (1 − (C/v)L)P_c = P_ci with L the operator of [`ThresholdFokkerPlanck`]: one backward Euler
/// step. It is solved on 512, 1024 and 2048 cells and extrapolated (Richardson); for a smooth P_ci the error
/// is 1e-9 of the mean.
#[derive(Debug, Clone, Copy)]
pub struct Closure<'a> {
    /// Diffusion of thresholds.
    pub maturing: &'a ThresholdFokkerPlanck,
    /// Velocity v.
    pub velocity: f64,
}

impl Closure<'_> {
    /// P_c.
    ///
    /// # Errors
    /// A density that could not be represented; stopped by the monitor.
    pub fn law(&self, monitor: &mut dyn Monitor) -> Result<SharedLaw> {
        let newborn = self.maturing.newborn_law();
        let spread = newborn.mean() * self.maturing.diffusion / self.velocity;
        if spread < NOTHING * self.maturing.resolution().powi(2) {
            return Ok(newborn.clone());
        }
        let watch = Watch::new(monitor);
        let levels = [1, 2, 4].map(|fine| watch.value(|| self.solved(COARSEST * fine, &watch)));
        watch.check()?;
        let masses: Vec<f64> =
            (0..COARSEST).map(|i| extrapolated(levels.each_ref().map(|l| l.1[i]))).collect();
        let mean = extrapolated(levels.each_ref().map(|level| level.0));
        Ok(Arc::new(self.series(&masses, mean)?))
    }

    /// Returns C and the masses on [`COARSEST`] cells, from a solution on `cells` cells. C is the root of ⟨h⟩
    /// = C.
    fn solved(&self, cells: usize, mut watch: &Watch<'_>) -> (f64, Vec<f64>) {
        let operator = self.maturing.operator(cells);
        let middles = operator.middles();
        let newborn = self.maturing.newborn(&middles, -1.0, &mut watch).unwrap_or_default();
        let solve = |mean: f64| resolved(&operator, mean / self.velocity, &newborn);
        // The mean C is implicit: the time constant of the equation contains the mean of its solution.
        let excess = |mean: f64| {
            let masses = solve(mean);
            middles.iter().zip(&masses).map(|(h, mass)| h * mass).sum::<f64>() - mean
        };
        let (low, high) = self.maturing.support;
        // Thresholds lie inside the support, hence their mean too: the root is bracketed.
        let mean = brent_root(excess, low, high, 0.0).unwrap_or(low);
        (mean, solve(mean).chunks(cells / COARSEST).map(|cells| cells.iter().sum()).collect())
    }

    /// The distribution with these masses and the mean C.
    fn series(&self, masses: &[f64], mean: f64) -> Result<Series> {
        let (low, high) = self.maturing.support;
        let width = (high - low) / masses.len() as f64;
        let most = masses.iter().fold(0.0_f64, |most, &mass| most.max(mass));
        // Masses below this do not show in any result; the support ends at the outermost cells above it.
        let shown = |mass: &f64| *mass > 1e-15 * most;
        let (first, last) = (masses.iter().position(shown), masses.iter().rposition(shown));
        let bound = |cell: usize| low + cell as f64 * width;
        let (start, end) = (first.map_or(low, bound), last.map_or(high, |cell| bound(cell + 1)));
        let spread = mean * self.maturing.diffusion / self.velocity;
        let breakpoints = self.maturing.breakpoints(spread);
        let density = |h: f64| if h < start { 0.0 } else { density(masses, (h - low) / width) / width };
        let ends = [(start, density(start)), (end, -density(end))].into_iter();
        let jumps = ends.map(|(position, amplitude)| Breakpoint { position, exponent: 0.0, amplitude });
        let breakpoints: Vec<Breakpoint> = breakpoints.into_iter().chain(jumps).collect();
        let edges: Vec<f64> = breakpoints.iter().map(|b| b.position).collect();
        let resolution = Resolution::Relative { fraction: 1e-9, negligible: 1e-9 * most / width };
        let density = Piecewise::resolve(density, &edges, end, resolution).part(start, end);
        // Nothing narrower than a cell is resolved.
        let resolution = self.maturing.resolution().min(spread.sqrt().max(width));
        Series::solved(density, breakpoints, resolution)
    }
}

/// (1 − aL)⁻¹ m.
fn resolved(operator: &Diffusion, a: f64, masses: &[f64]) -> Vec<f64> {
    let mut out = masses.to_vec();
    operator.resolve(a, &mut out);
    out
}

/// Richardson extrapolation of three levels, each twice as fine as the one before: removes errors of second
/// and fourth order.
fn extrapolated([coarse, fine, finest]: [f64; 3]) -> f64 {
    let (better, best) = (fine + (fine - coarse) / 3.0, finest + (finest - fine) / 3.0);
    best + (best - better) / 15.0
}

/// The density per cell at a position in units of cells, from masses of equal cells: the slope of the
/// interpolated cumulative sum.
fn density(masses: &[f64], position: f64) -> f64 {
    let stencil = Stencil::at(position, masses.len() + 1);
    // Summed from the first edge of the stencil, so that tails keep their relative accuracy.
    let edges =
        masses[stencil.first..].iter().scan(0.0, |sum, mass| Some(std::mem::replace(sum, *sum + mass)));
    let mut sums = [0.0; POINTS];
    sums.iter_mut().zip(edges).for_each(|(sum, edge)| *sum = edge);
    if stencil.first + POINTS > masses.len() {
        sums[POINTS - 1] = masses[stencil.first..].iter().sum();
    }
    stencil.slope(|edge| sums[edge - stencil.first])
}
