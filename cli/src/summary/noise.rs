//! Text of the summary for the noise of steady sliding.

use asperity::record::Quantity;
use asperity::task::summary::{Noise, Summary};

use super::{digits, with_unit};

/// Lines for the noise of the force.
pub fn lines(summary: &Summary, noise: &Noise) -> Vec<(&'static str, String)> {
    let value = |number: f64, quantity| with_unit(digits(number), number, &summary.units.label(quantity));
    let std = value(noise.force_std, Quantity::Force);
    vec![
        ("kinetic friction", format!("F_k = {}", value(noise.kinetic_friction, Quantity::Force))),
        ("noise of the force", format!("standard deviation {std} of {} contacts", digits(noise.size))),
        ("spectrum at q = 0", format!("S(0) = {}", value(noise.at_zero, Quantity::ForceSquaredLength))),
        ("spectrum at large q", format!("q²S/(2F_k) → {}", value(noise.tail, Quantity::Stiffness))),
    ]
}
