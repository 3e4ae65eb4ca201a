//! Numerical methods, without reference to contacts.
//!
//! * Functions as Legendre series on cells: `legendre` (16-point Gauss rule), `piecewise`, `rearrange`, `laplace` and `fourier` (transforms), `breakpoints` (where they
//!   are not smooth), `stencil` (Lagrange interpolation), `table` (a look-up table).
//! * Equations: `volterra` (convolution equations of the second kind), `diffusion` (Fokker–Planck equation on an axis), `motion`
//!   (Newton's equation of a body), `tr_bdf2` (time stepping), `linear`, `springs` (tridiagonal), `roots` (Brent),
//!   `zeros` (of analytic functions), `nelder_mead` (minima in several variables).
//! * Lattices: `real_transform` (discrete Fourier transforms), `line` and `modes` (functions of the lattice Laplacian by cosine transforms), `fractional` (its square root).
//! * Statistics and sums: `least_squares`, `student` (quantiles), `ljung_box` (a test of autocorrelation), `powerlaw`, `cutoff`, `omori`, `gauss` (quadrature of a discrete measure), `compensated`, `product`,
//!   `accumulation` (the point at which an integral reaches a value), `sorting`, `dawson`, `incomplete` (integrals of exponentials from tables), `exponential` and `logarithm` (in loops), `wide` (AVX-512 and AVX2).
//!
//! Only the fits of [`powerlaw`], [`cutoff`] and [`omori`] are for users of the crate. `diffusion`, `legendre` and `roots` are public and hidden, because
//! tests and benches outside the crate hold them against other methods, or compute expected values with them.

pub(crate) mod accumulation;
pub(crate) mod breakpoints;
pub(crate) mod compensated;
pub mod cutoff;
pub(crate) mod dawson;
#[doc(hidden)]
pub mod diffusion;
pub(crate) mod exponential;
pub(crate) mod fourier;
pub(crate) mod fractional;
pub(crate) mod gauss;
pub(crate) mod incomplete;
mod laplace;
pub(crate) mod least_squares;
#[doc(hidden)]
pub mod legendre;
pub(crate) mod line;
pub(crate) mod linear;
pub(crate) mod ljung_box;
pub(crate) mod logarithm;
pub(crate) mod modes;
pub(crate) mod motion;
pub(crate) mod nelder_mead;
pub mod omori;
pub(crate) mod order;
pub(crate) mod periodogram;
pub(crate) mod piecewise;
pub mod powerlaw;
pub(crate) mod product;
pub(crate) mod real_transform;
mod rearrange;
#[doc(hidden)]
pub mod roots;
pub(crate) mod sorting;
pub(crate) mod springs;
pub(crate) mod stencil;
pub(crate) mod student;
pub(crate) mod table;
pub(crate) mod tr_bdf2;
pub(crate) mod volterra;
pub(crate) mod wide;
pub(crate) mod zeros;
