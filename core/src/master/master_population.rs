//! The contacts of a master equation, moved back and forth.

mod state;

use std::sync::Arc;

use super::loading::{BranchEnergies, LoadingBranch};
use super::renewal::unit_force;
use super::solved_branches::SolvedBranches;
use super::unloading::UnloadingBranch;
use super::{MasterEquation, Tolerance};
use crate::Result;
use crate::law::Atom;
use crate::life::{Layer, LayerSums, Life, walls};
use crate::monitor::{Monitor, Watch};
use crate::population::{Books, Direction, Population, Response, Way};
use crate::rate_dependent::State;

/// The contacts of a master equation as a [`Population`].
///
/// A course is solved from the stretches at the place where it begins. As long as the slider goes back from its furthest
/// point on the course without breaking a contact, stretches only shift: the way back is a straight line, and so is the
/// way forth again. Once a contact breaks on the way back, another course begins at the furthest point.
#[derive(Debug, Clone)]
pub struct MasterPopulation {
    interface: Arc<SolvedBranches>,
    /// The life of the contacts at X = 0.
    start: Arc<Life>,
    course: Arc<LoadingBranch>,
    /// The way of the course, and the position at its beginning.
    direction: Direction,
    origin: f64,
    /// The furthest advance on the course, the cell of the solution ahead of it, and how far the slider is behind it.
    furthest: f64,
    cell: usize,
    behind: f64,
    /// The way back from the furthest advance, once looked at.
    back: Option<UnloadingBranch>,
    moved: Direction,
    looked: Direction,
    /// Whether what is about to break together will stay free.
    holding: bool,
    /// What has broken before the course and stayed free.
    free: f64,
    /// Energy lost and breaks before the course, per contact and unit stiffness.
    lost: f64,
    broken: f64,
    /// What the stretches at the beginning of the course are off by, as an error of the force on it, and the largest error of
    /// the force before; both as [`LoadingBranch::error`] tells them.
    inherited: f64,
    worst: f64,
    /// The state to come back to.
    marked: Option<Box<Self>>,
}

impl MasterEquation {
    /// The contacts at X = 0 as a population to be moved, F/(N_c⟨k⟩) to about `tolerance` × the mean threshold.
    /// What breaks at once in a relaxed start has broken before. Contacts at a velocity can be moved forward, and reset.
    ///
    /// # Errors
    /// A tolerance outside [1e-12, 1e-2]; `ageing.mean_field`; too many point masses; accuracy not reached;
    /// stopped by the monitor.
    pub fn population(
        &self,
        tolerance: impl Into<Tolerance>,
        monitor: &mut dyn Monitor,
    ) -> Result<MasterPopulation> {
        let tolerance = tolerance.into();
        tolerance.check()?;
        self.has_transients()?;
        let interface = SolvedBranches::of(self, tolerance);
        let course = interface.first(self, monitor)?;
        Ok(MasterPopulation {
            interface: Arc::new(interface),
            start: course.first().clone(),
            course: Arc::new(course),
            direction: Direction::Forward,
            origin: 0.0,
            furthest: 0.0,
            cell: 0,
            behind: 0.0,
            back: None,
            moved: Direction::Forward,
            looked: Direction::Forward,
            holding: false,
            free: 0.0,
            lost: 0.0,
            broken: 0.0,
            inherited: 0.0,
            worst: 0.0,
            marked: None,
        })
    }
}

impl MasterPopulation {
    /// The share of contacts that can be told where they are or that they are free, by quadrature over stretches: 1.
    pub fn total_probability(&self) -> f64 {
        if let Some(kept) = self.course.kept(self.furthest).filter(|_| self.interface.knows_time()) {
            return kept;
        }
        let there = LayerSums::of(&self.layers(), &self.interface.contacts).unbroken;
        there + self.free + if self.course.is_held() { self.account().broken } else { 0.0 }
    }

    /// Whether `direction` is the way of the course.
    fn is_onward(&self, direction: Direction) -> bool {
        direction == self.direction
    }

    /// The direction of a move, or, of none, that last looked in.
    fn towards(&self, by: f64) -> Direction {
        match by {
            by if by > 0.0 => Direction::Forward,
            by if by < 0.0 => Direction::Backward,
            _ => self.looked,
        }
    }

    /// Looks at the way back, as far as it has not been before.
    fn look_back(&mut self) -> Result<&UnloadingBranch> {
        self.interface.forgets("drive", "a way back")?;
        let back = match self.back.take() {
            Some(back) => back,
            None => UnloadingBranch::new(&self.course, (self.furthest, self.cell), &self.interface),
        };
        let back = self.back.insert(back);
        if self.behind >= back.length {
            back.solve(self.course.is_held(), &self.interface)?;
        }
        Ok(back)
    }

    /// Force and slope, per unit stiffness and seen along the course, after a move on by `by`, or back by −`by`.
    fn response(&self, by: f64, onward: bool) -> (f64, f64) {
        if onward && self.behind == 0.0 {
            return self.course.response(self.furthest + by, self.cell);
        }
        let (force, slope) = self.course.response(self.furthest, self.cell);
        match &self.back {
            Some(UnloadingBranch { length, course: Some(course), .. })
                if !onward && self.behind >= *length =>
            {
                let (force, slope) = course.response(self.behind - by, course.cell(self.behind));
                (-force, slope)
            }
            Some(UnloadingBranch { stiffness, .. }) => (force - stiffness * (self.behind - by), *stiffness),
            None if !onward && self.interface.knows_time() => {
                let stiffness = self.interface.newborn_stiffness();
                (force + stiffness * by, stiffness)
            }
            None => (force, slope),
        }
    }

    /// Moves on along the course by `by`.
    fn go_on(&mut self, by: f64) -> Result<()> {
        self.back = None;
        let (next, end) = (self.furthest + by, self.course.cell_end(self.cell));
        if next < end - self.interface.near() {
            self.furthest = next;
            return Ok(());
        }
        self.furthest = end;
        if self.course.breaks_after(self.cell) { Ok(()) } else { self.go_over(false) }
    }

    /// Goes over the end of a cell, where what breaks together has `crossed` or nothing is known to.
    fn go_over(&mut self, crossed: bool) -> Result<()> {
        self.cell += 1;
        if self.furthest >= self.course.end() {
            self.look_further(crossed, &mut ())?;
        }
        Ok(())
    }

    /// Solves the course for twice the way. What breaks together where it ended is known only then.
    fn look_further(&mut self, crossed: bool, monitor: &mut dyn Monitor) -> Result<()> {
        let end = 2.0 * self.course.end();
        let Some(course) = self.course.extended(end, self.interface.tolerance, monitor)? else {
            return Ok(());
        };
        self.cell = course.cell(self.furthest);
        if let Some(before) =
            self.cell.checked_sub(1).filter(|&before| !crossed && course.breaks_after(before))
            && (course.cell_end(before) - self.furthest).abs() <= self.interface.near()
        {
            // In front of it, for whoever moves the contacts has not been told.
            (self.cell, self.furthest) = (before, self.furthest.min(course.cell_end(before).next_down()));
        }
        self.course = Arc::new(course);
        Ok(())
    }

    /// Whether contacts here are about to break together.
    fn stands(&self) -> bool {
        self.behind == 0.0
            && self.furthest == self.course.cell_end(self.cell)
            && self.course.breaks_after(self.cell)
    }

    /// Breaks what breaks together here, and leaves it free.
    fn part(&mut self) {
        let contacts = &self.interface.contacts;
        let [before, after] =
            [false, true].map(|crossed| self.course.layers(self.furthest, self.cell, crossed, contacts));
        let course = self.interface.held(after.clone());
        let [before, after] = [before, after].map(|layers| LayerSums::of(&layers, contacts));
        let broken = before.unbroken - after.unbroken;
        self.settle();
        self.lost += before.breaking_energy - after.breaking_energy;
        self.broken += broken;
        self.free += broken;
        self.begin(Arc::new(course), self.direction);
    }

    /// Goes over to the course back from the furthest point, where its straight part ends.
    fn turn(&mut self) -> Result<()> {
        if let UnloadingBranch { course: Some(course), length, breaks, .. } = self.look_back()?.clone() {
            self.behind = 0.0;
            self.settle();
            self.begin(course, self.direction.reversed());
            self.furthest = length;
            self.cell = self.course.cell(length);
            if breaks && self.cell > 0 {
                self.cell -= 1;
                self.furthest = self.course.cell_end(self.cell);
            }
        }
        Ok(())
    }

    /// Begins another course where the slider is.
    fn begin(&mut self, course: Arc<LoadingBranch>, direction: Direction) {
        self.inherited += self.course.error();
        self.worst = self.worst.max(self.inherited);
        (self.origin, self.direction) = (self.position(), direction);
        (self.course, self.furthest, self.cell, self.behind) = (course, 0.0, 0, 0.0);
        self.back = None;
    }

    /// Adds what has happened on the loading branch to the energies.
    fn settle(&mut self) {
        let account = self.account();
        self.lost += account.lost;
        self.broken += account.broken;
        self.free += if self.course.is_held() { account.broken } else { 0.0 };
    }

    /// Energies of the loading branch.
    fn account(&self) -> BranchEnergies {
        let account = self.course.account(self.furthest, self.cell);
        let Some(UnloadingBranch { stiffness, .. }) = self.back.as_ref().filter(|_| self.behind > 0.0) else {
            return account;
        };
        let (force, _) = self.course.response(self.furthest, self.cell);
        let elastic = account.elastic - (force - 0.5 * stiffness * self.behind) * self.behind;
        BranchEnergies { elastic, ..account }
    }

    /// The contacts as they are, seen along the course.
    fn layers(&self) -> Vec<Layer> {
        let layers = self.course.layers(self.furthest, self.cell, false, &self.interface.contacts);
        if self.behind == 0.0 {
            return layers;
        }
        layers.iter().map(|layer| layer.mirrored().advanced(self.behind).mirrored()).collect()
    }
}

impl Population for MasterPopulation {
    fn position(&self) -> f64 {
        self.origin + self.direction.sign() * (self.furthest - self.behind)
    }

    fn way(&mut self, direction: Direction, monitor: &mut dyn Monitor) -> Result<Way> {
        self.looked = direction;
        if self.stands() && (self.holding || self.is_onward(direction)) {
            self.cross(monitor)?;
        }
        if self.is_onward(direction) {
            if self.behind > 0.0 {
                let breaks = self.furthest == self.course.cell_end(self.cell);
                return Ok(Way { length: self.behind, straight: true, breaks });
            }
            if self.course.cell_end(self.cell) >= self.course.end() {
                // Before its last cell is gone through: this may take long, and somebody listens now.
                self.look_further(true, monitor)?;
            }
            let length = self.course.cell_end(self.cell) - self.furthest;
            return Ok(Way {
                length,
                straight: length.is_infinite(),
                breaks: self.course.breaks_after(self.cell),
            });
        }
        if self.interface.knows_time() {
            // It begins as a straight line; that it cannot be gone is told by whoever goes it.
            return Ok(Way { length: f64::INFINITY, straight: true, breaks: false });
        }
        let behind = self.behind;
        let back = self.look_back()?;
        Ok(match &back.course {
            Some(course) if behind >= back.length => {
                let cell = course.cell(behind);
                let length = course.cell_end(cell) - behind;
                Way { length, straight: length.is_infinite(), breaks: course.breaks_after(cell) }
            }
            _ => Way { length: back.length - behind, straight: true, breaks: back.breaks },
        })
    }

    fn ahead(&self, by: f64) -> Response {
        let onward = self.is_onward(self.towards(by));
        let (force, slope) = self.response(if onward { by.abs() } else { -by.abs() }, onward);
        let stiffness = self.interface.stiffness;
        Response { force: self.direction.sign() * stiffness * force, tangent: stiffness * slope }
    }

    fn advance(&mut self, by: f64) -> Result<()> {
        if by == 0.0 {
            return Ok(());
        }
        let direction = self.towards(by);
        let way = self.way(direction, &mut ())?;
        let (by, near) = (by.abs().min(way.length), self.interface.near());
        self.moved = direction;
        if self.is_onward(direction) {
            if self.behind == 0.0 {
                return self.go_on(by);
            }
            self.behind = if by < self.behind - near { self.behind - by } else { 0.0 };
            return Ok(());
        }
        let behind = self.behind + by;
        let length = self.look_back()?.length;
        if behind < length - near {
            self.behind = behind;
            return Ok(());
        }
        self.behind = length;
        self.turn()?;
        if length > 0.0 { Ok(()) } else { self.go_on(by) }
    }

    fn cross(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        if !self.stands() {
            return Ok(());
        }
        if std::mem::take(&mut self.holding) {
            self.part();
            return Ok(());
        }
        self.go_over(true)
    }

    fn reset(&mut self, direction: Direction, _monitor: &mut dyn Monitor) -> Result<()> {
        let fresh = self.interface.fresh()?;
        let released = self.account().elastic - self.interface.newborn_energy();
        self.settle();
        self.lost += released;
        self.broken += 1.0 - std::mem::take(&mut self.free);
        self.begin(fresh, direction);
        // Of what has been, fresh contacts know nothing.
        self.inherited = 0.0;
        (self.moved, self.looked, self.holding) = (direction, direction, false);
        Ok(())
    }

    fn hold(&mut self) -> Result<()> {
        self.interface.forgets("block.slip", "contacts held free as they break")?;
        self.holding = !self.course.is_held() && self.stands();
        if !self.course.is_held() && !self.holding {
            let course = self.interface.held(self.layers());
            self.settle();
            self.begin(Arc::new(course), self.direction);
        }
        Ok(())
    }

    fn release(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        self.holding = false;
        if !self.course.is_held() {
            return Ok(());
        }
        self.cross(monitor)?;
        let mut layers = self.layers();
        let free = self.free + self.account().broken;
        let newborn = self.interface.reborn.layers().iter().map(|layer| {
            let layer = layer.clone().scaled(free);
            if self.moved == self.direction { layer } else { layer.mirrored() }
        });
        layers.extend(newborn);
        let course = self.interface.renewed(layers, &mut ())?;
        self.settle();
        self.lost -= std::mem::take(&mut self.free) * self.interface.newborn_energy();
        self.begin(Arc::new(course), self.direction);
        Ok(())
    }

    /// That of the course, and of all since contacts last re-formed together whose stretches it began with.
    fn error(&self) -> f64 {
        let error = self.worst.max(self.inherited + self.course.error());
        self.interface.stiffness * unit_force(&self.interface.reborn) * error
    }

    fn mark(&mut self) {
        self.marked = None;
        self.marked = Some(Box::new(self.clone()));
    }

    fn recall(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        if let Some(marked) = self.marked.take() {
            *self = *marked;
        }
        Ok(())
    }

    fn books(&self) -> Books {
        let BranchEnergies { elastic, lost, broken } = self.account();
        let stiffness = self.interface.stiffness;
        Books {
            elastic: stiffness * elastic,
            lost: stiffness * (self.lost + lost),
            broken: self.broken + broken,
        }
    }

    fn stretch_density(
        &self,
        stretches: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(Vec<f64>, Vec<Atom>)>> {
        if self.interface.knows_time() {
            let found = self.course.stretch_density(self.furthest, stretches, monitor)?;
            return Ok(found.map(|found| (found.density, found.atoms)));
        }
        let (layers, sign) = (self.layers(), self.direction.sign());
        let thresholds = self.interface.contacts.thresholds.as_ref();
        let watch = Watch::new(monitor);
        let unbroken = |x: f64| layers.iter().map(|layer| layer.unbroken_density(sign * x, thresholds)).sum();
        let density = stretches.iter().map(|&x| watch.value(|| unbroken(x))).collect();
        watch.check()?;
        let walls = walls(thresholds);
        let atoms = layers.iter().flat_map(|layer| layer.unbroken_atoms(thresholds, &walls));
        let mut atoms: Vec<_> = atoms
            .map(|atom| Atom { position: sign * atom.position, ..atom })
            .filter(|a| a.weight > 0.0)
            .collect();
        atoms.sort_by(|a, b| a.position.total_cmp(&b.position));
        Ok(Some((density, atoms)))
    }

    fn copy(&self) -> Box<dyn Population> {
        Box::new(self.clone())
    }

    fn state(&self) -> State {
        self.kept()
    }

    fn restore(&mut self, state: &State, monitor: &mut dyn Monitor) -> Result<()> {
        self.take_up(state, monitor)
    }
}
