//! Parameter sweeps for `asperity.sweep`: the plan, the store of the command, and the finished data set.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use std::{fmt, ops, thread};

use asperity::monitor::Monitor;
use asperity::{Error, Result};
use asperity_runner::checkpoint::Lock;
use asperity_runner::sweep::{
    self, Axis, Batch, Case, Dataset, Gathered, Identity, Kept, Labelled, Plan, Store, Value, Values,
};
use asperity_runner::{memory, output};
use numpy::IntoPyArray as _;
use pyo3::exceptions::{PyFileExistsError, PyMemoryError, PyOSError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use rayon::ThreadPoolBuilder;

use crate::argument::{Argument, Optional as _};
use crate::record::attributes;
use crate::result::{Text, assignments, parsed};
use crate::watch::{detached, watched};
use crate::{error, typed};

/// Text of a scenario, its name in messages, the folder of its files, and overrides.
type Specification = (String, String, PathBuf, Vec<String>);

/// Time between two looks at signals and progress.
const PERIOD: Duration = Duration::from_millis(20);

/// A sweep of `asperity.sweep`: its cases, and those that are there.
#[pyclass(frozen, name = "_Sweep", module = "asperity._core")]
pub struct Sweep {
    kind: Kind,
    folder: Option<PathBuf>,
    state: Mutex<State>,
}

/// What is swept.
enum Kind {
    Scenario(Box<Plan>, Specification),
    /// A function of the user, with the axes of its arguments.
    Function(Identity, Vec<Axis>),
}

impl Kind {
    /// Numbers of places of the grids of curves.
    fn places(&self) -> Vec<usize> {
        match self {
            Self::Scenario(plan, _) => plan.places(),
            Self::Function(..) => Vec::new(),
        }
    }
}

struct State {
    gathered: Gathered,
    store: Option<Store>,
    /// Cases of a function that are not stored yet.
    waiting: Vec<Case>,
    _lock: Option<Lock>,
}

impl Sweep {
    fn new(kind: Kind, folder: Option<PathBuf>, retry: bool) -> PyResult<Self> {
        let identity = match &kind {
            Kind::Scenario(plan, _) => plan.identity(),
            Kind::Function(identity, _) => identity.clone(),
        };
        let places = kind.places();
        let needed = places.iter().map(|&places| (places * identity.cases * size_of::<f64>()) as u64).sum();
        let free = memory::available();
        if needed > free {
            let [needed, free] = [needed, free].map(memory::words);
            return Err(PyMemoryError::new_err(format!(
                "sweep.keep: expected curves that fit in the {free} of memory available, got {needed}; asperity sweep writes them to a file"
            )));
        }
        let Some(directory) = &folder else {
            let gathered = Gathered::new(identity.cases, &places);
            let state = State { gathered, store: None, waiting: Vec::new(), _lock: None };
            return Ok(Self { kind, folder, state: Mutex::new(state) });
        };
        output::check(directory).map_err(error::files)?;
        let mut store = Store::new(directory, identity);
        let lock = store.lock(None).map_err(failed)?;
        let mut gathered = store.gathered(&places, u64::MAX).map_err(failed)?;
        if retry {
            gathered.forget_failures();
        }
        let state = State { gathered, store: Some(store), waiting: Vec::new(), _lock: Some(lock) };
        Ok(Self { kind, folder, state: Mutex::new(state) })
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[pymethods]
impl Sweep {
    /// The sweep of a scenario with a table sweep. Its corners are checked.
    #[staticmethod]
    #[pyo3(signature = (
        scenario: "str | PathLike[str] | Mapping[str, Any]", overrides: "Mapping[str, Any] | None", folder, retry
    ))]
    fn of_scenario(
        scenario: &Bound<'_, PyAny>,
        overrides: Option<&Bound<'_, PyAny>>,
        folder: Option<Argument<PathBuf>>,
        retry: bool,
    ) -> PyResult<Self> {
        let overrides = overrides.map(assignments).transpose()?.unwrap_or_default();
        let Text { text, name, folder: relative } = Text::of(scenario)?;
        let input = parsed(scenario.py(), (&text, &name, &relative, &overrides))?;
        let plan = Plan::new(&input).map_err(|e| error::scenario(&e))?;
        let relative =
            std::path::absolute(if relative.as_os_str().is_empty() { ".".into() } else { relative })?;
        let specification = (text, name, relative, overrides);
        Self::new(Kind::Scenario(Box::new(plan), specification), folder.get("folder")?, retry)
    }

    /// The sweep of a function over arguments with these values; `hash` and `text` identify it in a folder.
    #[staticmethod]
    #[pyo3(signature = (
        hash, text, axes: "Sequence[tuple[str, Sequence[float] | Sequence[str]]]", folder, retry
    ))]
    fn of_function(
        hash: String,
        text: String,
        axes: Vec<(String, Bound<'_, PyAny>)>,
        folder: Option<Argument<PathBuf>>,
        retry: bool,
    ) -> PyResult<Self> {
        let axes: Vec<Axis> =
            axes.into_iter().map(|(name, values)| argument(name, &values)).collect::<PyResult<_>>()?;
        let cases = axes.iter().map(|axis| axis.length).product();
        Self::new(Kind::Function(Identity { hash, text, cases }, axes), folder.get("folder")?, retry)
    }

    /// The number of cases.
    #[getter]
    fn cases(&self) -> usize {
        self.state().gathered.there.len()
    }

    /// What a worker needs to compute cases.
    #[getter]
    fn specification(&self) -> Option<Specification> {
        match &self.kind {
            Kind::Scenario(_, specification) => Some(specification.clone()),
            Kind::Function(..) => None,
        }
    }

    /// The numbers of the cases that are not there.
    fn missing(&self) -> Vec<usize> {
        missing(&self.state().gathered)
    }

    /// Computes the missing cases of a scenario in this process.
    #[pyo3(signature = (threads, *, progress: "_Progress" = None))]
    fn compute(
        &self,
        py: Python<'_>,
        threads: Option<usize>,
        progress: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let Kind::Scenario(plan, _) = &self.kind else {
            return Err(PyValueError::new_err("a function is computed in Python"));
        };
        let done = watched(progress, py, |monitor| {
            let done = match threads {
                None => self.work(plan, monitor),
                Some(threads) => on_threads(threads, monitor, |monitor| self.work(plan, monitor))?,
            };
            match done {
                Err(sweep::Error::Stopped(error)) => Err(error),
                other => Ok(other),
            }
        })?;
        done.map_err(failed)
    }

    /// Adds the cases that a worker has computed.
    fn add(&self, py: Python<'_>, cases: &[u8]) -> PyResult<()> {
        let batch = Batch::decode(cases).map_err(PyValueError::new_err)?;
        detached(py, || self.put(&batch)).map_err(failed)
    }

    /// Adds a case of a function: the values that it has found by their names, or why it failed. It is stored with `flush`.
    #[pyo3(signature = (number, found: "Mapping[str, float | str] | None", failure: "str | None", *, flush))]
    fn add_case(
        &self,
        number: usize,
        found: Option<&Bound<'_, PyDict>>,
        failure: Option<String>,
        flush: bool,
    ) -> PyResult<()> {
        let entry = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| -> PyResult<(String, Value)> {
            let value = match value.extract::<String>() {
                Ok(word) => Value::Word(word),
                Err(_) => Value::Number(value.extract()?),
            };
            Ok((name.extract()?, value))
        };
        let entries =
            found.map_or(Ok(Vec::new()), |found| found.iter().map(entry).collect::<PyResult<_>>())?;
        let kept = failure.map_or(Ok(Kept { entries, curves: Vec::new() }), Err);
        let mut state = self.state();
        state.waiting.push(Case { number, kept });
        drop(state);
        if flush { self.flush() } else { Ok(()) }
    }

    /// Stores the cases of a function that are not stored yet.
    fn flush(&self) -> PyResult<()> {
        let cases = std::mem::take(&mut self.state().waiting);
        if cases.is_empty() { Ok(()) } else { self.put(&Batch::new(&cases)).map_err(failed) }
    }

    /// The attributes of the whole, the coordinates and the variables, each with name, dimensions, values and attributes, when
    /// all cases are there; written to the folder if there is one.
    #[pyo3(signature = () -> "tuple[dict[str, Any], list[Any], list[Any]]")]
    fn finish<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(typed::Values<'py>, Bound<'py, PyList>, Bound<'py, PyList>)> {
        let dataset = detached(py, || self.dataset()).map_err(failed)?;
        let coordinates = dataset.axes.iter().chain(&dataset.grids).flat_map(|axis| &axis.coordinates);
        let coordinates = coordinates.map(|variable| labelled(py, variable)).collect::<PyResult<Vec<_>>>()?;
        let variables =
            dataset.variables.iter().map(|variable| labelled(py, variable)).collect::<PyResult<Vec<_>>>()?;
        let mut found = sweep::attributes(&dataset);
        found.push(("scenario".into(), output::Attribute::Text(dataset.scenario.clone())));
        Ok((attributes(py, found)?, PyList::new(py, coordinates)?, PyList::new(py, variables)?))
    }
}

impl Sweep {
    /// Computes what is missing.
    fn work(&self, plan: &Plan, monitor: &mut dyn Monitor) -> sweep::Result<()> {
        let mut state = self.state();
        let State { gathered, store, .. } = &mut *state;
        let missing = missing(gathered);
        match store {
            None => gathered.add(&Batch::new(&sweep::compute(plan, &missing, monitor)?)).map_err(added)?,
            Some(store) => {
                sweep::run(plan, &missing, gathered.there.len() - missing.len(), store, monitor)?;
                *gathered = store.gathered(&plan.places(), u64::MAX)?;
            }
        }
        Ok(())
    }

    fn put(&self, batch: &Batch) -> sweep::Result<()> {
        let mut state = self.state();
        if let Some(store) = &mut state.store {
            store.add_batch(batch)?;
        }
        state.gathered.add(batch).map_err(added)
    }

    fn dataset(&self) -> sweep::Result<Dataset> {
        let mut state = self.state();
        if let Some(store) = &mut state.store {
            store.finish()?;
        }
        // Nothing is asked of them again.
        let gathered = std::mem::take(&mut state.gathered);
        let dataset = match &self.kind {
            Kind::Scenario(plan, _) => Dataset::of_plan(plan, gathered),
            Kind::Function(Identity { hash, text, .. }, axes) => {
                Dataset::of_cases("", (hash, text), axes.clone(), gathered)
            }
        };
        if let Some(folder) = &self.folder {
            sweep::write(folder, &dataset, &[])?;
        }
        Ok(dataset)
    }
}

/// The numbers of the cases that are not there.
fn missing(gathered: &Gathered) -> Vec<usize> {
    (0..gathered.there.len()).filter(|&case| !gathered.there[case]).collect()
}

/// Cases cannot be added to what is there.
fn added(source: std::io::Error) -> sweep::Error {
    sweep::Error::System { path: PathBuf::new(), action: "add cases", source }
}

/// Computes cases of a scenario on some threads: what a worker does. Returns the bytes that `_Sweep.add` takes.
#[pyfunction(name = "_sweep_cases")]
pub fn cases<'py>(
    py: Python<'py>,
    specification: Specification,
    cases: Vec<usize>,
    threads: usize,
) -> PyResult<Bound<'py, PyBytes>> {
    let (text, name, folder, overrides) = specification;
    let input = parsed(py, (&text, &name, &folder, &overrides))?;
    let plan = Plan::unchecked(&input).map_err(|e| error::scenario(&e))?;
    asperity_runner::threads::check(threads)
        .map_err(|expected| error::invalid("threads", expected, threads))?;
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| PyOSError::new_err(error.to_string()))?;
    let found =
        py.detach(|| pool.install(|| sweep::compute(&plan, &cases, &mut Free))).map_err(error::core)?;
    Ok(PyBytes::new(py, &Batch::new(&found).encode()))
}

/// The monitor of a worker: the memory of the system.
struct Free;

impl Monitor for Free {
    fn progress(&mut self, _fraction: f64) -> ops::ControlFlow<()> {
        ops::ControlFlow::Continue(())
    }

    fn memory(&self) -> u64 {
        memory::available()
    }
}

/// A monitor on another thread: the fraction done goes out, the stop comes in.
struct Remote<'a> {
    done: &'a AtomicU64,
    stopped: &'a AtomicBool,
    memory: u64,
}

impl Monitor for Remote<'_> {
    fn progress(&mut self, fraction: f64) -> ops::ControlFlow<()> {
        self.done.store(fraction.to_bits(), Ordering::Relaxed);
        if self.stopped.load(Ordering::Relaxed) {
            ops::ControlFlow::Break(())
        } else {
            ops::ControlFlow::Continue(())
        }
    }

    fn memory(&self) -> u64 {
        self.memory
    }
}

/// Does the work on a number of threads, while this one, the one of Python, looks for signals and shows the progress.
fn on_threads<T: Send>(
    threads: usize,
    monitor: &mut dyn Monitor,
    work: impl FnOnce(&mut dyn Monitor) -> T + Send,
) -> Result<T> {
    let refused = |found: &dyn fmt::Display| {
        Error::invalid("threads", "a number of threads that the system allows", found)
    };
    asperity_runner::threads::check(threads)
        .map_err(|expected| Error::invalid("threads", expected, threads))?;
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| refused(&error))?;
    let (done, stopped, memory) = (AtomicU64::new(0), AtomicBool::new(false), monitor.memory());
    thread::scope(|scope| {
        let worker =
            scope.spawn(|| pool.install(|| work(&mut Remote { done: &done, stopped: &stopped, memory })));
        while !worker.is_finished() {
            if monitor.progress(f64::from_bits(done.load(Ordering::Relaxed))).is_break() {
                stopped.store(true, Ordering::Relaxed);
            }
            thread::sleep(PERIOD);
        }
        Ok(worker.join().expect("a case does not panic"))
    })
}

/// The axis of an argument.
fn argument(name: String, values: &Bound<'_, PyAny>) -> PyResult<Axis> {
    let values = match values.extract::<Vec<f64>>() {
        Ok(numbers) => Values::Numbers(numbers),
        Err(_) => Values::Texts(values.extract()?),
    };
    let length = values.count();
    let coordinates = vec![Labelled {
        name: name.clone(),
        long_name: String::new(),
        key: name.clone(),
        units: String::new(),
        dimensions: vec![name.clone()],
        values,
    }];
    Ok(Axis { name, length, coordinates })
}

/// A variable for xarray.
fn labelled<'py>(py: Python<'py>, variable: &Labelled) -> PyResult<Bound<'py, PyAny>> {
    let about = PyDict::new(py);
    let labels = [("long_name", &variable.long_name), ("units", &variable.units), ("key", &variable.key)];
    for (name, label) in labels.into_iter().filter(|(_, label)| !label.is_empty()) {
        about.set_item(name, label)?;
    }
    let values = match &variable.values {
        Values::Texts(texts) => PyList::new(py, texts)?.into_any(),
        numbers => numbers.read(0, usize::MAX)?.into_owned().into_pyarray(py).into_any(),
    };
    Ok((&variable.name, &variable.dimensions, values, about).into_pyobject(py)?.into_any())
}

/// Sweeps that cannot be continued are `FileExistsError`, other errors as those of runs.
fn failed(found: sweep::Error) -> PyErr {
    let text = found.to_string();
    match found {
        sweep::Error::Busy { .. } => PyFileExistsError::new_err(text),
        sweep::Error::System { source, .. } => std::io::Error::new(source.kind(), text).into(),
        sweep::Error::Output(found) => error::files(found),
        sweep::Error::Stopped(found) => error::core(found),
        _ => PyValueError::new_err(text),
    }
}
