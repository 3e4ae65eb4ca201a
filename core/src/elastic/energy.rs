//! The energy balance of an interface, motion by motion.

use serde::{Deserialize, Serialize};

use super::batch::sum;
use super::cells::CellEnergies;
use super::configuration::Configuration;
use super::residual::InterfaceModel;
use crate::Result;
use crate::energy::EnergyBalance;
use crate::monitor::Monitor;

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
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub fn new(
        model: &mut InterfaceModel,
        configuration: &Configuration,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let coupling = model.coupling_energy(configuration, monitor)?;
        Ok(Self::begun(model, configuration, coupling))
    }

    /// The same where the slider stores the energy `coupling`.
    pub fn begun(model: &InterfaceModel, configuration: &Configuration, coupling: f64) -> Self {
        Self { total: EnergyBalance::default(), stored: model.stored(configuration, coupling) }
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

    /// Adds a motion in balance, after which the slider stores the energy `coupling`. Its work ∫ΣK_0(X_T − X_j) dX_T is, by parts
    /// and with the balance of forces, the energy that springs and slider gain, and the work ∫ΣF_j dX_j on the contacts.
    pub fn add_creep(&mut self, model: &InterfaceModel, configuration: &Configuration, coupling: f64) {
        let (before, now) = (self.stored, model.stored(configuration, coupling));
        let springs = now.spring - before.spring + now.coupling - before.coupling;
        // The work of contacts is an integral of the tabulated curves. The balance of energies then
        // tests that elastic energy and breaks, which are tabulated on their own, add up to it.
        self.add(now, springs + now.contacts.work - before.contacts.work, 0.0);
    }

    /// Adds a move of the drive alone, from where it was.
    pub fn add_drive(&mut self, model: &InterfaceModel, configuration: &Configuration, from: f64) {
        let (drive, positions) = (configuration.drive, &configuration.positions);
        // The pull of the springs is linear in the drive, so that the midpoint gives its work
        // exactly.
        let middle = 0.5 * (from + drive);
        let pull = sum(positions.len(), |j| model.springs.of(j) * (middle - positions[j]));
        // The cells stand, and so does the energy of the slider.
        let now = model.stored(configuration, self.stored.coupling);
        self.add(now, pull * (drive - from), 0.0);
    }

    /// Adds a slide at a fixed drive that has dissipated so much, and after which the slider stores the energy `coupling`.
    pub fn add_slide(
        &mut self,
        model: &InterfaceModel,
        configuration: &Configuration,
        coupling: f64,
        dissipated: f64,
    ) {
        self.add(model.stored(configuration, coupling), 0.0, dissipated);
    }
}

impl InterfaceModel {
    /// Elastic energy of the slider in a configuration.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub fn coupling_energy(
        &mut self,
        configuration: &Configuration,
        monitor: &mut dyn Monitor,
    ) -> Result<f64> {
        let displacements = configuration.displacements();
        let forces = self.elastic_forces(displacements, monitor)?;
        Ok(self.coupling.energy(displacements, &forces))
    }

    /// Stored energies in a configuration in which the slider stores the energy `coupling`.
    fn stored(&self, configuration: &Configuration, coupling: f64) -> StoredEnergy {
        let (positions, drive) = (&configuration.positions, configuration.drive);
        StoredEnergy {
            spring: sum(self.len(), |j| 0.5 * self.springs.of(j) * (drive - positions[j]).powi(2)),
            coupling,
            contacts: self.cells.energies(),
        }
    }
}
