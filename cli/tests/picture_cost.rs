//! The pictures of a run as SVG take less time than its task.
#![cfg(target_os = "linux")]

mod support;

use std::process::Stdio;

use support::{Folder, reaped, scenarios};

/// Scenarios with the shortest tasks, whose pictures are the dearest beside them.
const SHORT: [&str; 3] = ["commensurate", "compared", "identical"];
/// Enough for one run of each kind that other programs do not disturb.
const RUNS: usize = 15;

/// CPU seconds of a run, those of the start of the program among them.
fn seconds(folder: &Folder, scenario: &str, options: &[&str]) -> f64 {
    let path = scenarios().join(scenario).with_extension("toml");
    let arguments = ["run", path.to_str().unwrap(), "--quiet", "-o", "out"];
    let mut command = folder.asperity(&[&arguments, options].concat());
    let ended = reaped(command.stdout(Stdio::null()).spawn().unwrap());
    assert_eq!(ended.code, Some(0), "{scenario}");
    ended.seconds
}

/// Pictures as SVG take about a third of the task here; with PNG they take twice as much as the task. Least times of runs that
/// alternate differ by less than a tenth, also beside other work.
#[test]
fn pictures_as_svg_cost_less_than_their_task() {
    let folder = Folder::new();
    for scenario in SHORT {
        let (mut task, mut both) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..RUNS {
            task = task.min(seconds(&folder, scenario, &["--no-figures"]));
            both = both.min(seconds(&folder, scenario, &["--figures", "svg"]));
        }
        assert!(both - task < task, "{scenario}: {both} s with pictures, {task} s without");
    }
}
