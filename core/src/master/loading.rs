//! Force and energies of contacts along one way of the slider, whether what breaks re-forms or stays free.

use std::sync::{Arc, OnceLock};

use super::renewal::{RenewalSolution, slope};
use super::{Stretches, Tolerance};
use crate::Result;
use crate::contacts::Contacts;
use crate::life::{Layer, Life, tidied, walls};
use crate::monitor::Monitor;
use crate::numerics::breaks::same_position;
use crate::numerics::piecewise::Piecewise;
use crate::numerics::volterra::Kernel;

/// What contacts do as the slider goes one way from where they are: curves of the advance u, per contact and per unit
/// stiffness.
#[derive(Debug)]
pub(super) struct LoadingBranch {
    motion: Motion,
    ledger: OnceLock<Ledger>,
}

/// What becomes of contacts that break.
#[derive(Debug)]
enum Motion {
    /// They re-form.
    Renewed(Box<RenewalSolution>),
    /// They stay free.
    Held { first: Arc<Life>, slope: Piecewise },
}

/// Energies and breaks along a course.
#[derive(Debug)]
struct Ledger {
    energy: Piecewise,
    /// Elastic energy that the unbroken will have lost when all have broken.
    breaking_energy: Piecewise,
    /// What breaks from u on.
    yet_to_break: Piecewise,
}

/// Energies and breaks since the beginning of a course, per contact and per unit stiffness.
#[derive(Debug, Clone, Copy)]
pub(super) struct BranchEnergies {
    pub(super) elastic: f64,
    pub(super) lost: f64,
    pub(super) broken: f64,
}

impl LoadingBranch {
    /// The course on which what breaks re-forms, solved up to the advance `end`.
    ///
    /// # Errors
    /// Those of [`RenewalSolution::solve`].
    pub(super) fn renewed(
        first: Arc<Life>,
        reborn: &Arc<Life>,
        end: f64,
        tolerance: Tolerance,
        monitor: &mut dyn Monitor,
    ) -> Result<Self> {
        let leg = RenewalSolution::solve(&first, reborn, end, tolerance, monitor)?;
        Ok(Self { motion: Motion::Renewed(Box::new(leg)), ledger: OnceLock::new() })
    }

    /// The course on which what breaks stays free.
    pub(super) fn held(first: Arc<Life>) -> Self {
        let slope = slope(first.force().curve(), &first);
        Self { motion: Motion::Held { first, slope }, ledger: OnceLock::new() }
    }

    /// The same course, solved up to `end`.
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
            Motion::Renewed(leg) => {
                Self::renewed(leg.first.clone(), &leg.reborn, end, tolerance, monitor).map(Some)
            }
            Motion::Held { .. } => Ok(None),
        }
    }

    /// The life of the contacts that are there at its beginning.
    pub(super) fn first(&self) -> &Arc<Life> {
        match &self.motion {
            Motion::Renewed(leg) => &leg.first,
            Motion::Held { first, .. } => first,
        }
    }

    /// Where the solution ends; on a course where nothing re-forms, where nothing is left.
    pub(super) fn end(&self) -> f64 {
        self.force().end()
    }

    /// Estimated error of F, per unit stiffness, mean life and mean stiffness, where the stretches at its beginning are right.
    pub(super) fn error(&self) -> f64 {
        match &self.motion {
            Motion::Renewed(leg) => leg.error,
            Motion::Held { first, .. } => first.error(),
        }
    }

    /// The density of stretches at the advance u, and its atoms, where what breaks re-forms.
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
            Motion::Renewed(leg) => leg.stretch_density(u, stretches, monitor).map(Some),
            Motion::Held { .. } => Ok(None),
        }
    }

    /// Whether what breaks stays free.
    pub(super) fn is_held(&self) -> bool {
        matches!(self.motion, Motion::Held { .. })
    }

    /// The cell that holds u, the right one at a boundary; one more than there are where nothing is left.
    pub(super) fn cell(&self, u: f64) -> usize {
        if u < self.end() { self.force().nearest(u) } else { self.force().coefficients.len() }
    }

    /// Where a cell ends; infinite where nothing is left.
    pub(super) fn cell_end(&self, cell: usize) -> f64 {
        self.force().boundaries.get(cell + 1).copied().unwrap_or(f64::INFINITY)
    }

    /// Whether contacts break together at the end of a cell.
    pub(super) fn breaks_after(&self, cell: usize) -> bool {
        let (end, before) = (self.cell_end(cell), self.force().boundaries.get(cell).copied().unwrap_or(0.0));
        let near = |x: f64| x > before && same_position(x, end);
        match &self.motion {
            Motion::Renewed(leg) => {
                let atoms = &leg.solution.atoms;
                let first = atoms.partition_point(|a| a.position <= before);
                atoms.get(first).is_some_and(|a| near(a.position))
            }
            Motion::Held { first, .. } => first.breaking().atoms().any(|a| near(a.position)),
        }
    }

    /// The share of all contacts that is there, by quadrature, where what breaks re-forms.
    pub(super) fn kept(&self, u: f64) -> Option<f64> {
        match &self.motion {
            Motion::Renewed(leg) => Some(leg.sum_at(Life::survival, u)),
            Motion::Held { .. } => None,
        }
    }

    /// Force and slope at u by the polynomials of a cell.
    pub(super) fn response(&self, u: f64, cell: usize) -> (f64, f64) {
        (at(self.force(), u, cell), at(self.slope(), u, cell))
    }

    /// The force: a polynomial on each of its cells.
    fn force(&self) -> &Piecewise {
        match &self.motion {
            Motion::Renewed(leg) => &leg.force,
            Motion::Held { first, .. } => first.force().curve(),
        }
    }

    /// Its slope, on the same cells.
    fn slope(&self) -> &Piecewise {
        match &self.motion {
            Motion::Renewed(leg) => &leg.slope,
            Motion::Held { slope, .. } => slope,
        }
    }

    /// Energies and breaks up to the advance u.
    ///
    /// What breaks at a stretch x loses ½k x² there; what re-forms brings its ½k r², booked when it breaks.
    pub(super) fn account(&self, u: f64, cell: usize) -> BranchEnergies {
        let ledger = self.ledger.get_or_init(|| self.ledger());
        let at = |curve: &Piecewise| at(curve, u, cell);
        let start = |kernel: &Kernel| self::at(kernel.curve(), 0.0, 0);
        let brought = |life: &Life| start(life.breaking_energy()) - life.newborn_energy();
        let doomed = self::at(&ledger.breaking_energy, 0.0, 0);
        let (broken, born) = match &self.motion {
            Motion::Renewed(leg) => {
                let broken = self::at(&ledger.yet_to_break, 0.0, 0) - at(&ledger.yet_to_break);
                (broken, broken * brought(&leg.reborn))
            }
            Motion::Held { first, .. } => (start(first.survival()) - at(&ledger.yet_to_break), 0.0),
        };
        let lost = doomed + born - at(&ledger.breaking_energy);
        BranchEnergies { elastic: at(&ledger.energy), lost, broken }
    }

    fn ledger(&self) -> Ledger {
        match &self.motion {
            Motion::Renewed(leg) => {
                let atoms = leg.solution.atoms.iter().map(|a| (a.position, a.weight));
                Ledger {
                    energy: leg.sum(Life::energy, &mut ()).unwrap_or_default(),
                    breaking_energy: leg.sum(Life::breaking_energy, &mut ()).unwrap_or_default(),
                    yet_to_break: leg.solution.density.integrated_from_end(0.0, &atoms.collect::<Vec<_>>()),
                }
            }
            Motion::Held { first, .. } => Ledger {
                energy: first.energy().curve().clone(),
                breaking_energy: first.breaking_energy().curve().clone(),
                yet_to_break: first.survival().curve().clone(),
            },
        }
    }

    /// The contacts at the advance u, seen along the way; at the end of the cell, those that break together there have
    /// `crossed` it or not, but none has re-formed.
    pub(super) fn layers(&self, u: f64, cell: usize, crossed: bool, contacts: &Contacts) -> Vec<Layer> {
        let mut layers: Vec<_> = self.first().layers().iter().map(|layer| layer.advanced(u)).collect();
        if let Motion::Renewed(leg) = &self.motion {
            layers.push(leg.born(u, cell));
        }
        let walls = walls(contacts.thresholds.as_ref());
        let begun = self.force().boundaries.get(cell).copied().unwrap_or(u);
        let since = if crossed { 0.0 } else { (u - begun).max(0.0) };
        layers.iter_mut().for_each(|layer| layer.pass(&walls, since));
        tidied(layers, contacts.thresholds.as_ref())
    }
}

/// The value at u of the polynomial of a cell; 0 past the last.
fn at(curve: &Piecewise, u: f64, cell: usize) -> f64 {
    if cell < curve.coefficients.len() { curve.value_in(cell, u) } else { 0.0 }
}
