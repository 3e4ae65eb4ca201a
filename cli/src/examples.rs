//! The scenarios that come with asperity.

use std::fmt::Write as _;

use asperity_runner::input;

/// A shipped file: its name and its text.
type Shipped = (&'static str, &'static str);

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!(env!("ASPERITY_SHIPPED"), "/scenarios/", $name)))),*]
    };
}

/// All files, simple ones first. Tables follow the scenario that names them.
const SHIPPED: [Shipped; 53] = shipped![
    "fig2.toml",
    "fig3.toml",
    "rectangular.toml",
    "identical.toml",
    "weibull.toml",
    "lognormal.toml",
    "quenched.toml",
    "areas.toml",
    "commensurate.toml",
    "compared.toml",
    "stick-slip-reset.toml",
    "stick-slip-overdamped.toml",
    "stick-slip-arrest.toml",
    "stick-slip-inertial.toml",
    "smooth-sliding.toml",
    "hysteresis.toml",
    "imposed-force.toml",
    "avalanches.toml",
    "laboratory.toml",
    "velocity-curve-thermal.toml",
    "velocity-curve-additive.toml",
    "velocity-curve-delay.toml",
    "velocity-curve-ageing.toml",
    "velocity-curve-mean-field.toml",
    "velocity-step.toml",
    "velocity-step-mean-field.toml",
    "slide-hold-slide.toml",
    "healing.toml",
    "creep.toml",
    "spectrum.toml",
    "fit.toml",
    "fit-cycles.toml",
    "fit-steady.toml",
    "stick-slip-ageing.toml",
    "slow-slip.toml",
    "stability.toml",
    "sweep-stability.toml",
    "sweep-critical-stiffness.toml",
    "ofc.toml",
    "aftershocks.toml",
    "front-chain.toml",
    "precursors-edge.toml",
    "half-space-512.toml",
    "front-ageing.toml",
    "front-waves.toml",
    "hold-chain.toml",
    "renormalised.toml",
    "renormalised-cells.toml",
    "first_loading.csv",
    "front-chain.csv",
    "measured-pull.csv",
    "measured-cycles.csv",
    "measured-noise.csv",
];

/// The first line of scenarios, by which editors find their schema.
const SCHEMA: &str = "#:schema asperity.schema.json";

/// The text of the example `name`, with or without `.toml`; scenarios name their schema.
pub fn find(name: &str) -> Option<String> {
    let is_named = |file: &str| file == name || file.strip_suffix(".toml") == Some(name);
    let (file, text) = SHIPPED.iter().find(|(file, _)| is_named(file))?;
    Some(if file.ends_with(".toml") { format!("{SCHEMA}\n{text}") } else { (*text).to_owned() })
}

/// The name of the example that is most similar to `name`, if one is similar at all.
pub fn nearest(name: &str) -> Option<&'static str> {
    let names = SHIPPED.iter().map(|(file, _)| file.strip_suffix(".toml").unwrap_or(file));
    input::nearest(name, names)
}

/// Names and titles of the examples.
pub fn list() -> String {
    let mut list = String::new();
    for (file, text) in SHIPPED {
        let name = file.strip_suffix(".toml").unwrap_or(file);
        let title = text.lines().find_map(|line| line.strip_prefix("title = "));
        let title = title.map_or("a table that a scenario reads", |title| title.trim_matches('"'));
        let _ = writeln!(list, "{name:<22} {title}");
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_file_is_listed() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios");
        for entry in std::fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            if entry.file_type().unwrap().is_file() {
                let name = entry.file_name().into_string().unwrap();
                assert!(find(&name).is_some(), "{name} is not among the examples");
            }
        }
    }

    #[test]
    fn scenarios_are_found_by_bare_name_and_listed_with_their_titles() {
        let text = find("fig2").unwrap();
        assert!(text.contains("[pull]") && text.starts_with("#:schema asperity.schema.json\n"));
        assert!(find("first_loading.csv").unwrap().starts_with("position"));
        assert!(find("fig9").is_none());
        assert_eq!((nearest("stick-slip-reste"), nearest("x")), (Some("stick-slip-reset"), None));
        assert!(list().lines().any(|line| line.starts_with("fig2 ") && line.contains("Braun")));
    }
}
