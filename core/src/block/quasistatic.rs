//! Creep in balance from instability to instability, with what is kept of it.

use super::equilibrium_path::EquilibriumPath;
use super::events::{Event, Sizes};
use super::run::length;
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
pub(super) enum Stop {
    /// The drive is where it should be.
    Reached,
    /// Balance is lost here.
    Unstable,
    /// Contacts are about to break together.
    Breakpoint,
    /// There is no balance near.
    Runaway,
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
    turning_points: Vec<f64>,
    /// Length of the way of the drive: all of it, of the legs done.
    path: (f64, f64),
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
        let leg_start = Point { drive, position, force, spring_force: force };
        Ok(Self {
            block: *block,
            stored: block.loading.stored(drive, position),
            look,
            trace: Vec::new(),
            events: Vec::new(),
            sizes: Sizes::default(),
            course: None,
            offered: SlipCourse::default(),
            energy: EnergyBalance::default(),
            approach: EnergyBalance::default(),
            open: EnergyBalance::default(),
            books,
            leg_start,
            stiffness: None,
            rest: position,
            turning_points: Vec::new(),
            path: (0.0, 0.0),
            ways: 0,
        })
    }

    /// Says where the drive is going, for reports.
    pub fn watch(&mut self, turning_points: &[f64]) {
        self.turning_points = turning_points.to_vec();
        self.path.0 = length(self.drive(), turning_points);
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
            let done = self.path.1 + (self.drive() - self.leg_start.drive).abs();
            self.look.tell(done / self.path.0)?;
        }
        self.look.towards(direction)
    }

    /// Brings the drive through the values asked for; where the slider runs away on the way, from where.
    pub fn leg(&mut self, direction: Direction, asked: &[f64]) -> Result<Option<Point>> {
        self.leg_start = self.point();
        if self.block.loading == Loading::Force {
            self.stiffness = Some(self.unloading()?);
        }
        let mut asked = asked;
        self.rest = self.look.position;
        loop {
            let stop = self.creep(direction, &mut asked)?;
            let here = self.point();
            if stop == Stop::Reached {
                self.path.1 += (here.drive - self.leg_start.drive).abs();
                return Ok(None);
            }
            if stop == Stop::Runaway || !self.event(stop == Stop::Breakpoint)? {
                return Ok(Some(here));
            }
            self.rest = self.look.position;
        }
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
                (true, ..) => Some(Stop::Reached),
                (_, true, _) => Some(Stop::Unstable),
                (_, _, true) => Some(Stop::Breakpoint),
                _ => self.is_gone(self.drive()).then_some(Stop::Runaway),
            };
            self.glide(if asked.is_empty() { reached } else { end })?;
            if let Some(stop) = stop {
                return Ok(stop);
            }
        }
    }

    /// Whether the slider is too far from where it was at rest for a drive, or for the one that the leg began at.
    pub fn is_gone(&self, drive: f64) -> bool {
        let largest = drive.abs().max(self.leg_start.drive.abs());
        let gone = (self.look.position - self.rest).abs();
        self.stiffness.is_some_and(|stiffness| gone > RUNAWAY * largest / stiffness)
    }

    /// How large a drive is that belongs to a length: an imposed force is that of contacts so far stretched.
    pub fn drive_of(&self, length: f64) -> f64 {
        self.stiffness.unwrap_or(1.0) * length
    }

    /// Keeps the state of balance at an advance `a` for the trace.
    fn keep(&mut self, drive: f64, a: f64) {
        let position = self.look.position + self.look.sign() * a;
        let force = self.look.response(a).force;
        let spring_force = self.look.loading.pull(drive, position, force);
        self.trace.push(Point { drive, position, force, spring_force });
    }

    /// Moves on by `a` in balance.
    fn glide(&mut self, a: f64) -> Result<()> {
        let (loading, sign) = (self.look.loading, self.look.sign());
        self.open.work += sign * self.look.integral(a, |_, response| loading.work(response));
        self.look.advance(a)
    }

    /// The energy balance since it was last closed; it is closed here, at a given drive.
    pub fn closed(&mut self, drive: f64) -> EnergyBalance {
        let (books, stored) = (self.look.books(), self.look.loading.stored(drive, self.look.position));
        let mut energy = std::mem::take(&mut self.open);
        energy.spring = stored - self.stored;
        energy.elastic = books.elastic - self.books.elastic;
        energy.breaks = books.lost - self.books.lost;
        (self.books, self.stored) = (books, stored);
        self.energy += energy;
        energy
    }

    /// Breaks since the energy balance was last closed, per contact.
    pub fn broken(&self) -> f64 {
        self.look.books().broken - self.books.broken
    }

    /// Elastic energy of the contacts when the energy balance was last closed.
    pub fn stored_in_contacts(&self) -> f64 {
        self.books.elastic
    }

    /// Closes the energy balance at the end of the drive.
    pub fn close(&mut self) {
        let drive = self.drive();
        let energy = self.closed(drive);
        self.approach += energy;
    }
}
