//! Numerical methods that know no physics.

pub mod accumulation;
pub mod breaks;
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
