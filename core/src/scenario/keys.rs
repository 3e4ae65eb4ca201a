//! Keys of a scenario for the arguments of the core.
//!
//! An error of the core names the argument that it refuses (`thresholds`); the reader of a scenario needs the key that gave its
//! value (`contacts.thresholds`). Only this module contains both.

use crate::Error;

/// Names of arguments, and of fields of them, with their keys. The first that fits counts. No table of a scenario is called like an
/// argument, so that keys are left as they are.
const KEYS: [(&str, &str); 23] = [
    ("thresholds", "contacts.thresholds"),
    ("reforming", "contacts.reforming"),
    ("stiffness.per_threshold", "contacts.stiffness_per_threshold"),
    ("stiffness.of_threshold", "contacts.stiffness_of_threshold"),
    ("temperature", "contacts.temperature"),
    ("ageing", "contacts.ageing"),
    ("delay", "contacts.delay"),
    ("free_friction", "contacts.free_friction"),
    ("population", "contacts.thresholds"),
    ("tolerance", "master_equation.tolerance"),
    ("size", "ensemble.size"),
    ("positions", "pull.points"),
    ("turning_points", "drive.turning_points"),
    ("slip", "block.slip"),
    ("cells", "interface.cells"),
    ("connection", "interface.connection"),
    ("viscosity", "interface.viscosity"),
    ("drive_tolerance", "interface.drive_tolerance"),
    ("neighbours", "interface.coupling.neighbours.stiffness"),
    ("stiffness", "interface.coupling.neighbours.stiffness"),
    ("modulus", "interface.coupling.half_space.modulus"),
    ("cell", "interface.coupling.half_space.cell"),
    ("poisson_ratio", "interface.coupling.half_space.poisson_ratio"),
];

impl Error {
    /// The same error about the key of a scenario that gave the argument.
    pub(crate) fn of_scenario(mut self) -> Self {
        if let Self::Invalid { key, .. } | Self::TooLarge { key, .. } | Self::Accuracy { key, .. } = &mut self
            && let Some(found) = key_of(key)
        {
            *key = found;
        }
        self
    }
}

/// The key for an argument or a part of one.
pub(super) fn key_of(argument: &str) -> Option<String> {
    KEYS.iter().find_map(|(name, key)| {
        let part = argument.strip_prefix(name)?;
        (part.is_empty() || part.starts_with('.')).then(|| format!("{key}{part}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_and_their_parts_have_keys_and_keys_stay() {
        for (argument, key) in [
            ("thresholds", Some("contacts.thresholds")),
            ("ageing.smoluchowski.diffusion", Some("contacts.ageing.smoluchowski.diffusion")),
            ("stiffness.per_threshold", Some("contacts.stiffness_per_threshold")),
            ("stiffness", Some("interface.coupling.neighbours.stiffness")),
            ("contacts.thresholds", None),
            ("cells_of_another", None),
            ("", None),
        ] {
            assert_eq!(key_of(argument).as_deref(), key, "{argument}");
        }
        assert!(KEYS.iter().all(|(_, key)| key_of(key).is_none()));
    }
}
