//! Computing scenarios and reading results.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use asperity::monitor::Monitor;
use asperity::scenario::Scenario;
use asperity::task::summary::{FitFriction, Friction, StaticFriction, Summary, Uncertain};
use asperity::task::{self, Storage};
use asperity_runner::checkpoint::{Checkpoints, Every};
use asperity_runner::input::{self, Input};
use asperity_runner::output::{self, Outcome};
use pyo3::IntoPyObjectExt as _;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};

use crate::argument::{Argument, Optional as _, Whole};
use crate::pickle::{self, Reduced, damaged};
use crate::record::{Record, attributes};
use crate::watch::{beside, detached, watched_on, watched_writing};
use crate::{convert, error, tables, typed, values};

/// The result of a scenario: a mapping from the names of variables to arrays, with the summary.
///
/// The variables are those of `result.nc`: `position`, `force`, `breaking_rate`, `stretch_density`, …
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> result = asp.run({"contacts": {"thresholds": asp.Gaussian(1.0, 0.1)}, "pull": {"points": 11}})
/// >>> result["force"].shape, round(result.kinetic_friction, 3)
/// ((11,), 0.505)
#[pyclass(frozen, extends = Record, module = "asperity")]
pub struct Result {
    scenario: String,
    summary: Summary,
}

/// The result of a task, for Python.
pub fn object(py: Python<'_>, outcome: Outcome) -> PyResult<Py<Result>> {
    let Outcome { scenario, summary, record } = outcome;
    let record = Record::new(py, record, summary.units.clone())?;
    Py::new(py, record.add_subclass(Result { scenario, summary }))
}

#[pymethods]
impl Result {
    /// The scenario, TOML, with all defaults filled in.
    #[getter]
    fn scenario(&self) -> &str {
        &self.scenario
    }

    /// The summary: static and kinetic friction, relaxation length, …, as in `summary.json`.
    #[getter]
    fn summary<'py>(&self, py: Python<'py>) -> PyResult<typed::Values<'py>> {
        py.import("json")?.call_method1("loads", (self.json(),)).map(typed::Values)
    }

    /// The title of the scenario.
    #[getter]
    fn title(&self) -> &str {
        &self.summary.title
    }

    /// The static friction F_s with its position X_s; the array of F_s for a hold curve, shape (holds,); None if the force still
    /// rises at the end, or never decreases, and for tasks without it.
    #[getter]
    fn static_friction<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<typed::StaticFrictionOrArray<'py>>> {
        const NAME: &str = "static_friction";
        let (py, numbers) = (slf.py(), &slf.get().summary.numbers);
        if slf.contains(NAME)? {
            return slf.get_item(NAME).map(typed::StaticFrictionOrArray).map(Some);
        }
        match numbers.friction().map(|friction| friction.static_friction) {
            None | Some(StaticFriction::NotReached) => Ok(None),
            Some(StaticFriction::Reached { force, position }) => {
                let found = values::static_friction(py, force, position)?;
                Ok(Some(typed::StaticFrictionOrArray(found.0)))
            }
        }
    }

    /// The kinetic friction F_k, the force of steady sliding; an array where the task has many velocities, of a protocol that
    /// of each step, nan in holds and ramps; nan for tasks without it.
    #[getter]
    fn kinetic_friction<'py>(slf: &Bound<'py, Self>) -> PyResult<typed::NumberOrArray<'py>> {
        let numbers = &slf.get().summary.numbers;
        let of_steps = numbers.steps().iter().map(|step| step.kinetic_friction.unwrap_or(f64::NAN));
        let of_steps: Vec<f64> = of_steps.collect();
        if of_steps.iter().any(|friction| friction.is_finite()) {
            return convert::row(slf.py(), of_steps).map(typed::NumberOrArray);
        }
        let of_curve = numbers.hold_curve().map(|curve| curve.kinetic_friction);
        let of_noise = numbers.noise().map(|noise| noise.kinetic_friction);
        let number = of_curve.or(of_noise);
        slf.get().known(
            slf,
            "kinetic_friction",
            number,
            |friction| friction.kinetic_friction,
            |fit| fit.kinetic_friction,
        )
    }

    /// The critical stiffness K_c, force per length; inf where the force jumps down; an array where the task has many
    /// velocities; nan for tasks without it.
    #[getter]
    fn critical_stiffness<'py>(slf: &Bound<'py, Self>) -> PyResult<typed::NumberOrArray<'py>> {
        slf.get().known(
            slf,
            "critical_stiffness",
            None,
            |friction| friction.critical_stiffness.0,
            |fit| fit.critical_stiffness,
        )
    }

    /// The relaxation length X*; inf if the force does not settle exponentially, nan if no root is found, and for tasks without it.
    #[getter]
    fn relaxation_length<'py>(slf: &Bound<'py, Self>) -> PyResult<typed::NumberOrArray<'py>> {
        slf.get().known(
            slf,
            "relaxation_length",
            None,
            |friction| friction.relaxation_length.0,
            |fit| fit.relaxation_length,
        )
    }

    /// The events of a slider or an interface; None if the task has no events.
    #[getter]
    fn events<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<typed::Events<'py>>> {
        let columns = PyDict::new(slf.py());
        slf.as_super().get().events_into(&columns)?;
        if columns.is_empty() { Ok(None) } else { values::events(slf.py(), columns).map(Some) }
    }

    /// Writes the folder that `asperity run` would write, without figures; open_result reads it.
    ///
    /// Parameters
    /// ----------
    /// folder
    ///     The folder, which asperity made if it exists.
    ///
    /// Raises
    /// ------
    /// FileExistsError
    ///     If there is a folder that asperity did not make.
    /// OSError
    ///     For errors of the system.
    fn save(slf: &Bound<'_, Self>, folder: Argument<PathBuf>) -> PyResult<()> {
        let folder = folder.get("folder")?;
        let Self { scenario, summary } = slf.get();
        let record = slf.as_super().get().copy(slf.py())?;
        let outcome = Outcome { scenario: scenario.clone(), summary: summary.clone(), record };
        detached(slf.py(), || output::write(&folder, &outcome, &[])).map(drop).map_err(error::files)
    }

    fn _attributes<'py>(&self, py: Python<'py>) -> PyResult<typed::Values<'py>> {
        attributes(py, output::attributes(&self.summary))
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let bytes = slf.as_super().get().packed(slf.py(), &(&slf.get().scenario, slf.get().json()))?;
        pickle::reduced(slf.py(), "Result", &bytes, None)
    }
}

impl Result {
    /// The array called `name`, or the number of a pull or of a fit, or `other`, or nan.
    fn known<'py>(
        &self,
        result: &Bound<'py, Self>,
        name: &str,
        other: Option<f64>,
        of_pull: impl Fn(&Friction) -> f64,
        of_fit: impl Fn(&FitFriction) -> Uncertain,
    ) -> PyResult<typed::NumberOrArray<'py>> {
        if result.contains(name)? {
            return result.get_item(name).map(typed::NumberOrArray);
        }
        let numbers = &self.summary.numbers;
        let of_fit = || Some(of_fit(numbers.fit()?.friction.as_ref()?).value.0);
        let number = numbers.friction().map(of_pull).or_else(of_fit).or(other).unwrap_or(f64::NAN);
        number.into_bound_py_any(result.py()).map(typed::NumberOrArray)
    }

    /// The result of a pickle.
    pub fn restored(py: Python<'_>, bytes: &[u8]) -> PyResult<Py<PyAny>> {
        let ((scenario, summary), record): ((String, String), _) = Record::unpacked(py, bytes)?;
        let summary = serde_json::from_str(&summary).map_err(damaged)?;
        Ok(Py::new(py, record.add_subclass(Self { scenario, summary }))?.into_any())
    }

    /// The summary as in `summary.json`.
    fn json(&self) -> String {
        serde_json::to_string(&self.summary).expect("a summary is plain data")
    }
}

/// Computes a scenario.
///
/// Parameters
/// ----------
/// scenario
///     The path of a file; or the text of a scenario, recognised by an equals sign; or a dictionary of the same keys,
///     in which distributions and contacts may be objects.
/// overrides
///     Values by dotted key, such as {"contacts.thresholds.gaussian.std": 0.1}; a distribution replaces the one in
///     the scenario.
/// progress
///     As for MasterEquation.pull.
/// folder
///     Folder for the results, as for Result.save.
/// checkpoint
///     With a folder, checkpoints of the drive of an interface are written next to it: after each number of events,
///     or after each time interval, a datetime.timedelta or a text such as "10min". They are removed once the results
///     are written.
/// resume
///     Whether to continue from the last checkpoint; without one, the run starts at the beginning.
/// threads
///     The number of threads of this computation, from 1 to 8 per core, on which results do not depend; by default those of
///     the process, one per core or RAYON_NUM_THREADS.
///
/// Returns
/// -------
/// Result
///
/// Raises
/// ------
/// ValueError
///     For an invalid scenario, with the key, what was expected and what was found, and for a checkpoint of another
///     scenario.
/// OSError
///     For a file that cannot be read.
/// FileExistsError
///     For a checkpoint of a run that was not finished or is still running.
/// MemoryError
///     For results that do not fit.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> scenario = {'contacts': {'thresholds': asp.Gaussian(1.0, 0.1)}, 'pull': {'distance': 5.0}}
/// >>> result = asp.run(scenario, {'pull.points': 501})
/// >>> round(result.kinetic_friction, 6)
/// 0.505
/// >>> result['force'].shape
/// (501,)
#[pyfunction]
#[pyo3(signature = (
    scenario: "str | PathLike[str] | Mapping[str, Any]", overrides: "Mapping[str, Any] | None" = None, *,
    progress: "_Progress" = None, folder = None, checkpoint: "SupportsIndex | timedelta | str | None" = None,
    resume = Argument::new(false), threads = None
), text_signature = "(scenario, overrides=None, *, progress=None, folder=None, checkpoint=None, resume=False, threads=None)")]
pub fn run(
    scenario: &Bound<'_, PyAny>,
    overrides: Option<&Bound<'_, PyAny>>,
    progress: Option<Bound<'_, PyAny>>,
    folder: Option<Argument<PathBuf>>,
    checkpoint: Option<&Bound<'_, PyAny>>,
    resume: Argument<bool>,
    threads: Option<Whole>,
) -> PyResult<Py<Result>> {
    let (folder, resume) = (folder.get("folder")?, resume.get("resume")?);
    let py = scenario.py();
    let overrides = overrides.map(assignments).transpose()?.unwrap_or_default();
    let checkpoint = checkpoint.map(convert::every).transpose()?;
    let Text { text, name, folder: relative } = Text::of(scenario)?;
    let input = parsed(py, (&text, &name, &relative, &overrides))?;
    let Some(folder) = folder else {
        if checkpoint.is_some() || resume {
            return Err(error::invalid("folder", "one, beside which checkpoints are kept", "None"));
        }
        let compute = |monitor: &mut dyn Monitor| asperity_runner::run(&input.scenario, monitor);
        return object(py, watched_on(threads, progress, py, compute)?);
    };
    output::check(&folder).map_err(error::files)?;
    let stop = Arc::new(AtomicBool::new(false));
    let kept = checkpoints(&input.scenario, &folder, checkpoint, resume)?;
    let mut kept = kept.map(|kept| kept.interrupted_by(stop.clone()));
    let outcome = watched_writing(threads, &stop, progress, py, |monitor| {
        let checkpoints = kept.as_mut().map(|kept| kept as &mut dyn task::Checkpoints);
        asperity_runner::run_with(&input.scenario, Storage { checkpoints, columns: None }, monitor)
    });
    // A failed checkpoint is reported as the reason of the stop.
    let failure = kept.as_mut().and_then(Checkpoints::failure);
    let outcome = failure.map_or(outcome, |failure| Err(error::checkpoint(failure)))?;
    detached(py, || output::write(&folder, &outcome, &[])).map_err(error::files)?;
    kept.map_or(Ok(()), Checkpoints::remove).map_err(error::checkpoint)?;
    object(py, outcome)
}

/// The scenario of a text with its name, the folder of its files, and overrides; files may be large.
pub fn parsed(
    py: Python<'_>,
    (text, name, folder, overrides): (&str, &str, &Path, &[String]),
) -> PyResult<Input> {
    let (text, name) = (text.to_owned(), name.to_owned());
    let (folder, overrides) = (folder.to_owned(), overrides.to_owned());
    let read = move |monitor: &mut dyn Monitor| input::parse_with(&text, &name, &folder, &overrides, monitor);
    beside(py, read)?.map_err(|diagnostic| error::scenario(&diagnostic))
}

/// The requested checkpoints.
fn checkpoints(
    scenario: &Scenario,
    folder: &Path,
    every: Option<Every>,
    resume: bool,
) -> PyResult<Option<Checkpoints>> {
    if every.is_none() && !resume {
        return Ok(None);
    }
    scenario.keeps_checkpoints("checkpoint").map_err(error::core)?;
    let begin = if resume { Checkpoints::resume } else { Checkpoints::begin };
    begin(folder, scenario, every).map(Some).map_err(error::checkpoint)
}

/// Reads the folder that `asperity run` or Result.save wrote.
///
/// Parameters
/// ----------
/// folder
///     The folder.
///
/// Returns
/// -------
/// Result
///
/// Raises
/// ------
/// OSError
///     For a file that cannot be read.
/// ValueError
///     For one that asperity did not write, and for the folder of a sweep.
///
/// Examples
/// --------
/// >>> import tempfile
/// >>> import asperity as asp
/// >>> scenario = {'contacts': {'thresholds': asp.Gaussian(1.0, 0.1)}, 'pull': {}}
/// >>> with tempfile.TemporaryDirectory() as folder:
/// ...     _ = asp.run(scenario, folder=folder + '/results')
/// ...     again = asp.open_result(folder + '/results')
/// >>> round(again.kinetic_friction, 6)
/// 0.505
#[pyfunction]
pub fn open_result(py: Python<'_>, folder: Argument<PathBuf>) -> PyResult<Py<Result>> {
    let folder = folder.get("folder")?;
    let sweep = folder.join("sweep.nc");
    if sweep.is_file() {
        let found = format!("that of a sweep: xarray.open_dataset reads {}", sweep.display());
        return Err(error::invalid("folder", "the folder of a run", found));
    }
    object(py, detached(py, || output::read(&folder)).map_err(error::files)?)
}

/// The text of a scenario, its name in messages, and the folder to which its file paths are relative.
pub struct Text {
    pub text: String,
    pub name: String,
    pub folder: PathBuf,
}

impl Text {
    pub fn of(scenario: &Bound<'_, PyAny>) -> PyResult<Self> {
        let here = |text| Self { text, name: "the scenario".into(), folder: PathBuf::new() };
        if scenario.is_instance_of::<PyDict>() {
            return written(&tables::toml("", scenario)?).map(here);
        }
        if scenario.is_instance_of::<PyString>() && scenario.contains("=")? {
            return scenario.extract().map(here);
        }
        let expected = "a path, the text of a scenario, or a dictionary";
        let path: PathBuf =
            scenario.extract().map_err(|_| error::wrong_type("scenario", expected, scenario))?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let unread =
            |source| error::files(output::Error::System { path: path.clone(), action: "read", source });
        let text = std::fs::read_to_string(&path).map_err(unread)?;
        Ok(Self { text, name: path.display().to_string(), folder })
    }
}

fn written(value: &toml::Value) -> PyResult<String> {
    toml::to_string(value).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Overrides in the form of the command line, `key=value`.
pub fn assignments(overrides: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    let expected = "a dict of values by dotted key";
    let overrides =
        overrides.cast::<PyDict>().map_err(|_| error::wrong_type("overrides", expected, overrides))?;
    let assignment = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let key: String =
            key.extract().map_err(|_| error::wrong_type("overrides", "keys that are texts", &key))?;
        let value = tables::toml(&key, &value)?;
        Ok(format!("{key}={value}"))
    };
    overrides.iter().map(assignment).collect()
}
