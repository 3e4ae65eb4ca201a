//! Cells with a population each, such as ensembles of few contacts.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::cell::Cell;
use super::tabulate::CurveTable;
use super::{
    CellAreas, CellEnergies, Cells, CellsSnapshot, CellsState, Extremes, Instability, Slopes, checked,
};
use crate::elastic::batch::{all, change_chunks, fill_with, gather, largest};
use crate::monitor::{Monitor, report};
use crate::parallel;
use crate::population::{Direction, Population};
use crate::{Error, Result};

/// Cells of time-independent contacts, each with a population of its own.
///
/// Each cell has its own friction curve, tabulated a little ahead of the cell and dropped behind it. Besides, it keeps its
/// population as it was at first, and as it was when its contacts last re-formed all together: the present state follows
/// from the places at which they did.
#[derive(Debug)]
pub struct Populations {
    cells: Vec<PopulationCell>,
    areas: CellAreas,
    /// Extremes of the tabulated curves, now and at the mark.
    known: Extremes,
    known_at_mark: Extremes,
}

/// A cell.
#[derive(Debug)]
struct PopulationCell {
    /// Its contacts at first.
    first: Arc<dyn Population>,
    /// s.
    scale: f64,
    /// a.
    area: f64,
    now: SinceReset,
    /// Advances X/s at which its contacts re-formed all together, each since the one before.
    resets: Vec<f64>,
    /// Its advance at the mark, and its energies.
    marked: (f64, CellEnergies),
    /// Its state at the mark, if it has been detached since.
    detached: Option<Box<SinceReset>>,
}

/// A cell since its contacts last re-formed all together.
#[derive(Debug)]
struct SinceReset {
    /// Its contacts then.
    base: Arc<dyn Population>,
    /// Their friction curve.
    table: CurveTable,
    /// X since then.
    advance: f64,
    /// Whether the cell is detached.
    free: bool,
    /// Energies and breaks before, without the elastic energy.
    settled: CellEnergies,
}

/// State of a cell.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct PopulationCellState {
    resets: Vec<f64>,
    advance: f64,
    intervals: usize,
    settled: CellEnergies,
}

impl SinceReset {
    fn new(base: Arc<dyn Population>, settled: CellEnergies, monitor: &mut dyn Monitor) -> Result<Self> {
        let table = CurveTable::new(base.copy(), monitor)?;
        Ok(Self { base, table, advance: 0.0, free: false, settled })
    }
}

impl PopulationCell {
    fn new(population: Box<dyn Population>, monitor: &mut dyn Monitor) -> Result<Self> {
        let first: Arc<dyn Population> = population.into();
        Ok(Self {
            now: SinceReset::new(first.clone(), CellEnergies::default(), monitor)?,
            first,
            scale: 1.0,
            area: 1.0,
            resets: Vec::new(),
            marked: (0.0, CellEnergies::default()),
            detached: None,
        })
    }

    fn on_curve(&self) -> Cell<'_> {
        let SinceReset { table, advance, free, .. } = &self.now;
        Cell { curve: &table.curve, advance: *advance, scale: self.scale, area: self.area, free: *free }
    }

    /// Whether its curve covers an advance.
    fn knows(&self, by: f64) -> bool {
        self.now.table.knows(self.on_curve().place(by))
    }

    /// Extends its curve to cover an advance, and drops what no return to the mark needs.
    fn extend_curve(&mut self, by: f64) -> Result<()> {
        let [here, end] = [0.0, by].map(|by| self.on_curve().place(by));
        let passed = if self.detached.is_some() { 0.0 } else { self.marked.0.min(self.now.advance) };
        self.now.table.curve.forget(passed / self.scale);
        self.now.table.extend_to(end, here, &mut ())
    }

    /// Its energies and breaks after an advance.
    fn done(&self, by: f64) -> CellEnergies {
        self.now.settled + self.on_curve().done(by)
    }

    fn detach(&mut self, by: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let place = self.on_curve().place(by);
        let mut now =
            SinceReset::new(renewed(&*self.now.base, place, monitor)?, CellEnergies::default(), monitor)?;
        let fresh = now.table.curve.energies(0.0).scaled(self.scale).of_area(self.area);
        now.settled = CellEnergies { elastic: 0.0, ..self.done(by).renewed(fresh.elastic, self.area) };
        now.free = true;
        self.resets.push(place);
        self.detached = Some(Box::new(std::mem::replace(&mut self.now, now)));
        Ok(())
    }

    fn mark(&mut self) {
        self.marked = (self.now.advance, self.done(0.0));
        self.detached = None;
        self.now.table.mark();
    }

    fn recall(&mut self) {
        if let Some(before) = self.detached.take() {
            self.now = *before;
            self.resets.pop();
        }
        self.now.advance = self.marked.0;
        self.now.table.recall();
    }

    fn state(&self) -> PopulationCellState {
        let SinceReset { table, advance, settled, .. } = &self.now;
        PopulationCellState {
            resets: self.resets.clone(),
            advance: *advance,
            intervals: table.intervals(),
            settled: *settled,
        }
    }

    fn restore(&mut self, kept: &PopulationCellState) -> Result<()> {
        let &PopulationCellState { ref resets, advance, intervals, settled } = kept;
        let mut base = self.first.clone();
        // Contacts are not stored but recomputed: a population is deterministic, and one number per
        // reset replaces the state of every contact.
        for &place in resets {
            base = renewed(&*base, place, &mut ())?;
        }
        self.now = SinceReset { advance, ..SinceReset::new(base, settled, &mut ())? };
        self.now.table.resume(intervals, advance / self.scale, &mut ())?;
        self.resets.clone_from(resets);
        self.mark();
        Ok(())
    }
}

/// Changes all cells, each with its own value, on all threads. The monitor is asked between some of them and the next.
///
/// # Errors
/// Those of a cell; stopped by the monitor.
fn each<T: Sync>(
    cells: &mut [PopulationCell],
    values: &[T],
    monitor: &mut dyn Monitor,
    change: impl Fn(&mut PopulationCell, &T) -> Result<()> + Sync,
) -> Result<()> {
    /// Cells between two questions, each of which takes up to some tenths of a millisecond for hundreds of contacts.
    const SOME: usize = 64;
    for (cells, values) in cells.chunks_mut(SOME).zip(values.chunks(SOME)) {
        report(monitor, 0.0)?;
        let cells = cells.iter_mut().zip(values).collect();
        let changed =
            parallel::map(cells, &|_, (cell, value): (&mut PopulationCell, &T)| change(cell, value));
        changed.into_iter().collect::<Result<()>>()?;
    }
    Ok(())
}

/// Contacts that have advanced by `place` and re-formed there all together. A contact that breaks within the rounding error
/// of that place breaks with all others.
fn renewed(base: &dyn Population, place: f64, monitor: &mut dyn Monitor) -> Result<Arc<dyn Population>> {
    let mut population = moved(base, place, rounding(base, place), monitor)?;
    population.reset(Direction::Forward, monitor)?;
    Ok(population.into())
}

/// Rounding error of the position of contacts that have advanced by `place`.
fn rounding(base: &dyn Population, place: f64) -> f64 {
    16.0 * f64::EPSILON * ((base.position() + place).abs() + place)
}

/// Contacts that have advanced by `place`; those that break less than `near` before it have not broken yet.
fn moved(
    base: &dyn Population,
    place: f64,
    near: f64,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Population>> {
    let mut population = base.copy();
    let end = population.position() + place;
    loop {
        let interval = population.smooth_interval(Direction::Forward, monitor)?;
        let left = (end - population.position()).max(0.0);
        if left <= interval.length + near {
            population.advance(left.min(interval.length))?;
            return Ok(population);
        }
        population.advance(interval.length)?;
        if interval.breaks {
            population.cross(monitor)?;
        }
    }
}

impl Populations {
    /// Cells in the states of these populations, one for each cell, row by row.
    ///
    /// # Errors
    /// Those of the populations; stopped by the monitor.
    pub fn new(populations: Vec<Box<dyn Population>>, monitor: &mut dyn Monitor) -> Result<Self> {
        let cells: Result<Vec<PopulationCell>> =
            populations.into_iter().map(|p| PopulationCell::new(p, monitor)).collect();
        let mut populations = Self {
            cells: cells?,
            areas: CellAreas::default(),
            known: Extremes::default(),
            known_at_mark: Extremes::default(),
        };
        populations.know();
        Ok(populations)
    }

    /// The same cells with scales s_j, one for each; see [`super::Curves::scaled`].
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

    /// The same cells with areas a_j, one for each; see [`super::Curves::with_areas`].
    ///
    /// # Errors
    /// Those of [`CellAreas::new`].
    pub fn with_areas(mut self, areas: Vec<f64>) -> Result<Self> {
        self.areas = CellAreas::new(areas, self.len())?;
        self.cells.iter_mut().enumerate().for_each(|(j, cell)| cell.area = self.areas.of(j));
        self.known = Extremes::default();
        self.know();
        Ok(self)
    }

    /// Updates the extremes of the tabulated curves.
    fn know(&mut self) {
        let most = |known: Extremes, cell: usize| {
            let PopulationCell { scale, area, now: SinceReset { table, .. }, .. } = &self.cells[cell];
            known.and(table.extremes().scaled(area * scale, *area))
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

    fn areas(&self) -> CellAreas {
        self.areas.clone()
    }

    fn extend_curves(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<bool> {
        if all(by.len(), |cell| self.cells[cell].knows(by[cell])) {
            return Ok(false);
        }
        let extend = |cell: &mut PopulationCell, by: &f64| {
            if cell.knows(*by) { Ok(()) } else { cell.extend_curve(*by) }
        };
        let extended = each(&mut self.cells, by, monitor, extend);
        // What was extended before a stop is known, too.
        self.know();
        extended.map(|()| true)
    }

    fn largest_tangent(&self) -> f64 {
        let from = |cell: usize| {
            let own = &self.cells[cell];
            own.area * own.now.table.largest_tangent(own.on_curve().place(0.0))
        };
        largest(self.len(), from)
    }

    fn residual(
        &mut self,
        by: &[f64],
        forces: &mut [f64],
        tangents: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<f64> {
        self.extend_curves(by, monitor)?;
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

    fn slopes(&mut self, by: &[f64], slopes: &mut [Slopes], monitor: &mut dyn Monitor) -> Result<()> {
        self.extend_curves(by, monitor)?;
        fill_with(slopes, |cell| self.cells[cell].on_curve().slopes(by[cell]), monitor)
    }

    fn instability(&self, cell: usize, by: f64, slope: f64) -> Option<Instability> {
        self.cells[cell].on_curve().instability(by, slope)
    }

    fn advance(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<()> {
        self.extend_curves(by, monitor)?;
        for (PopulationCell { now, .. }, by) in
            self.cells.iter_mut().zip(by).filter(|(cell, _)| !cell.now.free)
        {
            now.advance += by;
        }
        Ok(())
    }

    fn detach(&mut self, cell: usize, by: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.cells[cell].detach(by, monitor)
    }

    fn reattach(&mut self) {
        self.cells.iter_mut().for_each(|cell| cell.now.free = false);
    }

    fn mark_curves(&mut self) {
        self.cells.iter_mut().for_each(|cell| cell.now.table.mark());
        self.known_at_mark = self.known;
    }

    fn recall_curves(&mut self) {
        self.cells.iter_mut().for_each(|cell| cell.now.table.recall());
        self.known = self.known_at_mark;
    }

    fn mark(&mut self) {
        self.cells.iter_mut().for_each(PopulationCell::mark);
        self.known_at_mark = self.known;
    }

    fn recall(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        self.cells.iter_mut().for_each(PopulationCell::recall);
        self.known = self.known_at_mark;
        Ok(())
    }

    fn since_mark(&self, cell: usize) -> CellEnergies {
        let cell = &self.cells[cell];
        cell.done(0.0) - cell.marked.1
    }

    fn energies(&self) -> CellEnergies {
        let add = |sum, cell: usize| sum + self.cells[cell].done(0.0);
        gather(self.len(), CellEnergies::default, add, |a, b| a + b)
    }

    fn stretches(&self, cell: usize) -> Result<Option<Vec<f64>>> {
        let PopulationCell { now, scale, .. } = &self.cells[cell];
        let place = now.advance / scale;
        // A contact that breaks exactly there has broken, as on the curve.
        let population = moved(&*now.base, place, -rounding(&*now.base, place), &mut ())?;
        let stretches = population.stretches();
        Ok(stretches.map(|stretches| stretches.into_iter().map(|stretch| scale * stretch).collect()))
    }

    fn state(&self) -> CellsState {
        let cells = self.cells.iter().map(PopulationCell::state).collect();
        CellsState(CellsSnapshot::Populations { cells, known: self.known })
    }

    fn restore(&mut self, state: CellsState, monitor: &mut dyn Monitor) -> Result<()> {
        let CellsSnapshot::Populations { cells, known } = state.0 else {
            return Err(Error::invalid("state", "that of cells with a population each", "another one"));
        };
        if cells.len() != self.len() {
            let expected = format!("that of {} cells", self.len());
            return Err(Error::invalid("state", expected, format!("that of {}", cells.len())));
        }
        each(&mut self.cells, &cells, monitor, PopulationCell::restore)?;
        self.known = known;
        Ok(())
    }
}
