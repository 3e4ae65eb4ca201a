//! The contacts of all cells of an interface as one batch: functions take and fill slices with one value per cell.

mod areas;
mod cell;
mod curve;
mod curves;
mod populations;
mod scales;
mod tabulate;

pub use areas::CellAreas;
pub use curves::Curves;
pub use populations::Populations;
pub use scales::scales;

use serde::{Deserialize, Serialize};

use crate::monitor::Monitor;
use crate::{Error, Result};

/// Energies and breaks of contacts, each summed on its own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CellEnergies {
    /// ∫F dX, the work done on them.
    pub work: f64,
    /// Elastic energy Σ ½k x².
    pub elastic: f64,
    /// Energy dissipated in breaks: Σ over breaks of ½k x_b², minus the ½k r² of re-formed contacts.
    pub lost: f64,
    /// Breaks, per contact of a cell of area 1.
    pub broken: f64,
}

impl CellEnergies {
    /// The energies of cells whose lengths and forces are `scale` times as large.
    #[must_use]
    pub(super) fn scaled(self, scale: f64) -> Self {
        // Forces scale like lengths since stiffness does not, hence energies with the square.
        let energy = scale * scale;
        Self { work: energy * self.work, elastic: energy * self.elastic, lost: energy * self.lost, ..self }
    }

    /// The energies and breaks of a cell of this area.
    #[must_use]
    pub(super) fn of_area(self, area: f64) -> Self {
        let Self { work, elastic, lost, broken } = self;
        Self { work: area * work, elastic: area * elastic, lost: area * lost, broken: area * broken }
    }

    /// The energies after all contacts of a cell of this area have broken and re-formed with the elastic energy `fresh`.
    #[must_use]
    pub(super) fn renewed(self, fresh: f64, area: f64) -> Self {
        let lost = self.lost + self.elastic - fresh;
        Self { lost, broken: self.broken + area, elastic: fresh, ..self }
    }
}

impl std::ops::Add for CellEnergies {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            work: self.work + other.work,
            elastic: self.elastic + other.elastic,
            lost: self.lost + other.lost,
            broken: self.broken + other.broken,
        }
    }
}

impl std::ops::Sub for CellEnergies {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            work: self.work - other.work,
            elastic: self.elastic - other.elastic,
            lost: self.lost - other.lost,
            broken: self.broken - other.broken,
        }
    }
}

/// Place of a cell on the curve that it shares with others: its contacts are those of cells of scale 1 after an advance
/// X/s, with all lengths s times as large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing {
    /// X/s, since the start, or since all of its contacts last re-formed together.
    pub advance: f64,
    /// Scale s of its lengths and forces.
    pub scale: f64,
    /// Whether its contacts have re-formed together.
    pub renewed: bool,
}

/// Least and largest tangent dF/dX over an advance; the least is −∞ where contacts break together.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slopes {
    /// Least tangent.
    pub least: f64,
    /// Largest tangent, jumps aside.
    pub largest: f64,
}

/// Where a cell becomes unstable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Instability {
    /// The advance after which it does, a length.
    pub at: f64,
    /// Whether contacts break together before the advance ends.
    pub together: bool,
}

/// Largest slope and force of the friction curves as far as they are tabulated; the sizes of steps depend on them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// The largest |dF/dX| that a cell can have, jumps aside.
    pub steepest: f64,
    /// The largest |F| that a cell can have: forces are accurate to about 1e-12 of it.
    pub strongest: f64,
    /// Whether contacts break together anywhere.
    pub jumps: bool,
}

impl Extremes {
    /// The extremes of two curves together.
    fn and(self, other: Self) -> Self {
        Self {
            steepest: self.steepest.max(other.steepest),
            strongest: self.strongest.max(other.strongest),
            jumps: self.jumps || other.jumps,
        }
    }

    /// The extremes of cells whose forces are at most `strength` times and whose slopes are at most `area` times as large.
    fn scaled(self, strength: f64, area: f64) -> Self {
        Self { strongest: strength * self.strongest, steepest: area * self.steepest, ..self }
    }
}

/// Cells, each with contacts of its own that move together.
///
/// Cells have no positions here: they are moved by advances δ_j ≥ 0, lengths, from where they are. The force of a cell
/// depends on its own advance alone, so that a batch may be evaluated on any number of threads. Slices have one value per
/// cell, row by row.
pub trait Cells: std::fmt::Debug + Send + Sync {
    /// Number of cells.
    fn len(&self) -> usize;

    /// Estimated error of the force of a cell, the largest of all; 0 where contacts are followed one by one.
    fn error(&self) -> f64 {
        0.0
    }

    /// Whether there are no cells.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Areas of the cells; each is 1 unless they are given. What acts on a cell per area is multiplied by them.
    fn areas(&self) -> CellAreas {
        CellAreas::default()
    }

    /// Largest slope and force of their curves.
    fn extremes(&self) -> Extremes;

    /// Extends the tabulated curves to cover the advances `by`. Returns true if they had to be extended.
    ///
    /// # Errors
    /// Those of the population that is tabulated; stopped by the monitor.
    fn extend_curves(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<bool>;

    /// Upper bound of the tangent of any cell from here to the end of the tabulated curves, at least 0.
    fn largest_tangent(&self) -> f64;

    /// Computes the residual: subtracts F_j after the advances `by` from `forces`, writes dF_j/dX_j there to `tangents`, and
    /// returns the largest |residual|. Does not move the cells.
    ///
    /// # Errors
    /// Those of the population that is tabulated; stopped by the monitor.
    fn residual(
        &mut self,
        by: &[f64],
        forces: &mut [f64],
        tangents: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<f64>;

    /// Friction force F_j of a cell at its present place.
    fn force(&self, cell: usize) -> f64;

    /// Least and largest tangent of each cell over the advances `by`.
    ///
    /// # Errors
    /// Those of the population that is tabulated; stopped by the monitor.
    fn slopes(&mut self, by: &[f64], slopes: &mut [Slopes], monitor: &mut dyn Monitor) -> Result<()>;

    /// The first advance, up to `by`, at which the tangent of a cell falls below `slope`, or at which contacts break
    /// together; none if there is none. The curve must cover `by`.
    fn instability(&self, cell: usize, by: f64, slope: f64) -> Option<Instability>;

    /// Moves the cells by `by`; contacts break and re-form on the way.
    ///
    /// # Errors
    /// Those of the population that is tabulated; stopped by the monitor.
    fn advance(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<()>;

    /// Detaches a cell: after an advance `by` all of its contacts break. From then on the cell moves without contacts, and
    /// carries only the force that they will have when they re-form.
    ///
    /// # Errors
    /// Those of the population that is tabulated.
    fn detach(&mut self, cell: usize, by: f64, monitor: &mut dyn Monitor) -> Result<()>;

    /// Reattaches all detached cells: their contacts re-form where the cells are.
    fn reattach(&mut self);

    /// Marks how far curves are known, in place of what was marked before.
    fn mark_curves(&mut self);

    /// Returns to what was known of the curves at the mark, for cells that have not moved since.
    fn recall_curves(&mut self);

    /// Marks the present state, in place of the one marked before.
    fn mark(&mut self);

    /// Frees what is kept for the mark.
    fn unmark(&mut self) {}

    /// Returns to the marked state.
    ///
    /// # Errors
    /// Those of the population that is tabulated; stopped by the monitor.
    fn recall(&mut self, monitor: &mut dyn Monitor) -> Result<()>;

    /// Energies and breaks of a cell since the mark; the elastic energy is the change since then.
    fn since_mark(&self, cell: usize) -> CellEnergies;

    /// Energies and breaks of all cells since the beginning; the elastic energy is the present one.
    fn energies(&self) -> CellEnergies;

    /// Place of a cell on a shared curve; none where each cell has a curve of its own.
    fn standing(&self, _cell: usize) -> Option<Standing> {
        None
    }

    /// Stretches of the contacts of a cell, where these are followed one by one.
    ///
    /// # Errors
    /// Those of the population that is tabulated.
    fn stretches(&self, _cell: usize) -> Result<Option<Vec<f64>>> {
        Ok(None)
    }

    /// All that changes as cells move.
    fn state(&self) -> CellsState;

    /// Restores the state of cells of the same description.
    ///
    /// # Errors
    /// A state of other cells; those of the population that is tabulated.
    fn restore(&mut self, state: CellsState, monitor: &mut dyn Monitor) -> Result<()>;
}

/// State of a batch of cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellsState(CellsSnapshot);

/// The state by kind of cells.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum CellsSnapshot {
    /// Cells that share a curve.
    Curves {
        /// X_j since the contacts last re-formed all together.
        advances: Vec<f64>,
        /// Whether they have.
        renewed: Vec<bool>,
        /// Tabulated intervals of the two curves, on which the sizes of steps depend.
        intervals: [usize; 2],
        /// Energies and breaks before that.
        settled: CellEnergies,
    },
    /// Cells with a population each.
    Populations {
        /// Each cell.
        cells: Vec<populations::PopulationCellState>,
        /// Extremes of the tabulated curves, on which the sizes of steps depend.
        known: Extremes,
    },
}

/// Refuses scales s_j whose number is not that of the cells, or that are not above 0.
fn checked(scales: &[f64], cells: usize) -> Result<()> {
    if scales.len() != cells {
        let expected = format!("a scale for each of the {cells} cells");
        return Err(Error::invalid("scales", expected, format!("{} of them", scales.len())));
    }
    match scales.iter().position(|scale| !(*scale > 0.0 && scale.is_finite())) {
        Some(cell) => {
            let found = format!("{} for cell {cell}", scales[cell]);
            Err(Error::invalid("scales", "scales above 0, so that thresholds are", found))
        }
        None => Ok(()),
    }
}
