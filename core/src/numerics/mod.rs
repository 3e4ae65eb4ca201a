//! Numerical methods that know nothing of contacts.
//!
//! * Functions as Legendre series on cells: `legendre` (16-point Gauss rule), `piecewise`, `rearrange`, `breakpoints` (where they
//!   are not smooth), `stencil` (Lagrange interpolation), `table` (a look-up table).
//! * Equations: `volterra` (convolution equations of the second kind), `diffusion` (Fokker–Planck equation on an axis), `motion`
//!   (Newton's equation of a body), `tr_bdf2` (time stepping), `linear`, `springs` (tridiagonal), `roots` (Brent).
//! * Lattices: `line` and `modes` (functions of the lattice Laplacian by cosine transforms), `fractional` (its square root).
//! * Statistics and sums: `powerlaw`, `cutoff`, `gauss` (quadrature of a discrete measure), `compensated`, `product`,
//!   `accumulation` (the point at which an integral reaches a value), `dawson`, `wide` (AVX-512 loops).

pub mod accumulation;
pub mod breakpoints;
pub mod compensated;
pub mod cutoff;
pub mod dawson;
pub mod diffusion;
pub mod fractional;
pub mod gauss;
pub mod legendre;
pub mod line;
pub mod linear;
pub mod modes;
pub mod motion;
pub mod piecewise;
pub mod powerlaw;
pub mod product;
mod rearrange;
pub mod roots;
pub mod springs;
pub mod stencil;
pub mod table;
pub mod tr_bdf2;
pub mod volterra;
pub(crate) mod wide;
