//! The pictures of a run.

mod advance;
mod catalogue;
mod corner;
mod covariance;
mod curve;
mod distribution;
mod equilibrium;
mod evolution;
mod field;
mod fit;
mod fit_spectrum;
mod force;
mod formats;
mod free_form;
mod hold_curve;
mod potential;
mod protocol;
mod sizes;
mod slip;
mod slip_rate;
mod space_time;
mod spectrum;
mod stability;
mod stick_slip;
mod stress_map;
mod style;
mod sweep;
mod thresholds;
mod typography;
mod velocity_curve;
mod velocity_step;

use asperity_runner::output::{Attachment, Outcome};
use asperity_runner::sweep::Dataset;
use kuva::render::render::Scene;

pub use formats::{Format, Style};
pub use style::digits;

/// Draws every picture for which the record has the variables.
///
/// # Errors
/// A picture that cannot be converted, with its name.
pub fn draw(outcome: &mut Outcome, style: &Style) -> Result<Vec<Attachment>, String> {
    if style.title {
        return pictures(outcome, style);
    }
    let title = std::mem::take(&mut outcome.summary.title);
    let found = pictures(outcome, style);
    outcome.summary.title = title;
    found
}

fn pictures(outcome: &Outcome, style: &Style) -> Result<Vec<Attachment>, String> {
    if style.formats.is_empty() {
        return Ok(Vec::new());
    }
    let scenes = [
        ("force", force::scene(outcome)),
        ("evolution", evolution::scene(outcome)),
        ("distribution", distribution::scene(outcome)),
        ("covariance", covariance::scene(outcome)),
        stick_slip::scene(outcome),
        ("velocity_curve", velocity_curve::scene(outcome)),
        ("hold_curve", hold_curve::scene(outcome)),
        ("protocol", protocol::scene(outcome)),
        ("velocity_step", velocity_step::scene(outcome)),
        ("equilibrium", equilibrium::scene(outcome)),
        ("potential", potential::scene(outcome)),
        ("slip", slip::scene(outcome)),
        ("sizes", sizes::scene(outcome)),
        ("catalogue", catalogue::scene(outcome)),
        ("stress_map", stress_map::scene(outcome)),
        ("space_time", space_time::scene(outcome)),
        ("slip_rate", slip_rate::scene(outcome)),
        ("thresholds", thresholds::scene(outcome)),
        ("spectrum", spectrum::scene(outcome).or_else(|| fit_spectrum::scene(outcome))),
        ("correlation", spectrum::correlation(outcome)),
        ("stability", stability::scene(outcome)),
        ("fit", fit::scene(outcome)),
        ("free_form", free_form::scene(outcome)),
        ("corner", corner::scene(outcome)),
    ];
    let scenes = scenes.into_iter().filter_map(|(name, scene)| Some((name.to_owned(), scene?)));
    converted(scenes, &outcome.summary.title, style)
}

/// Draws the pictures of a sweep.
///
/// # Errors
/// A picture that cannot be converted, with its name.
pub fn of_sweep(dataset: &Dataset, style: &Style) -> Result<Vec<Attachment>, String> {
    if style.formats.is_empty() {
        return Ok(Vec::new());
    }
    if style.title {
        return converted(sweep::scenes(dataset).into_iter(), &dataset.title, style);
    }
    let untitled = Dataset { title: String::new(), ..dataset.clone() };
    converted(sweep::scenes(&untitled).into_iter(), "", style)
}

/// Scenes with their names as files of all formats.
fn converted(
    scenes: impl Iterator<Item = (String, Scene)>,
    title: &str,
    style: &Style,
) -> Result<Vec<Attachment>, String> {
    let title = style::heading(title).0;
    let mut pictures = Vec::new();
    for (name, scene) in scenes {
        let svg = formats::svg(&scene, &title, style);
        for &format in &style.formats {
            let name = format!("{name}.{}", format.ending());
            let bytes =
                formats::converted(&svg, format, style).map_err(|error| format!("{name}: {error}"))?;
            pictures.push(Attachment { name, bytes });
        }
    }
    Ok(pictures)
}

#[cfg(test)]
mod tests;
