//! The Fokker–Planck (Smoluchowski) equation ∂_t p = D∂_h[U' + ∂_h]p on an interval, with reflecting ends or
//! above an absorbing boundary that rises (the *floor*).
//!
//! Two discretisations: [`MovingGrid`], finite volumes on cells that follow the floor, for many cohorts in
//! steps of any kind; spectral [`Elements`], to rounding where a density is smooth, on which [`Evolution`]
//! follows one cohort in time and [`Resolvent`] gives the density after an exponentially distributed time.
//!
//! Finite volumes use the flux of D. L. Scharfetter and H. K. Gummel, IEEE Trans. Electron Devices 16, 64
//! (1969), and J. S. Chang and G. Cooper, J. Comput. Phys. 6, 1 (1970): for cells of width Δ with masses m_i,
//! J_{i+½} = (D/Δ²)[B(δ) m_i − B(−δ) m_{i+1}], B(z) = z/(e^z − 1), δ = U_{i+1} − U_i. U_i is −ln of the
//! stationary mass of cell i. Because B(−δ) = e^δ B(δ), the stationary distribution carries no flux, to
//! rounding, however coarse the cells; otherwise the error is of second order in Δ.

mod elements;
mod evolution;
mod galerkin;
mod moving_grid;
mod potential;
mod radau;
mod resolvent;
mod slab;

pub use elements::Elements;
pub use evolution::{Evolution, TimeStep};
pub use galerkin::{Field, Loss};
pub use moving_grid::{Coefficients, MovingBoundary, MovingGrid, Sink, Workspace};
pub use potential::{Potential, Slope};
pub use resolvent::Resolvent;

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
