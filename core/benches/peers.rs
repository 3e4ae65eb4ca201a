//! One page: this crate next to what a user would write in Python, run in turns in the same call.
//!
//! The interpreter is `$PEERS_PYTHON`; `core/benches/peers/requirements.txt` says what it needs. With `$PEERS_LARGE` there
//! are rows more, which take half an hour. Times are CPU seconds but for the two threads, medians of turns;
//! the peers have been compiled and warmed up.
//!
//! The event-driven peers do less: one sequential generator for all contacts, the mean force alone. Ours are
//! streams that each contact has for itself (the same numbers on any number of threads) and standard errors.

#![allow(missing_docs)]

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::time::Instant;

use asperity::contacts::{Contacts, Initial, Start};
use asperity::elastic::cells::scales;
use asperity::elastic::coupling::half_space;
use asperity::elastic::{CellLoading, CellSlip, Curves, Interface, InterfaceParameters, State};
use asperity::ensemble::lattice::{Edges, Lattice, LatticeCoupling, Shape, Until};
use asperity::ensemble::{Disorder, Ensemble};
use asperity::law::{Gaussian, Point, Rectangular, SharedLaw};
use asperity::master::MasterEquation;
use cpu_time::{ProcessTime, ThreadTime};

const TURNS: usize = 9;

/// F(5) of Fig. 2.
const EXACT: f64 = 0.297307166;

const HEAD: &str = "\
<!-- Written by `make peers`: change core/benches/peers.rs instead. -->
# Comparison with Python code

Each row is the same computation by asperity (*ours*) and by a Python script (*theirs*), run alternately in one call of
`make peers`, on one thread except where stated. Times are medians of nine runs, or of one where stated, in CPU time on
the machine that made this page; the scripts are compiled and warmed up; the range is that of the quartiles of the ratio.
*Error* is that of their F(5); ours is accurate to 1e-10 for the master equation, and to the statistical error for the
ensemble. From break to break, theirs uses one sequential random generator on one thread and computes the mean force;
ours uses a random stream for each contact and also computes standard errors. Coupled contacts start from different
random stretches in the two programs; their mean forces at the end agree within 0.02, as do those of cells with
different random scale factors. The scripts are in `core/benches/peers`.

| computation | ours, ms | theirs | theirs, ms | error | ratio |
| --- | ---: | --- | ---: | ---: | ---: |";

fn main() {
    println!("{HEAD}");
    let memory = memory();
    against_python();
    let alone = alone();
    if std::env::var_os("PEERS_LARGE").is_some() {
        [1e-4, 1e-6].into_iter().for_each(|tolerance| next_event(1024, (2.3, 0.02), tolerance, 1));
    }
    println!("\n{alone}\n{memory}");
}

/// The laws of Fig. 2.
fn interface() -> (Contacts, Initial) {
    let gaussian = |mean, std| -> SharedLaw { Arc::new(Gaussian::new(mean, std).unwrap()) };
    let (thresholds, reforming) = (gaussian(1.0, 0.05), Arc::new(Point::new(0.0).unwrap()));
    let contacts = Contacts::new(thresholds, reforming);
    (contacts, Initial { law: gaussian(0.1, 0.025), start: Start::Conditional })
}

fn ensemble(size: usize) -> Ensemble {
    let (contacts, initial) = interface();
    Ensemble::new(contacts, initial, size, 1, Disorder::Annealed).unwrap()
}

/// i `step` for i = 0 … `last`/`step`.
fn grid(last: f64, step: f64) -> Vec<f64> {
    (0..=(last / step).round() as usize).map(|i| i as f64 * step).collect()
}

fn against_python() {
    let figure = |points: &[f64]| {
        let (contacts, initial) = interface();
        let pull = MasterEquation::new(contacts, &initial).unwrap().pull_with(20.0, 1e-10, &mut ()).unwrap();
        let force: Vec<f64> = points.iter().map(|&x| pull.force(x)).collect();
        force[points.len() / 4]
    };
    let fine = grid(20.0, 1e-3);
    let job = "Fig. 2 to X = 20, 20 001 points";
    row(job, "Eq. (2) in NumPy, ΔX = 1e-3", "shift_grid.py", || figure(&fine));
    row(job, "Eq. (2) in a numba loop, ΔX = 1e-3", "shift_loop.py", || figure(&fine));
    row(job, "py-pde, upwind on cells of 1e-3, numba", "upwind.py", || figure(&fine));
    let coarse = grid(20.0, 0.01);
    row("Fig. 2 to X = 20, 2001 points", "the Python package of asperity", "package.py", || figure(&coarse));
    row("10 000 contacts to X = 20, 20 001 points", "numba, stepped", "stepped.py", || {
        ensemble(10_000).pull(&fine).unwrap().force[5000]
    });
    let coarse = grid(100.0, 0.05);
    let events = |size| ensemble(size).pull(&coarse).unwrap().force[100];
    let (few, many) = (20_000, 1_000_000);
    let job = "20 000 contacts to X = 100, 2001 points";
    let [twister, generator] =
        ["np.random", "PCG64"].map(|draws| format!("numba, from break to break, {draws}"));
    row(job, &twister, &format!("event_driven.py twister {few}"), || events(few));
    row(job, &generator, &format!("event_driven.py pcg64 {few}"), || events(few));
    let job = "1 000 000 contacts to X = 100, 2001 points, ours on two threads, wall-clock time";
    let script = format!("event_driven.py pcg64 {many}");
    in_turns(job, &generator, &script, Some(EXACT), (2, TURNS), || events(many));
    for share in [0.2, 0.25] {
        let job = format!("128 × 128 identical contacts, coupled, α = {share}, to X = 2");
        let name = "numba, with a search of the lattice for every avalanche";
        against(&job, name, &format!("lattice.py {share}"), None, || coupled(share));
    }
    for side in [1024, 4096] {
        let job = format!("{side} × {side} cells under a periodic half-space, all forces once");
        let positions: Vec<f64> = (0..side * side).map(|j| (0.37 * j as f64).sin()).collect();
        let mut forces = vec![0.0; positions.len()];
        let mut slider = half_space(Shape::Square([side; 2]), Edges::Periodic, 1.0, 1.0).unwrap();
        against(&job, "NumPy, rfft2 and irfft2", &format!("convolution.py {side}"), None, || {
            slider.forces(&positions, &mut forces, &mut ()).unwrap();
            forces[0]
        });
    }
    next_event(128, (2.3, 0.02), 1e-6, TURNS);
}

/// A row of the next event of so many cells a side, from a drive on and by first steps of theirs, so many turns of it.
fn next_event(side: usize, (drive, step): (f64, f64), tolerance: f64, turns: usize) {
    let job = format!(
        "{side} × {side} cells under a periodic half-space, the next event, to {tolerance:e} of the drive{}",
        if turns == 1 { ", one turn" } else { "" }
    );
    let (mut cells, begun) = deformable(side, drive, tolerance);
    let (name, script) =
        ("NumPy, rfft2 and irfft2 in every step", format!("interface.py {side} {drive} {step} {tolerance}"));
    let next = || {
        cells.restore(begun.clone(), &mut ()).unwrap();
        cells.next(f64::INFINITY).unwrap();
        cells.force() / cells.len() as f64
    };
    in_turns(&job, name, &script, None, (1, turns), next);
}

/// Side × side cells with thresholds of 1 ± 0.1, stretched by 1 ± 0.05 from cell to cell, at a drive.
fn deformable(side: usize, drive: f64, drive_tolerance: f64) -> (Interface, State) {
    let relaxed: SharedLaw = Arc::new(Point::new(0.0).unwrap());
    let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1).unwrap()), relaxed.clone());
    let start = Initial { law: relaxed, start: Start::Conditional };
    let population = MasterEquation::new(contacts, &start).unwrap().population_with(1e-10, &mut ()).unwrap();
    let cells = Curves::new(&population, side * side).unwrap();
    let cells = cells.scaled(scales(side * side, 0.05, 1).unwrap()).unwrap();
    let setting = InterfaceParameters {
        connection: 0.5,
        loading: CellLoading::Uniform,
        slip: CellSlip::Overdamped,
        viscosity: None,
        drive_tolerance,
        area: None,
    };
    let slider = half_space(Shape::Square([side; 2]), Edges::Periodic, 3.0, 1.0).unwrap();
    let mut interface = Interface::new(Box::new(cells), slider, setting).unwrap();
    interface.run(drive, &mut |_, _| ()).unwrap();
    let state = interface.state();
    (interface, state)
}

/// The mean force at X = 2 of contacts that share what they let go, from random stretches.
fn coupled(share: f64) -> f64 {
    let point = |at| -> SharedLaw { Arc::new(Point::new(at).unwrap()) };
    let stretches = Rectangular::new(0.0, 0.9999).unwrap();
    let start = Initial { law: Arc::new(stretches), start: Start::Conditional };
    let coupling = LatticeCoupling::with_alpha(Shape::Square([128, 128]), Edges::Open, share);
    let contacts = Contacts::new(point(1.0), point(0.0));
    let mut lattice = Lattice::new(contacts, start, &coupling, 1, Disorder::Annealed).unwrap();
    lattice.run(Until::Drive(2.0), &mut |_| ()).unwrap();
    lattice.force()
}

/// One line of the table, of a job that has F(5).
fn row(job: &str, name: &str, script: &str, ours: impl Fn() -> f64 + Sync) {
    against(job, name, script, Some(EXACT), &ours);
}

/// One line of the table, ours on this thread alone, of a job that has a force, perhaps known exactly.
fn against(job: &str, name: &str, script: &str, exact: Option<f64>, ours: impl FnMut() -> f64 + Send) {
    in_turns(job, name, script, exact, (1, TURNS), ours);
}

/// The same on so many threads, in so many turns: in seconds of the wall where there are more threads than one, which
/// theirs take no less of than of their core.
fn in_turns(
    job: &str,
    name: &str,
    script: &str,
    exact: Option<f64>,
    (threads, turns): (usize, usize),
    mut ours: impl FnMut() -> f64 + Send,
) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut peer = Peer::start(script);
    let mut off = 0.0;
    let turn = |_| {
        let (ours, force) = pool.install(|| {
            let (begun, wall) = (ThreadTime::now(), Instant::now());
            let force = ours();
            let spent = if threads == 1 { begun.elapsed() } else { wall.elapsed() };
            (spent.as_secs_f64(), force)
        });
        let (theirs, their_force) = peer.run();
        // 1e4 contacts scatter by 3e-3, upwind differences are wrong by 0.017.
        assert!((force - their_force).abs() < 0.02, "{script}: F = {force} and {their_force}");
        off = exact.map_or(0.0, |exact| 100.0 * (their_force / exact - 1.0));
        [ours, theirs, theirs / ours]
    };
    let turns: Vec<[f64; 3]> = (0..turns).map(turn).collect();
    let [ours, theirs, ratio] = [0, 1, 2].map(|k| quartiles(turns.iter().map(|turn| turn[k])));
    let (ours, theirs) = (1e3 * ours[1], 1e3 * theirs[1]);
    let off = match exact {
        None => "–".into(),
        Some(_) if off.abs() < 1e-6 => "0".into(),
        Some(_) => format!("{off:.1} %"),
    };
    let [low, middle, high] = ratio;
    println!("| {job} | {ours:.3} | {name} | {theirs:.2} | {off} | {middle:.2} ({low:.2} to {high:.2}) |");
}

fn quartiles(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    [1, 2, 3].map(|k| values[k * (values.len() - 1) / 4])
}

/// A script that runs when it is asked to.
struct Peer {
    process: Child,
    to: Option<ChildStdin>,
    from: BufReader<ChildStdout>,
}

impl Peer {
    fn start(script: &str) -> Self {
        let python = std::env::var("PEERS_PYTHON").unwrap_or_else(|_| "python3".into());
        let (file, arguments) = script.split_once(' ').unwrap_or((script, ""));
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/peers/").to_owned() + file;
        let mut command = Command::new(python);
        // One core for each side: NumPy would else take more.
        command
            .env("OMP_NUM_THREADS", "1")
            .env("OPENBLAS_NUM_THREADS", "1")
            .arg(&path)
            .args(arguments.split(' '));
        let mut process = command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
        let (to, from) = (process.stdin.take(), BufReader::new(process.stdout.take().unwrap()));
        let mut peer = Self { process, to, from };
        assert_eq!(peer.line(), "ready\n", "{script} did not start");
        peer
    }

    fn line(&mut self) -> String {
        let mut line = String::new();
        self.from.read_line(&mut line).unwrap();
        line
    }

    /// CPU seconds and the force.
    fn run(&mut self) -> (f64, f64) {
        self.to.as_mut().unwrap().write_all(b"\n").unwrap();
        let line = self.line();
        let mut numbers = line.split_whitespace().map(|word| word.parse::<f64>().unwrap());
        (numbers.next().unwrap(), numbers.next().unwrap())
    }
}

impl Drop for Peer {
    fn drop(&mut self) {
        // The end of its input is the end of the script.
        self.to = None;
        let _ = self.process.wait();
    }
}

/// What there is no peer for: cost of a break, a second core, memory.
fn alone() -> String {
    let positions = grid(100.0, 0.05);
    let many = ensemble(20_000);
    let [one, two] = [1, 2].map(|n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap());
    // Wall and CPU seconds, breaks.
    let timed = |pool: &rayon::ThreadPool| {
        let (wall, cpu) = (Instant::now(), ProcessTime::now());
        let breaks = pool.install(|| many.pull(&positions).unwrap().breaks);
        (wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64(), breaks as f64)
    };
    let turns: Vec<_> = (0..4 * TURNS).map(|_| (timed(&one), timed(&two))).collect();
    let [cheap, cost, _] = quartiles(turns.iter().map(|(one, _)| 1e9 * one.1 / one.2));
    let [_, faster, best] = quartiles(turns.iter().map(|(one, two)| one.0 / two.0));
    let [_, more, _] = quartiles(turns.iter().map(|(one, two)| two.1 / one.1));
    format!(
        "* A break, Gaussian thresholds: {cost:.2} ns of CPU (lower quartile {cheap:.2}).
* Two threads: {faster:.2} times as fast as one (upper quartile {best:.2}), on cores that others use too.
* Two threads: {more:.2} times the CPU of one (1 is no overhead; free cores make it {:.2} times as fast).",
        2.0 / more
    )
}

/// What contacts take, before anything else has taken more.
fn memory() -> String {
    let peak = |last: f64| {
        let pull = ensemble(1_000).pull(&grid(last, last / 1000.0)).unwrap();
        (pull.breaks, peak_memory())
    };
    let ((few, before), (more, after)) = (peak(100.0), peak(10_000.0));
    format!("* Peak memory: {before} kB after {few} breaks, {after} kB after {more} more.")
}

/// Most memory this process has had, kB; 0 where the system does not report it.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|kb| kb.parse().ok()).unwrap_or(0)
}
