//! Where the work of the drive goes.

use std::ops::AddAssign;

/// The books of a part of a motion; every term is computed on its own, none as the remainder.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Energy {
    /// Work of the drive: ∫F dX_T behind a spring, ∫F dX where X or the force is imposed.
    pub work: f64,
    /// Change of the energy ½K(X_T − X)² of the spring.
    pub spring: f64,
    /// Change of the elastic energy Σ ½k x² of the contacts.
    pub elastic: f64,
    /// Lost in breaks of contacts.
    pub breaks: f64,
    /// Lost by the slider in slips: ∫[K(X_T − X) − F] dX where it has no inertia (`overdamped`, `damped`, `arrest`, the last
    /// swing of `inertial`), the spring energy released for `reset`.
    pub slip: f64,
    /// Lost by viscous damping, ∫γẊ² dt.
    pub viscous: f64,
}

impl Energy {
    /// Work less everything it went into: 0 but for rounding and the accuracy of the forces.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        self.work - (self.spring + self.elastic + self.breaks + self.slip + self.viscous)
    }
}

impl AddAssign for Energy {
    fn add_assign(&mut self, other: Self) {
        self.work += other.work;
        self.spring += other.spring;
        self.elastic += other.elastic;
        self.breaks += other.breaks;
        self.slip += other.slip;
        self.viscous += other.viscous;
    }
}
