//! A variable of a result at other places along its coordinate, so that results can be compared point by point.

use super::is_coordinate;
use crate::record::{Record, Variable};
use crate::{Error, Result};

/// The variable called `name`, which has one dimension, at `places` along its [`coordinate`]: linear between its points, NaN beyond
/// them. Where it jumps, at two points of the same coordinate, the value is the one after the jump.
///
/// # Errors
/// No such variable, one of several dimensions, a coordinate that falls.
pub fn interpolated(record: &Record, name: &str, places: &[f64]) -> Result<Vec<f64>> {
    let refused = |found: &str| Error::invalid(name, "a variable along one rising coordinate", found);
    let variable = record.get(name).ok_or_else(|| refused("none of this name"))?;
    if variable.dimensions.len() != 1 {
        return Err(refused(&format!("one along {}", variable.dimensions.join(" and "))));
    }
    let along = coordinate(record, variable).ok_or_else(|| refused("one without a coordinate"))?;
    if !along.values.is_sorted() {
        return Err(refused(&format!("one whose {} falls", along.name)));
    }
    Ok(places.iter().map(|&place| linear(&along.values, &variable.values, place)).collect())
}

/// The coordinate of a variable along one dimension: the first other variable that is one of this dimension.
pub fn coordinate<'a>(record: &'a Record, variable: &Variable) -> Option<&'a Variable> {
    let [dimension] = &variable.dimensions[..] else { return None };
    let along = |v: &&Variable| {
        is_coordinate(&v.name, &v.dimensions) && v.dimensions[0] == *dimension && v.name != variable.name
    };
    record.variables.iter().find(along)
}

/// The function through the points (x, y), with rising x, at a place.
fn linear(x: &[f64], y: &[f64], place: f64) -> f64 {
    let after = x.partition_point(|&x| x <= place);
    match (after.checked_sub(1), after < x.len()) {
        (None, _) => f64::NAN,
        (Some(i), _) if x[i] == place => y[i],
        (Some(_), false) => f64::NAN,
        (Some(i), true) => y[i] + (y[after] - y[i]) * ((place - x[i]) / (x[after] - x[i])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Quantity;

    fn record() -> Record {
        let mut record = Record::default();
        record.push("position", "position", Quantity::Length, &["position"], vec![0.0, 1.0, 1.0, 3.0]);
        record.push("force", "force", Quantity::Force, &["position"], vec![0.0, 2.0, 1.0, 5.0]);
        record.push("count", "count", Quantity::Count, &["other"], vec![1.0]);
        record
    }

    #[test]
    fn values_are_linear_between_points_and_unknown_beyond() {
        let found = interpolated(&record(), "force", &[-0.5, 0.0, 0.5, 1.0, 2.0, 3.0, 3.5]).unwrap();
        assert!(found[0].is_nan() && found[6].is_nan());
        assert_eq!(found[1..6], [0.0, 1.0, 1.0, 3.0, 5.0]);
    }

    #[test]
    fn what_has_no_rising_coordinate_is_refused() {
        let error = |name| interpolated(&record(), name, &[0.0]).unwrap_err().to_string();
        assert!(error("missing").contains("none of this name"));
        assert!(error("count").contains("without a coordinate"));
        // A coordinate is not its own.
        assert!(error("position").contains("without a coordinate"));
        let mut falling = record();
        falling.variables[0].values[3] = 0.5;
        assert!(interpolated(&falling, "force", &[0.0]).unwrap_err().to_string().contains("position falls"));
    }
}
