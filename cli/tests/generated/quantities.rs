//! What the numbers of a scenario measure, so that all can be given in other units, and which values are ordinary.

use serde_json::Value as Json;

/// Units in which a scenario is written, in those in which its numbers are near 1.
#[derive(Debug, Clone, Copy)]
pub struct Units {
    /// Of length.
    pub length: f64,
    /// Of force.
    pub force: f64,
    /// Of time.
    pub time: f64,
}

/// A number: exponents of length, force and time, and the decades in which ordinary values lie.
pub struct Quantity {
    dimension: [i32; 3],
    /// Decades of ordinary values.
    pub ordinary: [f64; 2],
}

impl Quantity {
    /// How large its unit is.
    pub fn unit(&self, units: Units) -> f64 {
        let [length, force, time] = self.dimension;
        units.length.powi(length) * units.force.powi(force) * units.time.powi(time)
    }
}

/// What the number under `key` of the table `path` is, from its `schema`. Keys of distributions have none: these know their
/// parameters.
///
/// # Panics
/// A number of which the schema declares no dimension.
pub fn of(schema: &Json, path: &str, key: &str) -> Quantity {
    let declared = schema["x-dimension"].as_str();
    let declared = declared.unwrap_or_else(|| panic!("{path}.{key}: x-dimension is not declared"));
    let table = path.rsplit('.').next().unwrap_or_default();
    Quantity { dimension: dimension(declared), ordinary: ordinary(declared, table, key) }
}

/// Exponents of length, force and time, from `force*time^2/length`.
fn dimension(declared: &str) -> [i32; 3] {
    let (above, below) = declared.split_once('/').unwrap_or((declared, "1"));
    let mut exponents = [0; 3];
    for (factors, sign) in [(above, 1), (below, -1)] {
        for factor in factors.split('*').filter(|factor| *factor != "1") {
            let (unit, power) = factor.split_once('^').unwrap_or((factor, "1"));
            let place = ["length", "force", "time"].iter().position(|known| *known == unit);
            let place =
                place.unwrap_or_else(|| panic!("{declared}: {unit} is neither length, force nor time"));
            exponents[place] += sign * power.parse::<i32>().expect("a whole power");
        }
    }
    exponents
}

/// Decades in which ordinary values lie: those of the dimension, with some exceptions.
fn ordinary(dimension: &str, table: &str, key: &str) -> [f64; 2] {
    match (table, key) {
        ("pull" | "drive", "distance") => [0.0, 0.8],
        ("pull", "snapshots") | ("drive", "turning_points" | "maps") | ("compare", "position") => [-1.0, 0.0],
        ("half_space", "cell") => [-1.0, 1.0],
        ("half_space", "poisson_ratio") => [-2.0, -0.35],
        ("neighbours", "stiffness") | ("interface", "connection") => [-2.0, 1.0],
        ("frozen_rank" | "logarithmic", "time") => [-2.0, 2.0],
        ("delay", "time") => [-2.0, 1.0],
        ("hold_curve", "from" | "to") => [-1.0, 3.0],
        ("creep", "forces") => [-1.0, -0.3],
        ("contacts", "count") => [0.0, 3.0],
        ("logarithmic", "growth") | ("disorder", "std") => [-3.0, -0.5],
        ("master_equation", "tolerance") => [-9.0, -3.0],
        ("interface", "drive_tolerance") => [-8.0, -4.0],
        ("disorder", "scale") => [-0.1, 0.1],
        ("figure", "width" | "height") => [1.9, 2.1],
        ("figure", "font_size") => [0.8, 1.0],
        ("figure", "dpi") => [1.5, 2.3],
        _ => match dimension {
            "length" | "force" => [-1.0, 0.5],
            "time" | "force/length" | "force/length^2" => [-1.0, 1.0],
            "force*length" => [-3.0, 0.0],
            "1/time" => [-1.0, 3.0],
            "1/length" => [0.0, 2.0],
            "length/time" => [-3.0, 1.0],
            "length^2/time" => [-4.0, -1.0],
            "1" => [-2.0, 0.0],
            _ => [-2.0, 1.0],
        },
    }
}
