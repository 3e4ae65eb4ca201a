//! A deformable interface: cells with contacts of their own, coupled by the elasticity of the slider.

pub mod coupling;

pub use coupling::Coupling;
