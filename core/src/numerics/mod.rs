//! Numerical methods that know no physics.

pub mod accumulation;
pub mod breaks;
pub mod compensated;
pub mod dawson;
pub mod diffusion;
pub mod legendre;
pub mod linear;
pub mod motion;
pub mod piecewise;
pub mod powerlaw;
mod rearrange;
pub mod roots;
pub mod stencil;
pub mod table;
pub mod volterra;
