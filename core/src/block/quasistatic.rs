//! Quasistatic motion: creep along equilibria from one instability to the next, with its records.

use serde::{Deserialize, Serialize};

use super::equilibrium_path::EquilibriumPath;
use super::events::{Event, MotionEnd, Sizes};
use super::trace::{Point, SlipCourse};
use super::{Block, EnergyBalance, Loading, Slip, check_damping_ratio};
use crate::Result;
use crate::energy::ContactEnergies;
use crate::monitor::Monitor;
use crate::population::{Direction, Population};

/// Intervals between two reports to the monitor.
const REPORT: u32 = 1024;

/// Displacement at which a slider under an imposed force has run away, in mean stretches of contacts that carry the force.
const RUNAWAY: f64 = 100.0;

/// The end of a creep.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stop {
    /// The requested drive is reached after this advance on the interval ahead.
    Reached(f64),
    /// The equilibrium becomes unstable here.
    Unstable,
    /// Contacts break simultaneously here.
    Breakpoint,
    /// There is no equilibrium nearby.
    Runaway,
}

/// The next event of a driven slider.
#[expect(clippy::large_enum_variant, reason = "one exists at a time")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Next {
    /// The requested drive is reached after this advance on the interval ahead. The slider has not moved there yet.
    Reached(f64),
    /// Contacts have broken at a fixed drive; `None` if too few for an event.
    Happened(Option<Event>),
    /// There is no equilibrium ahead of this state.
    Runaway(Point),
}

/// The state of a run between two events, except for the contacts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Memory {
    /// Position of the slider, and its displacement while no contact was attached.
    position: f64,
    carried: f64,
    /// Direction of the drive.
    pub direction: Direction,
    /// Energy balance up to the last closing.
    pub energy: EnergyBalance,
    /// The part of it since the last slip.
    pub approach: EnergyBalance,
    /// Work and dissipation since the last closing.
    pub open: EnergyBalance,
    /// Energies of the contacts and of the spring at the last closing.
    energies: ContactEnergies,
    stored: f64,
    /// State at the last turn of the drive.
    pub segment_start: Point,
    /// N⟨k⟩, for an imposed force only.
    stiffness: Option<f64>,
    /// Position after the last event or turn.
    pub rest: f64,
    /// The drive at which the background force holds the slider at rest; `None` where it slides in equilibrium.
    held_at: Option<f64>,
}

/// A slider in quasistatic motion.
pub(super) struct QuasistaticRun<'a> {
    pub block: Block,
    pub path: EquilibriumPath<'a>,
    pub trace: Vec<Point>,
    pub events: Vec<Event>,
    pub sizes: Sizes,
    pub course: Option<SlipCourse>,
    /// The time course of the last swing, until one of a slip is recorded.
    pub offered: SlipCourse,
    pub memory: Memory,
    /// Path length of the drive: in total, and up to the last turn.
    pub path_length: (f64, f64),
    intervals: u32,
}

impl<'a> QuasistaticRun<'a> {
    pub fn new(
        block: &Block,
        population: &'a mut dyn Population,
        monitor: &'a mut dyn Monitor,
    ) -> Result<Self> {
        let energies = population.energies();
        let path =
            EquilibriumPath::new(population, (block.loading, block.background), Direction::Forward, monitor)?;
        let drive = path.drive_here();
        let (position, force) = (path.position, path.friction(0.0));
        let memory = Memory {
            position,
            carried: 0.0,
            direction: Direction::Forward,
            energy: EnergyBalance::default(),
            approach: EnergyBalance::default(),
            open: EnergyBalance::default(),
            energies,
            stored: path.stored(drive, position),
            segment_start: Point { drive, position, force, spring_force: force },
            stiffness: None,
            rest: position,
            held_at: None,
        };
        Ok(Self::with(block, path, memory))
    }

    /// Resumes a run from its memory and its population.
    pub fn resumed(
        block: &Block,
        population: &'a mut dyn Population,
        memory: Memory,
        monitor: &'a mut dyn Monitor,
    ) -> Result<Self> {
        let mut path =
            EquilibriumPath::new(population, (block.loading, block.background), memory.direction, monitor)?;
        (path.position, path.carried) = (memory.position, memory.carried);
        Ok(Self::with(block, path, memory))
    }

    fn with(block: &Block, path: EquilibriumPath<'a>, memory: Memory) -> Self {
        Self {
            block: *block,
            path,
            trace: Vec::new(),
            events: Vec::new(),
            sizes: Sizes::default(),
            course: None,
            offered: SlipCourse::default(),
            memory,
            path_length: (0.0, 0.0),
            intervals: 0,
        }
    }

    /// The memory from which the run can be resumed between two events.
    pub fn into_memory(self) -> Memory {
        Memory { position: self.path.position, carried: self.path.carried, ..self.memory }
    }

    /// The drive: that of the equilibrium at the present position, unless the background force holds the slider.
    pub fn drive(&self) -> f64 {
        self.memory.held_at.unwrap_or_else(|| self.path.drive_here())
    }

    /// The drive moves to a value at which the background force holds the slider. Without such a force nothing happens.
    pub fn hold_at(&mut self, drive: f64) {
        if self.block.background == 0.0 {
            return;
        }
        let before = self.memory.held_at.replace(drive);
        self.load_spring(before.unwrap_or(drive), drive);
    }

    /// Adds the work of the drive on the spring of a slider at rest.
    fn load_spring(&mut self, from: f64, to: f64) {
        let (path, position) = (&self.path, self.path.position);
        self.memory.open.work += path.stored(to, position) - path.stored(from, position);
    }

    /// The present state, an equilibrium.
    pub fn point(&self) -> Point {
        let drive = self.drive();
        let force = self.path.friction_at_rest(drive);
        Point { drive, position: self.path.position, force, spring_force: force }
    }

    /// N⟨k⟩ at the start.
    ///
    /// # Errors
    /// Under an imposed force a damping with which the motion of a mass on these contacts cannot be integrated.
    pub fn first_unloading(&mut self) -> Result<f64> {
        let stiffness = self.unloading()?;
        if let (Loading::Force, Slip::Inertial { mass, damping }) = (self.block.loading, self.block.slip) {
            check_damping_ratio(stiffness, mass, damping).map_err(|e| e.under("slip.inertial"))?;
        }
        Ok(stiffness)
    }

    /// N⟨k⟩, the slope of F on unloading.
    pub fn unloading(&mut self) -> Result<f64> {
        let forward = self.path.direction;
        self.path.find_interval(forward.reversed())?;
        // On unloading no contact breaks, so that the slope is that of all attached contacts.
        let stiffness = self.path.here.tangent;
        self.path.find_interval(forward)?;
        Ok(stiffness)
    }

    /// Computes the interval ahead, and reports to the monitor from time to time.
    pub fn find_interval(&mut self, direction: Direction) -> Result<()> {
        self.intervals += 1;
        if self.intervals >= REPORT {
            self.intervals = 0;
            let done = self.path_length.1 + (self.drive() - self.memory.segment_start.drive).abs();
            self.path.report_progress(done / self.path_length.0)?;
        }
        self.path.find_interval(direction)
    }

    /// Moves the drive through the requested values. Returns the state from which the slider ran away, if it did.
    pub fn follow_segment(&mut self, direction: Direction, requested: &[f64]) -> Result<Option<Point>> {
        self.turn(direction)?;
        let mut requested = requested;
        loop {
            match self.next(&mut requested)? {
                Next::Happened(_) => {}
                Next::Runaway(from) => return Ok(Some(from)),
                Next::Reached(ahead) => {
                    self.advance(ahead)?;
                    self.path_length.1 += (self.drive() - self.memory.segment_start.drive).abs();
                    return Ok(None);
                }
            }
        }
    }

    /// Turns the drive to a direction.
    pub fn turn(&mut self, direction: Direction) -> Result<()> {
        self.memory.direction = direction;
        self.memory.segment_start = self.point();
        self.hold_at(self.memory.segment_start.drive);
        if self.block.loading == Loading::Force {
            self.memory.stiffness = Some(self.unloading()?);
        }
        self.memory.rest = self.path.position;
        Ok(())
    }

    /// Moves the drive through the requested values, or to the next breaks at a fixed drive and through these. Values that
    /// have been passed are removed from `requested`.
    pub fn next(&mut self, requested: &mut &[f64]) -> Result<Next> {
        let breaks = match self.creep(self.memory.direction, requested)? {
            Stop::Reached(ahead) => return Ok(Next::Reached(ahead)),
            Stop::Runaway => return Ok(Next::Runaway(self.point())),
            Stop::Unstable => false,
            Stop::Breakpoint => true,
        };
        let here = self.point();
        match self.event(breaks)? {
            MotionEnd::Balanced(happened) => {
                self.memory.rest = self.path.position;
                Ok(Next::Happened(happened))
            }
            MotionEnd::Away => Ok(Next::Runaway(here)),
        }
    }

    /// Creeps along equilibria. Values that have been passed are removed from `requested`.
    fn creep(&mut self, direction: Direction, requested: &mut &[f64]) -> Result<Stop> {
        let sign = direction.sign();
        loop {
            self.find_interval(direction)?;
            if self.is_held_up_to(requested) {
                return Ok(Stop::Reached(0.0));
            }
            if !self.path.rises() {
                return Ok(Stop::Unstable);
            }
            let turn = self.path.turn(0.0, true);
            let end = turn.unwrap_or(self.path.interval.length);
            let top = if end.is_finite() { self.path.drive(end) } else { f64::INFINITY };
            let mut reached = 0.0;
            // The equilibrium drive rises up to `top`, so that each value below it is reached once.
            while let Some((&next, rest)) = requested.split_first()
                && sign * next <= top
            {
                reached = self.path.reaches(sign * next, reached, end);
                self.add_to_trace(next, reached);
                *requested = rest;
            }
            let stop = match (requested.is_empty(), turn.is_some(), self.path.interval.breaks) {
                (true, ..) => return Ok(Stop::Reached(reached)),
                (_, true, _) => Some(Stop::Unstable),
                (_, _, true) => Some(Stop::Breakpoint),
                _ => self.has_run_away(self.drive()).then_some(Stop::Runaway),
            };
            self.advance(end)?;
            if let Some(stop) = stop {
                return Ok(stop);
            }
        }
    }

    /// Moves the drive of a slider that the background force holds, until it is about to slide or all requested values have been
    /// passed. Returns whether they have.
    fn is_held_up_to(&mut self, requested: &mut &[f64]) -> bool {
        if self.memory.held_at.is_none() {
            return false;
        }
        let (sign, sliding) = (self.path.sign(), self.path.drive_here());
        while let Some((&next, rest)) = requested.split_first()
            && sign * next < sign * sliding
        {
            self.add_to_trace(next, 0.0);
            self.hold_at(next);
            *requested = rest;
            if rest.is_empty() {
                return true;
            }
        }
        self.hold_at(sliding);
        self.memory.held_at = None;
        false
    }

    /// Whether the slider has run away: its displacement since the last event is too large for the imposed force.
    pub fn has_run_away(&self, drive: f64) -> bool {
        // Sliding contacts carry the force without the background force, which acts against the motion.
        let carried = |force: f64| (force - self.path.sign() * self.block.background).abs();
        let largest = carried(drive).max(carried(self.memory.segment_start.drive));
        // A force above what contacts can carry has no equilibrium at any distance. Contacts at
        // rest would be displaced by force/N⟨k⟩: a hundred times as far without a new equilibrium
        // counts as none.
        let gone = (self.path.position - self.memory.rest).abs();
        self.memory.stiffness.is_some_and(|stiffness| gone > RUNAWAY * largest / stiffness)
    }

    /// The drive that corresponds to a length. For an imposed force it is the force of contacts with that stretch.
    pub fn drive_of(&self, length: f64) -> f64 {
        self.memory.stiffness.unwrap_or(1.0) * length
    }

    /// Adds the equilibrium after an advance `a` to the trace.
    fn add_to_trace(&mut self, drive: f64, a: f64) {
        let position = self.path.position + self.path.sign() * a;
        // The background force holds a slider whose drive is short of the equilibrium ahead.
        let force = if a == 0.0 { self.path.friction_at_rest(drive) } else { self.path.friction(a) };
        let spring_force = self.path.spring_force(drive, a);
        self.trace.push(Point { drive, position, force, spring_force });
    }

    /// Advances by `a` along equilibria.
    pub fn advance(&mut self, a: f64) -> Result<()> {
        let (loading, sign) = (self.path.loading, self.path.sign());
        // Between two breaks the force is a polynomial of degree 15, which the Gauss rule
        // integrates exactly: the energy balance closes to rounding.
        self.memory.open.work += sign * self.path.integral(a, |_, response| loading.work(response));
        let drives = sign * self.path.drive(a) - self.path.drive_here();
        self.memory.open.work += self.path.shift() * drives;
        self.move_by(a)
    }

    /// Moves by `a` on the interval ahead, against the background force.
    pub fn move_by(&mut self, a: f64) -> Result<()> {
        self.memory.open.background += self.block.background * a;
        self.path.advance(a)
    }

    /// Closes the energy balance at a fixed drive. Returns the energies since the last closing.
    pub fn close_energy_balance(&mut self, drive: f64) -> EnergyBalance {
        let (energies, stored) = (self.path.energies(), self.path.stored(drive, self.path.position));
        // Work and dissipation are integrated along the motion; stored energies and breaks are differences of
        // totals. No term is computed as the remainder of the others.
        let mut energy = std::mem::take(&mut self.memory.open);
        energy.spring = stored - self.memory.stored;
        energy.elastic = energies.elastic - self.memory.energies.elastic;
        energy.breaks = energies.lost - self.memory.energies.lost;
        (self.memory.energies, self.memory.stored) = (energies, stored);
        self.memory.energy += energy;
        energy
    }

    /// Breaks since the last closing of the energy balance, per contact.
    pub fn broken(&self) -> f64 {
        self.path.energies().broken - self.memory.energies.broken
    }

    /// Elastic energy of the contacts at the last closing of the energy balance.
    pub fn stored_in_contacts(&self) -> f64 {
        self.memory.energies.elastic
    }

    /// Closes the energy balance at the end of the drive.
    pub fn close(&mut self) {
        let drive = self.drive();
        let energy = self.close_energy_balance(drive);
        self.memory.approach += energy;
    }
}
