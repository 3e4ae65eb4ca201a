//! The loading branch: force and energies as the slider moves in one direction, whether broken contacts
//! re-form or stay free.

use std::sync::{Arc, OnceLock};

use super::renewal::{RenewalSolution, slope};
use super::{Stretches, Tolerance};
use crate::Result;
use crate::contacts::Contacts;
use crate::life::{Layer, Life, simplified, threshold_atoms};
use crate::monitor::Monitor;
use crate::numerics::breakpoints::same_position;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// Motion of the slider in one direction from a given state of the contacts: curves of the advance u, per
/// contact and per unit stiffness.
#[derive(Debug)]
pub(super) struct LoadingBranch {
    motion: Motion,
    energy_curves: OnceLock<EnergyCurves>,
}

/// What becomes of contacts that break.
#[derive(Debug)]
enum Motion {
    /// They re-form.
    Renewed(Box<RenewalSolution>),
    /// They stay free.
    Held { first: Arc<Life>, slope: Piecewise },
}

/// Curves of energies and breaks along a branch.
#[derive(Debug, Default)]
struct EnergyCurves {
    energy: Piecewise,
    /// Energy that the unbroken contacts will dissipate when they break.
    breaking_energy: Piecewise,
    /// Fraction that breaks from u on.
    yet_to_break: Piecewise,
}

/// Energies and breaks since the start of a branch, per contact and per unit stiffness.
#[derive(Debug, Clone, Copy)]
pub(super) struct BranchEnergies {
    pub(super) elastic: f64,
    pub(super) lost: f64,
    pub(super) broken: f64,
}

impl LoadingBranch {
    /// The branch on which broken contacts re-form, solved up to the advance `end`.
    ///
    /// # Errors
    /// Those of [`RenewalSolution::solve`].
    pub(super) fn renewed(
        first: Arc<Life>,
        reformed: &Arc<Life>,
        end: f64,
        tolerance: Tolerance,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let renewal = RenewalSolution::solve(&first, reformed, end, tolerance, monitor)?;
        Ok(Self { motion: Motion::Renewed(Box::new(renewal)), energy_curves: OnceLock::new() })
    }

    /// The branch on which broken contacts stay free.
    pub(super) fn held(first: Arc<Life>) -> Self {
        let slope = slope(first.force().curve(), &first);
        Self { motion: Motion::Held { first, slope }, energy_curves: OnceLock::new() }
    }

    /// The same branch solved up to `end`; `None` if nothing re-forms, where it is complete.
    ///
    /// # Errors
    /// Those of [`RenewalSolution::solve`].
    pub(super) fn extended(
        &self,
        end: f64,
        tolerance: Tolerance,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Self>> {
        match &self.motion {
            Motion::Renewed(renewal) => {
                let (first, reformed) = (renewal.first.clone(), &renewal.reformed);
                let longer = Self::renewed(first, reformed, end, tolerance, monitor)?;
                // Energies that have been asked for are asked for again, where no monitor can stop them.
                if self.energy_curves.get().is_some() {
                    let curves = longer.energy_curves(monitor)?;
                    longer.energy_curves.get_or_init(|| curves);
                }
                Ok(Some(longer))
            }
            Motion::Held { .. } => Ok(None),
        }
    }

    /// The life of the contacts that are there at its beginning.
    pub(super) fn first(&self) -> &Arc<Life> {
        match &self.motion {
            Motion::Renewed(renewal) => &renewal.first,
            Motion::Held { first, .. } => first,
        }
    }

    /// Where the solution ends; on a branch where nothing re-forms, where no contact is left.
    pub(super) fn end(&self) -> f64 {
        self.force().end()
    }

    /// Estimated error of F, per unit stiffness, mean life and mean stiffness, given the stretches at its
    /// start.
    pub(super) fn error(&self) -> f64 {
        match &self.motion {
            Motion::Renewed(renewal) => renewal.error,
            Motion::Held { first, .. } => first.error(),
        }
    }

    /// The density of stretches at the advance u, and its point masses; `None` if broken contacts stay free.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(super) fn stretch_density(
        &self,
        u: f64,
        stretches: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Stretches>> {
        match &self.motion {
            Motion::Renewed(renewal) => renewal.stretch_density(u, stretches, monitor).map(Some),
            Motion::Held { .. } => Ok(None),
        }
    }

    /// Whether broken contacts stay free.
    pub(super) fn is_held(&self) -> bool {
        matches!(self.motion, Motion::Held { .. })
    }

    /// The cell that contains u (the right one at a boundary); the number of cells where no contact is left.
    pub(super) fn cell(&self, u: f64) -> usize {
        if u < self.end() { self.force().nearest(u) } else { self.force().coefficients.len() }
    }

    /// End of a cell; infinite where no contact is left.
    pub(super) fn cell_end(&self, cell: usize) -> f64 {
        self.force().boundaries.get(cell + 1).copied().unwrap_or(f64::INFINITY)
    }

    /// Whether contacts break simultaneously at the end of a cell.
    pub(super) fn breaks_after(&self, cell: usize) -> bool {
        let (end, before) = (self.cell_end(cell), self.force().boundaries.get(cell).copied().unwrap_or(0.0));
        let near = |x: f64| x > before && same_position(x, end);
        match &self.motion {
            Motion::Renewed(renewal) => {
                let atoms = &renewal.solution.atoms;
                let first = atoms.partition_point(|a| a.position <= before);
                atoms.get(first).is_some_and(|a| near(a.position))
            }
            Motion::Held { first, .. } => first.breaking().atoms().any(|a| near(a.position)),
        }
    }

    /// Total probability by quadrature, if broken contacts re-form.
    pub(super) fn total_probability(&self, u: f64) -> Option<f64> {
        match &self.motion {
            Motion::Renewed(renewal) => Some(renewal.sum_at(Life::survival, u)),
            Motion::Held { .. } => None,
        }
    }

    /// Force and slope at u, from the polynomials of a cell.
    pub(super) fn response(&self, u: f64, cell: usize) -> (f64, f64) {
        let force =
            if u == 0.0 && self.first().starts_unstretched() { 0.0 } else { at(self.force(), u, cell) };
        (force, at(self.slope(), u, cell))
    }

    /// The force: a polynomial on each of its cells.
    fn force(&self) -> &Piecewise {
        match &self.motion {
            Motion::Renewed(renewal) => &renewal.force,
            Motion::Held { first, .. } => first.force().curve(),
        }
    }

    /// Its slope, on the same cells.
    fn slope(&self) -> &Piecewise {
        match &self.motion {
            Motion::Renewed(renewal) => &renewal.slope,
            Motion::Held { slope, .. } => slope,
        }
    }

    /// Energies and breaks up to the advance u.
    ///
    /// A contact that breaks at the stretch x dissipates ½k x²; one that re-forms adds its ½k r², counted
    /// when it breaks.
    pub(super) fn energies(&self, u: f64, cell: usize) -> BranchEnergies {
        // Only a monitor can make them fail.
        let energy_curves =
            self.energy_curves.get_or_init(|| self.energy_curves(&mut ()).unwrap_or_default());
        let at = |curve: &Piecewise| at(curve, u, cell);
        let start = |kernel: &Kernel| self::at(kernel.curve(), 0.0, 0);
        let brought = |life: &Life| start(life.breaking_energy()) - life.fresh_energy();
        let initial_breaking_energy = self::at(&energy_curves.breaking_energy, 0.0, 0);
        let (broken, born) = match &self.motion {
            Motion::Renewed(renewal) => {
                let broken = self::at(&energy_curves.yet_to_break, 0.0, 0) - at(&energy_curves.yet_to_break);
                (broken, broken * brought(&renewal.reformed))
            }
            Motion::Held { first, .. } => (start(first.survival()) - at(&energy_curves.yet_to_break), 0.0),
        };
        // The energy that contacts will dissipate when they break is a property of their life: what
        // was there at first, and what re-formed contacts brought with them, less what is left. No
        // integral over breaks is needed.
        let lost = initial_breaking_energy + born - at(&energy_curves.breaking_energy);
        BranchEnergies { elastic: at(&energy_curves.energy), lost, broken }
    }

    fn energy_curves(&self, monitor: &mut dyn Monitor) -> Result<EnergyCurves> {
        Ok(match &self.motion {
            Motion::Renewed(renewal) => {
                let atoms: Vec<_> = renewal.solution.atoms.iter().map(|a| (a.position, a.weight)).collect();
                EnergyCurves {
                    energy: renewal.sum(Life::energy, monitor)?,
                    breaking_energy: renewal.sum(Life::breaking_energy, monitor)?,
                    yet_to_break: renewal.solution.density.integrated_from_end(0.0, &atoms),
                }
            }
            Motion::Held { first, .. } => EnergyCurves {
                energy: first.energy().curve().clone(),
                breaking_energy: first.breaking_energy().curve().clone(),
                yet_to_break: first.survival().curve().clone(),
            },
        })
    }

    /// The contacts at the advance u, seen in the direction of motion. At the end of the cell those that
    /// break simultaneously there are still present unless they have been `crossed`; none of them has
    /// re-formed.
    pub(super) fn layers(&self, u: f64, cell: usize, crossed: bool, contacts: &Contacts) -> Vec<Layer> {
        let mut layers: Vec<_> = self.first().layers().iter().map(|layer| layer.advanced(u)).collect();
        if let Motion::Renewed(renewal) = &self.motion {
            layers.push(renewal.born(u, cell));
        }
        let threshold_atoms = threshold_atoms(contacts.thresholds.as_ref());
        let begun = self.force().boundaries.get(cell).copied().unwrap_or(u);
        let since = if crossed { 0.0 } else { (u - begun).max(0.0) };
        layers.iter_mut().for_each(|layer| layer.mark_passed(&threshold_atoms, since));
        simplified(layers, contacts.thresholds.as_ref())
    }
}

/// The value at u of the polynomial of a cell; 0 after the last.
fn at(curve: &Piecewise, u: f64, cell: usize) -> f64 {
    if cell < curve.coefficients.len() { curve.value_in(cell, u) } else { 0.0 }
}
