//! Numerical methods that know no physics.

pub mod breaks;
pub mod compensated;
pub mod legendre;
pub mod piecewise;
pub mod roots;
pub mod volterra;
