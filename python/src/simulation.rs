//! The class Simulation: a model that advances step by step, from event to event, behind a lock.

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use asperity::record::Record;
use pyo3::exceptions::{PyAttributeError, PyIndexError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};

use crate::argument::{Real, Whole};
use crate::convert;
use crate::description::Description;
use crate::simulated::{Energy, MovedInTime, Simulated, read, write};
use crate::stretches::StretchGrid;
use crate::watch::{detached, watched};
use crate::{error, typed, values};

/// The head of a state: the version of asperity that wrote it, the model, the velocity of its load point in time, and events.
#[derive(Serialize, Deserialize)]
struct Heading {
    version: String,
    model: String,
    velocity: Option<f64>,
    slide: Slide,
}

/// The events of the last slide, which may be several clusters of cells, and how many of them have been returned.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Slide {
    events: Record,
    returned: usize,
}

impl Slide {
    fn has_more(&self) -> bool {
        self.returned < self.events.length("event").unwrap_or(0)
    }
}

/// A simulation that advances step by step, from event to event, with its state readable in between.
///
/// simulation() of an Interface, a Lattice, a Block, a MasterEquation, a Transport or an Ensemble returns one. Its events are
/// those of `drive` of the same model, bit for bit; those of a block in time are the same within the tolerance.
///
/// Over time-dependent contacts models move in time: their load point has a `velocity`, and `hold` lets it rest.
///
/// Ctrl-C interrupts long computations; the simulation then has the state after the last event, and can continue. Using a
/// simulation while another thread advances it raises RuntimeError.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> theory = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1)))
/// >>> simulation = asp.Block(theory, 0.3).simulation()
/// >>> _ = simulation.advance(1.0)
/// >>> simulation.drive
/// 1.0
#[pyclass(frozen, module = "asperity")]
pub struct Simulation {
    model: Py<PyAny>,
    heading: String,
    /// Shape of arrays with a value for each cell.
    shape: Vec<usize>,
    simulated: Mutex<Box<dyn Simulated>>,
    /// Behind a lock that only a call which has locked `simulated` takes.
    slide: Mutex<Slide>,
}

impl Simulation {
    /// The simulation of a model, whose cells form an array of the given shape, at the velocity and the tolerance `driven`.
    pub fn new(
        model: &Bound<'_, Description>,
        driven: (Option<f64>, Option<f64>),
        shape: Vec<usize>,
        simulated: Box<dyn Simulated>,
    ) -> PyResult<Self> {
        let heading = format!("{} {driven:?}", model.get().json()?);
        Ok(Self {
            model: model.clone().into_any().unbind(),
            heading,
            shape,
            simulated: Mutex::new(simulated),
            slide: Mutex::default(),
        })
    }

    fn slide(&self) -> MutexGuard<'_, Slide> {
        self.slide.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next event up to a drive, from the drive at which the iterator was made: one of the last slide, if it has more.
    fn next_event<'py>(
        &self,
        py: Python<'py>,
        (from, until): (f64, f64),
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.with(|simulated| {
            // Another call may have advanced it beyond the last drive.
            if (simulated.drive() - until) * (until - from) > 0.0 {
                return Ok(None);
            }
            if !self.slide().has_more() {
                let events = watched(None, py, |monitor| simulated.next_event(until, monitor))?;
                *self.slide() = Slide { events, returned: 0 };
            }
            let mut slide = self.slide();
            if !slide.has_more() {
                return Ok(None);
            }
            slide.returned += 1;
            values::event(py, &slide.events, slide.returned - 1).map(Some)
        })
    }

    /// Uses the model, unless another call is using it.
    fn with<T>(&self, work: impl FnOnce(&mut dyn Simulated) -> PyResult<T>) -> PyResult<T> {
        match self.simulated.try_lock() {
            Ok(mut simulated) => work(simulated.as_mut()),
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

    /// Uses the model as one in time; `name` is what was asked of it.
    fn in_time<T>(&self, name: &str, work: impl FnOnce(&mut dyn MovedInTime) -> PyResult<T>) -> PyResult<T> {
        self.with(|simulated| match simulated.in_time() {
            Some(moved) => work(moved),
            None => {
                let text =
                    format!("{name}: no time passes in this model, whose contacts do not depend on it");
                Err(PyAttributeError::new_err(text))
            }
        })
    }

    /// Values of the cells as an array.
    fn array<'py>(&self, py: Python<'py>, values: Vec<f64>) -> PyResult<typed::Array<'py>> {
        convert::array(py, &self.shape, values).map(typed::Array)
    }
}

#[pymethods]
impl Simulation {
    /// The model of the simulation: an Interface, Lattice, Block, MasterEquation, Transport or Ensemble.
    #[getter]
    fn model<'py>(&self, py: Python<'py>) -> typed::SimulatedModel<'py> {
        typed::SimulatedModel(self.model.bind(py).clone())
    }

    /// The load-point displacement X_T, a length; without a spring, the displacement of the slider.
    #[getter]
    fn drive(&self) -> PyResult<f64> {
        self.with(|simulated| Ok(simulated.drive()))
    }

    /// The time; 0 for models without time.
    #[getter]
    fn time(&self) -> PyResult<f64> {
        self.with(|simulated| Ok(simulated.time()))
    }

    /// The velocity of the load point, above 0, with which `advance` and `events` continue; it may be changed at any time.
    /// Models without time have none.
    #[getter]
    fn velocity(&self) -> PyResult<f64> {
        self.in_time("velocity", |moved| Ok(moved.velocity()))
    }

    #[setter]
    fn set_velocity(&self, velocity: Real) -> PyResult<()> {
        let velocity = velocity.get("velocity")?;
        self.in_time("velocity", |moved| moved.set_velocity(velocity).map_err(error::core))
    }

    /// The velocity of each cell: shape (n,) or (rows, columns); (1,) for a block. Models without time have none.
    #[getter]
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        let velocities = self.in_time("velocities", |moved| Ok(moved.velocities()))?;
        self.array(py, velocities)
    }

    /// The friction force of all cells and contacts.
    #[getter]
    fn force(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(|simulated| Ok(detached(py, move || simulated.force())))
    }

    /// The force of each cell, or of each contact of a Lattice: shape (n,) or (rows, columns); (1,) for a slider.
    #[getter]
    fn forces<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        let forces = self.with(|simulated| Ok(detached(py, move || simulated.forces())))?;
        self.array(py, forces)
    }

    /// The position X_j of each cell, a length: shape (n,) or (rows, columns); (1,) for a slider. A Lattice has none.
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        let positions = self.with(|simulated| Ok(simulated.positions()))?;
        let none =
            || PyAttributeError::new_err("positions: contacts coupled one by one have stretches alone");
        self.array(py, positions.ok_or_else(none)?)
    }

    /// The energy balance from X_T = 0: an InterfaceEnergy for an Interface, otherwise an Energy. A Lattice has none.
    #[getter]
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<typed::AnyEnergy<'py>> {
        match self.with(|simulated| detached(py, move || simulated.energy()).map_err(error::core))? {
            Some(Energy::Slider(energy)) => Ok(typed::AnyEnergy(values::energy(py, &energy)?.0)),
            Some(Energy::Interface(energy)) => Ok(typed::AnyEnergy(values::interface_energy(py, &energy)?.0)),
            None => Err(PyAttributeError::new_err(
                "energy: not computed for contacts coupled one by one, and for a rigid slider in time",
            )),
        }
    }

    /// Advances to the displacement `until` and yields each event after it has happened: an iterator.
    ///
    /// Events are those of `drive` of the same model (slips of a block or an interface, avalanches of a lattice, simultaneous
    /// breaks under a rigid slider), with the same fields: `drive`, `drop`, …. Between two events the state is the one just
    /// after the first of them; it can be read, saved, or advanced. Clusters of cells that slip in one slide of an interface
    /// are events at the same drive: the state is then that after the slide. The iterator ends at the displacement; a new
    /// one goes on with the next event.
    ///
    /// Parameters
    /// ----------
    /// until
    ///     An absolute displacement of the load point, not a step; larger than the present one, or, for sliders that
    ///     can turn back, also smaller.
    ///
    /// Returns
    /// -------
    /// Iterator[Event]
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a displacement to which an interface would have to move backwards.
    #[pyo3(signature = (until) -> "Iterator[Event]")]
    fn events(slf: Bound<'_, Self>, until: Real) -> PyResult<EventIterator> {
        let until = until.get("until")?;
        let from = slf.get().with(|simulated| {
            simulated.check("until", until).map_err(error::core)?;
            Ok(simulated.drive())
        })?;
        Ok(EventIterator { simulation: slf.unbind(), interval: (from, until) })
    }

    /// Advances to a displacement of the load point, through all events in between.
    ///
    /// Parameters
    /// ----------
    /// drive
    ///     An absolute displacement, not a step; larger than the present one, or, for sliders that can turn back,
    ///     also smaller. Stops do not change later results of a slider or a lattice. For an interface every stop is
    ///     an equilibrium that is computed: stops may change the last digits of later results, and the drives of
    ///     events within drive_tolerance. A stop of a block in time changes later results within its tolerance.
    /// progress
    ///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a displacement to which an interface would have to move backwards.
    #[pyo3(signature = (drive, *, progress: "_Progress" = None))]
    fn advance(&self, py: Python<'_>, drive: Real, progress: Option<Bound<'_, PyAny>>) -> PyResult<()> {
        let drive = drive.get("drive")?;
        self.with(|simulated| {
            simulated.check("drive", drive).map_err(error::core)?;
            *self.slide() = Slide::default();
            watched(progress, py, |monitor| simulated.advance(drive, monitor))
        })
    }

    /// Holds the load point for a duration, through all events in it. Contacts age while it rests.
    ///
    /// Parameters
    /// ----------
    /// duration
    ///     A time, 0 or above.
    /// progress
    ///     As for MasterEquation.pull. Ctrl-C interrupts the computation; `time` shows how much of it is done.
    ///
    /// Raises
    /// ------
    /// AttributeError
    ///     For models without time.
    /// ValueError
    ///     For a duration that is not a finite number, 0 or above.
    ///
    /// Examples
    /// --------
    /// >>> import asperity as asp
    /// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1), ageing=asp.Logarithmic(growth=0.1, time=1.0))
    /// >>> sim = asp.Block(asp.Transport(contacts), 5.0, asp.Damped(0.01)).simulation(velocity=0.1)
    /// >>> sim.advance(4.0)
    /// >>> sim.hold(100.0)
    /// >>> round(sim.time), sim.drive
    /// (140, 4.0)
    #[pyo3(signature = (duration, *, progress: "_Progress" = None))]
    fn hold(&self, py: Python<'_>, duration: Real, progress: Option<Bound<'_, PyAny>>) -> PyResult<()> {
        let duration = duration.get("duration")?;
        self.in_time("hold", |moved| {
            *self.slide() = Slide::default();
            watched(progress, py, |monitor| moved.hold(duration, monitor))
        })
    }

    /// The density Q(x) of the stretches of the contacts of a cell, per length.
    ///
    /// The result has `stretch` and `density` of shape (n,), and `atoms`, stretches that many contacts share. Detached
    /// contacts are not counted.
    ///
    /// Parameters
    /// ----------
    /// cell
    ///     The number of a cell of an Interface, counted along rows; 0 for a slider, and for a Lattice, whose
    ///     contacts are counted all together.
    /// stretches
    ///     A list of n stretches at which the density is given, for contacts that follow the master equation.
    /// edges
    ///     N + 1 rising edges of bins in which contacts are counted that are simulated one by one, or in time; at
    ///     given stretches each of them is an atom. Without stretches and edges, a suitable grid is chosen.
    /// progress
    ///     As for MasterEquation.pull.
    ///
    /// Returns
    /// -------
    /// StretchDensity
    ///
    /// Raises
    /// ------
    /// IndexError
    ///     If there is no such cell.
    /// ValueError
    ///     For stretches and edges together, fewer than two edges or edges that do not rise, and edges for contacts
    ///     that follow the master equation without time dependence.
    #[pyo3(
        signature = (cell = Whole::new(0), stretches: "ArrayLike | None" = None, *, edges: "ArrayLike | None" = None, progress: "_Progress" = None),
        text_signature = "($self, cell=0, stretches=None, *, edges=None, progress=None)"
    )]
    fn stretch_density<'py>(
        &self,
        py: Python<'py>,
        cell: Whole,
        stretches: Option<&Bound<'py, PyAny>>,
        edges: Option<&Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<typed::StretchDensity<'py>> {
        let cell: usize = cell.get("cell")?;
        let cells = self.with(|simulated| Ok(simulated.cells()))?;
        if cell >= cells {
            let text = format!("cell: expected a number below {cells}, got {cell}");
            return Err(PyIndexError::new_err(text));
        }
        let grid = StretchGrid::new(stretches, edges)?;
        let (stretches, found) = self.with(|simulated| {
            watched(progress, py, move |monitor| simulated.stretch_density(cell, grid, monitor))
        })?;
        values::stretches(py, stretches, found)
    }

    /// The whole state of the simulation, as bytes for `restore` in the same version of asperity.
    ///
    /// Returns
    /// -------
    /// bytes
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let (mut bytes, model) = (Vec::new(), self.heading.clone());
        let into = &mut bytes;
        self.with(|simulated| {
            let velocity = simulated.in_time().map(|moved| moved.velocity());
            write(&Heading { version, model, velocity, slide: self.slide().clone() }, into);
            detached(py, move || simulated.write_state(into));
            Ok(())
        })?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Restores a state of this simulation, or of another one of the same model; it continues from there bit for bit.
    ///
    /// Parameters
    /// ----------
    /// state
    ///     What `state` gave.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For the state of another model, or of another version of asperity.
    #[pyo3(signature = (state: "bytes"))]
    fn restore(&self, py: Python<'_>, state: &Bound<'_, PyAny>) -> PyResult<()> {
        let expected = "bytes that a simulation has saved";
        let state = state.cast::<PyBytes>().map_err(|_| error::wrong_type("state", expected, state))?;
        let mut rest = state.as_bytes();
        let Heading { version, model, velocity, slide } = read(&mut rest).map_err(error::core)?;
        if version != env!("CARGO_PKG_VERSION") {
            let expected = format!("one that asperity {} wrote", env!("CARGO_PKG_VERSION"));
            return Err(error::invalid("state", expected, format!("one of asperity {version}")));
        }
        if model != self.heading {
            return Err(error::invalid("state", "that of a simulation of the same model", "that of another"));
        }
        self.with(|simulated| {
            watched(None, py, |monitor| simulated.restore_state(rest, monitor))?;
            *self.slide() = slide;
            match simulated.in_time().zip(velocity) {
                Some((moved, velocity)) => moved.set_velocity(velocity).map_err(error::core),
                None => Ok(()),
            }
        })
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let name = self.model.bind(py).get_type().name()?.to_string();
        Ok(format!("<asperity.Simulation of {name} at drive={}>", self.drive()?))
    }
}

/// An iterator over the events of a simulation, each computed when it is asked for.
#[pyclass(frozen, module = "asperity")]
pub struct EventIterator {
    simulation: Py<Simulation>,
    /// The drive when the iterator was made, and the last drive.
    interval: (f64, f64),
}

#[pymethods]
impl EventIterator {
    fn __iter__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __next__<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.simulation.get().next_event(py, self.interval)
    }
}
