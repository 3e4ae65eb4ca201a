//! The cases of sweeps: their order, their values and their bounds.
#![allow(missing_docs)]

use std::ops::ControlFlow;
use std::path::Path;

use asperity::monitor::Monitor;
use asperity_runner::input::{self, Input};
use asperity_runner::sweep::{Dataset, Gathered, Plan, Values};

const HEAD: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
pull = { distance = 3.0, points = 31 }
ensemble = { size = 10, seed = 7 }
";

fn read(sweep: &str) -> Input {
    input::parse(&format!("{HEAD}{sweep}"), "text", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"))
}

fn refused(sweep: &str) -> String {
    match input::parse(&format!("{HEAD}{sweep}"), "text", Path::new(""), &[]) {
        Err(error) => error.to_string(),
        Ok(input) => Plan::new(&input).unwrap_err().to_string(),
    }
}

/// A case that needs more memory than each thread may take is computed alone.
#[test]
fn results_do_not_depend_on_how_threads_share_the_memory() {
    /// Enough for one of the lattices, of 28.8 MB, not for two.
    struct Memory;
    impl Monitor for Memory {
        fn progress(&mut self, _: f64) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }
        fn memory(&self) -> u64 {
            40_000_000
        }
    }

    let text = r#"
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
interface = { cells = [400, 1000], contacts = "one", coupling.neighbours = { stiffness = 0.2 }, connection = 0.2 }
drive = { distance = 0.1, points = 2 }
sweep = { keep = ["catalogue.events"], over = { "interface.connection" = [0.1, 0.2, 0.3] } }
"#;
    let input = input::parse(text, "text", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&input).unwrap();
    let cases = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| asperity_runner::sweep::compute(&plan, &[0, 1, 2], &mut Memory)).unwrap()
    });
    assert_eq!(cases[0], cases[1]);
    assert!(cases[0].iter().all(|case| case.kept.is_ok()), "{:?}", cases[0]);
}

/// A case that meets a limit that no memory raises has failed, on any number of threads.
#[test]
fn a_case_beyond_a_fixed_limit_has_failed() {
    let text = r#"
contacts.thresholds.mixture = [
    { weight = 0.5, law.point.at = 1.0 },
    { weight = 0.3, law.point.at = 1.41421356 },
    { weight = 0.2, law.point.at = 1.7320508 },
]
pull = { distance = 2.0, points = 2 }
sweep = { keep = ["kinetic_friction"], over = { "pull.distance" = [2.0, 3.0, 400.0] } }
"#;
    let input = input::parse(text, "text", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&input).unwrap();
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let cases = pool.install(|| asperity_runner::sweep::compute(&plan, &[0, 1, 2], &mut ())).unwrap();
        assert_eq!(cases.iter().map(|case| case.number).collect::<Vec<_>>(), [0, 1, 2]);
        assert_eq!(cases.iter().map(|case| case.kept.is_ok()).collect::<Vec<_>>(), [true, true, false]);
        assert!(cases[2].kept.as_ref().is_err_and(|why| why.contains("jumps and kinks")), "{:?}", cases[2]);
    }
}

/// Replicas of renormalisation, each of several runs with seeds of their own, share none of them.
#[test]
fn replicas_of_several_runs_share_no_seed() {
    let text = r#"
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
interface = { cells = [8, 8], contacts = "one", coupling.neighbours = { stiffness = 0.2 }, connection = 0.2 }
renormalisation.runs = 3
ensemble.seed = 5
sweep = { keep = ["renormalisation.mean"], repeat = 3, over = { "interface.connection" = [0.2] } }
"#;
    let input = input::parse(text, "text", Path::new(""), &[]).unwrap_or_else(|e| panic!("{e}"));
    let plan = Plan::new(&input).unwrap();
    let seeds = [0, 1, 2].map(|case| plan.case(case).unwrap().ensemble.unwrap().seed);
    assert_eq!(seeds, [5, 8, 11]);
}

const FULL: &str = r#"
[sweep]
keep = ["kinetic_friction"]
repeat = 2
zip = [["contacts.count", "contacts.stiffness"]]
[sweep.over]
"contacts.count" = [1, 10]
"pull.distance" = { from = 4.0, to = 1.0, points = 4 }
"contacts.stiffness" = [1.0, 0.5]
"contacts.thresholds" = [{ gaussian = { mean = 1.0, std = 0.2 } }, { gamma = { mean = 2.0, std = 0.2 } }]
"#;

#[test]
fn cases_run_along_the_axes_in_their_order_the_last_one_fastest() {
    let plan = Plan::new(&read(FULL)).unwrap();
    assert_eq!(plan.count(), 2 * 4 * 2 * 2);
    for number in 0..plan.count() {
        let place = plan.place(number);
        let case = plan.case(number).unwrap();
        assert_eq!(case.contacts.count, [1.0, 10.0][place[0]]);
        assert_eq!(case.contacts.stiffness, Some([1.0, 0.5][place[0]]));
        assert_eq!(case.pull.unwrap().distance, [4.0, 3.0, 2.0, 1.0][place[1]]);
        assert_eq!(case.contacts.thresholds.unwrap().name(), ["gaussian", "gamma"][place[2]]);
        assert_eq!(case.ensemble.unwrap().seed, 7 + place[3] as u64);
        assert!(case.sweep.is_none());
        assert_eq!(number, ((place[0] * 4 + place[1]) * 2 + place[2]) * 2 + place[3]);
    }
}

#[test]
fn axes_are_labelled_coordinates() {
    let plan = Plan::new(&read(FULL)).unwrap();
    let data = Dataset::of_plan(&plan, Gathered::new(plan.count(), &plan.places()));
    let names: Vec<_> =
        data.axes.iter().flat_map(|axis| &axis.coordinates).map(|c| c.name.as_str()).collect();
    let expected = ["contacts_count", "contacts_stiffness", "pull_distance", "contacts_thresholds", "repeat"];
    assert_eq!(names, expected);
    let Values::Texts(laws) = &data.axes[2].coordinates[0].values else { panic!("words") };
    assert_eq!(laws[1], "{ gamma = { mean = 2.0, std = 0.2 } }");
}

/// The resolved scenario is the same sweep: `scenario.toml` computes the same again.
#[test]
fn the_resolved_text_is_the_same_sweep() {
    let first = read(FULL);
    let text = input::to_text(&first.scenario);
    let again = input::parse(&text, "resolved", Path::new("/nowhere"), &[]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.scenario, first.scenario);
    assert_eq!(Plan::new(&again).unwrap().identity(), Plan::new(&first).unwrap().identity());
}

#[test]
fn all_that_determines_the_results_is_in_the_hash() {
    let hash = |text: &str| Plan::new(&read(text)).unwrap().identity().hash;
    let own = hash(FULL);
    for (part, other) in [
        ("points = 4", "points = 5"),
        ("[1.0, 0.5]", "[1.0, 0.25]"),
        ("repeat = 2", "repeat = 3"),
        ("[\"kinetic_friction\"]", "[\"kinetic_friction\", \"contacts\"]"),
        ("std = 0.2 } }]", "std = 0.25 } }]"),
    ] {
        assert_ne!(hash(&FULL.replace(part, other)), own, "{other}");
    }
}

#[test]
fn what_is_wrong_is_named() {
    let over = |axes: &str| refused(&format!("[sweep]\nkeep = [\"kinetic_friction\"]\n[sweep.over]\n{axes}"));
    for (axes, expected) in [
        ("\"contacts.count\" = [1.0, inf]", "sweep.over.contacts.count.1: expected a finite number, got inf"),
        ("\"pull\" = [{ distance = 3.0 }]\n\"pull.points\" = [2, 3]", "got pull.points beside pull"),
        (
            "\"ensemble.seed\" = [1, 2]\n[sweep.over.\"contacts.count\"]\nfrom = 1\nto = 1\npoints = 3",
            "another number than from = 1",
        ),
        ("\"pull.points\" = [31, 1]", "pull.points: expected 2 points or more"),
        (
            "\"contacts.thresholds.gaussian.std\" = [0.1, \"wide\"]",
            "expected a number, got the text \"wide\"",
        ),
    ] {
        let error = over(axes);
        assert!(error.contains(expected), "{axes}: {error}");
    }
    let both =
        "[sweep]\nkeep = [\"kinetic_friction\"]\nrepeat = 2\n[sweep.over]\n\"ensemble.seed\" = [1, 2]\n";
    assert!(refused(both).contains("expected replicas or an axis, not both, got an axis with ensemble.seed"));
    let large = r#"[sweep]
keep = [{ variable = "force", at = { from = 0.0, to = 3.0, points = 1000000 } }]
over = { "contacts.count" = { from = 1.0, to = 2.0, points = 2000000 } }"#;
    let error = refused(large);
    assert!(
        error.contains("expected 1e12 values of all cases or fewer, got 2e12 values of 2e6 cases"),
        "{error}"
    );
}
