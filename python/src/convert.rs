//! Conversion between values of Python and those of the core: numbers and arrays, seeds, words, scenarios.

use std::num::NonZeroU64;

use asperity::contacts::Hazard;
use asperity::monitor::Monitor;
use asperity::scenario::{Barrier, Disorder, TaskStart};
use asperity::task::summary::SlidingKind;
use asperity_runner::checkpoint::Every;
use asperity_runner::{duration, input};
use numpy::ndarray::{ArrayD, ArrayViewD, IxDyn};
use numpy::{
    Element, IntoPyArray, PyArrayDescrMethods, PyReadonlyArrayDyn, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::IntoPyObjectExt as _;
use pyo3::exceptions::{PyOverflowError, PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDelta, PyFloat, PyInt, PyList, PyString, PyTuple};
use serde::de::DeserializeOwned;

use crate::error::{self, invalid, wrong_type};
use crate::typed::argument_type;
use crate::watch::{report, watched};

/// Values computed between two checks for signals.
const PIECE: usize = 64;

/// Largest allowed nesting depth of tables, lists and objects in a scenario; no valid one reaches half of it.
pub const DEPTH: usize = 64;

/// An object of a Python module, looked up once.
pub struct Import(PyOnceLock<Py<PyAny>>, &'static str, &'static str);

impl Import {
    pub const fn new(module: &'static str, name: &'static str) -> Self {
        Self(PyOnceLock::new(), module, name)
    }

    pub fn get<'py>(&self, py: Python<'py>) -> PyResult<&Bound<'py, PyAny>> {
        let look_up = || PyResult::Ok(py.import(self.1)?.getattr(self.2)?.unbind());
        Ok(self.0.get_or_try_init(py, look_up)?.bind(py))
    }
}

/// The valid range of a number.
pub struct Domain {
    pub low: f64,
    pub high: f64,
    pub what: &'static str,
}

impl Domain {
    pub const NUMBERS: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY, what: "a number" };
    pub const PROBABILITIES: Self = Self { low: 0.0, high: 1.0, what: "a probability" };

    /// Positions of a pull.
    pub fn positions(distance: f64) -> Self {
        Self { low: 0.0, high: distance, what: "a position" }
    }

    fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    fn refuse(&self, key: &str, value: f64) -> PyErr {
        let Self { low, high, what } = self;
        let range = match (low.is_finite(), *high < f64::MAX) {
            (true, true) => format!(" from {low} to {high}"),
            (true, false) => format!(" of {low} or above"),
            (false, _) => String::new(),
        };
        invalid(key, format!("{what}{range}"), value)
    }
}

/// The interval between checkpoints: a number of events, a timedelta, or text as on the command line.
pub fn every(value: &Bound<'_, PyAny>) -> PyResult<Every> {
    const KEY: &str = "checkpoint";
    let every = if let Ok(text) = value.cast::<PyString>() {
        text.to_str()?.parse().ok()
    } else if value.is_instance_of::<PyDelta>() {
        let seconds: f64 = value.call_method0("total_seconds")?.extract()?;
        duration::within(seconds).map(Every::Time)
    } else {
        let expected = "a number of events, a timedelta or text";
        let events = value.call_method0("__index__").map_err(|_| wrong_type(KEY, expected, value))?;
        events.extract().ok().and_then(NonZeroU64::new).map(Every::Events)
    };
    every.map_or_else(|| Err(invalid(KEY, Every::expected(), value.str()?)), Ok)
}

/// A number, or an array of them.
enum Numbers<'py> {
    One(f64),
    Many(PyReadonlyArrayDyn<'py, f64>),
}

impl<'py> Numbers<'py> {
    /// Reads integers or real numbers in any form that NumPy converts to an array.
    fn read(key: &str, value: &Bound<'py, PyAny>) -> PyResult<Self> {
        if value.is_instance_of::<PyFloat>() || value.is_instance_of::<PyInt>() {
            return value.extract().map(Self::One);
        }
        unmasked(key, value, DEPTH)?;
        let array: PyReadonlyArrayDyn<'py, f64> = match value.extract() {
            Ok(array) => array,
            Err(_) => as_floats(key, value)?.extract()?,
        };
        Ok(if array.ndim() == 0 { Self::One(array.as_array()[[].as_slice()]) } else { Self::Many(array) })
    }
}

/// Refuses masked values, because the number under a mask is not meant as a value.
pub fn unmasked(key: &str, value: &Bound<'_, PyAny>, depth: usize) -> PyResult<()> {
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let depth = deeper(key, depth)?;
        return value.try_iter()?.enumerate().try_for_each(|(i, item)| {
            let item = item?;
            let number = item.is_instance_of::<PyFloat>() || item.is_instance_of::<PyInt>();
            if number { Ok(()) } else { unmasked(&format!("{key}.{i}"), &item, depth) }
        });
    }
    static MASKED: Import = Import::new("numpy.ma", "MaskedArray");
    static COUNT: Import = Import::new("numpy.ma", "count_masked");
    let py = value.py();
    if !value.is_instance(MASKED.get(py)?)? {
        return Ok(());
    }
    match COUNT.get(py)?.call1((value,))?.extract()? {
        0 => Ok(()),
        masked => {
            let (masked, all): (usize, usize) = (masked, value.getattr("size")?.extract()?);
            let expected = "numbers none of which is masked (compressed() leaves out those that are)";
            Err(invalid(key, expected, format!("{masked} masked of {all}")))
        }
    }
}

/// The remaining nesting depth below `key`.
pub fn deeper(key: &str, depth: usize) -> PyResult<usize> {
    depth.checked_sub(1).ok_or_else(|| {
        let outermost = key.split('.').next().unwrap_or(key);
        let expected = format!("at most {DEPTH} tables and lists within each other");
        invalid(outermost, expected, "more (does one hold itself?)")
    })
}

fn as_floats<'py>(key: &str, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    static AS_ARRAY: Import = Import::new("numpy", "asarray");
    let array = AS_ARRAY.get(value.py())?.call1((value,))?;
    if !matches!(array.cast::<PyUntypedArray>()?.dtype().kind(), b'i' | b'u' | b'f') {
        let found = array.getattr("dtype")?;
        let text = format!("{key}: expected numbers, got {} of dtype {found}", value.get_type().name()?);
        return Err(PyTypeError::new_err(text));
    }
    array.call_method1("astype", ("float64",))
}

/// Applies `function` to a number (returns a float) or to an array (returns an array of its shape).
pub fn evaluate<'py>(
    key: &str,
    at: &Bound<'py, PyAny>,
    domain: &Domain,
    function: impl Fn(f64) -> f64 + Send + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let py = at.py();
    match Numbers::read(key, at)? {
        Numbers::One(value) if domain.contains(value) => function(value).into_bound_py_any(py),
        Numbers::One(value) => Err(domain.refuse(key, value)),
        Numbers::Many(values) => {
            let values = values.as_array();
            if let Some((place, &value)) = values.iter().enumerate().find(|(_, v)| !domain.contains(**v)) {
                return Err(domain.refuse(&format!("{key}.{place}"), value));
            }
            let found = watched(None, py, |monitor| each(values, &function, monitor))?;
            Ok(found.into_pyarray(py).into_any())
        }
    }
}

/// Applies `function` to all numbers at once, a number (returns a float) or an array (returns an array of its shape).
pub fn evaluate_all<'py>(
    key: &str,
    at: &Bound<'py, PyAny>,
    domain: &Domain,
    function: impl Fn(&[f64], &mut dyn Monitor) -> asperity::Result<Vec<f64>> + Send + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let py = at.py();
    let (values, shape) = flat(key, at, domain)?;
    let found = watched(None, py, |monitor| function(&values, monitor))?;
    let Some(shape) = shape else { return found[0].into_bound_py_any(py) };
    let array = ArrayD::from_shape_vec(IxDyn(&shape), found).expect("as many numbers as the shape has");
    Ok(array.into_pyarray(py).into_any())
}

/// Applies a function that gives `count` rows of as many numbers: an array of the shape (count,) for a number, and of
/// (count, …) for an array.
pub fn evaluate_rows<'py>(
    (key, at): (&str, &Bound<'py, PyAny>),
    domain: &Domain,
    count: usize,
    function: impl Fn(&[f64], &mut dyn Monitor) -> asperity::Result<Vec<Vec<f64>>> + Send + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let py = at.py();
    let (values, shape) = flat(key, at, domain)?;
    let rows = watched(None, py, |monitor| function(&values, monitor))?;
    let mut whole = vec![count];
    whole.extend(shape.unwrap_or_default());
    array(py, &whole, rows.concat())
}

/// The numbers of a domain in a number or an array, and the shape of an array.
fn flat(key: &str, at: &Bound<'_, PyAny>, domain: &Domain) -> PyResult<(Vec<f64>, Option<Vec<usize>>)> {
    let (values, shape) = match Numbers::read(key, at)? {
        Numbers::One(value) => (vec![value], None),
        Numbers::Many(array) => {
            let array = array.as_array();
            (array.iter().copied().collect(), Some(array.shape().to_vec()))
        }
    };
    match values.iter().enumerate().find(|(_, value)| !domain.contains(**value)) {
        Some((place, &value)) if shape.is_some() => Err(domain.refuse(&format!("{key}.{place}"), value)),
        Some((_, &value)) => Err(domain.refuse(key, value)),
        None => Ok((values, shape)),
    }
}

/// Applies `function` to each of the values.
fn each(
    values: ArrayViewD<'_, f64>,
    function: impl Fn(f64) -> f64,
    monitor: &mut dyn Monitor,
) -> asperity::Result<ArrayD<f64>> {
    let mut found = Vec::with_capacity(values.len());
    for &value in &values {
        if found.len() % PIECE == 0 {
            report(monitor, found.len(), values.len())?;
        }
        found.push(function(value));
    }
    Ok(ArrayD::from_shape_vec(values.raw_dim(), found).expect("as many numbers as the shape has"))
}

/// A list of numbers.
pub fn list(key: &str, values: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    match Numbers::read(key, values)? {
        Numbers::Many(array) if array.ndim() == 1 => Ok(array.as_array().iter().copied().collect()),
        Numbers::Many(array) => {
            Err(invalid(key, "a list of numbers", format!("an array of shape {:?}", array.shape())))
        }
        Numbers::One(_) => Err(wrong_type(key, "a list of numbers", values)),
    }
}

/// A list of numbers in a domain.
pub fn list_within(key: &str, values: &Bound<'_, PyAny>, domain: &Domain) -> PyResult<Vec<f64>> {
    let values = list(key, values)?;
    match values.iter().position(|&value| !domain.contains(value)) {
        Some(place) => Err(domain.refuse(&format!("{key}.{place}"), values[place])),
        None => Ok(values),
    }
}

/// One number of a domain or a list of them, as a list; and whether it was one number.
pub fn one_or_list(key: &str, values: &Bound<'_, PyAny>, domain: &Domain) -> PyResult<(Vec<f64>, bool)> {
    match Numbers::read(key, values)? {
        Numbers::One(value) if domain.contains(value) => Ok((vec![value], true)),
        Numbers::One(value) => Err(domain.refuse(key, value)),
        Numbers::Many(_) => Ok((list_within(key, values, domain)?, false)),
    }
}

/// A number of contacts.
pub fn contacts(key: &str, number: f64) -> PyResult<f64> {
    if number.is_finite() && number > 0.0 {
        return Ok(number);
    }
    Err(invalid(key, "a number of contacts above 0", number))
}

/// An array of the given shape that owns `values` and is read-only.
pub fn array<'py, T: Element>(
    py: Python<'py>,
    shape: &[usize],
    values: Vec<T>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = ArrayD::from_shape_vec(IxDyn(shape), values)
        .map_err(|e| PyRuntimeError::new_err(e.to_string()))?
        .into_pyarray(py)
        .into_any();
    array.call_method1("setflags", (false,))?;
    Ok(array)
}

/// A one-dimensional array that owns `values` and is read-only.
pub fn row<T: Element>(py: Python<'_>, values: Vec<T>) -> PyResult<Bound<'_, PyAny>> {
    array(py, &[values.len()], values)
}

/// A square array that owns `values`, row by row, and is read-only.
pub fn square<T: Element>(py: Python<'_>, values: Vec<T>) -> PyResult<Bound<'_, PyAny>> {
    let side = values.len().isqrt();
    array(py, &[side, side], values)
}

/// A seed: an integer, or a number drawn from a generator of NumPy, also one of its older kind.
pub struct Seed(pub u64);

impl Seed {
    /// A seed that differs from call to call, from the entropy of the operating system.
    pub fn of_the_system(py: Python<'_>) -> PyResult<Self> {
        static GENERATOR: Import = Import::new("numpy.random", "default_rng");
        GENERATOR.get(py)?.call0()?.call_method1("integers", (1_u64 << 63,))?.extract().map(Self)
    }
}

impl<'py> FromPyObject<'_, 'py> for Seed {
    type Error = PyErr;

    argument_type!("_Seed");

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Self::named("seed", &value)
    }
}

impl Seed {
    /// The seed under `key`.
    pub fn named(key: &str, value: &Bound<'_, PyAny>) -> PyResult<Self> {
        const EXPECTED: &str = "a whole number from 0 to 2^63 - 1, or a numpy.random.Generator";
        static GENERATOR: Import = Import::new("numpy.random", "Generator");
        static OLDER: Import = Import::new("numpy.random", "RandomState");
        let py = value.py();
        if !value.hasattr("__index__")? {
            if value.is_instance(GENERATOR.get(py)?)? {
                return value.call_method1("integers", (1_u64 << 63,))?.extract().map(Self);
            }
            if value.is_instance(OLDER.get(py)?)? {
                return value
                    .call_method1("randint", (0, 1_u64 << 63, py.None(), "int64"))?
                    .extract()
                    .map(Self);
            }
            return Err(wrong_type(key, EXPECTED, value));
        }
        match value.extract::<u64>() {
            Ok(seed) if i64::try_from(seed).is_ok() => Ok(Self(seed)),
            _ => Err(invalid(key, EXPECTED, value.str()?)),
        }
    }
}

/// A requested number of values, or the shape of an array of them.
pub struct Size(pub Vec<usize>);

impl<'py> FromPyObject<'_, 'py> for Size {
    type Error = PyErr;

    argument_type!("SupportsIndex | Sequence[SupportsIndex]");

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let refused = |error: PyErr| {
            let text = value.str().map_or_else(|_| "something else".into(), |text| text.to_string());
            let whole = error.is_instance_of::<PyOverflowError>(value.py());
            let expected = "None, a whole number, 0 or above, or a tuple of them";
            if whole { invalid("size", expected, text) } else { wrong_type("size", expected, &value) }
        };
        if value.hasattr("__index__")? {
            return value.extract().map(|length| Self(vec![length])).map_err(refused);
        }
        value.extract().map(Self).map_err(refused)
    }
}

/// One of several words.
pub fn word<T: DeserializeOwned>(key: &str, word: &str) -> PyResult<T> {
    input::word(key, word).map_err(error::core)
}

/// The word for a start.
pub fn start(start: TaskStart) -> &'static str {
    match start {
        TaskStart::Conditional => "conditional",
        TaskStart::Relaxed => "relaxed",
        TaskStart::Steady => "steady",
    }
}

/// The word for a disorder.
pub fn disorder(disorder: Disorder) -> &'static str {
    match disorder {
        Disorder::Annealed => "annealed",
        Disorder::Quenched => "quenched",
    }
}

/// The word for a hazard.
pub fn hazard(hazard: Hazard) -> &'static str {
    match hazard {
        Hazard::Joint => "joint",
        Hazard::Additive => "additive",
        _ => unreachable!("a hazard without a word"),
    }
}

/// The word for a barrier.
pub fn barrier(barrier: Barrier) -> &'static str {
    match barrier {
        Barrier::Elastic => "elastic",
        Barrier::Bell => "bell",
        Barrier::Catastrophe => "catastrophe",
        _ => unreachable!("a barrier without a word"),
    }
}

/// The word for a kind of sliding.
pub fn regime(kind: SlidingKind) -> &'static str {
    match kind {
        SlidingKind::Smooth => "smooth",
        SlidingKind::Transient => "transient",
        SlidingKind::Persistent => "persistent",
        SlidingKind::Runaway => "runaway",
        SlidingKind::Undecided => "undecided",
    }
}
