//! Results as labelled columns, with values in NumPy arrays.

use asperity::record::{self, Quantity, Variable};
use asperity::scenario::Units;
use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

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

    /// The names of the variables.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.name.as_str())
    }
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
    #[pyo3(signature = () -> "KeysView[str]")]
    fn keys(&self) -> Vec<&str> {
        self.names().collect()
    }

    /// The arrays of the variables.
    #[pyo3(signature = () -> "ValuesView[_Array]")]
    fn values<'py>(&self, py: Python<'py>) -> Vec<typed::Array<'py>> {
        self.columns.iter().map(|column| typed::Array(column.values.bind(py).clone())).collect()
    }

    /// Names and arrays of the variables.
    #[pyo3(signature = () -> "ItemsView[str, _Array]")]
    fn items<'py>(&self, py: Python<'py>) -> Vec<(&str, typed::Array<'py>)> {
        self.names().zip(self.values(py)).collect()
    }

    /// The array called key, or default.
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
    #[pyo3(signature = () -> "Dataset")]
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._xarray")?.call_method1("dataset", (slf,))
    }

    /// Plots the force along the pull or the drive (for an imposed force, the force against the position), with the
    /// kinetic friction and, for a pull, the static friction, if they are known. Returns the axes. It needs
    /// matplotlib.
    ///
    /// ax: axes to plot on; new ones if None. Other arguments are passed to its plot().
    #[pyo3(signature = (ax: "Axes | None" = None, **style: "Any") -> "Axes")]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<&Bound<'py, PyAny>>,
        style: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("asperity._plot")?.call_method("draw", (slf, ax), style)
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

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._show")?.call_method1("record", (slf,))?.extract()
    }

    fn _repr_html_(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("asperity._show")?.call_method1("record_html", (slf,))?.extract()
    }
}
