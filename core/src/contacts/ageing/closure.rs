//! The law of thresholds in steady sliding, by the closure of the coupled equations for Q and P_c.

use std::sync::Arc;

use super::ThresholdFokkerPlanck;
use crate::Result;
use crate::law::{Break, Series, SharedLaw};
use crate::monitor::{Monitor, Watch};
use crate::numerics::diffusion::Diffusion;
use crate::numerics::piecewise::{Piecewise, Resolution};
use crate::numerics::roots::brent_root;
use crate::numerics::stencil::{POINTS, Stencil};

/// Cells at the coarsest of three levels, and in all of which densities are told.
const COARSEST: usize = 512;

/// Squared widths to which thresholds spread before they break, over that of the laws, from which on they stay as they are.
const NOTHING: f64 = 1e-13;

/// P_c = ∫₀^∞ e^{−τ} P_c^{Smol}(t = τC/v) dτ, with C the mean of P_c: ages are distributed exponentially.
///
/// That is (1 − (C/v)L)P_c = P_ci with L of [`ThresholdFokkerPlanck`]. It is solved on 512, 1024 and 2048 cells, and extrapolated; where
/// P_ci is smooth, what is left is 1e-9 of a mean.
#[derive(Debug, Clone, Copy)]
pub struct Closure<'a> {
    /// How thresholds diffuse.
    pub maturing: &'a ThresholdFokkerPlanck,
    /// v.
    pub velocity: f64,
}

impl Closure<'_> {
    /// P_c.
    ///
    /// # Errors
    /// A density that could not be solved for; stopped by the monitor.
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

    /// C and the masses, summed over what are [`COARSEST`] cells.
    fn solved(&self, cells: usize, mut watch: &Watch<'_>) -> (f64, Vec<f64>) {
        let operator = self.maturing.operator(cells);
        let middles = operator.middles();
        let newborn = self.maturing.newborn(&middles, -1.0, &mut watch).unwrap_or_default();
        let solve = |mean: f64| resolved(&operator, mean / self.velocity, &newborn);
        let excess = |mean: f64| {
            let masses = solve(mean);
            middles.iter().zip(&masses).map(|(h, mass)| h * mass).sum::<f64>() - mean
        };
        let (low, high) = self.maturing.support;
        let mean = brent_root(excess, low, high, 0.0).unwrap_or(low);
        (mean, solve(mean).chunks(cells / COARSEST).map(|cells| cells.iter().sum()).collect())
    }

    /// The law of a mean C that has these masses.
    fn series(&self, masses: &[f64], mean: f64) -> Result<Series> {
        let (low, high) = self.maturing.support;
        let width = (high - low) / masses.len() as f64;
        let most = masses.iter().fold(0.0_f64, |most, &mass| most.max(mass));
        // Below that nothing shows; beyond the lowest and highest such cell there is nothing.
        let shown = |mass: &f64| *mass > 1e-15 * most;
        let (first, last) = (masses.iter().position(shown), masses.iter().rposition(shown));
        let bound = |cell: usize| low + cell as f64 * width;
        let (start, end) = (first.map_or(low, bound), last.map_or(high, |cell| bound(cell + 1)));
        let spread = mean * self.maturing.diffusion / self.velocity;
        let breaks = self.maturing.breaks(spread);
        let density = |h: f64| if h < start { 0.0 } else { density(masses, (h - low) / width) / width };
        let ends = [(start, density(start)), (end, -density(end))].into_iter();
        let jumps = ends.map(|(position, amplitude)| Break { position, exponent: 0.0, amplitude });
        let breaks: Vec<Break> = breaks.into_iter().chain(jumps).collect();
        let edges: Vec<f64> = breaks.iter().map(|b| b.position).collect();
        let resolution = Resolution::Relative { fraction: 1e-9, negligible: 1e-9 * most / width };
        let density = Piecewise::resolve(density, &edges, end, resolution).part(start, end);
        // No cell tells what is narrower than itself.
        let resolution = self.maturing.resolution().min(spread.sqrt().max(width));
        Series::solved(density, breaks, resolution)
    }
}

/// (1 − aL)⁻¹ m.
fn resolved(operator: &Diffusion, a: f64, masses: &[f64]) -> Vec<f64> {
    let mut out = masses.to_vec();
    operator.resolve(a, &mut out);
    out
}

/// Three levels, each twice as fine as the one before, without their errors of second and fourth order.
fn extrapolated([coarse, fine, finest]: [f64; 3]) -> f64 {
    let (better, best) = (fine + (fine - coarse) / 3.0, finest + (finest - fine) / 3.0);
    best + (best - better) / 15.0
}

/// The density, per cell, that even cells of these masses have at a place counted in cells: the slope of their sums.
fn density(masses: &[f64], place: f64) -> f64 {
    let stencil = Stencil::at(place, masses.len() + 1);
    // Counted from the first edge of the stencil, so that in a tail nothing is lost against what is far away.
    let edges =
        masses[stencil.first..].iter().scan(0.0, |sum, mass| Some(std::mem::replace(sum, *sum + mass)));
    let mut sums = [0.0; POINTS];
    sums.iter_mut().zip(edges).for_each(|(sum, edge)| *sum = edge);
    if stencil.first + POINTS > masses.len() {
        sums[POINTS - 1] = masses[stencil.first..].iter().sum();
    }
    stencil.slope(|edge| sums[edge - stencil.first])
}
