//! Stick-slip over velocity and stiffness: the answers of simulations, and the critical stiffnesses.

use asperity::record::Record;

use super::motion::{style, values};
use crate::picture::{Curve, Form, Key, Series};

const LINES: [(&str, &str); 3] = [
    ("persistent_stiffness", "end of persistent stick-slip"),
    ("critical_stiffness", "<i>K</i><sub>c</sub> of the first pull"),
    ("critical_stiffness_sliding", "<i>K</i><sub>c</sub> of steady sliding"),
];
/// How the values of `stick_slip` are drawn.
const ANSWERS: [(&str, &str, Form); 3] =
    [("none", "quiet", Form::Rings), ("transient", "blue", Form::Dots), ("persistent", "orange", Form::Dots)];

/// The lines and the answers that have a place on logarithmic axes.
pub fn curves(record: &Record) -> Vec<Curve<'_>> {
    let lines = LINES.iter().enumerate().map(|(i, (name, words))| {
        let (color, form) = style(i);
        let series = |name| Series { values: values(record, name).into(), of: String::new() };
        Curve { key: Key::new(words, color, form), x: series("velocity"), y: series(name) }
    });
    let answers = (0..ANSWERS.len()).map(|answer| answered(record, answer));
    lines.chain(answers).filter(|curve| curve.y.values.iter().any(|&y| y > 0.0)).collect()
}

/// The velocities and stiffnesses of an answer.
fn answered(record: &Record, answer: usize) -> Curve<'_> {
    let [velocity, stiffness, found] =
        ["velocity", "stiffness", "stick_slip"].map(|name| values(record, name));
    let own = found.iter().enumerate().filter(|(_, value)| **value == answer as f64).map(|(i, _)| i);
    let (x, y) = own.map(|i| (velocity[i / stiffness.len()], stiffness[i % stiffness.len()])).unzip();
    let (words, color, form) = ANSWERS[answer];
    Curve { key: Key::new(words, color, form), x: Series::own(x), y: Series::own(y) }
}
