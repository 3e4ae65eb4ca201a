//! What the pictures of a run take, beside its task.
#![cfg(target_os = "linux")]

mod support;

use std::process::Stdio;

use support::{Folder, reaped, scenarios};

/// Scenarios with the shortest tasks, whose pictures are the dearest beside them.
const SHORT: [&str; 4] = ["commensurate", "compared", "identical", "stick-slip-reset"];
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

/// As SVG, the usual format, they take 0.1 to 0.5 times as much as the task here, less than it; with PNG up to 2.6 times as much.
/// Least times of runs that alternate differ by less than a tenth, also beside other work.
#[test]
fn pictures_cost_less_than_their_task_and_with_png_a_few_times_as_much() {
    let folder = Folder::new();
    for scenario in SHORT {
        let mut least = [f64::INFINITY; 3];
        for _ in 0..RUNS {
            for (least, options) in
                least.iter_mut().zip([&["--no-figures"][..], &[], &["--figures", "svg,png"]])
            {
                *least = least.min(seconds(&folder, scenario, options));
            }
        }
        let [task, usual, with_png] = least;
        assert!(usual - task < task, "{scenario}: {usual} s with pictures, {task} s without");
        assert!(with_png - task < 3.5 * task, "{scenario}: {with_png} s with PNG, {task} s without");
    }
}
