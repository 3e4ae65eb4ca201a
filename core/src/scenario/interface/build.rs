//! An interface as the objects that it describes.

use super::super::Ensemble;
use super::{CellSlip, Coupling, Edges, Interface, Loading};
use crate::contacts::{Contacts, Initial};
use crate::elastic::cells::{Cells, Curves, Populations};
use crate::elastic::{self, coupling};
use crate::ensemble::lattice::{self, Lattice};
use crate::master::{MasterEquation, Stretches};
use crate::monitor::Monitor;
use crate::population::Population;
use crate::shape;
use crate::{Error, Result};

impl Interface {
    /// Contacts coupled one by one.
    ///
    /// # Errors
    /// What [`Lattice::new`] refuses.
    pub fn lattice(
        &self,
        contacts: Contacts,
        initial: Initial,
        ensemble: Option<&Ensemble>,
    ) -> Result<Lattice> {
        let Ensemble { seed, disorder, .. } = ensemble.cloned().unwrap_or_default();
        Lattice::new(contacts, initial, &self.springs()?, seed, disorder.into())
    }

    /// Cells whose contacts move together: by the master equation, or those of an `ensemble`, of which each cell has
    /// `size`, the first cell the first ones.
    ///
    /// # Errors
    /// What the master equation, the ensemble, cells and couplings refuse; stopped by the monitor.
    pub fn deformable(
        &self,
        contacts: Contacts,
        initial: &Initial,
        tolerance: f64,
        ensemble: Option<&Ensemble>,
        monitor: &mut dyn Monitor,
    ) -> Result<elastic::Interface> {
        let length = contacts.thresholds.mean();
        let scales = self.disorder.as_ref().map(|scales| scales.build(self.size())).transpose();
        let scales = scales.map_err(|e| e.under("interface"))?;
        let cells: Box<dyn Cells> = match ensemble {
            Some(ensemble) => {
                let drawn = self.drawn(&ensemble.build(contacts, initial.clone())?, monitor)?;
                let cells = Populations::new(drawn, monitor)?;
                Box::new(if let Some(scales) = scales { cells.scaled(&scales)? } else { cells })
            }
            None => {
                let population = MasterEquation::new(contacts, initial)?.population(tolerance)?;
                let cells = Curves::new(&population, self.size(), monitor)?;
                Box::new(if let Some(scales) = scales { cells.scaled(scales)? } else { cells })
            }
        };
        let build = || elastic::Interface::new(cells, self.elasticity()?, self.setting(length));
        build().map_err(|e| e.under("interface"))
    }

    /// Stretches Q[x, X(r)] of the contacts of a cell, which follow an equation: of scale s, Q(x/s; X/s)/s.
    ///
    /// # Errors
    /// Those of [`MasterEquation::pull`].
    pub fn stretch_density(
        equation: &MasterEquation,
        cell: elastic::Standing,
        stretches: &[f64],
        tolerance: f64,
        monitor: &mut dyn Monitor,
    ) -> Result<Stretches> {
        let elastic::Standing { advance, scale, renewed } = cell;
        let equation = if renewed { equation.renewed() } else { equation.clone() };
        let distance = advance.max(equation.contacts().thresholds.mean());
        let places: Vec<f64> = stretches.iter().map(|x| x / scale).collect();
        let mut found = equation.pull(distance, tolerance, monitor)?.stretch_density(advance, &places);
        found.density.iter_mut().for_each(|density| *density /= scale);
        found.atoms.iter_mut().for_each(|atom| atom.position *= scale);
        Ok(found)
    }

    /// The contacts of each cell.
    fn drawn(
        &self,
        ensemble: &crate::ensemble::Ensemble,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Box<dyn Population>>> {
        let cell = |cell: usize| -> Result<Box<dyn Population>> {
            let first = (cell * ensemble.size()) as u64;
            Ok(Box::new(ensemble.clone().numbered_from(first).population(monitor)?))
        };
        (0..self.size()).map(cell).collect()
    }

    fn elasticity(&self) -> Result<Box<dyn elastic::Coupling>> {
        let (shape, edges) = (self.shape()?, self.edges.into());
        match self.coupling {
            Coupling::Neighbours { stiffness } => coupling::neighbours(shape, edges, stiffness),
            Coupling::HalfSpace { modulus, cell } => coupling::half_space(shape, edges, modulus, cell),
        }
    }

    /// How cells are driven, the mean threshold being a `length`.
    fn setting(&self, length: f64) -> elastic::Setting {
        elastic::Setting {
            connection: self.connection,
            loading: match self.loading {
                Loading::Uniform => elastic::Loading::Uniform,
                Loading::Edge => elastic::Loading::Edge,
            },
            slip: match self.slip.unwrap_or_default() {
                CellSlip::Reset => elastic::Slip::Reset,
                CellSlip::Overdamped => elastic::Slip::Overdamped,
            },
            viscosity: self.viscosity,
            drive_tolerance: self.drive_tolerance * length,
            area: match self.coupling {
                Coupling::Neighbours { .. } => 1.0,
                Coupling::HalfSpace { cell, .. } => cell * cell,
            },
        }
    }

    /// Springs between single contacts.
    ///
    /// # Errors
    /// A half-space.
    pub fn springs(&self) -> Result<lattice::Coupling> {
        match self.coupling {
            Coupling::Neighbours { stiffness } => Ok(lattice::Coupling {
                shape: self.shape()?,
                edges: self.edges.into(),
                neighbours: stiffness,
                connection: self.connection,
            }),
            Coupling::HalfSpace { .. } => {
                let expected = "coupling.neighbours beside interface.contacts = \"one\"";
                Err(Error::invalid("coupling.half_space", expected, "a half-space"))
            }
        }
    }
}

impl From<Edges> for shape::Edges {
    fn from(edges: Edges) -> Self {
        match edges {
            Edges::Open => Self::Open,
            Edges::Periodic => Self::Periodic,
        }
    }
}
