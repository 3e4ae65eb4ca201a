//! Friction against the standard deviation of the thresholds, for maps of stick-slip over K and σ.

use asperity::law::Law;
use asperity::master::Tolerance;
use asperity::monitor::{Aside, Monitor};
use asperity::scenario::Scenario;
use asperity::task::summary::Extended;
use asperity::{Error, Result};

use crate::answer::WidthCurve;
use crate::solved::{equation, pulled};

/// Coefficients of variation: from thresholds that are almost equal to those of an exponential distribution.
const NARROWEST: f64 = 0.02;
const BROADEST: f64 = 1.0;
/// Widths in equal steps of their logarithm: K_c is smooth on these.
const WIDTHS: usize = 32;
/// Accuracy of F, per N_c⟨k⟩ and mean life: below the width of a line.
const TOLERANCE: f64 = 1e-4;
/// Distance of a pull, in mean thresholds: the first maximum of F and its steepest fall lie within.
const DISTANCE: f64 = 4.0;

/// Friction of the contacts of `scenario` with thresholds of other widths.
///
/// # Errors
/// Thresholds without a parameter `std`; those of the solver; stopped by the monitor.
pub fn width_curve(scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<WidthCurve> {
    let pulled = pulled(scenario);
    let model = pulled.build()?;
    let velocity = pulled.pull.as_ref().and_then(|pull| pull.velocity);
    let thresholds = &model.contacts.thresholds;
    if !thresholds.parameters().iter().any(|parameter| parameter.name == "std") {
        let expected = "a distribution with a parameter std, for a map over the width of the thresholds";
        return Err(Error::invalid("contacts.thresholds", expected, thresholds.name()));
    }
    let mean = parameter(thresholds.as_ref(), "mean").unwrap_or_else(|| thresholds.mean());
    let mut curve = WidthCurve {
        width: widths(mean).collect(),
        critical_stiffness: Vec::new(),
        static_friction: Vec::new(),
        kinetic_friction: Vec::new(),
    };
    for (i, &width) in curve.width.iter().enumerate() {
        let monitor = &mut Aside { fraction: i as f64 / WIDTHS as f64, monitor };
        let mut contacts = model.contacts.clone();
        contacts.thresholds = thresholds.with_parameter("std", width)?;
        let equation = equation(contacts, &model.initial, velocity, monitor)?;
        let pull = equation.pull_with(DISTANCE * mean, Tolerance::from(TOLERANCE), monitor)?;
        curve.critical_stiffness.push(Extended(pull.critical_stiffness()));
        curve.static_friction.push(pull.static_friction().map(|peak| peak.value + model.background));
        curve.kinetic_friction.push(equation.steady_state().kinetic_friction() + model.background);
    }
    Ok(curve)
}

fn widths(mean: f64) -> impl Iterator<Item = f64> {
    let step = (BROADEST / NARROWEST).ln() / (WIDTHS - 1) as f64;
    (0..WIDTHS).map(move |i| mean * NARROWEST * (step * i as f64).exp())
}

fn parameter(law: &dyn Law, name: &str) -> Option<f64> {
    law.parameters().into_iter().find(|parameter| parameter.name == name).map(|parameter| parameter.value)
}

/// What the curve depends on: the scenario of the pull, without the width of the thresholds.
pub fn description(scenario: &Scenario) -> String {
    let mut value = serde_json::to_value(pulled(scenario)).unwrap_or_default();
    if let Some(families) = value.pointer_mut("/contacts/thresholds").and_then(|law| law.as_object_mut()) {
        for parameters in families.values_mut().filter_map(|family| family.as_object_mut()) {
            parameters.remove("std");
        }
    }
    value.to_string()
}
