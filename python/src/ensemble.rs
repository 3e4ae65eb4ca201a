//! The ensemble: contacts drawn at random and followed one by one.

use asperity::ensemble::{self, Snapshots};
use asperity::master::MasterEquation;
use asperity::monitor::Monitor;
use asperity::record::{self, Quantity};
use asperity::scenario::{self, Units};
use asperity::task::Grid;
use pyo3::prelude::*;

use crate::argument::{Argument, Optional as _, Real, Whole};
use crate::contacts::Contacts;
use crate::convert::{self, Seed};
use crate::law::AnyLaw;
use crate::model::{Model, steady_interface};
use crate::pickle::{self, Reduced};
use crate::plain::Plain;
use crate::record::Record;
use crate::simulation::Simulation;
use crate::solver::{Solver, built};
use crate::transport::{self, Step};
use crate::watch::{watched, watched_on};
use crate::{error, typed};

/// Random contacts followed one by one (Monte Carlo): the earthquake-like model.
///
/// Parameters
/// ----------
/// contacts, initial, start
///     As for MasterEquation.
/// size
///     The number of simulated contacts; forces are scaled to the count of the contacts.
/// seed
///     A whole number below 2^63, which always gives the same numbers, on any number of threads, or a
///     numpy.random.Generator, from which one such number is drawn.
/// disorder
///     "annealed" if a contact that re-forms gets a new threshold, as in the master equation; "quenched" if it keeps
///     its own.
///
/// Raises
/// ------
/// ValueError
///     For distributions that leave no possible stretch for a contact.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> contacts = asp.Contacts(asp.Gaussian(1.0, 0.1))
/// >>> pull = asp.Ensemble(contacts, size=1000, seed=1).pull(distance=5.0, points=11)
/// >>> pull.force.shape
/// (11,)
/// >>> bool(abs(pull.force[1] - 0.5) < 1e-3)
/// True
#[pyclass(frozen, extends = Model, module = "asperity")]
pub struct Ensemble;

#[pymethods]
impl Ensemble {
    #[new]
    #[pyo3(
        signature = (
            contacts, initial = None, *, size = Whole::new(100_000), seed = Seed(1), disorder: "Literal['annealed', 'quenched']" = Argument::text("annealed"),
            start: "Literal['conditional', 'relaxed', 'steady']" = Argument::text("conditional")),
        text_signature = "(contacts, initial=None, *, size=100000, seed=1, disorder='annealed', start='conditional')"
    )]
    fn new(
        py: Python<'_>,
        contacts: Argument<Bound<'_, Contacts>>,
        initial: Option<Argument<AnyLaw>>,
        size: Whole,
        seed: Seed,
        disorder: Argument<String>,
        start: Argument<String>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let initial = initial.get("initial")?;
        let contacts = &contacts.get("contacts")?;
        let disorder = disorder.get("disorder")?;
        let start = start.get("start")?;
        let interface = steady_interface(contacts, initial, &start)?;
        let (size, disorder) = (size.get("size")?, convert::word("disorder", &disorder)?);
        let own = scenario::Ensemble { size: Some(size), seed: seed.0, disorder };
        let build = |monitor: &mut dyn Monitor| {
            let (contacts, initial) = built(&interface, monitor)?;
            own.build(contacts, initial)
        };
        let ensemble = watched(None, py, build)?;
        let plain = Plain::Ensemble(interface, own);
        Ok(Model::new(plain, Solver::Ensemble(ensemble)).add_subclass(Self))
    }

    /// The number of simulated contacts.
    #[getter]
    fn size(slf: &Bound<'_, Self>) -> usize {
        Self::plain(slf).size()
    }

    /// The seed of the random numbers.
    #[getter]
    fn seed(slf: &Bound<'_, Self>) -> u64 {
        Self::plain(slf).seed
    }

    /// The kind of disorder, "annealed" or "quenched".
    #[getter]
    fn disorder(slf: &Bound<'_, Self>) -> typed::DisorderWord {
        typed::DisorderWord(convert::disorder(Self::plain(slf).disorder))
    }

    /// Its events are the breaks of contacts; in time it has none.
    ///
    /// Parameters
    /// ----------
    /// velocity
    ///     The velocity of the slider in time, above 0; required for time-dependent contacts.
    ///
    /// Returns
    /// -------
    /// Simulation
    ///     A simulation of the contacts under a rigid slider that advances step by step, at X = 0.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For time-dependent contacts without a velocity.
    #[pyo3(signature = (*, velocity = None))]
    fn simulation(slf: &Bound<'_, Self>, velocity: Option<Real>) -> PyResult<Simulation> {
        let velocity = velocity.get("velocity")?;
        Model::simulation(slf.as_super(), velocity)
    }

    /// Displaces the slider's base from X = 0 to distance, from break to break.
    ///
    /// Parameters
    /// ----------
    /// distance, points, progress
    ///     As for MasterEquation.pull.
    /// velocity
    ///     The velocity of the slider, above 0; required only for time-dependent contacts.
    /// snapshots
    ///     A list of m positions, in increasing order, at which the stretches are counted.
    /// edges
    ///     A list of edges of the n bins of these counts, in increasing order; by default bins of equal width up to
    ///     where hardly any contact holds. Ctrl-C interrupts the computation.
    /// threads
    ///     The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default those of
    ///     the process, one per core or RAYON_NUM_THREADS.
    ///
    /// Returns
    /// -------
    /// EnsemblePull
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a distance or a velocity that is not above 0, no velocity for time-dependent contacts, fewer than 2
    ///     points, snapshots that do not rise or lie beyond the distance, edges below 0 or that do not rise, and a
    ///     number of threads out of its range.
    /// MemoryError
    ///     For results that do not fit.
    #[pyo3(
        signature = (
            distance = Real::new(20.0), points = Whole::new(2001), *, velocity = None, snapshots: "ArrayLike | None" = None, edges: "ArrayLike | None" = None,
            progress: "_Progress" = None, threads = None
        ),
        text_signature = "($self, distance=20.0, points=2001, *, velocity=None, snapshots=None, edges=None, progress=None, threads=None)"
    )]
    #[expect(clippy::too_many_arguments, reason = "they are named in Python")]
    fn pull(
        slf: Bound<'_, Self>,
        distance: Real,
        points: Whole,
        velocity: Option<Real>,
        snapshots: Option<&Bound<'_, PyAny>>,
        edges: Option<&Bound<'_, PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
        threads: Option<Whole>,
    ) -> PyResult<Py<EnsemblePull>> {
        let velocity = velocity.get("velocity")?;
        let distance = distance.get("distance")?;
        let py = slf.py();
        let snapshots = snapshots.map_or(Ok(Vec::new()), |at| convert::list("snapshots", at))?;
        let asked = scenario::Pull {
            distance,
            points: points.get("points")?,
            snapshots,
            velocity,
            ..scenario::Pull::default()
        };
        asked.check().map_err(|e| error::core(e.under("pull")))?;
        let ensemble = slf.as_super().get().ensemble();
        let edges = match edges {
            Some(edges) => convert::list("edges", edges)?,
            None => watched(None, py, |monitor| even_edges(ensemble, velocity, monitor))?,
        };
        let positions = asked.positions();
        let snapshots = Snapshots { positions: asked.snapshots, edges };
        let pull = watched_on(threads, progress, py, |monitor| match velocity {
            Some(velocity) => ensemble.pull_at_with(velocity, &positions, &snapshots, monitor),
            None => ensemble.pull_with(&positions, &snapshots, monitor),
        })?;
        let breaks = pull.breaks;
        let record = Record::new(py, columns(positions, snapshots, pull), Units::default())?;
        Py::new(py, record.add_subclass(EnsemblePull { ensemble: slf.unbind(), breaks }))
    }

    /// Follows the contacts from t = 0 through the steps, one after the other.
    ///
    /// Parameters
    /// ----------
    /// steps
    ///     A list of Step.
    /// progress
    ///     As for MasterEquation.pull. Ctrl-C interrupts the computation.
    ///
    /// Returns
    /// -------
    /// Record
    ///     A Record of variables of shape (n,), with n output points of all steps (steps share the point where they
    ///     meet): `time`, `position`, `force`, its standard error `force_error`, and `free`, the detached fraction:
    ///     contacts that are broken and have not yet re-formed. Where relative_normal_load varies also that variable, as
    ///     for Transport.follow.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For no steps, a relative_normal_load of the first step that is not 1, and for ageing by MeanField, which is not a rule for a single contact.
    #[pyo3(signature = (steps, *, progress: "_Progress" = None))]
    fn follow(
        slf: &Bound<'_, Self>,
        steps: Argument<Vec<Bound<'_, Step>>>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<Py<Record>> {
        let steps = steps.get("steps")?;
        let py = slf.py();
        let (motion, times) = transport::motion(steps)?;
        let ensemble = slf.as_super().get().ensemble();
        let follow = |monitor: &mut dyn Monitor| match motion.steps().next() {
            Some(_) => ensemble.follow_under_load(&motion, &times, monitor),
            None => ensemble.follow_with(motion.history(), &times, monitor),
        };
        let trace = watched(progress, py, follow)?;
        Py::new(py, Record::new(py, transport::followed(trace), Units::default())?)
    }
}

impl Ensemble {
    fn plain<'a>(ensemble: &'a Bound<'_, Self>) -> &'a scenario::Ensemble {
        match ensemble.as_super().as_super().get().plain() {
            Plain::Ensemble(_, own) => own,
            _ => unreachable!("an ensemble is described as an ensemble"),
        }
    }
}

/// Edges of even bins up to a stretch at which hardly any contact is attached.
fn even_edges(
    ensemble: &ensemble::Ensemble,
    velocity: Option<f64>,
    monitor: &mut dyn Monitor,
) -> asperity::Result<Vec<f64>> {
    let (contacts, initial) = (ensemble.contacts().clone(), ensemble.initial());
    let equation = match velocity {
        Some(velocity) => MasterEquation::at_with(contacts, initial, velocity, monitor)?,
        None => MasterEquation::new_with(contacts, initial, monitor)?,
    };
    Ok(Grid::new(&equation, initial, &[]).edges(ensemble.size()))
}

/// The results of a pull of the ensemble as columns; stretches only if there are snapshots.
fn columns(positions: Vec<f64>, snapshots: Snapshots, pull: ensemble::EnsemblePull) -> record::Record {
    let Snapshots { positions: at, edges } = snapshots;
    let density = (0..at.len()).flat_map(|i| pull.stretch_density(i..i + 1)).collect();
    let mut record = record::Record::default();
    let along = &["position"];
    record.push("position", "position X of the slider's base", Quantity::Length, along, positions);
    record.push("force", "friction force", Quantity::Force, along, pull.force);
    record.push("force_error", "its standard error", Quantity::Force, along, pull.error);
    if at.is_empty() {
        return record;
    }
    let centres = edges.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    record.push("snapshot", "position X of the snapshot", Quantity::Length, &["snapshot"], at);
    record.push("bin", "stretch at the middle of a bin", Quantity::Length, &["bin"], centres);
    record.push("edge", "edge of the bins", Quantity::Length, &["edge"], edges);
    let (words, along) = ("density of stretches", &["snapshot", "bin"]);
    record.push("stretch_density", words, Quantity::PerLength, along, density);
    record
}

/// A pull of an ensemble: the friction force with its standard error, and counts of the stretches.
///
/// Its variables are `position`, `force` and `force_error`; with snapshots also `snapshot` of shape (m,),
/// `edge` of shape (n + 1,), the middles `bin` of the bins, of shape (n,), and `stretch_density` of shape (m,
/// n), per length.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> pull = asp.Ensemble(asp.Contacts(asp.Gaussian(1.0, 0.1)), size=100, seed=1).pull(3.0, 31)
/// >>> pull.force.shape, pull.force_error.shape
/// ((31,), (31,))
#[pyclass(frozen, extends = Record, module = "asperity")]
pub struct EnsemblePull {
    ensemble: Py<Ensemble>,
    breaks: u64,
}

#[pymethods]
impl EnsemblePull {
    /// The ensemble that was pulled.
    #[getter]
    fn ensemble(&self, py: Python<'_>) -> Py<Ensemble> {
        self.ensemble.clone_ref(py)
    }

    /// The standard error of the force, shape (points,), from the variance between contacts; nan for one contact.
    #[getter]
    fn force_error<'py>(slf: &Bound<'py, Self>) -> PyResult<typed::Array<'py>> {
        slf.get_item("force_error").map(typed::Array)
    }

    /// The number of breaks up to the end, including those of a relaxed start at X = 0.
    #[getter]
    fn breaks(&self) -> u64 {
        self.breaks
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let (py, Self { ensemble, breaks }) = (slf.py(), slf.get());
        let bytes = slf.as_super().get().packed(py, breaks)?;
        pickle::reduced(py, "EnsemblePull", &bytes, Some(ensemble.bind(py).clone().into_any()))
    }
}

impl EnsemblePull {
    /// The pull of a pickle.
    pub fn restored(py: Python<'_>, bytes: &[u8], model: Option<Bound<'_, PyAny>>) -> PyResult<Py<PyAny>> {
        let ensemble = pickle::of_model::<Ensemble>(model, |_| true)?.unbind();
        let (breaks, record) = Record::unpacked(py, bytes)?;
        Ok(Py::new(py, record.add_subclass(Self { ensemble, breaks }))?.into_any())
    }
}
