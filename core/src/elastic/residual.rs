//! Forces out of balance on the cells.

use super::batch::{change, fill, largest, sum};
use super::cells::{Cells, Extremes, Slopes};
use super::configuration::{Advances, Configuration};
use super::coupling::Coupling;
use super::parameters::DriveSprings;
use crate::Result;
use crate::monitor::Monitor;

/// Stiffness A_jj of the slider, relative to the steepest slope of the contacts, above which differences of positions are
/// kept: roundings of positions would be forces of 1e-12 of the strongest ones after ten mean thresholds.
const STIFF: f64 = 1e3;

/// A rigid translation under forces below this fraction of A_jj makes no force.
const TRANSLATION: f64 = 1e-9;

/// Rounding error of a balance, relative to the strongest force of a cell.
const BALANCED: f64 = 1e-14;

/// The same in creep, whose steps start from a new evaluation of all forces instead of what the last one has left.
const BALANCED_IN_CREEP: f64 = 1e-11;

/// Rounding error of the positions in the forces of drive and slider, in units in the last place.
const ROUNDINGS: f64 = 4.0;

/// What makes the forces on the cells: contacts, the elastic slider, and springs to the drive.
#[derive(Debug)]
pub(super) struct InterfaceModel {
    pub cells: Box<dyn Cells>,
    pub coupling: Box<dyn Coupling>,
    pub springs: DriveSprings,
    /// Residuals computed since this was last reported.
    pub residuals: usize,
}

/// Forces out of balance, with the tangents of the contacts in the same state.
pub(super) struct Residual {
    /// r_j = K_0j(X_T − X_j) − (AX)_j − F_j.
    pub forces: Vec<f64>,
    /// dF_j/dX_j.
    pub tangents: Vec<f64>,
    /// max |r_j|.
    pub largest: f64,
}

impl InterfaceModel {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// The balance in which cells stand where their populations do; those that the drive pulls are at a mean position of 0.
    ///
    /// # Errors
    /// Those of the cells; stopped by the monitor.
    pub fn initial_balance(&mut self, monitor: &mut dyn Monitor) -> Result<Configuration> {
        let number = self.len();
        let stiffness = largest(number, |j| self.coupling.self_stiffness(j));
        let stiff = stiffness > STIFF * self.cells.extremes().steepest;
        let relative = stiff && self.resists_differences_only(stiffness, monitor)?;
        let mut configuration = Configuration::new(number, relative);
        if self.residual(&configuration, monitor)?.largest > 0.0 {
            // At this drive the springs carry the whole friction force. Contacts do not move, so that the
            // positions of the cells in equilibrium solve a linear system.
            configuration.drive = self.force() / self.springs.total();
            let residual = self.residual(&configuration, monitor)?;
            let mut positions = residual.forces;
            let mut diagonal = residual.tangents;
            fill(&mut diagonal, |j| self.springs.of(j));
            let goal = self.rounding(&configuration, configuration.drive);
            self.coupling.solve_variable(&diagonal, &mut positions, goal, monitor)?;
            configuration.put(positions);
        }
        Ok(configuration)
    }

    /// Whether a rigid translation makes no elastic force, compared to the `stiffness` of a cell that moves alone.
    fn resists_differences_only(&mut self, stiffness: f64, monitor: &mut dyn Monitor) -> Result<bool> {
        let mut forces = vec![0.0; self.len()];
        self.coupling.forces(&vec![1.0; self.len()], &mut forces, monitor)?;
        Ok(forces.iter().all(|force| force.abs() <= TRANSLATION * stiffness))
    }

    /// −AX, forces of the slider.
    pub fn elastic_forces(&mut self, displacements: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        let mut forces = vec![0.0; displacements.len()];
        self.coupling.forces(displacements, &mut forces, monitor)?;
        Ok(forces)
    }

    /// K_0j(X_T − X_j) − (AX)_j, forces of drive and slider.
    pub fn pulls(&mut self, configuration: &Configuration, monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        let mut pulls = self.elastic_forces(configuration.displacements(), monitor)?;
        let (springs, drive, positions) = (&self.springs, configuration.drive, &configuration.positions);
        change(&mut pulls, |j, elastic| springs.of(j) * (drive - positions[j]) + elastic);
        Ok(pulls)
    }

    /// The pulls halfway between an earlier configuration and one now, at the same drive. These are the means over any path
    /// from one to the other as far as work is concerned, because pulls are linear in positions and A is symmetric.
    pub fn mean_pulls(
        &mut self,
        before: &Configuration,
        now: &Configuration,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<f64>> {
        let mut pulls = self.elastic_forces(&now.displacements_halfway(before), monitor)?;
        let (springs, drive) = (&self.springs, now.drive);
        let middle = |j: usize| 0.5 * (before.positions[j] + now.positions[j]);
        change(&mut pulls, |j, elastic| springs.of(j) * (drive - middle(j)) + elastic);
        Ok(pulls)
    }

    /// The residual where the cells are.
    pub fn residual(&mut self, configuration: &Configuration, monitor: &mut dyn Monitor) -> Result<Residual> {
        let pulls = self.pulls(configuration, monitor)?;
        self.residual_under(pulls, monitor)
    }

    /// The same under known pulls.
    pub fn residual_under(&mut self, pulls: Vec<f64>, monitor: &mut dyn Monitor) -> Result<Residual> {
        let at_rest = vec![0.0; pulls.len()];
        self.subtract_contacts(pulls, &at_rest, monitor)
    }

    /// The residual at a drive after advances; `elastic` are the elastic forces before them.
    pub fn residual_after(
        &mut self,
        configuration: &Configuration,
        drive: f64,
        advances: &Advances,
        elastic: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Residual> {
        let mut pulls = self.elastic_forces(advances.displacements(), monitor)?;
        let (springs, positions, by) = (&self.springs, &configuration.positions, &advances.by);
        let spring = |j: usize| springs.of(j) * (drive - positions[j] - by[j]);
        // Forces of the advances are added to those of the positions: A δ keeps the digits that A
        // (X + δ) would lose.
        change(&mut pulls, |j, change| spring(j) + (elastic[j] + change));
        self.subtract_contacts(pulls, by, monitor)
    }

    /// Pulls less the forces of the contacts after advances.
    fn subtract_contacts(
        &mut self,
        pulls: Vec<f64>,
        by: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Residual> {
        let (mut forces, mut tangents) = (pulls, vec![0.0; by.len()]);
        self.residuals += 1;
        let largest = self.cells.residual(by, &mut forces, &mut tangents, monitor)?;
        Ok(Residual { forces, tangents, largest })
    }

    /// Tangents of the contacts after advances.
    pub fn tangents(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        Ok(self.subtract_contacts(vec![0.0; by.len()], by, monitor)?.tangents)
    }

    /// Least and largest tangent of each cell over an advance.
    pub fn slopes(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<Vec<Slopes>> {
        let mut slopes = vec![Slopes::default(); by.len()];
        self.cells.slopes(by, &mut slopes, monitor)?;
        Ok(slopes)
    }

    /// K_0j + η_j/dt; `rate` is η/dt of a cell of area 1.
    pub fn held(&self, cell: usize, rate: f64) -> f64 {
        self.springs.of(cell) + self.springs.areas().of(cell) * rate
    }

    /// The largest slope |F_j'| of a cell per area.
    pub fn steepest_per_area(&self) -> f64 {
        self.cells.extremes().steepest / self.springs.areas().largest()
    }

    /// d_j = F_j' + K_0j + η_j/dt, where d_j δ_ij + A_ij is the derivative of the residual, sign aside; `rate` is η/dt of a cell
    /// of area 1.
    pub fn diagonal(&self, tangents: Vec<f64>, rate: f64) -> Vec<f64> {
        let mut diagonal = tangents;
        change(&mut diagonal, |j, tangent| tangent + self.held(j, rate));
        diagonal
    }

    /// Friction force of all cells.
    pub fn force(&self) -> f64 {
        sum(self.len(), |j| self.cells.force(j))
    }

    /// F_j.
    pub fn contact_forces(&self) -> Vec<f64> {
        let mut forces = vec![0.0; self.len()];
        fill(&mut forces, |j| self.cells.force(j));
        forces
    }

    /// Rounding error of a residual.
    pub fn rounding(&self, configuration: &Configuration, drive: f64) -> f64 {
        let displaced = configuration.displacements();
        let pull = largest(self.len(), |j| {
            self.springs.of(j) * drive.abs() + self.coupling.self_stiffness(j) * displaced[j].abs()
        });
        BALANCED * self.cells.extremes().strongest + ROUNDINGS * f64::EPSILON * pull
    }

    /// Residual that creep leaves.
    pub fn creep_tolerance(&self, configuration: &Configuration, drive: f64) -> f64 {
        self.rounding(configuration, drive).max(BALANCED_IN_CREEP * self.cells.extremes().strongest)
    }

    /// The length on which the steepest slope makes the strongest force.
    pub fn length(&self) -> f64 {
        let Extremes { strongest, steepest, .. } = self.cells.extremes();
        strongest / steepest
    }
}
