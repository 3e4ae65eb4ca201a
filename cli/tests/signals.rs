//! Signals: what ends a run, how soon, and what does not.
#![cfg(target_os = "linux")]

mod support;

use std::fs::File;
use std::io::Read as _;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use support::{Folder, errors, names, reaped, scenarios, tomls};

/// A look at a process is taken so often, and so many of them: a minute, long enough for any machine, and never waited for. Looks
/// are counted, since the clock of a machine that was held up jumps.
const PAUSE: Duration = Duration::from_millis(2);
const LOOKS: usize = 30_000;
/// CPU time that a run may take after a signal, in seconds.
const CPU: f64 = 1.0;

/// More than a minute of work, in pieces of less than a millisecond.
const LONG: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
pull = { distance = 3.0, points = 31 }
ensemble.size = 2000000000
";

/// Half a minute of events, and as many checkpoints as are asked for.
const EVENTS: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.count = 1024
initial.rectangular = { min = 0.0, max = 0.5 }
interface = { cells = [32, 32], contacts = 'one', coupling.neighbours = { stiffness = 0.2 }, connection = 0.2, catalogue_from = 1e4 }
drive = { distance = 1e4, points = 11 }
";

/// The same with 256 times as many contacts, whose state has some megabytes.
const LARGE: &str = "
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
contacts.count = 262144
initial.rectangular = { min = 0.0, max = 0.5 }
interface = { cells = [512, 512], contacts = 'one', coupling.neighbours = { stiffness = 0.2 }, connection = 0.2, catalogue_from = 1e4 }
drive = { distance = 1e4, points = 11 }
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("long.toml", LONG);
    folder.write("events.toml", EVENTS);
    folder
}

fn spawn(command: &mut Command) -> Child {
    command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

/// The same command, which hears SIGHUP where the tests themselves were made to outlive the terminal, too.
fn heeding_sighup(command: &Command) -> Command {
    let mut heard = Command::new("env");
    heard.arg("--default-signal=HUP").arg(command.get_program()).args(command.get_args());
    command.get_current_dir().map(|folder| heard.current_dir(folder));
    for (name, value) in command.get_envs() {
        match value {
            Some(value) => heard.env(name, value),
            None => heard.env_remove(name),
        };
    }
    heard
}

/// Sends signals without a pause between them.
fn send(child: &Child, signals: &[&str]) {
    let kill: Vec<_> = signals.iter().map(|signal| format!("kill -{signal} {};", child.id())).collect();
    Command::new("sh").args(["-c", &kill.concat()]).stderr(Stdio::null()).status().unwrap();
}

/// State and CPU time in seconds of a process that has not been waited for.
fn status(child: &Child) -> (char, f64) {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).unwrap();
    // Behind the name, which is in brackets: the state, and 11 fields further on the times of user and system.
    let fields: Vec<_> = stat.rsplit_once(") ").unwrap().1.split(' ').collect();
    let ticks: f64 = fields[11..13].iter().map(|field| field.parse::<f64>().unwrap()).sum();
    // Linux shows hundredths of a second on every machine that it runs on.
    (fields[0].chars().next().unwrap(), ticks / 100.0)
}

/// Looks at a process until this is so.
fn wait_until(child: &Child, is_so: impl Fn((char, f64)) -> bool, otherwise: &str) {
    for _ in 0..LOOKS {
        if is_so(status(child)) {
            return;
        }
        std::thread::sleep(PAUSE);
    }
    panic!("{otherwise}");
}

/// The CPU time from now to the end of the process.
fn time_to_end(child: &Child) -> f64 {
    let before = status(child).1;
    wait_until(child, |(state, _)| state == 'Z', "it does not end");
    status(child).1 - before
}

/// What a process says that ends within [`CPU`] after these signals.
fn ended_by(child: Child, signals: &[&str]) -> Output {
    send(&child, signals);
    let took = time_to_end(&child);
    assert!(took < CPU, "{signals:?}: {took} s");
    child.wait_with_output().unwrap()
}

/// Waits until the process has computed for a while.
fn at_work(child: &Child, seconds: f64) {
    wait_until(child, |(state, time)| time >= seconds || state == 'Z', "it does nothing");
}

fn left(folder: &Path) -> Vec<String> {
    names(folder).into_iter().filter(|name| !name.ends_with(".toml")).collect()
}

#[test]
fn every_signal_ends_a_run_as_ctrl_c_does() {
    let folder = folder();
    for signal in ["INT", "TERM", "HUP"] {
        let child = spawn(&mut heeding_sighup(&folder.asperity(&["run", "long.toml"])));
        at_work(&child, 0.05);
        let output = ended_by(child, &[signal]);
        assert_eq!(output.status.code(), Some(130), "{signal}");
        assert_eq!(errors(&output), "interrupted: nothing was written\n", "{signal}");
        assert_eq!(left(folder.path()), [""; 0], "{signal}");
    }
}

/// At moments of CPU time from 3 ms to 2 s, other ones for each scenario: laws, lives, solvers, pictures.
#[test]
fn shipped_scenarios_end_wherever_they_are() {
    const SEEDS: [f64; 2] = [0.0, 0.5];
    let paths = tomls(&scenarios());
    let ended: Vec<usize> = std::thread::scope(|scope| {
        let threads = SEEDS.map(|seed| {
            let paths = &paths;
            scope.spawn(move || {
                let numbered = paths.iter().enumerate();
                numbered.filter(|&(number, path)| ends_at(path, moment(number, seed))).count()
            })
        });
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let (ended, all) = (ended.iter().sum::<usize>(), SEEDS.len() * paths.len());
    assert!(3 * ended >= all, "only {ended} of {all} had not come to their end");
}

/// The CPU time after which a run is sent a signal, even in its logarithm.
fn moment(number: usize, seed: f64) -> f64 {
    // Multiples of the golden ratio are spread evenly.
    let part = (number as f64 * 0.618_034 + seed).fract();
    3e-3 * (2.0_f64 / 3e-3).powf(part)
}

/// Whether a scenario has not come to its end at a moment, and ends as it should.
fn ends_at(scenario: &Path, moment: f64) -> bool {
    let folder = Folder::new();
    let command = support::command_of(scenario);
    let child = spawn(&mut folder.asperity(&[command, scenario.to_str().unwrap(), "-o", "results"]));
    at_work(&child, moment);
    send(&child, &["INT"]);
    let (before, ended) = (status(&child).1, reaped(child));
    // Times of a process that has not ended are known to a hundredth of a second.
    assert!(ended.seconds - before < CPU + 0.01, "{scenario:?} at {moment}: {} s", ended.seconds - before);
    // Stored cases of a sweep stay.
    let names: Vec<_> = folder.names().into_iter().filter(|name| !name.contains(".sweep-")).collect();
    match ended.code {
        Some(0) => {
            assert_eq!(names, ["results"], "{scenario:?} at {moment}");
            assert!(folder.path().join("results/summary.json").exists(), "{scenario:?} at {moment}");
            false
        }
        // Before the program listens the signal does what it does to any.
        None | Some(130) => {
            assert_eq!(names, [""; 0], "{scenario:?} at {moment}");
            true
        }
        code => panic!("{scenario:?} at {moment}: {code:?}"),
    }
}

#[test]
fn a_run_with_checkpoints_keeps_one_first_also_where_a_signal_comes_twice() {
    let folder = folder();
    for signals in [&["INT"][..], &["TERM", "TERM"]] {
        let child = spawn(&mut folder.asperity(&["run", "events.toml", "--checkpoint", "1h", "--resume"]));
        at_work(&child, 0.2);
        let output = ended_by(child, signals);
        assert_eq!(output.status.code(), Some(130), "{signals:?}");
        let said = errors(&output);
        let reported = "interrupted: no results were written; --resume continues from out/events.checkpoint.";
        assert!(said.contains(reported), "{signals:?}: {said}");
    }
}

/// The checkpoint goes to a pipe, so that the signal comes in the middle of it.
#[test]
fn a_checkpoint_that_is_being_written_is_given_up_for_the_one_before() {
    let folder = Folder::new();
    folder.write("large.toml", LARGE);
    let child = spawn(&mut folder.asperity(&["run", "large.toml", "--checkpoint", "1h"]));
    at_work(&child, 0.2);
    assert_eq!(ended_by(child, &["INT"]).status.code(), Some(130));
    let before = folder.path().join("out/large.checkpoint.0");
    let kept = std::fs::read(&before).unwrap();
    // Many times what a pipe holds: the run waits for its reader.
    assert!(kept.len() > 4 << 20, "{} bytes", kept.len());
    let script =
        r#"mkfifo out/large.checkpoint.$$.partial; exec "$0" run large.toml --checkpoint 1 --resume"#;
    let mut shell = Command::new("sh");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_asperity")]).current_dir(folder.path());
    let child = spawn(&mut shell);
    let pipe = folder.path().join(format!("out/large.checkpoint.{}.partial", child.id()));
    wait_until(&child, |_| pipe.exists(), "there is no pipe");
    let mut reader = File::open(&pipe).unwrap();
    reader.read_exact(&mut [0]).unwrap();
    send(&child, &["INT"]);
    // The run receives the signal while it waits.
    std::thread::sleep(Duration::from_millis(200));
    let rest = std::io::copy(&mut reader, &mut std::io::sink()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(130), "{}", errors(&output));
    assert!(
        errors(&output).contains("--resume continues from out/large.checkpoint.0"),
        "{}",
        errors(&output)
    );
    assert!(rest < kept.len() as u64 / 2, "{rest} of {} bytes", kept.len());
    assert_eq!(std::fs::read(&before).unwrap(), kept);
    assert!(!pipe.exists());
}

/// A checkpoint that cannot be written, to a pipe that nobody reads, holds the run up for good.
#[test]
fn a_second_signal_ends_what_does_not_stop() {
    let folder = folder();
    let script =
        r#"mkdir out; mkfifo out/events.checkpoint.$$.partial; exec "$0" run events.toml --checkpoint 1h"#;
    let mut shell = Command::new("sh");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_asperity")]).current_dir(folder.path());
    let mut child = spawn(&mut shell);
    at_work(&child, 0.05);
    send(&child, &["INT"]);
    // It has said that it waits, one second after the signal.
    std::thread::sleep(Duration::from_millis(1500));
    assert!(child.try_wait().unwrap().is_none(), "it did not wait for its checkpoint");
    let output = ended_by(child, &["INT"]);
    assert_eq!(output.status.code(), Some(130));
    assert!(errors(&output).contains("a second Ctrl-C stops the run immediately"), "{}", errors(&output));
}

#[test]
fn who_is_made_to_outlive_the_terminal_does() {
    let folder = folder();
    let mut shell = Command::new("sh");
    let script = r#"exec nohup "$0" run long.toml"#;
    shell.args(["-c", script, env!("CARGO_BIN_EXE_asperity")]).current_dir(folder.path());
    let mut child = spawn(&mut shell);
    at_work(&child, 0.05);
    send(&child, &["HUP"]);
    let before = status(&child).1;
    at_work(&child, before + 0.1);
    assert!(child.try_wait().unwrap().is_none(), "it ended");
    assert_eq!(ended_by(child, &["TERM"]).status.code(), Some(130));
}

/// A pipe without a writer is waited for as any file is read, and let go of.
#[test]
fn what_waits_for_a_file_ends_too() {
    let folder = folder();
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe.toml")).status().unwrap().success());
    let child = spawn(&mut folder.asperity(&["run", "pipe.toml"]));
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(ended_by(child, &["INT"]).status.code(), Some(130));
}

#[test]
fn a_run_ends_when_its_time_is_over() {
    let folder = folder();
    let output = folder.run(&["run", "long.toml", "--max-time", "0.3s"]);
    assert_eq!(output.status.code(), Some(130));
    assert_eq!(errors(&output), "stopped after 0.3 s (--max-time): nothing was written\n");
    assert_eq!(left(folder.path()), [""; 0]);
    let output = folder.run(&["run", "events.toml", "--max-time", "1s"]);
    assert_eq!(output.status.code(), Some(130));
    let reported =
        "stopped after 1 s (--max-time): no results were written; --resume continues from out/events.";
    assert!(errors(&output).starts_with(reported), "{}", errors(&output));
}
