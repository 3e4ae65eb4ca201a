//! A slider that is driven step by step, from event to event, and can be observed in between.

use serde::{Deserialize, Serialize};

use super::quasistatic::{Memory, Next, QuasistaticRun};
use super::{Block, EnergyBalance, Event, Point, events};
use crate::law::Atom;
use crate::monitor::{Monitor, report};
use crate::population::{Direction, Population};
use crate::rate_dependent::ContactsState;
use crate::record::Record;
use crate::{Error, Result};

/// Breaks per contact, and events, after which a copy of the contacts is made for a return. Copies are rare enough to take
/// less time than the breaks, and frequent enough for the events since the last one to be repeated within 0.1 s.
const COPY_AFTER: (f64, u64) = (0.1, 10_000);

/// A slider on its contacts, driven from event to event.
///
/// The run is that of [`Block::pull`], event by event. Intermediate stops do not change it: contacts stay at the last event
/// or kink of the force, and the state at a stop is computed ahead of that point. Only a turn of the drive moves the contacts
/// to the stop. A second copy of the contacts allows a return if a step is interrupted.
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
    /// A copy for a return, and the number of events since.
    copied: SliderOnContacts,
    since: u64,
    /// Start and end of the present run of the drive.
    span: (f64, f64),
}

/// A slider and its contacts.
#[derive(Debug)]
struct SliderOnContacts {
    population: Box<dyn Population>,
    memory: Memory,
    /// Advance of the slider beyond the contacts, and its state there.
    ahead: f64,
    here: Point,
}

/// The state of a slider and its contacts. A simulation of the same description continues from it bit for bit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimulationState {
    memory: Memory,
    ahead: f64,
    here: Point,
    contacts: ContactsState,
}

impl Block {
    /// A simulation of the slider on these contacts, in equilibrium with them.
    ///
    /// # Errors
    /// Those of the population; a damping too large for an imposed force.
    pub fn simulation(&self, population: Box<dyn Population>) -> Result<BlockSimulation> {
        self.simulation_with(population, &mut ())
    }

    /// The same with a monitor.
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
        run.first_unloading()?;
        run.turn(Direction::Forward)?;
        let here = run.point();
        let memory = run.into_memory();
        let now = SliderOnContacts { population, memory, ahead: 0.0, here };
        let span = (here.drive, here.drive);
        Ok(BlockSimulation { block: *self, copied: now.copy(), now, since: 0, span })
    }
}

impl SliderOnContacts {
    fn copy(&self) -> Self {
        let Self { population, memory, ahead, here } = self;
        Self { population: population.copy(), memory: memory.clone(), ahead: *ahead, here: *here }
    }

    /// Moves the contacts to the position of the slider, and applies `then` to the run there.
    fn catch_up<T>(
        &mut self,
        block: &Block,
        then: impl FnOnce(&mut QuasistaticRun<'_>) -> Result<T>,
    ) -> Result<T> {
        let (ahead, memory, nobody) = (std::mem::take(&mut self.ahead), self.memory.clone(), &mut ());
        let mut run = QuasistaticRun::resumed(block, self.population.as_mut(), memory, nobody)?;
        run.advance(ahead)?;
        let done = then(&mut run)?;
        self.memory = run.into_memory();
        Ok(done)
    }
}

impl BlockSimulation {
    /// The drive: X_T, X of a rigid slider, or an imposed force.
    pub fn drive(&self) -> f64 {
        self.now.here.drive
    }

    /// Drive, position of the slider's base, friction force and force of the spring.
    pub fn point(&self) -> Point {
        self.now.here
    }

    /// The energy balance since the start.
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
    ///
    /// # Errors
    /// Those of the contacts.
    pub fn broken(&self) -> Result<f64> {
        self.now.copy().catch_up(&self.block, |run| Ok(run.path.energies().broken))
    }

    /// Largest estimated error of the force so far; 0 for contacts that are followed one by one.
    pub fn error(&self) -> f64 {
        self.now.population.error()
    }

    /// The stretches of the attached contacts, in no order; `None` unless contacts are followed one by one.
    ///
    /// # Errors
    /// Those of the population.
    pub fn stretches(&self) -> Result<Option<Vec<f64>>> {
        self.observe(|population| Ok(population.stretches()))
    }

    /// The density of stretches; see [`Population::stretch_density`].
    ///
    /// # Errors
    /// Those of the population.
    pub fn stretch_density(&self, stretches: &[f64]) -> Result<Option<(Vec<f64>, Vec<Atom>)>> {
        self.stretch_density_with(stretches, &mut ())
    }

    /// The same with a monitor.
    ///
    /// # Errors
    /// As [`Self::stretch_density`]; stopped by the monitor.
    pub fn stretch_density_with(
        &self,
        stretches: &[f64],
        monitor: &mut dyn Monitor,
    ) -> Result<Option<(Vec<f64>, Vec<Atom>)>> {
        self.observe(|population| population.stretch_density(stretches, monitor))
    }

    /// Applies `evaluate` to the contacts at the position of the slider.
    fn observe<T>(&self, evaluate: impl FnOnce(&dyn Population) -> Result<T>) -> Result<T> {
        // Contacts stand at the last event or kink; a copy is moved to the slider for the
        // observation, so that looking changes nothing.
        if self.now.ahead == 0.0 {
            return evaluate(self.now.population.as_ref());
        }
        let mut there = self.now.copy();
        there.catch_up(&self.block, |_| Ok(()))?;
        evaluate(there.population.as_ref())
    }

    /// Moves the drive, forward or back, to `until` or through the next event before it. Returns `None` at `until`.
    ///
    /// An event is a slip or, for a rigid slider, a set of simultaneous breaks. With a `slip_fraction`, events in which fewer
    /// contacts break are omitted.
    ///
    /// # Errors
    /// A drive that is not a finite number; those of the population; an imposed force that the contacts cannot carry. The
    /// state is then the one before the call.
    pub fn next_event(&mut self, until: f64) -> Result<Option<Event>> {
        self.next_event_with(until, &mut ())
    }

    /// The same with a monitor.
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
        if self.span.1 != until {
            self.span = (here, until);
        }
        let direction = if until > here { Direction::Forward } else { Direction::Backward };
        let turns = direction != self.now.memory.direction;
        let turned = if turns { self.now.catch_up(&self.block, |run| run.turn(direction)) } else { Ok(()) };
        let mut happened = turned.and_then(|()| self.step(until, monitor));
        if turns && happened.is_ok() {
            // Contacts that cannot move back report it only when they are moved, so a copy is moved now.
            happened = self.now.copy().catch_up(&self.block, |_| Ok(())).and(happened);
        }
        // An interrupted step has left the contacts anywhere: the last copy is taken, and the
        // events since are repeated.
        if happened.is_err() {
            self.go_back(here)?;
            return happened;
        }
        self.since += u64::from(matches!(happened, Ok(Some(_))));
        let broken = [&self.now, &self.copied].map(|slider| slider.population.energies().broken);
        let broken = broken[0] - broken[1];
        // Events are repeated in one direction only: every turn needs a new copy.
        if turns || broken >= COPY_AFTER.0 || self.since >= COPY_AFTER.1 {
            (self.copied, self.since) = (self.now.copy(), 0);
        }
        happened
    }

    /// Events as columns, those of `events.csv`.
    pub fn record(&self, events: &[Event]) -> Record {
        events::record(events, self.block.loading.drive_quantity())
    }

    /// Moves the drive to `until`, and calls `each` for every event.
    ///
    /// # Errors
    /// See [`BlockSimulation::next_event`]; the state is then the one after the last event.
    pub fn run(&mut self, until: f64, each: &mut dyn FnMut(&Event)) -> Result<()> {
        self.run_with(until, &mut (), each)
    }

    /// The same with a monitor.
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

    /// The present state of slider and contacts.
    pub fn state(&self) -> SimulationState {
        let SliderOnContacts { memory, ahead, here, population } = &self.now;
        SimulationState { memory: memory.clone(), ahead: *ahead, here: *here, contacts: population.state() }
    }

    /// Restores the state of a simulation of the same description.
    ///
    /// # Errors
    /// A state of other contacts; those of the population.
    pub fn restore(&mut self, state: SimulationState, monitor: &mut dyn Monitor) -> Result<()> {
        let SimulationState { memory, ahead, here, contacts } = state;
        let mut population = self.now.population.copy();
        population.restore(&contacts, monitor)?;
        self.now = SliderOnContacts { population, memory, ahead, here };
        (self.copied, self.since) = (self.now.copy(), 0);
        self.span = (here.drive, here.drive);
        Ok(())
    }

    /// Continues in the present direction of the drive, to `until` or through the next event.
    fn step(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Option<Event>> {
        let ((from, to), SliderOnContacts { population, memory, ahead, here }) = (self.span, &mut self.now);
        let length = (to - from).abs().max(f64::MIN_POSITIVE);
        report(monitor, ((here.drive - from).abs() / length).min(1.0))?;
        let before = (from - memory.segment_start.drive).abs();
        let mut run = QuasistaticRun::resumed(&self.block, population.as_mut(), memory.clone(), monitor)?;
        // Progress is counted from the start of the present run of the drive, not from its last turn.
        run.path_length = (length, -before);
        let requested = [until];
        let mut requested = requested.as_slice();
        loop {
            let event = match run.next(&mut requested)? {
                Next::Happened(event) => event,
                Next::Reached(distance) => {
                    *here = run.trace.pop().expect("the trace has a point at each requested drive");
                    (*memory, *ahead) = (run.into_memory(), distance);
                    return Ok(None);
                }
                Next::Runaway(_) => {
                    let expected = "a force that the contacts can carry";
                    return Err(Error::invalid("drive", expected, until));
                }
            };
            if let Some(event) = event {
                (*memory, *ahead, *here) = (run.into_memory(), 0.0, event.after);
                return Ok(Some(event));
            }
        }
    }

    /// Returns to the state at `drive`, before a step: repeats the events since the copy.
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
