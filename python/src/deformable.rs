//! What deformable interfaces have in common: a drive of their load point.

use asperity::scenario::{Drive, Edges, Elasticity, MainShocks, Renormalisation, Scenario};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::argument::{Argument, Optional as _, Real, Whole};
use crate::contacts::Contacts;
use crate::convert;
use crate::description::Description;
use crate::law::Law;
use crate::plain::Plain;
use crate::plain::Surface;
use crate::result::{self, Result};
use crate::simulation::Simulation;
use crate::transport::{self, Step};
use crate::watch::{watched, watched_on};
use crate::{error, simulated, typed};

/// What the kinds of interfaces have in common: a drive of their load point.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
/// >>> chain = asp.Interface(contacts, [4], connection=1.0, neighbours=2.0)
/// >>> isinstance(chain, asp.Deformable)
/// True
#[pyclass(frozen, subclass, extends = Description, module = "asperity")]
pub struct Deformable;

#[pymethods]
impl Deformable {
    /// Plots the distributions of the contacts, as Contacts.plot, with that of their initial stretches.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Axes to plot on; new ones by default.
    /// **style
    ///     Arguments of the plot() of the axes.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///     The axes.
    ///
    /// Raises
    /// ------
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(signature = (ax: "Axes | None" = None, **style: "Any") -> "Axes")]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._plot")?.call_method("model", (slf, ax), style)
    }

    /// Drives the interface over distance, from event to event. X_T begins where the springs to the drive are in balance
    /// with the contacts: at 0 for relaxed ones, and for time-dependent ones with start="steady" in steady sliding at
    /// velocity.
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
    ///     The allowed error of the force of a cell per mean threshold and per stiffness, 1e-10 by default. Cells
    ///     that move in time have none by default, and errors of 1e-4 mean thresholds in a step; with a tolerance,
    ///     steps are shorter, and the error is estimated by a second motion.
    /// maps
    ///     A list of drives, in increasing order, at which the state of every cell is stored; for a chain it is also
    ///     stored at every point.
    /// catalogue_from
    ///     Events are recorded from this drive on.
    /// slip_rates
    ///     The largest number of steps in time at which the velocity of every cell is stored, as `slip_rate` of shape
    ///     (steps, cells) at `slip_rate_time`; None for none. Steps are short in events.
    /// main_shocks
    ///     The size and the window of main shocks of a Lattice, around which foreshocks and aftershocks are counted: the
    ///     smallest number of breaks, and the length of the window on each side in mean intervals between events; as the third
    ///     number the largest distance of epicentres in cells. None for no statistics.
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
    ///     For a distance or a velocity that is not above 0, no velocity for time-dependent contacts or cells with a
    ///     mass, main_shocks of an Interface, fewer than 2 points, a tolerance that is not from 1e-12 to 1e-2, maps that do not rise or lie beyond
    ///     the distance, a catalogue_from below 0, fewer than 2 slip_rates, or some for cells that do not move in
    ///     time, a number of threads out of its range, and more results than fit in memory.
    #[pyo3(
        signature = (
            distance = Real::new(20.0), points = Whole::new(2001), *, velocity = None, tolerance = None, maps: "ArrayLike | None" = None,
            catalogue_from = Real::new(0.0), slip_rates = None, main_shocks: "tuple[int, float] | tuple[int, float, int] | None" = None, progress: "_Progress" = None, threads = None
        ),
        text_signature = "($self, distance=20.0, points=2001, *, velocity=None, tolerance=None, maps=None, catalogue_from=0.0, slip_rates=None, main_shocks=None, progress=None, threads=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn drive(
        slf: &Bound<'_, Self>,
        distance: Real,
        points: Whole,
        velocity: Option<Real>,
        tolerance: Option<Real>,
        maps: Option<&Bound<'_, PyAny>>,
        catalogue_from: Real,
        slip_rates: Option<Whole>,
        main_shocks: Option<&Bound<'_, PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
        threads: Option<Whole>,
    ) -> PyResult<Py<Result>> {
        let catalogue_from = catalogue_from.get("catalogue_from")?;
        let velocity = velocity.get("velocity")?;
        let tolerance = tolerance.get("tolerance")?;
        let distance = distance.get("distance")?;
        let py = slf.py();
        let maps = maps.map_or(Ok(Vec::new()), |maps| convert::list("maps", maps))?;
        let points = points.get("points")?;
        let drive = Drive { distance: Some(distance), points, velocity, maps, ..Drive::default() };
        outcome(
            py,
            Self::plain(slf).scenario(drive),
            tolerance,
            (catalogue_from, slip_rates, main_shocks),
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
    /// tolerance, catalogue_from, slip_rates, main_shocks, progress, threads
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
        signature = (steps, *, tolerance = None, catalogue_from = Real::new(0.0), slip_rates = None, main_shocks: "tuple[int, float] | tuple[int, float, int] | None" = None, progress: "_Progress" = None, threads = None),
        text_signature = "($self, steps, *, tolerance=None, catalogue_from=0.0, slip_rates=None, main_shocks=None, progress=None, threads=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn follow(
        slf: &Bound<'_, Self>,
        steps: Argument<Vec<Bound<'_, Step>>>,
        tolerance: Option<Real>,
        catalogue_from: Real,
        slip_rates: Option<Whole>,
        main_shocks: Option<&Bound<'_, PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
        threads: Option<Whole>,
    ) -> PyResult<Py<Result>> {
        let steps = steps.get("steps")?;
        let tolerance = tolerance.get("tolerance")?;
        let catalogue_from = catalogue_from.get("catalogue_from")?;
        let mut protocol = transport::protocol(steps)?;
        let surface = Self::plain(slf);
        protocol.0[0].start = Some(surface.contacts.start);
        let scenario =
            Scenario { drive: None, protocol: Some(protocol), ..surface.scenario(Drive::default()) };
        let recorded = (catalogue_from, slip_rates, main_shocks);
        outcome(slf.py(), scenario, tolerance, recorded, (threads, progress))
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
    ///     As for drive, but the error is not estimated.
    ///
    /// Returns
    /// -------
    /// Simulation
    ///     A simulation that advances step by step, at X_T = 0; with start="steady", in balance at the velocity.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a velocity that is not above 0, none for time-dependent contacts or cells with a mass, and a tolerance
    ///     that is not from 1e-12 to 1e-2.
    #[pyo3(signature = (*, velocity = None, tolerance = None))]
    fn simulation(
        slf: &Bound<'_, Self>,
        velocity: Option<Real>,
        tolerance: Option<Real>,
    ) -> PyResult<Simulation> {
        let velocity = velocity.get("velocity")?;
        let tolerance = tolerance.get("tolerance")?;
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
    pub fn plain<'a>(interface: &'a Bound<'_, Self>) -> &'a Surface {
        match interface.as_super().get().plain() {
            Plain::Surface(surface) => surface,
            _ => unreachable!("an interface is described as one"),
        }
    }

    pub fn made(surface: Surface) -> PyResult<PyClassInitializer<Self>> {
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

/// The result of a scenario of an interface, with the given tolerance, events from a drive on, and so many slip rates.
fn outcome(
    py: Python<'_>,
    mut scenario: Scenario,
    tolerance: Option<f64>,
    (catalogue_from, slip_rates, main_shocks): (f64, Option<Whole>, Option<&Bound<'_, PyAny>>),
    (threads, progress): (Option<Whole>, Option<Bound<'_, PyAny>>),
) -> PyResult<Py<Result>> {
    scenario.master_equation.tolerance = tolerance;
    if let Some(own) = &mut scenario.interface {
        own.catalogue_from = catalogue_from;
        own.slip_rates = slip_rates.map(|steps| steps.get("slip_rates")).transpose()?;
        own.main_shocks = main_shocks.map(chosen).transpose()?;
    }
    let outcome = watched_on(threads, progress, py, |monitor| {
        scenario.build()?;
        asperity_runner::run(&scenario, monitor)
    })?;
    result::object(py, outcome)
}

/// The size and the window of main shocks, and the distance if it is given.
fn chosen(main_shocks: &Bound<'_, PyAny>) -> PyResult<MainShocks> {
    if let Ok((size, window)) = main_shocks.extract::<(u64, f64)>() {
        return Ok(MainShocks { size, window, distance: None });
    }
    let expected = "a tuple of a size, a window and, if wanted, a distance";
    let (size, window, distance) = main_shocks
        .extract::<(u64, f64, usize)>()
        .map_err(|_| error::wrong_type("main_shocks", expected, main_shocks))?;
    Ok(MainShocks { size, window, distance: Some(distance) })
}
