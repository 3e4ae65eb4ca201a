//! Deformable interfaces: cells on an elastic slider, and contacts coupled one by one.

use asperity::scenario::{
    self, CellLoading, CellSlip, Disorder, Drive, Edges, Elasticity, PerCell, Renormalisation, Scales,
    Scenario, SlidingDirection,
};
use pyo3::IntoPyObjectExt as _;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::contacts::Contacts;
use crate::convert::{self, Real, Seed, Whole};
use crate::description::{Description, Plain};
use crate::law::{AnyLaw, Law, given};
use crate::model::{interface, interface_arguments, steady_interface};
use crate::result::{self, Result};
use crate::simulation::Simulation;
use crate::stretches::StretchGrid;
use crate::transport::{self, Step};
use crate::watch::{watched, watched_on};
use crate::{description, error, simulated, typed, values};

/// A deformable interface, and the initial state of its contacts.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Surface {
    pub contacts: description::Interface,
    pub own: scenario::Interface,
    pub ensemble: Option<scenario::Ensemble>,
}

impl Surface {
    /// The scenario of a drive.
    pub fn scenario(&self, drive: Drive) -> Scenario {
        let description::Interface { contacts, initial, start } = self.contacts.clone();
        Scenario {
            initial,
            drive: Some(Drive { start, ..drive }),
            interface: Some(self.own.clone()),
            ensemble: self.ensemble.clone(),
            ..Scenario::new(contacts)
        }
    }

    /// The scenario of first breaks.
    fn first_breaks(&self, asked: Renormalisation) -> Scenario {
        let description::Interface { contacts, initial, .. } = self.contacts.clone();
        Scenario {
            initial,
            renormalisation: Some(asked),
            interface: Some(self.own.clone()),
            ensemble: self.ensemble.clone(),
            ..Scenario::new(contacts)
        }
    }
}

/// What the kinds of interfaces have in common: a drive of their load point.
#[pyclass(frozen, subclass, extends = Description, module = "asperity")]
pub struct Deformable;

#[pymethods]
impl Deformable {
    /// Drives the interface from X_T = 0 over distance, from event to event; with start="steady" and time-dependent
    /// contacts from steady sliding at velocity, where X_T begins at the balance of the springs to the drive.
    ///
    /// Parameters
    /// ----------
    /// distance
    ///     The displacement of the drive, above 0.
    /// points
    ///     The number of points of the trace, including both ends.
    /// velocity
    ///     The velocity of the drive, above 0; required for time-dependent contacts and for cells with a mass.
    /// tolerance
    ///     The allowed error of the force of a cell per mean threshold and per stiffness, 1e-10 by default; for
    ///     time-dependent contacts also the allowed error of a step of a cell, per mean threshold, 1e-4 by default.
    /// maps
    ///     A list of drives, in increasing order, at which the state of every cell is stored; for a chain it is also
    ///     stored at every point.
    /// catalogue_from
    ///     Events are recorded from this drive on.
    /// slip_rates
    ///     The largest number of steps in time at which the velocity of every cell is stored, as `slip_rate` of shape
    ///     (steps, cells) at `slip_rate_time`; None for none. Steps are short in events.
    /// progress
    ///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
    /// threads
    ///     The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default those of
    ///     the process, one per core or RAYON_NUM_THREADS.
    ///
    /// Returns
    /// -------
    /// Result
    ///     The Result of the equivalent scenario: its `events` are the catalogue, and its `summary["catalogue"]`
    ///     describes the distributions of their sizes and intervals. run computes the same scenarios and can write
    ///     checkpoints.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For invalid values, or for more results than fit in memory.
    #[pyo3(
        signature = (
            distance = Real::new(20.0), points = Whole::new(2001), *, velocity = None, tolerance = None, maps: "ArrayLike | None" = None,
            catalogue_from = 0.0, slip_rates = None, progress: "_Progress" = None, threads = None
        ),
        text_signature = "($self, distance=20.0, points=2001, *, velocity=None, tolerance=None, maps=None, catalogue_from=0.0, slip_rates=None, progress=None, threads=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn drive(
        slf: &Bound<'_, Self>,
        distance: Real,
        points: Whole,
        velocity: Option<Real>,
        tolerance: Option<Real>,
        maps: Option<&Bound<'_, PyAny>>,
        catalogue_from: f64,
        slip_rates: Option<Whole>,
        progress: Option<Bound<'_, PyAny>>,
        threads: Option<Whole>,
    ) -> PyResult<Py<Result>> {
        let velocity = velocity.map(|number| number.get("velocity")).transpose()?;
        let tolerance = tolerance.map(|number| number.get("tolerance")).transpose()?;
        let distance = distance.get("distance")?;
        let py = slf.py();
        let maps = maps.map_or(Ok(Vec::new()), |maps| convert::list("maps", maps))?;
        let points = points.get("points")?;
        let drive = Drive { distance: Some(distance), points, velocity, maps, ..Drive::default() };
        outcome(
            py,
            Self::plain(slf).scenario(drive),
            tolerance,
            (catalogue_from, slip_rates),
            (threads, progress),
        )
    }

    /// Moves the load point from balance at t = 0 through the steps, one after the other: velocity steps and holds of an
    /// interface over time-dependent contacts.
    ///
    /// Parameters
    /// ----------
    /// steps
    ///     A list of Step. With start="steady" all cells slide steadily at the velocity of the first one.
    /// tolerance, catalogue_from, slip_rates, progress, threads
    ///     As for drive.
    ///
    /// Returns
    /// -------
    /// Result
    ///     The Result of the equivalent scenario, with the state of every cell of a chain at every point of the
    ///     trace, and of a lattice where steps begin and end.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For no steps, for time-independent contacts, and for more results than fit in memory.
    #[pyo3(
        signature = (steps, *, tolerance = None, catalogue_from = 0.0, slip_rates = None, progress: "_Progress" = None, threads = None),
        text_signature = "($self, steps, *, tolerance=None, catalogue_from=0.0, slip_rates=None, progress=None, threads=None)"
    )]
    fn follow(
        slf: &Bound<'_, Self>,
        steps: Vec<Bound<'_, Step>>,
        tolerance: Option<f64>,
        catalogue_from: f64,
        slip_rates: Option<Whole>,
        progress: Option<Bound<'_, PyAny>>,
        threads: Option<Whole>,
    ) -> PyResult<Py<Result>> {
        let mut protocol = transport::protocol(steps)?;
        let surface = Self::plain(slf);
        protocol.0[0].start = Some(surface.contacts.start);
        let scenario =
            Scenario { drive: None, protocol: Some(protocol), ..surface.scenario(Drive::default()) };
        outcome(slf.py(), scenario, tolerance, (catalogue_from, slip_rates), (threads, progress))
    }

    /// The distribution of the drives at which contacts break for the first time: what renormalisation calls.
    #[pyo3(signature = (runs, points, *, progress: "_Progress" = None))]
    fn _first_breaks(
        slf: &Bound<'_, Self>,
        runs: Whole,
        points: Whole,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<Result>> {
        let asked = Renormalisation { runs: runs.get("runs")?, points: points.get("points")? };
        let scenario = Self::plain(slf).first_breaks(asked);
        let outcome = watched(progress, slf.py(), |monitor| {
            scenario.build()?;
            asperity_runner::run(&scenario, monitor)
        })?;
        result::object(slf.py(), outcome)
    }

    /// Parameters
    /// ----------
    /// velocity, tolerance
    ///     As for drive.
    ///
    /// Returns
    /// -------
    /// Simulation
    ///     A simulation that advances step by step, at X_T = 0; with start="steady", in balance at the velocity.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For invalid values.
    #[pyo3(signature = (*, velocity = None, tolerance = None))]
    fn simulation(
        slf: &Bound<'_, Self>,
        velocity: Option<f64>,
        tolerance: Option<f64>,
    ) -> PyResult<Simulation> {
        let surface = Self::plain(slf);
        let simulated =
            watched(None, slf.py(), |monitor| simulated::interface(surface, velocity, tolerance, monitor))?;
        let shape = surface.own.cells.clone();
        Simulation::new(slf.as_super(), (velocity, tolerance), shape, simulated)
    }

    /// The contacts.
    #[getter]
    fn contacts<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Contacts>> {
        Plain::Contacts(Self::plain(slf).contacts.contacts.clone()).instance(slf.py())
    }

    /// The distribution Q_ini of the stretches of all contacts at X_T = 0.
    #[getter]
    fn initial<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, Law>> {
        Plain::Law(Self::plain(slf).contacts.initial.clone()).instance(slf.py())
    }

    /// The kind of the initial state, "conditional", "relaxed" or "steady".
    #[getter]
    fn start(slf: &Bound<'_, Self>) -> typed::StartWord {
        typed::StartWord(convert::start(Self::plain(slf).contacts.start))
    }

    /// K_0, the stiffness of the spring between a cell, or a contact, and the drive.
    #[getter]
    fn connection(slf: &Bound<'_, Self>) -> f64 {
        Self::plain(slf).own.connection
    }

    /// K_int, the stiffness of the spring between two neighbours; None on a half-space.
    #[getter]
    fn neighbours(slf: &Bound<'_, Self>) -> Option<f64> {
        match Self::plain(slf).own.coupling {
            Elasticity::Neighbours { stiffness } => Some(stiffness),
            _ => None,
        }
    }

    /// The edges, "open" or "periodic".
    #[getter]
    fn edges(slf: &Bound<'_, Self>) -> typed::EdgesWord {
        typed::EdgesWord(if Self::plain(slf).own.edges == Edges::Periodic { "periodic" } else { "open" })
    }

    /// The seed of the random numbers.
    #[getter]
    fn seed(slf: &Bound<'_, Self>) -> u64 {
        let Surface { own, ensemble, .. } = Self::plain(slf);
        let of_cells = own.disorder.as_ref().and_then(|scales| scales.seed);
        ensemble.as_ref().map(|ensemble| ensemble.seed).or(of_cells).unwrap_or(1)
    }

    /// The length of a chain, or rows and columns of a lattice.
    #[getter]
    fn cells(slf: &Bound<'_, Self>) -> Vec<usize> {
        Self::plain(slf).own.cells.clone()
    }
}

impl Deformable {
    fn plain<'a>(interface: &'a Bound<'_, Self>) -> &'a Surface {
        match interface.as_super().get().plain() {
            Plain::Surface(surface) => surface,
            _ => unreachable!("an interface is described as one"),
        }
    }

    fn made(surface: Surface) -> PyResult<PyClassInitializer<Self>> {
        let background = surface.contacts.contacts.background().map_err(error::core)?;
        if background > 0.0 {
            let expected =
                "none under an interface, whose forces are those of the contacts (a scenario adds it)";
            return Err(error::invalid("contacts.background_force", expected, background));
        }
        // The drive is set later.
        surface.scenario(Drive { velocity: Some(1.0), ..Drive::default() }).build().map_err(error::core)?;
        Ok(Description::new(Plain::Surface(Box::new(surface))).add_subclass(Self))
    }
}

/// A deformable slider (Burridge–Knopoff, or on a half-space): elastically coupled cells of contacts, each
/// connected to the drive by a spring. The contacts of a cell move together.
///
/// Parameters
/// ----------
/// contacts
///     The contacts of a cell.
/// cells
///     The length of a chain, such as [1000], or rows and columns, such as [512, 512].
/// initial, start
///     As for MasterEquation; start="steady" holds for time-dependent contacts too, at the velocity of the drive,
///     unless they have a size.
/// connection
///     K_0, the stiffness of the spring between a cell and the drive.
/// neighbours
///     K_int, the stiffness of the spring between two neighbours.
/// half_space
///     The shear modulus of a half-space and the side of a cell, instead of neighbours.
/// poisson_ratio
///     Poisson's ratio ν of the half-space, from -0.9 to 0.48; 0 where its modulus is an effective one.
/// sliding
///     The direction of sliding on a half-space, along which one with ν > 0 is stiffer: along the "columns", from row to
///     row and along a chain, or along the "rows".
/// edges
///     "open" or "periodic".
/// loading
///     "uniform", or "edge" if the drive pulls only the first cell or row.
/// slip
///     The slip rule: "reset" (the default), by which all contacts of an unstable cell break and re-form, or
///     "overdamped"; None for cells with a mass.
/// viscosity
///     The drag on a moving cell, force per velocity; with it events have durations. Time-dependent contacts require
///     it, with slip="overdamped", or a mass: η dX_j/dt = K_0 (X_T - X_j) - (AX)_j - F_j; a cell then slips while it
///     is more than ten times as fast as the drive.
/// mass
///     The mass M of a cell. Cells then follow M d²X_j/dt² + η dX_j/dt = K_0 (X_T - X_j) - (AX)_j - F_j at the
///     velocity of the drive, and disturbances travel as waves. Athermal contacts are loaded and unloaded; a cell over
///     time-dependent contacts that would go back stands.
/// disorder
///     The standard deviation of the scale factors of cells, which multiply all lengths of their contacts and are
///     drawn from a Gaussian distribution of mean 1 with the seed; or a list of the scale factors.
/// seed
///     The seed of these scale factors and of single contacts.
/// drive_tolerance
///     The accuracy of the drive at which equilibrium is lost, in mean thresholds; not used for time-dependent
///     contacts.
/// size
///     None for cells of many contacts, which follow the master equation; or the number of contacts in each cell,
///     which are drawn with the seed and followed one by one, with slip="overdamped".
/// quenched
///     Whether these keep their thresholds.
///
/// Raises
/// ------
/// ValueError
///     For invalid values.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
/// >>> chain = asp.Interface(contacts, [16], connection=0.5, neighbours=1.0)
/// >>> len(chain.drive(distance=3.0).events) > 0
/// True
#[pyclass(frozen, extends = Deformable, module = "asperity")]
pub struct Interface;

#[pymethods]
impl Interface {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    #[pyo3(
        signature = (
            contacts, cells, initial = None, *, connection, neighbours = None, half_space = None, poisson_ratio = 0.0, sliding: "Literal['columns', 'rows']" = "columns", edges: "Literal['open', 'periodic']" = "open",
            loading: "Literal['uniform', 'edge']" = "uniform", slip: "Literal['reset', 'overdamped'] | None" = None, viscosity = None, mass = None, disorder: "_Number | ArrayLike | None" = None, seed = Seed(1),
            drive_tolerance = 1e-6, size = None, quenched = false, start: "Literal['conditional', 'relaxed', 'steady']" = "conditional"
        ),
        text_signature = "(contacts, cells, initial=None, *, connection, neighbours=None, half_space=None, poisson_ratio=0.0, sliding='columns', edges='open', loading='uniform', slip=None, viscosity=None, mass=None, disorder=None, seed=1, drive_tolerance=1e-6, size=None, quenched=False, start='conditional')"
    )]
    fn new(
        contacts: &Bound<'_, Contacts>,
        cells: Vec<usize>,
        initial: Option<AnyLaw>,
        connection: Real,
        neighbours: Option<f64>,
        half_space: Option<(f64, f64)>,
        poisson_ratio: f64,
        sliding: &str,
        edges: &str,
        loading: &str,
        slip: Option<&str>,
        viscosity: Option<f64>,
        mass: Option<f64>,
        disorder: Option<&Bound<'_, PyAny>>,
        seed: Seed,
        drive_tolerance: f64,
        size: Option<Whole>,
        quenched: bool,
        start: &str,
    ) -> PyResult<PyClassInitializer<Self>> {
        let connection = connection.get("connection")?;
        let sliding = convert::word("sliding", sliding)?;
        let coupling = match (neighbours, half_space) {
            (Some(stiffness), None) if poisson_ratio == 0.0 && sliding == SlidingDirection::default() => {
                Elasticity::Neighbours { stiffness }
            }
            (Some(_), None) => {
                let expected = "half_space beside poisson_ratio and sliding, which are those of a half-space";
                return Err(error::invalid("neighbours", expected, "neighbours"));
            }
            (None, Some((modulus, cell))) => Elasticity::HalfSpace { modulus, cell, poisson_ratio, sliding },
            (both, _) => {
                let found = if both.is_some() { "both" } else { "neither" };
                return Err(error::invalid("neighbours", "either neighbours or half_space", found));
            }
        };
        let own = scenario::Interface {
            cells,
            contacts: PerCell::Many,
            connection,
            coupling,
            edges: convert::word("edges", edges)?,
            loading: convert::word("loading", loading)?,
            slip: slip
                .or(mass.is_none().then_some("reset"))
                .map(|slip| convert::word("slip", slip))
                .transpose()?,
            mass,
            viscosity,
            disorder: disorder.map(|disorder| scales(disorder, seed.0)).transpose()?,
            drive_tolerance,
            catalogue_from: 0.0,
            slip_rates: None,
        };
        let size = size.map(|size| size.get("size")).transpose()?;
        let ensemble = few(size, seed.0, quenched)?;
        let surface = Surface { contacts: steady_interface(contacts, initial, start)?, own, ensemble };
        Ok(Deformable::made(surface)?.add_subclass(Self))
    }

    /// The shear modulus of a half-space and the side of a cell, or None.
    #[getter]
    fn half_space(slf: &Bound<'_, Self>) -> Option<(f64, f64)> {
        match Deformable::plain(slf.as_super()).own.coupling {
            Elasticity::HalfSpace { modulus, cell, .. } => Some((modulus, cell)),
            _ => None,
        }
    }

    /// Poisson's ratio ν of a half-space; 0 if it has none.
    #[getter]
    fn poisson_ratio(slf: &Bound<'_, Self>) -> f64 {
        match Deformable::plain(slf.as_super()).own.coupling {
            Elasticity::HalfSpace { poisson_ratio, .. } => poisson_ratio,
            _ => 0.0,
        }
    }

    /// The direction of sliding, "columns" or "rows", which counts on a half-space.
    #[getter]
    fn sliding(slf: &Bound<'_, Self>) -> typed::SlidingDirectionWord {
        let own = &Deformable::plain(slf.as_super()).own;
        let rows = matches!(own.coupling, Elasticity::HalfSpace { sliding: SlidingDirection::Rows, .. });
        typed::SlidingDirectionWord(if rows { "rows" } else { "columns" })
    }

    /// The loading, "uniform" or "edge".
    #[getter]
    fn loading(slf: &Bound<'_, Self>) -> typed::LoadingWord {
        let edge = Deformable::plain(slf.as_super()).own.loading == CellLoading::Edge;
        typed::LoadingWord(if edge { "edge" } else { "uniform" })
    }

    /// The slip rule, "reset" or "overdamped"; None for cells with a mass.
    #[getter]
    fn slip(slf: &Bound<'_, Self>) -> Option<typed::CellSlipWord> {
        let own = &Deformable::plain(slf.as_super()).own;
        let word = |slip| if slip == CellSlip::Overdamped { "overdamped" } else { "reset" };
        own.slip.map(|slip| typed::CellSlipWord(word(slip)))
    }

    /// The mass of a cell, or None.
    #[getter]
    fn mass(slf: &Bound<'_, Self>) -> Option<f64> {
        Deformable::plain(slf.as_super()).own.mass
    }

    /// The speed of long waves between neighbours, sqrt(K_int/M), in cells per time; None without a mass and on a
    /// half-space.
    #[getter]
    fn wave_speed(slf: &Bound<'_, Self>) -> Option<f64> {
        Deformable::plain(slf.as_super()).own.wave_speed()
    }

    /// The drag on a moving cell, force per velocity, or None.
    #[getter]
    fn viscosity(slf: &Bound<'_, Self>) -> Option<f64> {
        Deformable::plain(slf.as_super()).own.viscosity
    }

    /// The standard deviation of the scale factors of cells, or these, shape (n,); None if there are none.
    #[getter]
    fn disorder<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<typed::NumberOrArray<'py>>> {
        let Some(scales) = &Deformable::plain(slf.as_super()).own.disorder else { return Ok(None) };
        let found = match (&scales.scale, scales.std) {
            (Some(scale), _) => convert::row(slf.py(), scale.clone())?,
            (None, std) => std.into_bound_py_any(slf.py())?,
        };
        Ok(Some(typed::NumberOrArray(found)))
    }

    /// The accuracy of the drive at which equilibrium is lost, in mean thresholds.
    #[getter]
    fn drive_tolerance(slf: &Bound<'_, Self>) -> f64 {
        Deformable::plain(slf.as_super()).own.drive_tolerance
    }

    /// The number of contacts in each cell where they are followed one by one, or None.
    #[getter]
    fn size(slf: &Bound<'_, Self>) -> Option<usize> {
        Deformable::plain(slf.as_super()).ensemble.as_ref().and_then(|ensemble| ensemble.size)
    }

    /// Whether these keep their thresholds.
    #[getter]
    fn quenched(slf: &Bound<'_, Self>) -> bool {
        let ensemble = Deformable::plain(slf.as_super()).ensemble.as_ref();
        ensemble.is_some_and(|ensemble| ensemble.disorder == Disorder::Quenched)
    }

    /// The distribution of the stretches of the contacts of a cell, per length, after the interface has been driven
    /// from X_T = 0.
    ///
    /// The result has `stretch` and `density` of shape (n,), and `atoms`, the point masses. Detached contacts are
    /// not counted. Without bins each of the few contacts of a cell with a size is an atom.
    ///
    /// Parameters
    /// ----------
    /// cell
    ///     Its number, counted row by row.
    /// stretches
    ///     A list of n stretches.
    /// at
    ///     The drive, 0 or above.
    /// velocity
    ///     The velocity of the drive, for time-dependent contacts.
    /// edges
    ///     Instead of stretches, edges of n bins, n + 1 increasing numbers; only for time-dependent contacts and for
    ///     cells with a size. The density is then the mean in each bin, and `stretch` its middle.
    /// progress
    ///     As for MasterEquation.pull.
    ///
    /// Returns
    /// -------
    /// StretchDensity
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a cell that does not exist, and for invalid values.
    #[pyo3(
        signature = (cell, stretches: "ArrayLike | None" = None, *, at, velocity = None, edges: "ArrayLike | None" = None, progress: "_Progress" = None),
        text_signature = "($self, cell, stretches=None, *, at, velocity=None, edges=None, progress=None)"
    )]
    fn stretch_density<'py>(
        slf: &Bound<'py, Self>,
        cell: Whole,
        stretches: Option<&Bound<'py, PyAny>>,
        at: f64,
        velocity: Option<f64>,
        edges: Option<&Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<typed::StretchDensity<'py>> {
        let py = slf.py();
        let (cell, grid) = (cell.get("cell")?, StretchGrid::new(stretches, edges)?);
        if matches!(grid, StretchGrid::Default) {
            return Err(error::invalid("stretches", "either stretches or edges", "neither"));
        }
        if !(at.is_finite() && at >= 0.0) {
            return Err(error::invalid("at", "a finite drive, 0 or above", at));
        }
        let surface = Deformable::plain(slf.as_super());
        let (stretches, found) = watched(progress, py, |monitor| {
            let mut simulated = simulated::unrelaxed_interface(surface, velocity, None, monitor)?;
            simulated.advance(at, monitor)?;
            simulated.stretch_density(cell, grid, monitor)
        })?;
        values::stretches(py, stretches, found)
    }
}

/// The result of a scenario of an interface, with the given tolerance, events from a drive on, and so many slip rates.
fn outcome(
    py: Python<'_>,
    mut scenario: Scenario,
    tolerance: Option<f64>,
    (catalogue_from, slip_rates): (f64, Option<Whole>),
    (threads, progress): (Option<Whole>, Option<Bound<'_, PyAny>>),
) -> PyResult<Py<Result>> {
    scenario.master_equation.tolerance = tolerance;
    if let Some(own) = &mut scenario.interface {
        own.catalogue_from = catalogue_from;
        own.slip_rates = slip_rates.map(|steps| steps.get("slip_rates")).transpose()?;
    }
    let outcome = watched_on(threads, progress, py, |monitor| {
        scenario.build()?;
        asperity_runner::run(&scenario, monitor)
    })?;
    result::object(py, outcome)
}

/// The ensemble of contacts, if their number is given.
fn few(size: Option<usize>, seed: u64, quenched: bool) -> PyResult<Option<scenario::Ensemble>> {
    if size.is_none() && quenched {
        let expected = "False without a size: contacts that follow the master equation are annealed";
        return Err(error::invalid("quenched", expected, "True"));
    }
    let disorder = if quenched { Disorder::Quenched } else { Disorder::Annealed };
    Ok(size.map(|size| scenario::Ensemble { size: Some(size), seed, disorder }))
}

/// A standard deviation, or the scale factors themselves.
fn scales(disorder: &Bound<'_, PyAny>, seed: u64) -> PyResult<Scales> {
    if let Ok(std) = disorder.extract::<f64>() {
        return Ok(Scales { std: Some(std), seed: Some(seed), ..Scales::default() });
    }
    Ok(Scales { scale: Some(convert::list("disorder", disorder)?), ..Scales::default() })
}

/// Contacts coupled one by one, which re-form after the slip event: the cellular automaton of Olami, Feder and
/// Christensen, for any distribution of thresholds.
///
/// Parameters
/// ----------
/// contacts
///     The distributions of the contacts; their count is the total number that all cells represent.
/// cells
///     The length of a chain, or rows and columns.
/// initial, start
///     As for Ensemble.
/// neighbours
///     The stiffness of the spring between two neighbours.
/// connection
///     The stiffness of the spring to the drive. A neighbour gains the fraction neighbours/(z neighbours +
///     connection) of the force that a breaking contact releases, with z = 4, or 2 on a chain.
/// edges
///     "open" or "periodic".
/// seed, disorder
///     As for Ensemble.
///
/// Raises
/// ------
/// ValueError
///     For invalid values.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> lattice = asp.Lattice(asp.Contacts(asp.Gaussian(1.0, 0.1)), [16, 16], neighbours=0.2, connection=0.2)
/// >>> len(lattice.drive(distance=3.0).events) > 0
/// True
#[pyclass(frozen, extends = Deformable, module = "asperity")]
pub struct Lattice;

#[pymethods]
impl Lattice {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    #[pyo3(
        signature = (
            contacts, cells, initial = None, *, neighbours, connection, edges: "Literal['open', 'periodic']" = "open", seed = Seed(1),
            disorder: "Literal['annealed', 'quenched']" = "annealed", start: "Literal['conditional', 'relaxed']" = "conditional"
        ),
        text_signature = "(contacts, cells, initial=None, *, neighbours, connection, edges='open', seed=1, disorder='annealed', start='conditional')"
    )]
    fn new(
        contacts: &Bound<'_, Contacts>,
        cells: Vec<usize>,
        initial: Option<AnyLaw>,
        neighbours: f64,
        connection: Real,
        edges: &str,
        seed: Seed,
        disorder: &str,
        start: &str,
    ) -> PyResult<PyClassInitializer<Self>> {
        let connection = connection.get("connection")?;
        let own = scenario::Interface {
            cells,
            contacts: PerCell::One,
            connection,
            coupling: Elasticity::Neighbours { stiffness: neighbours },
            edges: convert::word("edges", edges)?,
            loading: CellLoading::Uniform,
            slip: None,
            viscosity: None,
            mass: None,
            disorder: None,
            drive_tolerance: scenario::Interface::DRIVE_TOLERANCE,
            catalogue_from: 0.0,
            slip_rates: None,
        };
        let disorder = convert::word("disorder", disorder)?;
        let ensemble = Some(scenario::Ensemble { size: None, seed: seed.0, disorder });
        let surface = Surface { contacts: interface(contacts, initial, start)?, own, ensemble };
        Ok(Deformable::made(surface)?.add_subclass(Self))
    }

    /// The kind of disorder, "annealed" or "quenched".
    #[getter]
    fn disorder(slf: &Bound<'_, Self>) -> typed::DisorderWord {
        let ensemble = Deformable::plain(slf.as_super()).ensemble.as_ref();
        typed::DisorderWord(convert::disorder(ensemble.map_or(Disorder::Annealed, |own| own.disorder)))
    }
}

/// The class of an interface.
pub fn class<'py>(surface: &Surface, py: Python<'py>) -> Bound<'py, pyo3::types::PyType> {
    match surface.own.contacts {
        PerCell::Many => py.get_type::<Interface>(),
        PerCell::One => py.get_type::<Lattice>(),
    }
}

/// The arguments that create an interface.
pub fn arguments(surface: &Surface, into: &Bound<'_, PyDict>) -> PyResult<()> {
    let Surface { contacts, own, ensemble } = surface;
    interface_arguments(contacts, into)?;
    into.set_item("cells", own.cells.clone())?;
    into.set_item("connection", own.connection)?;
    match own.coupling {
        Elasticity::Neighbours { stiffness } => into.set_item("neighbours", stiffness)?,
        Elasticity::HalfSpace { modulus, cell, poisson_ratio, sliding } => {
            into.set_item("half_space", (modulus, cell))?;
            given(into, "poisson_ratio", (poisson_ratio != 0.0).then_some(poisson_ratio))?;
            given(into, "sliding", (sliding == SlidingDirection::Rows).then_some("rows"))?;
        }
        _ => unreachable!("a coupling that no argument makes"),
    }
    given(into, "edges", (own.edges == Edges::Periodic).then_some("periodic"))?;
    given(into, "loading", (own.loading == CellLoading::Edge).then_some("edge"))?;
    given(into, "slip", (own.slip == Some(CellSlip::Overdamped)).then_some("overdamped"))?;
    given(into, "viscosity", own.viscosity)?;
    given(into, "mass", own.mass)?;
    let tolerance = own.drive_tolerance;
    given(into, "drive_tolerance", (tolerance != scenario::Interface::DRIVE_TOLERANCE).then_some(tolerance))?;
    if let Some(scales) = &own.disorder {
        given(into, "disorder", scales.std)?;
        given(into, "disorder", scales.scale.clone())?;
        given(into, "seed", scales.seed.filter(|&seed| seed != 1))?;
    }
    let Some(ensemble) = ensemble else { return Ok(()) };
    given(into, "seed", Some(ensemble.seed).filter(|&seed| seed != 1))?;
    let quenched = ensemble.disorder == Disorder::Quenched;
    if ensemble.size.is_some() {
        given(into, "size", ensemble.size)?;
        return given(into, "quenched", quenched.then_some(true));
    }
    given(into, "disorder", quenched.then(|| convert::disorder(ensemble.disorder)))
}
