//! Results from their pickles, each by the class that wrote it.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::ensemble::EnsemblePull;
use crate::estimates::Estimates;
use crate::fit_steady::SteadyEstimates;
use crate::fit_velocity_curve::VelocityCurveEstimates;
use crate::found::Arguments;
use crate::gradient::FrictionGradient;
use crate::pickle::{check_version, damaged};
use crate::posterior::Posterior;
use crate::pull::Pull;
use crate::rate_state::{Healing, VelocityStep};
use crate::record::Record;
use crate::result::Result;
use crate::stick_slip::StickSlip;

/// The fit that was pickled.
#[pyfunction(name = "_restore_fit")]
#[pyo3(signature = (version, function, named: "dict[str, object]", law, content, parts: "tuple[Any, ...]") -> "object")]
pub fn restore_fit(
    py: Python<'_>,
    version: &str,
    function: &str,
    named: Bound<'_, PyDict>,
    law: Option<String>,
    content: &[u8],
    parts: Bound<'_, PyTuple>,
) -> PyResult<Py<PyAny>> {
    check_version(version)?;
    let named = named.unbind();
    let other = |_| damaged("a fit with other parts");
    match function {
        "fit" => {
            let (model, pull, readings, laws) = parts.extract().map_err(other)?;
            let given = Arguments { function: "fit", named, law };
            let fit = Estimates::restored(given, content, (model, pull), (readings, laws))?;
            Ok(Py::new(py, fit)?.into_any())
        }
        "fit_steady" => {
            let given = Arguments { function: "fit_steady", named, law };
            let fit = SteadyEstimates::restored(given, content, parts.extract().map_err(other)?)?;
            Ok(Py::new(py, fit)?.into_any())
        }
        "fit_velocity_curve" => {
            let given = Arguments { function: "fit_velocity_curve", named, law };
            let fit = VelocityCurveEstimates::restored(given, content, parts.extract().map_err(other)?)?;
            Ok(Py::new(py, fit)?.into_any())
        }
        found => Err(damaged(format!("a {found:?}"))),
    }
}

/// The result that was pickled.
#[pyfunction(name = "_restore_result")]
#[pyo3(signature = (version, kind, content, model: "object" = None) -> "object")]
pub fn restore_result(
    py: Python<'_>,
    version: &str,
    kind: &str,
    content: &[u8],
    model: Option<Bound<'_, PyAny>>,
) -> PyResult<Py<PyAny>> {
    check_version(version)?;
    match kind {
        "Record" => Record::restored(py, content),
        "Result" => Result::restored(py, content),
        "Pull" => Pull::restored(py, content, model),
        "FrictionGradient" => FrictionGradient::restored(py, content),
        "EnsemblePull" => EnsemblePull::restored(py, content, model),
        "StickSlip" => StickSlip::restored(py, content, model),
        "VelocityStep" => VelocityStep::restored(py, content),
        "Healing" => Healing::restored(py, content),
        "Posterior" => Posterior::restored(py, content),
        other => Err(damaged(format!("a {other:?}"))),
    }
}
