//! Builds the objects that `[interface]` describes.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use super::super::{Block, Ensemble};
use super::{Interface, PerCell, Scales};
use crate::contacts::{Contacts, Initial};
use crate::elastic::cells::{Cells, Curves, Populations};
use crate::elastic::coupling::Elasticity;
use crate::elastic::rate_dependent::Scaled;
use crate::elastic::{self, RateDependentInterface, RateDependentInterfaceParameters};
use crate::ensemble::lattice::{self, Lattice};
use crate::law::{SharedLaw, scattered};
use crate::master::{MasterEquation, Stretches, Tolerance, Transport};
use crate::monitor::{Aside, Monitor, Part, report};
use crate::population::Population;
use crate::rate_dependent::{PopulationInTime, RateDependentContacts};
use crate::{Error, Result};

/// How the contacts of cells in time are at the start.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum CellStart<'a> {
    /// Initial stretches, all contacts of age 0.
    Initial(&'a Initial),
    /// In steady sliding of all cells at this velocity.
    Steady(f64),
}

impl Interface {
    /// Contacts coupled one by one, in time if they have a velocity.
    ///
    /// # Errors
    /// What [`Lattice::new_with`] and [`Lattice::at_with`] refuse; stopped by the monitor.
    pub fn lattice(
        &self,
        contacts: Contacts,
        initial: Initial,
        ensemble: Option<&Ensemble>,
        velocity: Option<f64>,
        monitor: &mut dyn Monitor,
    ) -> Result<Lattice> {
        let Ensemble { seed, disorder, .. } = ensemble.cloned().unwrap_or_default();
        let springs = self.springs()?;
        match velocity {
            Some(velocity) => {
                Lattice::at_with(contacts, initial, &springs, velocity, (seed, disorder), monitor)
            }
            None => Lattice::new_with(contacts, initial, &springs, seed, disorder, monitor),
        }
    }

    /// Cells whose contacts move together. They follow the master equation, or are those of an `ensemble`: `size` contacts in
    /// each cell of mean area, the first ones in the first cell.
    ///
    /// # Errors
    /// What the master equation, the ensemble, cells and couplings refuse; stopped by the monitor.
    pub fn deformable(
        &self,
        contacts: Contacts,
        initial: &Initial,
        tolerance: impl Into<Tolerance>,
        ensemble: Option<&Ensemble>,
        monitor: &mut dyn Monitor,
    ) -> Result<elastic::Interface> {
        let length = contacts.thresholds.mean();
        let scales = self.disorder.as_ref().map(|scales| scales.build(self.size())).transpose();
        let scales = scales.map_err(|e| e.under("interface"))?;
        let areas = self.relative_areas();
        let cells: Box<dyn Cells> = match ensemble {
            Some(ensemble) => {
                let drawn = self.drawn(&ensemble.build(contacts, initial.clone())?, monitor)?;
                let cells = Populations::new(drawn, monitor)?;
                let cells = if let Some(scales) = scales { cells.scaled(&scales)? } else { cells };
                Box::new(if let Some(areas) = areas { cells.with_areas(areas)? } else { cells })
            }
            None => {
                let aside = &mut Aside { fraction: 0.0, monitor };
                let population =
                    MasterEquation::new_with(contacts, initial, aside)?.population_with(tolerance, aside)?;
                let cells = Curves::new_with(&population, self.size(), aside)?;
                let cells = if let Some(scales) = scales { cells.scaled(scales)? } else { cells };
                Box::new(if let Some(areas) = areas { cells.with_areas(areas)? } else { cells })
            }
        };
        let aside = &mut Aside { fraction: 0.0, monitor };
        let coupling = self.elasticity(aside)?;
        elastic::Interface::new_with(cells, coupling, self.setting(length), aside)
    }

    /// Cells that move in time. Time-dependent contacts are solved by transport with a `tolerance`, athermal ones by the master
    /// equation, or they are those of an `ensemble`: `size` contacts in each cell of mean area, the first ones in the first
    /// cell. `step` is the tolerance of a step of a cell, a length.
    ///
    /// # Errors
    /// What transport, the ensemble, cells and couplings refuse; an ensemble in steady sliding.
    pub fn in_time(
        &self,
        contacts: &Contacts,
        start: CellStart<'_>,
        tolerance: f64,
        step: f64,
        ensemble: Option<&Ensemble>,
        monitor: &mut dyn Monitor,
    ) -> Result<RateDependentInterface> {
        let scales =
            self.disorder.as_ref().map_or_else(|| Ok(vec![1.0; self.size()]), |s| s.build(self.size()));
        let scales = scales.map_err(|e| e.under("interface"))?;
        let cells = match start {
            CellStart::Initial(initial) if !contacts.rules.are_time_dependent() => {
                self.athermal_in_time(contacts, initial, ensemble, monitor)?
            }
            _ => {
                let sizes = ensemble.map(|ensemble| self.contacts_of_cells(ensemble.size()));
                let ensemble = ensemble.zip(sizes.as_deref());
                rate_dependent(contacts, &scales, start, tolerance, ensemble, monitor)?
            }
        };
        let areas = self.relative_areas().unwrap_or_else(|| vec![1.0; self.size()]);
        let scaled = |((cell, &scale), &area): ((_, &f64), &f64)| -> Result<Box<dyn RateDependentContacts>> {
            Ok(Box::new(Scaled::new(cell, scale)?.on_area(area)?))
        };
        let cells = cells.into_iter().zip(&scales).zip(&areas).map(scaled).collect::<Result<_>>()?;
        let elastic::InterfaceParameters { connection, loading, area, .. } = self.setting(1.0);
        let setting = RateDependentInterfaceParameters {
            connection,
            loading,
            mass: self.mass.unwrap_or(0.0),
            viscosity: self.viscosity.unwrap_or(if self.mass.is_some() { 0.0 } else { f64::NAN }),
            tolerance: step,
            slip_fraction: ensemble.map_or(0.0, |_| Block::SLIP_FRACTION),
            area,
        };
        let aside = &mut Aside { fraction: 1.0, monitor };
        let coupling = self.elasticity(aside)?;
        RateDependentInterface::new_with(cells, coupling, setting, aside)
    }

    /// The same interface with the disorder drawn from the seed plus `further`.
    #[must_use]
    pub fn redrawn(&self, further: usize) -> Self {
        let redrawn =
            |scales: &Scales| Scales { seed: Some(scales.seed() + further as u64), ..scales.clone() };
        Self { disorder: self.disorder.as_ref().map(redrawn), ..self.clone() }
    }

    /// The distribution of the thresholds of all cells together; those of a cell have the distribution of `contacts` times its
    /// scale factor.
    ///
    /// # Errors
    /// Those of [`scattered`].
    pub fn thresholds(&self, contacts: &Contacts) -> Result<SharedLaw> {
        match self.disorder.as_ref().and_then(|scales| scales.std) {
            Some(std) if std > 0.0 => Ok(Arc::new(scattered(contacts.thresholds.as_ref(), std)?)),
            _ => Ok(contacts.thresholds.clone()),
        }
    }

    /// κ, the fraction of the force lost by a breaking contact that other contacts gain. For cells of N contacts it is
    /// N⟨k⟩/(N⟨k⟩ + K_0), whatever couples the cells.
    ///
    /// # Errors
    /// Single contacts on a half-space.
    pub fn mean_field_coupling(&self, contacts: &Contacts) -> Result<f64> {
        match self.contacts {
            PerCell::One => Ok(self.springs()?.mean_field_coupling()),
            PerCell::Many => {
                let stiffness = contacts.count * contacts.stiffness.mean(contacts.thresholds.as_ref());
                Ok(stiffness / (stiffness + self.connection))
            }
        }
    }

    /// Distribution of stretches Q[x, X(r)] of the contacts of a cell that follows the master equation: Q(x/s; X/s)/s for
    /// the scale factor s.
    ///
    /// # Errors
    /// Those of [`MasterEquation::pull`].
    pub fn stretch_density(
        equation: &MasterEquation,
        cell: elastic::Standing,
        stretches: &[f64],
        tolerance: impl Into<Tolerance>,
        monitor: &mut dyn Monitor,
    ) -> Result<Stretches> {
        let elastic::Standing { advance, scale, renewed } = cell;
        let equation = if renewed { equation.renewed() } else { equation.clone() };
        let distance = advance.max(equation.contacts().thresholds.mean());
        let places: Vec<f64> = stretches.iter().map(|x| x / scale).collect();
        let pull = equation.pull_with(distance, tolerance, monitor)?;
        let aside = &mut Aside { fraction: 1.0, monitor };
        let mut found = pull.stretch_density_with(advance, &places, aside)?;
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
        let mut first = 0;
        let cell = |size: usize| -> Result<Box<dyn Population>> {
            let cell = ensemble.clone().of_size(size)?.numbered_from(first);
            first += size as u64;
            Ok(Box::new(cell.population_with(monitor)?))
        };
        self.contacts_of_cells(ensemble.size()).into_iter().map(cell).collect()
    }

    /// Athermal contacts of each cell, in units of its scale.
    fn athermal_in_time(
        &self,
        contacts: &Contacts,
        initial: &Initial,
        ensemble: Option<&Ensemble>,
        monitor: &mut dyn Monitor,
    ) -> Result<Vec<Box<dyn RateDependentContacts>>> {
        let stiffness = contacts.count * contacts.stiffness.mean(contacts.thresholds.as_ref());
        let in_time = |population: Box<dyn Population>| -> Box<dyn RateDependentContacts> {
            Box::new(PopulationInTime::new(population, stiffness))
        };
        if let Some(ensemble) = ensemble {
            let drawn = self.drawn(&ensemble.build(contacts.clone(), initial.clone())?, monitor)?;
            return Ok(drawn.into_iter().map(in_time).collect());
        }
        let aside = &mut Aside { fraction: 0.0, monitor };
        let equation = MasterEquation::new_with(contacts.clone(), initial, aside)?;
        // Far more accurate than the steps in time, whose error alone is estimated.
        let population = equation.population_with(Tolerance::default(), aside)?;
        Ok((0..self.size()).map(|_| in_time(population.copy())).collect())
    }

    /// What couples the cells.
    ///
    /// # Errors
    /// Cells that the coupling refuses; stopped by the monitor.
    pub fn elasticity(&self, monitor: &mut dyn Monitor) -> Result<Box<dyn elastic::Coupling>> {
        self.coupling.build(self.shape()?, self.edges, monitor)
    }

    /// Parameters of the interface for contacts of mean threshold `length`.
    fn setting(&self, length: f64) -> elastic::InterfaceParameters {
        elastic::InterfaceParameters {
            connection: self.connection,
            loading: self.loading,
            slip: self.slip.unwrap_or_default(),
            viscosity: self.viscosity,
            drive_tolerance: self.drive_tolerance * length,
            area: self.coupling.area(),
        }
    }

    /// Springs between single contacts.
    ///
    /// # Errors
    /// A half-space.
    pub fn springs(&self) -> Result<lattice::LatticeCoupling> {
        match self.coupling {
            Elasticity::Neighbours { stiffness } => Ok(lattice::LatticeCoupling {
                shape: self.shape()?,
                edges: self.edges,
                neighbours: stiffness,
                connection: self.connection,
            }),
            Elasticity::HalfSpace { .. } => {
                let expected = "coupling.neighbours beside interface.contacts = \"one\"";
                Err(Error::invalid("coupling.half_space", expected, "a half-space"))
            }
        }
    }
}

/// Time-dependent contacts of cells of these scales, in units of these. An ensemble has so many contacts in each cell.
fn rate_dependent(
    contacts: &Contacts,
    scales: &[f64],
    start: CellStart<'_>,
    tolerance: f64,
    ensemble: Option<(&Ensemble, &[usize])>,
    monitor: &mut dyn Monitor,
) -> Result<Vec<Box<dyn RateDependentContacts>>> {
    // Cells of the same temperature and friction of free contacts, and, in steady sliding, of the same velocity, share one
    // solution, which takes long to compute.
    let mut alike: HashMap<[Option<u64>; 3], Transport> = HashMap::new();
    let each = 1.0 / scales.len() as f64;
    let mut first = 0;
    let mut cell = |(cell, &scale): (usize, &f64)| -> Result<Box<dyn RateDependentContacts>> {
        let monitor = &mut Part::new(monitor, cell as f64 * each, each);
        report(monitor, 0.0)?;
        let contacts = in_units_of(scale, contacts);
        let energy = contacts.rules.temperature.map(|temperature| temperature.energy.to_bits());
        let free = Some(contacts.rules.free_friction.force.to_bits());
        // A cell of the scale s slides at v/s in its own units.
        let velocity = match start {
            CellStart::Initial(_) => None,
            CellStart::Steady(velocity) => Some((velocity / scale).to_bits()),
        };
        let cell: Box<dyn RateDependentContacts> = match ensemble {
            Some((ensemble, sizes)) => {
                let CellStart::Initial(initial) = start else { return Err(no_steady_ensemble()) };
                let drawn = ensemble.build(contacts, initial.clone())?.of_size(sizes[cell])?;
                let drawn = drawn.numbered_from(first);
                first += sizes[cell] as u64;
                Box::new(drawn.in_time_with(monitor)?)
            }
            None => Box::new(match alike.entry([energy, free, velocity]) {
                Entry::Occupied(known) => known.get().clone(),
                Entry::Vacant(new) => {
                    let solution = match start {
                        CellStart::Initial(initial) => {
                            Transport::new_with(contacts, initial, tolerance, monitor)?
                        }
                        CellStart::Steady(velocity) => {
                            Transport::steady_with(&contacts, velocity / scale, tolerance, monitor)?
                        }
                    };
                    new.insert(solution).clone()
                }
            }),
        };
        Ok(cell)
    };
    scales.iter().enumerate().map(&mut cell).collect()
}

/// The error of single contacts that are to begin in steady sliding.
pub(in crate::scenario) fn no_steady_ensemble() -> Error {
    let expected = "no ensemble of time-dependent contacts under a [block] or an [interface] beside start = \"steady\", which single contacts reach by sliding only";
    Error::invalid("ensemble", expected, "one")
}

/// Contacts of a cell in units of its scale factor: lengths and forces are divided by `scale`, energies by its square.
fn in_units_of(scale: f64, contacts: &Contacts) -> Contacts {
    let mut contacts = contacts.clone();
    contacts.rules.free_friction.force /= scale;
    if let Some(temperature) = &mut contacts.rules.temperature {
        temperature.energy /= scale * scale;
    }
    contacts
}
