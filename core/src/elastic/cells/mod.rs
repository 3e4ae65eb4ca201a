//! Cells of an interface as a batch, seen from outside: slices in, slices out.

mod cell;
mod curve;
mod curves;
mod populations;
mod scales;
mod tabulate;

pub use curves::Curves;
pub use populations::Populations;
pub use scales::scales;

use serde::{Deserialize, Serialize};

use crate::monitor::Monitor;
use crate::{Error, Result};

/// What contacts have done, each summed on its own.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct CellEnergies {
    /// ∫F dX, the work done on them.
    pub work: f64,
    /// Elastic energy Σ ½k x².
    pub elastic: f64,
    /// Lost in breaks: Σ over breaks of ½k x_b², less the ½k r² of what re-formed.
    pub lost: f64,
    /// Breaks, per contact of a cell.
    pub broken: f64,
}

impl CellEnergies {
    /// Of cells whose lengths and forces are `scale` times as large.
    #[must_use]
    pub(super) fn scaled(self, scale: f64) -> Self {
        let energy = scale * scale;
        Self { work: energy * self.work, elastic: energy * self.elastic, lost: energy * self.lost, ..self }
    }

    /// After all contacts have broken, too, and re-formed with the elastic energy `newborn`.
    #[must_use]
    pub(super) fn renewed(self, newborn: f64) -> Self {
        let lost = self.lost + self.elastic - newborn;
        Self { lost, broken: self.broken + 1.0, elastic: newborn, ..self }
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

/// Where a cell is on the curve that it shares with others: its contacts are those of lengths 1 after an advance X/s, all
/// lengths s times as large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Standing {
    /// X/s, since the start, or since all of its contacts last re-formed together.
    pub advance: f64,
    /// s.
    pub scale: f64,
    /// Whether they have.
    pub renewed: bool,
}

/// Least and largest tangent dF/dX on a part of a way; the least is −∞ where contacts break together on it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Slopes {
    /// Least tangent.
    pub least: f64,
    /// Largest tangent, of what is told of the way.
    pub largest: f64,
}

/// Where a cell begins to fall on a way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fall {
    /// The advance after which it does.
    pub on: f64,
    /// Whether contacts break together on the way.
    pub together: bool,
}

/// What the friction curves of cells are at most, as far as they are known; how cells are moved depends on it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// The largest |dF/dX| that a cell can have, short of jumps.
    pub steepest: f64,
    /// The largest |F| that a cell is known to have somewhere: forces are good to about 1e-12 of it.
    pub strongest: f64,
    /// Whether contacts break together somewhere.
    pub jumps: bool,
}

impl Extremes {
    /// Those of two curves together.
    fn and(self, other: Self) -> Self {
        Self {
            steepest: self.steepest.max(other.steepest),
            strongest: self.strongest.max(other.strongest),
            jumps: self.jumps || other.jumps,
        }
    }

    /// Those of curves of cells of such a scale.
    fn scaled(self, scale: f64) -> Self {
        Self { strongest: scale * self.strongest, ..self }
    }
}

/// Cells, each with contacts of its own that move together.
///
/// Nothing is known here of where cells are: they stand, and go on by so much. A cell answers for itself alone, so that
/// a batch may be worked on by any number of threads.
pub trait Cells: Send + Sync {
    /// Number of cells.
    fn len(&self) -> usize;

    /// Estimated error of the force of a cell, the largest of all; 0 where contacts are followed one by one.
    fn error(&self) -> f64 {
        0.0
    }

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What their curves are at most.
    fn extremes(&self) -> Extremes;

    /// Sees to it that curves are known as far as cells may go; whether they were not.
    ///
    /// # Errors
    /// Those of the population behind it.
    fn reach(&mut self, by: &[f64]) -> Result<bool>;

    /// The largest tangent that a cell may have from where it stands on, as far as its curve is known; 0 where none is above.
    fn stiffest(&self) -> f64;

    /// Takes the forces F_j after advances `by` from where the cells stand off `forces`, and tells their tangents and the
    /// largest force that is left; nothing moves.
    ///
    /// # Errors
    /// Those of the population behind it.
    fn residual(&mut self, by: &[f64], forces: &mut [f64], tangents: &mut [f64]) -> Result<f64>;

    /// F_j of a cell where it stands.
    fn force(&self, cell: usize) -> f64;

    /// Tangents on the ways from where the cells stand.
    ///
    /// # Errors
    /// Those of the population behind it.
    fn slopes(&mut self, by: &[f64], slopes: &mut [Slopes]) -> Result<()>;

    /// The first advance, up to `by`, from which on the tangent of a cell is below `slope`, or where contacts break together;
    /// its curve is known as far as that.
    fn fall(&self, cell: usize, by: f64, slope: f64) -> Option<Fall>;

    /// Moves the cells on, through all that breaks there.
    ///
    /// # Errors
    /// Those of the population behind it.
    fn advance(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<()>;

    /// Moves a cell on by `by`; there all of its contacts break. It is free from then on, moves without them and is
    /// held by the force alone that they will have when they re-form.
    ///
    /// # Errors
    /// Those of the population behind it.
    fn detach(&mut self, cell: usize, by: f64, monitor: &mut dyn Monitor) -> Result<()>;

    /// What is free re-forms where it is.
    fn reattach(&mut self);

    /// Remembers the state of the cells, in place of the one before.
    fn mark(&mut self);

    /// That state is asked for no more.
    fn unmark(&mut self) {}

    /// Comes back to the state at the mark.
    ///
    /// # Errors
    /// Those of the population behind it.
    fn recall(&mut self, monitor: &mut dyn Monitor) -> Result<()>;

    /// What a cell has done since the mark; its elastic energy is the change since then.
    fn since(&self, cell: usize) -> CellEnergies;

    /// What all cells have done; their elastic energy is that of now.
    fn account(&self) -> CellEnergies;

    /// Where a cell is on a curve that it shares; none where it has contacts of its own.
    fn standing(&self, _cell: usize) -> Option<Standing> {
        None
    }

    /// The stretches of the contacts of a cell, where these are followed one by one.
    ///
    /// # Errors
    /// Those of the population behind it.
    fn stretches(&self, _cell: usize) -> Result<Option<Vec<f64>>> {
        Ok(None)
    }

    /// All that changes as cells move.
    fn state(&self) -> CellsState;

    /// Goes to what cells of the same description have come to.
    ///
    /// # Errors
    /// A state of other cells; those of the population behind it.
    fn restore(&mut self, state: CellsState, monitor: &mut dyn Monitor) -> Result<()>;
}

/// What cells have come to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellsState(CellsSnapshot);

/// The same, by what they are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum CellsSnapshot {
    /// Cells that share a curve.
    Curves {
        /// How far each has gone since its contacts last re-formed all together.
        advances: Vec<f64>,
        /// Whether they have.
        renewed: Vec<bool>,
        /// How far curves were known, which decides on steps.
        ways: [usize; 2],
        /// What was done before.
        settled: CellEnergies,
    },
    /// Cells of populations of their own.
    Populations {
        /// Each cell.
        cells: Vec<populations::OwnState>,
        /// What was known of their curves, which decides on steps.
        known: Extremes,
    },
}

/// Refuses scales s_j that are not one for each cell, or not above 0.
fn checked(scales: &[f64], cells: usize) -> Result<()> {
    if scales.len() != cells {
        let expected = format!("a scale for each of the {cells} cells");
        return Err(Error::invalid("disorder", expected, format!("{} of them", scales.len())));
    }
    match scales.iter().position(|scale| !(*scale > 0.0 && scale.is_finite())) {
        Some(cell) => {
            let found = format!("{} for cell {cell}", scales[cell]);
            Err(Error::invalid("disorder", "scales above 0, so that thresholds are", found))
        }
        None => Ok(()),
    }
}
