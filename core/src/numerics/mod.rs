//! Numerical methods that know no physics.

pub mod breaks;
pub mod legendre;
pub mod linear;
pub mod motion;
pub mod piecewise;
pub mod roots;
pub mod volterra;
