//! The pictures of a run.

mod advance;
mod catalogue;
mod clip;
mod compared;
mod corner;
mod covariance;
mod coverage;
mod creep;
mod curve;
mod distribution;
mod dots;
mod equilibrium;
mod evolution;
mod field;
mod fit;
mod fit_spectrum;
mod fit_velocity_curve;
mod fitting;
mod force;
mod formats;
mod free_form;
mod front_lines;
mod grey;
mod grid;
mod hold_curve;
mod legend;
mod letters;
mod magnitude;
mod main_shocks;
mod measured;
mod png_file;
mod potential;
mod protocol;
mod raster;
mod room;
mod shapes;
mod simplify;
mod sizes;
mod slip;
mod slip_rate;
mod slipped;
mod smooth;
mod space_time;
mod spectrum;
mod stability;
mod stick_slip;
mod stick_slip_scatter;
mod stress_map;
mod style;
mod sweep;
mod sweep_label;
mod thresholds;
mod tick_labels;
mod ticks;
mod typography;
mod velocity_curve;
mod velocity_step;

use asperity::scenario::{Figure, FigureFormat};
use asperity_runner::output::{Attachment, Outcome};
use asperity_runner::sweep::Dataset;
use kuva::render::render::Scene;
use rayon::iter::{IntoParallelIterator as _, ParallelIterator as _};

use formats::Picture;
use legend::fitted;

pub use formats::check;
pub use style::digits;

/// Draws every picture for which the record has the variables.
///
/// # Errors
/// A picture that cannot be converted, with its name.
pub fn draw(outcome: &mut Outcome, style: &Figure) -> Result<Vec<Attachment>, String> {
    if style.title {
        return pictures(outcome, style);
    }
    let title = std::mem::take(&mut outcome.summary.title);
    let found = pictures(outcome, style);
    outcome.summary.title = title;
    found
}

fn pictures(outcome: &Outcome, style: &Figure) -> Result<Vec<Attachment>, String> {
    if style.formats.is_empty() {
        return Ok(Vec::new());
    }
    let page = formats::page(style);
    let scenes = [
        (
            "force",
            fitted(page, |page| force::scene(outcome, page).or_else(|| compared::scene(outcome, page))),
        ),
        ("evolution", fitted(page, |page| evolution::scene(outcome, page))),
        ("distribution", fitted(page, |page| distribution::scene(outcome, page))),
        ("covariance", fitted(page, |page| covariance::scene(outcome, page))),
        (stick_slip::name(&outcome.record), fitted(page, |page| stick_slip::scene(outcome, page))),
        (
            "velocity_curve",
            fitted(page, |page| {
                velocity_curve::scene(outcome, page).or_else(|| fit_velocity_curve::scene(outcome, page))
            }),
        ),
        ("hold_curve", fitted(page, |page| hold_curve::scene(outcome, page))),
        ("protocol", fitted(page, |page| protocol::scene(outcome, page))),
        ("velocity_step", fitted(page, |page| velocity_step::scene(outcome, page))),
        ("creep_curve", fitted(page, |page| creep::scene(outcome, page))),
        ("creep_rate", fitted(page, |page| creep::rate(outcome, page))),
        ("static_fatigue", fitted(page, |page| creep::fatigue(outcome, page))),
        ("equilibrium", fitted(page, |page| equilibrium::scene(outcome, page))),
        ("potential", fitted(page, |page| potential::scene(outcome, page))),
        ("slip", fitted(page, |page| slip::scene(outcome, page))),
        ("sizes", fitted(page, |page| sizes::scene(outcome, page))),
        ("catalogue", fitted(page, |page| catalogue::scene(outcome, page))),
        ("main_shocks", fitted(page, |page| main_shocks::scene(outcome, page))),
        ("stress_map", fitted(page, |page| stress_map::scene(outcome, page))),
        ("space_time", fitted(page, |page| space_time::scene(outcome, page))),
        ("slip_rate", fitted(page, |page| slip_rate::scene(outcome, page))),
        ("thresholds", fitted(page, |page| thresholds::scene(outcome, page))),
        (
            "spectrum",
            fitted(page, |page| {
                spectrum::scene(outcome, page).or_else(|| fit_spectrum::scene(outcome, page))
            }),
        ),
        ("correlation", fitted(page, |page| spectrum::correlation(outcome, page))),
        ("stability", fitted(page, |page| stability::scene(outcome, page))),
        ("stick_slip_scatter", fitted(page, |page| stick_slip_scatter::scene(outcome, page))),
        ("fit", fitted(page, |page| fit::scene(outcome, page))),
        ("free_form", fitted(page, |page| free_form::scene(outcome, page))),
        ("corner", fitted(page, |page| corner::scene(outcome, page))),
    ];
    let title = page.heading(&outcome.summary.title).0;
    let scenes = scenes.into_iter().filter_map(|(name, scene)| Some((name.to_owned(), scene?)));
    files(scenes, &title, style)
}

/// Draws the pictures of a sweep.
///
/// # Errors
/// A picture that cannot be converted, with its name.
pub fn of_sweep(dataset: &Dataset, style: &Figure) -> Result<Vec<Attachment>, String> {
    if style.formats.is_empty() {
        return Ok(Vec::new());
    }
    let page = formats::page(style);
    let mut drawn = dataset.drawn().map_err(|error| format!("curves cannot be read: {error}"))?;
    if !style.title {
        drawn.title.clear();
    }
    files(sweep::scenes(&drawn, page).into_iter(), &page.heading(&drawn.title).0, style)
}

/// Scenes with their names as files of all formats.
fn files(
    scenes: impl Iterator<Item = (String, Scene)>,
    title: &str,
    style: &Figure,
) -> Result<Vec<Attachment>, String> {
    let pictures: Vec<(String, Picture)> =
        scenes.map(|(name, scene)| (name, Picture::new(scene, title, style))).collect();
    // A format that is given twice is one file.
    let mut formats: Vec<FigureFormat> = Vec::new();
    for format in &style.formats {
        if !formats.contains(format) {
            formats.push(*format);
        }
    }
    let all = |drawn| formats.iter().map(move |format| (drawn, *format));
    let files: Vec<(&(String, Picture), FigureFormat)> = pictures.iter().flat_map(all).collect();
    let convert = |((name, picture), format): (&(String, Picture), FigureFormat)| {
        let name = format!("{name}.{}", format.name());
        match picture.converted(format) {
            Ok(bytes) => Ok(Attachment { name, bytes }),
            Err(error) => Err(format!("{name}: {error}")),
        }
    };
    files.into_par_iter().map(convert).collect()
}

#[cfg(test)]
mod tests;
