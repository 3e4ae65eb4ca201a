//! The scenario of a fit with the numbers that it has found, as a `[pull]` beside each measured curve, as a `[spectrum]`,
//! or as a `[velocity_curve]`.

use asperity::scenario::{Compare, Scenario};

use super::Outcome;
use crate::input;

/// The texts of the fitted scenarios, one for each curve with the name of its file; none for other tasks.
pub fn fitted(outcome: &Outcome) -> Vec<(String, String)> {
    let (Some(found), Ok(scenario)) =
        (outcome.summary.numbers.fit(), toml::from_str::<Scenario>(&outcome.scenario))
    else {
        return Vec::new();
    };
    let values: Vec<(String, f64)> =
        found.numbers.iter().map(|number| (number.key.clone(), number.value)).collect();
    if let Some(highest) = outcome.record.values("fit_wave_number").and_then(<[f64]>::last) {
        let text = input::to_text(&scenario.fitted_spectrum(&values, *highest));
        return vec![("fitted.toml".to_owned(), text)];
    }
    if scenario.fit.as_ref().is_some_and(|fit| fit.velocity_curve.is_some()) {
        let free = values.iter().find(|(key, _)| key == "fit.offset").map(|(_, value)| *value);
        let offset = free.or(scenario.fit.as_ref().map(|fit| fit.offset)).unwrap_or(0.0);
        let text = input::to_text(&scenario.fitted_velocity_curve(&values, offset));
        return vec![("fitted.toml".to_owned(), text)];
    }
    let count = found.distances.len();
    let one = |(curve, &distance): (usize, &f64)| {
        let name = if count == 1 { "fitted.toml".to_owned() } else { format!("fitted-{curve}.toml") };
        let compare = compared(outcome, (&scenario, curve), &values)?;
        Some((name, input::to_text(&scenario.fitted(&values, (curve, distance), compare))))
    };
    found.distances.iter().enumerate().filter_map(one).collect()
}

/// The measured curve, without offset, trend and origin; `None` within if none was measured.
fn compared(
    outcome: &Outcome,
    (scenario, curve): (&Scenario, usize),
    values: &[(String, f64)],
) -> Option<Option<Compare>> {
    let fit = scenario.fit.as_ref()?;
    let given = fit.curves().into_iter().nth(curve)?;
    let number = |name: &str, fixed: Option<f64>| {
        let keys = [format!("fit.{name}"), format!("fit.curve.{curve}.{name}")];
        let found = values.iter().find(|(known, _)| keys.contains(known));
        found.map_or(fixed.unwrap_or(0.0), |(_, value)| *value)
    };
    let [offset, trend, origin] =
        [("offset", given.offset), ("trend", given.trend), ("origin", given.origin)]
            .map(|(name, fixed)| number(name, fixed));
    let numbers = outcome.record.values("reading_curve");
    let of_curve = |name: &str| -> Option<Vec<f64>> {
        let values = outcome.record.values(name)?.iter().enumerate();
        let own = |i: usize| numbers.is_none_or(|numbers| numbers[i] == curve as f64);
        Some(values.filter(|(i, _)| own(*i)).map(|(_, value)| *value).collect())
    };
    let measured = of_curve("reading_position")?;
    Some(of_curve("measured_force").map(|forces| Compare {
        position: Some(match of_curve("slider_position") {
            Some(slider) => slider,
            None => measured.iter().map(|y| y - origin).collect(),
        }),
        force: Some(forces.iter().zip(&measured).map(|(force, y)| force - offset - trend * y).collect()),
        ..Compare::default()
    }))
}
