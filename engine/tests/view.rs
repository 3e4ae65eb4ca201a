//! What a page shows: controls whose changes the engine understands, and pictures of the numbers.

use std::ops::ControlFlow;

use asperity::monitor::Monitor;
use asperity_engine::Engine;
use asperity_engine::answer::Answer;
use asperity_engine::request::{Change, Part, Request, View};
use asperity_engine::shown::Shown;

const TEXT: &str = "[contacts]
thresholds.gaussian = { mean = 1.0, std = 0.2 }
[block]
stiffness = 0.3
slip = \"overdamped\"
[drive]
distance = 8.0
";

fn request(text: &str, changes: Vec<Change>) -> Request {
    let parts = vec![Part::Force, Part::Stretches];
    let view = Some(View { width: 400.0, whole: 800.0, readings: false });
    Request { text: text.into(), changes, parts, position: 1.25, view, ..Request::default() }
}

fn answer(text: &str, changes: Vec<Change>) -> Answer {
    let answer = Engine::default().answer(&request(text, changes), &mut ());
    assert!(answer.invalid.is_none() && answer.failures.is_empty(), "{answer:?}");
    answer
}

fn shown(text: &str) -> Shown {
    answer(text, vec![]).view.expect("what a page shows")
}

/// The value of a control as JSON has it.
fn value(answer: &Shown, id: &str) -> serde_json::Value {
    let rows = serde_json::to_value(&answer.controls).unwrap();
    let mut items = rows.as_array().unwrap().iter().flat_map(|row| row["items"].as_array().unwrap());
    items.find(|item| item["id"] == id).unwrap_or_else(|| panic!("no control {id}"))["value"].clone()
}

/// The changes of a template, as the page fills it in.
fn filled(template: &str, x: &str, y: &str) -> Vec<Change> {
    let json = template.replace("$x", x).replace("$y", y);
    let json = if json.starts_with('[') { json } else { format!("[{json}]") };
    serde_json::from_str(&json).unwrap_or_else(|error| panic!("{json}: {error}"))
}

#[test]
fn every_control_makes_a_change_that_the_engine_understands() {
    let parts =
        "[{ weight = 0.5, law.gaussian = { mean = 1.0, std = 0.1 } }, { weight = 0.5, law.point.at = 2.0 }]";
    let mixture = TEXT.replace("gaussian = { mean = 1.0, std = 0.2 }", &format!("mixture = {parts}"));
    let nodes = "tabulated = { stretch = [0.5, 0.9, 1.1, 1.5], density = [0.0, 1.0, 2.0, 0.0] }";
    let polygon = TEXT.replace("gaussian = { mean = 1.0, std = 0.2 }", nodes);
    for text in [TEXT, &mixture, &polygon] {
        let rows = serde_json::to_value(&shown(text).controls).unwrap();
        let items = rows.as_array().unwrap().iter().flat_map(|row| row["items"].as_array().unwrap());
        for item in items {
            let chosen = match item["kind"].as_str().unwrap() {
                "select" => {
                    let mut options = item["options"].as_array().unwrap().iter();
                    options
                        .find(|option| **option != item["value"])
                        .and_then(|option| option.as_str())
                        .unwrap()
                }
                _ => "0.75",
            };
            let changes = filled(item["change"].as_str().unwrap(), chosen, "");
            let changed = Engine::default().answer(&request(text, changes), &mut ());
            assert!(changed.invalid.is_none() && changed.scenario.is_some(), "{item} {changed:?}");
            assert_ne!(changed.text, text, "{item}");
        }
    }
}

#[test]
fn what_is_dragged_goes_where_it_is_dragged() {
    let view = shown(TEXT);
    let laws = view.panels.iter().find(|panel| panel.id == "laws").unwrap();
    // The mean and one standard deviation from it, and the point masses of R and Q_ini.
    assert_eq!(laws.handles.len(), 4);
    let moved = answer(TEXT, filled(&laws.handles[1].change, "1.25", "0.5"));
    assert!(moved.text.contains("{ mean = 1.0, std = 0.25 }"), "{}", moved.text);
}

#[test]
fn what_is_over_another_handle_can_be_taken() {
    let view = shown(TEXT);
    let laws = view.panels.iter().find(|panel| panel.id == "laws").unwrap();
    let [reforming, initial] = [2, 3].map(|i| laws.handles[i].at);
    assert_eq!([initial[0] - reforming[0], initial[1] - reforming[1]], [0.0, 12.0]);
    assert!(laws.svg.contains("weight 1 is 0.9 of the axis"), "{}", laws.svg);
}

#[test]
fn sliders_from_0_go_to_twice_the_mean_threshold() {
    let text = TEXT.replace("mean = 1.0, std = 0.2", "mean = 3e-6, std = 6e-7");
    let rows = serde_json::to_value(&shown(&text).controls).unwrap();
    let row = rows.as_array().unwrap().iter().find(|row| row["id"] == "initial.point.at").unwrap();
    assert_eq!(row["items"][0]["ends"], serde_json::json!([0.0, 6e-6]));
}

#[test]
fn the_velocity_of_a_pull_is_named() {
    let text = "[contacts]
thresholds.gaussian = { mean = 1.0, std = 0.2 }
ageing.logarithmic = { growth = 0.02, time = 1.0 }
[[protocol]]
hold = 10.0
[[protocol]]
velocity = 0.1
distance = 5.0
[units]
length = \"µm\"
time = \"s\"
";
    let view = shown(text);
    let force = view.panels.iter().find(|panel| panel.id == "force").unwrap();
    assert_eq!(force.title, "Friction force at <i>v</i> = 0.1 µm/s");
    let named =
        |view: &Shown| view.numbers.iter().find(|row| row.0.contains("velocity")).map(|row| row.1.clone());
    assert_eq!(named(&view).unwrap(), "0.1 µm/s");
    // Contacts that know no time have the same force at every velocity.
    assert_eq!(named(&shown(&TEXT.replace("distance = 8.0", "distance = 8.0\nvelocity = 0.01"))), None);
}

#[test]
fn a_picture_has_the_places_of_the_numbers() {
    let found = answer(TEXT, vec![]);
    let (view, force) = (found.view.unwrap(), found.force.unwrap());
    let panel = view.panels.iter().find(|panel| panel.id == "force").unwrap();
    let path = panel.svg.split("<path d=\"").find(|path| path.contains("stroke-width=\"1.75\"")).unwrap();
    let points: Vec<[f64; 2]> = path.split('"').next().unwrap()[1..]
        .split('L')
        .map(|point| {
            let (x, y) = point.split_once(' ').unwrap();
            [x.parse().unwrap(), y.parse().unwrap()]
        })
        .collect();
    assert_eq!(points.len(), force.position.len());
    let [left, top, width, height] = panel.plot;
    for (i, [x, y]) in points.into_iter().enumerate() {
        let across = panel.x.min + (panel.x.max - panel.x.min) * (x - left) / width;
        let up = panel.y.max - (panel.y.max - panel.y.min) * (y - top) / height;
        // Half of the last digit of a place, in pixels.
        let [dot, line] =
            [0.006 * (panel.x.max - panel.x.min) / width, 0.006 * (panel.y.max - panel.y.min) / height];
        assert!((across - force.position[i]).abs() < dot && (up - force.force[i]).abs() < line, "{i}");
    }
}

#[test]
fn friction_at_several_temperatures_has_a_curve_for_each() {
    let text = "[contacts]
thresholds.gaussian = { mean = 1.0, std = 0.2 }
temperature = { energy = 0.05, attempt_rate = 1.0 }
[velocity_curve]
velocities = [1e-4, 1e-3, 1e-2]
temperatures = [0.02, 0.1]
";
    let asked = Request { parts: vec![Part::Task], ..request(text, vec![]) };
    let answer = Engine::default().answer(&asked, &mut ());
    let view = answer.view.unwrap();
    let motion = view.panels.iter().find(|panel| panel.id == "motion").unwrap();
    assert!(["= 0.02<", "= 0.1<"].iter().all(|label| motion.svg.contains(label)), "{}", motion.svg);
    // The places of the three forces, from the top of the picture; lines of the legend have no corner.
    let places = ["blue", "orange"].map(|colour| -> Vec<f64> {
        let stroke = format!("stroke=\"var(--{colour})\"");
        let mut curves = motion.svg.split("<path d=\"M").filter(|path| path.contains(&stroke));
        let curve =
            curves.find_map(|path| path.split('"').next().filter(|points| points.contains('L'))).unwrap();
        curve.split('L').map(|point| point.split_once(' ').unwrap().1.parse().unwrap()).collect()
    });
    assert!(places.iter().all(|curve| curve.len() == 3 && curve.is_sorted_by(|a, b| a > b)), "{places:?}");
    // Friction rises with velocity, and warm contacts have less.
    assert!(places[0].iter().zip(&places[1]).all(|(cold, warm)| cold < warm), "{places:?}");
}

#[test]
fn units_are_labelled() {
    let view = shown(&format!("{TEXT}[units]\nlength = \"µm\"\nforce = \"mN\"\n"));
    let names: Vec<&str> =
        view.panels.iter().flat_map(|panel| &panel.columns).map(|column| column.name.as_str()).collect();
    for name in ["stretch x (µm)", "P_c (1/µm)", "F(X) (mN)", "their weights"] {
        assert!(names.contains(&name), "{name}: {names:?}");
    }
    assert_eq!(view.length, " µm");
    let numbers = serde_json::to_value(&view.numbers).unwrap();
    assert!(numbers[4][1].as_str().unwrap().ends_with(" mN/µm"), "{numbers}");
}

#[test]
fn a_rule_of_slip_begins_with_numbers_of_its_spring() {
    let chosen = |name: &str| filled("{\"key\":\"block.slip\",\"slip\":\"$x\"}", name, "");
    let damped = answer(TEXT, chosen("damped"));
    assert!(damped.text.contains("slip = { damped = { damping = 0.03 } }"), "{}", damped.text);
    let timed = TEXT.replace("distance = 8.0", "distance = 8.0\nvelocity = 0.01");
    let inertial = answer(&timed, chosen("inertial"));
    // 0.3 · 10² and 0.3 · 10, ten being a tenth of the time in which the drive moves by the mean threshold.
    assert!(inertial.text.contains("inertial = { mass = 30.0, damping = 3.0 }"), "{}", inertial.text);
    assert_eq!(value(&inertial.view.unwrap(), "block.slip.inertial.mass"), "30");
    assert_eq!(answer(&damped.text, chosen("reset")).text, TEXT.replace("overdamped", "reset"));
    let unknown = Engine::default().answer(&request(TEXT, chosen("sticky")), &mut ());
    assert_eq!(unknown.failures, ["block.slip: expected a rule of slip, got sticky"]);
}

#[test]
fn the_map_of_a_mixture_has_the_critical_stiffness_of_each_width() {
    let mixture = |first: f64| {
        let parts = format!(
            "[{{ weight = 0.5, law.gaussian = {{ mean = 1.0, std = {first} }} }}, \
             {{ weight = 0.5, law.weibull = {{ shape = 5.0, scale = 2.0 }} }}]"
        );
        TEXT.replace("gaussian = { mean = 1.0, std = 0.2 }", &format!("mixture = {parts}"))
    };
    let text = mixture(0.2);
    let asked = Request { parts: vec![Part::CriticalStiffness], ..request(&text, vec![]) };
    let found = Engine::default().answer(&asked, &mut ());
    let (curve, panels) = (found.critical_stiffness.unwrap(), found.view.unwrap().panels);
    let map = panels.iter().find(|panel| panel.id == "map").unwrap();
    for i in [8, 14] {
        // Texts that are dragged have five digits.
        let changes = filled(&map.handles[0].change, &curve.width[i].to_string(), "0.3");
        let there = answer(&text, changes).force.unwrap();
        let (reported, exact) = (curve.critical_stiffness[i].0, there.critical_stiffness.0);
        // A slope follows from a force of error 1e-4 over lengths of σ.
        assert!((reported - exact).abs() < 1e-4 / curve.width[i] + 2e-3 * exact, "{reported} {exact}");
    }
    let exponential = text.replace("weibull = { shape = 5.0, scale = 2.0 }", "exponential = { mean = 1.0 }");
    assert!(!shown(&exponential).details.contains(&Part::CriticalStiffness));
}

#[test]
fn a_motion_is_not_computed_again_for_another_width() {
    let mut engine = Engine::default();
    let mut asked = Request { parts: vec![Part::Block], ..request(TEXT, vec![]) };
    let first = engine.answer(&asked, &mut ());
    asked.view = Some(View { width: 300.0, whole: 600.0, readings: false });
    let mut asked_for = 0;
    let second = engine.answer(&asked, &mut Counted(&mut asked_for));
    let size = |answer: &Answer| answer.view.as_ref().unwrap().panels[0].size[0];
    assert_eq!((size(&first), size(&second)), (400.0, 300.0));
    assert_eq!(first.block.unwrap().record, second.block.unwrap().record);
    assert_eq!(asked_for, 0);
}

/// Counts how often work reports its progress.
struct Counted<'a>(&'a mut usize);

impl Monitor for Counted<'_> {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        *self.0 += 1;
        ControlFlow::Continue(())
    }
}
