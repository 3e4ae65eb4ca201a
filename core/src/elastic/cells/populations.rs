//! Cells that are each a population of their own, such as ensembles of few contacts.

use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cell::Cell;
use super::tabulate::CurveTable;
use super::{CellEnergies, Cells, CellsSnapshot, CellsState, Extremes, Fall, Slopes, checked};
use crate::elastic::batch::{all, change_chunks, fill, gather, largest};
use crate::monitor::Monitor;
use crate::population::{Direction, Population};
use crate::{Error, Result};

/// Cells of contacts without rates, each a population that none of the others shares.
///
/// Each has a friction curve of its own, tabulated a little ahead of it and forgotten behind. Besides that it keeps its
/// population as it was at first and as it last re-formed all together: what it has come to follows from the places at
/// which it did.
pub struct Populations {
    cells: Vec<Own>,
    /// What curves are at most so far, and what they were at the mark.
    known: Extremes,
    known_at_mark: Extremes,
}

/// A cell.
struct Own {
    first: Arc<dyn Population>,
    scale: f64,
    stand: Stand,
    /// Where its contacts re-formed all together, each from where they did before, per scale.
    resets: Vec<f64>,
    /// Its advance at the mark, and what it had done.
    marked: (f64, CellEnergies),
    /// What it was at the mark, if its contacts have broken all together since.
    parted: Option<Box<Stand>>,
}

/// Where a cell stands.
struct Stand {
    /// Its contacts at first, or as they last re-formed all together.
    base: Arc<dyn Population>,
    /// Their curve from there.
    table: CurveTable,
    /// X since then.
    advance: f64,
    free: bool,
    /// What was done before, with no energy kept.
    settled: CellEnergies,
}

/// What a cell has come to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct OwnState {
    resets: Vec<f64>,
    advance: f64,
    ways: usize,
    settled: CellEnergies,
}

impl Stand {
    fn new(base: Arc<dyn Population>, settled: CellEnergies, monitor: &mut dyn Monitor) -> Result<Self> {
        let table = CurveTable::new(base.copy(), monitor)?;
        Ok(Self { base, table, advance: 0.0, free: false, settled })
    }
}

impl Own {
    fn new(population: Box<dyn Population>, monitor: &mut dyn Monitor) -> Result<Self> {
        let first: Arc<dyn Population> = population.into();
        Ok(Self {
            stand: Stand::new(first.clone(), CellEnergies::default(), monitor)?,
            first,
            scale: 1.0,
            resets: Vec::new(),
            marked: (0.0, CellEnergies::default()),
            parted: None,
        })
    }

    fn on_curve(&self) -> Cell<'_> {
        let Stand { table, advance, free, .. } = &self.stand;
        Cell { curve: &table.curve, advance: *advance, scale: self.scale, free: *free }
    }

    /// Whether its curve is known as far as an advance.
    fn knows(&self, by: f64) -> bool {
        self.stand.table.knows(self.on_curve().place(by))
    }

    /// Sees to it that it is.
    fn reach(&mut self, by: f64) -> Result<()> {
        let [here, end] = [0.0, by].map(|by| self.on_curve().place(by));
        let passed = if self.parted.is_some() { 0.0 } else { self.marked.0.min(self.stand.advance) };
        self.stand.table.curve.forget(passed / self.scale);
        self.stand.table.reach(end, here, &mut ())
    }

    /// What it has done after an advance.
    fn done(&self, by: f64) -> CellEnergies {
        self.stand.settled + self.on_curve().done(by)
    }

    fn detach(&mut self, by: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let place = self.on_curve().place(by);
        let mut stand =
            Stand::new(renewed(&*self.stand.base, place, monitor)?, CellEnergies::default(), monitor)?;
        let newborn = stand.table.curve.account(0.0).scaled(self.scale);
        stand.settled = CellEnergies { elastic: 0.0, ..self.done(by).renewed(newborn.elastic) };
        stand.free = true;
        self.resets.push(place);
        self.parted = Some(Box::new(std::mem::replace(&mut self.stand, stand)));
        Ok(())
    }

    fn mark(&mut self) {
        self.marked = (self.stand.advance, self.done(0.0));
        self.parted = None;
        self.stand.table.mark();
    }

    fn recall(&mut self) {
        if let Some(stand) = self.parted.take() {
            self.stand = *stand;
            self.resets.pop();
        }
        self.stand.advance = self.marked.0;
        self.stand.table.recall();
    }

    fn state(&self) -> OwnState {
        let Stand { table, advance, settled, .. } = &self.stand;
        OwnState { resets: self.resets.clone(), advance: *advance, ways: table.ways(), settled: *settled }
    }

    fn restore(&mut self, kept: OwnState) -> Result<()> {
        let OwnState { resets, advance, ways, settled } = kept;
        let mut base = self.first.clone();
        for &place in &resets {
            base = renewed(&*base, place, &mut ())?;
        }
        self.stand = Stand { advance, ..Stand::new(base, settled, &mut ())? };
        self.stand.table.resume(ways, advance / self.scale, &mut ())?;
        self.resets = resets;
        self.mark();
        Ok(())
    }
}

/// Contacts that have gone on to a place from where they are and re-formed there all together. What breaks within
/// rounding of that place breaks with all others.
fn renewed(base: &dyn Population, place: f64, monitor: &mut dyn Monitor) -> Result<Arc<dyn Population>> {
    let mut population = moved(base, place, rounding(base, place), monitor)?;
    population.reset(Direction::Forward, monitor)?;
    Ok(population.into())
}

/// What is rounding in where contacts are that have gone on to a place.
fn rounding(base: &dyn Population, place: f64) -> f64 {
    16.0 * f64::EPSILON * ((base.position() + place).abs() + place)
}

/// Contacts that have gone on to a place from where they are; what would break less than `near` before it has not.
fn moved(
    base: &dyn Population,
    place: f64,
    near: f64,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Population>> {
    let mut population = base.copy();
    let end = population.position() + place;
    loop {
        let way = population.way(Direction::Forward, monitor)?;
        let left = (end - population.position()).max(0.0);
        if left <= way.length + near {
            population.advance(left.min(way.length))?;
            return Ok(population);
        }
        population.advance(way.length)?;
        if way.breaks {
            population.cross(monitor)?;
        }
    }
}

impl Populations {
    /// Cells that stand where their populations do.
    ///
    /// # Errors
    /// Those of the populations; stopped by the monitor.
    pub fn new(populations: Vec<Box<dyn Population>>, monitor: &mut dyn Monitor) -> Result<Self> {
        let cells: Result<Vec<Own>> = populations.into_iter().map(|p| Own::new(p, monitor)).collect();
        let mut populations =
            Self { cells: cells?, known: Extremes::default(), known_at_mark: Extremes::default() };
        populations.know();
        Ok(populations)
    }

    /// The same cells with scales s_j, one for each, as [`super::Curves::scaled`] has them.
    ///
    /// # Errors
    /// Another number of scales than of cells; a scale that is not a finite number above 0, naming its cell.
    pub fn scaled(mut self, scales: &[f64]) -> Result<Self> {
        checked(scales, self.len())?;
        self.cells.iter_mut().zip(scales).for_each(|(cell, scale)| cell.scale = *scale);
        self.known = Extremes::default();
        self.know();
        Ok(self)
    }

    /// Looks at what is known of the curves.
    fn know(&mut self) {
        let most = |known: Extremes, cell: usize| {
            let Own { scale, stand: Stand { table, .. }, .. } = &self.cells[cell];
            known.and(table.extremes().scaled(*scale))
        };
        self.known = gather(self.len(), || self.known, most, Extremes::and);
    }
}

impl Cells for Populations {
    fn len(&self) -> usize {
        self.cells.len()
    }

    fn extremes(&self) -> Extremes {
        self.known
    }

    fn reach(&mut self, by: &[f64]) -> Result<bool> {
        if all(by.len(), |cell| self.cells[cell].knows(by[cell])) {
            return Ok(false);
        }
        let reach = |(cell, by): (&mut Own, &f64)| if cell.knows(*by) { Ok(()) } else { cell.reach(*by) };
        self.cells.par_iter_mut().zip(by).try_for_each(reach)?;
        self.know();
        Ok(true)
    }

    fn stiffest(&self) -> f64 {
        let from = |cell: usize| {
            let own = &self.cells[cell];
            own.stand.table.stiffest(own.on_curve().place(0.0))
        };
        largest(self.len(), from)
    }

    fn residual(&mut self, by: &[f64], forces: &mut [f64], tangents: &mut [f64]) -> Result<f64> {
        self.reach(by)?;
        let cells = &self.cells;
        let chunk = |first: usize, forces: &mut [f64], tangents: &mut [f64]| {
            let each = (first..).zip(forces).zip(tangents).map(|((cell, force), tangent)| {
                (*force, *tangent) = cells[cell].on_curve().residual(by[cell], *force);
                force.abs()
            });
            each.fold(0.0, f64::max)
        };
        Ok(change_chunks(forces, tangents, chunk))
    }

    fn force(&self, cell: usize) -> f64 {
        self.cells[cell].on_curve().force()
    }

    fn slopes(&mut self, by: &[f64], slopes: &mut [Slopes]) -> Result<()> {
        self.reach(by)?;
        fill(slopes, |cell| self.cells[cell].on_curve().slopes(by[cell]));
        Ok(())
    }

    fn fall(&self, cell: usize, by: f64, slope: f64) -> Option<Fall> {
        self.cells[cell].on_curve().fall(by, slope)
    }

    fn advance(&mut self, by: &[f64], _monitor: &mut dyn Monitor) -> Result<()> {
        self.reach(by)?;
        for (Own { stand, .. }, by) in self.cells.iter_mut().zip(by).filter(|(cell, _)| !cell.stand.free) {
            stand.advance += by;
        }
        Ok(())
    }

    fn detach(&mut self, cell: usize, by: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.cells[cell].detach(by, monitor)
    }

    fn reattach(&mut self) {
        self.cells.iter_mut().for_each(|cell| cell.stand.free = false);
    }

    fn mark(&mut self) {
        self.cells.iter_mut().for_each(Own::mark);
        self.known_at_mark = self.known;
    }

    fn recall(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        self.cells.iter_mut().for_each(Own::recall);
        self.known = self.known_at_mark;
        Ok(())
    }

    fn since(&self, cell: usize) -> CellEnergies {
        let cell = &self.cells[cell];
        cell.done(0.0) - cell.marked.1
    }

    fn account(&self) -> CellEnergies {
        let add = |sum, cell: usize| sum + self.cells[cell].done(0.0);
        gather(self.len(), CellEnergies::default, add, |a, b| a + b)
    }

    fn stretches(&self, cell: usize) -> Result<Option<Vec<f64>>> {
        let Own { stand, scale, .. } = &self.cells[cell];
        let place = stand.advance / scale;
        // What breaks there has broken, as on the curve.
        let population = moved(&*stand.base, place, -rounding(&*stand.base, place), &mut ())?;
        let stretches = population.stretches();
        Ok(stretches.map(|stretches| stretches.into_iter().map(|stretch| scale * stretch).collect()))
    }

    fn state(&self) -> CellsState {
        let cells = self.cells.iter().map(Own::state).collect();
        CellsState(CellsSnapshot::Populations { cells, known: self.known })
    }

    fn restore(&mut self, state: CellsState, _monitor: &mut dyn Monitor) -> Result<()> {
        let CellsSnapshot::Populations { cells, known } = state.0 else {
            return Err(Error::invalid("state", "that of cells of populations of their own", "another one"));
        };
        if cells.len() != self.len() {
            let expected = format!("that of {} cells", self.len());
            return Err(Error::invalid("state", expected, format!("that of {}", cells.len())));
        }
        self.cells.par_iter_mut().zip(cells).try_for_each(|(cell, kept)| cell.restore(kept))?;
        self.known = known;
        Ok(())
    }
}
