//! Which variables of results are coordinates: where the others are given.

/// Variables along one dimension that are coordinates on it, beside those that are named like their dimension. Their values need
/// not rise: the drive stays where it is during a slip.
pub const COORDINATES: [&str; 20] = [
    "drive",
    "time",
    "event_drive",
    "event_time",
    "ensemble_drive",
    "ensemble_time",
    "ensemble_event_drive",
    "ensemble_event_time",
    "map_time",
    "slip_rate_step",
    "slip_rate_drive",
    "branch_position",
    "compared_position",
    "compared_velocity",
    "compared_hold",
    "breaking_atom_position",
    "stretch_atom_position",
    "stretch_atom_stretch",
    "steady_atom_stretch",
    "threshold_atom_stretch",
];

/// Whether a variable along `dimensions` is a coordinate.
pub fn is_coordinate(name: &str, dimensions: &[String]) -> bool {
    dimensions.len() == 1 && (dimensions[0] == name || COORDINATES.contains(&name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::columns;

    #[test]
    fn every_coordinate_is_a_variable_along_one_dimension() {
        let all = columns();
        let variables = || all.iter().flat_map(|(_, record)| &record.variables);
        for name in COORDINATES {
            assert!(variables().any(|variable| variable.name == name), "{name}");
            assert!(variables().all(|v| v.name != name || v.dimensions.len() == 1), "{name}");
        }
    }
}
