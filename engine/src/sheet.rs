//! The sheets of the page, and what each computes.

use asperity::scenario::Scenario;

use crate::request::Part;
use crate::width;

/// The sheet of a scenario.
pub fn name(scenario: &Scenario) -> &'static str {
    let in_time = scenario.velocity_curve.is_some()
        || scenario.hold_curve.is_some()
        || scenario.protocol.is_some()
        || scenario.creep.is_some();
    match (&scenario.interface, in_time) {
        (Some(_), _) => "chain",
        (None, true) => "time",
        (None, false) => "slider",
    }
}

/// What takes longer than a preview: the map where thresholds have a width, and the motion or the task.
pub fn details(scenario: &Scenario) -> Vec<Part> {
    let motion = if scenario.interface.is_some() {
        Some(Part::Task)
    } else if scenario.block.is_some() && scenario.drive.is_some() {
        Some(Part::Block)
    } else if scenario.pull.is_some() || scenario.drive.is_some() {
        None
    } else {
        Some(Part::Task)
    };
    let wide = scenario.contacts.thresholds.as_ref().and_then(width::of).is_some();
    let map = (wide && motion != Some(Part::Task)).then_some(Part::CriticalStiffness);
    map.into_iter().chain(motion).collect()
}
