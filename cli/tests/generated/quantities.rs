//! What the numbers of a scenario measure, so that all can be given in other units, and which values are ordinary.

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

/// What the number under `key` of the table `path` is. Keys of distributions are not listed: these know their parameters.
///
/// # Panics
/// A key that is not listed: a new one needs a line.
pub fn of(path: &str, key: &str) -> Quantity {
    let table = path.rsplit('.').next().unwrap_or_default();
    let (dimension, ordinary) = match (table, key) {
        ("pull" | "drive", "distance") => ([1, 0, 0], [0.0, 0.8]),
        ("pull", "snapshots") | ("drive", "turning_points" | "maps") | ("compare", "position") => {
            ([1, 0, 0], [-1.0, 0.0])
        }
        (_, "distance" | "catalogue_from") => ([1, 0, 0], [-1.0, 0.5]),
        ("half_space", "cell") => ([1, 0, 0], [-1.0, 1.0]),
        ("drive", "force_to") | ("compare", "force") | ("contacts", "normal_load") => {
            ([0, 1, 0], [-1.0, 0.5])
        }
        ("contacts", "stiffness") | ("block", "stiffness") => ([-1, 1, 0], [-1.0, 1.0]),
        ("neighbours", "stiffness") | ("interface", "connection") => ([-1, 1, 0], [-2.0, 1.0]),
        ("contacts", "stiffness_per_threshold") | ("areas", "modulus" | "strength") => {
            ([-2, 1, 0], [-1.0, 1.0])
        }
        ("half_space", "modulus") => ([-2, 1, 0], [-1.0, 1.0]),
        ("temperature", "energy") | ("velocity_curve", "temperatures") => ([1, 1, 0], [-3.0, 0.0]),
        ("temperature", "attempt_rate") => ([0, 0, -1], [-1.0, 3.0]),
        ("frozen_rank" | "logarithmic", "time") => ([0, 0, 1], [-2.0, 2.0]),
        ("delay", "time") => ([0, 0, 1], [-2.0, 1.0]),
        ("hold_curve", "from" | "to") => ([0, 0, 1], [-1.0, 3.0]),
        (_, "duration" | "hold") => ([0, 0, 1], [-1.0, 1.0]),
        (_, "velocity" | "velocity_to") | ("velocity_curve", "from" | "to") => ([1, 0, -1], [-3.0, 1.0]),
        ("smoluchowski" | "mean_field", "diffusion") => ([2, 0, -1], [-4.0, -1.0]),
        ("interface", "viscosity") | ("damped" | "inertial", "damping") => ([-1, 1, 1], [-2.0, 1.0]),
        ("inertial", "mass") => ([-1, 1, 2], [-2.0, 1.0]),
        ("contacts", "count") => ([0, 0, 0], [0.0, 3.0]),
        ("logarithmic", "growth") => ([0, 0, 0], [-3.0, -0.5]),
        ("block", "slip_fraction") => ([0, 0, 0], [-2.0, 0.0]),
        ("master_equation", "tolerance") => ([0, 0, 0], [-9.0, -3.0]),
        ("interface", "drive_tolerance") => ([0, 0, 0], [-8.0, -4.0]),
        ("disorder", "std") => ([0, 0, 0], [-3.0, -0.5]),
        ("disorder", "scale") => ([0, 0, 0], [-0.1, 0.1]),
        _ => panic!("{path}.{key}: what it measures is not listed"),
    };
    Quantity { dimension, ordinary }
}
