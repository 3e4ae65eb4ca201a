//! Where the work of the drive goes.

use std::ops::{Add, AddAssign, Mul, Sub};

use serde::{Deserialize, Serialize};

/// The energy balance of a part of a motion; every term is computed on its own, none as the remainder.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Energy {
    /// Work of the drive: ∫F dX_T behind a spring, ∫F dX where X or the force is imposed.
    pub work: f64,
    /// Change of the energy ½K(X_T − X)² of the spring.
    pub spring: f64,
    /// Change of the elastic energy Σ ½k x² of the contacts.
    pub elastic: f64,
    /// Change of the energy ½MẊ² of the slider, where it is followed in time.
    pub kinetic: f64,
    /// What ageing brought that makes stretched contacts stiffer, ∫Σ ½x² dk: beside the work, not of it.
    pub strengthening: f64,
    /// Lost in breaks of contacts.
    pub breaks: f64,
    /// Lost by the slider in slips: ∫[K(X_T − X) − F] dX where it has no inertia (`overdamped`, `damped`, `arrest`, the last
    /// swing of `inertial`), the spring energy released for `reset`.
    pub slip: f64,
    /// Lost by viscous damping, ∫γẊ² dt.
    pub viscous: f64,
}

impl Energy {
    /// Work, and what ageing brought, less everything they went into: 0 but for rounding and the accuracy of the forces.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        let stored = self.spring + self.elastic + self.kinetic;
        self.work + self.strengthening - (stored + self.breaks + self.dissipated())
    }

    /// Lost by the slider: by its damping, and otherwise in slips.
    #[must_use]
    pub fn dissipated(&self) -> f64 {
        self.slip + self.viscous
    }
}

impl Mul<f64> for Energy {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            work: factor * self.work,
            spring: factor * self.spring,
            elastic: factor * self.elastic,
            kinetic: factor * self.kinetic,
            strengthening: factor * self.strengthening,
            breaks: factor * self.breaks,
            slip: factor * self.slip,
            viscous: factor * self.viscous,
        }
    }
}

impl Add for Energy {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            work: self.work + other.work,
            spring: self.spring + other.spring,
            elastic: self.elastic + other.elastic,
            kinetic: self.kinetic + other.kinetic,
            strengthening: self.strengthening + other.strengthening,
            breaks: self.breaks + other.breaks,
            slip: self.slip + other.slip,
            viscous: self.viscous + other.viscous,
        }
    }
}

impl Sub for Energy {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl AddAssign for Energy {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
