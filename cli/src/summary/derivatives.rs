//! Text of the summary for derivatives by parameters.

use asperity::task::summary::FrictionDerivative;

use super::digits;

/// A line for each parameter.
pub fn lines(derivatives: &[FrictionDerivative]) -> Vec<(&'static str, String)> {
    let line = |(number, by): (usize, &FrictionDerivative)| {
        let label = if number == 0 { "derivatives" } else { "" };
        let at_rest = by.static_friction.map_or(String::new(), |value| format!("F_s {}, ", digits(value)));
        let values = [by.kinetic_friction, by.relaxation_length.0, by.critical_stiffness.0].map(digits);
        let [kinetic, length, stiffness] = values;
        let of = format!("{at_rest}F_k {kinetic}, X* {length}, K_c {stiffness}");
        (label, format!("by {} = {}: {of}", by.parameter, digits(by.value)))
    };
    derivatives.iter().enumerate().map(line).collect()
}
