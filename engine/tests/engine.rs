//! The answers of the engine against the solvers that it calls, and what it says of invalid requests.

use std::ops::ControlFlow;
use std::sync::Arc;

use asperity::contacts::{Contacts, Initial};
use asperity::law::{Gaussian, Point};
use asperity::master::MasterEquation;
use asperity::monitor::Monitor;
use asperity_engine::answer::Answer;
use asperity_engine::request::{Change, Part, Request};
use asperity_engine::{Engine, Limits};

const TEXT: &str = "\
[contacts]
thresholds.gaussian = { mean = 1.0, std = 0.2 } # narrow

[initial]
gaussian = { mean = 0.1, std = 0.025 }

[block]
stiffness = 0.3
slip = \"overdamped\"

[drive]
distance = 8.0
";

fn request(parts: &[Part]) -> Request {
    Request { text: TEXT.into(), parts: parts.into(), position: 1.25, ..Request::default() }
}

fn answer(request: &Request) -> Answer {
    let answer = Engine::default().answer(request, &mut ());
    assert!(answer.invalid.is_none() && answer.failures.is_empty(), "{answer:?}");
    answer
}

fn equation(std: f64) -> MasterEquation {
    let contacts =
        Contacts::new(Arc::new(Gaussian::new(1.0, std).unwrap()), Arc::new(Point::new(0.0).unwrap()));
    MasterEquation::new(contacts, &Initial::new(Arc::new(Gaussian::new(0.1, 0.025).unwrap()))).unwrap()
}

#[test]
fn the_force_is_that_of_the_master_equation() {
    let found = answer(&request(&[Part::Force])).force.unwrap();
    let pull = equation(0.2).pull(8.0).unwrap();
    assert_eq!((found.position[0], *found.position.last().unwrap()), (0.0, 8.0));
    for (&x, &force) in found.position.iter().zip(&found.force) {
        assert_eq!(force, pull.force(x));
    }
    let peak = pull.static_friction().unwrap();
    let reported = found.static_friction.unwrap();
    assert_eq!((reported.position, reported.value), (peak.position, peak.value));
    assert_eq!(found.critical_stiffness.0, pull.critical_stiffness());
    assert_eq!(found.kinetic_friction, equation(0.2).steady_state().kinetic_friction());
}

#[test]
fn a_preview_is_as_accurate_as_a_line_is_wide() {
    let exact = answer(&request(&[Part::Force])).force.unwrap();
    let preview = answer(&Request { preview: true, ..request(&[Part::Force]) }).force.unwrap();
    assert!(preview.accuracy > exact.accuracy);
    for (a, b) in preview.force.iter().zip(&exact.force) {
        // The tolerance of a preview, per N⟨k⟩ and mean life, both about 1.
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
}

#[test]
fn solutions_are_kept_and_give_what_new_ones_give() {
    let mut engine = Engine::default();
    let parts = [Part::Force, Part::Stretches, Part::CriticalStiffness];
    let all: Vec<_> = parts.iter().map(|&part| engine.answer(&request(&[part]), &mut ())).collect();
    // One change in between, and back.
    let value = Some("0.4".into());
    let change = Change { key: "contacts.thresholds.gaussian.std".into(), value, ..Change::default() };
    let changed = engine.answer(&Request { changes: vec![change], ..request(&[Part::Force]) }, &mut ());
    assert!(changed.text.contains("std = 0.4 } # narrow"), "{}", changed.text);
    assert_ne!(changed.force.unwrap().force, all[0].force.as_ref().unwrap().force);
    let again = engine.answer(&request(&parts), &mut ());
    assert_eq!(again.force.unwrap().force, all[0].force.as_ref().unwrap().force);
    let [kept, new] = [&again.stretches, &all[1].stretches].map(|found| found.as_ref().unwrap());
    assert_eq!((&kept.density.values, kept.position), (&new.density.values, 1.25));
    assert_eq!(
        again.critical_stiffness.unwrap().kinetic_friction,
        all[2].critical_stiffness.as_ref().unwrap().kinetic_friction
    );
}

#[test]
fn stretches_are_densities() {
    let found = answer(&request(&[Part::Stretches])).stretches.unwrap();
    let of_laws = [&found.thresholds, &found.reforming, &found.initial].map(|law| (law, &found.law_stretch));
    let of_contacts = [&found.density, &found.steady].map(|density| (density, &found.stretch));
    for (density, stretch) in of_laws.into_iter().chain(of_contacts) {
        let panels = stretch.windows(2).zip(density.values.windows(2));
        let area: f64 = panels.map(|(x, q)| 0.5 * (x[1] - x[0]) * (q[0] + q[1])).sum();
        let total = area + density.weights.iter().sum::<f64>();
        // The trapezoidal rule over steps of 1/400 of the range; what is beyond it is 1e-6.
        assert!((total - 1.0).abs() < 1e-4, "{total}");
    }
    assert_eq!((found.reforming.at[0], found.reforming.weights[0]), (0.0, 1.0));
}

#[test]
fn thresholds_that_warm_contacts_do_not_reach_are_shown() {
    let warm = "[contacts]\nthresholds.gaussian = { mean = 1.0, std = 0.15 }\n\
                temperature = { energy = 50.0, attempt_rate = 1.0, barrier = \"elastic\" }\n[pull]\nvelocity = 3e-3\ndistance = 1.0\n";
    let found = answer(&Request { text: warm.into(), ..request(&[Part::Stretches]) }).stretches.unwrap();
    let last = |stretches: &[f64]| stretches[stretches.len() - 1];
    assert!(last(&found.stretch) < 0.5, "{}", last(&found.stretch));
    // One contact in a million is 4.8 standard deviations above the mean.
    assert!((last(&found.law_stretch) - 1.05 * (1.0 + 4.75 * 0.15)).abs() < 0.01);
}

#[test]
fn the_critical_stiffness_is_that_of_each_width() {
    let found = answer(&request(&[Part::CriticalStiffness])).critical_stiffness.unwrap();
    for i in [4, 12, 20, 28] {
        let pull = equation(found.width[i]).pull(4.0).unwrap();
        let (reported, exact) = (found.critical_stiffness[i].0, pull.critical_stiffness());
        // A slope follows from a force of error 1e-4 over lengths of σ; K_c from 9 to 0.05.
        assert!((reported - exact).abs() < 1e-4 / found.width[i] + 1e-3 * exact, "{reported} {exact}");
    }
}

/// Contacts that re-form at stretches of up to several standard deviations: narrow thresholds are all below some of them.
#[test]
fn widths_that_are_not_possible_are_left_out() {
    let text = format!("{TEXT}\n[contacts.reforming]\nexponential = {{ mean = 0.08 }}\n");
    let asked = |text: String| Request { text, ..request(&[Part::CriticalStiffness]) };
    let found = answer(&asked(text)).critical_stiffness.unwrap();
    assert!((5..32).contains(&found.width.len()), "{:?}", found.width);
    assert_eq!(found.critical_stiffness.len(), found.width.len());
    let whole = answer(&request(&[Part::CriticalStiffness])).critical_stiffness.unwrap();
    assert!(found.width.iter().all(|width| whole.width.contains(width)));
}

#[test]
fn the_block_moves_as_its_task_says() {
    let found = answer(&request(&[Part::Block, Part::Task]));
    let (block, task) = (found.block.unwrap(), found.task.unwrap());
    let slips = task.summary.numbers.sliding().unwrap().slips;
    assert!(slips > 0);
    assert_eq!(block.summary.numbers.sliding().unwrap().slips, slips);
    let without = TEXT.replace("[block]\nstiffness = 0.3\nslip = \"overdamped\"\n", "");
    assert!(answer(&Request { text: without, ..request(&[Part::Block]) }).block.is_none());
}

#[test]
fn an_invalid_scenario_is_located() {
    let wrong = TEXT.replace("std = 0.2", "std = -0.2");
    let answer =
        Engine::default().answer(&Request { text: wrong.clone(), ..request(&[Part::Force]) }, &mut ());
    let invalid = answer.invalid.unwrap();
    assert_eq!((invalid.line, invalid.key.as_str()), (Some(2), "contacts.thresholds.gaussian.std"));
    assert!(invalid.message.contains("-0.2"), "{}", invalid.message);
    assert!(answer.force.is_none() && answer.text == wrong);
}

#[test]
fn errors_of_a_part_leave_the_others() {
    let text = TEXT.replace("gaussian = { mean = 1.0, std = 0.2 } # narrow", "point = { at = 1.0 }");
    let parts = [Part::CriticalStiffness, Part::Force];
    let answer = Engine::default().answer(&Request { text, ..request(&parts) }, &mut ());
    assert!(answer.critical_stiffness.is_none() && answer.force.is_some());
    assert!(
        answer.failures[0].starts_with("the critical stiffness: contacts.thresholds: expected"),
        "{:?}",
        answer.failures
    );
}

#[test]
fn requests_that_are_none_are_refused() {
    for request in
        [&b"{"[..], b"[]", b"{\"text\": 3}", b"{\"text\": \"\", \"parts\": [\"forces\"]}", &[0xff, 0xfe]]
    {
        let answer = String::from_utf8(Engine::default().answer_json(request, &mut ())).unwrap();
        assert!(answer.contains("the request is invalid"), "{answer}");
    }
}

#[test]
fn contacts_in_time_are_pulled_at_a_velocity_of_their_task() {
    let aged = "[contacts]\nthresholds.gaussian = { mean = 1.0, std = 0.2 }\nageing.logarithmic = { growth = 0.02, time = 1.0 }\n";
    let force = |task: &str| {
        let text = format!("{aged}{task}");
        answer(&Request { text, ..request(&[Part::Force]) }).force.unwrap().kinetic_friction
    };
    let expected = force("[pull]\nvelocity = 0.1\ndistance = 5.0\n");
    for task in [
        "[drive]\nvelocity = 0.1\n[block]\nstiffness = 0.5\nslip.damped = { damping = 0.1 }\n",
        "[[protocol]]\nvelocity = 0.1\ndistance = 5.0\n[[protocol]]\nhold = 3.0\n",
        "[[protocol]]\nhold = 3.0\n[[protocol]]\nvelocity = 0.1\ndistance = 5.0\n",
        "[[protocol]]\nvelocity = 0.0\nduration = 3.0\n[[protocol]]\nvelocity = 0.1\ndistance = 5.0\n",
        "[velocity_curve]\nfrom = 0.01\nto = 1.0\n",
        "[hold_curve]\nfrom = 1.0\nto = 10.0\nvelocity = 0.1\n",
    ] {
        // The middle of a curve is 0.1 but for rounding.
        assert!((force(task) - expected).abs() < 1e-12, "{task}");
    }
}

/// A pull that a scenario does not have is no mistake in it.
#[test]
fn scenarios_without_a_pull_have_no_failures() {
    let contacts = "[contacts]\nthresholds.gaussian = { mean = 0.6, std = 0.15 }\n";
    let closure = "ageing.mean_field = { mature.gaussian = { mean = 1.0, std = 0.2 }, diffusion = 0.04 }\n";
    let aged = "ageing.logarithmic = { growth = 0.02, time = 1.0 }\n";
    for task in [
        format!("{closure}[velocity_curve]\nfrom = 0.01\nto = 1.0\n"),
        format!("{closure}[[protocol]]\nvelocity = 0.1\ndistance = 1.0\n"),
        format!("{aged}[[protocol]]\nhold = 3.0\n"),
    ] {
        let text = format!("{contacts}{task}");
        let found = answer(&Request { text, ..request(&[Part::Force, Part::Stretches]) });
        assert!(found.force.is_none() && found.stretches.is_none(), "{task}");
    }
}

#[test]
fn a_monitor_stops_the_work_and_nothing_wrong_is_kept() {
    struct Stop;
    impl Monitor for Stop {
        fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }
    let mut engine = Engine::default();
    let stopped = engine.answer(&request(&[Part::Force, Part::Block]), &mut Stop);
    assert!(stopped.stopped && stopped.force.is_none() && stopped.failures.is_empty(), "{stopped:?}");
    let after = engine.answer(&request(&[Part::Force]), &mut ());
    assert_eq!(after.force.unwrap().force, answer(&request(&[Part::Force])).force.unwrap().force);
}

#[test]
fn keys_that_name_files_and_numbers_beyond_limits_are_refused() {
    let text = TEXT.replace("gaussian = { mean = 1.0, std = 0.2 }", "tabulated = { file = \"law.csv\" }");
    let request = Request { text, ..request(&[Part::Force]) };
    let invalid = Engine::default().answer(&request, &mut ()).invalid.unwrap();
    assert_eq!(
        invalid.message,
        "contacts.thresholds.tabulated.file: expected the values themselves, since no files are read here, got \"law.csv\""
    );
    let limits = Limits { points: 1000, contacts: 1, cells: 1 };
    let asked = Request { text: format!("{TEXT}points = 1001\n"), ..request };
    let invalid = Engine::limited(limits).answer(&asked, &mut ()).invalid.unwrap();
    assert_eq!(invalid.message, "drive.points: expected at most 1000 points in the explorer, got 1001");
    assert_eq!(invalid.line, Some(13));
}
