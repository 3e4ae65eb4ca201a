//! Simulations: interfaces, blocks and contacts that are advanced step by step, with their state readable in between.

use std::sync::{Mutex, TryLockError};

use asperity::contacts::{Initial, Start};
use asperity::energy::EnergyBalance;
use asperity::master::{MasterEquation, Stretches};
use asperity::monitor::{Aside, Monitor};
use asperity::rate_dependent::{StretchInterval, binned};
use asperity::record::Record;
use asperity::scenario::{self, Drive, PerCell};
use asperity::task::Grid;
use asperity::task::interface::{
    DrivenCells, DrivenContacts, DrivenInterface, DrivenRateDependentCells, cells_in_time,
};
use asperity::{Error, Result, block, master};
use pyo3::exceptions::{PyAttributeError, PyIndexError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::convert::{self, Whole};
use crate::description::Description;
use crate::interface::Surface;
use crate::watch::{detached, watched};
use crate::{error, values};

/// Events between two looks at signals.
const SLICE: u64 = 16;

/// Fewest and most bins of the stretches of contacts, where nobody says which.
const BINS: (f64, f64) = (20.0, 200.0);

/// A stretch of those just re-formed, of the largest, that is rounding.
const ROUNDING: f64 = 1e-12;

/// What is seen of something that is driven.
pub trait Observed {
    /// Number of cells whose contacts can be looked at.
    fn cells(&self) -> usize {
        1
    }

    /// The time so far; 0 where none passes.
    fn time(&self) -> f64 {
        0.0
    }

    fn force(&mut self) -> Result<f64>;

    /// The force of each cell.
    fn forces(&mut self) -> Result<Vec<f64>>;

    /// The position of each cell, where cells have some.
    fn positions(&self) -> Option<Vec<f64>>;

    /// Where the work of the drive has gone, where that is told.
    fn energy(&mut self) -> Result<Option<Energies>>;

    /// The stretches of the contacts of a cell.
    fn look(
        &mut self,
        cell: usize,
        looked: Looked,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, Stretches)>;
}

/// Something that is driven from event to event, whatever it is.
pub trait Live: Observed + Send {
    /// The drive so far.
    fn drive(&self) -> f64;

    /// Refuses a drive to which it cannot be brought.
    fn check(&self, key: &str, until: f64) -> Result<()> {
        if until >= self.drive() && until.is_finite() {
            return Ok(());
        }
        let expected =
            format!("a finite drive, {} or above, where it is now: it moves forward only", self.drive());
        Err(Error::invalid(key, expected, until))
    }

    /// Goes on to a drive, or to the next event: its columns, a row for each part of it; no rows at the drive.
    fn next(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Record>;

    /// Goes on to a drive.
    fn advance(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<()>;

    /// Adds what it has come to.
    fn write(&mut self, into: &mut Vec<u8>);

    /// Goes to what was written; where that fails all is as before.
    fn read(&mut self, from: &[u8], monitor: &mut dyn Monitor) -> Result<()>;
}

/// The energies of a slider, or of an interface.
pub enum Energies {
    Block(EnergyBalance),
    Interface(EnergyBalance),
}

/// An interface of a scenario, with what it takes to look at its contacts.
struct Driven<M, With> {
    model: M,
    with: With,
}

impl<M: DrivenInterface + Send, With: Send> Live for Driven<M, With>
where
    Self: Observed,
{
    fn drive(&self) -> f64 {
        self.model.drive()
    }

    fn next(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Record> {
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
            if self.model.advance(until, SLICE, monitor, &mut |_| ())? {
                return Ok(());
            }
        }
    }

    fn write(&mut self, into: &mut Vec<u8>) {
        write(&self.model.state(), into);
    }

    fn read(&mut self, from: &[u8], monitor: &mut dyn Monitor) -> Result<()> {
        let (state, before) = (read(&mut &*from)?, self.model.state());
        self.model.restore(state, monitor).or_else(|error| {
            self.model.restore(before, &mut ())?;
            Err(error)
        })
    }
}

/// How the contacts of cells that share a curve are known.
struct Solved {
    equation: MasterEquation,
    initial: Initial,
    tolerance: master::Tolerance,
}

impl Observed for Driven<DrivenCells, Option<Solved>> {
    fn cells(&self) -> usize {
        self.model.interface.len()
    }

    fn time(&self) -> f64 {
        self.model.interface.time()
    }

    fn force(&mut self) -> Result<f64> {
        Ok(self.model.interface.force())
    }

    fn forces(&mut self) -> Result<Vec<f64>> {
        Ok(self.model.interface.forces())
    }

    fn positions(&self) -> Option<Vec<f64>> {
        Some(self.model.interface.positions().to_vec())
    }

    fn energy(&mut self) -> Result<Option<Energies>> {
        Ok(Some(Energies::Interface(self.model.interface.energy())))
    }

    fn look(
        &mut self,
        cell: usize,
        looked: Looked,
        monitor: &mut dyn Monitor,
    ) -> Result<(Vec<f64>, Stretches)> {
        let interface = &self.model.interface;
        if let Some(portions) = interface.stretches(cell)? {
            return looked.at(&portions);
        }
        let standing = interface.standing(cell)?.expect("cells of many contacts share a curve");
        let Solved { equation, initial, tolerance } = self.with.as_ref().expect("they follow an equation");
        let stretches = looked.stretches(|| {
            let renewed = Initial { law: equation.contacts().reforming.clone(), start: Start::Conditional };
            let begun = if standing.renewed { &renewed } else { initial };
            let grid = Grid::new(equation, begun, &[standing.advance]);
            grid.stretches.into_iter().map(|x| standing.scale * x).collect()
        })?;
        let found =
            scenario::Interface::stretch_density(equation, standing, &stretches, *tolerance, monitor)?;
        Ok((stretches, found))
    }
}

impl Observed for Driven<DrivenRateDependentCells, ()> {
    fn cells(&self) -> usize {
        self.model.interface.len()
    }

    fn time(&self) -> f64 {
        self.model.interface.time()
    }

    fn force(&mut self) -> Result<f64> {
        Ok(self.model.interface.force())
    }

    fn forces(&mut self) -> Result<Vec<f64>> {
        Ok(self.model.interface.forces())
    }

    fn positions(&self) -> Option<Vec<f64>> {
        Some(self.model.interface.positions())
    }

    fn energy(&mut self) -> Result<Option<Energies>> {
        Ok(Some(Energies::Interface(self.model.interface.energy())))
    }

    fn look(&mut self, cell: usize, looked: Looked, _: &mut dyn Monitor) -> Result<(Vec<f64>, Stretches)> {
        looked.at(&self.model.interface.stretches(cell)?)
    }
}

impl Observed for Driven<DrivenContacts, f64> {
    fn force(&mut self) -> Result<f64> {
        Ok(self.model.lattice.force())
    }

    fn forces(&mut self) -> Result<Vec<f64>> {
        Ok(self.model.lattice.forces())
    }

    fn positions(&self) -> Option<Vec<f64>> {
        None
    }

    fn energy(&mut self) -> Result<Option<Energies>> {
        Ok(None)
    }

    /// Those of all contacts, `with` being the stiffness by which each adds to the force.
    fn look(&mut self, _: usize, looked: Looked, _: &mut dyn Monitor) -> Result<(Vec<f64>, Stretches)> {
        let forces = self.model.lattice.forces();
        looked.at(&points(forces.iter().map(|force| force / self.with).collect(), forces.len()))
    }
}

/// A slider over a population, or a population under a rigid slider.
pub struct Slider {
    pub simulation: block::BlockSimulation,
    /// The master equation of the contacts and their start; or the number of those that are followed one by one.
    pub contacts: SliderContacts,
}

/// What is known of the contacts under a slider.
pub enum SliderContacts {
    Solved(MasterEquation, Initial),
    Followed(usize),
}

impl Observed for Slider {
    fn force(&mut self) -> Result<f64> {
        Ok(self.simulation.point().force)
    }

    fn forces(&mut self) -> Result<Vec<f64>> {
        Ok(vec![self.simulation.point().force])
    }

    fn positions(&self) -> Option<Vec<f64>> {
        Some(vec![self.simulation.point().position])
    }

    fn energy(&mut self) -> Result<Option<Energies>> {
        self.simulation.energy().map(|energy| Some(Energies::Block(energy)))
    }

    fn look(&mut self, _: usize, looked: Looked, monitor: &mut dyn Monitor) -> Result<(Vec<f64>, Stretches)> {
        let (equation, initial) = match &self.contacts {
            SliderContacts::Followed(size) => {
                let stretches = self.simulation.stretches()?.unwrap_or_default();
                return looked.at(&points(stretches, *size));
            }
            SliderContacts::Solved(equation, initial) => (equation, initial),
        };
        let position = self.simulation.point().position;
        let chosen = matches!(looked, Looked::Default);
        let stretches = looked.stretches(|| {
            let ahead = Grid::new(equation, initial, &[position]).stretches;
            // Where the slider has turned contacts may be stretched the other way.
            ahead[1..].iter().rev().map(|x| -x).chain(ahead.iter().copied()).collect()
        })?;
        let found = self.simulation.stretch_density_with(&stretches, monitor)?;
        let (mut density, atoms) = found.expect("contacts that follow an equation are a distribution");
        let mut stretches = stretches;
        let behind = stretches.partition_point(|&x| x < 0.0);
        if chosen && density[..behind].iter().all(|&density| density == 0.0) {
            stretches.drain(..behind);
            density.drain(..behind);
        }
        Ok((stretches, Stretches { density, atoms }))
    }
}

impl Live for Slider {
    fn drive(&self) -> f64 {
        self.simulation.drive()
    }

    fn check(&self, key: &str, until: f64) -> Result<()> {
        if until.is_finite() { Ok(()) } else { Err(Error::invalid(key, "a finite drive", until)) }
    }

    fn next(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<Record> {
        let event = self.simulation.next_event_with(until, monitor)?;
        Ok(self.simulation.record(event.as_slice()))
    }

    fn advance(&mut self, until: f64, monitor: &mut dyn Monitor) -> Result<()> {
        self.simulation.run_with(until, monitor, &mut |_| ())
    }

    fn write(&mut self, into: &mut Vec<u8>) {
        write(&self.simulation.state(), into);
    }

    fn read(&mut self, from: &[u8], monitor: &mut dyn Monitor) -> Result<()> {
        self.simulation.restore(read(&mut &*from)?, monitor)
    }
}

/// Contacts at one stretch each, out of so many.
fn points(stretches: Vec<f64>, size: usize) -> Vec<StretchInterval> {
    let share = 1.0 / size as f64;
    let near = ROUNDING * stretches.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let at = |stretch: f64| {
        let stretch = if stretch.abs() < near { 0.0 } else { stretch };
        StretchInterval { low: stretch, high: stretch, share }
    };
    stretches.into_iter().map(at).collect()
}

/// Where a distribution of stretches is looked at.
pub enum Looked {
    /// At stretches.
    Stretches(Vec<f64>),
    /// In bins between edges.
    Bins(Vec<f64>),
    /// Where it can be seen well.
    Default,
}

impl Looked {
    pub fn of(stretches: Option<&Bound<'_, PyAny>>, edges: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        match (stretches, edges) {
            (Some(stretches), None) => Ok(Self::Stretches(convert::list("stretches", stretches)?)),
            (None, Some(edges)) => Ok(Self::Bins(convert::list("edges", edges)?)),
            (None, None) => Ok(Self::Default),
            (Some(_), Some(_)) => Err(error::invalid("stretches", "either stretches or edges", "both")),
        }
    }

    /// The stretches, where contacts are a distribution; those of `default` where nobody says which.
    fn stretches(self, default: impl FnOnce() -> Vec<f64>) -> Result<Vec<f64>> {
        match self {
            Self::Stretches(stretches) => Ok(stretches),
            Self::Default => Ok(default()),
            Self::Bins(_) => {
                let expected = "None where contacts follow the master equation and know no time";
                Err(Error::invalid("edges", expected, "edges of bins"))
            }
        }
    }

    /// The stretches, or the middles of the bins, with what is found of contacts there.
    fn at(self, portions: &[StretchInterval]) -> Result<(Vec<f64>, Stretches)> {
        let edges = match self {
            Self::Stretches(stretches) => {
                let found = Stretches::of(portions, &stretches);
                return Ok((stretches, found));
            }
            Self::Bins(edges) => edges,
            Self::Default => even_bins(portions),
        };
        let density = binned(portions, &edges)?;
        let middles = edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        Ok((middles, Stretches { density, atoms: Vec::new() }))
    }
}

/// Edges of even bins that hold all contacts, 0 being among them or below all.
fn even_bins(portions: &[StretchInterval]) -> Vec<f64> {
    let low = portions.iter().fold(0.0, |low: f64, portion| low.min(portion.low));
    let high = portions.iter().fold(low, |high: f64, portion| high.max(portion.high));
    let number = (portions.len() as f64).sqrt().clamp(BINS.0, BINS.1).ceil();
    let (low, width) = (1.05 * low, 1.05 * (high - low).max(f64::MIN_POSITIVE) / number);
    (0..=number as usize).map(|i| low + width * i as f64).collect()
}

/// Cells or contacts of an interface, to be driven from X_T = 0 at a velocity where they know time.
pub fn deformable(
    surface: &Surface,
    velocity: Option<f64>,
    tolerance: Option<f64>,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Live>> {
    let mut driven = built(surface, velocity, tolerance, monitor)?;
    if surface.own.contacts == PerCell::Many {
        // They are built in balance but for rounding; a drive begins with a stop here, too.
        driven.advance(0.0, monitor)?;
    }
    Ok(driven)
}

/// The same as they are built.
pub fn built(
    surface: &Surface,
    velocity: Option<f64>,
    tolerance: Option<f64>,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Live>> {
    let mut scenario = surface.scenario(Drive { velocity, ..Drive::default() });
    scenario.master_equation.tolerance = tolerance;
    let built = scenario.build()?;
    let scenario::Model { contacts, initial, .. } = built.clone();
    let (own, ensemble) = (&surface.own, surface.ensemble.as_ref());
    if own.contacts == PerCell::One {
        let unit = contacts.stiffness.of(contacts.thresholds.mean());
        let per_contact = unit * contacts.count / own.size() as f64;
        let lattice = own.lattice(contacts, initial, ensemble)?;
        let model = DrivenContacts { lattice, chain: false };
        return Ok(Box::new(Driven { model, with: per_contact }));
    }
    let velocity = velocity.filter(|_| contacts.rules.are_time_dependent());
    if let Some(velocity) = velocity {
        let interface = cells_in_time(&built, own, monitor)?;
        return Ok(Box::new(Driven { model: DrivenRateDependentCells { interface, velocity }, with: () }));
    }
    let tolerance = scenario.master_equation.tolerance();
    let with = match ensemble {
        Some(_) => None,
        None => {
            let aside = &mut Aside { fraction: 0.0, monitor };
            let equation = MasterEquation::new_with(contacts.clone(), &initial, aside)?;
            Some(Solved { equation, initial: initial.clone(), tolerance })
        }
    };
    let interface = own.deformable(contacts, &initial, tolerance, ensemble, monitor)?;
    let model = DrivenCells { interface, timed: own.viscosity.is_some(), solved: ensemble.is_none() };
    Ok(Box::new(Driven { model, with }))
}

/// What stands in front of a state: who wrote it, and of what.
#[derive(Serialize, Deserialize)]
struct Heading {
    version: String,
    model: String,
}

fn write(value: &impl Serialize, into: &mut Vec<u8>) {
    ciborium::into_writer(value, into).expect("a state is plain data, and memory does not refuse it");
}

fn read<T: DeserializeOwned>(from: &mut &[u8]) -> Result<T> {
    let refused = |_| Error::invalid("state", "bytes that Simulation.state returned", "others");
    ciborium::from_reader(from).map_err(refused)
}

/// A simulation that advances step by step, from event to event, with its state readable in between.
///
/// simulation() of an Interface, a Lattice, a Block, a MasterEquation or an Ensemble returns one, at X_T = 0. Its events are
/// those of `drive` of the same model, bit for bit.
///
/// Ctrl-C interrupts long computations; the simulation then has the state after the last event, and can continue. Using a
/// simulation while another thread advances it raises RuntimeError.
#[pyclass(frozen, module = "asperity")]
pub struct Simulation {
    model: Py<PyAny>,
    heading: String,
    /// Lengths of the arrays of cells.
    shape: Vec<usize>,
    live: Mutex<Box<dyn Live>>,
}

impl Simulation {
    /// The simulation of a model that is driven at a velocity and solved to a tolerance where it needs them, its cells in an
    /// array of a shape.
    pub fn new(
        model: &Bound<'_, Description>,
        driven: (Option<f64>, Option<f64>),
        shape: Vec<usize>,
        live: Box<dyn Live>,
    ) -> PyResult<Self> {
        let heading = format!("{} {driven:?}", model.get().json()?);
        Ok(Self { model: model.clone().into_any().unbind(), heading, shape, live: Mutex::new(live) })
    }

    /// Does something to what is simulated, unless it is at work.
    fn with<T>(&self, work: impl FnOnce(&mut dyn Live) -> PyResult<T>) -> PyResult<T> {
        match self.live.try_lock() {
            Ok(mut live) => work(live.as_mut()),
            Err(TryLockError::WouldBlock) => {
                let text =
                    "simulation: expected one that is not at work, got one that another call is driving";
                Err(PyRuntimeError::new_err(text))
            }
            Err(TryLockError::Poisoned(_)) => {
                Err(PyRuntimeError::new_err("simulation: expected one that works, got one that has failed"))
            }
        }
    }

    /// Values of the cells, as an array.
    fn array<'py>(&self, py: Python<'py>, values: Vec<f64>) -> PyResult<Bound<'py, PyAny>> {
        convert::array(py, &self.shape, values)
    }
}

#[pymethods]
impl Simulation {
    /// The model of the simulation: an Interface, Lattice, Block, MasterEquation or Ensemble.
    #[getter]
    fn model(&self, py: Python<'_>) -> Py<PyAny> {
        self.model.clone_ref(py)
    }

    /// The load-point displacement X_T, a length; without a spring, the displacement of the slider.
    #[getter]
    fn drive(&self) -> PyResult<f64> {
        self.with(|live| Ok(live.drive()))
    }

    /// The time; 0 for models without time.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        self.with(|live| Ok(live.time()))
    }

    /// The friction force of all cells and contacts.
    #[getter]
    fn force(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(|live| detached(py, || live.force()).map_err(error::core))
    }

    /// The force of each cell, or of each contact of a Lattice: shape (n,) or (rows, columns); (1,) for a slider.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let forces = self.with(|live| detached(py, || live.forces()).map_err(error::core))?;
        self.array(py, forces)
    }

    /// The position X_j of each cell, a length: shape (n,) or (rows, columns); (1,) for a slider. A Lattice has none.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let positions = self.with(|live| Ok(live.positions()))?;
        let none =
            || PyAttributeError::new_err("positions: contacts coupled one by one have stretches alone");
        self.array(py, positions.ok_or_else(none)?)
    }

    /// The energy balance from X_T = 0: an InterfaceEnergy for an Interface, otherwise an Energy. A Lattice has none.
    #[getter]
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match self.with(|live| detached(py, || live.energy()).map_err(error::core))? {
            Some(Energies::Block(energy)) => values::energy(py, &energy),
            Some(Energies::Interface(energy)) => values::interface_energy(py, &energy),
            None => Err(PyAttributeError::new_err("energy: that of contacts coupled one by one is not told")),
        }
    }

    /// Advances to the displacement `until` and yields each event after it has happened: an iterator.
    ///
    /// Events are those of `drive` of the same model (slips of a block or an interface, avalanches of a lattice, simultaneous
    /// breaks under a rigid slider), with the same fields: `drive`, `drop`, …. Between two events the state is the one just
    /// after the first of them; it can be read, saved, or advanced. The iterator ends at the displacement.
    ///
    /// until: an absolute displacement of the load point, not a step; larger than the present one, or, for sliders that
    /// can turn back, also smaller.
    ///
    /// Raises ValueError for a displacement to which an interface would have to move backwards.
    fn events(slf: Bound<'_, Self>, until: f64) -> PyResult<EventsAhead> {
        let from = slf.get().with(|live| {
            live.check("until", until).map_err(error::core)?;
            Ok(live.drive())
        })?;
        Ok(EventsAhead { simulation: slf.unbind(), way: (from, until), told: Mutex::default() })
    }

    /// Advances to a displacement of the load point, through all events in between.
    ///
    /// drive: an absolute displacement, not a step; larger than the present one, or, for sliders that can turn back, also
    /// smaller. Stops do not change later results of a slider or a lattice. For an interface every stop is an equilibrium
    /// that is computed: stops may change the last digits of later results, and the drives of events within drive_tolerance.
    /// progress: as for MasterEquation.pull. Ctrl-C interrupts the computation.
    ///
    /// Raises ValueError for a displacement to which an interface would have to move backwards.
    #[pyo3(signature = (drive, *, progress = None))]
    fn advance(&self, py: Python<'_>, drive: f64, progress: Option<Bound<'_, PyAny>>) -> PyResult<()> {
        self.with(|live| {
            live.check("drive", drive).map_err(error::core)?;
            watched(progress, py, |monitor| live.advance(drive, monitor))
        })
    }

    /// The density Q(x) of the stretches of the contacts of a cell, per length.
    ///
    /// cell: the number of a cell of an Interface, counted along rows; 0 for a slider, and for a Lattice, whose contacts are
    /// counted all together.
    /// stretches: a list of n stretches at which the density is given, for contacts that follow the master equation.
    /// edges: n + 1 rising edges of bins in which contacts are counted that are simulated one by one, or in time; at given
    /// stretches each of them is an atom. Without stretches and edges, a suitable grid is chosen.
    /// progress: as for MasterEquation.pull.
    ///
    /// The result has `stretch` and `density` of shape (n,), and `atoms`, stretches that many contacts share. Detached
    /// contacts are not counted.
    ///
    /// Raises IndexError if there is no such cell, ValueError for invalid values.
    #[pyo3(
        signature = (cell = Whole::new(0), stretches = None, *, edges = None, progress = None),
        text_signature = "($self, cell=0, stretches=None, *, edges=None, progress=None)"
    )]
    fn stretch_density<'py>(
        &self,
        py: Python<'py>,
        cell: Whole,
        stretches: Option<&Bound<'py, PyAny>>,
        edges: Option<&Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let cell: usize = cell.get("cell")?;
        let cells = self.with(|live| Ok(live.cells()))?;
        if cell >= cells {
            let text = format!("cell: expected a number below {cells}, got {cell}");
            return Err(PyIndexError::new_err(text));
        }
        let looked = Looked::of(stretches, edges)?;
        let (stretches, found) =
            self.with(|live| watched(progress, py, |monitor| live.look(cell, looked, monitor)))?;
        values::stretches(py, stretches, found)
    }

    /// The whole state of the simulation, as bytes for `restore` in the same version of asperity.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let mut bytes = Vec::new();
        write(&Heading { version, model: self.heading.clone() }, &mut bytes);
        self.with(|live| {
            detached(py, || live.write(&mut bytes));
            Ok(())
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Restores a state of this simulation, or of another one of the same model; it continues from there bit for bit.
    ///
    /// Raises ValueError for the state of another model, or of another version of asperity.
    fn restore(&self, py: Python<'_>, state: &[u8]) -> PyResult<()> {
        let mut rest = state;
        let Heading { version, model } = read(&mut rest).map_err(error::core)?;
        if version != env!("CARGO_PKG_VERSION") {
            let expected = format!("one that asperity {} wrote", env!("CARGO_PKG_VERSION"));
            return Err(error::invalid("state", expected, format!("one of asperity {version}")));
        }
        if model != self.heading {
            return Err(error::invalid("state", "that of a simulation of the same model", "that of another"));
        }
        self.with(|live| watched(None, py, |monitor| live.read(rest, monitor)))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let name = self.model.bind(py).get_type().name()?.to_string();
        Ok(format!("<asperity.Simulation of {name} at drive={}>", self.drive()?))
    }
}

/// Events of a simulation, each computed when it is asked for.
#[pyclass(frozen, module = "asperity")]
pub struct EventsAhead {
    simulation: Py<Simulation>,
    /// Where the drive was, and where it goes.
    way: (f64, f64),
    /// What happened last, and how much of it has been handed out.
    told: Mutex<(Record, usize)>,
}

#[pymethods]
impl EventsAhead {
    fn __iter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Ok(mut told) = self.told.try_lock() else {
            return Err(PyRuntimeError::new_err("events: expected one thread, got more"));
        };
        if told.0.length("event").unwrap_or(0) == told.1 {
            let (from, until) = self.way;
            let next = |live: &mut dyn Live| {
                // Somebody else has driven it further.
                if (live.drive() - until) * (until - from) > 0.0 {
                    return Ok(Record::default());
                }
                watched(None, py, |monitor| live.next(until, monitor))
            };
            *told = (self.simulation.get().with(next)?, 0);
        }
        let (record, row) = &mut *told;
        if record.length("event").unwrap_or(0) == *row {
            return Ok(None);
        }
        *row += 1;
        values::event(py, record, *row - 1).map(Some)
    }
}

/// The simulation of a block, or of contacts under a rigid slider.
pub fn slider(
    block: &block::Block,
    population: Box<dyn asperity::population::Population>,
    contacts: SliderContacts,
    monitor: &mut dyn Monitor,
) -> Result<Box<dyn Live>> {
    let simulation = block.simulation_with(population, monitor)?;
    Ok(Box::new(Slider { simulation, contacts }))
}
