//! Cells that share one friction curve, F_j(X) = s_j F(X/s_j): nothing but an advance is kept of each.

use std::collections::HashMap;

use super::cell::Cell;
use super::curve::Curve;
use super::tabulate::Table;
use super::{Account, Cells, Kept, Slopes, Standing, State, checked};
use crate::elastic::batch::{all, change, change_and_fill, fill, gather, largest};
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
    first: Table,
    fresh: Table,
    /// X since the start, or since the contacts last re-formed together.
    advances: Vec<f64>,
    courses: Vec<Course>,
    /// Empty where all are 1.
    scales: Vec<f64>,
    largest_scale: f64,
    settled: Account,
    /// Advances at the mark.
    marked: Vec<f64>,
    /// Cells that have parted since the mark.
    parted: HashMap<usize, Parted>,
    settled_at_mark: Account,
}

/// What a cell follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Course {
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
            first: Table::new(population.copy(), monitor)?,
            fresh: Table::new(fresh, monitor)?,
            advances: vec![0.0; number],
            courses: vec![Course::First; number],
            scales: Vec::new(),
            largest_scale: 1.0,
            settled: Account::default(),
            marked: Vec::new(),
            parted: HashMap::new(),
            settled_at_mark: Account::default(),
        })
    }

    /// The same cells with scales s_j, one for each.
    ///
    /// # Errors
    /// Another number of scales than of cells; a scale that is not a finite number above 0, naming its cell.
    pub fn scaled(mut self, scales: Vec<f64>) -> Result<Self> {
        checked(&scales, self.advances.len())?;
        self.largest_scale = scales.iter().fold(0.0, |most, scale| scale.max(most));
        self.scales = scales;
        Ok(self)
    }

    /// What threads may share.
    fn batch(&self) -> Batch<'_> {
        let Self { first, fresh, advances, courses, scales, .. } = self;
        Batch { first: &first.curve, fresh: &fresh.curve, advances, courses, scales }
    }

    /// Sees to it that curves are known as far as cells may go.
    fn reach(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<()> {
        let batch = self.batch();
        let table = |cell: usize| if batch.is_renewed(cell) { &self.fresh } else { &self.first };
        if all(by.len(), |cell| table(cell).knows(batch.cell(cell).place(by[cell]))) {
            return Ok(());
        }
        let furthest = |fresh: bool| {
            largest(by.len(), |cell| {
                if batch.is_renewed(cell) == fresh { batch.cell(cell).place(by[cell]) } else { 0.0 }
            })
        };
        let (first, fresh) = (furthest(false), furthest(true));
        self.first.reach(first, 0.0, monitor)?;
        self.fresh.reach(fresh, 0.0, monitor)
    }
}

/// A cell whose contacts have broken together since the mark.
struct Parted {
    /// What it had done since then.
    done: Account,
    /// What it followed before.
    course: Course,
}

/// Curves and where cells are on them.
struct Batch<'a> {
    first: &'a Curve,
    fresh: &'a Curve,
    advances: &'a [f64],
    courses: &'a [Course],
    scales: &'a [f64],
}

impl Batch<'_> {
    #[inline]
    fn cell(&self, cell: usize) -> Cell<'_> {
        let curve = if self.is_renewed(cell) { self.fresh } else { self.first };
        let scale = if self.scales.is_empty() { 1.0 } else { self.scales[cell] };
        Cell { curve, advance: self.advances[cell], scale, free: self.courses[cell] == Course::Free }
    }

    /// Whether its contacts have broken all together.
    #[inline]
    fn is_renewed(&self, cell: usize) -> bool {
        self.courses[cell] != Course::First
    }

    /// What a cell has done since its contacts last re-formed together, at such an advance since then.
    fn done(&self, cell: usize, advance: f64) -> Account {
        Cell { advance, ..self.cell(cell) }.done(0.0)
    }
}

impl Cells for Curves {
    fn len(&self) -> usize {
        self.advances.len()
    }

    fn steepest(&self) -> f64 {
        self.first.steepest().max(self.fresh.steepest())
    }

    fn strongest(&self) -> f64 {
        self.largest_scale * self.first.strongest().max(self.fresh.strongest())
    }

    fn resist(&mut self, by: &[f64], forces: &mut [f64], tangents: &mut [f64]) -> Result<()> {
        self.reach(by, &mut ())?;
        let batch = self.batch();
        change_and_fill(forces, tangents, |cell, force| batch.cell(cell).resist(by[cell], force));
        Ok(())
    }

    fn slopes(&mut self, from: Option<&[f64]>, to: &[f64], slopes: &mut [Slopes]) -> Result<()> {
        self.reach(to, &mut ())?;
        let batch = self.batch();
        fill(slopes, |cell| batch.cell(cell).slopes(from.map_or(0.0, |from| from[cell]), to[cell]));
        Ok(())
    }

    fn fall(&self, cell: usize, by: f64, slope: f64) -> Option<f64> {
        self.batch().cell(cell).fall(by, slope)
    }

    fn advance(&mut self, by: &[f64], monitor: &mut dyn Monitor) -> Result<()> {
        self.reach(by, monitor)?;
        let courses = &self.courses;
        let on =
            |cell: usize, advance| if courses[cell] == Course::Free { advance } else { advance + by[cell] };
        change(&mut self.advances, on);
        Ok(())
    }

    fn part(&mut self, cell: usize, by: f64, _monitor: &mut dyn Monitor) -> Result<()> {
        let batch = self.batch();
        let begun = batch.done(cell, self.marked[cell]);
        let newborn = Cell { curve: batch.fresh, advance: 0.0, ..batch.cell(cell) }.done(0.0);
        let done = batch.cell(cell).done(by).renewed(newborn.elastic);
        self.parted.insert(cell, Parted { done: done - begun, course: self.courses[cell] });
        self.settled = self.settled + Account { elastic: 0.0, ..done };
        self.advances[cell] = 0.0;
        self.courses[cell] = Course::Free;
        Ok(())
    }

    fn rejoin(&mut self) {
        for cell in self.parted.keys() {
            self.courses[*cell] = Course::Fresh;
        }
    }

    fn mark(&mut self) {
        self.marked.clone_from(&self.advances);
        self.settled_at_mark = self.settled;
        self.parted.clear();
        [&mut self.first, &mut self.fresh].into_iter().for_each(Table::mark);
    }

    fn unmark(&mut self) {
        (self.marked, self.parted) = (Vec::new(), HashMap::new());
    }

    fn recall(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        self.advances.clone_from(&self.marked);
        self.settled = self.settled_at_mark;
        [&mut self.first, &mut self.fresh].into_iter().for_each(Table::recall);
        for (cell, parted) in self.parted.drain() {
            self.courses[cell] = parted.course;
        }
        Ok(())
    }

    fn since(&self, cell: usize) -> Account {
        let batch = self.batch();
        match self.parted.get(&cell) {
            Some(parted) => parted.done,
            None => batch.done(cell, self.advances[cell]) - batch.done(cell, self.marked[cell]),
        }
    }

    fn account(&self) -> Account {
        let batch = self.batch();
        let add = |sum, cell: usize| sum + batch.done(cell, batch.advances[cell]);
        self.settled + gather(self.len(), Account::default, add, |a, b| a + b)
    }

    fn standing(&self, cell: usize) -> Option<Standing> {
        let batch = self.batch();
        let at = batch.cell(cell);
        Some(Standing { advance: at.place(0.0), scale: at.scale, renewed: batch.is_renewed(cell) })
    }

    fn state(&self) -> State {
        let batch = self.batch();
        State(Kept::Curves {
            advances: self.advances.clone(),
            renewed: (0..self.len()).map(|cell| batch.is_renewed(cell)).collect(),
            ways: [self.first.ways(), self.fresh.ways()],
            settled: self.settled,
        })
    }

    fn restore(&mut self, state: State, monitor: &mut dyn Monitor) -> Result<()> {
        let Kept::Curves { advances, renewed, ways, settled } = state.0 else {
            return Err(Error::invalid("state", "that of cells that share a curve", "another one"));
        };
        if (advances.len(), renewed.len()) != (self.len(), self.len()) {
            let expected = format!("that of {} cells", self.len());
            return Err(Error::invalid("state", expected, format!("that of {}", advances.len())));
        }
        let course = |renewed| if renewed { Course::Fresh } else { Course::First };
        self.courses = renewed.into_iter().map(course).collect();
        (self.advances, self.settled) = (advances, settled);
        self.parted.clear();
        self.first.resume(ways[0], 0.0, monitor)?;
        self.fresh.resume(ways[1], 0.0, monitor)
    }
}
