//! Cells that share one friction curve, F_j(X) = a_j s_j F(X/s_j), so that the state of a cell is its advance.

use std::collections::HashMap;

use super::cell::Cell;
use super::curve::{Curve, LANES};
use super::tabulate::CurveTable;
use super::{
    CellAreas, CellEnergies, Cells, CellsSnapshot, CellsState, Extremes, Instability, Slopes, Standing,
    checked,
};
use crate::elastic::batch::{change, change_chunks, fill_with, gather, largest};
use crate::monitor::Monitor;
use crate::population::{Direction, Population};
use crate::{Error, Result};

/// Cells of time-independent contacts of one kind: the force of each cell depends on its advance alone, by one curve that is
/// tabulated as far as it is needed.
///
/// All cells start from the state of the population. After all contacts of a cell have broken together it follows the curve
/// of contacts that have just re-formed. The scale s_j of a cell multiplies thresholds and the stretches at which contacts
/// re-form, hence lengths and forces, but not stiffness. Its area a_j multiplies the number of contacts, hence forces, stiffness
/// and energies, but not lengths.
#[derive(Debug)]
pub struct Curves {
    /// The curve from the start.
    first: CurveTable,
    /// The curve of contacts that have all just re-formed.
    fresh: CurveTable,
    /// The contacts where their curves begin.
    begun: [Box<dyn Population>; 2],
    /// X since the start, or since the contacts last re-formed together.
    advances: Vec<f64>,
    courses: Vec<CellCourse>,
    /// s_j; empty where all are 1.
    scales: Vec<f64>,
    areas: CellAreas,
    /// The largest a_j s_j.
    largest_strength: f64,
    /// Lower bound of the distance from any cell to the end of its tabulated curve; 0 where it has to be computed anew.
    margin: f64,
    /// Energies and breaks of the cells before their contacts last re-formed together.
    settled: CellEnergies,
    /// Advances at the mark.
    marked: Vec<f64>,
    /// Cells that have been detached since the mark.
    detached: HashMap<usize, DetachedCell>,
    settled_at_mark: CellEnergies,
}

/// The curve that a cell follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CellCourse {
    /// That of the contacts as they were at the start.
    First,
    /// That of contacts that have all re-formed together.
    Fresh,
    /// None: the cell is detached. Its contacts will follow `Fresh`.
    Free,
}

impl Curves {
    /// `number` cells in the state of `population`.
    ///
    /// # Errors
    /// Those of the population.
    pub fn new(population: &dyn Population, number: usize) -> Result<Self> {
        Self::new_with(population, number, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::new`]; stopped by the monitor.
    pub fn new_with(population: &dyn Population, number: usize, monitor: &mut dyn Monitor) -> Result<Self> {
        let mut fresh = population.copy();
        fresh.reset(Direction::Forward, monitor)?;
        Ok(Self {
            first: CurveTable::new(population.copy(), monitor)?,
            fresh: CurveTable::new(fresh.copy(), monitor)?,
            begun: [population.copy(), fresh],
            advances: vec![0.0; number],
            courses: vec![CellCourse::First; number],
            scales: Vec::new(),
            areas: CellAreas::default(),
            largest_strength: 1.0,
            margin: 0.0,
            settled: CellEnergies::default(),
            marked: Vec::new(),
            detached: HashMap::new(),
            settled_at_mark: CellEnergies::default(),
        })
    }

    /// The same cells with scales s_j, one for each.
    ///
    /// # Errors
    /// Another number of scales than of cells; a scale that is not a finite number above 0, naming its cell.
    pub fn scaled(mut self, scales: Vec<f64>) -> Result<Self> {
        checked(&scales, self.advances.len())?;
        (self.scales, self.margin) = (scales, 0.0);
        self.largest_strength = self.find_largest_strength();
        Ok(self)
    }

    /// The same cells with areas a_j, one for each: a_j times the contacts, and a_j times the force.
    ///
    /// # Errors
    /// Those of [`CellAreas::new`].
    pub fn with_areas(mut self, areas: Vec<f64>) -> Result<Self> {
        self.areas = CellAreas::new(areas, self.advances.len())?;
        self.largest_strength = self.find_largest_strength();
        Ok(self)
    }

    fn find_largest_strength(&self) -> f64 {
        let batch = self.batch();
        largest(self.advances.len(), |cell| {
            let cell = batch.cell(cell);
            cell.area * cell.scale
        })
    }

    /// The data that threads share.
    fn batch(&self) -> Batch<'_> {
        let Self { first, fresh, advances, courses, scales, areas, .. } = self;
        Batch { first: &first.curve, fresh: &fresh.curve, advances, courses, scales, areas }
    }

    /// Extends the curves to cover an advance of all cells by `most`. Returns true if they had to be extended.
    fn extend_by(&mut self, most: f64, monitor: &mut dyn Monitor) -> Result<bool> {
        // The margin is a bound for all cells, so that most steps need not look at each of them.
        if most <= self.margin {
            return Ok(false);
        }
        let batch = self.batch();
        let furthest = |renewed: bool| {
            largest(self.len(), |cell| {
                if batch.is_renewed(cell) == renewed { batch.cell(cell).beyond(most) } else { 0.0 }
            })
        };
        let (first, fresh) = (furthest(false), furthest(true));
        let known = [self.first.intervals(), self.fresh.intervals()];
        self.first.extend_to(first, 0.0, monitor)?;
        self.fresh.extend_to(fresh, 0.0, monitor)?;
        self.margin = self.least_margin();
        Ok(known != [self.first.intervals(), self.fresh.intervals()])
    }

    /// Least distance from any cell to the end of its tabulated curve.
    fn least_margin(&self) -> f64 {
        let batch = self.batch();
        let left = |cell: usize| {
            let table = if batch.is_renewed(cell) { &self.fresh } else { &self.first };
            table.end() * batch.cell(cell).scale - self.advances[cell]
        };
        gather(self.len(), || f64::INFINITY, |least: f64, cell| least.min(left(cell)), f64::min)
    }
}

/// The longest advance.
fn longest(by: &[f64]) -> f64 {
    largest(by.len(), |cell| by[cell])
}

/// A cell that has been detached since the mark.
#[derive(Debug)]
struct DetachedCell {
    /// Its energies and breaks since the mark.
    done: CellEnergies,
    /// The curve that it followed before.
    course: CellCourse,
}

/// The curves, and where the cells are on them.
struct Batch<'a> {
    first: &'a Curve,
    fresh: &'a Curve,
    advances: &'a [f64],
    courses: &'a [CellCourse],
    scales: &'a [f64],
    areas: &'a CellAreas,
}

impl Batch<'_> {
    #[inline]
    fn cell(&self, cell: usize) -> Cell<'_> {
        let curve = if self.is_renewed(cell) { self.fresh } else { self.first };
        let scale = if self.scales.is_empty() { 1.0 } else { self.scales[cell] };
        let (advance, free) = (self.advances[cell], self.courses[cell] == CellCourse::Free);
        Cell { curve, advance, scale, area: self.areas.of(cell), free }
    }

    /// Whether its contacts have all broken together.
    #[inline]
    fn is_renewed(&self, cell: usize) -> bool {
        self.courses[cell] != CellCourse::First
    }

    /// As [`Cell::residual`], for the cells from `first` on; the largest |residual|.
    fn residual(&self, first: usize, by: &[f64], forces: &mut [f64], tangents: &mut [f64]) -> f64 {
        let mut most = 0.0_f64;
        let lanes = forces.chunks_mut(LANES).zip(tangents.chunks_mut(LANES));
        for ((forces, tangents), first) in lanes.zip((first..).step_by(LANES)) {
            match self.shared(first, forces.len()) {
                Some(curve) => self.residual_on(curve, first, by, forces, tangents),
                None => {
                    for ((force, tangent), cell) in forces.iter_mut().zip(tangents).zip(first..) {
                        (*force, *tangent) = self.cell(cell).residual(by[cell], *force);
                    }
                }
            }
            most = forces.iter().fold(most, |most, force| most.max(force.abs()));
        }
        most
    }

    /// The curve that all of [`LANES`] cells from `first` on follow.
    #[inline(always)]
    fn shared(&self, first: usize, number: usize) -> Option<&Curve> {
        let courses = &self.courses[first..first + number];
        let curve = match courses[0] {
            CellCourse::First => self.first,
            CellCourse::Fresh => self.fresh,
            CellCourse::Free => return None,
        };
        (number == LANES && courses.iter().all(|course| *course == courses[0])).then_some(curve)
    }

    #[inline(always)]
    fn residual_on(&self, curve: &Curve, first: usize, by: &[f64], forces: &mut [f64], tangents: &mut [f64]) {
        let cells = first..first + LANES;
        let (advances, by) = (&self.advances[cells.clone()], &by[cells.clone()]);
        let mut scales = [1.0; LANES];
        if !self.scales.is_empty() {
            scales.copy_from_slice(&self.scales[cells.clone()]);
        }
        let mut areas = [1.0; LANES];
        if let Some(all) = self.areas.all() {
            areas.copy_from_slice(&all[cells]);
        }
        let places = std::array::from_fn(|lane| (advances[lane] + by[lane]) / scales[lane]);
        let [carried, slopes] = curve.responses(places);
        for lane in 0..LANES {
            forces[lane] -= areas[lane] * scales[lane] * carried[lane];
            tangents[lane] = areas[lane] * slopes[lane];
        }
    }

    /// Energies and breaks of a cell since its contacts last re-formed together, at an advance since then.
    fn done(&self, cell: usize, advance: f64) -> CellEnergies {
        Cell { advance, ..self.cell(cell) }.done(0.0)
    }
}

impl Cells for Curves {
    fn len(&self) -> usize {
        self.advances.len()
    }

    fn extremes(&self) -> Extremes {
        self.first.extremes().and(self.fresh.extremes()).scaled(self.largest_strength, self.areas.largest())
    }

    fn error(&self) -> f64 {
        self.largest_strength * self.first.error().max(self.fresh.error())
    }

    fn areas(&self) -> CellAreas {
        self.areas.clone()
    }

    fn extend_curves(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<bool> {
        self.extend_by(longest(by), monitor)
    }

    fn largest_tangent(&self) -> f64 {
        let batch = self.batch();
        let nearest = |renewed: bool| {
            let place = |cell: usize| {
                if batch.is_renewed(cell) == renewed { batch.cell(cell).place(0.0) } else { f64::INFINITY }
            };
            gather(self.len(), || f64::INFINITY, |least: f64, cell| least.min(place(cell)), f64::min)
        };
        let steepest =
            self.first.largest_tangent(nearest(false)).max(self.fresh.largest_tangent(nearest(true)));
        self.areas.largest() * steepest
    }

    fn residual(
        &mut self,
        by: &[f64],
        forces: &mut [f64],
        tangents: &mut [f64],
        monitor: &mut dyn Monitor,
    ) -> Result<f64> {
        self.extend_curves(by, monitor)?;
        let batch = self.batch();
        Ok(change_chunks(forces, tangents, |first, forces, tangents| {
            batch.residual(first, by, forces, tangents)
        }))
    }

    fn force(&self, cell: usize) -> f64 {
        self.batch().cell(cell).force()
    }

    fn slopes(&mut self, by: &[f64], slopes: &mut [Slopes], monitor: &mut dyn Monitor) -> Result<()> {
        self.extend_curves(by, monitor)?;
        let batch = self.batch();
        fill_with(slopes, |cell| batch.cell(cell).slopes(by[cell]), monitor)
    }

    fn instability(&self, cell: usize, by: f64, slope: f64) -> Option<Instability> {
        self.batch().cell(cell).instability(by, slope)
    }

    fn advance(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<()> {
        let most = longest(by);
        self.extend_by(most, monitor)?;
        let courses = &self.courses;
        let on = |cell: usize, advance| {
            if courses[cell] == CellCourse::Free { advance } else { advance + by[cell] }
        };
        change(&mut self.advances, on);
        self.margin -= most;
        Ok(())
    }

    fn detach(&mut self, cell: usize, by: f64, _monitor: &mut dyn Monitor) -> Result<()> {
        let batch = self.batch();
        let begun = batch.done(cell, self.marked[cell]);
        // All contacts of the cell break and re-form: it keeps the elastic energy of re-formed contacts, and
        // the rest is dissipated.
        let renewed = Cell { curve: batch.fresh, advance: 0.0, ..batch.cell(cell) }.done(0.0);
        let done = batch.cell(cell).done(by).renewed(renewed.elastic, batch.areas.of(cell));
        self.detached.insert(cell, DetachedCell { done: done - begun, course: self.courses[cell] });
        self.settled = self.settled + CellEnergies { elastic: 0.0, ..done };
        self.advances[cell] = 0.0;
        self.courses[cell] = CellCourse::Free;
        self.margin = 0.0;
        Ok(())
    }

    fn reattach(&mut self) {
        for cell in self.detached.keys() {
            self.courses[*cell] = CellCourse::Fresh;
        }
    }

    fn mark_curves(&mut self) {
        [&mut self.first, &mut self.fresh].into_iter().for_each(CurveTable::mark);
    }

    fn recall_curves(&mut self) {
        self.margin = 0.0;
        [&mut self.first, &mut self.fresh].into_iter().for_each(CurveTable::recall);
    }

    fn mark(&mut self) {
        self.marked.clone_from(&self.advances);
        self.settled_at_mark = self.settled;
        self.detached.clear();
        self.mark_curves();
    }

    fn unmark(&mut self) {
        (self.marked, self.detached) = (Vec::new(), HashMap::new());
    }

    fn recall(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        self.advances.clone_from(&self.marked);
        self.settled = self.settled_at_mark;
        self.recall_curves();
        for (cell, detached) in self.detached.drain() {
            self.courses[cell] = detached.course;
        }
        Ok(())
    }

    fn since_mark(&self, cell: usize) -> CellEnergies {
        let batch = self.batch();
        match self.detached.get(&cell) {
            Some(detached) => detached.done,
            None => batch.done(cell, self.advances[cell]) - batch.done(cell, self.marked[cell]),
        }
    }

    fn energies(&self) -> CellEnergies {
        let batch = self.batch();
        let add = |sum, cell: usize| sum + batch.done(cell, batch.advances[cell]);
        self.settled + gather(self.len(), CellEnergies::default, add, |a, b| a + b)
    }

    fn standing(&self, cell: usize) -> Option<Standing> {
        let batch = self.batch();
        let at = batch.cell(cell);
        Some(Standing { advance: at.place(0.0), scale: at.scale, renewed: batch.is_renewed(cell) })
    }

    fn state(&self) -> CellsState {
        let batch = self.batch();
        CellsState(CellsSnapshot::Curves {
            advances: self.advances.clone(),
            renewed: (0..self.len()).map(|cell| batch.is_renewed(cell)).collect(),
            intervals: [self.first.intervals(), self.fresh.intervals()],
            settled: self.settled,
        })
    }

    fn restore(&mut self, state: CellsState, monitor: &mut dyn Monitor) -> Result<()> {
        let CellsSnapshot::Curves { advances, renewed, intervals, settled } = state.0 else {
            return Err(Error::invalid("state", "that of cells that share a curve", "another one"));
        };
        if (advances.len(), renewed.len()) != (self.len(), self.len()) {
            let expected = format!("that of {} cells", self.len());
            return Err(Error::invalid("state", expected, format!("that of {}", advances.len())));
        }
        let course = |renewed| if renewed { CellCourse::Fresh } else { CellCourse::First };
        self.courses = renewed.into_iter().map(course).collect();
        (self.advances, self.settled, self.margin) = (advances, settled, 0.0);
        self.detached.clear();
        for ((table, begun), known) in
            [&mut self.first, &mut self.fresh].into_iter().zip(&self.begun).zip(intervals)
        {
            // Steps depend on how far a curve is known.
            if table.intervals() > known {
                *table = CurveTable::new(begun.copy(), monitor)?;
            }
            table.resume(known, 0.0, monitor)?;
        }
        Ok(())
    }
}
