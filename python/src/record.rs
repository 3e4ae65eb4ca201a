//! Results as labelled columns, with values in NumPy arrays.

use asperity::record::{self, Quantity, Variable};
use asperity::scenario::Units;
use asperity::task::is_coordinate;
use asperity_runner::output::{self, Attribute};
use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::argument::{Argument, Optional as _};
use crate::pickle::{self, Reduced, VERSION, damaged};
use crate::{convert, typed, values};

/// Description of the values of a column, and the array that owns them.
struct Column {
    name: String,
    long_name: String,
    quantity: Quantity,
    dimensions: Vec<String>,
    values: Py<PyAny>,
}

/// Results: a mapping from the names of variables to read-only arrays.
///
/// Examples
/// --------
/// >>> import asperity as asp
/// >>> pull = asp.MasterEquation(asp.Contacts(asp.Gaussian(1.0, 0.1))).pull(3.0, 31)
/// >>> isinstance(pull, asp.Record), pull["force"].shape
/// (True, (31,))
#[pyclass(frozen, mapping, subclass, module = "asperity")]
pub struct Record {
    columns: Vec<Column>,
    units: Units,
}

impl Record {
    /// Moves the values of `record` to NumPy.
    pub fn new(py: Python<'_>, record: record::Record, units: Units) -> PyResult<PyClassInitializer<Self>> {
        let lengths: Vec<(String, usize)> =
            record.dimensions().into_iter().map(|(name, length)| (name.to_owned(), length)).collect();
        let length = |name: &String| lengths.iter().find(|known| known.0 == *name).map_or(0, |known| known.1);
        let column = |variable: Variable| {
            let shape: Vec<usize> = variable.dimensions.iter().map(length).collect();
            PyResult::Ok(Column {
                values: convert::array(py, &shape, variable.values)?.unbind(),
                name: variable.name,
                long_name: variable.long_name,
                quantity: variable.quantity,
                dimensions: variable.dimensions,
            })
        };
        let columns = record.variables.into_iter().map(column).collect::<PyResult<_>>()?;
        Ok(Self { columns, units }.into())
    }

    /// The record of the core, with copied values.
    pub fn copy(&self, py: Python<'_>) -> PyResult<record::Record> {
        let variable = |column: &Column| {
            let values: PyReadonlyArrayDyn<'_, f64> = column.values.bind(py).extract()?;
            PyResult::Ok(Variable {
                name: column.name.clone(),
                long_name: column.long_name.clone(),
                quantity: column.quantity,
                dimensions: column.dimensions.clone(),
                values: values.as_array().iter().copied().collect(),
            })
        };
        let variables = self.columns.iter().map(variable).collect::<PyResult<_>>()?;
        Ok(record::Record { variables })
    }

    /// The bytes of a pickle: `content`, and the record.
    pub fn packed(&self, py: Python<'_>, content: &impl Serialize) -> PyResult<Vec<u8>> {
        let arrays: Vec<PyReadonlyArrayDyn<'_, f64>> =
            self.columns.iter().map(|column| column.values.bind(py).extract()).collect::<PyResult<_>>()?;
        let values: Vec<&[f64]> =
            arrays.iter().map(|array| Ok(array.as_slice()?)).collect::<PyResult<_>>()?;
        let described = self.columns.iter().zip(&values).map(|(column, values)| {
            let Column { name, long_name, quantity, dimensions, .. } = column;
            let without_values = Variable {
                name: name.clone(),
                long_name: long_name.clone(),
                quantity: *quantity,
                dimensions: dimensions.clone(),
                values: Vec::new(),
            };
            (without_values, values.len())
        });
        let head = Head { content, units: self.units.clone(), variables: described.collect() };
        pickle::pack(&head, &values)
    }

    /// What [`Self::packed`] was given, and the record.
    pub fn unpacked<T: DeserializeOwned>(
        py: Python<'_>,
        bytes: &[u8],
    ) -> PyResult<(T, PyClassInitializer<Self>)> {
        let (head, values) = pickle::unpack::<Head<T>>(bytes)?;
        let mut left = values.as_slice();
        let mut variables = Vec::with_capacity(head.variables.len());
        for (without_values, count) in head.variables {
            let (own, rest) = left.split_at_checked(count).ok_or_else(|| damaged("fewer"))?;
            variables.push(Variable { values: own.to_vec(), ..without_values });
            left = rest;
        }
        let record = Self::new(py, record::Record { variables }, head.units).map_err(damaged)?;
        Ok((head.content, record))
    }

    /// The record that was pickled.
    pub fn restored(py: Python<'_>, bytes: &[u8]) -> PyResult<Py<PyAny>> {
        let ((), record) = Self::unpacked(py, bytes)?;
        Ok(Py::new(py, record)?.into_any())
    }

    /// The columns of events by name; whole numbers as such.
    pub fn events_into(&self, columns: &Bound<'_, PyDict>) -> PyResult<()> {
        for column in &self.columns {
            if let Some(name) = column.name.strip_prefix("event_") {
                let values = column.values.bind(columns.py());
                let count = column.quantity == Quantity::Count;
                let whole = || values.call_method1("astype", ("int64",));
                columns.set_item(name, if count { whole()? } else { values.clone() })?;
            }
        }
        Ok(())
    }

    /// The names of the variables.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.name.as_str())
    }
}

/// A record without its values, and what belongs to it.
#[derive(Serialize, Deserialize)]
struct Head<T> {
    content: T,
    units: Units,
    /// Each with the number of its values.
    variables: Vec<(Variable, usize)>,
}

#[pymethods]
impl Record {
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<typed::Array<'py>> {
        let found = self.columns.iter().find(|column| column.name == name);
        let unknown = || {
            let names: Vec<_> = self.names().collect();
            PyKeyError::new_err(format!("expected one of {}, got {name}", names.join(", ")))
        };
        found.map(|column| typed::Array(column.values.bind(py).clone())).ok_or_else(unknown)
    }

    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        name.extract::<String>().is_ok_and(|name| self.names().any(|known| known == name))
    }

    fn __len__(&self) -> usize {
        self.columns.len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<typed::Names<'py>> {
        Ok(typed::Names(self.keys().into_pyobject(py)?.try_iter()?.into_any()))
    }

    /// The names of the variables.
    ///
    /// Returns
    /// -------
    /// KeysView[str]
    #[pyo3(signature = () -> "KeysView[str]")]
    fn keys(&self) -> Vec<&str> {
        self.names().collect()
    }

    /// The arrays of the variables.
    ///
    /// Returns
    /// -------
    /// ValuesView[numpy.ndarray]
    #[pyo3(signature = () -> "ValuesView[_Array]")]
    fn values<'py>(&self, py: Python<'py>) -> Vec<typed::Array<'py>> {
        self.columns.iter().map(|column| typed::Array(column.values.bind(py).clone())).collect()
    }

    /// Names and arrays of the variables.
    ///
    /// Returns
    /// -------
    /// ItemsView[str, numpy.ndarray]
    #[pyo3(signature = () -> "ItemsView[str, _Array]")]
    fn items<'py>(&self, py: Python<'py>) -> Vec<(&str, typed::Array<'py>)> {
        self.names().zip(self.values(py)).collect()
    }

    /// The array called key, or default.
    ///
    /// Parameters
    /// ----------
    /// key
    ///     The name of a variable.
    /// default
    ///     What to return if there is none.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray or None or numpy.ndarray or _T
    ///
    /// Raises
    /// ------
    /// TypeError
    ///     For an argument of another type, which the message names.
    #[pyo3(signature = (key, default: "None; _Array | _T" = None, /) -> "_Array | None; _Array | _T")]
    fn get<'py>(
        &self,
        py: Python<'py>,
        key: &str,
        default: Option<Bound<'py, PyAny>>,
    ) -> Option<Bound<'py, PyAny>> {
        self.__getitem__(py, key).ok().map(|found| found.0).or(default)
    }

    /// Positions X of the slider's base: an array of shape (n,), a length.
    #[getter]
    fn position<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        self.__getitem__(py, "position")
    }

    /// The friction force F at the positions, shape (n,): the total force of all N_c contacts; where contacts break
    /// simultaneously, after the break.
    #[getter]
    fn force<'py>(&self, py: Python<'py>) -> PyResult<typed::Array<'py>> {
        self.__getitem__(py, "force")
    }

    /// An xarray.Dataset with named dimensions, long names and units. It needs xarray.
    ///
    /// Returns
    /// -------
    /// xarray.Dataset
    #[pyo3(signature = () -> "Dataset")]
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._xarray")?.call_method1("dataset", (slf,))
    }

    /// Plots the result; it needs matplotlib, whose styles it follows.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Axes to plot on; new ones by default.
    /// kind : str, optional
    ///     One of `pictures`; by default the first: the force of a pull or a drive, the friction of a velocity curve or a
    ///     hold curve, the spectrum, the fit, the thresholds of a renormalisation.
    /// **style
    ///     Arguments of the plot() of the axes for the curve, or of pcolormesh or imshow for a map. A "map" also takes
    ///     `at`, the drive whose map is shown, by default the last.
    ///
    /// Returns
    /// -------
    /// matplotlib.axes.Axes
    ///     The axes.
    ///
    /// Raises
    /// ------
    /// ValueError
    ///     For a kind that the result does not have.
    /// ImportError
    ///     If matplotlib is not installed.
    #[pyo3(signature = (ax: "Axes | None" = None, *, kind: "str | None" = None, **style: "Any") -> "Axes")]
    pub fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        kind: Option<Argument<String>>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let kind = kind.get("kind")?;
        slf.py().import("asperity._pictures")?.call_method("draw", (slf, ax, kind), style)
    }

    /// The kinds of pictures that plot() draws of this result; the first is its default.
    #[getter]
    fn pictures(slf: &Bound<'_, Self>) -> PyResult<typed::Words> {
        let kinds = slf.py().import("asperity._pictures")?.call_method1("kinds", (slf,))?;
        kinds.extract().map(typed::Words)
    }

    /// The names of the variables that are coordinates of the others.
    fn _coordinates(&self) -> Vec<&str> {
        let known = |column: &&Column| is_coordinate(&column.name, &column.dimensions);
        self.columns.iter().filter(known).map(|column| column.name.as_str()).collect()
    }

    fn _attributes<'py>(&self, py: Python<'py>) -> PyResult<typed::Values<'py>> {
        let version = ("version".to_owned(), Attribute::Text(VERSION.to_owned()));
        attributes(py, output::common().into_iter().chain([version]).collect())
    }

    /// Dimensions, descriptive name and unit of each variable.
    #[getter]
    fn labels<'py>(&self, py: Python<'py>) -> PyResult<typed::Labels<'py>> {
        let labels = PyDict::new(py);
        for column in &self.columns {
            let unit = self.units.label(column.quantity);
            let label = values::label(py, &column.dimensions, &column.long_name, &unit, column.quantity)?;
            labels.set_item(&column.name, label)?;
        }
        Ok(typed::Labels(labels.into_any()))
    }

    #[pyo3(signature = () -> "tuple[Any, tuple[Any, ...]]")]
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let bytes = slf.get().packed(slf.py(), &())?;
        pickle::reduced(slf.py(), "Record", &bytes, None)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._show")?.call_method1("record", (slf,))?.extract()
    }

    fn _repr_html_(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._show")?.call_method1("record_html", (slf,))?.extract()
    }
}

/// Attributes of a result by name.
pub fn attributes(py: Python<'_>, found: Vec<(String, Attribute)>) -> PyResult<typed::Values<'_>> {
    let attributes = PyDict::new(py);
    for (name, attribute) in found {
        match attribute {
            Attribute::Text(text) => attributes.set_item(name, text),
            Attribute::Whole(number) => attributes.set_item(name, number),
            Attribute::Seed(number) => attributes.set_item(name, number),
            Attribute::Number(number) => attributes.set_item(name, number),
        }?;
    }
    Ok(typed::Values(attributes.into_any()))
}
