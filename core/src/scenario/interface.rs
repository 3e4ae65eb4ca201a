//! `[interface]`: cells, or single contacts, that move differently since the slider between them deforms.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Drive, Ensemble, exactly_one, positive, size};
use crate::contacts::{Contacts, Initial};
use crate::elastic::cells::{Cells, Curves, Populations, scales};
use crate::elastic::{self, coupling};
use crate::ensemble::lattice::{self, Lattice};
use crate::master::{MasterEquation, Stretches};
use crate::monitor::Monitor;
use crate::population::Population;
use crate::shape::{self, Shape};
use crate::{Error, Result};

/// An interface of cells coupled by elasticity, or of contacts coupled one by one; `[drive]` moves its top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Interface {
    /// Length of a chain, such as `[1000]`, or rows and columns of a lattice, such as `[512, 512]`.
    pub cells: Vec<usize>,
    /// Whether a cell has many contacts, or is one.
    #[serde(default)]
    pub contacts: PerCell,
    /// Stiffness K_0 of the spring between a cell and the drive, 0 or above.
    pub connection: f64,
    /// What couples cells to each other.
    pub coupling: Coupling,
    /// What is beyond the outermost cells.
    #[serde(default)]
    pub edges: Edges,
    /// Which cells the drive pulls.
    #[serde(default)]
    pub loading: Loading,
    /// What happens to cells that have lost their balance, where they have many contacts; `reset` by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = "reset"))]
    pub slip: Option<CellSlip>,
    /// Viscous drag of a moving cell, force per velocity, above 0: events then take time, and fronts have speeds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub viscosity: Option<f64>,
    /// How cells of many contacts differ; without this table they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disorder: Option<Scales>,
    /// How closely the drive at which balance is lost is found, in mean thresholds.
    #[serde(default = "drive_tolerance")]
    pub drive_tolerance: f64,
    /// Drive from which on events are recorded, 0 or above.
    #[serde(default)]
    pub catalogue_from: f64,
}

/// What a cell is.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PerCell {
    /// Contacts that move together, `contacts.count` of them: so many that they follow the master equation, or
    /// `ensemble.size` that are followed one by one.
    #[default]
    Many,
    /// One contact, which re-forms when the slide is over.
    One,
}

/// What couples cells.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Coupling {
    /// Springs between nearest neighbours.
    Neighbours {
        /// K_int, stiffness of such a spring, 0 or above.
        stiffness: f64,
    },
    /// An elastic half-space.
    HalfSpace {
        /// G*, its modulus, force per area, above 0.
        modulus: f64,
        /// Side a of a cell, above 0.
        cell: f64,
    },
}

/// What is beyond the outermost cells.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Edges {
    /// Nothing; beyond contacts coupled one by one something rigid.
    #[default]
    Open,
    /// The cells of the other side.
    Periodic,
}

/// Which cells the drive pulls.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Loading {
    /// All of them.
    #[default]
    Uniform,
    /// The first of a chain, the first row of a lattice.
    Edge,
}

/// What happens to cells that have lost their balance.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CellSlip {
    /// All contacts of an unstable cell break and re-form.
    #[default]
    Reset,
    /// Cells move to the next balance, contacts breaking and re-forming on the way.
    Overdamped,
}

/// How cells differ: all lengths of cell j, its thresholds foremost, are those of the contacts times s_j.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Scales {
    /// Standard deviation of s_j, drawn from a Gaussian of mean 1, 0 or above.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub std: Option<f64>,
    /// Seed of the draws; 1 by default.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(extend("default" = 1))]
    pub seed: Option<u64>,
    /// CSV file with the one column `scale`, a row for each cell, along rows, instead of `std`; its path is relative to the
    /// scenario.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// The scales themselves, instead of `file`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scale: Option<Vec<f64>>,
}

fn drive_tolerance() -> f64 {
    Interface::DRIVE_TOLERANCE
}

/// Bytes that a contact coupled one by one takes at most.
const BYTES_PER_CONTACT: f64 = 64.0;
/// Bytes that a cell takes, with what it takes to couple it.
const BYTES_PER_CELL: f64 = 128.0;
/// Bytes that a cell of few contacts takes, and each of them.
const BYTES_PER_ENSEMBLE: [f64; 2] = [16e3, 256.0];

impl Interface {
    /// The accuracy of drives, in mean thresholds, where nothing is said.
    pub const DRIVE_TOLERANCE: f64 = 1e-6;

    /// Whether every value makes sense, and goes with the contacts, the drive and the ensemble.
    ///
    /// # Errors
    /// The first that does not, with its full path.
    pub fn check(&self, contacts: &Contacts, drive: &Drive, ensemble: Option<&Ensemble>) -> Result<()> {
        onwards(drive).map_err(|e| e.under("drive"))?;
        self.check_cells(contacts, ensemble)
    }

    /// The same, whatever drives the cells.
    ///
    /// # Errors
    /// The first value that does not, with its full path.
    pub fn check_cells(&self, contacts: &Contacts, ensemble: Option<&Ensemble>) -> Result<()> {
        if let Some(rule) = contacts.rules.first() {
            let expected =
                "contacts that know no time, since balance of cells is followed along the drive alone";
            return Err(Error::invalid(format!("contacts.{rule}"), expected, "one that does"));
        }
        self.values().map_err(|e| e.under("interface"))?;
        match self.contacts {
            PerCell::Many => self.many(ensemble),
            PerCell::One => self.one(contacts, ensemble),
        }
    }

    /// Number of cells.
    pub fn size(&self) -> usize {
        self.cells.iter().fold(1, |size, &side| size.saturating_mul(side))
    }

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

    /// Values that make no sense whatever a cell is; keys are relative to this table.
    fn values(&self) -> Result<()> {
        let shape = self.shape()?;
        let bytes = match self.contacts {
            PerCell::Many => BYTES_PER_CELL,
            PerCell::One => BYTES_PER_CONTACT,
        };
        size::check("cells", shape.size(), bytes)?;
        not_negative("connection", self.connection)?;
        self.coupling.check().map_err(|e| e.under("coupling"))?;
        self.viscosity.map(|viscosity| positive("viscosity", viscosity)).transpose()?;
        positive("drive_tolerance", self.drive_tolerance)?;
        not_negative("catalogue_from", self.catalogue_from).map(drop)
    }

    fn shape(&self) -> Result<Shape> {
        match self.cells[..] {
            [length] if length > 0 => Ok(Shape::Chain(length)),
            [rows, columns] if rows > 0 && columns > 0 => Ok(Shape::Square([rows, columns])),
            _ => {
                let expected = "[length] of a chain or [rows, columns] of a lattice, each 1 or more";
                Err(Error::invalid("cells", expected, format!("{:?}", self.cells)))
            }
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
                Err(one_by_one("coupling.half_space", "coupling.neighbours", "a half-space"))
            }
        }
    }

    /// What cells of contacts that move together need, and what does not go with them.
    fn many(&self, ensemble: Option<&Ensemble>) -> Result<()> {
        let check = || {
            positive("connection", self.connection)?;
            self.shape()?.check(self.edges.into())?;
            self.disorder.as_ref().map_or(Ok(()), |scales| scales.build(self.size()).map(drop))
        };
        check().map_err(|e| e.under("interface"))?;
        ensemble.map_or(Ok(()), |ensemble| self.few(ensemble))
    }

    /// What cells of few contacts need.
    fn few(&self, ensemble: &Ensemble) -> Result<()> {
        let Some(size) = ensemble.size else {
            let expected = "the number of contacts followed in each cell of the interface";
            return Err(Error::invalid("ensemble.size", expected, "none"));
        };
        if self.slip.unwrap_or_default() == CellSlip::Reset {
            let expected = "\"overdamped\" beside [ensemble], where balance is lost at every break: in a reset all \
                            contacts of a cell would break with its first one";
            return Err(Error::invalid("interface.slip", expected, "reset"));
        }
        let [cell, contact] = BYTES_PER_ENSEMBLE;
        size::check("interface.cells", self.size(), cell + contact * size as f64)
    }

    /// What does not go with single contacts.
    fn one(&self, contacts: &Contacts, ensemble: Option<&Ensemble>) -> Result<()> {
        let given = [
            ("slip", self.slip.is_some(), "re-form when the slide is over", "a rule of slip"),
            ("viscosity", self.viscosity.is_some(), "know no time", "one"),
            ("disorder", self.disorder.is_some(), "draw their thresholds from contacts.thresholds", "one"),
            ("loading", self.loading == Loading::Edge, "are all pulled by the drive", "edge"),
        ];
        if let Some((key, _, why, found)) = given.into_iter().find(|given| given.1) {
            let expected =
                format!("none beside interface.contacts = \"one\": contacts coupled one by one {why}");
            return Err(Error::invalid(key, expected, found).under("interface"));
        }
        if let Some(size) = ensemble.and_then(|ensemble| ensemble.size) {
            let expected = "none beside interface.contacts = \"one\", where every cell is a contact";
            return Err(Error::invalid("ensemble.size", expected, size));
        }
        Lattice::check(contacts, &self.springs().map_err(|e| e.under("interface"))?)
    }
}

impl Coupling {
    fn check(&self) -> Result<()> {
        match *self {
            Self::Neighbours { stiffness } => not_negative("neighbours.stiffness", stiffness).map(drop),
            Self::HalfSpace { modulus, cell } => {
                positive("half_space.modulus", modulus)?;
                positive("half_space.cell", cell).map(drop)
            }
        }
    }
}

impl Scales {
    /// The scales of so many cells.
    fn build(&self, cells: usize) -> Result<Vec<f64>> {
        self.check(cells).map_err(|e| e.under("disorder"))?;
        match &self.scale {
            Some(scale) => Ok(scale.clone()),
            None => scales(cells, self.std.unwrap_or(0.0), self.seed.unwrap_or(1)),
        }
    }

    /// Checks the values for so many cells.
    fn check(&self, cells: usize) -> Result<()> {
        let given = [("std", self.std.is_some()), ("file", self.file.is_some() || self.scale.is_some())];
        exactly_one("", "either std or file", &given)?;
        if let (Some(seed), None) = (self.seed, self.std) {
            return Err(Error::invalid("seed", "none beside file: nothing is drawn", seed));
        }
        self.std.map(|std| not_negative("std", std)).transpose()?;
        // TOML has no whole numbers above this.
        if let Some(seed) = self.seed.filter(|&seed| i64::try_from(seed).is_err()) {
            return Err(Error::invalid("seed", "a whole number below 2^63", seed));
        }
        let Some(scales) = &self.scale else { return Ok(()) };
        if scales.len() != cells {
            return Err(Error::invalid("scale", format!("{cells} scales, one for each cell"), scales.len()));
        }
        match scales.iter().position(|&scale| !(scale.is_finite() && scale > 0.0)) {
            Some(cell) => Err(Error::invalid(format!("scale.{cell}"), "a number above 0", scales[cell])),
            None => Ok(()),
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

/// Refuses drives that an interface does not follow.
fn onwards(drive: &Drive) -> Result<()> {
    let given = [("turning_points", drive.turning_points.is_some()), ("force_to", drive.force_to.is_some())];
    match given.into_iter().find(|given| given.1) {
        Some((key, _)) => {
            let expected = "a distance: an interface is driven forward only, through its connection";
            Err(Error::invalid(key, expected, key))
        }
        None => Ok(()),
    }
}

fn one_by_one(key: &str, expected: &str, found: &str) -> Error {
    Error::invalid(key, format!("{expected} beside interface.contacts = \"one\""), found)
}

fn not_negative(key: &str, value: f64) -> Result<f64> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::invalid(key, "a finite number, 0 or above", value))
    }
}
