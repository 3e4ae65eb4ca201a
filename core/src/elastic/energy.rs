//! Where the work of the drive goes.

use serde::{Deserialize, Serialize};

use super::Interface;
use super::batch::sum;
use super::cells::CellEnergies;
use super::differences::Differences;

/// The energy balance of a motion; every term is computed on its own, none as the remainder.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Energy {
    /// Work of the drive, ∫ΣK_0(X_T − X_j) dX_T.
    pub work: f64,
    /// Change of the energy ½ΣK_0(X_T − X_j)² of the springs to the drive.
    pub connection: f64,
    /// Change of the energy ½XᵀAX of the slider.
    pub coupling: f64,
    /// Change of the elastic energy Σ½kx² of the contacts.
    pub elastic: f64,
    /// What ageing brought that makes stretched contacts stiffer, ∫Σ½x² dk: beside the work, not of it; 0 without time.
    pub strengthening: f64,
    /// Lost in breaks of contacts.
    pub breaks: f64,
    /// Lost in slips: ∫Σ[K_0(X_T − X_j) − (AX)_j − F_j] dX_j.
    pub slip: f64,
}

impl Energy {
    /// Work, and what ageing brought, less everything they went into: 0 but for rounding and the accuracy of the forces.
    #[must_use]
    pub fn imbalance(&self) -> f64 {
        let stored = self.connection + self.coupling + self.elastic;
        self.work + self.strengthening - (stored + self.breaks + self.slip)
    }
}

/// What is stored, and what contacts have done.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct StoredEnergy {
    connection: f64,
    coupling: f64,
    pub contacts: CellEnergies,
}

impl Interface {
    /// What is stored now.
    pub(super) fn stored(&mut self) -> StoredEnergy {
        let displaced = Differences::now(self.differences.as_ref(), &self.positions);
        self.coupling.forces(displaced, &mut self.excess);
        let (positions, drive) = (&self.positions, self.drive);
        StoredEnergy {
            connection: sum(self.len(), |j| 0.5 * self.connection(j) * (drive - positions[j]).powi(2)),
            coupling: self.coupling.energy(displaced, &self.excess),
            contacts: self.cells.account(),
        }
    }

    /// Enters what has happened since the energy balance was last closed, with what the drive did and what slips have lost.
    fn enter(&mut self, work: f64, slip: f64) {
        let (before, now) = (self.closed, self.stored());
        self.energy.work += work;
        self.energy.connection += now.connection - before.connection;
        self.energy.coupling += now.coupling - before.coupling;
        self.energy.elastic += now.contacts.elastic - before.contacts.elastic;
        self.energy.breaks += now.contacts.lost - before.contacts.lost;
        self.energy.slip += slip;
        self.closed = now;
    }

    /// Enters a motion in balance. Its work ∫ΣK_0(X_T − X_j) dX_T is, by parts and with the balance of forces, what the
    /// springs gain and ∫Σ[(AX)_j + F_j] dX_j.
    pub(super) fn enter_creep(&mut self) {
        let (before, now) = (self.closed, self.stored());
        let springs = now.connection - before.connection + now.coupling - before.coupling;
        self.enter(springs + now.contacts.work - before.contacts.work, 0.0);
    }

    /// Enters a move of the drive alone, from where it was.
    pub(super) fn enter_drive(&mut self, from: f64) {
        let middle = 0.5 * (from + self.drive);
        let pull = sum(self.positions.len(), |j| self.connection(j) * (middle - self.positions[j]));
        self.enter(pull * (self.drive - from), 0.0);
    }

    /// Enters a slide at a fixed drive that has lost so much.
    pub(super) fn enter_slide(&mut self, slip: f64) {
        self.enter(0.0, slip);
    }
}
