//! The scenarios that come with asperity.

use std::fmt::Write as _;

use asperity_runner::input;

/// A shipped file: its name and its text.
type Shipped = (&'static str, &'static str);

/// All files, in the order of their names.
const SHIPPED: &[Shipped] = include!(concat!(env!("OUT_DIR"), "/shipped.rs"));

/// Scenarios in the order in which they are listed, simple ones first. Others follow, then the tables that scenarios read.
const ORDER: &[&str] = &[
    "fig2",
    "fig3",
    "rectangular",
    "identical",
    "weibull",
    "lognormal",
    "quenched",
    "areas",
    "commensurate",
    "compared",
    "stick-slip-reset",
    "stick-slip-overdamped",
    "stick-slip-arrest",
    "stick-slip-inertial",
    "smooth-sliding",
    "hysteresis",
    "imposed-force",
    "avalanches",
    "laboratory",
    "velocity-curve-thermal",
    "velocity-curve-additive",
    "velocity-curve-delay",
    "velocity-curve-ageing",
    "velocity-curve-mean-field",
    "velocity-step",
    "velocity-step-mean-field",
    "load-step",
    "slide-hold-slide",
    "healing",
    "creep",
    "spectrum",
    "fit",
    "fit-cycles",
    "fit-steady",
    "fit-velocity-curve",
    "stick-slip-ageing",
    "slow-slip",
    "stability",
    "sweep-stability",
    "sweep-critical-stiffness",
    "ofc",
    "aftershocks",
    "front-chain",
    "precursors-edge",
    "unequal-cells",
    "half-space-512",
    "front-ageing",
    "front-waves",
    "hold-chain",
    "renormalised",
    "renormalised-cells",
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
    let names = shipped().into_iter().map(|(file, _)| file.strip_suffix(".toml").unwrap_or(file));
    input::nearest(name, names)
}

/// All files in the order of the list.
fn shipped() -> Vec<Shipped> {
    let mut shipped = SHIPPED.to_vec();
    shipped.sort_by_key(|(file, _)| place(file));
    shipped
}

/// Where a file is in the list: those of equal places are in the order of their names.
fn place(file: &str) -> usize {
    let Some(name) = file.strip_suffix(".toml") else { return usize::MAX };
    ORDER.iter().position(|listed| *listed == name).unwrap_or(ORDER.len())
}

/// Names and titles of the examples.
pub fn list() -> String {
    let mut list = String::new();
    for (file, text) in shipped() {
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
    fn every_scenario_of_the_order_is_shipped() {
        ORDER.iter().for_each(|name| assert!(find(name).is_some(), "{name}"));
        assert!(list().ends_with("a table that a scenario reads\n"));
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
