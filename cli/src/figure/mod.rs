//! The pictures of a run, as SVG and PNG.

mod catalogue;
mod corner;
mod covariance;
mod curve;
mod dashes;
mod distribution;
mod equilibrium;
mod evolution;
mod field;
mod fit;
mod fit_spectrum;
mod force;
mod free_form;
mod hold_curve;
mod potential;
mod protocol;
mod sizes;
mod slip;
mod space_time;
mod spectrum;
mod stick_slip;
mod stress_map;
mod style;
mod thresholds;
mod velocity_curve;
mod velocity_step;

use asperity_runner::output::{Attachment, Outcome};
use kuva::backend::png::PngBackend;
use kuva::backend::svg::SvgBackend;

/// Dots per unit of the canvas in PNG files: a picture is about 2000 dots wide.
const DENSITY: f32 = 3.0;

/// Draws every picture for which the record has the variables.
///
/// # Errors
/// A picture that cannot be converted to PNG, with its name.
pub fn draw(outcome: &Outcome) -> Result<Vec<Attachment>, String> {
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
        ("thresholds", thresholds::scene(outcome)),
        ("spectrum", spectrum::scene(outcome).or_else(|| fit_spectrum::scene(outcome))),
        ("correlation", spectrum::correlation(outcome)),
        ("fit", fit::scene(outcome)),
        ("free_form", free_form::scene(outcome)),
        ("corner", corner::scene(outcome)),
    ];
    let mut pictures = Vec::new();
    for (name, scene) in scenes {
        let Some(mut scene) = scene else { continue };
        let svg = renumbered(&SvgBackend::new().render_scene(&scene));
        dashes::cut(&mut scene);
        let png = PngBackend::new().with_scale(DENSITY).render_scene(&scene);
        let png = png.map_err(|error| format!("{name}.png: {error}"))?;
        pictures.push(Attachment { name: format!("{name}.svg"), bytes: svg.into_bytes() });
        pictures.push(Attachment { name: format!("{name}.png"), bytes: png });
    }
    Ok(pictures)
}

/// Renumbers the clip paths of a picture from 0, because the library counts them over the whole process.
fn renumbered(svg: &str) -> String {
    const PREFIX: &str = "kuva-clip-";
    let mut parts = svg.split(PREFIX);
    let mut text = parts.next().unwrap_or_default().to_owned();
    let mut seen: Vec<&str> = Vec::new();
    for part in parts {
        let digits = part.len() - part.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let (number, rest) = part.split_at(digits);
        let index = seen.iter().position(|&s| s == number).unwrap_or_else(|| {
            seen.push(number);
            seen.len() - 1
        });
        text += &format!("{PREFIX}{index}{rest}");
    }
    text
}

#[cfg(test)]
mod tests;
