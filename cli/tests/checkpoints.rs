//! Runs that are killed, interrupted or found damaged, and go on from their checkpoints.
#![cfg(unix)]

mod support;

use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use support::{Folder, errors, names, scenarios};

/// A few seconds of avalanches, all of them recorded.
const SCENARIO: &str = "
title = 'Avalanches'
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.count = 1024
initial.rectangular = { min = 0.0, max = 0.5 }
interface = { cells = [32, 32], contacts = 'one', coupling.neighbours = { stiffness = 0.2 }, connection = 0.2 }
drive = { distance = 100.0, points = 11, maps = [40.0, 80.0] }
";

/// Some seconds of events of cells of many contacts.
const CELLS: &str = "
title = 'Precursors'
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
drive = { distance = 200.0, points = 11 }
[interface]
cells = [60]
coupling.neighbours = { stiffness = 2.0 }
connection = 0.5
loading = 'edge'
disorder = { std = 0.05, seed = 1 }
slip = 'overdamped'
";

/// A second or two of events of cells whose contacts age.
const IN_TIME: &str = "
title = 'Precursors that age'
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.ageing.logarithmic = { growth = 0.05, time = 1.0 }
drive = { distance = 60.0, points = 11, velocity = 1e-2 }
master_equation.tolerance = 1e-2
[interface]
cells = [6]
coupling.neighbours = { stiffness = 2.0 }
connection = 2.0
loading = 'edge'
slip = 'overdamped'
viscosity = 0.3
";

/// The same cells with unequal areas along a protocol with a hold, with their slip rates.
const HELD: &str = "
title = 'Precursors, and a hold'
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.ageing.logarithmic = { growth = 0.05, time = 1.0 }
protocol = [
    { velocity = 1e-2, distance = 20.0, points = 11 },
    { hold = 1e4, points = 3 },
    { velocity = 1e-2, distance = 40.0, points = 11 },
]
master_equation.tolerance = 1e-2
[interface]
cells = [6]
coupling.neighbours = { stiffness = 2.0 }
connection = 2.0
loading = 'edge'
slip = 'overdamped'
viscosity = 0.3
slip_rates = 100
areas = [1.0, 1.2, 0.8, 1.5, 1.0, 0.9]
";

/// Avalanches of contacts that break thermally, at a velocity.
const CONTACTS_IN_TIME: &str = "
title = 'Avalanches with temperature'
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.count = 4096
contacts.temperature = { energy = 0.005, attempt_rate = 1.0, barrier = 'bell' }
contacts.ageing.logarithmic = { growth = 0.01, time = 1.0 }
initial.rectangular = { min = 0.0, max = 0.5 }
interface = { cells = [64, 64], contacts = 'one', coupling.neighbours = { stiffness = 0.2 }, connection = 0.2 }
drive = { distance = 60.0, points = 11, maps = [20.0, 40.0], velocity = 1e-3 }
";

/// The same contacts along a protocol with a hold.
const CONTACTS_HELD: &str = "
title = 'Avalanches with temperature, and a hold'
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.count = 4096
contacts.temperature = { energy = 0.005, attempt_rate = 1.0, barrier = 'bell' }
initial.rectangular = { min = 0.0, max = 0.5 }
interface = { cells = [64, 64], contacts = 'one', coupling.neighbours = { stiffness = 0.2 }, connection = 0.2 }
protocol = [
    { velocity = 1e-3, distance = 20.0, points = 11 },
    { hold = 1e4, points = 3 },
    { velocity = 1e-2, distance = 160.0, points = 11 },
]
";

/// Cells of few contacts, many events.
const FEW: &str = "
[ensemble]
size = 30
";

/// Long enough for a checkpoint to be seen, and never to be waited for.
const PATIENCE: Duration = Duration::from_secs(60);

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("slow.toml", SCENARIO);
    folder
}

fn start(folder: &Folder, more: &[&str]) -> Child {
    let arguments = [&["run", "slow.toml", "--checkpoint", "2000"], more].concat();
    let mut command = folder.asperity(&arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn slots(folder: &Folder) -> [PathBuf; 2] {
    [0, 1].map(|slot| folder.path().join(format!("out/slow.checkpoint.{slot}")))
}

/// Events at a checkpoint, from its header.
fn events(path: &Path) -> Option<u64> {
    let bytes = std::fs::read(path).ok()?;
    let header = bytes.split(|&byte| byte == b'\n').nth(1)?;
    serde_json::from_slice::<serde_json::Value>(header).ok()?["events"].as_u64()
}

/// Waits until a checkpoint of so many times 2000 events is seen.
fn wait_for(folder: &Folder, number: u64) {
    wait_for_events(folder, 2000 * number);
}

fn wait_for_events(folder: &Folder, number: u64) {
    let begun = Instant::now();
    while slots(folder).iter().filter_map(|path| events(path)).max().unwrap_or(0) < number {
        assert!(begun.elapsed() < PATIENCE, "no checkpoint of {number} events");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Every file of a folder with its bytes.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    names(folder).into_iter().map(|name| (name.clone(), std::fs::read(folder.join(&name)).unwrap())).collect()
}

/// The results of the same scenario, not interrupted.
fn undisturbed() -> Vec<(String, Vec<u8>)> {
    let folder = folder();
    folder.succeed(&["run", "slow.toml", "--quiet"]);
    contents(&folder.path().join("out/slow"))
}

fn same(folder: &Folder, expected: &[(String, Vec<u8>)]) {
    let found = contents(&folder.path().join("out/slow"));
    assert_eq!(found.len(), expected.len());
    for ((name, bytes), (other, wanted)) in found.iter().zip(expected) {
        assert!(name == other && bytes == wanted, "{name} differs from {other}");
    }
    assert_eq!(names(&folder.path().join("out")), ["slow"], "checkpoints are left");
}

#[test]
fn a_run_killed_three_times_gives_the_same_bytes() {
    let expected = undisturbed();
    let folder = folder();
    for (number, more) in [(1, &[][..]), (3, &["--resume"]), (5, &["--resume"])] {
        let mut child = start(&folder, more);
        wait_for(&folder, number);
        child.kill().unwrap();
        assert!(!child.wait().unwrap().success(), "it was over before checkpoint {number}");
        assert!(!folder.path().join("out/slow").exists(), "results before the end");
    }
    let output = folder.run(&["run", "slow.toml", "--resume"]);
    assert!(output.status.success() && errors(&output).contains("continuing from"), "{}", errors(&output));
    same(&folder, &expected);
}

/// How far the curve is known that cells share decides on their steps, and goes on, too.
#[test]
fn cells_that_are_killed_and_interrupted_give_the_same_bytes() {
    same_bytes_after(CELLS, 5, &[(5, "-KILL"), (20, "-INT"), (30, "-KILL"), (45, "-INT")]);
}

#[test]
fn cells_in_time_that_are_killed_and_interrupted_give_the_same_bytes() {
    same_bytes_after(IN_TIME, 1, &[(1, "-KILL"), (3, "-KILL"), (4, "-INT"), (5, "-KILL")]);
    same_bytes_after(
        &[IN_TIME, FEW].concat(),
        5,
        &[(5, "-KILL"), (15, "-KILL"), (20, "-INT"), (25, "-KILL")],
    );
}

#[test]
fn cells_held_in_time_that_are_killed_and_interrupted_give_the_same_bytes() {
    same_bytes_after(HELD, 1, &[(1, "-KILL"), (3, "-KILL"), (4, "-INT"), (5, "-KILL")]);
}

#[test]
fn contacts_in_time_that_are_killed_and_interrupted_give_the_same_bytes() {
    for scenario in [CONTACTS_IN_TIME, CONTACTS_HELD] {
        same_bytes_after(
            scenario,
            1000,
            &[(1000, "-KILL"), (5000, "-INT"), (9000, "-KILL"), (12_000, "-INT")],
        );
    }
}

/// Ends a run with checkpoints every so many events by signals after numbers of them, and then lets it go on.
fn same_bytes_after(scenario: &str, every: u64, signals: &[(u64, &str)]) {
    let folder = Folder::new();
    folder.write("slow.toml", scenario);
    folder.succeed(&["run", "slow.toml", "--quiet", "-o", "whole"]);
    let expected = contents(&folder.path().join("whole"));
    for &(number, signal) in signals {
        let arguments = ["run", "slow.toml", "--checkpoint", &every.to_string(), "--resume"];
        let mut command = folder.asperity(&arguments);
        let mut child = command.stderr(Stdio::null()).spawn().unwrap();
        wait_for_events(&folder, number);
        std::process::Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
        assert!(!child.wait().unwrap().success(), "it was over before {number} events");
    }
    folder.succeed(&["run", "slow.toml", "--resume", "--quiet"]);
    same(&folder, &expected);
}

/// What was found is written once: a late checkpoint is no larger than an early one.
#[test]
fn checkpoints_do_not_grow_with_what_was_found() {
    let folder = folder();
    let mut child = start(&folder, &[]);
    let size = |number| {
        wait_for(&folder, number);
        let sizes = slots(&folder).map(|path| std::fs::metadata(path).map_or(0, |file| file.len()));
        sizes.into_iter().max().unwrap()
    };
    let (early, late) = (size(2), size(20));
    child.kill().unwrap();
    child.wait().unwrap();
    // The state of 1024 contacts, for which the text of the scenario is short: a tenth covers other digits.
    assert!(late as f64 <= 1.1 * early as f64, "{early} bytes after 4000 events, {late} after 40000");
    let found = std::fs::metadata(folder.path().join("out/slow.checkpoint.found")).unwrap().len();
    assert!(found > 40_000 * 8, "{found} bytes of 40000 events");
}

#[test]
fn checkpoints_come_by_time_too_and_a_limit_of_time_leaves_one() {
    let expected = undisturbed();
    let folder = folder();
    let mut command = folder.asperity(&["run", "slow.toml", "--checkpoint", "0.02s"]);
    let mut child = command.stderr(Stdio::null()).spawn().unwrap();
    wait_for_events(&folder, 1000);
    child.kill().unwrap();
    child.wait().unwrap();
    let output = folder.run(&["run", "slow.toml", "--resume", "--max-time", "0.01s"]);
    let said = errors(&output);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("stopped after 0.01 s (--max-time): no results were written; --resume"), "{said}");
    folder.succeed(&["run", "slow.toml", "--resume", "--quiet"]);
    same(&folder, &expected);
}

#[test]
fn two_runs_do_not_keep_checkpoints_in_one_place() {
    let expected = undisturbed();
    let folder = folder();
    let mut first = start(&folder, &[]);
    wait_for(&folder, 1);
    for option in [&["--checkpoint", "10"][..], &["--resume"]] {
        let output = folder.run(&[&["run", "slow.toml"], option].concat());
        let said = errors(&output);
        assert_eq!(output.status.code(), Some(1), "{said}");
        let reported =
            format!("out/slow: another run (process {}) writes checkpoints for this folder", first.id());
        assert!(said.contains(&reported), "{said}");
    }
    assert!(first.wait().unwrap().success(), "the first was disturbed");
    same(&folder, &expected);

    // Many at once: one of them runs, and the others say why not.
    let mut runs: Vec<_> = (0..6).map(|_| start(&folder, &["-o", "out/fast"])).collect();
    let ended: Vec<_> = runs.iter_mut().map(|run| run.wait().unwrap().code()).collect();
    assert!(ended.iter().filter(|code| **code == Some(0)).count() >= 1, "{ended:?}");
    assert!(ended.iter().all(|code| matches!(code, Some(0 | 1))), "{ended:?}");
    assert_eq!(names(&folder.path().join("out")), ["fast", "slow"], "something is left");
}

#[test]
fn ctrl_c_leaves_a_checkpoint_and_says_so() {
    let expected = undisturbed();
    let folder = folder();
    let child = start(&folder, &[]);
    wait_for(&folder, 1);
    let kill = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", errors(&output));
    assert!(errors(&output).contains("--resume continues from out/slow.checkpoint."), "{}", errors(&output));
    folder.succeed(&["run", "slow.toml", "--resume", "--quiet"]);
    same(&folder, &expected);
}

/// A run stopped after two checkpoints at least.
fn stopped() -> Folder {
    let folder = folder();
    let mut child = start(&folder, &[]);
    wait_for(&folder, 2);
    child.kill().unwrap();
    child.wait().unwrap();
    folder
}

#[test]
fn a_damaged_checkpoint_is_passed_over_for_the_one_before() {
    let expected = undisturbed();
    let folder = stopped();
    let [older, newer] = {
        let mut slots = slots(&folder);
        slots.sort_by_key(|path| events(path));
        slots
    };
    let damage = |path: &Path| {
        let mut bytes = std::fs::read(path).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        std::fs::write(path, bytes).unwrap();
    };
    damage(&newer);
    let before = events(&older).unwrap();
    let output = folder.run(&["run", "slow.toml", "--resume"]);
    let said = errors(&output);
    assert!(output.status.success(), "{said}");
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    assert!(
        said.contains(&format!("{}: a damaged checkpoint: its checksum is wrong", name(&newer))),
        "{said}"
    );
    assert!(said.contains(&format!("{}, after {before} events", name(&older))), "{said}");
    same(&folder, &expected);

    let folder = stopped();
    slots(&folder).iter().for_each(|path| damage(path));
    let output = folder.run(&["run", "slow.toml", "--resume"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("a damaged checkpoint"), "{}", errors(&output));
    assert!(slots(&folder).iter().all(|path| path.exists()), "something was lost");
}

#[test]
fn a_checkpoint_of_something_else_is_refused_with_the_difference() {
    let folder = stopped();
    let refused = |arguments: &[&str], code: i32, words: &[&str]| {
        let output = folder.run(&[&["run", "slow.toml"], arguments].concat());
        let said = errors(&output);
        assert_eq!(output.status.code(), Some(code), "{said}");
        words.iter().for_each(|word| assert!(said.contains(word), "{word} not in {said}"));
    };
    let other = ["--resume", "--set", "ensemble.seed=7", "--set", "interface.connection=0.3"];
    refused(&other, 2, &["interface.connection = 0.3", "interface.connection = 0.2", "ensemble.seed"]);
    refused(&["--checkpoint", "10"], 1, &["unfinished", "--resume"]);
    // Another version: the header changed, and the checksum with it.
    for path in slots(&folder) {
        let bytes = std::fs::read(&path).unwrap();
        let version = concat!("\"version\":\"", env!("CARGO_PKG_VERSION"), "\"");
        let at = bytes.windows(version.len()).position(|window| window == version.as_bytes()).unwrap();
        let body = &bytes[..bytes.len() - 4];
        let mut changed = [&body[..at], b"\"version\":\"0.0.1\"", &body[at + version.len()..]].concat();
        changed.extend(crc32fast::hash(&changed).to_le_bytes());
        std::fs::write(path, changed).unwrap();
    }
    refused(&["--resume"], 2, &["asperity 0.0.1", concat!("asperity ", env!("CARGO_PKG_VERSION"))]);
    let plain = folder.run(&["run", "slow.toml", "--set", "interface.cells=[0]"]);
    assert_eq!(plain.status.code(), Some(2));
}

#[test]
fn only_interfaces_have_checkpoints() {
    let folder = Folder::new();
    folder.write("pull.toml", "contacts.thresholds.point = { at = 1.0 }\npull.distance = 1.0\n");
    let renormalised = scenarios().join("renormalised-cells.toml");
    for scenario in ["pull.toml", renormalised.to_str().unwrap()] {
        for option in [&["--checkpoint", "10"][..], &["--resume"]] {
            let output = folder.run(&[&["run", scenario], option].concat());
            assert_eq!(output.status.code(), Some(2));
            let expected =
                format!("{}: expected a scenario of [drive] or [[protocol]] with [interface]", option[0]);
            assert!(errors(&output).contains(&expected), "{}", errors(&output));
        }
    }
    folder.write("slow.toml", &SCENARIO.replace("100.0", "1.0").replace("[40.0, 80.0]", "[]"));
    let output = folder.run(&["run", "slow.toml", "--resume"]);
    assert!(output.status.success() && errors(&output).contains("starts at the beginning"));
}
