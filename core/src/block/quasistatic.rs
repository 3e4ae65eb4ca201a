//! Creep in balance from instability to instability, with what is kept of it.

use serde::{Deserialize, Serialize};

use super::equilibrium_path::EquilibriumPath;
use super::events::{Event, Sizes};
use super::trace::{Point, SlipCourse};
use super::{Block, EnergyBalance, Loading};
use crate::Result;
use crate::monitor::Monitor;
use crate::population::{Books, Direction, Population};

/// Ways between two reports to the monitor.
const REPORT: u32 = 1024;

/// A slider that has moved this often the mean stretch of contacts that carry the imposed force has run away.
const RUNAWAY: f64 = 100.0;

/// Why a creep ended.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Stop {
    /// The drive is where it should be, so far ahead on the way.
    Reached(f64),
    /// Balance is lost here.
    Unstable,
    /// Contacts are about to break together.
    Breakpoint,
    /// There is no balance near.
    Runaway,
}

/// What happens next to a slider that is driven.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Next {
    /// The drive is where it should be, so far ahead on the way; the slider has not gone there.
    Reached(f64),
    /// Something has happened at a fixed drive, an event, or too little to be one.
    Happened(Option<Event>),
    /// From here there is no balance.
    Runaway(Point),
}

/// What is to be remembered of a run from one event to the next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Memory {
    /// Where the slider is, and how far it was moved while no contact held.
    position: f64,
    carried: f64,
    /// Which way the drive goes.
    pub direction: Direction,
    /// All that is closed.
    pub energy: EnergyBalance,
    /// What is closed since the last slip.
    pub approach: EnergyBalance,
    /// Work and losses of the slider since the energy balance was last closed.
    pub open: EnergyBalance,
    /// The energies then, and the energy of the spring.
    books: Books,
    stored: f64,
    /// Where the drive last turned.
    pub leg_start: Point,
    /// N⟨k⟩ where a force is imposed.
    stiffness: Option<f64>,
    /// Where it was.
    pub rest: f64,
}

/// A slider on its way.
pub(super) struct QuasistaticRun<'a> {
    pub block: Block,
    pub look: EquilibriumPath<'a>,
    pub trace: Vec<Point>,
    pub events: Vec<Event>,
    pub sizes: Sizes,
    pub course: Option<SlipCourse>,
    /// The course of the last swing, as long as there is none of a slip.
    pub offered: SlipCourse,
    pub memory: Memory,
    /// Length of the way of the drive: all of it, of the legs done.
    pub path: (f64, f64),
    ways: u32,
}

impl<'a> QuasistaticRun<'a> {
    pub fn new(
        block: &Block,
        population: &'a mut dyn Population,
        monitor: &'a mut dyn Monitor,
    ) -> Result<Self> {
        let books = population.books();
        let look = EquilibriumPath::new(population, block.loading, Direction::Forward, monitor)?;
        let drive = look.drive_here();
        let (position, force) = (look.position, look.here.force);
        let memory = Memory {
            position,
            carried: 0.0,
            direction: Direction::Forward,
            energy: EnergyBalance::default(),
            approach: EnergyBalance::default(),
            open: EnergyBalance::default(),
            books,
            stored: block.loading.stored(drive, position),
            leg_start: Point { drive, position, force, spring_force: force },
            stiffness: None,
            rest: position,
        };
        Ok(Self::with(block, look, memory))
    }

    /// The run that is remembered, taken up where its population stands.
    pub fn resumed(
        block: &Block,
        population: &'a mut dyn Population,
        memory: Memory,
        monitor: &'a mut dyn Monitor,
    ) -> Result<Self> {
        let mut look = EquilibriumPath::new(population, block.loading, memory.direction, monitor)?;
        (look.position, look.carried) = (memory.position, memory.carried);
        Ok(Self::with(block, look, memory))
    }

    fn with(block: &Block, look: EquilibriumPath<'a>, memory: Memory) -> Self {
        Self {
            block: *block,
            look,
            trace: Vec::new(),
            events: Vec::new(),
            sizes: Sizes::default(),
            course: None,
            offered: SlipCourse::default(),
            memory,
            path: (0.0, 0.0),
            ways: 0,
        }
    }

    /// What is to be remembered to take up the run between two events.
    pub fn remembered(self) -> Memory {
        Memory { position: self.look.position, carried: self.look.carried, ..self.memory }
    }

    /// The drive in balance here.
    pub fn drive(&self) -> f64 {
        self.look.drive_here()
    }

    /// The state here, in balance.
    pub fn point(&self) -> Point {
        let force = self.look.here.force;
        Point { drive: self.drive(), position: self.look.position, force, spring_force: force }
    }

    /// N⟨k⟩, the slope of F when the slider moves back.
    pub fn unloading(&mut self) -> Result<f64> {
        let forward = self.look.direction;
        self.look.towards(forward.reversed())?;
        let stiffness = self.look.here.tangent;
        self.look.towards(forward)?;
        Ok(stiffness)
    }

    /// Looks ahead; now and then tells the monitor.
    pub fn towards(&mut self, direction: Direction) -> Result<()> {
        self.ways += 1;
        if self.ways >= REPORT {
            self.ways = 0;
            let done = self.path.1 + (self.drive() - self.memory.leg_start.drive).abs();
            self.look.tell(done / self.path.0)?;
        }
        self.look.towards(direction)
    }

    /// Brings the drive through the values asked for; where the slider runs away on the way, from where.
    pub fn leg(&mut self, direction: Direction, asked: &[f64]) -> Result<Option<Point>> {
        self.turn(direction)?;
        let mut asked = asked;
        loop {
            match self.next(&mut asked)? {
                Next::Happened(_) => {}
                Next::Runaway(from) => return Ok(Some(from)),
                Next::Reached(ahead) => {
                    self.glide(ahead)?;
                    self.path.1 += (self.drive() - self.memory.leg_start.drive).abs();
                    return Ok(None);
                }
            }
        }
    }

    /// Begins to drive the slider in a direction.
    pub fn turn(&mut self, direction: Direction) -> Result<()> {
        self.memory.direction = direction;
        self.memory.leg_start = self.point();
        if self.block.loading == Loading::Force {
            self.memory.stiffness = Some(self.unloading()?);
        }
        self.memory.rest = self.look.position;
        Ok(())
    }

    /// Brings the drive on through the values asked for, which lose what is passed, or to where something happens at a fixed
    /// drive, and through that.
    pub fn next(&mut self, asked: &mut &[f64]) -> Result<Next> {
        let breaks = match self.creep(self.memory.direction, asked)? {
            Stop::Reached(ahead) => return Ok(Next::Reached(ahead)),
            Stop::Runaway => return Ok(Next::Runaway(self.point())),
            Stop::Unstable => false,
            Stop::Breakpoint => true,
        };
        let here = self.point();
        let Some(happened) = self.event(breaks)? else { return Ok(Next::Runaway(here)) };
        self.memory.rest = self.look.position;
        Ok(Next::Happened(happened))
    }

    /// Creeps in balance, `asked` losing what is passed.
    fn creep(&mut self, direction: Direction, asked: &mut &[f64]) -> Result<Stop> {
        let sign = direction.sign();
        loop {
            self.towards(direction)?;
            if !self.look.rises() {
                return Ok(Stop::Unstable);
            }
            let turn = self.look.turn(0.0, true);
            let end = turn.unwrap_or(self.look.way.length);
            let top = if end.is_finite() { self.look.drive(end) } else { f64::INFINITY };
            let mut reached = 0.0;
            while let Some((&next, rest)) = asked.split_first()
                && sign * next <= top
            {
                reached = self.look.reaches(sign * next, reached, end);
                self.keep(next, reached);
                *asked = rest;
            }
            let stop = match (asked.is_empty(), turn.is_some(), self.look.way.breaks) {
                (true, ..) => return Ok(Stop::Reached(reached)),
                (_, true, _) => Some(Stop::Unstable),
                (_, _, true) => Some(Stop::Breakpoint),
                _ => self.is_gone(self.drive()).then_some(Stop::Runaway),
            };
            self.glide(end)?;
            if let Some(stop) = stop {
                return Ok(stop);
            }
        }
    }

    /// Whether the slider is too far from where it was at rest for a drive, or for the one that the leg began at.
    pub fn is_gone(&self, drive: f64) -> bool {
        let largest = drive.abs().max(self.memory.leg_start.drive.abs());
        let gone = (self.look.position - self.memory.rest).abs();
        self.memory.stiffness.is_some_and(|stiffness| gone > RUNAWAY * largest / stiffness)
    }

    /// How large a drive is that belongs to a length: an imposed force is that of contacts so far stretched.
    pub fn drive_of(&self, length: f64) -> f64 {
        self.memory.stiffness.unwrap_or(1.0) * length
    }

    /// Keeps the state of balance at an advance `a` for the trace.
    fn keep(&mut self, drive: f64, a: f64) {
        let position = self.look.position + self.look.sign() * a;
        let force = self.look.response(a).force;
        let spring_force = self.look.loading.pull(drive, position, force);
        self.trace.push(Point { drive, position, force, spring_force });
    }

    /// Moves on by `a` in balance.
    pub fn glide(&mut self, a: f64) -> Result<()> {
        let (loading, sign) = (self.look.loading, self.look.sign());
        self.memory.open.work += sign * self.look.integral(a, |_, response| loading.work(response));
        self.look.advance(a)
    }

    /// The energy balance since it was last closed; it is closed here, at a given drive.
    pub fn closed(&mut self, drive: f64) -> EnergyBalance {
        let (books, stored) = (self.look.books(), self.look.loading.stored(drive, self.look.position));
        let mut energy = std::mem::take(&mut self.memory.open);
        energy.spring = stored - self.memory.stored;
        energy.elastic = books.elastic - self.memory.books.elastic;
        energy.breaks = books.lost - self.memory.books.lost;
        (self.memory.books, self.memory.stored) = (books, stored);
        self.memory.energy += energy;
        energy
    }

    /// Breaks since the energy balance was last closed, per contact.
    pub fn broken(&self) -> f64 {
        self.look.books().broken - self.memory.books.broken
    }

    /// Elastic energy of the contacts when the energy balance was last closed.
    pub fn stored_in_contacts(&self) -> f64 {
        self.memory.books.elastic
    }

    /// Closes the energy balance at the end of the drive.
    pub fn close(&mut self) {
        let drive = self.drive();
        let energy = self.closed(drive);
        self.memory.approach += energy;
    }
}
