//! A slider that is driven step by step, from event to event, and looked at in between.

use serde::{Deserialize, Serialize};

use super::quasistatic::{Memory, Next, QuasistaticRun};
use super::{Block, EnergyBalance, Event, Loading, Point, Slip, bearable, events};
use crate::law::Atom;
use crate::monitor::{Monitor, report};
use crate::population::{Direction, Population};
use crate::rate_dependent::ContactsState;
use crate::record::Record;
use crate::{Error, Result};

/// Breaks per contact, and events, after which a copy of the contacts is made to come back to: so rarely that copies take
/// less time than the breaks, so often that what has happened since is done again in less than a tenth of a second.
const COPY_AFTER: (f64, u64) = (0.1, 10_000);

/// A slider on its contacts, driven from event to event.
///
/// The run is that of [`Block::pull`], event by event. Stops on the way leave no trace in it: contacts stay at the last event
/// or kink of the force, and what is asked for at a stop is found ahead of there. Only where the drive turns the stop is a
/// part of the way. Contacts are kept twice, to come back to where they were when a step is stopped half-way.
///
/// ```
/// use std::sync::Arc;
/// use asperity::block::{Block, Loading, Slip};
/// use asperity::contacts::{Contacts, Initial};
/// use asperity::law::{Gaussian, Point};
/// use asperity::master::MasterEquation;
///
/// let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// let population = MasterEquation::new(contacts, &Initial::default())?.population()?;
/// let block = Block::new(Loading::Spring(1.0), Slip::Reset, None)?;
/// let mut slider = block.simulation(Box::new(population))?;
/// while let Some(slip) = slider.next_event(5.0)? {
///     println!("at X_T = {:.3} the force drops by {:.3}", slip.before.drive, slip.drop());
/// }
/// assert_eq!(slider.drive(), 5.0);
/// # Ok::<(), asperity::Error>(())
/// ```
#[derive(Debug)]
pub struct BlockSimulation {
    block: Block,
    now: SliderOnContacts,
    /// A copy to come back to, and events since.
    copied: SliderOnContacts,
    since: u64,
    /// Where the present run began, and its end.
    path: (f64, f64),
}

/// A slider and its contacts.
#[derive(Debug)]
struct SliderOnContacts {
    population: Box<dyn Population>,
    memory: Memory,
    /// How far ahead of the contacts the slider is, and its state there.
    ahead: f64,
    here: Point,
}

/// What a slider and its contacts have come to. A simulation of the same description goes on from it as if it had never
/// stopped, bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimulationState {
    memory: Memory,
    ahead: f64,
    here: Point,
    contacts: ContactsState,
}

impl Block {
    /// The slider on these contacts, in balance where they stand, to be driven step by step.
    ///
    /// # Errors
    /// Those of the population; of an imposed force, more damping than can be followed.
    pub fn simulation(&self, population: Box<dyn Population>) -> Result<BlockSimulation> {
        self.simulation_with(population, &mut ())
    }

    /// The same watched by a monitor.
    ///
    /// # Errors
    /// As [`Self::simulation`]; stopped by the monitor.
    pub fn simulation_with(
        &self,
        population: Box<dyn Population>,
        monitor: &mut dyn Monitor,
    ) -> Result<BlockSimulation> {
        let mut population = population;
        let mut run = QuasistaticRun::new(self, population.as_mut(), monitor)?;
        let unloading = run.unloading()?;
        if let (Loading::Force, Slip::Inertial { mass, damping }) = (self.loading, self.slip) {
            bearable(unloading, mass, damping).map_err(|e| e.under("slip.inertial"))?;
        }
        run.turn(Direction::Forward)?;
        let here = run.point();
        let memory = run.remembered();
        let now = SliderOnContacts { population, memory, ahead: 0.0, here };
        let path = (here.drive, here.drive);
        Ok(BlockSimulation { block: *self, copied: now.copy(), now, since: 0, path })
    }
}

impl SliderOnContacts {
    fn copy(&self) -> Self {
        let Self { population, memory, ahead, here } = self;
        Self { population: population.copy(), memory: memory.clone(), ahead: *ahead, here: *here }
    }

    /// Takes the contacts to where the slider is, and does something to the run there.
    fn catch_up<T>(
        &mut self,
        block: &Block,
        then: impl FnOnce(&mut QuasistaticRun<'_>) -> Result<T>,
    ) -> Result<T> {
        let (ahead, memory, nobody) = (std::mem::take(&mut self.ahead), self.memory.clone(), &mut ());
        let mut run = QuasistaticRun::resumed(block, self.population.as_mut(), memory, nobody)?;
        run.glide(ahead)?;
        let done = then(&mut run)?;
        self.memory = run.remembered();
        Ok(done)
    }
}

impl BlockSimulation {
    /// X_T; X of a rigid slider; an imposed force.
    pub fn drive(&self) -> f64 {
        self.now.here.drive
    }

    /// Drive, position of the slider's bottom, friction force and that of the spring.
    pub fn point(&self) -> Point {
        self.now.here
    }

    /// Where the work of the drive has gone so far.
    ///
    /// # Errors
    /// Those of the population.
    pub fn energy(&self) -> Result<EnergyBalance> {
        let SliderOnContacts { memory, ahead, .. } = &self.now;
        if *ahead == 0.0 && memory.open == EnergyBalance::default() {
            return Ok(memory.energy);
        }
        self.now.copy().catch_up(&self.block, |run| {
            run.close();
            Ok(run.memory.energy)
        })
    }

    /// Breaks so far, per contact.
    pub fn broken(&self) -> f64 {
        self.now.population.books().broken
    }

    /// Estimated error of the force, the largest so far; 0 of contacts that are followed one by one.
    pub fn error(&self) -> f64 {
        self.now.population.error()
    }

    /// The stretches of the contacts that hold, in no order, where they are followed one by one.
    ///
    /// # Errors
    /// Those of the population.
    pub fn stretches(&self) -> Result<Option<Vec<f64>>> {
        self.look(|population| Ok(population.stretches()))
    }

    /// The density of stretches, see [`Population::stretch_density`].
    ///
    /// # Errors
    /// Those of the population.
    pub fn stretch_density(&self, stretches: &[f64]) -> Result<Option<(Vec<f64>, Vec<Atom>)>> {
        self.stretch_density_with(stretches, &mut ())
    }

    /// The same watched by a monitor.
    ///
    /// # Errors
    /// As [`Self::stretch_density`]; stopped by the monitor.
    pub fn stretch_density_with(
        &self,
        stretches: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(Vec<f64>, Vec<Atom>)>> {
        self.look(|population| population.stretch_density(stretches, monitor))
    }

    /// What is seen of the contacts where the slider is.
    fn look<T>(&self, see: impl FnOnce(&dyn Population) -> Result<T>) -> Result<T> {
        if self.now.ahead == 0.0 {
            return see(self.now.population.as_ref());
        }
        let mut there = self.now.copy();
        there.catch_up(&self.block, |_| Ok(()))?;
        see(there.population.as_ref())
    }

    /// Moves the drive, forward or back, to `until` or through the next event on the way; none if it got there.
    ///
    /// An event is a slip; of a rigid slider, contacts that break together. With a `slip_fraction` those are left out in which
    /// fewer contacts break.
    ///
    /// # Errors
    /// A drive that is no finite number; those of the population; an imposed force that the contacts cannot carry. All
    /// is as before the call then.
    pub fn next_event(&mut self, until: f64) -> Result<Option<Event>> {
        self.next_event_with(until, &mut ())
    }

    /// The same watched by a monitor.
    ///
    /// # Errors
    /// As [`Self::next_event`]; stopped by the monitor.
    pub fn next_event_with(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Option<Event>> {
        if !until.is_finite() {
            return Err(Error::invalid("drive", "a finite number", until));
        }
        let here = self.now.here.drive;
        if until == here {
            report(monitor, 1.0)?;
            return Ok(None);
        }
        if self.path.1 != until {
            self.path = (here, until);
        }
        let direction = if until > here { Direction::Forward } else { Direction::Backward };
        let turns = direction != self.now.memory.direction;
        let turned = if turns { self.now.catch_up(&self.block, |run| run.turn(direction)) } else { Ok(()) };
        let mut happened = turned.and_then(|()| self.step(until, monitor));
        if turns && happened.is_ok() {
            // Some contacts tell that they cannot go back only as they are moved.
            happened = self.now.copy().catch_up(&self.block, |_| Ok(())).and(happened);
        }
        if happened.is_err() {
            self.go_back(here)?;
            return happened;
        }
        self.since += u64::from(matches!(happened, Ok(Some(_))));
        let broken = self.broken() - self.copied.population.books().broken;
        if turns || broken >= COPY_AFTER.0 || self.since >= COPY_AFTER.1 {
            (self.copied, self.since) = (self.now.copy(), 0);
        }
        happened
    }

    /// Events as columns, those of `events.csv`.
    pub fn record(&self, events: &[Event]) -> Record {
        events::record(events, self.block.loading.drive_quantity())
    }

    /// Moves the drive to `until`, and tells `each` event on the way.
    ///
    /// # Errors
    /// See [`BlockSimulation::next_event`]; all is as after the last event then.
    pub fn run(&mut self, until: f64, each: &mut dyn FnMut(&Event)) -> Result<()> {
        self.run_with(until, &mut (), each)
    }

    /// The same watched by a monitor.
    ///
    /// # Errors
    /// As [`Self::run`]; stopped by the monitor.
    pub fn run_with(
        &mut self,
        until: f64,
        monitor: &mut dyn Monitor,
        each: &mut dyn FnMut(&Event),
    ) -> Result<()> {
        while let Some(event) = self.next_event_with(until, monitor)? {
            each(&event);
        }
        Ok(())
    }

    /// What slider and contacts have come to.
    pub fn state(&self) -> SimulationState {
        let SliderOnContacts { memory, ahead, here, population } = &self.now;
        SimulationState { memory: memory.clone(), ahead: *ahead, here: *here, contacts: population.state() }
    }

    /// Goes to what a simulation of the same description has come to.
    ///
    /// # Errors
    /// A state of other contacts; those of the population.
    pub fn restore(&mut self, state: SimulationState, monitor: &mut dyn Monitor) -> Result<()> {
        let SimulationState { memory, ahead, here, contacts } = state;
        let mut population = self.now.population.copy();
        population.restore(&contacts, monitor)?;
        self.now = SliderOnContacts { population, memory, ahead, here };
        (self.copied, self.since) = (self.now.copy(), 0);
        self.path = (here.drive, here.drive);
        Ok(())
    }

    /// Goes on in the direction of the drive, to `until` or through the next event.
    fn step(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Option<Event>> {
        let ((from, to), SliderOnContacts { population, memory, ahead, here }) = (self.path, &mut self.now);
        let length = (to - from).abs().max(f64::MIN_POSITIVE);
        report(monitor, ((here.drive - from).abs() / length).min(1.0))?;
        let before = (from - memory.leg_start.drive).abs();
        let mut run = QuasistaticRun::resumed(&self.block, population.as_mut(), memory.clone(), monitor)?;
        run.path = (length, -before);
        let asked = [until];
        let mut asked = asked.as_slice();
        loop {
            let event = match run.next(&mut asked)? {
                Next::Happened(event) => event,
                Next::Reached(way) => {
                    *here = run.trace.pop().expect("a point is kept at each drive that is asked for");
                    (*memory, *ahead) = (run.remembered(), way);
                    return Ok(None);
                }
                Next::Runaway(_) => {
                    let expected = "a force that the contacts can carry";
                    return Err(Error::invalid("drive", expected, until));
                }
            };
            if let Some(event) = event {
                (*memory, *ahead, *here) = (run.remembered(), 0.0, event.after);
                return Ok(Some(event));
            }
        }
    }

    /// Comes back to where the slider was at a drive before a step: from the copy it goes through the same events again.
    fn go_back(&mut self, drive: f64) -> Result<()> {
        self.now = self.copied.copy();
        let end = self.now.memory.direction.sign() * f64::MAX;
        for _ in 0..self.since {
            self.step(end, &mut ())?;
        }
        if self.drive() != drive {
            self.step(drive, &mut ())?;
        }
        Ok(())
    }
}
