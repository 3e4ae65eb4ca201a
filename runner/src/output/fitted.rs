//! The scenario of a fit with the numbers that it has found, as a `[pull]` beside the measured curve, or as a `[spectrum]`.

use asperity::scenario::{Compare, Scenario};

use super::Outcome;
use crate::input;

/// The text of the fitted scenario; `None` for other tasks.
pub fn fitted(outcome: &Outcome) -> Option<String> {
    let found = outcome.summary.numbers.fit()?;
    let scenario: Scenario = toml::from_str(&outcome.scenario).ok()?;
    let fit = scenario.fit.as_ref()?;
    let values: Vec<(String, f64)> =
        found.numbers.iter().map(|number| (number.key.clone(), number.value)).collect();
    if let Some(wave_numbers) = outcome.record.values("fit_wave_number") {
        let highest = *wave_numbers.last()?;
        return Some(input::to_text(&scenario.fitted_spectrum(&values, highest)));
    }
    let number = |key: &str, fixed: f64| {
        values.iter().find(|(known, _)| known == key).map_or(fixed, |(_, value)| *value)
    };
    let [offset, trend, origin] =
        [("fit.offset", fit.offset), ("fit.trend", fit.trend), ("fit.origin", fit.origin)]
            .map(|(key, fixed)| number(key, fixed));
    let measured = outcome.record.values("reading_position")?;
    let compare = outcome.record.values("measured_force").map(|forces| Compare {
        position: Some(match outcome.record.values("slider_position") {
            Some(slider) => slider.to_vec(),
            None => measured.iter().map(|y| y - origin).collect(),
        }),
        force: Some(forces.iter().zip(measured).map(|(force, y)| force - offset - trend * y).collect()),
        file: None,
    });
    Some(input::to_text(&scenario.fitted(&values, found.distance, compare)))
}
