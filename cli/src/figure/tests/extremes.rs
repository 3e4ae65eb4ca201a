//! Pictures of very small values, of values of one sign or one size, and of texts with control characters.

use asperity::record::Quantity;
use asperity::scenario::{Figure, FigureFormat};
use asperity::task::summary::{
    CurveLimits, Noise, ProtocolNumbers, SpectrumNumbers, StabilityNumbers, VelocityCurveNumbers,
};
use asperity_runner::output::Outcome;

use super::interface::lattice;
use super::{draw, frames, outcome, raw, style, svg, timed};

/// The places of the points of the longest curve of a picture, across and down.
fn longest(svg: &str) -> (Vec<f64>, Vec<f64>) {
    let curves = svg.split(" d=\"").skip(1).map(|path| path.split('"').next().unwrap());
    let curve = curves.max_by_key(|path| path.matches('L').count()).unwrap();
    let points = curve.split(['M', 'L']).filter_map(|point| {
        let mut numbers = point.split([' ', ',']).filter_map(|number| number.parse::<f64>().ok());
        Some((numbers.next()?, numbers.next()?))
    });
    points.unzip()
}

/// The part of a length that lies between the first and the last of these places.
fn part(places: &[f64], length: f64) -> f64 {
    let ends = places
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &at| (at.min(low), at.max(high)));
    (ends.1 - ends.0) / length
}

/// A velocity curve from one power of ten to another.
fn velocities(from: i32, to: i32) -> Outcome {
    let limits = vec![CurveLimits { temperature: None, fast: 0.51, slow: None, viscosity: None }];
    let mut outcome = timed(VelocityCurveNumbers { limits, stability: None, compare: None });
    let parts = 4 * (to - from);
    let velocity = (0..=parts).map(|i| 10f64.powf(f64::from(from) + 0.25 * f64::from(i))).collect();
    let friction = (0..=parts).map(|i| 0.3 + (f64::from(i) / f64::from(parts)).powi(2)).collect();
    outcome.record.push("velocity", "v", Quantity::Velocity, &["velocity"], velocity);
    outcome.record.push("kinetic_friction", "F_k", Quantity::Force, &["velocity"], friction);
    outcome
}

/// Each decade below 10⁻¹⁰ is as wide as the others, with a label of its true value.
#[test]
fn a_logarithmic_axis_goes_down_to_any_value() {
    for (from, to) in [(-14, -2), (-13, -12), (-300, -298)] {
        let pictures = draw(&velocities(from, to)).unwrap();
        let text = raw(&pictures, "velocity_curve.svg");
        let (across, _) = longest(text);
        let frame = frames(text)[0];
        assert!(part(&across, frame[2]) > 0.9, "{from}: {across:?} in {frame:?}");
        let middle =
            across.iter().filter(|&&x| x > frame[0] + 0.25 * frame[2] && x < frame[0] + 0.75 * frame[2]);
        assert!(middle.count() > 3, "{from}: {across:?}");
    }
    let labels = svg(&draw(&velocities(-14, -2)).unwrap(), "velocity_curve.svg");
    assert!(
        ["10⁻¹⁴", "10⁻⁸", "10⁻²"].iter().all(|label| labels.contains(label)) && !labels.contains("10⁻¹⁵")
    );
}

/// A protocol with these velocities and forces, for 100 times.
fn protocol(velocity: impl Fn(f64) -> f64, force: impl Fn(f64) -> f64) -> Outcome {
    let mut outcome = timed(ProtocolNumbers { force_error: 1e-6, steps: Vec::new(), compare: None });
    let time: Vec<f64> = (0..100).map(f64::from).collect();
    for (name, quantity, values) in [
        ("velocity", Quantity::Velocity, time.iter().copied().map(velocity).collect()),
        ("force", Quantity::Force, time.iter().copied().map(force).collect()),
        ("time", Quantity::Time, time),
    ] {
        outcome.record.push(name, name, quantity, &["point"], values);
    }
    outcome
}

/// The picture of tiny forces is that of usual ones but for the labels.
#[test]
fn a_linear_axis_shows_forces_of_any_size() {
    for size in [1.0, 2e-18, 3e-300] {
        let pictures = draw(&protocol(|_| 1.0, |t| size * (0.1 * t).sin())).unwrap();
        let text = raw(&pictures, "protocol.svg");
        let (_, down) = longest(text);
        let frame = frames(text)[1];
        let heights = part(&down, frame[3]);
        assert!((heights - 1.0 / 1.08).abs() < 0.01, "{size}: {heights}");
    }
    let pictures = draw(&protocol(|_| 1.0, |t| 2e-18 * (0.1 * t).sin())).unwrap();
    assert!(svg(&pictures, "protocol.svg").contains("10⁻¹⁸"));
}

/// Long labels of ticks do not cover the label of their axis, and both panels begin together.
#[test]
fn panels_have_room_for_long_labels() {
    let panels = |size: f64| {
        let outcome = protocol(|t| if t < 50.0 { size } else { 0.1 * size }, |t| 0.01 * t);
        frames(raw(&draw(&outcome).unwrap(), "protocol.svg"))
    };
    let (usual, long) = (panels(1.0), panels(1e-12));
    assert!(long[0][0] > usual[0][0] + 9.0, "{long:?} {usual:?}");
    assert_eq!(long[0][0], long[1][0]);
}

/// The images of a picture.
fn images(svg: &str) -> Vec<&str> {
    svg.split("base64,").skip(1).map(|part| part.split('"').next().unwrap()).collect()
}

/// An interface with other forces of its cells.
fn with_forces(of: impl Fn(f64) -> f64) -> Outcome {
    let mut outcome = lattice(40);
    for variable in outcome.record.variables.iter_mut().filter(|variable| variable.name == "cell_force") {
        variable.values.iter_mut().for_each(|force| *force = of(*force));
    }
    outcome
}

#[test]
fn a_map_of_tiny_forces_has_the_colours_of_usual_ones() {
    let [usual, tiny] = [1.0, 2f64.powi(-60)].map(|size| {
        let pictures = draw(&with_forces(|force| size * force)).unwrap();
        images(raw(&pictures, "stress_map.svg")).into_iter().map(str::to_owned).collect::<Vec<_>>()
    });
    assert_eq!(usual, tiny);
}

/// Forces that differ by rounding are one colour, and the numbers of the scale are short.
#[test]
fn equal_forces_have_one_colour() {
    let noise = |force: f64| 1.0 / 3.0 + 1e-12 * (force % 5.0);
    let pictures = draw(&with_forces(noise)).unwrap();
    let exact = draw(&with_forces(|_| 1.0 / 3.0)).unwrap();
    let [noise, exact] = [&pictures, &exact].map(|pictures| raw(pictures, "stress_map.svg"));
    assert_eq!(images(noise)[..2], images(exact)[..2]);
    assert!(!noise.contains("0.33333"));
}

/// Long numbers of a colour scale are within the picture, and so are its colours.
#[test]
fn a_colour_scale_has_room_for_long_numbers() {
    let pictures = draw(&with_forces(|force| 1.0 / 3.0 + 1e-8 * force)).unwrap();
    let text = raw(&pictures, "stress_map.svg");
    let width: f64 = text.split("viewBox=\"0 0 ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let scale = frames(text)[2];
    assert!(scale[2] > 10.0 && scale[0] + scale[2] < width, "{scale:?} in {width}");
    let tree = usvg::Tree::from_str(text, &with_fonts()).unwrap();
    let drawn = tree.root().abs_stroke_bounding_box();
    assert!(drawn.left() > -1.0 && f64::from(drawn.right()) < width + 1.0, "{drawn:?} in {width}");
}

fn with_fonts() -> usvg::Options<'static> {
    let mut options = usvg::Options { font_family: "DejaVu Sans".into(), ..usvg::Options::default() };
    super::super::letters::fonts()
        .into_iter()
        .for_each(|font| options.fontdb_mut().load_font_data(font.to_vec()));
    options
}

#[test]
fn negative_values_have_the_axis_of_positive_ones_upside_down() {
    use super::super::style::heights;
    for (low, high) in [(6e-7, 2e-6), (0.9, 1.0), (0.0, 3.0)] {
        let (bottom, top) = heights(low, high);
        assert_eq!(heights(-high, -low), (-top, 0.0 - bottom));
    }
    assert!(heights(-2e-6, -6e-7).0 > -2.2e-6);
    assert_eq!(heights(-1.0, 2.0), (-1.08, 2.16));
    // Of a drive back, too: the curve fills the frame.
    let pictures = draw(&protocol(|_| 1.0, |t| -1e-6 * (1.0 + t))).unwrap();
    let text = raw(&pictures, "protocol.svg");
    assert!(part(&longest(text).1, frames(text)[1][3]) > 0.9);
}

/// The spectrum of contacts of this mean life up to the wave number 1.
fn spectrum(mean_life: f64) -> String {
    let noise =
        Noise { size: 100.0, kinetic_friction: 0.5, force_std: 0.05, mean_life, at_zero: 1.0, tail: 0.9 };
    let mut outcome = timed(SpectrumNumbers { noise });
    let q: Vec<f64> = (0..=100).map(|i| 0.01 * f64::from(i)).collect();
    let spectrum = q.iter().map(|q| 1.0 / (1.0 + q * q)).collect();
    outcome.record.push("wave_number", "q", Quantity::PerLength, &["wave_number"], q);
    outcome.record.push("spectrum", "S", Quantity::ForceSquaredLength, &["wave_number"], spectrum);
    svg(&draw(&outcome).unwrap(), "spectrum.svg")
}

#[test]
fn multiples_of_the_wave_number_of_breaks_are_marked_where_they_are_few() {
    let marks = |mean_life: f64| spectrum(mean_life).matches("stroke-dasharray=\"2 4\"").count();
    // Ten multiples of 2π/63 are below 1, and one line is in the legend.
    assert_eq!(marks(63.0), 10 + 1);
    assert_eq!([1e4, 1e12, f64::INFINITY].map(marks), [0; 3]);
    assert!(!spectrum(1e4).contains("multiples"));
}

#[test]
fn an_axis_of_stiffnesses_has_labels() {
    let mut outcome = timed(StabilityNumbers { stick_slip: Vec::new() });
    let along = &["velocity", "stiffness"];
    outcome.record.push("stick_slip", "kind", Quantity::Number, along, vec![0.0, 1.0, 2.0, 0.0]);
    outcome.record.push("velocity", "v", Quantity::Velocity, &["velocity"], vec![0.01, 0.02]);
    outcome.record.push("stiffness", "K", Quantity::Stiffness, &["stiffness"], vec![0.32, 0.4]);
    let text = svg(&draw(&outcome).unwrap(), "stability.svg");
    assert!([">0.2<", ">0.5<"].iter().all(|label| text.contains(label)), "{text}");
}

#[test]
fn control_characters_of_titles_and_units_are_left_out() {
    let mut outcome = outcome();
    outcome.summary.title = "bell \u{7} and \u{1b}\"title\"\u{9f}".into();
    outcome.summary.units.force = "M\u{0}Pa".into();
    let formats = vec![FigureFormat::Svg, FigureFormat::Pdf];
    let pictures = super::super::draw(&mut outcome, &Figure { formats, ..style() }).unwrap();
    let text = raw(&pictures, "force.svg");
    assert!(usvg::Tree::from_str(text, &usvg::Options::default()).is_ok());
    assert!(text.contains("bell  and &quot;title&quot;<") && svg(&pictures, "force.svg").contains("(MPa)"));
}
