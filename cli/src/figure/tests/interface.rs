//! The pictures of interfaces: catalogues, maps, chains over time.

use asperity::record::Quantity;
use asperity::scenario::Figure;
use asperity::task::summary::{Catalogue, InterfaceNumbers, Largest, Numbers};
use asperity_runner::output::Outcome;

use super::super::advance::Advance;
use super::{draw, frames, raw, style, svg, timed};

/// Events of sizes 1, 2, 3 … over a lattice of 3 × 4 contacts, shown twice.
pub fn lattice(events: usize) -> Outcome {
    let catalogue = Catalogue {
        unfinished: 0,
        cells: 12,
        events,
        from: 0.0,
        magnitude: "size".into(),
        magnitude_unit: "1".into(),
        law: None,
        mean_waiting: Some(1.0),
        waiting_variation: Some(0.0),
        largest: None,
        dissipated_breaks: None,
        dissipated_slip: None,
        wave_speed: None,
        front_speed: None,
        main_shocks: None,
    };
    let mut outcome = timed(InterfaceNumbers { catalogue });
    let numbers = |count: usize| (1..=count).map(|i| i as f64).collect::<Vec<_>>();
    let mut add = |name: &str, quantity, along: &[&str], values| {
        outcome.record.push(name, name, quantity, along, values);
    };
    add("event_drive", Quantity::Length, &["event"], numbers(events));
    add("event_size", Quantity::Number, &["event"], numbers(events));
    add("event_force_before", Quantity::Force, &["event"], vec![0.5; events]);
    add("event_force_after", Quantity::Force, &["event"], vec![0.4; events]);
    add("drive", Quantity::Length, &["point"], numbers(41));
    add("force", Quantity::Force, &["point"], vec![0.45; 41]);
    add("map_drive", Quantity::Length, &["map_drive"], vec![20.0, 40.0]);
    add("row", Quantity::Number, &["row"], numbers(3));
    add("column", Quantity::Number, &["column"], numbers(4));
    add("cell_force", Quantity::Force, &["map_drive", "row", "column"], numbers(24));
    outcome
}

#[test]
fn the_force_after_an_event_in_time_is_drawn_where_it_ends() {
    let mut outcome = lattice(2);
    let mut add = |name: &str, quantity, along: &[&str], values: &[f64]| {
        outcome.record.push(name, name, quantity, along, values.to_vec());
    };
    add("time", Quantity::Time, &["point"], &(0..41).map(|i| 2.0 * f64::from(i)).collect::<Vec<_>>());
    add("event_time", Quantity::Time, &["event"], &[0.0, 2.0]);
    let without = Advance::of(&outcome.record).unwrap().ends(&outcome.record);
    assert_eq!(without, [1.0, 2.0]);
    // The drive, from 1 to 41, moves by 1/2 per unit of time.
    let mut add = |values: &[f64]| {
        outcome.record.push("event_duration", "duration", Quantity::Time, &["event"], values.to_vec());
    };
    add(&[1.0, 1e3]);
    assert_eq!(Advance::of(&outcome.record).unwrap().ends(&outcome.record), [1.5, 41.0]);
}

#[test]
fn an_interface_has_a_catalogue_and_maps() {
    let pictures = draw(&lattice(40)).unwrap();
    let names: Vec<_> = pictures.iter().map(|p| p.name.as_str()).filter(|n| n.ends_with("svg")).collect();
    assert_eq!(names, ["catalogue.svg", "stress_map.svg"]);
    for (picture, words) in [
        (
            "catalogue.svg",
            ["Load-point displacement XT (µm)", "Force F (MPa)", "Breaks in an event", "40 events"],
        ),
        ("stress_map.svg", ["XT = 20", "XT = 40", "Force of a cell (MPa)", "Column"]),
    ] {
        for word in words {
            assert!(svg(&pictures, picture).contains(word), "{picture} lacks {word}");
        }
    }
    // The frames of both maps have 3 rows and 4 columns of square cells, and that of the colour scale is as tall.
    let [first, second, scale] = frames(raw(&pictures, "stress_map.svg"))[..] else { panic!("three frames") };
    for map in [first, second] {
        assert!((map[2] / map[3] - 4.0 / 3.0).abs() < 1e-3, "{map:?}");
        assert!((map[1] - scale[1]).abs() + (map[3] - scale[3]).abs() < 1e-6, "{map:?} {scale:?}");
    }
    let catalogue = svg(&pictures, "catalogue.svg");
    assert!(catalogue.contains("Poisson process"));
    // The points of both densities have error bars.
    let lines = |svg: &str| svg.matches("stroke=\"#e69f00\"").count();
    assert!(lines(&catalogue) >= 10, "{}", lines(&catalogue));
    // A map is one image, and the colour scale is another.
    let map = raw(&pictures, "stress_map.svg");
    assert_eq!((map.matches("<image").count(), map.matches("href=\"data:image/png;base64,").count()), (3, 3));
    let mut none = lattice(40);
    if let Numbers::InterfaceDrive(InterfaceNumbers { catalogue }) = &mut none.summary.numbers {
        catalogue.mean_waiting = None;
    }
    for (alone, has_density) in [(none, true), (lattice(5), false)] {
        let alone = draw(&alone).unwrap();
        let text = svg(&alone, "catalogue.svg");
        assert!(text.contains("Breaks in an event") && !text.contains("Poisson process"));
        assert_eq!(text.contains("Probability density"), has_density);
    }
}

/// The magnitudes of few events stand below the force, at their drives; without events the force is alone.
#[test]
fn few_events_are_drawn_along_the_drive() {
    let pictures = draw(&lattice(5)).unwrap();
    let [force, magnitudes] = frames(raw(&pictures, "catalogue.svg"))[..] else { panic!("two frames") };
    assert_eq!([force[0], force[2]], [magnitudes[0], magnitudes[2]]);
    assert_eq!(raw(&pictures, "catalogue.svg").matches("<circle").count(), 5 + 1);
    assert_eq!(frames(raw(&draw(&lattice(0)).unwrap(), "catalogue.svg")).len(), 1);
}

/// Fields have the colours of their values where these are: rows go up.
#[test]
fn a_map_has_a_dot_for_each_cell() {
    let pictures = draw(&lattice(5)).unwrap();
    let map = raw(&pictures, "stress_map.svg");
    let base64 = map.split("base64,").nth(1).unwrap().split('"').next().unwrap();
    let bytes = base64::Engine::decode(&base64::prelude::BASE64_STANDARD, base64).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut dots = vec![0; 3 * 12];
    let info = reader.next_frame(&mut dots).unwrap();
    assert_eq!((info.width, info.height), (4, 3));
    // The first value, the least of all, is at the lower left, in the darkest colour of the scale.
    assert_eq!(dots[3 * 8..3 * 9], [0x44, 0x01, 0x54]);
}

#[test]
fn slip_rates_have_a_logarithmic_colour_scale() {
    let mut outcome = lattice(0);
    let (steps, cells) = (50, 8);
    let numbers = |count: usize, unit: f64| (0..count).map(|i| unit * i as f64).collect::<Vec<_>>();
    // The drive goes at 1e-3; cells are at rest, creep, or slip at 0.4.
    let rate = |i: usize| [0.0, 1e-9, 2e-4, 0.4][i % 4];
    let mut add = |name: &str, quantity, along: &[&str], values| {
        outcome.record.push(name, name, quantity, along, values);
    };
    add("cell", Quantity::Number, &["cell"], numbers(cells, 1.0));
    add("slip_rate_time", Quantity::Time, &["slip_rate_time"], numbers(steps, 10.0));
    add("slip_rate_step", Quantity::Number, &["slip_rate_time"], numbers(steps, 2.0));
    add("slip_rate_drive", Quantity::Length, &["slip_rate_time"], numbers(steps, 0.01));
    let rates = (0..steps * cells).map(rate).collect();
    add("slip_rate", Quantity::Velocity, &["slip_rate_time", "cell"], rates);
    let pictures = draw(&outcome).unwrap();
    let text = svg(&pictures, "slip_rate.svg");
    for words in ["Cell", "Time t (s)", "Step of the computation", "Slip rate of a cell (µm/s)"] {
        assert!(text.contains(words), "{words}");
    }
    // Three decades below the drive and up to the decade of the fastest cell, and the ends of both axes.
    for tick in ["10⁰", "10⁻³", "10⁻⁶", ">400<", ">80<"] {
        assert!(text.contains(tick), "{tick}");
    }
    assert!(!text.contains("10⁻⁷") && !text.contains("10¹"));
    let [time, step, scale] = frames(raw(&pictures, "slip_rate.svg"))[..] else { panic!("three frames") };
    // Both panels and the colour scale are equally tall.
    for other in [step, scale] {
        assert!((time[1] - other[1]).abs() + (time[3] - other[3]).abs() < 1e-6, "{time:?} {other:?}");
    }
}

/// Maps of so many rows and columns at so many drives.
fn maps(rows: usize, columns: usize, count: usize) -> Outcome {
    let mut outcome = lattice(40);
    let numbers = |count: usize| (1..=count).map(|i| i as f64).collect::<Vec<_>>();
    let own = ["map_drive", "row", "column", "cell_force"];
    outcome.record.variables.retain(|variable| !own.contains(&variable.name.as_str()));
    for (name, quantity, count) in [
        ("map_drive", Quantity::Length, count),
        ("row", Quantity::Number, rows),
        ("column", Quantity::Number, columns),
    ] {
        outcome.record.push(name, name, quantity, &[name], numbers(count));
    }
    let forces = numbers(count * rows * columns);
    outcome.record.push("cell_force", "force", Quantity::Force, &["map_drive", "row", "column"], forces);
    outcome
}

/// The style of a column of a journal.
fn column() -> Figure {
    Figure { width: Some(86.0), font_size: Some(8.0), ..style() }
}

/// Cells are square however long the lattice is, and the colour scale has room for its label.
#[test]
fn maps_of_any_shape_have_square_cells() {
    for (rows, columns, count) in
        [(20, 90, 6), (20, 90, 1), (2, 200, 1), (90, 20, 6), (64, 64, 3), (600, 20, 2)]
    {
        for style in [style(), column()] {
            let pictures = super::super::draw(&mut maps(rows, columns, count), &style).unwrap();
            let found = frames(raw(&pictures, "stress_map.svg"));
            assert_eq!(found.len(), count + 1);
            let is_map =
                |frame: &&[f64; 4]| (frame[2] / frame[3] / (columns as f64 / rows as f64) - 1.0).abs() < 0.01;
            assert_eq!(found.iter().filter(is_map).count(), count, "{rows} × {columns}: {found:?}");
            assert!(found.iter().all(|frame| frame[3] > 55.0 || is_map(&frame)), "{found:?}");
        }
    }
}

/// Titles of panels have the unit of length, rows have whole numbers, and the title says that maps are left out.
#[test]
fn maps_say_where_they_are_and_how_many_are_not_drawn() {
    let text = svg(&draw(&maps(10, 10, 13)).unwrap(), "stress_map.svg");
    for words in ["XT = 1 µm<", "XT = 13 µm<", "(6 of 13 maps)<"] {
        assert!(text.contains(words), "{words}");
    }
    for part in [">2.5<", ">7.5<"] {
        assert!(!text.contains(part), "{part}");
    }
    assert!(!svg(&draw(&maps(10, 10, 6)).unwrap(), "stress_map.svg").contains("maps)"));
    // Of a long title the words are shortened, not their number.
    let mut long = maps(10, 10, 13);
    long.summary.title = "Small slips ".repeat(20);
    assert!(svg(&draw(&long).unwrap(), "stress_map.svg").contains("… (6 of 13 maps)<"));
    let untitled = super::super::draw(&mut long, &Figure { title: false, ..style() }).unwrap();
    assert!(!svg(&untitled, "stress_map.svg").contains("maps)"));
}

/// A chain of 10 cells with three events, the second of which is the largest: cells 1 to 3, 5 and 8 slipped in it.
fn chain() -> Outcome {
    let mut outcome = lattice(3);
    let numbers = |count: usize| (1..=count).map(|i| i as f64).collect::<Vec<_>>();
    let own = ["map_drive", "row", "column", "cell_force"];
    outcome.record.variables.retain(|variable| !own.contains(&variable.name.as_str()));
    if let Numbers::InterfaceDrive(InterfaceNumbers { catalogue }) = &mut outcome.summary.numbers {
        catalogue.largest = Some(Largest { event: 2, magnitude: 5.0, cells: 5.0, drive: 2.0 });
        catalogue.wave_speed = Some(1.5);
    }
    let mut add = |name: &str, quantity, along: &[&str], values| {
        outcome.record.push(name, name, quantity, along, values);
    };
    add("cell", Quantity::Number, &["cell"], numbers(10));
    add("map_drive", Quantity::Length, &["map_drive"], numbers(41));
    add("cell_force", Quantity::Force, &["map_drive", "cell"], numbers(410));
    add("slipped_event", Quantity::Number, &["slipped"], vec![1.0, 2.0, 2.0, 2.0, 2.0, 2.0, 3.0, 3.0]);
    // In the order in which they began.
    add("slipped_cell", Quantity::Number, &["slipped"], vec![6.0, 2.0, 1.0, 3.0, 8.0, 5.0, 0.0, 1.0]);
    add("slipped_start", Quantity::Time, &["slipped"], vec![0.1, 0.2, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7]);
    for (name, speed) in [("left", 4.0), ("right", 2.5)] {
        add(
            &format!("event_front_speed_{name}"),
            Quantity::Number,
            &["event"],
            vec![f64::NAN, speed, f64::NAN],
        );
    }
    outcome
}

/// Left and right end of the black lines in the first panel, in cells, and the cells with dots.
fn marked(text: &str) -> (Vec<[f64; 2]>, Vec<f64>) {
    let [left, _, width, _] = frames(text)[0];
    let cell = |x: f64| (100.0 * 10.0 * (x - left) / width).round() / 100.0;
    let number =
        |part: &str, key: &str| -> Option<f64> { part.split(key).nth(1)?.split('"').next()?.parse().ok() };
    let panel = text.split("data-frame").nth(1).unwrap();
    let paths = panel.split("<path ").skip(1).filter(|path| path.contains("stroke=\"#000000\""));
    let ends = |path: &str| {
        let d = path.split("d=\"").nth(1).unwrap().split('"').next().unwrap();
        let points = d.split(['M', 'L']).filter(|point| !point.trim().is_empty());
        let x: Vec<f64> =
            points.map(|point| point.trim().split([' ', ',']).next().unwrap().parse().unwrap()).collect();
        [cell(x[0]), cell(x[x.len() - 1])]
    };
    let dots = panel
        .split("<circle ")
        .skip(1)
        .filter(|circle| number(circle, "r=\"").unwrap() < 2.0)
        .filter_map(|circle| number(circle, "cx=\""))
        .map(cell);
    (paths.map(ends).collect(), dots.collect())
}

#[test]
fn lines_are_over_cells_that_slipped_and_dots_on_single_ones() {
    let pictures = draw(&chain()).unwrap();
    let text = raw(&pictures, "space_time.svg");
    let (mut lines, mut dots) = marked(text);
    lines.sort_by(|a, b| a[0].total_cmp(&b[0]));
    dots.sort_by(f64::total_cmp);
    assert_eq!(lines, [[0.0, 2.0], [1.0, 4.0]]);
    assert_eq!(dots, [5.5, 6.5, 8.5]);
    assert!(svg(&pictures, "space_time.svg").contains(">cells that slipped in an event<"));
}

/// The speeds are in the legend, and what is above the panel fits and has the variable of the axis.
#[test]
fn the_largest_event_is_named_by_its_drive_or_its_time() {
    let mut outcome = chain();
    let text = svg(&draw(&outcome).unwrap(), "space_time.svg");
    for words in ["Largest event, at XT = 2 µm<", "front to the right: 2.5 cells/s<", "waves: 1.5 cells/s<"]
    {
        assert!(text.contains(words), "{words}");
    }
    let count = |outcome: &Outcome, name: &str| outcome.record.values(name).unwrap().len();
    for (name, of, along) in [
        ("time", "drive", "point"),
        ("map_time", "map_drive", "map_drive"),
        ("event_time", "event_drive", "event"),
    ] {
        let values = (1..=count(&outcome, of)).map(|i| 10.0 * i as f64).collect();
        outcome.record.push(name, name, Quantity::Time, &[along], values);
    }
    let text = svg(&draw(&outcome).unwrap(), "space_time.svg");
    assert!(text.contains("Largest event, at t = 20 s<") && text.contains("Time t (s)"));
}

/// An event that is shorter than a row of the picture is in it.
#[test]
fn no_event_is_left_out_of_slip_rates() {
    let mut outcome = lattice(0);
    let mut add = |name: &str, quantity, along: &[&str], values| {
        outcome.record.push(name, name, quantity, along, values);
    };
    // Ten steps for each of five events: five while the chain creeps, and five, close together, in the event.
    let at = |event: i32, step: i32| {
        f64::from(137 * event + 27 * step.min(4)) + 1e-3 * f64::from((step - 4).max(0))
    };
    let time: Vec<f64> = (0..50).map(|i| at(i / 10, i % 10)).collect();
    let rates = (0..50).flat_map(|i| vec![if i % 10 == 7 { 0.4 } else { 1e-4 }; 4]).collect();
    let drive = time.iter().map(|time| 1e-3 * time).collect();
    add("cell", Quantity::Number, &["cell"], vec![0.0, 1.0, 2.0, 3.0]);
    add("slip_rate_step", Quantity::Number, &["slip_rate_time"], (0..50).map(f64::from).collect());
    add("slip_rate_drive", Quantity::Length, &["slip_rate_time"], drive);
    add("slip_rate_time", Quantity::Time, &["slip_rate_time"], time);
    add("slip_rate", Quantity::Velocity, &["slip_rate_time", "cell"], rates);
    let pictures = draw(&outcome).unwrap();
    let image = raw(&pictures, "slip_rate.svg").split("base64,").nth(1).unwrap().split('"').next().unwrap();
    let bytes = base64::Engine::decode(&base64::prelude::BASE64_STANDARD, image).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut dots = vec![0; 3 * 4 * 50];
    let info = reader.next_frame(&mut dots).unwrap();
    assert_eq!((info.width, info.height), (4, 50));
    // Fast cells are bright.
    let is_bright = |row: usize| dots[3 * 4 * row] > 200;
    let events = (0..50).filter(|&row| is_bright(row) && (row == 0 || !is_bright(row - 1))).count();
    assert_eq!(events, 5);
}

/// Pictures of several panels have no room for a title that is not wanted.
#[test]
fn a_picture_without_a_title_begins_with_its_panels() {
    let top = |title: bool, name: &str| {
        let pictures = super::super::draw(&mut chain(), &Figure { title, ..style() }).unwrap();
        let text = raw(&pictures, name);
        let moved = text.split("translate(").nth(1).and_then(|rest| rest.split(')').next()).unwrap();
        moved.split(',').nth(1).unwrap().parse::<f64>().unwrap()
    };
    for name in ["space_time.svg", "catalogue.svg"] {
        assert!(
            top(true, name) > 25.0 && top(false, name) <= 10.0,
            "{name}: {} {}",
            top(true, name),
            top(false, name)
        );
    }
}
