//! Labels of axes of sweeps: the words and symbols of the literature for keys and for what is kept.

use asperity_runner::sweep::Labelled;

/// Words of keys of the scenario, and of numbers and variables that are kept.
const WORDS: [(&str, &str); 23] = [
    ("block.stiffness", "Stiffness of the spring K"),
    ("contacts.ageing.logarithmic.growth", "Growth β of thresholds per factor e in age"),
    ("contacts.background_force", "Background force"),
    ("contacts.count", "Number of contacts N_c"),
    ("contacts.delay.time", "Delay τ"),
    ("contacts.normal_load", "Normal load"),
    ("contacts.stiffness", "Stiffness of a contact k"),
    ("contacts.temperature.energy", "Temperature T"),
    ("critical_stiffness", "Critical stiffness K_c"),
    ("critical_stiffness_sliding", "Critical stiffness of steady sliding K_c"),
    ("drive.velocity", "Velocity v"),
    ("force", "Friction force F"),
    ("kinetic_friction", "Kinetic friction F_k"),
    ("mean_drop", "Mean drop of the force"),
    ("period", "Period of stick-slip"),
    ("position", "Position X"),
    ("pull.velocity", "Velocity v"),
    ("relaxation_length", "Relaxation length X*"),
    ("slips", "Number of slips"),
    ("static_friction.force", "Static friction F_s"),
    ("static_friction.position", "Position of static friction X_s"),
    ("time", "Time t"),
    ("velocity", "Velocity v"),
];

/// Words of the tables with a distribution.
const DISTRIBUTIONS: [(&str, &str); 3] = [
    ("contacts.thresholds.", "thresholds"),
    ("contacts.reforming.", "re-formed stretches"),
    ("initial.", "initial stretches"),
];

/// Words of the parameters of distributions.
const PARAMETERS: [(&str, &str); 5] = [
    ("mean", "Mean of"),
    ("std", "Standard deviation σ of"),
    ("min", "Lowest end of"),
    ("max", "Highest end of"),
    ("shape", "Shape of the distribution of"),
];

/// The label of a variable with its unit. A key without words of its own stays as it is.
pub fn label(variable: &Labelled) -> String {
    let words = words(&variable.key).unwrap_or_else(|| variable.key.clone());
    let units = &variable.units;
    if units.is_empty() || units == "1" { words } else { format!("{words} ({units})") }
}

fn words(key: &str) -> Option<String> {
    let known = WORDS.iter().find(|(known, _)| *known == key).map(|(_, words)| (*words).to_owned());
    known.or_else(|| parameter(key))
}

/// The words of a parameter of a distribution, such as `contacts.thresholds.gaussian.std`.
fn parameter(key: &str) -> Option<String> {
    let (name, of) = DISTRIBUTIONS
        .iter()
        .find_map(|(table, of)| Some((key.strip_prefix(table)?.split_once('.')?.1, of)))?;
    let (_, words) = PARAMETERS.iter().find(|(known, _)| *known == name)?;
    Some(format!("{words} {of}"))
}

#[cfg(test)]
mod tests {
    use asperity_runner::sweep::Values;

    use super::*;

    fn labelled(key: &str, units: &str) -> String {
        let (name, long_name) = (String::new(), String::new());
        let values = Values::Numbers(Vec::new());
        let (key, units, dimensions) = (key.to_owned(), units.to_owned(), Vec::new());
        label(&Labelled { name, long_name, key, units, dimensions, values })
    }

    #[test]
    fn known_keys_have_words_and_others_stay() {
        assert_eq!(
            labelled("contacts.thresholds.gamma.std", "µm"),
            "Standard deviation σ of thresholds (µm)"
        );
        assert_eq!(labelled("initial.rectangular.max", "1"), "Highest end of initial stretches");
        assert_eq!(labelled("block.stiffness", ""), "Stiffness of the spring K");
        assert_eq!(labelled("contacts.thresholds", ""), "contacts.thresholds");
        assert_eq!(labelled("interface.connection", ""), "interface.connection");
    }

    #[test]
    fn words_are_in_order_of_their_keys() {
        assert!(WORDS.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
