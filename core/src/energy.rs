//! The energy balance of a driven slider: where the work of the drive goes.

use std::ops::{Add, AddAssign, Mul, Sub};

use serde::{Deserialize, Serialize};

/// Energies and number of breaks of a population of contacts, each summed on its own. The work done on the contacts is the
/// change of `elastic` − `strengthening` + `lost` + `sliding`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactEnergies {
    /// Present elastic energy Σ ½k x².
    pub elastic: f64,
    /// Energy dissipated in breaks since the beginning: Σ over breaks of ½k x_b², minus the ½k r² of re-formed contacts.
    pub lost: f64,
    /// Energy ∫Σ ½x² dk since the beginning, supplied by ageing that makes stretched contacts stiffer (k = κ x_s with the
    /// present threshold); negative if they weaken, 0 for athermal contacts.
    pub strengthening: f64,
    /// Energy dissipated by the constant friction force f of free contacts since the beginning, Σ∫f|dX|.
    #[serde(default)]
    pub sliding: f64,
    /// Breaks since the beginning, per contact.
    pub broken: f64,
}

/// Energy balance of a motion of a block or of an interface. Every term is computed on its own, none as the remainder.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyBalance {
    /// Work of the drive: ∫F dX_T behind a spring, ∫ΣK_0(X_T − X_j) dX_T of an interface, ∫F dX where X or the force is
    /// imposed.
    pub work: f64,
    /// Change of the energy ½K(X_T − X)² of the spring, or ½ΣK_0(X_T − X_j)² of the springs to the drive.
    pub spring: f64,
    /// Change of the elastic energy ½XᵀAX of the slider of an interface.
    pub coupling: f64,
    /// Change of the elastic energy Σ ½k x² of the contacts.
    pub elastic: f64,
    /// Change of the kinetic energy ½MẊ² of the slider, in motion in time.
    pub kinetic: f64,
    /// Energy supplied by ageing that makes stretched contacts stiffer, ∫Σ ½x² dk; it is not part of the work.
    pub strengthening: f64,
    /// Dissipated in breaks of contacts.
    pub breaks: f64,
    /// Dissipated by the slider in slips. Of a block: ∫[K(X_T − X) − F] dX where it has no inertia (`overdamped`, `damped`,
    /// `arrest`, the last swing of `inertial`), the spring energy released for `reset`. Of an interface:
    /// ∫Σ[K_0(X_T − X_j) − (AX)_j − F_j] dX_j, and in motion in time ∫Σ ηẊ_j² dt.
    pub slip: f64,
    /// Dissipated by viscous damping of a block, ∫γẊ² dt.
    pub viscous: f64,
    /// Dissipated by the background force, ∫B|dX|, and by the constant friction force of free contacts.
    #[serde(default)]
    pub background: f64,
}

impl EnergyBalance {
    /// Supplied less stored and dissipated energy: 0 but for rounding and the accuracy of the forces.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        let stored = self.spring + self.coupling + self.elastic + self.kinetic;
        self.work + self.strengthening - (stored + self.breaks + self.background + self.dissipated())
    }

    /// Dissipated by the slider: by its damping, and otherwise in slips.
    #[must_use]
    pub fn dissipated(&self) -> f64 {
        self.slip + self.viscous
    }
}

impl Mul<f64> for EnergyBalance {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            work: factor * self.work,
            spring: factor * self.spring,
            coupling: factor * self.coupling,
            elastic: factor * self.elastic,
            kinetic: factor * self.kinetic,
            strengthening: factor * self.strengthening,
            breaks: factor * self.breaks,
            slip: factor * self.slip,
            viscous: factor * self.viscous,
            background: factor * self.background,
        }
    }
}

impl Add for EnergyBalance {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            work: self.work + other.work,
            spring: self.spring + other.spring,
            coupling: self.coupling + other.coupling,
            elastic: self.elastic + other.elastic,
            kinetic: self.kinetic + other.kinetic,
            strengthening: self.strengthening + other.strengthening,
            breaks: self.breaks + other.breaks,
            slip: self.slip + other.slip,
            viscous: self.viscous + other.viscous,
            background: self.background + other.background,
        }
    }
}

impl Sub for EnergyBalance {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + other * -1.0
    }
}

impl AddAssign for EnergyBalance {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
