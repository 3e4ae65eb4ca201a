//! The contacts of a master equation as a population that can be moved back and forth.

mod state;

use std::sync::Arc;

use super::loading::{BranchEnergies, LoadingBranch};
use super::renewal::unit_force;
use super::solved_branches::SolvedBranches;
use super::unloading::UnloadingBranch;
use super::{MasterEquation, Tolerance};
use crate::energy::ContactEnergies;
use crate::law::Atom;
use crate::life::{Layer, LayerSums, Life, threshold_atoms};
use crate::monitor::{Monitor, Watch};
use crate::population::{Direction, Population, Response, SmoothInterval};
use crate::rate_dependent::ContactsState;
use crate::{Error, Result};

/// The contacts of a master equation as a [`Population`].
///
/// A loading branch is solved from the stretches at its start. While the slider moves back from its furthest
/// point on the branch without breaking a contact, stretches only shift: unloading and reloading follow one
/// straight line. As soon as a contact breaks on the way back, a new branch starts from the furthest point.
#[derive(Debug, Clone)]
pub struct MasterPopulation {
    interface: Arc<SolvedBranches>,
    /// The life of the contacts at X = 0.
    start: Arc<Life>,
    /// The present branch.
    branch: Arc<LoadingBranch>,
    /// The direction of the branch, and the position at its start.
    direction: Direction,
    origin: f64,
    /// The largest advance on the branch, the cell of the solution ahead of it, and the distance of the
    /// slider behind it.
    furthest: f64,
    cell: usize,
    behind: f64,
    /// The unloading branch from the furthest advance, once needed.
    back: Option<UnloadingBranch>,
    moved: Direction,
    looked: Direction,
    /// Whether contacts that are about to break simultaneously will stay free.
    holding: bool,
    /// Fraction that broke before this branch and stayed free.
    free: f64,
    /// Energy dissipated and fraction broken before this branch, per contact and unit stiffness.
    lost: f64,
    broken: f64,
    /// Error of the force due to the stretches at the start of the branch, and the largest error of the force
    /// before; both as in [`LoadingBranch::error`].
    inherited: f64,
    worst: f64,
    /// The state to return to.
    marked: Option<Box<Self>>,
}

impl MasterEquation {
    /// The contacts at X = 0 as a population, as accurate as [`Tolerance::default`]. Contacts that break at once in a
    /// relaxed start have broken before. Contacts at a velocity can only be moved forward, and reset.
    ///
    /// # Errors
    /// `ageing.mean_field`; free contacts with friction; too many point masses.
    pub fn population(&self) -> Result<MasterPopulation> {
        self.population_with(Tolerance::default(), &mut ())
    }

    /// The same with F/(N_c⟨k⟩) accurate to about `tolerance` × the mean threshold, watched by a monitor.
    ///
    /// # Errors
    /// As [`Self::population`]; a tolerance outside [1e-12, 1e-2]; accuracy not reached; stopped by the monitor.
    pub fn population_with(
        &self,
        tolerance: impl Into<Tolerance>,
        monitor: &mut dyn Monitor,
    ) -> Result<MasterPopulation> {
        let tolerance = tolerance.into();
        tolerance.check()?;
        self.has_transients()?;
        let friction = self.contacts.rules.free_friction;
        if !friction.is_none() {
            let expected = "none for contacts that a block moves without time (a Transport or an ensemble in time has it)";
            return Err(Error::invalid("free_friction", expected, format!("a force of {}", friction.force)));
        }
        let interface = SolvedBranches::of(self, tolerance);
        let branch = interface.first(self, monitor)?;
        Ok(MasterPopulation {
            interface: Arc::new(interface),
            start: branch.first().clone(),
            branch: Arc::new(branch),
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
    /// ∫Q plus the fraction of free contacts, by quadrature over stretches: 1.
    pub fn total_probability(&self) -> f64 {
        if let Some(total_probability) =
            self.branch.total_probability(self.furthest).filter(|_| self.interface.is_time_dependent())
        {
            return total_probability;
        }
        let there = LayerSums::of(&self.layers(), &self.interface.contacts).unbroken;
        there + self.free + if self.branch.is_held() { self.branch_energies().broken } else { 0.0 }
    }

    /// Whether `direction` is that of the branch.
    fn is_onward(&self, direction: Direction) -> bool {
        direction == self.direction
    }

    /// The direction of a move; for a zero move the one last asked about.
    fn towards(&self, by: f64) -> Direction {
        match by {
            by if by > 0.0 => Direction::Forward,
            by if by < 0.0 => Direction::Backward,
            _ => self.looked,
        }
    }

    /// The unloading branch, solved as far as needed.
    fn unloading_branch(&mut self, monitor: &mut dyn Monitor) -> Result<&UnloadingBranch> {
        self.interface.require_one_way("drive", "a way back")?;
        let back = match self.back.take() {
            Some(back) => back,
            None => UnloadingBranch::new(&self.branch, (self.furthest, self.cell), &self.interface),
        };
        let back = self.back.insert(back);
        if self.behind >= back.length {
            back.solve(self.branch.is_held(), &self.interface, monitor)?;
        }
        Ok(back)
    }

    /// Force and slope, per unit stiffness and seen along the branch, after a further advance `by`, or back
    /// by −`by`.
    fn response(&self, by: f64, onward: bool) -> (f64, f64) {
        if onward && self.behind == 0.0 {
            return self.branch.response(self.furthest + by, self.cell);
        }
        let (force, slope) = self.branch.response(self.furthest, self.cell);
        match &self.back {
            Some(UnloadingBranch { length, branch: Some(branch), .. })
                if !onward && self.behind >= *length =>
            {
                let (force, slope) = branch.response(self.behind - by, branch.cell(self.behind));
                (-force, slope)
            }
            Some(UnloadingBranch { stiffness, .. }) => (force - stiffness * (self.behind - by), *stiffness),
            None if !onward && self.interface.is_time_dependent() => {
                let stiffness = self.interface.fresh_stiffness();
                (force + stiffness * by, stiffness)
            }
            None => (force, slope),
        }
    }

    /// Advances by `by` along the branch.
    fn advance_on_branch(&mut self, by: f64) -> Result<()> {
        self.back = None;
        let (next, end) = (self.furthest + by, self.branch.cell_end(self.cell));
        // A position within rounding of the end of a cell is the end, where contacts may break together.
        if next < end - self.interface.rounding() {
            self.furthest = next;
            return Ok(());
        }
        self.furthest = end;
        if self.branch.breaks_after(self.cell) { Ok(()) } else { self.enter_next_cell(false) }
    }

    /// Goes to the next cell; contacts that break simultaneously at its start have `crossed` their thresholds
    /// or are not known to.
    fn enter_next_cell(&mut self, crossed: bool) -> Result<()> {
        self.cell += 1;
        if self.furthest >= self.branch.end() {
            self.extend_branch(crossed, &mut ())?;
        }
        Ok(())
    }

    /// Solves the branch for twice the distance. Simultaneous breaks where it ended are known only then.
    fn extend_branch(&mut self, crossed: bool, monitor: &mut dyn Monitor) -> Result<()> {
        // Doubling keeps the total cost of all extensions below twice that of the last one,
        // although each solves from the start.
        let end = 2.0 * self.branch.end();
        let Some(branch) = self.branch.extended(end, self.interface.tolerance, monitor)? else {
            return Ok(());
        };
        self.cell = branch.cell(self.furthest);
        if let Some(before) =
            self.cell.checked_sub(1).filter(|&before| !crossed && branch.breaks_after(before))
            && (branch.cell_end(before) - self.furthest).abs() <= self.interface.rounding()
        {
            // Stay in front of a simultaneous break that has not been reported to the caller.
            (self.cell, self.furthest) = (before, self.furthest.min(branch.cell_end(before).next_down()));
        }
        self.branch = Arc::new(branch);
        Ok(())
    }

    /// Whether contacts are about to break simultaneously here.
    fn is_at_simultaneous_break(&self) -> bool {
        self.behind == 0.0
            && self.furthest == self.branch.cell_end(self.cell)
            && self.branch.breaks_after(self.cell)
    }

    /// Breaks the contacts that break simultaneously here, and leaves them free.
    fn break_without_reforming(&mut self) {
        let contacts = &self.interface.contacts;
        let [before, after] =
            [false, true].map(|crossed| self.branch.layers(self.furthest, self.cell, crossed, contacts));
        let branch = self.interface.held(after.clone());
        let [before, after] = [before, after].map(|layers| LayerSums::of(&layers, contacts));
        let broken = before.unbroken - after.unbroken;
        self.accumulate_energies();
        self.lost += before.breaking_energy - after.breaking_energy;
        self.broken += broken;
        self.free += broken;
        self.start_branch(Arc::new(branch), self.direction);
    }

    /// Replaces the branch by the unloading branch from the furthest point, where its straight part ends.
    fn start_reverse_branch(&mut self) -> Result<()> {
        if let UnloadingBranch { branch: Some(branch), length, breaks, .. } =
            self.unloading_branch(&mut ())?.clone()
        {
            self.behind = 0.0;
            self.accumulate_energies();
            self.start_branch(branch, self.direction.reversed());
            self.furthest = length;
            self.cell = self.branch.cell(length);
            if breaks && self.cell > 0 {
                self.cell -= 1;
                self.furthest = self.branch.cell_end(self.cell);
            }
        }
        Ok(())
    }

    /// Starts another branch at the present position.
    fn start_branch(&mut self, branch: Arc<LoadingBranch>, direction: Direction) {
        // A new branch starts from stretches that have the error of the old one: errors of branches
        // add up until contacts all re-form.
        self.inherited += self.branch.error();
        self.worst = self.worst.max(self.inherited);
        (self.origin, self.direction) = (self.position(), direction);
        (self.branch, self.furthest, self.cell, self.behind) = (branch, 0.0, 0, 0.0);
        self.back = None;
    }

    /// Adds the energies of the branch to the totals.
    fn accumulate_energies(&mut self) {
        let energies = self.branch_energies();
        self.lost += energies.lost;
        self.broken += energies.broken;
        self.free += if self.branch.is_held() { energies.broken } else { 0.0 };
    }

    /// Energies of the present branch, the straight unloading included.
    fn branch_energies(&self) -> BranchEnergies {
        let energies = self.branch.energies(self.furthest, self.cell);
        let Some(UnloadingBranch { stiffness, .. }) = self.back.as_ref().filter(|_| self.behind > 0.0) else {
            return energies;
        };
        let (force, _) = self.branch.response(self.furthest, self.cell);
        // On the straight line the elastic energy changes by the work done, ∫F dX, since nothing
        // breaks.
        let elastic = energies.elastic - (force - 0.5 * stiffness * self.behind) * self.behind;
        BranchEnergies { elastic, ..energies }
    }

    /// The present contacts, seen along the branch.
    fn layers(&self) -> Vec<Layer> {
        let layers = self.branch.layers(self.furthest, self.cell, false, &self.interface.contacts);
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

    fn smooth_interval(&mut self, direction: Direction, monitor: &mut dyn Monitor) -> Result<SmoothInterval> {
        self.looked = direction;
        if self.is_at_simultaneous_break() && (self.holding || self.is_onward(direction)) {
            self.cross(monitor)?;
        }
        if self.is_onward(direction) {
            if self.behind > 0.0 {
                let breaks = self.furthest == self.branch.cell_end(self.cell);
                return Ok(SmoothInterval { length: self.behind, straight: true, breaks });
            }
            if self.branch.cell_end(self.cell) >= self.branch.end() {
                // Before its last cell is passed: this may take long, and here a monitor can stop it.
                self.extend_branch(true, monitor)?;
            }
            let length = self.branch.cell_end(self.cell) - self.furthest;
            return Ok(SmoothInterval {
                length,
                straight: length.is_infinite(),
                breaks: self.branch.breaks_after(self.cell),
            });
        }
        if self.interface.is_time_dependent() {
            // It starts as a straight line; moving along it is refused later.
            return Ok(SmoothInterval { length: f64::INFINITY, straight: true, breaks: false });
        }
        let behind = self.behind;
        let back = self.unloading_branch(monitor)?;
        Ok(match &back.branch {
            Some(branch) if behind >= back.length => {
                let cell = branch.cell(behind);
                let length = branch.cell_end(cell) - behind;
                SmoothInterval { length, straight: length.is_infinite(), breaks: branch.breaks_after(cell) }
            }
            _ => SmoothInterval { length: back.length - behind, straight: true, breaks: back.breaks },
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
        let interval = self.smooth_interval(direction, &mut ())?;
        let (by, rounding) = (by.abs().min(interval.length), self.interface.rounding());
        self.moved = direction;
        if self.is_onward(direction) {
            if self.behind == 0.0 {
                return self.advance_on_branch(by);
            }
            self.behind = if by < self.behind - rounding { self.behind - by } else { 0.0 };
            return Ok(());
        }
        let behind = self.behind + by;
        let length = self.unloading_branch(&mut ())?.length;
        if behind < length - rounding {
            self.behind = behind;
            return Ok(());
        }
        self.behind = length;
        self.start_reverse_branch()?;
        if length > 0.0 { Ok(()) } else { self.advance_on_branch(by) }
    }

    fn cross(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        if !self.is_at_simultaneous_break() {
            return Ok(());
        }
        if std::mem::take(&mut self.holding) {
            self.break_without_reforming();
            return Ok(());
        }
        self.enter_next_cell(true)
    }

    fn reset(&mut self, direction: Direction, monitor: &mut dyn Monitor) -> Result<()> {
        let fresh = self.interface.fresh(monitor)?;
        let released = self.branch_energies().elastic - self.interface.fresh_energy();
        self.accumulate_energies();
        self.lost += released;
        self.broken += 1.0 - std::mem::take(&mut self.free);
        self.start_branch(fresh, direction);
        // Fresh contacts inherit no error.
        self.inherited = 0.0;
        (self.moved, self.looked, self.holding) = (direction, direction, false);
        Ok(())
    }

    fn hold(&mut self) -> Result<()> {
        self.interface.require_one_way("slip", "contacts held free as they break")?;
        self.holding = !self.branch.is_held() && self.is_at_simultaneous_break();
        if !self.branch.is_held() && !self.holding {
            let branch = self.interface.held(self.layers());
            self.accumulate_energies();
            self.start_branch(Arc::new(branch), self.direction);
        }
        Ok(())
    }

    fn release(&mut self, monitor: &mut dyn Monitor) -> Result<()> {
        self.holding = false;
        if !self.branch.is_held() {
            return Ok(());
        }
        self.cross(monitor)?;
        let mut layers = self.layers();
        let free = self.free + self.branch_energies().broken;
        let fresh = self.interface.reformed.layers().iter().map(|layer| {
            let layer = layer.clone().scaled(free);
            if self.moved == self.direction { layer } else { layer.mirrored() }
        });
        layers.extend(fresh);
        let branch = self.interface.renewed(layers, monitor)?;
        self.accumulate_energies();
        self.lost -= std::mem::take(&mut self.free) * self.interface.fresh_energy();
        self.start_branch(Arc::new(branch), self.direction);
        Ok(())
    }

    /// The error of this branch and of all since contacts last re-formed together, whose final stretches it
    /// started with.
    fn error(&self) -> f64 {
        let error = self.worst.max(self.inherited + self.branch.error());
        self.interface.stiffness * unit_force(&self.interface.reformed) * error
    }

    fn mark(&mut self) {
        // The copy is to hold no mark of its own.
        self.marked = None;
        self.marked = Some(Box::new(self.clone()));
    }

    fn recall(&mut self, _monitor: &mut dyn Monitor) -> Result<()> {
        if let Some(marked) = self.marked.take() {
            *self = *marked;
        }
        Ok(())
    }

    fn energies(&self) -> ContactEnergies {
        let BranchEnergies { elastic, lost, broken } = self.branch_energies();
        let stiffness = self.interface.stiffness;
        ContactEnergies {
            sliding: 0.0,
            elastic: stiffness * elastic,
            lost: stiffness * (self.lost + lost),
            strengthening: 0.0,
            broken: self.broken + broken,
        }
    }

    fn stretch_density(
        &self,
        stretches: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(Vec<f64>, Vec<Atom>)>> {
        if self.interface.is_time_dependent() {
            let found = self.branch.stretch_density(self.furthest, stretches, monitor)?;
            return Ok(found.map(|found| (found.density, found.atoms)));
        }
        let (layers, sign) = (self.layers(), self.direction.sign());
        let thresholds = self.interface.contacts.thresholds.as_ref();
        let watch = Watch::new(monitor);
        let unbroken = |x: f64| layers.iter().map(|layer| layer.unbroken_density(sign * x, thresholds)).sum();
        let density = stretches.iter().map(|&x| watch.value(|| unbroken(x))).collect();
        watch.check()?;
        let shared = threshold_atoms(thresholds);
        let atoms = layers.iter().flat_map(|layer| layer.unbroken_atoms(thresholds, &shared));
        let mut atoms: Vec<_> = atoms
            .map(|atom| Atom { position: sign * atom.position, ..atom })
            .filter(|a| a.weight > 0.0)
            .collect();
        Atom::sort(&mut atoms);
        Ok(Some((density, atoms)))
    }

    fn copy(&self) -> Box<dyn Population> {
        Box::new(self.clone())
    }

    fn state(&self) -> ContactsState {
        self.kept()
    }

    fn restore(&mut self, state: &ContactsState, monitor: &mut dyn Monitor) -> Result<()> {
        self.take_up(state, monitor)
    }
}
