//! Cells that share one friction curve, F_j(X) = s_j F(X/s_j): nothing but an advance is kept of each.

use std::collections::HashMap;

use super::cell::Cell;
use super::curve::{Curve, LANES};
use super::tabulate::CurveTable;
use super::{CellEnergies, Cells, CellsSnapshot, CellsState, Extremes, Fall, Slopes, Standing, checked};
use crate::elastic::batch::{change, change_chunks, fill, gather, largest};
use crate::monitor::Monitor;
use crate::population::{Direction, Population};
use crate::{Error, Result};

/// Cells of contacts without rates, all of one kind: the force of each depends on its advance alone, along one curve
/// that is tabulated as far as it is needed.
///
/// All start from where the population stands; after all contacts of a cell have broken together it follows the
/// curve of contacts that have just re-formed. The scale s_j of a cell stretches thresholds and the stretches at which
/// contacts re-form, and so does lengths and forces, but not stiffness.
pub struct Curves {
    first: CurveTable,
    fresh: CurveTable,
    /// The contacts where their curves begin.
    begun: [Box<dyn Population>; 2],
    /// X since the start, or since the contacts last re-formed together.
    advances: Vec<f64>,
    courses: Vec<CellCourse>,
    /// Empty where all are 1.
    scales: Vec<f64>,
    largest_scale: f64,
    /// How far cells may go at least until the end of what is known of their curves; 0 where that is not known.
    margin: f64,
    settled: CellEnergies,
    /// Advances at the mark.
    marked: Vec<f64>,
    /// Cells that have parted since the mark.
    parted: HashMap<usize, Parted>,
    settled_at_mark: CellEnergies,
}

/// What a cell follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum CellCourse {
    /// The curve of the contacts as they were at the start.
    First,
    /// That of contacts that have all re-formed together.
    Fresh,
    /// None, until its contacts, broken together, re-form.
    Free,
}

impl Curves {
    /// So many cells that stand where `population` does.
    ///
    /// # Errors
    /// Those of the population; stopped by the monitor.
    pub fn new(population: &dyn Population, number: usize, monitor: &mut dyn Monitor) -> Result<Self> {
        let mut fresh = population.copy();
        fresh.reset(Direction::Forward, monitor)?;
        Ok(Self {
            first: CurveTable::new(population.copy(), monitor)?,
            fresh: CurveTable::new(fresh.copy(), monitor)?,
            begun: [population.copy(), fresh],
            advances: vec![0.0; number],
            courses: vec![CellCourse::First; number],
            scales: Vec::new(),
            largest_scale: 1.0,
            margin: 0.0,
            settled: CellEnergies::default(),
            marked: Vec::new(),
            parted: HashMap::new(),
            settled_at_mark: CellEnergies::default(),
        })
    }

    /// The same cells with scales s_j, one for each.
    ///
    /// # Errors
    /// Another number of scales than of cells; a scale that is not a finite number above 0, naming its cell.
    pub fn scaled(mut self, scales: Vec<f64>) -> Result<Self> {
        checked(&scales, self.advances.len())?;
        self.largest_scale = scales.iter().fold(0.0, |most, scale| scale.max(most));
        (self.scales, self.margin) = (scales, 0.0);
        Ok(self)
    }

    /// What threads may share.
    fn batch(&self) -> Batch<'_> {
        let Self { first, fresh, advances, courses, scales, .. } = self;
        Batch { first: &first.curve, fresh: &fresh.curve, advances, courses, scales }
    }

    /// Sees to it that curves are known as far as cells may go, none by more than `most`; whether they were not.
    fn reach_on(&mut self, most: f64, monitor: &mut dyn Monitor) -> Result<bool> {
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
        let known = [self.first.ways(), self.fresh.ways()];
        self.first.reach(first, 0.0, monitor)?;
        self.fresh.reach(fresh, 0.0, monitor)?;
        self.margin = self.least_margin();
        Ok(known != [self.first.ways(), self.fresh.ways()])
    }

    /// How far every cell may go until the end of what is known of its curve.
    fn least_margin(&self) -> f64 {
        let batch = self.batch();
        let left = |cell: usize| {
            let table = if batch.is_renewed(cell) { &self.fresh } else { &self.first };
            table.end() * batch.cell(cell).scale - self.advances[cell]
        };
        gather(self.len(), || f64::INFINITY, |least: f64, cell| least.min(left(cell)), f64::min)
    }
}

/// The longest of ways forward.
fn longest(by: &[f64]) -> f64 {
    largest(by.len(), |cell| by[cell])
}

/// A cell whose contacts have broken together since the mark.
struct Parted {
    /// What it had done since then.
    done: CellEnergies,
    /// What it followed before.
    course: CellCourse,
}

/// Curves and where cells are on them.
struct Batch<'a> {
    first: &'a Curve,
    fresh: &'a Curve,
    advances: &'a [f64],
    courses: &'a [CellCourse],
    scales: &'a [f64],
}

impl Batch<'_> {
    #[inline]
    fn cell(&self, cell: usize) -> Cell<'_> {
        let curve = if self.is_renewed(cell) { self.fresh } else { self.first };
        let scale = if self.scales.is_empty() { 1.0 } else { self.scales[cell] };
        Cell { curve, advance: self.advances[cell], scale, free: self.courses[cell] == CellCourse::Free }
    }

    /// Whether its contacts have broken all together.
    #[inline]
    fn is_renewed(&self, cell: usize) -> bool {
        self.courses[cell] != CellCourse::First
    }

    /// As [`Cell::resist`], of the cells from the first one on; the largest force that is left.
    fn resist(&self, first: usize, by: &[f64], forces: &mut [f64], tangents: &mut [f64]) -> f64 {
        let mut most = 0.0_f64;
        let lanes = forces.chunks_mut(LANES).zip(tangents.chunks_mut(LANES));
        for ((forces, tangents), first) in lanes.zip((first..).step_by(LANES)) {
            match self.shared(first, forces.len()) {
                Some(curve) => self.resist_on(curve, first, by, forces, tangents),
                None => {
                    for ((force, tangent), cell) in forces.iter_mut().zip(tangents).zip(first..) {
                        (*force, *tangent) = self.cell(cell).resist(by[cell], *force);
                    }
                }
            }
            most = forces.iter().fold(most, |most, force| most.max(force.abs()));
        }
        most
    }

    /// The curve that [`LANES`] cells from the first one on follow together.
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
    fn resist_on(&self, curve: &Curve, first: usize, by: &[f64], forces: &mut [f64], tangents: &mut [f64]) {
        let cells = first..first + LANES;
        let (advances, by) = (&self.advances[cells.clone()], &by[cells.clone()]);
        let mut scales = [1.0; LANES];
        if !self.scales.is_empty() {
            scales.copy_from_slice(&self.scales[cells]);
        }
        let places = std::array::from_fn(|lane| (advances[lane] + by[lane]) / scales[lane]);
        let [carried, slopes] = curve.responses(places);
        for lane in 0..LANES {
            forces[lane] -= scales[lane] * carried[lane];
        }
        tangents.copy_from_slice(&slopes);
    }

    /// What a cell has done since its contacts last re-formed together, at such an advance since then.
    fn done(&self, cell: usize, advance: f64) -> CellEnergies {
        Cell { advance, ..self.cell(cell) }.done(0.0)
    }
}

impl Cells for Curves {
    fn len(&self) -> usize {
        self.advances.len()
    }

    fn extremes(&self) -> Extremes {
        self.first.extremes().and(self.fresh.extremes()).scaled(self.largest_scale)
    }

    fn error(&self) -> f64 {
        self.largest_scale * self.first.error().max(self.fresh.error())
    }

    fn reach(&mut self, by: &[f64]) -> Result<bool> {
        self.reach_on(longest(by), &mut ())
    }

    fn stiffest(&self) -> f64 {
        let batch = self.batch();
        let nearest = |renewed: bool| {
            let place = |cell: usize| {
                if batch.is_renewed(cell) == renewed { batch.cell(cell).place(0.0) } else { f64::INFINITY }
            };
            gather(self.len(), || f64::INFINITY, |least: f64, cell| least.min(place(cell)), f64::min)
        };
        self.first.stiffest(nearest(false)).max(self.fresh.stiffest(nearest(true)))
    }

    fn resist(&mut self, by: &[f64], forces: &mut [f64], tangents: &mut [f64]) -> Result<f64> {
        self.reach(by)?;
        let batch = self.batch();
        Ok(change_chunks(forces, tangents, |first, forces, tangents| {
            batch.resist(first, by, forces, tangents)
        }))
    }

    fn slopes(&mut self, by: &[f64], slopes: &mut [Slopes]) -> Result<()> {
        self.reach(by)?;
        let batch = self.batch();
        fill(slopes, |cell| batch.cell(cell).slopes(by[cell]));
        Ok(())
    }

    fn fall(&self, cell: usize, by: f64, slope: f64) -> Option<Fall> {
        self.batch().cell(cell).fall(by, slope)
    }

    fn advance(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<()> {
        let most = longest(by);
        self.reach_on(most, monitor)?;
        let courses = &self.courses;
        let on = |cell: usize, advance| {
            if courses[cell] == CellCourse::Free { advance } else { advance + by[cell] }
        };
        change(&mut self.advances, on);
        self.margin -= most;
        Ok(())
    }

    fn part(&mut self, cell: usize, by: f64, _monitor: &mut dyn Monitor) -> Result<()> {
        let batch = self.batch();
        let begun = batch.done(cell, self.marked[cell]);
        let newborn = Cell { curve: batch.fresh, advance: 0.0, ..batch.cell(cell) }.done(0.0);
        let done = batch.cell(cell).done(by).renewed(newborn.elastic);
        self.parted.insert(cell, Parted { done: done - begun, course: self.courses[cell] });
        self.settled = self.settled + CellEnergies { elastic: 0.0, ..done };
        self.advances[cell] = 0.0;
        self.courses[cell] = CellCourse::Free;
        self.margin = 0.0;
        Ok(())
    }

    fn rejoin(&mut self) {
        for cell in self.parted.keys() {
            self.courses[*cell] = CellCourse::Fresh;
        }
    }

    fn mark(&mut self) {
        self.marked.clone_from(&self.advances);
        self.settled_at_mark = self.settled;
        self.parted.clear();
        [&mut self.first, &mut self.fresh].into_iter().for_each(CurveTable::mark);
    }

    fn unmark(&mut self) {
        (self.marked, self.parted) = (Vec::new(), HashMap::new());
    }

    fn recall(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        self.margin = 0.0;
        self.advances.clone_from(&self.marked);
        self.settled = self.settled_at_mark;
        [&mut self.first, &mut self.fresh].into_iter().for_each(CurveTable::recall);
        for (cell, parted) in self.parted.drain() {
            self.courses[cell] = parted.course;
        }
        Ok(())
    }

    fn since(&self, cell: usize) -> CellEnergies {
        let batch = self.batch();
        match self.parted.get(&cell) {
            Some(parted) => parted.done,
            None => batch.done(cell, self.advances[cell]) - batch.done(cell, self.marked[cell]),
        }
    }

    fn account(&self) -> CellEnergies {
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
            ways: [self.first.ways(), self.fresh.ways()],
            settled: self.settled,
        })
    }

    fn restore(&mut self, state: CellsState, monitor: &mut dyn Monitor) -> Result<()> {
        let CellsSnapshot::Curves { advances, renewed, ways, settled } = state.0 else {
            return Err(Error::invalid("state", "that of cells that share a curve", "another one"));
        };
        if (advances.len(), renewed.len()) != (self.len(), self.len()) {
            let expected = format!("that of {} cells", self.len());
            return Err(Error::invalid("state", expected, format!("that of {}", advances.len())));
        }
        let course = |renewed| if renewed { CellCourse::Fresh } else { CellCourse::First };
        self.courses = renewed.into_iter().map(course).collect();
        (self.advances, self.settled, self.margin) = (advances, settled, 0.0);
        self.parted.clear();
        for ((table, begun), ways) in
            [&mut self.first, &mut self.fresh].into_iter().zip(&self.begun).zip(ways)
        {
            // Steps depend on how far a curve is known.
            if table.ways() > ways {
                *table = CurveTable::new(begun.copy(), monitor)?;
            }
            table.resume(ways, 0.0, monitor)?;
        }
        Ok(())
    }
}
