//! The pictures of shipped scenarios as SVG: panels share their edges, maps have square cells and colour bars as tall as they are,
//! nothing is outside of the picture or its frames, vertical axes show their values in full, legends cover nothing, texts do
//! not cover each other, and labels are the words of the field. The pictures fit into a column of a journal, too.

#[path = "picture/columns.rs"]
mod columns;
#[path = "picture/legends.rs"]
mod legends;
#[path = "picture/ranges.rs"]
mod ranges;
mod support;

use std::sync::Arc;

use Panels::{Below, Beside, Corner, Free, Pairs, Steps};
use rayon::prelude::*;
use support::{Folder, command_of, names, scenarios, tomls};

/// Scenarios that take long, and what makes them short.
const SHORTER: [(&str, &[&str]); 11] = [
    ("avalanches", &["ensemble.size=20000"]),
    ("creep", &["creep.forces=[0.6, 0.7]"]),
    ("front-ageing", &["drive.distance=4", "interface.cells=[10]"]),
    ("front-waves", &["drive.distance=2"]),
    ("half-space-512", &["interface.cells=[16, 16]"]),
    ("hold-chain", &["interface.cells=[5]"]),
    ("renormalised-cells", &["renormalisation.runs=4"]),
    ("stability", &["stability.velocities=[1e-3, 1e-2]", "stability.resolution=1.0"]),
    ("sweep-critical-stiffness", &["velocity_curve.points=3"]),
    ("velocity-curve-ageing", &["velocity_curve.points=5"]),
    ("velocity-curve-thermal", &["velocity_curve.points=5"]),
];

/// How the panels of a picture stand.
enum Panels {
    /// Below each other: they begin and end together.
    Below,
    /// Beside each other, the last one may be a scale of colours: all are equally tall.
    Beside,
    /// The second beside the first, and as tall; the third below the first, and as wide.
    Corner,
    /// In rows of two: those of a row are equally tall, those of a column begin and end together.
    Pairs,
    /// Rows of one panel, two panels, and so on: those of a row are equally tall, those of a column begin and end together.
    Steps,
    /// Each for itself.
    Free,
}

/// Pictures with the labels of their axes. Of others, something must be on the first vertical axis.
const PICTURES: [(&str, Panels, &[&str]); 37] = [
    ("catalogue", Free, &["Force F"]),
    ("corner", Steps, &["gaussian.mean", "count", "stiffness"]),
    ("correlation", Below, &["Displacement u", "Autocorrelation of the force"]),
    ("covariance", Beside, &["Displacement X₁", "Displacement X₂", "Correlation coefficient"]),
    ("creep", Below, &["Imposed force", "Position X"]),
    ("creep_curve", Below, &["Time t", "Slip since loading"]),
    ("creep_rate", Below, &["Time t", "Velocity v"]),
    ("critical_stiffness", Beside, &["Critical stiffness Kc", "Velocity v"]),
    ("critical_stiffness_sliding", Beside, &["Critical stiffness of steady sliding Kc", "Velocity v"]),
    ("distribution", Below, &["Stretch x", "Stretch density Q(x)"]),
    ("equilibrium", Below, &["Load-point displacement XT", "Position X"]),
    ("evolution", Pairs, &["Stretch x", "Q(x; X)"]),
    ("fit", Below, &["Friction force F", "Whitened residual"]),
    ("force", Below, &["Position X", "Friction force F"]),
    ("free_form", Below, &["Threshold", "Density of thresholds"]),
    ("hold_curve", Below, &["Hold time", "Static friction Fs"]),
    ("hysteresis", Below, &["Position X", "Friction force F"]),
    ("main_shocks", Below, &["Time from the main shock", "Rate of events / mean rate"]),
    ("mean_drop", Beside, &["Mean drop of the force", "Stiffness of the spring K"]),
    ("period", Beside, &["Period of stick-slip", "Stiffness of the spring K"]),
    ("potential", Below, &["Position X", "Potential V(X)"]),
    ("protocol", Below, &["Time t", "Velocity v", "Friction force F"]),
    ("regime", Beside, &["Stiffness of the spring K"]),
    ("sizes", Below, &["Contacts broken in an event", "Events per number of contacts"]),
    ("slip", Below, &["Time t", "Position X", "Velocity v", "Force"]),
    ("slip_rate", Beside, &["Cell", "Time t", "Step of the computation", "Slip rate of a cell"]),
    ("slips", Beside, &["Number of slips", "Stiffness of the spring K"]),
    ("space_time", Corner, &["Cell", "Force of a cell"]),
    ("spectrum", Below, &["Wave number q", "Spectrum S"]),
    ("stability", Below, &["Velocity v", "Stiffness K"]),
    ("static_fatigue", Below, &["Constant force F", "Time to failure"]),
    ("stick_slip", Below, &["Load-point displacement XT", "Spring force"]),
    ("stick_slip_scatter", Below, &["Stiffness K", "Fraction of 10 simulations"]),
    ("stress_map", Free, &["Column", "Row", "Force of a cell"]),
    ("thresholds", Below, &["Drive X", "Probability density"]),
    ("velocity_curve", Below, &["Velocity v", "Kinetic friction Fk"]),
    ("velocity_step", Below, &["Displacement since the step", "Friction force F"]),
];

/// Largest distance in units of the canvas that rounding to two digits leaves.
const ROUNDING: f64 = 0.03;

#[test]
fn pictures_of_shipped_scenarios_are_in_order() {
    let folder = others();
    let paths = [tomls(&scenarios()), tomls(folder.path())].concat();
    let (mut seen, mut axes): (Vec<String>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut legends = [0, 0];
    let found: Vec<_> = paths.par_iter().map(|path| checked(path)).collect();
    found.into_iter().for_each(|(pictures, shown, inside)| {
        seen.extend(pictures);
        axes.extend(shown);
        inside.into_iter().for_each(|is_inside| legends[usize::from(is_inside)] += 1);
    });
    seen.sort();
    seen.dedup();
    axes.sort_unstable();
    axes.dedup();
    let checked = ranges::count();
    assert_eq!(axes, (0..checked).collect::<Vec<usize>>());
    // Most panels have room for a legend; those that are filled by curves or cells have not.
    assert!(legends[1] > 2 * legends[0] && legends[0] > 5, "{legends:?} legends below and inside");
    let known: Vec<&str> = PICTURES.iter().map(|picture| picture.0).collect();
    known.iter().for_each(|name| assert!(seen.iter().any(|seen| seen == name), "{name} is not drawn"));
    known.iter().for_each(|name| assert!(ranges::has(name), "{name}"));
}

/// Scenarios with the pictures that no shipped one has.
fn others() -> Folder {
    let (folder, shipped) = (Folder::new(), scenarios());
    let read = |name: &str| std::fs::read_to_string(shipped.join(name)).unwrap();
    folder.write("measured-pull.csv", &read("measured-pull.csv"));
    let fit = "thresholds = \"free_form\"\nposterior = { draws = 20, chains = 2 }\n";
    folder.write("fit-free-form.toml", &(read("fit.toml") + fit));
    let pull = "[pull]\ndistance = 3.0\npoints = 31\ncovariance = [0.5, 1.0, 1.5, 2.0, 2.5]\n";
    folder.write(
        "covariance.toml",
        &format!("contacts.thresholds.gaussian = {{ mean = 1.0, std = 0.1 }}\n{pull}"),
    );
    folder
}

/// The names of the pictures of a scenario, which are in order, the numbers of the vertical axes in them, and which of their legends
/// are in a panel.
fn checked(path: &std::path::Path) -> (Vec<String>, Vec<usize>, Vec<bool>) {
    let scenario = path.file_stem().unwrap().to_str().unwrap();
    let folder = Folder::new();
    let mut arguments =
        vec![command_of(path), path.to_str().unwrap(), "--quiet", "--figures", "svg", "-o", "out"];
    let shorter = SHORTER.iter().find(|(name, _)| *name == scenario).map_or(&[][..], |found| found.1);
    arguments.extend(shorter.iter().flat_map(|set| ["--set", *set]));
    folder.succeed(&arguments);
    let out = folder.path().join("out");
    let outcome = asperity_runner::output::read(&out).ok();
    let drawn = names(&out).into_iter().filter_map(|name| Some(name.strip_suffix(".svg")?.to_owned()));
    let (mut axes, mut inside) = (Vec::new(), Vec::new());
    let drawn = drawn.inspect(|name| {
        let svg = std::fs::read_to_string(out.join(format!("{name}.svg"))).unwrap();
        let place = format!("{scenario}: {name}");
        check(&place, name, &svg);
        axes.extend(ranges::check(&place, name, &svg, outcome.as_ref()));
        inside.extend(legends::check(&place, &svg));
    });
    let drawn = drawn.collect();
    columns::check(&folder, scenario);
    (drawn, axes, inside)
}

fn check(place: &str, name: &str, svg: &str) {
    let (_, panels, labels) = PICTURES.iter().find(|picture| picture.0 == name).unwrap_or(&("", Free, &[]));
    let shown = words(svg);
    for label in *labels {
        assert!(shown.iter().any(|text| text.contains(label)), "{place}: {label} is not in {shown:?}");
    }
    let frames = frames(svg);
    assert!(!frames.is_empty(), "{place}");
    match panels {
        Below => share(place, &frames, ACROSS),
        Beside => share(place, &frames, ALONG),
        Corner => {
            share(place, &frames[..2], ALONG);
            share(place, &[&frames[..1], &frames[2..]].concat(), ACROSS);
        }
        Pairs => {
            frames.chunks(2).for_each(|row| share(place, row, ALONG));
            let column = |first: usize| -> Vec<_> { frames.iter().skip(first).step_by(2).copied().collect() };
            [0, 1].into_iter().for_each(|first| share(place, &column(first), ACROSS));
        }
        Steps => steps(place, &frames),
        Free => {}
    }
    if ["covariance", "stress_map"].contains(&name) {
        square(place, &frames);
    }
    let drawn = tree(svg);
    inside(place, &drawn);
    columns::apart(place, &drawn);
}

/// The start and the length of a frame from left to right, and from top to bottom.
const ACROSS: [usize; 2] = [0, 2];
const ALONG: [usize; 2] = [1, 3];

/// Rows of one frame, two frames, and so on are in columns.
fn steps(place: &str, frames: &[[f64; 4]]) {
    let (mut columns, mut rest) = (Vec::<Vec<[f64; 4]>>::new(), frames);
    while !rest.is_empty() {
        let (row, later) = rest.split_at(columns.len() + 1);
        share(place, row, ALONG);
        columns.push(Vec::new());
        columns.iter_mut().zip(row).for_each(|(column, frame)| column.push(*frame));
        rest = later;
    }
    columns.iter().for_each(|column| share(place, column, ACROSS));
}

/// Frames begin and end together.
fn share(place: &str, frames: &[[f64; 4]], sides: [usize; 2]) {
    let apart =
        |frame: &[f64; 4]| sides.map(|side| (frame[side] - frames[0][side]).abs()).iter().sum::<f64>();
    assert!(frames.iter().all(|frame| apart(frame) < ROUNDING), "{place}: {frames:?}");
}

/// Maps of equally many rows and columns are square, and the scale of colours is as tall.
fn square(place: &str, frames: &[[f64; 4]]) {
    let (scale, maps) = frames.split_last().unwrap();
    for map in maps {
        assert!((map[2] - map[3]).abs() < ROUNDING, "{place}: {map:?}");
    }
    let lowest = maps.iter().map(|map| map[1] + map[3]).fold(0.0, f64::max);
    let highest = maps.iter().map(|map| map[1]).fold(f64::INFINITY, f64::min);
    assert!(
        (scale[1] - highest).abs() + (scale[1] + scale[3] - lowest).abs() < ROUNDING,
        "{place}: {frames:?}"
    );
}

/// Everything that is drawn, letters included, is within the canvas.
fn inside(place: &str, tree: &usvg::Tree) {
    let (size, drawn) = (tree.size(), tree.root().abs_stroke_bounding_box());
    // Half of the line of a frame at the edge, and the accuracy of single precision.
    let beyond = 1.0;
    let out = -drawn.left() > beyond
        || -drawn.top() > beyond
        || drawn.right() - size.width() > beyond
        || drawn.bottom() - size.height() > beyond;
    assert!(!out, "{place}: {drawn:?} in {size:?}");
}

/// A picture as it is drawn, with its texts laid out.
fn tree(svg: &str) -> usvg::Tree {
    let mut options = usvg::Options { font_family: "DejaVu Sans".into(), ..usvg::Options::default() };
    for font in [dejavu::sans::regular(), dejavu::sans::oblique(), dejavu::sans::bold()] {
        Arc::make_mut(&mut options.fontdb).load_font_data(font.to_vec());
    }
    usvg::Tree::from_str(svg, &options).unwrap()
}

/// The texts of a picture without the marks of symbols in them.
fn words(svg: &str) -> Vec<String> {
    let texts = svg.split("<text").skip(1).filter_map(|part| part.split("</text>").next());
    let plain = |text: &str| -> String {
        let mut pieces = text.split('<').map(|piece| piece.split_once('>').map_or(piece, |(_, rest)| rest));
        let first = pieces.next().unwrap_or_default().to_owned();
        pieces.fold(first, |words, piece| words + piece)
    };
    texts.map(plain).collect()
}

/// The frames of the panels on the canvas: left, top, width, height.
fn frames(svg: &str) -> Vec<[f64; 4]> {
    let frame = |tag: Tag| -> Option<[f64; 4]> {
        let frame = numbers(tag.text, "data-frame=\"", '"')?;
        Some([tag.at[0] + frame[0], tag.at[1] + frame[1], frame[2], frame[3]])
    };
    tags(svg).into_iter().filter_map(frame).collect()
}

/// A tag of a picture.
struct Tag<'a> {
    text: &'a str,
    /// What stands between this tag and the next.
    content: &'a str,
    /// By how much the groups around it and its own are moved.
    at: [f64; 2],
}

fn tags(svg: &str) -> Vec<Tag<'_>> {
    let (mut moved, mut found): (Vec<[f64; 2]>, _) = (Vec::new(), Vec::new());
    for (text, content) in svg.split('<').filter_map(|part| part.split_once('>')) {
        if text.starts_with("/g") {
            moved.pop();
        } else if text.starts_with("g ") || text == "g" {
            let by = numbers(text, "translate(", ')').and_then(|by| by.try_into().ok()).unwrap_or([0.0; 2]);
            moved.push(by);
        }
        let at = [0, 1].map(|axis: usize| moved.iter().map(|by| by[axis]).sum());
        found.push(Tag { text, content, at });
    }
    found
}

/// The numbers after a key, up to an end.
fn numbers(tag: &str, key: &str, end: char) -> Option<Vec<f64>> {
    let listed = tag.split(key).nth(1)?.split(end).next()?;
    Some(listed.split([' ', ',']).filter_map(|number| number.parse().ok()).collect())
}
