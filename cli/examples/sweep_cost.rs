//! What a sweep costs beside its cases: CPU time over a plain loop, files and bytes of stored cases, and a restart without work;
//! and what the command costs beside the task of a run.
//!
//! `cargo build --release && cargo run --release -p asperity-cli --example sweep_cost`

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use asperity::scenario::{Law, Scenario};
use asperity_runner::sweep::{Case, Dataset, Kept, Plan, Store, Value, run, write};
use asperity_runner::{input, memory};
use cpu_time::ProcessTime;

/// Cases of about 8 ms.
const MAP: &str = r#"
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
block = { stiffness = 1.0, slip = "arrest" }
drive.distance = 20.0
[sweep]
keep = ["regime", "slips", "period"]
[sweep.over]
"contacts.thresholds.gaussian.std" = { from = 0.05, to = 0.3, points = 20 }
"block.stiffness" = { from = 0.2, to = 5.0, points = 20, scale = "log" }
"#;

/// Number of cases of the store, and those that are stored at once: 0.2 s of 8 ms each.
const MANY: usize = 100_000;
const AT_ONCE: usize = 25;

struct Free;

impl asperity::monitor::Monitor for Free {
    fn progress(&mut self, _fraction: f64) -> std::ops::ControlFlow<()> {
        std::ops::ControlFlow::Continue(())
    }

    fn memory(&self) -> u64 {
        memory::available()
    }
}

fn plan(text: &str) -> Plan {
    let input = input::parse(text, "map", Path::new(""), &[]).expect("a valid scenario");
    Plan::new(&input).expect("valid corners")
}

/// CPU time of a plain loop over the cases, in seconds, each made as a program would make it.
fn plain(plan: &Plan) -> f64 {
    let axes: Vec<Vec<f64>> = plan
        .dimensions
        .iter()
        .map(|dimension| dimension.keys[0].1.iter().filter_map(|value| value.number()).collect())
        .collect();
    let first = Scenario { sweep: None, ..plan.scenario.clone() };
    let begun = ProcessTime::now();
    for &std in &axes[0] {
        for &stiffness in &axes[1] {
            let mut scenario = first.clone();
            if let Some(Law::Gaussian { std: own, .. }) = &mut scenario.contacts.thresholds {
                *own = std;
            }
            scenario.block.as_mut().expect("a block").stiffness = stiffness;
            asperity_runner::run(&scenario, &mut Free).expect("a case that succeeds");
        }
    }
    begun.elapsed().as_secs_f64()
}

/// The argument with which this program computes one task.
const TASK: &str = "task";

fn main() {
    if std::env::args().nth(1).is_some_and(|argument| argument == TASK) {
        return task();
    }
    let folder = tempfile::tempdir().expect("a folder");
    // First: a disk that is busy with the files of the sweeps below makes it slower.
    command(folder.path());
    let map = plan(MAP);
    let cases: Vec<usize> = (0..map.count()).collect();
    for round in 0..3 {
        let alone = plain(&map);
        let mut store = Store::new(&folder.path().join(format!("map-{round}")), map.identity());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        let begun = ProcessTime::now();
        pool.install(|| run(&map, &cases, 0, &mut store, &mut Free)).expect("cases are stored");
        let swept = begun.elapsed().as_secs_f64();
        println!(
            "{} cases of {:.1} ms: CPU time {alone:.2} s in a loop, {swept:.2} s in a sweep, {:+.1} %",
            cases.len(),
            1e3 * alone / cases.len() as f64,
            100.0 * (swept / alone - 1.0)
        );
    }
    many(folder.path());
}

/// What `asperity run --no-figures` takes beside its task, from the start of the process to its end. The task is computed by a new
/// process, too. Least of many times, one of each after the other, so that other work of the machine counts little.
fn command(folder: &Path) {
    const TIMES: usize = 60;
    std::fs::write(folder.join("one.toml"), one()).expect("a file");
    let own = std::env::current_exe().expect("a path");
    let program = own.ancestors().nth(2).expect("the folder of programs").join("asperity");
    let mut least = [f64::INFINITY; 2];
    for number in 0..TIMES {
        let task = Command::new(&own).arg(TASK).output().expect("this program").stdout;
        let task: f64 = String::from_utf8_lossy(&task).trim().parse().expect("seconds");
        let results = format!("one-{number}");
        let begun = Instant::now();
        let mut run = Command::new(&program);
        run.args(["run", "one.toml", "--no-figures", "--quiet", "-o", &results]).current_dir(folder);
        assert!(run.status().expect("the command, built before").success());
        let whole = begun.elapsed().as_secs_f64();
        least = [least[0].min(task), least[1].min(whole)];
    }
    let [task, whole] = least;
    println!(
        "a task of {:.1} ms: {:.2} times that for asperity run --no-figures, {:.1} ms more",
        1e3 * task,
        whole / task,
        1e3 * (whole - task)
    );
}

/// One case of the map, over some of the distance.
fn one() -> String {
    MAP.split("[sweep]").next().expect("a beginning").replace("20.0", "25.0")
}

/// Prints the seconds of a task.
fn task() {
    let scenario = input::parse(&one(), "one", Path::new(""), &[]).expect("a valid scenario").scenario;
    let begun = Instant::now();
    asperity_runner::run(&scenario, &mut Free).expect("a task that succeeds");
    println!("{}", begun.elapsed().as_secs_f64());
}

/// The files of many cases, and what a restart takes when all are there.
fn many(folder: &Path) {
    let many =
        plan(&MAP.replace("points = 20", "points = 1000").replacen("points = 1000", "points = 100", 1));
    assert_eq!(many.count(), MANY);
    let directory = folder.join("many");
    let mut store = Store::new(&directory, many.identity());
    let case = |number: usize| {
        let entries = vec![
            ("regime".to_owned(), Value::Word("persistent".to_owned())),
            ("slips".to_owned(), Value::Number(number as f64)),
            ("period".to_owned(), Value::Number((number as f64).sqrt())),
        ];
        Case { number, kept: Ok(Kept { entries, curves: Vec::new() }) }
    };
    let begun = Instant::now();
    let (mut files, mut bytes) = (0, 0);
    for first in (0..MANY).step_by(AT_ONCE) {
        store.add(&(first..first + AT_ONCE).map(case).collect::<Vec<_>>()).expect("cases are stored");
        let now = size(store.folder());
        (files, bytes) = (files.max(now.0), bytes.max(now.1));
    }
    println!(
        "{MANY} cases, {AT_ONCE} at once: at most {files} files and {:.1} MB, stored in {:.1} s",
        bytes as f64 / 1e6,
        begun.elapsed().as_secs_f64()
    );
    for what in ["gathered for the first time", "a restart without work"] {
        let begun = Instant::now();
        let mut store = Store::new(&directory, many.identity());
        let there = store.there(true).expect("the store can be read");
        assert!(!there.contains(&false));
        store.finish().expect("the store can be written");
        let gathered = store.gathered(&many.places(), u64::MAX).expect("the store can be read");
        write(&directory, &Dataset::of_plan(&many, gathered), &[]).expect("results are written");
        let (files, bytes) = size(store.folder());
        println!(
            "{what}: {:.2} s; then {files} files, {:.1} MB",
            begun.elapsed().as_secs_f64(),
            bytes as f64 / 1e6
        );
    }
}

/// Number of files of a folder, and their bytes.
fn size(folder: &Path) -> (usize, u64) {
    let entries = std::fs::read_dir(folder).expect("a folder").flatten();
    entries.fold((0, 0), |(files, bytes), entry| {
        (files + 1, bytes + entry.metadata().map_or(0, |found| found.len()))
    })
}
