//! What a fit has found as plain values, which travel in pickles, and its search, which is made again where it is needed.

use asperity::fit;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use serde::{Deserialize, Serialize};

use crate::convert::Import;
use crate::pickle::{self, Reduced, VERSION};

/// A number that a fit has found: its name, value, error and interval, and its limit if it has one.
type PlainEstimate = (String, f64, f64, [f64; 2], Option<f64>);

/// The numbers that a fit has found.
#[derive(Serialize, Deserialize)]
pub struct FittedNumbers {
    parameters: Vec<PlainEstimate>,
    /// Covariance of the estimates, row by row.
    pub covariance: Vec<f64>,
    /// Correlations of their errors.
    pub correlations: Vec<fit::Correlation>,
    /// Whether the search has converged.
    pub converged: bool,
    /// Whether the readings are so far apart that other contacts may have the same forces there.
    pub sparse: bool,
    /// Solutions of the master equation that it took.
    pub solutions: usize,
    /// How well the measurement is described.
    pub misfit: Option<fit::Misfit>,
    /// The numbers that were not free.
    pub fixed: Vec<(String, f64)>,
    /// The standard deviation of the independent error of a reading.
    pub reading: f64,
    /// The reading of the force where there is none.
    pub offset: f64,
    /// The number of readings.
    pub readings: usize,
}

impl FittedNumbers {
    /// The numbers of a fit to a curve.
    pub fn of(found: &fit::Estimates) -> Self {
        Self {
            parameters: plain(&found.parameters),
            covariance: found.covariance.clone(),
            correlations: found.correlations(),
            converged: found.converged,
            sparse: found.is_sparse(),
            solutions: found.solutions,
            misfit: found.misfit,
            fixed: found.fixed(),
            reading: found.reading,
            offset: found.machine(0).offset,
            readings: found.readings.iter().map(|curve| curve.expected.len()).sum(),
        }
    }

    /// The numbers of a fit to a record of steady sliding.
    pub fn of_steady(found: &fit::SteadyEstimates) -> Self {
        Self {
            parameters: plain(&found.parameters),
            covariance: found.covariance.clone(),
            correlations: found.correlations(),
            converged: found.converged,
            sparse: false,
            solutions: found.solutions,
            misfit: Some(found.misfit),
            fixed: found.fixed(),
            reading: found.reading,
            offset: found.offset,
            readings: found.record().forces.len(),
        }
    }

    /// The numbers of a fit to forces at several velocities.
    pub fn of_velocity_curve(found: &fit::VelocityCurveEstimates) -> Self {
        Self {
            parameters: plain(&found.parameters),
            covariance: found.covariance.clone(),
            correlations: found.correlations(),
            converged: found.converged,
            sparse: false,
            solutions: found.solutions,
            misfit: Some(found.misfit),
            fixed: found.fixed(),
            reading: found.reading,
            offset: found.offset,
            readings: found.curve().forces.len(),
        }
    }

    /// The estimates.
    pub fn parameters(&self) -> Vec<fit::Estimate> {
        let estimate = |(name, value, error, interval, limit): &PlainEstimate| fit::Estimate {
            name: name.clone(),
            value: *value,
            error: *error,
            interval: *interval,
            limit: *limit,
        };
        self.parameters.iter().map(estimate).collect()
    }

    /// The bytes of a pickle.
    pub fn written(&self) -> PyResult<Vec<u8>> {
        pickle::pack(self, &[])
    }

    /// The numbers that were written.
    pub fn read(bytes: &[u8]) -> PyResult<Self> {
        Ok(pickle::unpack(bytes)?.0)
    }
}

fn plain(parameters: &[fit::Estimate]) -> Vec<PlainEstimate> {
    let one = |one: &fit::Estimate| (one.name.clone(), one.value, one.error, one.interval, one.limit);
    parameters.iter().map(one).collect()
}

/// The arguments of a fit that give the same search again.
pub struct Arguments {
    /// The function of the package, `fit`, `fit_steady` or `fit_velocity_curve`.
    pub function: &'static str,
    /// Its arguments by name.
    pub named: Py<PyDict>,
    /// The family of thresholds whose fit it is, of those in `Estimates.laws`.
    pub law: Option<String>,
}

impl Arguments {
    /// The same arguments for the fit of a family of thresholds.
    pub fn of_law(&self, py: Python<'_>, law: &str) -> PyResult<Self> {
        let named = self.named.bind(py).copy()?;
        named.set_item("laws", (law,))?;
        Ok(Self { function: self.function, named: named.unbind(), law: Some(law.to_owned()) })
    }

    /// What restores a fit: its numbers, these arguments, and the objects that it has.
    pub fn reduced<'py>(
        &self,
        py: Python<'py>,
        reported: &[u8],
        parts: Bound<'py, PyTuple>,
    ) -> PyResult<Reduced<'py>> {
        static RESTORE: Import = Import::new("asperity._core", "_restore_fit");
        let arguments =
            (VERSION, self.function, self.named.bind(py), &self.law, PyBytes::new(py, reported), parts);
        Ok((RESTORE.get(py)?.clone(), arguments.into_pyobject(py)?))
    }

    fn again<T: pyo3::PyClass>(&self, py: Python<'_>) -> PyResult<Py<T>> {
        let function = py.import("asperity._core")?.getattr(self.function)?;
        let mut found = function.call((), Some(self.named.bind(py)))?;
        if let Some(law) = &self.law {
            found = found.getattr("laws")?.get_item(law)?;
        }
        Ok(found.cast_into::<T>().map_err(PyErr::from)?.unbind())
    }
}

/// The end of a search: of the fit itself, or in the object of the same fit, made when it is needed.
pub enum Search<T, F> {
    Own(Box<F>),
    Again(PyOnceLock<Py<T>>),
}

impl<T: pyo3::PyClass, F> Search<T, F> {
    /// The end of the search; `other` finds it in another object.
    pub fn get<'a>(
        &'a self,
        py: Python<'_>,
        arguments: &Arguments,
        other: impl FnOnce(&'a Py<T>) -> Option<&'a F>,
    ) -> PyResult<&'a F> {
        match self {
            Self::Own(found) => Ok(found),
            Self::Again(same) => {
                let same = same.get_or_try_init(py, || arguments.again(py))?;
                other(same).ok_or_else(|| pickle::damaged("a fit without a search"))
            }
        }
    }

    /// The end of this search, if it is here.
    pub fn own(&self) -> Option<&F> {
        if let Self::Own(found) = self { Some(found) } else { None }
    }
}
