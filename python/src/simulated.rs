//! What a simulation advances: an interface that is driven from event to event, or a slider over contacts.

use std::io::{self, Read};

use asperity::contacts::{Initial, Start};
use asperity::energy::EnergyBalance;
use asperity::master::{MasterEquation, Stretches};
use asperity::monitor::{Aside, Monitor};
use asperity::population::Population;
use asperity::record::Record;
use asperity::scenario::{self, Drive, PerCell};
use asperity::task::Grid;
use asperity::task::interface::{
    DrivenCells, DrivenContacts, DrivenContactsInTime, DrivenInterface, DrivenRateDependentCells,
    LoadPointMotion, cells_in_time,
};
use asperity::{Error, Result, block};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::plain::Surface;
use crate::stretches::{StretchGrid, points};

/// Events after which a drive asks whether to go on.
const EVENTS_BETWEEN_CHECKS: u64 = 16;

/// A model that advances from event to event, with its state readable in between.
pub trait Simulated: Send {
    /// Number of cells whose stretches can be asked for.
    fn cells(&self) -> usize;

    /// Load-point displacement X_T.
    fn drive(&self) -> f64;

    /// Time; 0 for models without time.
    fn time(&self) -> f64;

    /// Friction force of all cells.
    fn force(&self) -> f64;

    /// Friction force of each cell.
    fn forces(&self) -> Vec<f64>;

    /// Position of each cell; `None` for contacts coupled one by one.
    fn positions(&self) -> Option<Vec<f64>>;

    /// Energy balance from X_T = 0; `None` where it is not computed.
    fn energy(&self) -> Result<Option<Energy>>;

    /// Distribution of the stretches of the contacts of a cell, and the stretches at which it is given.
    fn stretch_density(
        &self,
        cell: usize,
        grid: StretchGrid,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, Stretches)>;

    /// Refuses a drive that cannot be reached.
    fn check(&self, key: &str, until: f64) -> Result<()>;

    /// Advances to a drive, or through the next event before it. Returns the columns of the event, a row for each of its
    /// parts; no rows at the drive.
    fn next_event(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Record>;

    /// Advances to a drive.
    fn advance(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<()>;

    /// The model as one that moves in time; `None` where no time passes.
    fn in_time(&mut self) -> Option<&mut dyn MovedInTime> {
        None
    }

    /// Appends the state.
    fn write_state(&self, into: &mut Vec<u8>);

    /// Restores a state; after an error the present one is kept.
    fn restore_state(&mut self, from: &[u8], monitor: &mut dyn Monitor) -> Result<()>;
}

/// Refuses a drive behind the present one, `here`.
pub fn forward(key: &str, here: f64, until: f64) -> Result<()> {
    if until >= here && until.is_finite() {
        return Ok(());
    }
    let expected = format!("a finite drive, {here} or above, where it is now: it moves forward only");
    Err(Error::invalid(key, expected, until))
}

/// A model in time, whose load point has a velocity and can be held.
pub trait MovedInTime: Send {
    /// Velocity of the load point.
    fn velocity(&self) -> f64;

    /// The load point continues at a velocity above 0.
    fn set_velocity(&mut self, velocity: f64) -> Result<()>;

    /// Velocity of each cell.
    fn velocities(&self) -> Vec<f64>;

    /// Holds the load point for a duration, through all events in it.
    fn hold(&mut self, duration: f64, monitor: &mut dyn Monitor) -> Result<()>;
}

impl MovedInTime for DrivenRateDependentCells {
    fn velocity(&self) -> f64 {
        self.velocity().unwrap_or(0.0)
    }

    fn set_velocity(&mut self, velocity: f64) -> Result<()> {
        self.set_velocity(velocity)
    }

    fn velocities(&self) -> Vec<f64> {
        self.interface.velocities()
    }

    fn hold(&mut self, duration: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.hold_with(duration, monitor).map(drop)
    }
}

impl MovedInTime for DrivenContactsInTime {
    fn velocity(&self) -> f64 {
        self.velocity().unwrap_or(0.0)
    }

    fn set_velocity(&mut self, velocity: f64) -> Result<()> {
        self.set_velocity_with(velocity, &mut ())
    }

    fn velocities(&self) -> Vec<f64> {
        // Between avalanches all contacts are stretched as the drive moves.
        vec![self.velocity().unwrap_or(0.0); self.forces().len()]
    }

    fn hold(&mut self, duration: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.hold_with(duration, monitor)
    }
}

/// The energy balance of a slider or of an interface.
pub enum Energy {
    Slider(EnergyBalance),
    Interface(EnergyBalance),
}

/// Appends a value as CBOR.
pub fn write(value: &impl Serialize, into: &mut Vec<u8>) {
    ciborium::into_writer(value, into).expect("a state is plain data, and memory does not refuse it");
}

/// Reads a value that [`write`] wrote.
pub fn read<T: DeserializeOwned>(from: &mut &[u8]) -> Result<T> {
    ciborium::from_reader(from).map_err(|_| not_a_state())
}

/// The same with a monitor: states of large interfaces take seconds.
pub fn read_with<T: DeserializeOwned>(bytes: &[u8], monitor: &mut dyn Monitor) -> Result<T> {
    let mut reader = WatchedReader { bytes, monitor, asked: bytes.len() };
    match ciborium::from_reader(&mut reader) {
        Err(ciborium::de::Error::Io(_)) if !reader.bytes.is_empty() => Err(Error::Stopped),
        read => read.map_err(|_| not_a_state()),
    }
}

fn not_a_state() -> Error {
    Error::invalid("state", "bytes that Simulation.state returned", "others")
}

/// Bytes whose reading a monitor may stop.
struct WatchedReader<'a> {
    bytes: &'a [u8],
    monitor: &'a mut dyn Monitor,
    /// How many were left when the monitor was asked.
    asked: usize,
}

impl Read for WatchedReader<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        /// Bytes between two questions, some milliseconds.
        const ASK: usize = 1 << 18;
        if self.asked - self.bytes.len() >= ASK {
            self.asked = self.bytes.len();
            if self.monitor.progress(0.0).is_break() {
                return Err(io::Error::other("stopped"));
            }
        }
        self.bytes.read(into)
    }
}

/// An interface, and how the stretches of its contacts follow from its state.
struct SimulatedInterface<M> {
    model: M,
    cells: usize,
    stretch_density: StretchDensity<M>,
    in_time: fn(&mut M) -> Option<&mut dyn MovedInTime>,
}

/// [`Simulated::stretch_density`] of an interface.
type StretchDensity<M> =
    Box<dyn Fn(&M, usize, StretchGrid, &mut dyn Monitor) -> Result<(Vec<f64>, Stretches)> + Send>;

impl<M: DrivenInterface + Send> Simulated for SimulatedInterface<M> {
    fn cells(&self) -> usize {
        self.cells
    }

    fn drive(&self) -> f64 {
        self.model.drive()
    }

    fn time(&self) -> f64 {
        self.model.time()
    }

    fn force(&self) -> f64 {
        self.model.force()
    }

    fn forces(&self) -> Vec<f64> {
        self.model.forces()
    }

    fn positions(&self) -> Option<Vec<f64>> {
        self.model.positions()
    }

    fn energy(&self) -> Result<Option<Energy>> {
        Ok(self.model.energy().map(Energy::Interface))
    }

    fn stretch_density(
        &self,
        cell: usize,
        grid: StretchGrid,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, Stretches)> {
        (self.stretch_density)(&self.model, cell, grid, monitor)
    }

    fn check(&self, key: &str, until: f64) -> Result<()> {
        forward(key, self.drive(), until)
    }

    fn next_event(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Record> {
        let mut events = Vec::new();
        self.model.advance(until, 1, monitor, &mut |event| events.push(event))?;
        Ok(self.model.columns(&events))
    }

    fn advance(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<()> {
        let from = self.drive();
        loop {
            let fraction = if until > from { (self.drive() - from) / (until - from) } else { 1.0 };
            if monitor.progress(fraction).is_break() {
                return Err(Error::Stopped);
            }
            if self.model.advance(until, EVENTS_BETWEEN_CHECKS, monitor, &mut |_| ())? {
                return Ok(());
            }
        }
    }

    fn in_time(&mut self) -> Option<&mut dyn MovedInTime> {
        (self.in_time)(&mut self.model)
    }

    fn write_state(&self, into: &mut Vec<u8>) {
        write(&self.model.state(), into);
    }

    fn restore_state(&mut self, from: &[u8], monitor: &mut dyn Monitor) -> Result<()> {
        let (state, before) = (read_with(from, monitor)?, self.model.state());
        self.model.restore(state, monitor).or_else(|error| {
            self.model.restore(before, &mut ())?;
            Err(error)
        })
    }
}

/// The interface, driven from balance, at a velocity if its contacts are time-dependent.
pub fn interface(
    surface: &Surface,
    velocity: Option<f64>,
    tolerance: Option<f64>,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Simulated>> {
    let mut simulated = unrelaxed_interface(surface, velocity, tolerance, monitor)?;
    if surface.own.contacts == PerCell::Many {
        // Its cells are in equilibrium but for rounding. A drive also computes an equilibrium at X_T = 0 first.
        simulated.advance(0.0, monitor)?;
    }
    Ok(simulated)
}

/// The same interface before the equilibrium at X_T = 0 is computed.
pub fn unrelaxed_interface(
    surface: &Surface,
    velocity: Option<f64>,
    tolerance: Option<f64>,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Simulated>> {
    let mut scenario = surface.scenario(Drive { velocity, ..Drive::default() });
    scenario.master_equation.tolerance = tolerance;
    let model = scenario.build()?;
    if surface.own.contacts == PerCell::One {
        return coupled_contacts(surface, model, velocity, monitor);
    }
    match velocity.filter(|_| surface.own.moves_in_time(&model.contacts)) {
        Some(velocity) => rate_dependent_cells(surface, &model, velocity, monitor),
        None => athermal_cells(surface, model, monitor),
    }
}

fn coupled_contacts(
    surface: &Surface,
    model: scenario::Model,
    velocity: Option<f64>,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Simulated>> {
    let (own, scenario::Model { contacts, initial, .. }) = (&surface.own, model);
    let velocity = velocity.filter(|_| contacts.rules.are_time_dependent());
    let unit = contacts.stiffness.of(contacts.thresholds.mean());
    // Stiffness by which a contact adds to the force.
    let stiffness = unit * contacts.count / own.size() as f64;
    let lattice = own.lattice(contacts, initial, surface.ensemble.as_ref(), velocity, monitor)?;
    let stretches = move |forces: Vec<f64>, grid: StretchGrid| {
        grid.count(&points(forces.iter().map(|force| force / stiffness).collect(), forces.len()))
    };
    let model = DrivenContacts { lattice, chain: false };
    let Some(velocity) = velocity else {
        return Ok(Box::new(SimulatedInterface {
            model,
            cells: 1,
            stretch_density: Box::new(move |model, _, grid, _| stretches(model.forces(), grid)),
            in_time: |_| None,
        }));
    };
    Ok(Box::new(SimulatedInterface {
        model: DrivenContactsInTime::new(model, LoadPointMotion::Velocity(velocity)),
        cells: 1,
        stretch_density: Box::new(move |model, _, grid, _| stretches(model.forces(), grid)),
        in_time: |model| Some(model),
    }))
}

fn rate_dependent_cells(
    surface: &Surface,
    model: &scenario::Model,
    velocity: f64,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Simulated>> {
    let interface = cells_in_time(model, &surface.own, monitor)?;
    Ok(Box::new(SimulatedInterface {
        cells: interface.len(),
        model: DrivenRateDependentCells::new(interface, LoadPointMotion::Velocity(velocity)),
        stretch_density: Box::new(|model, cell, grid, _| grid.count(&model.interface.stretches(cell)?)),
        in_time: |model| Some(model),
    }))
}

fn athermal_cells(
    surface: &Surface,
    model: scenario::Model,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Simulated>> {
    let (own, ensemble, tolerance) =
        (&surface.own, surface.ensemble.as_ref(), model.master_equation.tolerance());
    let scenario::Model { contacts, initial, .. } = model;
    let stretch_density: StretchDensity<DrivenCells> = match ensemble {
        Some(_) => Box::new(|model, cell, grid, _| {
            let stretches = model.interface.stretches(cell)?;
            grid.count(&stretches.expect("cells of an ensemble know their contacts"))
        }),
        None => {
            let aside = &mut Aside { fraction: 0.0, monitor };
            let equation = MasterEquation::new_with(contacts.clone(), &initial, aside)?;
            let initial = initial.clone();
            Box::new(move |model, cell, grid, monitor| {
                let standing = model.interface.standing(cell)?.expect("the cells share a curve");
                let stretches = grid.stretches(|| {
                    let reformed =
                        Initial { law: equation.contacts().reforming.clone(), start: Start::Conditional };
                    let begun = if standing.renewed { &reformed } else { &initial };
                    let grid = Grid::new(&equation, begun, &[standing.advance]);
                    grid.stretches.into_iter().map(|x| standing.scale * x).collect()
                })?;
                let density = scenario::Interface::stretch_density(
                    &equation, standing, &stretches, tolerance, monitor,
                )?;
                Ok((stretches, density))
            })
        }
    };
    let interface = own.deformable(contacts, &initial, tolerance, ensemble, monitor)?;
    Ok(Box::new(SimulatedInterface {
        cells: interface.len(),
        model: DrivenCells::new(interface, own.viscosity.is_some(), ensemble.is_none()),
        stretch_density,
        in_time: |_| None,
    }))
}

/// A slider block over contacts, or contacts under a rigid slider.
struct Slider {
    simulation: block::BlockSimulation,
    contacts: SliderContacts,
}

/// The contacts under a slider.
pub enum SliderContacts {
    /// A distribution that follows the master equation, and its initial state.
    Solved(Box<MasterEquation>, Initial),
    /// So many contacts that are followed one by one.
    Followed(usize),
}

/// The simulation of a slider over a population of contacts.
pub fn slider(
    block: &block::Block,
    population: Box<dyn Population>,
    contacts: SliderContacts,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Simulated>> {
    let simulation = block.simulation_with(population, monitor)?;
    Ok(Box::new(Slider { simulation, contacts }))
}

impl Slider {
    /// The distribution of contacts that follow the master equation.
    fn solved(
        &self,
        equation: &MasterEquation,
        initial: &Initial,
        grid: StretchGrid,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, Stretches)> {
        let position = self.simulation.point().position;
        let chosen = matches!(grid, StretchGrid::Default);
        let mut stretches = grid.stretches(|| {
            let ahead = Grid::new(equation, initial, &[position]).stretches;
            // Where the slider has turned, contacts may have negative stretches.
            ahead[1..].iter().rev().map(|x| -x).chain(ahead.iter().copied()).collect()
        })?;
        let found = self.simulation.stretch_density_with(&stretches, monitor)?;
        let (mut density, atoms) =
            found.expect("contacts that follow the master equation are a distribution");
        let negative = stretches.partition_point(|&x| x < 0.0);
        if chosen && density[..negative].iter().all(|&density| density == 0.0) {
            stretches.drain(..negative);
            density.drain(..negative);
        }
        Ok((stretches, Stretches { density, atoms }))
    }
}

impl Simulated for Slider {
    fn cells(&self) -> usize {
        1
    }

    fn drive(&self) -> f64 {
        self.simulation.drive()
    }

    fn time(&self) -> f64 {
        0.0
    }

    fn force(&self) -> f64 {
        self.simulation.point().force
    }

    fn forces(&self) -> Vec<f64> {
        vec![self.force()]
    }

    fn positions(&self) -> Option<Vec<f64>> {
        Some(vec![self.simulation.point().position])
    }

    fn energy(&self) -> Result<Option<Energy>> {
        self.simulation.energy().map(|energy| Some(Energy::Slider(energy)))
    }

    fn stretch_density(
        &self,
        _: usize,
        grid: StretchGrid,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, Stretches)> {
        match &self.contacts {
            SliderContacts::Solved(equation, initial) => self.solved(equation, initial, grid, monitor),
            SliderContacts::Followed(size) => {
                grid.count(&points(self.simulation.stretches()?.unwrap_or_default(), *size))
            }
        }
    }

    fn check(&self, key: &str, until: f64) -> Result<()> {
        if until.is_finite() { Ok(()) } else { Err(Error::invalid(key, "a finite drive", until)) }
    }

    fn next_event(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Record> {
        let event = self.simulation.next_event_with(until, monitor)?;
        Ok(self.simulation.record(event.as_slice()))
    }

    fn advance(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.simulation.run_with(until, monitor, &mut |_| ())
    }

    fn write_state(&self, into: &mut Vec<u8>) {
        write(&self.simulation.state(), into);
    }

    fn restore_state(&mut self, from: &[u8], monitor: &mut dyn Monitor) -> Result<()> {
        self.simulation.restore(read_with(from, monitor)?, monitor)
    }
}
