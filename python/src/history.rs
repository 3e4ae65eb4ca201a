//! The motion of a load point that was measured.

use asperity::history::measured_pieces;
use pyo3::prelude::*;

use crate::argument::Whole;
use crate::convert;
use crate::error;

/// First reading, the one after the last, time of the beginning, velocity and its standard error.
type Piece = (usize, usize, f64, f64, f64);

/// The pieces of constant velocity in a measured motion: first reading, the one after the last, time of the beginning,
/// velocity and its standard error.
#[pyfunction(name = "_measured_pieces")]
#[pyo3(signature = (time: "ArrayLike", position: "ArrayLike", apart, least) -> "list[tuple[int, int, float, float, float]]")]
pub fn pieces(
    time: &Bound<'_, PyAny>,
    position: &Bound<'_, PyAny>,
    apart: f64,
    least: Whole,
) -> PyResult<Vec<Piece>> {
    let (time, position) = (convert::list("time", time)?, convert::list("position", position)?);
    let found = measured_pieces(&time, &position, (apart, least.get("least")?)).map_err(error::core)?;
    Ok(found
        .into_iter()
        .map(|piece| (piece.readings.start, piece.readings.end, piece.begin, piece.velocity, piece.error))
        .collect())
}
