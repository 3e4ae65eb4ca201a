//! Measured curves as Python gives them: one, or a list of several.

use asperity::fit::{Machine, Measurement};
use pyo3::prelude::*;

use crate::argument::{Real, Whole};
use crate::convert;
use crate::error;
use crate::typed::argument_type;

/// The compliance of the machine: a number, or "free".
pub enum Compliance {
    Known(f64),
    Free,
}

impl Compliance {
    /// The argument itself.
    pub fn to_object(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        Ok(match self {
            Self::Known(compliance) => compliance.into_pyobject(py)?.into_any().unbind(),
            Self::Free => "free".into_pyobject(py)?.into_any().unbind(),
        })
    }
}

impl<'py> FromPyObject<'_, 'py> for Compliance {
    type Error = PyErr;

    argument_type!("_Number | Literal['free']");

    fn extract(value: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        match value.extract::<String>() {
            Ok(word) if word == "free" => Ok(Self::Free),
            Ok(word) => Err(error::invalid("compliance", "a number or \"free\"", word)),
            Err(_) => value.extract::<Real>()?.get("compliance").map(Self::Known),
        }
    }
}

/// The measured curves, averaged, with the machine that measured them; `stiffness` is that of all contacts together, for the
/// first value of a free compliance.
pub fn curves(
    position: &Bound<'_, PyAny>,
    force: Option<&Bound<'_, PyAny>>,
    (machine, compliance): (Machine, &Compliance),
    (average, stiffness): (Whole, f64),
) -> PyResult<Vec<Measurement>> {
    let average = average.get("average")?;
    let positions = lists("position", position)?;
    let forces = match force {
        Some(force) => lists("force", force)?,
        None => vec![Vec::new(); positions.len()],
    };
    if force.is_some() && forces.iter().any(Vec::is_empty) {
        let expected = "measured forces, or None for a planned measurement";
        return Err(error::invalid("force", expected, "an empty list"));
    }
    if forces.len() != positions.len() {
        let expected = format!("the forces of {} curves", positions.len());
        return Err(error::invalid("force", &expected, format!("those of {}", forces.len())));
    }
    let measured = |(positions, forces)| {
        let mut averaged = Measurement { machine, ..Measurement::new(positions, forces) }
            .average(average)
            .map_err(error::core)?;
        if matches!(compliance, Compliance::Free) {
            averaged.machine.compliance = averaged.first_compliance(stiffness);
        }
        Ok(averaged)
    };
    positions.into_iter().zip(forces).map(measured).collect()
}

/// A list of numbers, or several in a list or as the rows of an array.
fn lists(key: &str, values: &Bound<'_, PyAny>) -> PyResult<Vec<Vec<f64>>> {
    let several = values
        .try_iter()
        .is_ok_and(|mut items| items.next().and_then(Result::ok).is_some_and(|first| first.len().is_ok()));
    if !several {
        return Ok(vec![convert::list(key, values)?]);
    }
    let items = values.try_iter()?.enumerate();
    items.map(|(i, item)| convert::list(&format!("{key}.{i}"), &item?)).collect()
}
