//! The table of numbers: friction, and the motion or the catalogue of events.

use asperity::record::Quantity;
use asperity::scenario::Scenario;
use asperity::task::summary::SlidingKind;

use crate::answer::{Computed, ForceCurve};
use crate::digits::{brief, precise, rounded};
use crate::picture::{Labels, escaped};
use crate::shown::NumberRow;

/// Relative error of the forces of a preview.
const PREVIEW: f64 = 3e-4;
/// Relative error of the period and the drops of a motion: without time, and in time.
const MOTION: [f64; 2] = [1e-6, 1e-4];
/// Least relative error: the digits that are shown at most.
const LEAST: f64 = 1e-12;

/// The numbers that are known, with the digits that are right.
pub fn rows(
    scenario: &Scenario,
    force: Option<&ForceCurve>,
    preview: bool,
    motion: Option<&Computed>,
) -> Vec<NumberRow> {
    let labels = Labels(&scenario.units);
    let number = |value: Option<f64>, error: f64, quantity: Quantity| match value {
        Some(value) if value.is_finite() => digits(value, error) + &escaped(&labels.unit(quantity)),
        Some(value) if value.is_infinite() => "infinite".to_owned(),
        _ => "—".to_owned(),
    };
    let peak = force.and_then(|force| force.static_friction.as_ref());
    let error = if preview { PREVIEW } else { force.map_or(LEAST, relative_error) };
    let highest = match (force, peak) {
        (Some(_), None) => "not reached".to_owned(),
        _ => number(peak.map(|peak| peak.value), error, Quantity::Force),
    };
    let root = error.sqrt();
    let of = |value: fn(&ForceCurve) -> f64| force.map(value);
    let (kinetic, life) = (of(|force| force.kinetic_friction), of(|force| force.relaxation_length.0));
    let stiffness = of(|force| force.critical_stiffness.0);
    // A preview may be without it.
    let follows = preview && life.is_some_and(f64::is_nan);
    let length = if follows { "…".to_owned() } else { number(life, root, Quantity::Length) };
    let mut rows = vec![
        NumberRow("static friction <i>F</i><sub>s</sub>", highest),
        NumberRow("at <i>X</i><sub>s</sub>", number(peak.map(|peak| peak.position), root, Quantity::Length)),
        NumberRow("kinetic friction <i>F</i><sub>k</sub>", number(kinetic, error, Quantity::Force)),
        NumberRow("relaxation length <i>X</i>*", length),
        NumberRow(
            "critical stiffness <i>K</i><sub>c</sub>",
            number(stiffness, 10.0 * error, Quantity::Stiffness),
        ),
    ];
    if let Some(velocity) = force.and_then(|force| force.velocity) {
        let value = brief(rounded(velocity, 10)) + &escaped(&labels.unit(Quantity::Velocity));
        rows.push(NumberRow("at the velocity <i>v</i>", value));
    }
    let numbers = motion.map(|motion| &motion.summary.numbers);
    if let Some(sliding) = numbers.and_then(|numbers| numbers.sliding()).filter(|_| scenario.block.is_some())
    {
        let error = MOTION[usize::from(sliding.timed)];
        rows.extend([
            NumberRow("sliding", kind(sliding.regime).to_owned()),
            NumberRow("slips", sliding.slips.to_string()),
            NumberRow("period", number(sliding.period, error, Quantity::Length)),
            NumberRow("mean force drop", number(sliding.mean_drop, error, Quantity::Force)),
        ]);
    }
    if let Some(catalogue) = numbers.and_then(|numbers| numbers.catalogue()) {
        let largest =
            catalogue.largest.as_ref().map_or("—".to_owned(), |largest| largest.cells.to_string());
        rows.extend([
            NumberRow("events", catalogue.events.to_string()),
            NumberRow("cells of the largest", largest),
        ]);
    }
    rows
}

/// The accuracy is that of forces per stiffness of the contacts, a length.
fn relative_error(force: &ForceCurve) -> f64 {
    let peak = force.static_friction.as_ref().map(|peak| peak.position);
    let length = peak.or_else(|| force.position.last().copied()).unwrap_or(1.0);
    (force.accuracy / length).max(LEAST)
}

fn digits(value: f64, error: f64) -> String {
    precise(value, (-error.log10()).floor().clamp(2.0, 10.0) as usize)
}

fn kind(regime: SlidingKind) -> &'static str {
    match regime {
        SlidingKind::Smooth => "smooth",
        SlidingKind::Transient => "transient",
        SlidingKind::Persistent => "persistent",
        SlidingKind::Runaway => "runaway",
        SlidingKind::Undecided => "undecided",
    }
}
