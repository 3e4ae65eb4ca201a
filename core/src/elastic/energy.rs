//! The energy balance of an interface, motion by motion.

use serde::{Deserialize, Serialize};

use super::batch::sum;
use super::cells::CellEnergies;
use super::configuration::Configuration;
use super::residual::InterfaceModel;
use crate::energy::EnergyBalance;

/// Energy stored in springs and slider, and the energies of the contacts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct StoredEnergy {
    spring: f64,
    coupling: f64,
    contacts: CellEnergies,
}

/// The energy balance from the beginning up to a configuration.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct EnergyBudget {
    pub total: EnergyBalance,
    /// Stored energies in that configuration.
    stored: StoredEnergy,
}

impl EnergyBudget {
    /// A balance that begins here.
    pub fn new(model: &mut InterfaceModel, configuration: &Configuration) -> Self {
        Self { total: EnergyBalance::default(), stored: model.stored(configuration) }
    }

    /// Adds a motion after which the energies `now` are stored, and during which the drive did `work` and `slip` was dissipated by the slider.
    fn add(&mut self, now: StoredEnergy, work: f64, slip: f64) {
        let before = std::mem::replace(&mut self.stored, now);
        self.total += EnergyBalance {
            work,
            spring: now.spring - before.spring,
            coupling: now.coupling - before.coupling,
            elastic: now.contacts.elastic - before.contacts.elastic,
            breaks: now.contacts.lost - before.contacts.lost,
            slip,
            ..EnergyBalance::default()
        };
    }

    /// Adds a motion in balance. Its work ∫ΣK_0(X_T − X_j) dX_T is, by parts and with the balance of forces, the energy that
    /// springs and slider gain, and the work ∫ΣF_j dX_j on the contacts.
    pub fn add_creep(&mut self, model: &mut InterfaceModel, configuration: &Configuration) {
        let (before, now) = (self.stored, model.stored(configuration));
        let springs = now.spring - before.spring + now.coupling - before.coupling;
        // The work of contacts is an integral of the tabulated curves. The balance of energies then
        // tests that elastic energy and breaks, which are tabulated on their own, add up to it.
        self.add(now, springs + now.contacts.work - before.contacts.work, 0.0);
    }

    /// Adds a move of the drive alone, from where it was.
    pub fn add_drive(&mut self, model: &mut InterfaceModel, configuration: &Configuration, from: f64) {
        let (drive, positions) = (configuration.drive, &configuration.positions);
        // The pull of the springs is linear in the drive, so that the midpoint gives its work
        // exactly.
        let middle = 0.5 * (from + drive);
        let pull = sum(positions.len(), |j| model.springs.of(j) * (middle - positions[j]));
        self.add(model.stored(configuration), pull * (drive - from), 0.0);
    }

    /// Adds a slide at a fixed drive that has dissipated so much.
    pub fn add_slide(&mut self, model: &mut InterfaceModel, configuration: &Configuration, dissipated: f64) {
        self.add(model.stored(configuration), 0.0, dissipated);
    }
}

impl InterfaceModel {
    /// Stored energies in a configuration.
    fn stored(&mut self, configuration: &Configuration) -> StoredEnergy {
        let displacements = configuration.displacements();
        let forces = self.elastic_forces(displacements);
        let (positions, drive) = (&configuration.positions, configuration.drive);
        StoredEnergy {
            spring: sum(self.len(), |j| 0.5 * self.springs.of(j) * (drive - positions[j]).powi(2)),
            coupling: self.coupling.energy(displacements, &forces),
            contacts: self.cells.energies(),
        }
    }
}
