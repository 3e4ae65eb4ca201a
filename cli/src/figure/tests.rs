use asperity::record::{Quantity, Record};
use asperity::scenario::{Figure, FigureFormat, Units};
use asperity::task::summary::{
    CurveLimits, Extended, Friction, FrictionCoefficients, HealingCurve, HoldCurveNumbers, Numbers, Peak,
    ProtocolNumbers, ProtocolStep, PullNumbers, RateState, SimulatedStickSlip, StabilityNumbers,
    StaticFriction, StickSlipKind, StickSlipNumbers, Summary, VelocityCurveNumbers,
};
use asperity_runner::output::{Attachment, Outcome};

mod extremes;
mod interface;

use interface::lattice;

fn friction() -> Friction {
    Friction {
        static_friction: StaticFriction::Reached { force: 0.8, position: 0.5 },
        kinetic_friction: 0.5,
        relaxation_length: Extended(10.0),
        relaxation_length_paper: Extended(9.0),
        critical_stiffness: Extended(6.0),
        friction_coefficients: None,
    }
}

/// Something to draw: a decaying force, two snapshots, a steady state.
fn outcome() -> Outcome {
    let mut record = Record::default();
    let grid = |count: i32, step: f64| (0..count).map(|i| step * f64::from(i)).collect::<Vec<_>>();
    let (position, stretch) = (grid(200, 0.05), grid(100, 0.02));
    let force: Vec<f64> = position.iter().map(|x| 0.5 - 0.4 * (-0.1 * x).exp() * (6.0 * x).cos()).collect();
    let bell =
        |center: f64| stretch.iter().map(move |x| (-8.0 * (x - center).powi(2)).exp()).collect::<Vec<_>>();
    record.push("force_std", "standard deviation", Quantity::Force, &["position"], vec![0.02; 200]);
    record.push("ensemble_force", "force", Quantity::Force, &["position"], force.clone());
    record.push("ensemble_error", "error", Quantity::Force, &["position"], vec![0.02; 200]);
    record.push("position", "position", Quantity::Length, &["position"], position);
    record.push("force", "force", Quantity::Force, &["position"], force);
    record.push("breaking_rate", "rate", Quantity::PerLength, &["position"], vec![1.0; 200]);
    record.push("snapshot", "position", Quantity::Length, &["snapshot"], vec![0.0, 1.5]);
    record.push(
        "stretch_density",
        "Q",
        Quantity::PerLength,
        &["snapshot", "stretch"],
        [bell(0.2), bell(0.9)].concat(),
    );
    record.push("steady_stretch_density", "Q", Quantity::PerLength, &["stretch"], bell(0.0));
    record.push("threshold_density", "P_c", Quantity::PerLength, &["stretch"], bell(1.0));
    record.push("hazard", "P", Quantity::PerLength, &["stretch"], stretch.iter().map(|x| x * x).collect());
    record.push("stretch", "stretch", Quantity::Length, &["stretch"], stretch);
    let summary = Summary {
        title: "A pull & <more>".into(),
        version: "0.1.0".into(),
        units: Units { length: "µm".into(), force: "MPa".into(), time: String::new() },
        accuracy: Some(1e-10),
        contacts: 1.0,
        background_force: None,
        normal_load: None,
        sample: Some(100.0),
        seed: Some(1),
        disorder: None,
        numbers: Numbers::Pull(PullNumbers { friction: friction(), derivatives: Vec::new(), compare: None }),
        warnings: Vec::new(),
    };
    Outcome { scenario: String::new(), summary, record }
}

fn style() -> Figure {
    Figure { formats: vec![FigureFormat::Svg, FigureFormat::Png], ..Figure::default() }
}

fn draw(outcome: &Outcome) -> Result<Vec<Attachment>, String> {
    super::draw(&mut outcome.clone(), &style())
}

/// A picture as SVG.
fn raw<'a>(pictures: &'a [Attachment], name: &str) -> &'a str {
    let picture = pictures.iter().find(|p| p.name == name).unwrap();
    std::str::from_utf8(&picture.bytes).unwrap()
}

/// The same without the marks of symbols within texts.
fn svg(pictures: &[Attachment], name: &str) -> String {
    let mut parts = raw(pictures, name).replace("</tspan>", "");
    while let Some(start) = parts.find("<tspan") {
        let end = start + parts[start..].find('>').unwrap();
        parts.replace_range(start..=end, "");
    }
    parts
}

/// The frames of the panels, at which curves are cut: left, top, width, height.
fn frames(svg: &str) -> Vec<[f64; 4]> {
    assert!(!svg.contains("clip-path"));
    let groups = svg.split("data-frame=\"").skip(1).map(|part| part.split('"').next().unwrap());
    let numbers = groups.map(|frame| frame.split(' ').map(|number| number.parse().unwrap()));
    numbers.map(|frame| frame.collect::<Vec<f64>>().try_into().unwrap()).collect()
}

#[test]
fn every_picture_comes_in_every_format() {
    let formats = FigureFormat::ALL.to_vec();
    let pictures = super::draw(&mut outcome(), &Figure { formats, ..style() }).unwrap();
    let names: Vec<_> = pictures.iter().map(|p| p.name.as_str()).collect();
    let expected = ["force", "evolution", "distribution"]
        .map(|n| ["svg", "png", "pdf"].map(|ending| format!("{n}.{ending}")));
    assert_eq!(names, expected.as_flattened());
    for (ending, start) in [("svg", &b"<svg"[..]), ("png", b"\x89PNG"), ("pdf", b"%PDF")] {
        let mut of_format = pictures.iter().filter(|p| p.name.ends_with(ending));
        assert!(of_format.all(|p| p.bytes.starts_with(start)), "{ending}");
    }
    assert!(super::draw(&mut outcome(), &Figure { formats: Vec::new(), ..style() }).unwrap().is_empty());
    let twice = Figure { formats: vec![FigureFormat::Png; 2], ..style() };
    assert_eq!(super::draw(&mut outcome(), &twice).unwrap().len(), 3);
}

/// A file in PNG: its size, its resolution in dots per metre, its samples.
fn read_png(bytes: &[u8]) -> ([u32; 2], Option<u32>, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut dots = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut dots).unwrap();
    ([frame.width, frame.height], reader.info().pixel_dims.map(|dims| dims.xppu), dots)
}

/// The picture in SVG as another program draws it, which reads it and lays its texts out: red, green and blue on white.
fn drawn_by_resvg(svg: &str, scale: f32, [width, height]: [u32; 2]) -> Vec<u8> {
    let mut options = usvg::Options::default();
    for font in super::letters::fonts() {
        options.fontdb_mut().load_font_data(font.to_vec());
    }
    let tree = usvg::Tree::from_str(svg, &options).unwrap();
    let mut dots = tiny_skia::Pixmap::new(width, height).unwrap();
    dots.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut dots.as_mut());
    dots.data().chunks_exact(4).flat_map(|dot| [dot[0], dot[1], dot[2]]).collect()
}

/// PNG pictures show what the SVG shows: curves, markers, dashes, areas, fields, texts with symbols, in colours and in grey.
#[test]
fn dots_are_those_of_the_svg_drawn_by_another_program() {
    for (outcome, grey) in [(outcome(), false), (lattice(40), false), (outcome(), true), (lattice(5), true)] {
        let pictures = super::draw(&mut outcome.clone(), &Figure { grey, dpi: 192.0, ..style() }).unwrap();
        for pair in pictures.chunks(2) {
            let (size, resolution, dots) = read_png(&pair[1].bytes);
            assert_eq!(resolution, Some(7559), "192 dots on 0.0254 m");
            let expected = drawn_by_resvg(raw(&pictures, &pair[0].name), 2.0, size);
            let samples = if grey { 1 } else { 3 };
            let apart = dots.chunks(samples).zip(expected.chunks(3));
            let apart =
                apart.map(|(got, expected)| (0..3).map(|i| got[i % samples].abs_diff(expected[i])).max());
            // Of areas both count a quarter of a row of dots as covered or not, 64 of 255. Coordinates in SVG have two digits, so that
            // an edge on the border of a quarter may be on the other side of it. Here letters cover any part of a dot.
            let other = apart.clone().filter(|apart| *apart > Some(40)).count();
            let most = apart.clone().flatten().max();
            let parts = other as f64 / (dots.len() / samples) as f64;
            assert!(
                most < Some(128) && parts < 1e-3,
                "{}: {other} dots are others, by {most:?}",
                pair[1].name
            );
            // A shade of 255 in a thousand dots.
            let mean = apart.flatten().map(f64::from).sum::<f64>() / (dots.len() / samples) as f64;
            assert!(mean < 0.25, "{}: {mean}", pair[1].name);
        }
    }
}

/// Measured points are points, and what is left of them stands below, on the same axis.
#[test]
fn measured_forces_have_a_panel_of_their_residuals() {
    let mut outcome = outcome();
    let position: Vec<f64> = (0..30).map(|i| 0.3 * f64::from(i)).collect();
    for (name, quantity, values) in [
        ("compared_position", Quantity::Length, position),
        ("compared_force", Quantity::Force, vec![0.6; 30]),
        ("compared_residual", Quantity::Force, [vec![0.1; 29], vec![f64::NAN]].concat()),
    ] {
        outcome.record.push(name, name, quantity, &["compared"], values);
    }
    let pictures = draw(&outcome).unwrap();
    let text = raw(&pictures, "force.svg");
    let [force, residuals] = frames(text)[..] else { panic!("two frames") };
    assert_eq!([force[0], force[2]], [residuals[0], residuals[2]]);
    // In both panels, but for one where no force is computed, and in the legend.
    assert_eq!(text.matches("fill=\"#009e73\"").count(), 30 + 29 + 1);
    assert!(svg(&pictures, "force.svg").contains(">Residual (MPa)<"));
}

/// A column of 86 mm at 600 dots per inch has 2031.5 dots, and its height follows.
#[test]
fn a_picture_has_the_width_and_the_resolution_that_are_asked_for() {
    let wanted = Figure { width: Some(86.0), dpi: 600.0, ..style() };
    let pictures = super::draw(&mut outcome(), &wanted).unwrap();
    let text = raw(&pictures, "force.svg");
    assert!(text.contains("width=\"86mm\"") && text.contains("viewBox=\"0 0 660 480\""), "{}", &text[..200]);
    let png = &pictures.iter().find(|p| p.name == "force.png").unwrap().bytes;
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    assert_eq!([number(16), number(20)], [2032, 1478]);
}

/// The labels of axes have 15 units of the canvas, which is as wide as the picture.
#[test]
fn letters_have_the_size_that_is_asked_for() {
    let wanted = Figure { width: Some(86.0), height: Some(60.0), font_size: Some(8.0), ..style() };
    let pictures = super::draw(&mut outcome(), &wanted).unwrap();
    for (name, panels) in [("force.svg", 1), ("evolution.svg", 2)] {
        let text = raw(&pictures, name);
        let size = |key: &str| -> f64 {
            let value = text.split(&format!(" {key}=\"")).nth(1).unwrap().split('"').next().unwrap();
            value.trim_end_matches("mm").parse().unwrap()
        };
        let canvas: Vec<f64> = text
            .split("viewBox=\"")
            .nth(1)
            .and_then(|rest| rest.split('"').next())
            .map(|rest| rest.split(' ').map(|number| number.parse().unwrap()).collect())
            .unwrap();
        assert_eq!(size("width"), 86.0);
        // A point is 25.4 / 72 mm. Pictures of several panels have margins besides, of 20 units.
        let points = 15.0 * 86.0 / canvas[2] / 25.4 * 72.0;
        assert!((points / 8.0 - 1.0).abs() < if panels == 1 { 1e-9 } else { 0.05 }, "{name}: {points}");
        if panels == 1 {
            assert!((size("height") - 60.0).abs() < 1e-9);
        }
        assert_eq!(frames(text).len(), panels);
    }
}

#[test]
fn grey_pictures_have_shades_of_grey_alone() {
    let pictures = super::draw(&mut outcome(), &Figure { grey: true, ..style() }).unwrap();
    // The evolution has letters and one curve.
    for (name, least) in [("force.svg", 3), ("evolution.svg", 2), ("distribution.svg", 3)] {
        let text = raw(&pictures, name);
        let colours = text.split("\"#").skip(1).map(|part| &part[..6]);
        let grey = |colour: &str| colour[..2] == colour[2..4] && colour[..2] == colour[4..];
        let mut shades: Vec<&str> =
            colours.inspect(|colour| assert!(grey(colour), "{name}: {colour}")).collect();
        shades.sort_unstable();
        shades.dedup();
        assert!(shades.len() >= least, "{name}: {shades:?}");
    }
}

/// The number of ticks that begin on the lower edge of a frame, by their length.
fn ticks_below(text: &str, frame: [f64; 4]) -> [usize; 2] {
    let edge = frame[1] + frame[3];
    let number = |line: &str, key: &str| -> f64 {
        line.split(&format!("{key}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
    };
    let mut found = [0, 0];
    for line in text.split("<line ").skip(1) {
        let [x1, y1, x2, y2] = ["x1", "y1", "x2", "y2"].map(|key| number(line, key));
        if x1 == x2 && (y1.max(y2) - edge).abs() < 0.02 {
            match (y1 - y2).abs() {
                length if (length - 5.0).abs() < 0.02 => found[0] += 1,
                length if (length - 3.0).abs() < 0.02 => found[1] += 1,
                _ => {}
            }
        }
    }
    found
}

#[test]
fn axes_have_minor_ticks() {
    let pictures = draw(&outcome()).unwrap();
    let text = raw(&pictures, "force.svg");
    // From 0 to 9.95 with ticks at 0, 2, 4, 6 and 8 and four parts of each step, up to 9.5.
    assert_eq!(ticks_below(text, frames(text)[0]), [5, 15]);
}

#[test]
fn symbols_are_typeset() {
    let pictures = draw(&outcome()).unwrap();
    let text = raw(&pictures, "force.svg");
    assert!(text.contains("Friction force <tspan font-style=\"italic\">F</tspan> (MPa)"));
    assert!(!text.contains('_'));
}

/// A map of correlation coefficients without the start of the pull, where the force is certain, for positions at even
/// and at other distances. None for one position besides.
#[test]
fn covariances_are_drawn_as_correlation_coefficients() {
    let draw_at = |positions: Vec<f64>| {
        let mut outcome = outcome();
        let square: Vec<f64> =
            positions.iter().flat_map(|a| positions.iter().map(move |b| a.min(*b) * 4.0)).collect();
        let dimensions = ["covariance_position", "covariance_other"];
        outcome.record.push(dimensions[0], "X₁", Quantity::Length, &dimensions[..1], positions.clone());
        outcome.record.push(dimensions[1], "X₂", Quantity::Length, &dimensions[1..], positions);
        outcome.record.push("covariance", "covariance", Quantity::ForceSquared, &dimensions, square);
        draw(&outcome).unwrap()
    };
    for positions in [vec![0.0, 1.0, 2.0, 3.0], vec![0.0, 1.0, 2.0, 4.0]] {
        let pictures = draw_at(positions);
        let map = svg(&pictures, "covariance.svg");
        for words in ["X₁", "X₂", "(µm)", "Correlation coefficient of the force"] {
            assert!(map.contains(words), "{words}");
        }
        assert!(!map.contains("NaN"));
        // At 0 the force has no scatter.
        assert!(map.contains("(grey: no scatter)"));
    }
    let pictures = draw_at(vec![1.0, 2.0]);
    assert!(!svg(&pictures, "covariance.svg").contains("grey"));
    let pictures = draw_at(vec![0.0, 1.0]);
    assert!(pictures.iter().all(|picture| picture.name != "covariance.svg"));
}

#[test]
fn a_record_without_snapshots_has_no_evolution() {
    let mut outcome = outcome();
    outcome.record.variables.retain(|v| v.name != "snapshot" && v.name != "stretch_density");
    let names: Vec<_> = draw(&outcome).unwrap().into_iter().map(|p| p.name).collect();
    assert_eq!(names, ["force.svg", "force.png", "distribution.svg", "distribution.png"]);
}

#[test]
fn labels_carry_units_and_titles() {
    let pictures = draw(&outcome()).unwrap();
    for (picture, words) in [
        ("force.svg", ["Position X (µm)", "Friction force F (MPa)", "static 0.8 MPa", "ensemble, N = 100"]),
        ("evolution.svg", ["Stretch x (µm)", "Q(x; X) (1/µm)", "X = 1.5", "master equation"]),
        ("distribution.svg", ["Stretch x (µm)", "Stretch density Q(x) (1/µm)", "hazard P(x)", "thresholds"]),
    ] {
        let text = svg(&pictures, picture);
        for word in words.into_iter().chain(["A pull &amp; &lt;more&gt;"]) {
            assert!(text.contains(word), "{picture} lacks {word}");
        }
    }
}

#[test]
fn a_normal_load_adds_an_axis_of_friction_coefficients() {
    let mut outcome = outcome();
    assert!(!svg(&draw(&outcome).unwrap(), "force.svg").contains("Friction coefficient"));
    let coefficients = FrictionCoefficients { normal_load: 2.0, at_rest: Some(0.4), kinetic: 0.25 };
    let friction = Friction { friction_coefficients: Some(coefficients), ..friction() };
    outcome.summary.numbers = Numbers::Pull(PullNumbers { friction, derivatives: Vec::new(), compare: None });
    assert!(svg(&draw(&outcome).unwrap(), "force.svg").contains("Friction coefficient"));
    // Measured forces have a panel of their residuals below, as wide as the other.
    outcome.record.push("compared_position", "X", Quantity::Length, &["compared"], vec![0.5, 1.0, 2.0]);
    for name in ["compared_force", "compared_residual"] {
        outcome.record.push(name, "F", Quantity::Force, &["compared"], vec![0.6; 3]);
    }
    let pictures = draw(&outcome).unwrap();
    let text = svg(&pictures, "force.svg");
    assert!(text.contains("Friction coefficient") && text.contains(">Residual (MPa)<"));
    let [force, residuals] = frames(raw(&pictures, "force.svg"))[..] else { panic!("two frames") };
    assert_eq!([force[0], force[2]], [residuals[0], residuals[2]]);
}

#[test]
fn the_same_numbers_give_the_same_bytes() {
    assert_eq!(draw(&outcome()).unwrap(), draw(&outcome()).unwrap());
}

/// An empty record, and the summary of a task in time.
fn timed(numbers: impl Into<Numbers>) -> Outcome {
    let mut outcome = outcome();
    outcome.record = Record::default();
    outcome.summary.numbers = numbers.into();
    outcome.summary.units.time = "s".into();
    outcome
}

#[test]
fn a_velocity_curve_has_its_limits_and_a_colour_for_each_temperature() {
    let limits = |t| CurveLimits { temperature: Some(t), fast: 0.51, slow: None, viscosity: None };
    let limits = vec![limits(0.1), limits(0.2)];
    let mut outcome = timed(VelocityCurveNumbers { limits, stability: None, compare: None });
    let velocity: Vec<f64> = (0..7).map(|i| 10f64.powi(i - 6)).collect();
    let both =
        |scale: f64| -> Vec<f64> { velocity.iter().chain(&velocity).map(|v| scale * v.powf(0.1)).collect() };
    let along = &["temperature", "velocity"];
    for (name, scale) in [
        ("kinetic_friction", 0.5),
        ("ensemble_force", 0.5),
        ("ensemble_error", 0.01),
        ("creep_friction", 0.4),
    ] {
        outcome.record.push(name, "force", Quantity::Force, along, both(scale));
    }
    outcome.record.push("temperature", "T", Quantity::Energy, &["temperature"], vec![0.1, 0.2]);
    outcome.record.push("velocity", "v", Quantity::Velocity, &["velocity"], velocity);
    let pictures = draw(&outcome).unwrap();
    let text = svg(&pictures, "velocity_curve.svg");
    for words in [
        "Velocity v (µm/s)",
        "Kinetic friction Fk (MPa)",
        "T = 0.1 MPa·µm",
        "T = 0.2 MPa·µm",
        "slow creep",
        "v → ∞: 0.51 MPa",
    ] {
        assert!(text.contains(words), "{words}");
    }
    assert_eq!(pictures.len(), 2);
    // Six decades from 10⁻⁶, a little longer at both ends, with 2 to 9 in each.
    let marked = raw(&pictures, "velocity_curve.svg");
    let [major, minor] = ticks_below(marked, frames(marked)[0]);
    assert_eq!(major, 7);
    assert!((48..=52).contains(&minor), "{minor}");
    // Curves of 7 velocities are smooth: they have more points than those of the velocities, as many as can be seen.
    let longest = marked.split("<path d=\"").skip(1).map(|path| path.split('"').next().unwrap());
    let most = longest.map(|path| path.matches('L').count()).max().unwrap();
    assert!(most > 3 * 6, "{most}");
}

/// The force of an ensemble in a drive is drawn as points, not as a line under the other.
#[test]
fn an_ensemble_that_sticks_and_slips_is_drawn_as_points() {
    let mut outcome = outcome();
    outcome.record = Record::default();
    let drive: Vec<f64> = (0..2000).map(|i| 0.01 * f64::from(i)).collect();
    let force: Vec<f64> = drive.iter().map(|drive| drive.fract()).collect();
    for (name, values) in [("drive", &drive), ("ensemble_drive", &drive)] {
        outcome.record.push(name, name, Quantity::Length, &["point"], values.clone());
    }
    for name in ["spring_force", "ensemble_spring_force"] {
        outcome.record.push(name, name, Quantity::Force, &["point"], force.clone());
    }
    let pictures = draw(&outcome).unwrap();
    let text = raw(&pictures, "stick_slip.svg");
    let lines = text.matches("stroke=\"#e69f00\"").count();
    let points = text.matches("fill=\"#e69f00\"").count();
    // Twenty teeth, of two markers or more each.
    assert!(lines == 0 && points > 60, "{lines} {points}");
}

#[test]
fn a_hold_curve_shows_healing_and_what_it_grows_from() {
    let hold_curve = HealingCurve {
        velocity: 1.0,
        kinetic_friction: 0.5,
        healing_per_decade: Some(0.01),
        healing_relative: Some(0.02),
        healing_cutoff: Some(3.0),
        at_one: Some(0.6),
        residual_relative: Some(0.01),
    };
    let mut outcome = timed(HoldCurveNumbers { hold_curve, compare: None });
    outcome.record.push("hold", "hold", Quantity::Time, &["hold"], vec![1.0, 10.0, 100.0]);
    outcome.record.push("static_friction", "F_s", Quantity::Force, &["hold"], vec![0.6, 0.61, 0.62]);
    let pictures = draw(&outcome).unwrap();
    let text = svg(&pictures, "hold_curve.svg");
    assert_eq!(frames(raw(&pictures, "hold_curve.svg")).len(), 1);
    for words in [
        "Hold time (s)",
        "Static friction Fs (MPa)",
        "healing 0.01 MPa per decade, cutoff time 3 s",
        "kinetic 0.5 MPa",
    ] {
        assert!(text.contains(words), "{words}");
    }
}

/// The residuals of measured hold times stand below, on the same logarithmic axis.
#[test]
fn measured_healing_has_a_panel_of_its_residuals() {
    let hold_curve = HealingCurve {
        velocity: 1.0,
        kinetic_friction: 0.5,
        healing_per_decade: None,
        healing_relative: None,
        healing_cutoff: None,
        at_one: None,
        residual_relative: None,
    };
    let mut outcome = timed(HoldCurveNumbers { hold_curve, compare: None });
    for (name, quantity, along, values) in [
        ("hold", Quantity::Time, "hold", [1.0, 10.0, 100.0]),
        ("static_friction", Quantity::Force, "hold", [0.6, 0.61, 0.62]),
        ("compared_hold", Quantity::Time, "compared", [2.0, 20.0, 50.0]),
        ("compared_force", Quantity::Force, "compared", [0.61, 0.62, 0.6]),
        ("compared_residual", Quantity::Force, "compared", [0.01, 0.008, -0.015]),
    ] {
        outcome.record.push(name, name, quantity, &[along], values.to_vec());
    }
    let pictures = draw(&outcome).unwrap();
    let text = raw(&pictures, "hold_curve.svg");
    let [force, residuals] = frames(text)[..] else { panic!("two frames") };
    assert_eq!([force[0], force[2]], [residuals[0], residuals[2]]);
    assert_eq!(ticks_below(text, force), ticks_below(text, residuals));
    assert_eq!(text.matches("fill=\"#009e73\"").count(), 3 + 3 + 1);
    assert!(svg(&pictures, "hold_curve.svg").contains(">Residual (MPa)<"));
}

/// What slides over single contacts do, in so many simulations, of which persistent stick-slip ends at 1.0.
fn scattered(simulations: usize, std: Option<f64>) -> Outcome {
    let ensemble = SimulatedStickSlip {
        simulations,
        none: 0,
        transient: 0,
        persistent: simulations,
        undecided: 0,
        mean_drop: Some(0.1),
        drop_std: None,
        period_scatter: None,
        persistent_stiffness: Extended(1.0),
        persistent_stiffness_std: std,
    };
    let numbers = StickSlipNumbers {
        velocity: None,
        stiffness: 0.5,
        stick_slip: StickSlipKind::Persistent,
        reason: String::new(),
        mean_drop: Some(0.1),
        persistent_stiffness: 1.1,
        persistent_stiffness_above: Extended(1.2),
        critical_stiffness: Extended(3.0),
        critical_stiffness_sliding: Extended(0.0),
        ensemble: Some(ensemble),
    };
    let mut outcome = timed(StabilityNumbers { stick_slip: vec![numbers] });
    let along = &["stiffness"];
    outcome.record.push("stiffness", "K", Quantity::Stiffness, along, vec![0.5, 2.0]);
    for (name, values) in [("none", [0.0, 0.5]), ("transient", [0.0, 0.5]), ("persistent", [1.0, 0.0])] {
        let name = format!("ensemble_{name}");
        outcome.record.push(&name, "fraction", Quantity::Number, along, values.to_vec());
    }
    outcome
}

#[test]
fn one_simulation_has_a_line_where_persistent_stick_slip_ends_and_several_have_a_band() {
    let one = svg(&draw(&scattered(1, None)).unwrap(), "stick_slip_scatter.svg");
    assert!(one.contains("Fraction of 1 simulation<"), "{one}");
    assert!(one.contains("end of persistence, N = 100") && !one.contains("± std"), "{one}");
    let several = svg(&draw(&scattered(3, Some(0.1))).unwrap(), "stick_slip_scatter.svg");
    assert!(several.contains("Fraction of 3 simulations"), "{several}");
    assert!(several.contains("end of persistence ± std, N = 100"), "{several}");
}

#[test]
fn a_protocol_has_a_picture_in_time_and_one_of_its_velocity_steps() {
    let steps = vec![ProtocolStep {
        velocity: 2.0,
        position: 20.0,
        duration: 20.0,
        pieces: None,
        velocity_from: None,
        relative_normal_load: None,
        force: 0.45,
        peak: Peak { force: 0.5, position: 20.0 },
        kinetic_friction: Some(0.45),
        rate_state: Some(RateState {
            velocity_before: 1.0,
            force_before: 0.5,
            a: 0.01,
            b: 0.01,
            distance: 3.0,
            peak: 0.0,
            a_relative: 0.02,
            b_relative: 0.02,
            residual: 1e-4,
            residual_relative: 0.01,
        }),
        measured: None,
        rate_state_spring: None,
        measured_spring: None,
        not_read: None,
    }];
    let mut outcome = timed(ProtocolNumbers { force_error: 1e-6, steps, compare: None });
    let time: Vec<f64> = (0..40).map(f64::from).collect();
    let velocity: Vec<f64> = time.iter().map(|t| if *t < 20.0 { 1.0 } else { 2.0 }).collect();
    let position: Vec<f64> = time.iter().map(|t| t + (t - 20.0).max(0.0)).collect();
    let force: Vec<f64> = time.iter().map(|t| 0.5 - 0.01 * (t - 20.0).clamp(0.0, 5.0)).collect();
    let mut add = |name: &str, quantity, values: &Vec<f64>| {
        outcome.record.push(name, name, quantity, &["point"], values.clone())
    };
    add("time", Quantity::Time, &time);
    add("drive", Quantity::Length, &position);
    add("position", Quantity::Length, &position);
    add("velocity", Quantity::Velocity, &velocity);
    add("force", Quantity::Force, &force);
    let pictures = draw(&outcome).unwrap();
    let names: Vec<_> = pictures.iter().map(|p| p.name.as_str()).filter(|n| n.ends_with("svg")).collect();
    assert_eq!(names, ["protocol.svg", "velocity_step.svg"]);
    // Both panels share the axis of time.
    let [above, below] = frames(raw(&pictures, "protocol.svg"))[..] else { panic!("two frames") };
    assert_eq!([above[0], above[2]], [below[0], below[2]]);
    for (picture, words) in [
        ("protocol.svg", ["Time t (s)", "Velocity v (µm/s)", "Friction force F (MPa)"]),
        (
            "velocity_step.svg",
            ["v = 1 µm/s → 2 µm/s", "Displacement since the step (µm)", "rate-and-state fit"],
        ),
    ] {
        for word in words {
            assert!(svg(&pictures, picture).contains(word), "{picture} lacks {word}");
        }
    }
    // Measured points of the step are points, and their residuals stand below, but for those beyond the step.
    add_measured(&mut outcome);
    let pictures = draw(&outcome).unwrap();
    let text = raw(&pictures, "velocity_step.svg");
    let [force, residuals] = frames(text)[..] else { panic!("two frames") };
    assert_eq!([force[0], force[2]], [residuals[0], residuals[2]]);
    // In both panels, and in the legend.
    assert_eq!(text.matches("fill=\"#009e73\"").count(), 9 + 9 + 1);
    assert!(svg(&pictures, "velocity_step.svg").contains(">Residual (MPa)<"));
    // Without a step in velocity they are shown against the position.
    let Numbers::Protocol(protocol) = &mut outcome.summary.numbers else { panic!("a protocol") };
    protocol.steps[0].rate_state = None;
    let pictures = draw(&outcome).unwrap();
    let names: Vec<_> = pictures.iter().map(|p| p.name.as_str()).filter(|n| n.ends_with("svg")).collect();
    assert_eq!(names, ["force.svg", "protocol.svg"]);
    assert_eq!(raw(&pictures, "force.svg").matches("fill=\"#009e73\"").count(), 11 + 11 + 1);
    for word in ["Position X (µm)", "Friction force F (MPa)", "Residual (MPa)", "measured"] {
        assert!(svg(&pictures, "force.svg").contains(word), "{word}");
    }
}

/// Where all contacts have one stretch, a stem shows them, and no line of density 0 is drawn beside it.
#[test]
fn point_masses_alone_have_no_line() {
    let lines = |outcome: &Outcome| raw(&draw(outcome).unwrap(), "evolution.svg").matches("<path d=").count();
    let smooth = outcome();
    let mut masses = smooth.clone();
    for variable in masses.record.variables.iter_mut().filter(|variable| variable.name == "stretch_density") {
        variable.values.fill(0.0);
    }
    assert_eq!(lines(&smooth) - lines(&masses), 2);
}

/// Eleven measured points, two of which are before what is shown of the step from 20 to 60.
fn add_measured(outcome: &mut Outcome) {
    let position = [2.0, 10.0, 17.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0];
    outcome.record.push("compared_position", "X", Quantity::Length, &["compared"], position.to_vec());
    outcome.record.push("compared_force", "F", Quantity::Force, &["compared"], vec![0.48; 11]);
    outcome.record.push("compared_residual", "F", Quantity::Force, &["compared"], vec![-0.01; 11]);
}

/// A protocol with this velocity.
fn moving(velocity: impl Fn(f64) -> f64) -> String {
    let numbers = ProtocolNumbers { force_error: 1e-6, steps: Vec::new(), compare: None };
    let mut outcome = timed(numbers);
    let time: Vec<f64> = (0..100).map(f64::from).collect();
    for (name, quantity, values) in [
        ("velocity", Quantity::Velocity, time.iter().copied().map(velocity).collect()),
        ("force", Quantity::Force, vec![0.5; 100]),
        ("time", Quantity::Time, time),
    ] {
        outcome.record.push(name, name, quantity, &["point"], values);
    }
    svg(&draw(&outcome).unwrap(), "protocol.svg")
}

#[test]
fn a_short_logarithmic_axis_has_two_labels() {
    let ends = |low: f64, high: f64| super::style::decades(&[low, high]);
    // 50, and 100 added; 5 and 2 added; both of a single value; 10 and 20.
    assert!((36.0..37.0).contains(&ends(37.0, 66.0).0) && ends(37.0, 66.0).1 == 100.0);
    assert_eq!(ends(2.1, 7.0).0, 2.0);
    assert_eq!(ends(3e-3, 3e-3), (2e-3, 5e-3));
    assert!(ends(9.0, 21.0).0 > 8.0 && ends(9.0, 21.0).1 < 22.0);
    // As they are.
    assert_eq!([ends(1e-310, 1e-310), ends(1e308, 1e308)], [(1e-310, 1e-310), (1e308, 1e308)]);
    assert!(ends(0.0, 0.0).0.is_nan() && ends(1.0, f64::INFINITY).1 == f64::INFINITY);
}

/// Slow creep, slow slip and rest are distinguished from each other; the axis of a velocity of one size, or of both signs, is linear.
#[test]
fn a_velocity_over_decades_has_a_logarithmic_axis() {
    let slow = moving(|t| if t < 50.0 { 1e-6 } else { 1e-2 });
    for power in ["10⁻⁶", "10⁻⁴", "10⁻²"] {
        assert!(slow.contains(power), "{power}");
    }
    // The two phases are four fifths of the panel apart or more.
    let [top, height] = [1, 3].map(|i| frames(&slow)[0][i]);
    let curve =
        slow.split("data-frame").nth(1).unwrap().split(" d=\"").nth(1).unwrap().split('"').next().unwrap();
    let heights: Vec<f64> = curve
        .split(['M', 'L'])
        .filter_map(|point| point.trim().split([' ', ',']).nth(1)?.parse().ok())
        .collect();
    let (high, low) = (heights[heights.len() - 1], heights[0]);
    assert!(low - high > 0.8 * height && high > top, "{low} {high} {top} {height}");
    // A slider that holds is below the axis.
    let holds = moving(|t| [0.0, 1e-5, 1.0][(t as usize / 10) % 3]);
    assert!(holds.contains("10⁻⁵") || holds.contains("10⁻⁴"));
    for linear in [moving(|t| 1.0 + 0.01 * t), moving(|t| (0.1 * t).sin()), moving(|_| 0.0)] {
        assert!(!linear.contains('⁻'), "a power of ten");
    }
}
