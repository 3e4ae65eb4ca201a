//! Arguments that name themselves where they are of a wrong type: PyO3 extracts them before a function knows their names.

use std::collections::BTreeMap;
use std::path::PathBuf;

use numpy::{PyUntypedArray, PyUntypedArrayMethods as _};
use pyo3::PyClass;
use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::error::invalid;
use crate::typed::argument_type;

/// What an argument is expected to be.
pub trait Expected {
    /// Whether True and False are such arguments. To Python they are numbers, too.
    const TAKES_BOOL: bool = false;

    fn expected() -> String;
}

/// An argument, or what was found in its place.
pub struct Argument<T>(Result<T, Found>);

/// What was found in place of an argument: a value of another type, or one out of range, as text.
enum Found {
    Type(String),
    Text(String),
}

/// What is known of numbers by their names: values and errors.
pub type Priors = BTreeMap<String, (f64, f64)>;

/// The same as they are given, so that a wrong one is named.
pub type GivenPriors = BTreeMap<String, Pair>;

/// A value and its error, or what was found in their place.
pub struct Pair(Result<(f64, f64), Found>);

/// A number.
pub type Real = Argument<f64>;

impl<T> Argument<T> {
    pub const fn new(value: T) -> Self {
        Self(Ok(value))
    }
}

impl Argument<String> {
    pub fn text(text: &str) -> Self {
        Self(Ok(text.into()))
    }
}

impl<T: Expected> Argument<T> {
    /// The value of the argument `key`.
    pub fn get(self, key: &str) -> PyResult<T> {
        self.0.map_err(|found| found.refused(key, &T::expected()))
    }
}

/// An argument that may be left out.
pub trait Optional<T> {
    /// The value of the argument `key`, if there is one.
    fn get(self, key: &str) -> PyResult<Option<T>>;
}

impl<T: Expected> Optional<T> for Option<Argument<T>> {
    fn get(self, key: &str) -> PyResult<Option<T>> {
        self.map(|argument| argument.get(key)).transpose()
    }
}

/// The argument `prior`, if there is one.
pub fn priors(given: Option<Argument<GivenPriors>>) -> PyResult<Option<Priors>> {
    let one = |(name, Pair(pair)): (String, Pair)| match pair {
        Ok(pair) => Ok((name, pair)),
        Err(found) => Err(found.refused(&format!("prior.{name}"), "a pair of numbers (value, error)")),
    };
    let given = given.get("prior")?;
    given.map(|given| given.into_iter().map(one).collect()).transpose()
}

impl Found {
    /// What stands in place of an argument that could not be extracted; other errors are passed on.
    fn of(value: &Bound<'_, PyAny>, error: PyErr) -> PyResult<Self> {
        let py = value.py();
        if error.is_instance_of::<PyOverflowError>(py) {
            return Ok(Self::Text(value.str()?.to_string()));
        }
        if !error.is_instance_of::<PyTypeError>(py) {
            return Err(error);
        }
        let name = value.get_type().name()?.to_string();
        Ok(Self::Type(match value.cast::<PyUntypedArray>() {
            Ok(array) => format!("{name} of shape {:?}", array.shape()),
            Err(_) => name,
        }))
    }

    fn refused(self, key: &str, expected: &str) -> PyErr {
        match self {
            Self::Type(name) => PyTypeError::new_err(format!("{key}: expected {expected}, got {name}")),
            Self::Text(text) => invalid(key, format!("{expected} in range"), text),
        }
    }
}

impl<'a, 'py, T: FromPyObject<'a, 'py> + Expected> FromPyObject<'a, 'py> for Argument<T> {
    type Error = PyErr;

    #[cfg(feature = "stubs")]
    const INPUT_TYPE: pyo3::inspect::PyStaticExpr = T::INPUT_TYPE;

    fn extract(value: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if !T::TAKES_BOOL && value.is_instance_of::<PyBool>() {
            return Ok(Self(Err(Found::Type("bool".into()))));
        }
        match value.extract() {
            Ok(found) => Ok(Self(Ok(found))),
            Err(error) => Found::of(&value, error.into()).map(|found| Self(Err(found))),
        }
    }
}

impl Expected for f64 {
    fn expected() -> String {
        "a number".into()
    }
}

impl Expected for bool {
    const TAKES_BOOL: bool = true;

    fn expected() -> String {
        "True or False".into()
    }
}

impl Expected for String {
    fn expected() -> String {
        "text".into()
    }
}

impl Expected for Vec<usize> {
    fn expected() -> String {
        "a list of whole numbers, 0 or above".into()
    }
}

impl Expected for Vec<String> {
    fn expected() -> String {
        "a list of names".into()
    }
}

impl Expected for PathBuf {
    fn expected() -> String {
        "a path".into()
    }
}

impl Expected for (f64, f64) {
    fn expected() -> String {
        "two numbers".into()
    }
}

impl Expected for (Bound<'_, PyAny>, Bound<'_, PyAny>) {
    fn expected() -> String {
        "two lists of numbers".into()
    }
}

impl FromPyObject<'_, '_> for Pair {
    type Error = PyErr;

    argument_type!("tuple[float, float]");

    fn extract(value: Borrowed<'_, '_, PyAny>) -> PyResult<Self> {
        match value.extract() {
            Ok(pair) => Ok(Self(Ok(pair))),
            // A tuple of another length.
            Err(error) if error.is_instance_of::<PyValueError>(value.py()) => {
                Ok(Self(Err(Found::Type(format!("{} of {} items", value.get_type().name()?, value.len()?)))))
            }
            Err(error) => Found::of(&value, error).map(|found| Self(Err(found))),
        }
    }
}

impl Expected for GivenPriors {
    fn expected() -> String {
        "a dict of pairs (value, error) by name".into()
    }
}

impl<T: PyClass> Expected for Bound<'_, T> {
    fn expected() -> String {
        T::NAME.into()
    }
}

impl<T: PyClass> Expected for Vec<Bound<'_, T>> {
    fn expected() -> String {
        format!("a list of {}", T::NAME)
    }
}

/// An integer, 0 or above, or what was found in its place.
pub struct Whole(Result<usize, Found>);

impl Whole {
    pub const fn new(number: usize) -> Self {
        Self(Ok(number))
    }

    /// The number under `key`.
    pub fn get<T: TryFrom<usize>>(self, key: &str) -> PyResult<T> {
        let number =
            self.0.and_then(|number| T::try_from(number).map_err(|_| Found::Text(number.to_string())));
        number.map_err(|found| match found {
            Found::Text(text) => invalid(key, "a whole number, 0 or above, and not too large", text),
            of_type @ Found::Type(_) => of_type.refused(key, "a whole number, 0 or above"),
        })
    }
}

impl<'py> FromPyObject<'_, 'py> for Whole {
    type Error = PyErr;

    argument_type!("SupportsIndex");

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match value.extract() {
            Ok(number) => Ok(Self(Ok(number))),
            Err(error) => Found::of(&value, error).map(|found| Self(Err(found))),
        }
    }
}
