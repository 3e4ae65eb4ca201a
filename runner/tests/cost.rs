//! The cost of every shipped scenario and of some calls, in steps and cells, is what it was: step-size controls and solvers that
//! degrade are seen, though results stay right. Counts depend on no clock and on no number of threads.
//!
//! `cost.txt` has the counts. `ASPERITY_UPDATE=1 cargo test --release -p asperity-runner --test cost` writes it anew.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use asperity::contacts::{Ageing, Contacts, Initial, Temperature};
use asperity::history::{History, Piece};
use asperity::law::{Gaussian, Point};
use asperity::master::{MasterEquation, Transport};
use asperity::monitor::{Cost, Monitor};
use asperity::scenario::Scenario;
use asperity_runner::input;
use asperity_runner::sweep::Plan;

/// A control that is changed on purpose gains or loses more; last digits of transcendental functions, which differ between
/// processors, decide on single steps only.
const MORE: f64 = 1.02;
/// Below this part of the old count the file is out of date, and would hide a loss of as much.
const LESS: f64 = 0.9;

/// The number of pieces of each kind of work.
#[derive(Debug, Default, Clone, PartialEq)]
struct Counted(BTreeMap<String, usize>);

impl Monitor for Counted {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn cost(&mut self, cost: Cost, pieces: usize) {
        if pieces > 0 {
            *self.0.entry(format!("{cost:?}")).or_default() += pieces;
        }
    }
}

/// The same of progress that never falls, which is what a monitor is promised.
struct NeverFalling<'a> {
    name: &'a str,
    done: f64,
    counted: &'a mut Counted,
}

impl Monitor for NeverFalling<'_> {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        assert!((self.done..=1.0).contains(&fraction), "{}: {fraction} after {}", self.name, self.done);
        self.done = fraction;
        self.counted.progress(fraction)
    }

    fn cost(&mut self, cost: Cost, pieces: usize) {
        self.counted.cost(cost, pieces);
    }
}

/// What a computation costs on some threads.
fn counted(threads: usize, compute: impl FnOnce(&mut Counted) + Send) -> Counted {
    let mut counted = Counted::default();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| compute(&mut counted));
    counted
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios")
}

/// Smaller ones of those that take long: they have the same kinds of steps.
const SMALLER: [(&str, &[&str]); 8] = [
    ("creep", &["creep.forces=[0.7]"]),
    ("front-ageing", &["drive.distance=1.0", "drive.points=3"]),
    ("half-space-512", &["interface.cells=[32,32]", "drive.maps=[]"]),
    ("hold-chain", &["interface.cells=[3]"]),
    ("renormalised-cells", &["renormalisation.runs=2", "interface.cells=[8,8]"]),
    ("stability", &["stability.velocities=[1e-2]", "stability.stiffnesses=[0.1]"]),
    ("velocity-curve-ageing", &["velocity_curve.points=2"]),
    ("velocity-curve-thermal", &["velocity_curve.points=2"]),
];

/// The scenario of a file, of a sweep its last case; without the ensemble beside the master equation, which makes no steps.
fn scenario(path: &Path) -> Scenario {
    let name = path.file_stem().unwrap().to_str().unwrap();
    let smaller = SMALLER.iter().find(|(of, _)| *of == name).map_or(&[][..], |(_, overrides)| *overrides);
    let overrides: Vec<String> = smaller.iter().map(|&text| text.to_owned()).collect();
    let read = input::read(path, &overrides).unwrap();
    let mut scenario = read.scenario.clone();
    if scenario.sweep.is_some() {
        let plan = Plan::unchecked(&read).unwrap();
        scenario = plan.case(plan.count() - 1).unwrap();
    }
    let alone = Scenario { ensemble: None, ..scenario.clone() };
    if alone.build().is_ok() { alone } else { scenario }
}

/// Costs by the name of what is computed and the kind of work.
type Costs = BTreeMap<String, usize>;

fn of_scenarios() -> Costs {
    let mut costs = Costs::new();
    let mut paths: Vec<_> = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == "toml"));
    for path in paths {
        let (scenario, name) = (scenario(&path), path.file_stem().unwrap().to_str().unwrap().to_owned());
        let cost = counted(2, |counted| {
            let mut monitor = NeverFalling { name: &name, done: 0.0, counted };
            drop(asperity_runner::run(&scenario, &mut monitor).unwrap());
        });
        costs.extend(cost.0.into_iter().map(|(kind, count)| (format!("{name}: {kind}"), count)));
    }
    costs
}

fn contacts(width: f64) -> Contacts {
    Contacts::new(Arc::new(Gaussian::new(1.0, width).unwrap()), Arc::new(Point::new(0.0).unwrap()))
}

/// The force on a pull.
fn pull(width: f64, distance: f64, tolerance: f64) -> Counted {
    counted(2, |monitor| {
        let equation = MasterEquation::new_with(contacts(width), &Initial::default(), monitor).unwrap();
        equation.pull_with(distance, tolerance, monitor).unwrap();
    })
}

/// Warm contacts that age, in steady sliding: the life at a velocity.
fn steady(threads: usize) -> Counted {
    counted(threads, |monitor| {
        let mut contacts = contacts(0.1);
        contacts.rules.temperature = Some(Temperature::new(0.02, 1.0));
        contacts.rules.ageing = Some(Ageing::Logarithmic { growth: 0.02, time: 1.0 });
        MasterEquation::at_with(contacts, &Initial::default(), 0.01, monitor).unwrap();
    })
}

/// The same from first loading through a hold, by transport.
fn slide_and_hold(threads: usize) -> Counted {
    counted(threads, |monitor| {
        let mut contacts = contacts(0.1);
        contacts.rules.temperature = Some(Temperature::new(0.02, 1.0));
        let piece = |velocity, duration| Piece { velocity, duration };
        let history = History::new(vec![piece(0.1, 20.0), piece(0.0, 100.0), piece(0.1, 10.0)]).unwrap();
        let mut transport = Transport::new(contacts, &Initial::default()).unwrap();
        transport.follow_with(&history, &[130.0], &mut *monitor).unwrap();
    })
}

fn of_calls() -> Costs {
    let calls = [
        ("pull(20), width 0.05", pull(0.05, 20.0, 1e-10)),
        ("pull(20), width 0.05, tolerance 1e-6", pull(0.05, 20.0, 1e-6)),
        ("pull(200), width 0.3", pull(0.3, 200.0, 1e-10)),
        ("steady sliding, warm and ageing", steady(2)),
        ("slide and hold, warm", slide_and_hold(2)),
    ];
    let named = |name: &str, cost: Counted| -> Costs {
        cost.0.into_iter().map(|(kind, count)| (format!("{name}: {kind}"), count)).collect()
    };
    calls.into_iter().flat_map(|(name, cost)| named(name, cost)).collect()
}

/// The counts as text, one a line.
fn text(costs: &Costs) -> String {
    costs.iter().fold(String::new(), |mut text, (name, count)| {
        writeln!(text, "{name} = {count}").unwrap();
        text
    })
}

fn read(text: &str) -> Costs {
    let entry = |line: &str| {
        let (name, count) = line.rsplit_once(" = ").unwrap();
        (name.to_owned(), count.parse().unwrap())
    };
    text.lines().map(entry).collect()
}

/// What differs from the counts that are kept by more than it may.
fn changes(kept: &Costs, now: &Costs) -> Vec<String> {
    let names: std::collections::BTreeSet<_> = kept.keys().chain(now.keys()).collect();
    let change = |name: &&String| {
        let [before, after] = [kept, now].map(|costs| costs.get(*name).copied().unwrap_or(0));
        let part = after as f64 / before as f64;
        let why = match () {
            () if part > MORE => "more than before",
            () if part < LESS => "so much less than before that the file is out of date",
            () => return None,
        };
        Some(format!("{name}: {after} after {before}, {why}"))
    };
    names.iter().filter_map(change).collect()
}

#[test]
fn computations_cost_what_they_did() {
    let mut now = of_scenarios();
    now.extend(of_calls());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cost.txt");
    if std::env::var_os("ASPERITY_UPDATE").is_some() {
        std::fs::write(&path, text(&now)).unwrap();
    }
    let changes = changes(&read(&std::fs::read_to_string(&path).unwrap()), &now);
    assert!(changes.is_empty(), "ASPERITY_UPDATE=1 keeps what is meant:\n{}", changes.join("\n"));
}

#[test]
fn costs_do_not_depend_on_the_number_of_threads() {
    assert_eq!(steady(1), steady(2));
    assert_eq!(slide_and_hold(1), slide_and_hold(2));
    let scenario = scenario(&folder().join("stick-slip-ageing.toml"));
    let run = |threads| counted(threads, |monitor| drop(asperity_runner::run(&scenario, monitor).unwrap()));
    assert_eq!(run(1), run(2));
}

#[test]
fn a_control_that_degrades_is_seen() {
    let kept = read("a: Steps = 100\nb: Steps = 100\nc: RejectedSteps = 0\n");
    let with = |name: &str, count| {
        let mut now = kept.clone();
        now.insert(name.to_owned(), count);
        changes(&kept, &now)
    };
    assert!(with("a: Steps", 102).is_empty());
    assert_eq!(with("a: Steps", 103), ["a: Steps: 103 after 100, more than before"]);
    assert_eq!(with("b: Steps", 89).len(), 1);
    assert_eq!(with("c: RejectedSteps", 1).len(), 1);
    assert_eq!(with("d: Steps", 1).len(), 1);
}
