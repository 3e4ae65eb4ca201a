//! Parameter sweeps: the same bytes however they are computed, and nothing lost by a kill.

mod support;

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use support::{Folder, errors, names, scenarios};

/// 24 cases of some ms, with words, replicas, a curve and a zipped axis; some cases fail when they are run.
const SMALL: &str = r#"
title = "A small sweep"
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
pull = { distance = 3.0, points = 31 }
ensemble = { size = 2000, seed = 3 }

[sweep]
keep = ["static_friction", "kinetic_friction", { variable = "ensemble_force", at = { from = 0.0, to = 3.0, points = 7 } }]
repeat = 2
zip = [["contacts.count", "contacts.stiffness"]]

[sweep.over]
"contacts.thresholds.gaussian.std" = { from = 0.05, to = 0.3, points = 4, scale = "log" }
"contacts.count" = [1, 10, 100]
"contacts.stiffness" = [1.0, 0.1, 0.01]
"#;

fn small() -> Folder {
    let folder = Folder::new();
    folder.write("small.toml", SMALL);
    folder
}

const QUIET: [&str; 3] = ["sweep", "small.toml", "--quiet"];

fn sweep(folder: &Folder, more: &[&str]) -> Output {
    folder.run(&[&QUIET[..], &["--no-figures"], more].concat())
}

fn succeed(folder: &Folder, more: &[&str]) {
    let output = sweep(folder, more);
    assert_eq!(output.status.code(), Some(0), "{more:?}: {}", errors(&output));
}

fn bytes(folder: &Folder, results: &str) -> Vec<u8> {
    std::fs::read(folder.path().join(results).join("sweep.nc")).unwrap()
}

/// The folder of stored cases.
fn store(folder: &Path) -> String {
    names(folder).into_iter().find(|name| name.contains(".sweep-")).unwrap()
}

#[test]
fn parts_in_any_order_and_twice_and_any_number_of_threads_give_the_same_bytes() {
    let folder = small();
    succeed(&folder, &["-o", "whole"]);
    succeed(&folder, &["-o", "one", "--threads", "1"]);
    succeed(&folder, &["-o", "two", "--threads", "2"]);
    for part in ["3/3", "1/3", "3/3", "2/3", "1/3"] {
        succeed(&folder, &["-o", "parts", "--part", part]);
    }
    succeed(&folder, &["-o", "parts", "--gather"]);
    let whole = bytes(&folder, "whole");
    for results in ["one", "two", "parts"] {
        assert!(bytes(&folder, results) == whole, "{results}");
    }
    let table = std::fs::read_to_string(folder.path().join("whole/sweep.csv")).unwrap();
    assert_eq!(table.lines().count(), 1 + 24);
    assert_eq!(
        table.lines().next().unwrap(),
        "contacts_thresholds_gaussian_std,contacts_count,contacts_stiffness,repeat,static_friction_force,\
         static_friction_position,kinetic_friction,accuracy"
    );
}

/// A case of a sweep has the numbers of a run with its values.
#[test]
fn a_case_is_the_run_with_its_values() {
    let folder = small();
    succeed(&folder, &["-o", "all"]);
    let table = std::fs::read_to_string(folder.path().join("all/sweep.csv")).unwrap();
    let row: Vec<&str> = table.lines().nth(1 + 2 * (2 * 3 + 1)).unwrap().split(',').collect();
    assert_eq!(&row[1..4], ["10", "0.1", "0"]);
    let std = format!("contacts.thresholds.gaussian.std={}", row[0]);
    let one = SMALL.split("[sweep]").next().unwrap();
    folder.write("one.toml", one);
    let sets = ["--set", &std, "--set", "contacts.count=10", "--set", "contacts.stiffness=0.1"];
    let json = folder.succeed(&[&["run", "one.toml", "--json", "--no-figures"], &sets[..]].concat());
    let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
    let reported = |cell: usize| row[cell].parse::<f64>().unwrap();
    assert_eq!(summary["static_friction"]["force"].as_f64(), Some(reported(4)));
    assert_eq!(summary["static_friction"]["position"].as_f64(), Some(reported(5)));
    assert_eq!(summary["kinetic_friction"].as_f64(), Some(reported(6)));
}

/// Numbers that look random (SplitMix64), the same in every run of the test.
fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[test]
fn a_sweep_that_is_killed_at_any_moment_is_continued_to_the_same_bytes() {
    let folder = small();
    // Longer cases, so that there is something to kill: half a second in all.
    let set = ["--set", "ensemble.size=40000"];
    succeed(&folder, &[&["-o", "whole"], &set[..]].concat());
    let mut state = 20;
    for kill in 0..20 {
        let results = format!("killed-{}", kill / 5);
        let more = ["-o", &results, "--no-figures", "--resume", "--threads", "2"];
        let mut command = folder.asperity(&[&QUIET[..], &more, &set].concat());
        let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(random(&mut state) % 400));
        // SIGKILL; it may have ended before.
        let _ = child.kill();
        child.wait().unwrap();
    }
    for group in 0..4 {
        let results = format!("killed-{group}");
        succeed(&folder, &[&["-o", &results, "--resume"], &set[..]].concat());
        assert!(bytes(&folder, &results) == bytes(&folder, "whole"), "{results}");
    }
}

#[test]
fn what_is_missing_is_named() {
    let folder = small();
    succeed(&folder, &["-o", "parts", "--part", "2/3"]);
    let output = sweep(&folder, &["-o", "parts", "--gather"]);
    assert_eq!(output.status.code(), Some(1));
    let message = errors(&output);
    assert!(message.contains("16 of 24 cases are missing: parts 1, 3 (--part I/3)"), "{message}");
    assert!(!folder.path().join("parts").exists(), "nothing is gathered");
}

#[test]
fn a_sweep_that_is_not_finished_is_not_begun_again() {
    let folder = small();
    succeed(&folder, &["-o", "new", "--part", "1/2"]);
    let output = sweep(&folder, &["-o", "new"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        errors(&output).contains("12 of 24 cases are stored; continue with --resume"),
        "{}",
        errors(&output)
    );
}

#[test]
fn damaged_files_and_stores_of_others_are_not_used() {
    let folder = small();
    succeed(&folder, &["-o", "whole"]);
    succeed(&folder, &["-o", "torn"]);
    let torn = names(folder.path()).into_iter().find(|name| name.starts_with("torn.sweep-")).unwrap();
    let torn = folder.path().join(torn);
    for name in names(&torn).iter().filter(|name| name.ends_with(".cases")) {
        let path = torn.join(name);
        let mut content = std::fs::read(&path).unwrap();
        let middle = content.len() / 2;
        content[middle] ^= 1;
        std::fs::write(&path, content).unwrap();
    }
    // The store of another version.
    let manifest = std::fs::read_to_string(torn.join("sweep.json")).unwrap();
    let other = folder.path().join("torn.sweep-0123456789abcdef");
    std::fs::create_dir(&other).unwrap();
    let own = format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION"));
    assert!(manifest.contains(&own));
    std::fs::write(other.join("sweep.json"), manifest.replace(&own, "\"version\": \"0.0.1\"")).unwrap();
    let output = folder.run(&["sweep", "small.toml", "--no-figures", "--resume", "-o", "torn"]);
    let message = errors(&output);
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert!(message.contains("its checksum is wrong; its cases are computed again"), "{message}");
    assert!(message.contains("it holds cases of version 0.0.1"), "{message}");
    assert!(bytes(&folder, "torn") == bytes(&folder, "whole"));
    assert_eq!(names(&other), ["sweep.json"], "it is left as it is");
}

#[test]
#[cfg(target_os = "linux")]
fn two_sweeps_at_once_exclude_each_other() {
    let folder = small();
    folder.write("long.toml", &SMALL.replace("size = 2000,", "size = 200000000,"));
    let mut command = folder.asperity(&["sweep", "long.toml", "--quiet", "-o", "busy"]);
    let mut first = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let lock = folder.path().join("busy.sweep.lock");
    // A minute: long enough for any machine.
    for _ in 0..30_000 {
        if std::fs::read(&lock).is_ok_and(|content| !content.is_empty()) {
            break;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    let output = sweep(&folder, &["-o", "busy"]);
    let _ = first.kill();
    first.wait().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let message = errors(&output);
    assert!(
        message.contains(&format!("another sweep (process {}) writes to this folder", first.id())),
        "{message}"
    );
    // The lock of a process that was killed is none.
    succeed(&folder, &["-o", "busy"]);
}

/// Files may grow to no block at all, as on a full disk.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_ends_the_sweep_and_loses_nothing() {
    let folder = small();
    succeed(&folder, &["-o", "whole"]);
    succeed(&folder, &["-o", "full", "--part", "1/3"]);
    let before = names(&folder.path().join(store(folder.path())));
    let program = env!("CARGO_BIN_EXE_asperity");
    let script = format!(
        "ulimit -f 0; trap '' XFSZ; exec {program} sweep small.toml --no-figures --quiet -o full --resume"
    );
    let output = Command::new("bash").args(["-c", &script]).current_dir(folder.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    assert!(errors(&output).contains("cannot write: File too large"), "{}", errors(&output));
    assert!(!folder.path().join("full").exists());
    assert_eq!(names(&folder.path().join(store(folder.path()))), before);
    succeed(&folder, &["-o", "full", "--resume"]);
    assert!(bytes(&folder, "full") == bytes(&folder, "whole"));
}

/// Not even root may make files there.
#[test]
#[cfg(target_os = "linux")]
fn a_folder_that_cannot_be_written_is_found_before_any_work() {
    let folder = small();
    for place in ["/proc/results", "small.toml/results"] {
        let output = sweep(&folder, &["-o", place]);
        assert_eq!(output.status.code(), Some(1), "{place}: {}", errors(&output));
        assert!(errors(&output).contains(": cannot "), "{}", errors(&output));
        assert_eq!(folder.names(), ["small.toml"]);
    }
}

/// Curves of 4 MB, of which 1 MB may be in memory.
#[test]
fn curves_that_outgrow_the_memory_are_written_as_if_they_had_not() {
    let folder = small();
    let fine = SMALL.replace("points = 7", "points = 20001");
    folder.write("fine.toml", &fine);
    let run = |more: &[&str]| {
        folder.succeed(&[&["sweep", "fine.toml", "--figures", "svg", "--quiet"], more].concat());
    };
    run(&["-o", "memory"]);
    run(&["-o", "files", "--memory", "8MB"]);
    assert!(bytes(&folder, "files") == bytes(&folder, "memory"));
    for name in ["summary.json", "static_friction_force.svg"] {
        let [one, other] =
            ["files", "memory"].map(|run| std::fs::read(folder.path().join(run).join(name)).unwrap());
        assert!(one == other && !one.is_empty(), "{name}");
    }
    let text = folder.succeed(&["sweep", "fine.toml", "--explain"]);
    assert!(text.contains("curves                 4 MiB in sweep.nc"), "{text}");
}

/// The pictures of a folder are those of its sweep: lines with replicas and without, maps of numbers and of words.
#[test]
fn pictures_of_a_sweep_are_drawn_anew() {
    let folder = small();
    folder.write(
        "line.toml",
        &SMALL
            .replace("\"contacts.count\" = [1, 10, 100]", "")
            .replace("\"contacts.stiffness\" = [1.0, 0.1, 0.01]", "")
            .replace("zip = [[\"contacts.count\", \"contacts.stiffness\"]]", ""),
    );
    let map = std::fs::read_to_string(scenarios().join("sweep-stability.toml")).unwrap();
    folder.write("map.toml", &map.replace("points = 20", "points = 5"));
    for (scenario, some) in
        [("small", "kinetic_friction.svg"), ("line", "ensemble_force.svg"), ("map", "regime.svg")]
    {
        folder.succeed(&[
            "sweep",
            &format!("{scenario}.toml"),
            "--figures",
            "svg",
            "--quiet",
            "-o",
            scenario,
        ]);
        let results = folder.path().join(scenario);
        let pictures: Vec<String> =
            names(&results).into_iter().filter(|name| name.ends_with(".svg")).collect();
        assert!(pictures.iter().any(|name| name == some), "{scenario}: {pictures:?}");
        let read = || pictures.iter().map(|name| std::fs::read(results.join(name)).unwrap());
        let before: Vec<_> = read().collect();
        pictures.iter().for_each(|name| std::fs::remove_file(results.join(name)).unwrap());
        let reported = folder.succeed(&["plot", scenario, "--figures", "svg"]);
        assert!(reported.contains(some.trim_end_matches(".svg")), "{reported}");
        assert!(read().zip(&before).all(|(now, before)| now == *before), "{scenario}");
    }
}

/// Between two corners that are valid may be a case that is not.
#[test]
fn a_case_that_fails_is_a_value() {
    let folder = Folder::new();
    folder.write(
        "failing.toml",
        r#"
contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }
pull = { distance = 3.0, points = 31 }
[sweep]
keep = ["kinetic_friction"]
[sweep.over]
"pull.points" = [31, 32.5, 34]
"#,
    );
    let output = folder.run(&["sweep", "failing.toml", "--no-figures"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    let reported = String::from_utf8(output.stdout).unwrap();
    assert!(reported.contains("cases                  3, 1 of them failed"), "{reported}");
    let table = std::fs::read_to_string(folder.path().join("out/failing/sweep.csv")).unwrap();
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert!(rows[0].contains("0.50") && rows[2].contains("0.50"), "{table}");
    let reason = "32.5,NaN,NaN,\"pull.points: expected a whole number, 0 or above, got 32.5\"";
    assert_eq!(rows[1], reason, "{table}");
}

#[test]
fn cases_that_failed_are_computed_again_where_that_is_asked_for() {
    let folder = Folder::new();
    let scenario = |cells: &str| {
        format!(
            r#"
contacts.thresholds.gaussian = {{ mean = 1.0, std = 0.1 }}
interface = {{ cells = [10, 10], contacts = "one", coupling.neighbours = {{ stiffness = 0.2 }}, connection = 0.2 }}
drive = {{ distance = 0.1, points = 2 }}
sweep = {{ keep = ["catalogue.events"], over."interface.cells" = {cells} }}
"#
        )
    };
    folder.write("large.toml", &scenario("[[10, 10], [400, 1000], [20, 10], [1000, 400]]"));
    folder.write("larger.toml", &scenario("[[400, 1000], [1000, 400]]"));
    let run = |more: &[&str]| {
        let output = folder.run(&[&["sweep", "large.toml", "--no-figures"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{more:?}: {}", errors(&output));
        String::from_utf8(output.stdout).unwrap()
    };
    run(&["--quiet", "-o", "whole"]);
    // The large lattices take 28.8 MB.
    let little = ["--memory", "10MB"];
    assert!(run(&little).contains("cases                  4, 2 of them failed"));
    assert!(run(&[&little[..], &["--resume"]].concat()).contains("2 of them failed"));
    assert!(run(&["--resume"]).contains("2 of them failed"), "what failed is stored");
    assert!(!run(&["--retry"]).contains("failed"));
    assert_eq!(bytes(&folder, "out/large"), bytes(&folder, "whole"));
    assert!(!run(&["--resume"]).contains("failed"), "what was kept last counts");
    // Parts do the same.
    run(&[&little[..], &["--part", "1/2", "-o", "parts"]].concat());
    run(&[&little[..], &["--part", "2/2", "-o", "parts"]].concat());
    run(&["--part", "2/2", "-o", "parts", "--retry"]);
    run(&["--gather", "-o", "parts"]);
    assert_eq!(bytes(&folder, "parts"), bytes(&folder, "whole"));
    // Nothing at all is no success.
    let output = folder.run(&["sweep", "larger.toml", "--no-figures", "--memory", "10MB"]);
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    assert!(errors(&output).contains("all 2 cases failed"), "{}", errors(&output));
    assert!(folder.path().join("out/larger/sweep.nc").is_file());
}

#[test]
fn a_sweep_is_explained_without_work() {
    let folder = small();
    let text = folder.succeed(&["sweep", "small.toml", "--explain"]);
    for part in [
        "cases                  24",
        "contacts.count, contacts.stiffness: 3 values from 1 to 100",
        "stored                 0 of 24",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert_eq!(folder.names(), ["small.toml"]);
}

#[test]
fn too_many_cases_are_refused_with_their_number() {
    let folder = Folder::new();
    let axis = |key: &str| format!("\"{key}\" = {{ from = 1.0, to = 2.0, points = 1000 }}\n");
    let axes =
        [axis("contacts.count"), axis("contacts.stiffness"), axis("contacts.thresholds.gaussian.mean")];
    let head = "contacts.thresholds.gaussian = { mean = 1.0, std = 0.1 }\npull.distance = 3.0\n[sweep]\nkeep = [\"kinetic_friction\"]\n[sweep.over]\n";
    folder.write("huge.toml", &(head.to_owned() + &axes.concat()));
    let output = folder.run(&["sweep", "huge.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(errors(&output).contains("expected 1e7 cases or fewer, got 1e9 cases"), "{}", errors(&output));
    assert_eq!(folder.names(), ["huge.toml"]);
}

#[test]
fn the_shipped_map_has_all_its_regimes() {
    let folder = Folder::new();
    let path = scenarios().join("sweep-stability.toml");
    let text = folder.succeed(&["sweep", path.to_str().unwrap(), "-o", "map", "--figures", "svg"]);
    for word in ["persistent (", "transient (", "smooth ("] {
        assert!(text.contains(word), "{text}");
    }
    let drawn = ["mean_drop.svg", "period.svg", "regime.svg", "slips.svg"];
    assert!(drawn.iter().all(|name| folder.path().join("map").join(name).exists()));
}
