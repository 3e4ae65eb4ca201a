//! The Fokker–Planck (Smoluchowski) equation ∂_t p = D∂_h[U' + ∂_h]p on an interval, with reflecting ends or
//! above an absorbing boundary that rises (the *floor*).
//!
//! Three discretisations: [`Diffusion`], finite volumes on equal cells, for mean times; [`MovingGrid`],
//! finite volumes on cells that follow the floor, for many cohorts in steps of any kind; [`Evolution`],
//! spectral [`Elements`], to rounding where a density is smooth, for one cohort at a time.
//!
//! All finite volumes use the flux of D. L. Scharfetter and H. K. Gummel, IEEE Trans. Electron Devices 16, 64
//! (1969), and J. S. Chang and G. Cooper, J. Comput. Phys. 6, 1 (1970): for cells of width Δ with masses m_i,
//! J_{i+½} = (D/Δ²)[B(δ) m_i − B(−δ) m_{i+1}], B(z) = z/(e^z − 1), δ = U_{i+1} − U_i. U_i is −ln of the
//! stationary mass of cell i. Because B(−δ) = e^δ B(δ), the stationary distribution carries no flux, to
//! rounding, however coarse the cells; otherwise the error is of second order in Δ.

mod elements;
mod evolution;
mod moving_grid;
mod potential;
mod radau;
mod slab;

pub use elements::Elements;
pub use evolution::{Evolution, TimeStep};
pub use moving_grid::{Coefficients, MovingBoundary, MovingGrid, Sink, Workspace};
pub use potential::{Potential, Slope, potential_values};
pub use slab::{Field, Loss};

/// The operator L = D∂_h[U' + ∂_h] on equal cells, with reflecting ends.
#[derive(Debug, Clone)]
pub struct Diffusion {
    low: f64,
    width: f64,
    /// D.
    pub diffusion: f64,
    /// U_{i+1} − U_i, for each cell but the last.
    rises: Vec<f64>,
    /// Rate at which mass goes from a cell to the next one up; 0 for the last.
    pub up: Vec<f64>,
    /// Rate at which mass goes from a cell to the next one down; 0 for the first.
    pub down: Vec<f64>,
}

impl Diffusion {
    /// The operator on cells of one `width` from `low` on, one for each value of the `potential`: −ln of the
    /// stationary mass of the cell, up to a constant. All values must be finite, and D > 0.
    pub fn new(low: f64, width: f64, potential: &[f64], diffusion: f64) -> Self {
        let rises: Vec<f64> = potential.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let rate = diffusion / (width * width);
        let up = rises.iter().map(|&rise| rate * bernoulli(rise)).chain([0.0]).collect();
        let down = [0.0].into_iter().chain(rises.iter().map(|&rise| rate * bernoulli(-rise))).collect();
        Self { low, width, diffusion, rises, up, down }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.up.len()
    }

    /// Width of a cell.
    pub fn width(&self) -> f64 {
        self.width
    }

    /// The lower edge of a cell; `edge(cells())` is the upper end.
    pub fn edge(&self, cell: usize) -> f64 {
        self.low + cell as f64 * self.width
    }

    /// The middle of a cell.
    pub fn centre(&self, cell: usize) -> f64 {
        self.low + (cell as f64 + 0.5) * self.width
    }

    /// Replaces the masses m by (1 − aL)⁻¹ m: the masses after an exponentially distributed time of mean a, or after one
    /// backward Euler step of length a.
    pub fn resolve(&self, a: f64, masses: &mut [f64]) {
        // The Thomas algorithm from the top down, with 1 − a l_i/d_i instead of differences: all terms are positive, so
        // nothing cancels and mass is conserved to rounding. The lowest two cells are left as a system of their own.
        let mut inverses = vec![1.0; masses.len()];
        let (mut kept, mut carried, mut rest) = (0.0, 0.0, 1.0);
        for i in (1..masses.len()).rev() {
            let down = a * self.down[i];
            rest = 1.0 + a * (self.up[i] * kept);
            inverses[i] = 1.0 / (rest + down);
            kept = rest * inverses[i];
            masses[i] += carried;
            carried = down * inverses[i] * masses[i];
        }
        let [first, second, above @ ..] = masses else { return };
        let (up, down) = (self.up[0], a * self.down[1]);
        let next = rest + down;
        *first = (*first + down / next * *second) / (1.0 + a * (up * rest / next));
        *second = (*second + a * up * *first) / next;
        let mut lower = *second;
        for (i, mass) in (2..).zip(above) {
            lower = inverses[i] * *mass + a * self.up[i - 1] * inverses[i] * lower;
            *mass = lower;
        }
    }

    /// The middles of all cells.
    pub fn middles(&self) -> Vec<f64> {
        (0..self.cells()).map(|cell| self.centre(cell)).collect()
    }

    /// Slope U' of the potential at a cell.
    pub fn slope(&self, cell: usize) -> f64 {
        let rise = self.rises.get(cell).or(self.rises.last());
        rise.map_or(0.0, |rise| rise / self.width)
    }
}

/// The Bernoulli function B(z) = z/(e^z − 1).
pub fn bernoulli(z: f64) -> f64 {
    /// Below this |z| a series is summed, with a relative error of z¹⁰/5e7.
    const SMALL: f64 = 0.2;
    if z.abs() > SMALL {
        return z / z.exp_m1();
    }
    let square = z * z;
    1.0 - 0.5 * z + square / 12.0 * (1.0 - square / 60.0 * (1.0 - square / 42.0 * (1.0 - square / 40.0)))
}

/// Masses on cells with these `middles` from points (position, mass), by linear weighting (cloud in cell):
/// each mass is divided between the two nearest middles, which conserves the mean, however rough the
/// distribution of the points.
pub fn cloud_in_cell(middles: &[f64], points: impl Iterator<Item = (f64, f64)>) -> Vec<f64> {
    let (mut masses, mut above) = (vec![0.0; middles.len()], 0);
    for (place, mass) in points {
        // Points mostly rise: the next middle above one is near that above the last one.
        above += middles[above..].iter().take_while(|middle| **middle <= place).count();
        above -= middles[..above].iter().rev().take_while(|middle| **middle > place).count();
        if above == 0 || above == middles.len() {
            masses[above.min(middles.len() - 1)] += mass;
            continue;
        }
        let fraction = (place - middles[above - 1]) / (middles[above] - middles[above - 1]);
        masses[above - 1] += mass * (1.0 - fraction);
        masses[above] += mass * fraction;
    }
    masses
}
