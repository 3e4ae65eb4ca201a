//! Which tables go together, as the documents say; without these rules hardly a scenario would be accepted.

use asperity::scenario::Law;
use toml::{Table, Value};

use super::quantities::Units;
use super::random::SplitMix;
use super::scenario::Walk;

/// Whether a distribution has no point masses.
fn is_continuous(name: &str) -> bool {
    name == "series" || Law::FAMILIES.iter().any(|family| family.name == name && family.widths[1] > 0.0)
}

impl Walk<'_> {
    fn is(&self, path: &str, option: &str) -> bool {
        self.options.get(path).is_some_and(|taken| taken == option)
    }

    fn given(&self, path: &str) -> bool {
        self.options.get(path).is_some_and(|taken| taken != "absent")
    }

    fn task(&self) -> &str {
        &self.options[":alternative"]
    }

    /// Whether a rule of the contacts needs a time.
    fn in_time(&self) -> bool {
        ["temperature", "ageing", "delay"].iter().any(|rule| self.given(&format!("contacts.{rule}")))
    }

    /// Whether there is a background force.
    fn has_background(&self) -> bool {
        self.given("contacts.background_force") || self.given("contacts.background_coefficient")
    }

    /// Whether thresholds have a density.
    fn has_continuous_thresholds(&self) -> bool {
        self.options.get("contacts.thresholds").is_some_and(|family| is_continuous(family))
    }

    /// Whether contacts are coupled one by one.
    fn single(&self) -> bool {
        self.is("interface.contacts", "one")
    }
}

/// Whether contacts can start in steady sliding.
fn starts(walk: &Walk<'_>) -> bool {
    !walk.given("initial")
        && !walk.is("ensemble.disorder", "quenched")
        && !walk.is("contacts.ageing", "mean_field")
}

/// Whether a key must be given, or must not; none where it may.
pub(super) fn given(walk: &Walk<'_>, path: &str, key: &str) -> Option<bool> {
    let (task, in_time, interface) = (walk.task(), walk.in_time(), walk.given("interface"));
    let no = Some(false);
    match (path, key) {
        ("contacts", "temperature" | "ageing" | "delay") if task == "renormalisation" => no,
        ("contacts", "reforming") | ("", "initial") if task == "renormalisation" => no,
        // The noise of these contacts is not known.
        ("contacts", "delay" | "stiffness_per_threshold" | "stiffness_of_threshold")
            if task == "spectrum" =>
        {
            no
        }
        ("contacts", "stiffness" | "stiffness_per_threshold" | "stiffness_of_threshold")
            if walk.is("contacts:alternative", "areas") =>
        {
            no
        }
        ("contacts", "stiffness_per_threshold" | "stiffness_of_threshold")
            if walk.given("contacts.stiffness") =>
        {
            no
        }
        ("contacts", "stiffness" | "stiffness_per_threshold")
            if walk.given("contacts.stiffness_of_threshold") =>
        {
            no
        }
        ("contacts", "stiffness_of_threshold")
            if in_time
                || matches!(task, "renormalisation" | "protocol" | "hold_curve" | "creep")
                || walk.given("contacts.stiffness_per_threshold") =>
        {
            no
        }
        ("contacts", "temperature" | "ageing" | "delay") if walk.given("contacts.stiffness_of_threshold") => {
            no
        }
        // Free contacts slide; without a delay there are none.
        ("contacts", "free_friction") if !walk.given("contacts.delay") => no,
        ("contacts.free_friction", "viscosity") if task == "creep" => no,
        ("contacts.stiffness_of_threshold", key) => Some(key != "file"),
        ("contacts", "background_force" | "background_coefficient") if task == "renormalisation" => no,
        ("contacts", "background_force") if walk.given("contacts.background_coefficient") => no,
        ("contacts", "background_coefficient") if walk.given("contacts.background_force") => no,
        ("contacts", "background_coefficient") if walk.is("contacts.normal_load", "absent") => no,
        ("contacts", "normal_load") if walk.given("contacts.background_coefficient") => Some(true),
        ("", "block") if task == "stability" => Some(true),
        ("", "block") => (!matches!(task, "drive" | "protocol")).then_some(false),
        ("", "interface") => match task {
            "renormalisation" => Some(true),
            "drive" if !walk.given("block") => None,
            _ => no,
        },
        ("", "compare") if !matches!(task, "pull" | "protocol") => no,
        // Ten simulations of dozens of slips are more than a test can wait for where time passes.
        ("", "ensemble") if matches!(task, "renormalisation" | "stability" | "creep") => no,
        ("", "ensemble") if walk.is("contacts.ageing", "mean_field") => no,
        ("", "ensemble") if interface && !walk.single() && !walk.is("interface.slip", "overdamped") => no,
        ("pull", "covariance") if walk.is("ensemble.disorder", "quenched") => no,
        ("pull" | "drive" | "spectrum", "velocity") if in_time => Some(true),
        ("stability", "velocities") if in_time => Some(true),
        ("stability", "simulations") => Some(walk.given("ensemble")),
        ("drive", "maps") if !interface => no,
        ("compare", "position" | "force") => Some(true),
        ("compare", "stiffness") if task == "pull" || walk.given("block") => no,
        ("compare", "law" | "states") if !walk.given("compare.stiffness") && !walk.given("block") => no,
        ("ensemble", "size") if interface => Some(!walk.single()),
        // A hundred thousand contacts are not few.
        ("ensemble", "size") => Some(true),
        ("block", "slip") if in_time || task == "protocol" => Some(true),
        // As many as there are cells.
        ("interface", "areas") => no,
        ("interface", "slip" | "viscosity" | "disorder") if walk.single() => no,
        ("interface", "mass") if walk.single() || !walk.given("drive.velocity") => no,
        ("interface", "mass") if walk.given("contacts.background_force") => no,
        ("interface", "mass") if walk.given("contacts.background_coefficient") => no,
        ("interface", "slip") if walk.given("interface.mass") => no,
        ("interface", "slip" | "viscosity") if in_time => Some(true),
        ("interface", "main_shocks") if !walk.single() => no,
        ("interface", "slip_rates") if !in_time && !walk.given("interface.mass") => no,
        ("interface", "disorder") if task == "renormalisation" => Some(true),
        ("interface", "viscosity") if task == "renormalisation" => no,
        ("interface.disorder", "std") => Some(true),
        ("interface.disorder", "scale") => no,
        ("velocity_curve", "temperatures") if !walk.given("contacts.temperature") => no,
        ("velocity_curve", "stability") if walk.is("contacts.ageing", "mean_field") => no,
        // Only the first step may have one.
        ("protocol", "start") => no,
        // In the first step only 1.
        ("protocol", "relative_normal_load") => no,
        ("protocol", "pieces") => Some(walk.given("protocol.velocity_to")),
        (_, "points") => Some(true),
        _ => None,
    }
}

/// Whether an option goes with those that have been taken.
pub(super) fn allows(walk: &Walk<'_>, path: &str, option: &str) -> bool {
    let (task, in_time) = (walk.options.get(":alternative").map_or("", String::as_str), walk.in_time());
    let interface = walk.given("interface");
    match (path, option) {
        // A fit needs readings that such contacts can have led to. Drawn ones are refused, or are of another kind.
        (":alternative", "fit") => false,
        ("contacts:alternative", "areas") => !matches!(task, "renormalisation" | "spectrum"),
        ("contacts.thresholds", family) if matches!(task, "renormalisation" | "spectrum") => {
            is_continuous(family)
        }
        (
            "contacts.ageing.smoluchowski.mature"
            | "contacts.ageing.frozen_rank.mature"
            | "contacts.ageing.mean_field.mature",
            family,
        ) => is_continuous(family),
        ("contacts.ageing", "mean_field") => {
            let equal =
                !walk.given("contacts.stiffness_per_threshold") && !walk.is("contacts:alternative", "areas");
            let moves = task == "protocol" && equal && walk.has_continuous_thresholds();
            (moves || matches!(task, "pull" | "velocity_curve")) && !walk.given("contacts.temperature")
        }
        ("drive:alternative", "turning_points") => !(interface || in_time),
        ("drive:alternative", "force_to") => !(interface || in_time || walk.given("block")),
        ("ensemble.disorder", "quenched") => task != "spectrum",
        ("pull.start", "steady") => starts(walk) && !in_time && !walk.is("pull.derivatives", "true"),
        ("drive.start", "steady") => {
            let alone = !((walk.given("block") || interface) && walk.given("ensemble"));
            let forced = walk.is("drive:alternative", "force_to");
            starts(walk) && !forced && !walk.single() && (!in_time || alone)
        }
        ("block.slip", slip) if in_time || task == "protocol" => matches!(slip, "damped" | "inertial"),
        ("interface.loading", "edge") if walk.has_background() => false,
        ("interface.contacts", "one") => {
            let unequal = walk.is("contacts:alternative", "areas")
                || ["per", "of"]
                    .iter()
                    .any(|word| walk.given(&format!("contacts.stiffness_{word}_threshold")));
            // In time, hot contacts on a large lattice break more often than a test can wait for.
            !(in_time || unequal || walk.has_background())
        }
        ("interface.slip", "reset") => !in_time,
        ("interface.loading", "edge") => !walk.single() && task != "renormalisation",
        ("interface.coupling", "half_space") => !walk.single(),
        _ => true,
    }
}

/// Mean of a distribution, in units of length: contacts re-form and start well below thresholds.
pub(super) fn mean(consistent: bool, path: &str, random: &mut SplitMix) -> f64 {
    match path {
        "initial" | "contacts.reforming" if consistent => random.between(0.0, 0.3),
        path if path.ends_with("mature") => random.between(0.7, 2.0),
        _ => random.between(0.3, 1.5),
    }
}

/// Puts positions into an order in which they can be reached.
pub(super) fn order(consistent: bool, key: &str, values: &mut Vec<f64>) {
    if !consistent {
        return;
    }
    values.sort_by(f64::total_cmp);
    values.dedup();
    if key == "turning_points" && values.len() == 3 {
        values.swap(0, 2);
        values.swap(1, 2);
    }
}

/// Gives a distance where lengths are in units in which the default of 20 would be one of 1e30 thresholds, or of none; what was drawn
/// stays noted.
pub(super) fn in_units(scenario: &mut Table, units: Units) {
    for task in ["pull", "drive"] {
        let Some(table) = scenario.get_mut(task).and_then(Value::as_table_mut) else { continue };
        let another = ["distance", "turning_points", "force_to"].iter().any(|key| table.contains_key(*key));
        if !another && units.length != 1.0 {
            table.insert("distance".into(), Value::Float(5.0 * units.length));
        }
    }
}
