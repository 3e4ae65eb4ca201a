//! Friction against the standard deviation of the thresholds, for maps of stick-slip over K and σ.

use asperity::master::Tolerance;
use asperity::monitor::{Aside, Monitor};
use asperity::scenario::Scenario;
use asperity::task::summary::Extended;
use asperity::{Error, Result};

use crate::answer::WidthCurve;
use crate::solved::{equation, pulled};
use crate::width;

/// Coefficients of variation: from thresholds that are almost equal to those of an exponential distribution.
const NARROWEST: f64 = 0.02;
const BROADEST: f64 = 1.0;
/// Widths in equal steps of their logarithm: K_c is smooth on these.
const WIDTHS: usize = 32;
/// Accuracy of F, per N_c⟨k⟩ and mean life: below the width of a line.
const TOLERANCE: f64 = 1e-4;
/// Distance of a pull, in mean thresholds: the first maximum of F and its steepest fall lie within.
const DISTANCE: f64 = 4.0;

/// Friction of the contacts of `scenario` with thresholds of other widths, for those widths that are possible.
///
/// # Errors
/// Thresholds without a width that can be chosen; no width that is possible; those of the solver; stopped by the monitor.
pub fn width_curve(scenario: &Scenario, monitor: &mut dyn Monitor) -> Result<WidthCurve> {
    let pulled = pulled(scenario);
    let model = pulled.build()?;
    let velocity = pulled.pull.as_ref().and_then(|pull| pull.velocity);
    let thresholds = pulled.contacts.thresholds.as_ref().filter(|law| width::of(law).is_some());
    let Some(thresholds) = thresholds else {
        let expected = "a distribution with a width, for a map over the width of the thresholds";
        return Err(Error::invalid("contacts.thresholds", expected, model.contacts.thresholds.name()));
    };
    let mean = width::mean(thresholds);
    let reach = DISTANCE * model.contacts.thresholds.mean().max(mean);
    let friction = |width: f64, monitor: &mut dyn Monitor| {
        let mut contacts = model.contacts.clone();
        contacts.thresholds = width::changed(thresholds, width).build()?;
        let equation = equation(contacts, &model.initial, velocity, monitor)?;
        let pull = equation.pull_with(reach, Tolerance::from(TOLERANCE), monitor)?;
        Ok((equation.steady_state().kinetic_friction(), pull))
    };
    let mut curve = WidthCurve::default();
    let mut refused = None;
    for (i, width) in widths(mean).enumerate() {
        match friction(width, &mut Aside { fraction: i as f64 / WIDTHS as f64, monitor }) {
            Ok((kinetic_friction, pull)) => {
                curve.width.push(width);
                curve.critical_stiffness.push(Extended(pull.critical_stiffness()));
                curve.static_friction.push(pull.static_friction().map(|peak| peak.value + model.background));
                curve.kinetic_friction.push(kinetic_friction + model.background);
            }
            // Thresholds of this width may be below the stretches at which contacts re-form: the others have a curve.
            Err(error @ Error::Invalid { .. }) => refused = Some(error),
            Err(error) => return Err(error),
        }
    }
    match refused {
        Some(error) if curve.width.is_empty() => Err(error),
        _ => Ok(curve),
    }
}

fn widths(mean: f64) -> impl Iterator<Item = f64> {
    let step = (BROADEST / NARROWEST).ln() / (WIDTHS - 1) as f64;
    (0..WIDTHS).map(move |i| mean * NARROWEST * (step * i as f64).exp())
}

/// What the curve depends on: the scenario of the pull, with thresholds of one width.
pub fn description(scenario: &Scenario) -> String {
    let mut pulled = pulled(scenario);
    let thresholds = pulled.contacts.thresholds.take();
    pulled.contacts.thresholds = thresholds.map(|law| width::changed(&law, NARROWEST * width::mean(&law)));
    serde_json::to_string(&pulled).unwrap_or_default()
}
