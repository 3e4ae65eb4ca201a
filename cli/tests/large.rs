//! Runs that pass memory: results are written as they come, and what would need too much memory is refused.
#![cfg(target_os = "linux")]

mod support;

use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::process::{Command, Output, Stdio};
use std::thread;
use std::time::Duration;

use asperity_runner::output;
use support::{Folder, errors};

/// A chain whose forces are recorded at every point: 8 kB each.
const CHAIN: &str = "
[contacts]
count = 1000.0
thresholds.gaussian = { mean = 1.0, std = 0.1 }

[interface]
cells = [1000]
contacts = \"one\"
connection = 1.0
coupling.neighbours.stiffness = 1.0

[drive]
distance = 1.0
points = 2001
";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("chain.toml", CHAIN);
    folder
}

/// The output of a run in a shell that has done `before`.
fn after(folder: &Folder, before: &str, arguments: &[&str]) -> Output {
    let program = folder.asperity(arguments);
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("{before}; exec \"$0\" \"$@\"")]).arg(program.get_program());
    shell.args(program.get_args()).current_dir(folder.path()).output().unwrap()
}

/// 75 000 points are 600 MB, which were refused while files were assembled in memory.
#[test]
fn six_hundred_megabytes_are_written_in_less_memory() {
    let folder = folder();
    let arguments =
        ["run", "chain.toml", "--set", "drive.points=75001", "--only", "nc", "--quiet", "--threads", "1"];
    // What a process may address, its code and the stacks of its threads included.
    let output = after(&folder, "ulimit -v 300000", &arguments);
    assert!(output.status.success(), "{}", errors(&output));
    let size = fs::metadata(folder.path().join("out/chain/result.nc")).unwrap().len();
    assert!(size > 600_000_000, "{size} bytes");
}

#[test]
fn what_was_written_as_it_came_is_what_would_have_been_kept_in_memory() {
    let folder = folder();
    folder.succeed(&["run", "chain.toml", "--figures", "svg", "-o", "whole"]);
    let limited = folder.run(&["run", "chain.toml", "--memory", "32MB", "--figures", "svg", "-o", "pieces"]);
    assert!(limited.status.success(), "{}", errors(&limited));
    assert!(errors(&limited).contains("pictures show"), "{}", errors(&limited));
    let [of_whole, of_pieces] = ["whole", "pieces"].map(|name| support::names(&folder.path().join(name)));
    assert!(of_whole == of_pieces && of_whole.iter().any(|name| name == "space_time.svg"), "{of_pieces:?}");
    let catalogue =
        ["whole", "pieces"].map(|name| fs::read(folder.path().join(name).join("catalogue.svg")).unwrap());
    assert!(catalogue[0] == catalogue[1], "events are drawn as they are");
    let [whole, pieces] = ["whole", "pieces"].map(|name| {
        let mut outcome = output::read(&folder.path().join(name)).unwrap();
        outcome.record.variables.sort_by(|a, b| a.name.cmp(&b.name));
        outcome
    });
    assert_eq!(whole.summary, pieces.summary);
    assert!(whole.record.variables.iter().any(|variable| variable.values.len() == 2001 * 1000));
    // Numbers that are equal, and no NaN, which is not equal to itself.
    assert_eq!(whole.record, pieces.record);
    let again = after(&folder, "export ASPERITY_MEMORY=32MB", &["plot", "pieces", "--figures", "svg"]);
    assert!(again.status.success(), "{}", errors(&again));
    assert_eq!(support::names(&folder.path().join("pieces")), of_pieces);
    for name in ["trace.csv", "events.csv"] {
        let [whole, pieces] =
            ["whole", "pieces"].map(|run| fs::read(folder.path().join(run).join(name)).unwrap());
        assert!(whole == pieces && whole.len() > 1000, "{name}");
    }
}

#[test]
fn columns_go_on_from_a_checkpoint() {
    let folder = folder();
    let run =
        |more: &[&str]| folder.run(&[&["run", "chain.toml", "--memory", "32MB", "--quiet"], more].concat());
    assert!(run(&["-o", "whole", "--only", "nc"]).status.success());
    let stopped = run(&["-o", "stopped", "--only", "nc", "--max-time", "10ms"]);
    if !stopped.status.success() {
        let resumed = run(&["-o", "stopped", "--only", "nc", "--resume"]);
        assert!(resumed.status.success(), "{}", errors(&resumed));
    }
    let [whole, stopped] =
        ["whole", "stopped"].map(|run| fs::read(folder.path().join(run).join("result.nc")).unwrap());
    assert!(whole == stopped);
}

#[test]
fn a_run_killed_while_it_writes_leaves_no_results() {
    let folder = folder();
    let is_partial = || folder.names().iter().any(|name| name.contains("partial"));
    let mut run = folder.asperity(&["run", "chain.toml", "--set", "drive.points=40001", "--memory", "32MB"]);
    let mut run = run.args(["-o", "results", "--quiet"]).stderr(Stdio::null()).spawn().unwrap();
    // The folder under another name is there from the beginning of the writing.
    while !is_partial() {
        assert!(run.try_wait().unwrap().is_none(), "over before it was killed");
        thread::sleep(Duration::from_millis(1));
    }
    run.kill().unwrap();
    assert_eq!(run.wait().unwrap().signal(), Some(9));
    assert!(!folder.names().contains(&"results".to_owned()), "{:?}", folder.names());
    folder.succeed(&["run", "chain.toml", "-o", "results", "--no-figures"]);
}

/// A file that must not grow is refused by the system as a full disk is.
#[test]
fn a_full_disk_ends_a_run_with_1_and_leaves_nothing() {
    let folder = folder();
    let before = folder.names();
    // Blocks of 512 bytes: columns beside the results, and the results themselves, are larger.
    for blocks in [8_000, 31_300] {
        let limit = format!("trap '' XFSZ; ulimit -f {blocks}");
        let output = after(&folder, &limit, &["run", "chain.toml", "--memory", "32MB", "-o", "results"]);
        assert_eq!(output.status.code(), Some(1), "{blocks}: {}", errors(&output));
        let said = errors(&output);
        assert!(said.contains("cannot write"), "{said}");
        assert_eq!(folder.names(), before, "{said}");
    }
}

#[test]
fn cells_beyond_the_memory_are_refused_with_what_they_need_and_what_there_is() {
    let folder = folder();
    let cells = CHAIN.replace("contacts = \"one\"\n", "").replace("[1000]", "[2048, 2048]");
    folder.write("cells.toml", &cells);
    let output = folder.run(&["run", "cells.toml", "--memory", "500MB"]);
    let said = errors(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    // 192 bytes for each cell; what is drawn may break lines.
    let parts =
        ["memory: up to 768 MiB for the interface, of 477 MiB available", "interface.cells", "4194304"];
    assert!(parts.iter().all(|part| said.contains(part)), "{said}");
    assert!(said.contains("expected what fits in the 477 MiB of memory that is allowed"), "{said}");
    let quiet = errors(&folder.run(&["run", "cells.toml", "--memory", "500MB", "--quiet"]));
    assert!(!quiet.contains("memory: up to") && quiet.contains("768 MiB"), "{quiet}");
    assert!(!folder.path().join("out").exists(), "{:?}", folder.names());
}

#[test]
fn amounts_of_memory_that_are_none_are_refused() {
    let folder = folder();
    let output = folder.run(&["run", "chain.toml", "--memory", "much"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("expected an amount of memory such as 8GB"), "{}", errors(&output));
    let output = after(&folder, "export ASPERITY_MEMORY=much", &["run", "chain.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        errors(&output).contains("environment variable ASPERITY_MEMORY: expected"),
        "{}",
        errors(&output)
    );
    assert!(!folder.path().join("out").exists());
}

#[test]
fn only_the_files_asked_for_are_written() {
    let folder = folder();
    let written = |only: &str| {
        folder.succeed(&["run", "chain.toml", "--set", "drive.points=11", "-o", only, "--only", only]);
        support::names(&folder.path().join(only))
    };
    assert_eq!(written("nc"), [".asperity", "result.nc", "scenario.toml"]);
    assert_eq!(
        written("json,csv"),
        [".asperity", "events.csv", "scenario.toml", "summary.json", "trace.csv"]
    );
    assert!(written("figures").iter().any(|name| name.ends_with(".svg")));
    let output = folder.run(&["run", "chain.toml", "--only", "hdf"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("nc, csv, json, figures"), "{}", errors(&output));
}
