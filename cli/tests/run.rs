//! Runs: what is written and printed, and what is left when they fail.

mod support;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use support::{Folder, errors, names};

const SCENARIO: &str = r#"
title = "A quick pull"

[contacts]
normal_load = 2.0
thresholds.gaussian = { mean = 1.0, std = 0.1 }

[pull]
distance = 3.0
points = 31
snapshots = [0.0, 1.0]

[ensemble]
size = 1000
seed = 7

[units]
length = "µm"
force = "mN"
"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("quick.toml", SCENARIO);
    folder
}

#[test]
fn plot_draws_the_pictures_of_a_run_anew() {
    let folder = folder();
    folder.succeed(&["run", "quick.toml", "--figures", "svg,png"]);
    let results = folder.path().join("out/quick");
    let before = contents(&results);
    // The same pictures from result.nc, and more of them.
    assert_eq!(
        folder.succeed(&["plot", "out/quick"]),
        "pictures               force, evolution, distribution (svg)\n"
    );
    assert_eq!(contents(&results), before);
    folder.succeed(&["plot", "out/quick", "--figures", "pdf", "--no-title", "--figure-width", "86"]);
    let pdf = std::fs::read(results.join("force.pdf")).unwrap();
    assert!(pdf.starts_with(b"%PDF"));
    // A picture that was changed is kept; what plot wrote belongs to the results, and the next run removes it.
    std::fs::write(results.join("force.svg"), "changed").unwrap();
    let output = folder.run(&["plot", "out/quick"]);
    assert!(errors(&output).contains("force.svg was not written by asperity, or was changed; it is kept"));
    assert_eq!(std::fs::read_to_string(results.join("force.svg.kept")).unwrap(), "changed");
    folder.succeed(&["run", "quick.toml", "--figures", "svg,png"]);
    let mut after = contents(&results);
    after.retain(|(name, _)| name != "force.svg.kept");
    assert_eq!(after, before);
}

#[test]
fn plot_refuses_what_is_no_folder_of_results() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("empty")).unwrap();
    for place in ["nowhere", "empty"] {
        let output = folder.run(&["plot", place]);
        assert_eq!(output.status.code(), Some(1));
        assert!(errors(&output).contains(&format!("{place}/scenario.toml: cannot read")));
    }
    folder.succeed(&["run", "quick.toml", "--no-figures"]);
    std::fs::write(folder.path().join("out/quick/result.nc"), "no NetCDF").unwrap();
    let output = folder.run(&["plot", "out/quick"]);
    assert!(errors(&output).contains("result.nc"), "{}", errors(&output));
    assert!(!folder.path().join("out/quick/force.svg").exists());
}

#[test]
fn manual_pages_and_suggestions() {
    let folder = Folder::new();
    assert!(folder.succeed(&["man"]).contains(".TH asperity 1"));
    let page = folder.succeed(&["man", "run"]);
    assert!(page.contains("asperity\\-run") && page.contains("figure\\-width"), "{page}");
    assert!(errors(&folder.run(&["man", "rum"])).contains("there is no command rum"));
    assert!(errors(&folder.run(&["example", "fig22"])).contains("did you mean fig2?"));
    assert!(folder.succeed(&["completions", "--help"]).contains("~/.config/fish/completions"));
}

/// Every file of a folder with its bytes.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    names(folder).into_iter().map(|name| (name.clone(), std::fs::read(folder.join(&name)).unwrap())).collect()
}

#[test]
fn a_run_writes_to_out_and_prints_a_summary() {
    let folder = folder();
    let output = folder.run(&["run", "quick.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    assert_eq!(errors(&output), "", "no progress where nobody looks");
    let summary = String::from_utf8(output.stdout).unwrap();
    // The theory, for Gaussian thresholds and contacts unstretched at X = 0.
    for part in [
        "A quick pull",
        "F_s = 0.796436 mN at X_s = 0.844164 µm",
        "F_k = 0.505 mN",
        "X*  = 5.09098 µm (the paper's estimate 10 µm)",
        "K_c = 3.00922 mN/µm",
        "static 0.398218, kinetic 0.2525",
        "1000 contacts, seed 7",
        "out/quick",
        "  data                 scenario.toml, summary.json, force.csv, atoms.csv, result.nc",
        "  pictures             force, evolution, distribution (svg)",
    ] {
        assert!(summary.contains(part), "{part} not in\n{summary}");
    }
    let written = names(&folder.path().join("out/quick"));
    for name in ["scenario.toml", "summary.json", "result.nc", "force.csv", "force.svg"] {
        assert!(written.iter().any(|n| n == name), "{name} not in {written:?}");
    }
}

#[test]
fn the_summary_can_be_json_or_nothing() {
    let folder = folder();
    let json = folder.succeed(&["run", "quick.toml", "--json", "-o", "results"]);
    let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!((&summary["title"], &summary["seed"]), (&"A quick pull".into(), &7.into()));
    assert_eq!(json, std::fs::read_to_string(folder.path().join("results/summary.json")).unwrap());
    assert_eq!(folder.succeed(&["run", "quick.toml", "--quiet"]), "");
}

#[test]
fn pictures_are_those_that_are_asked_for() {
    let folder = folder();
    let pictures = |options: &[&str]| -> Vec<String> {
        folder.succeed(&[&["run", "quick.toml", "-o", "results", "--quiet"], options].concat());
        let written = names(&folder.path().join("results")).into_iter();
        written.filter(|name| [".svg", ".png", ".pdf"].iter().any(|end| name.ends_with(end))).collect()
    };
    assert_eq!(pictures(&["--no-figures"]), [""; 0]);
    let expected = ["distribution.pdf", "evolution.pdf", "force.pdf"];
    assert_eq!(pictures(&["--figures", "pdf", "--no-title", "--figure-width", "86"]), expected);
    assert_eq!(pictures(&[]), ["distribution.svg", "evolution.svg", "force.svg"]);
    // Dots per inch are those of PNG.
    assert_eq!(pictures(&["--figure-dpi", "50"]).iter().filter(|name| name.ends_with(".png")).count(), 3);
    assert_eq!(pictures(&["--set", "figure.formats=[\"svg\"]", "--figures", "pdf"]), expected);
    for (options, expected) in [
        (&["--figures", "eps"][..], "possible values: svg, png, pdf"),
        (&["--figure-width=-3"], "expected a number above 0"),
        (&["--figure-dpi", "inf"], "expected a finite number above 0"),
        (&["--figure-dpi", "1e6"], "figure.dpi: expected at most 20000 dots along a side"),
        (&["--figure-width", "20", "--figure-font-size", "12"], "figure: expected a picture at least"),
        (&["--set", "figure.width=-3"], "figure.width: expected a number above 0"),
        (&["--figures", "pdf", "--no-figures"], "cannot be used with"),
        (&["--figures", "pdf", "--figure-dpi", "300"], "--figure-dpi beside --figures without png"),
        (&["--no-title", "--no-figures"], "options of pictures beside --no-figures"),
        (&["--only", "csv", "--figure-dpi", "300"], "options of pictures beside --only without figures"),
        (&["--only", "nc,figures", "--no-figures"], "--no-figures beside --only with figures"),
    ] {
        let output = folder.run(&[&["run", "quick.toml", "-o", "none"], options].concat());
        assert_eq!(output.status.code(), Some(2), "{options:?}");
        assert!(errors(&output).contains(expected), "{options:?}: {}", errors(&output));
        assert!(!folder.path().join("none").exists(), "{options:?}");
    }
}

#[test]
fn the_written_scenario_gives_the_same_bytes_on_any_number_of_threads() {
    let folder = folder();
    folder.succeed(&["run", "quick.toml", "--set", "contacts.thresholds.gaussian.std=0.2", "-o", "first"]);
    folder.succeed(&["run", "first/scenario.toml", "--threads", "1", "-o", "second"]);
    folder.succeed(&["run", "first/scenario.toml", "--threads", "3", "-o", "third"]);
    let [first, second, third] = ["first", "second", "third"].map(|name| contents(&folder.path().join(name)));
    for ((name, bytes), others) in first.iter().zip(second.iter().zip(&third)) {
        assert!(bytes == &others.0.1 && bytes == &others.1.1, "{name} differs");
    }
    assert_eq!((first.len(), second.len()), (second.len(), third.len()));
}

/// Editors read the schema from a file; a line that names none would only be in their way.
#[test]
fn the_written_scenario_names_the_schema_that_is_around_it() {
    let folder = folder();
    let written = || std::fs::read_to_string(folder.path().join("out/quick/scenario.toml")).unwrap();
    folder.succeed(&["run", "quick.toml", "--no-figures"]);
    let without = written();
    assert!(!without.contains("#:schema"));
    let schema = folder.succeed(&["schema"]);
    folder.write("asperity.schema.json", &schema);
    folder.succeed(&["run", "quick.toml", "--no-figures"]);
    assert_eq!(written(), format!("#:schema ../../asperity.schema.json\n{without}"));
    // It is read as before.
    folder.succeed(&["plot", "out/quick", "--figures", "svg"]);
    folder.succeed(&["run", "out/quick/scenario.toml", "--no-figures", "-o", "out/again"]);
    let again = std::fs::read_to_string(folder.path().join("out/again/scenario.toml")).unwrap();
    assert_eq!(again, written());
}

#[test]
fn a_folder_of_ours_is_replaced_whole_and_any_other_left_alone() {
    let folder = folder();
    folder.succeed(&["run", "quick.toml", "-o", "results"]);
    let before = names(&folder.path().join("results"));
    folder.succeed(&["run", "quick.toml", "-o", "results", "--set", "pull.snapshots=[]"]);
    assert_ne!(names(&folder.path().join("results")), before, "pictures of snapshots were left behind");

    std::fs::create_dir(folder.path().join("thesis")).unwrap();
    folder.write("thesis/chapter.tex", "years of work");
    let output = folder.run(&["run", "quick.toml", "-o", "thesis"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("thesis"), "{}", errors(&output));
    assert_eq!(contents(&folder.path().join("thesis")), [("chapter.tex".into(), b"years of work".into())]);
}

#[test]
fn files_of_the_user_stay_in_a_folder_of_results() {
    let folder = folder();
    folder.succeed(&["run", "quick.toml", "-o", "results"]);
    folder.write("results/notes.txt", "seen");
    folder.write("results/force.csv", "position,force\n1,2\n");
    let output = folder.run(&["run", "quick.toml", "-o", "results"]);
    assert_eq!(output.status.code(), Some(0), "{}", errors(&output));
    assert_eq!(
        errors(&output).trim(),
        format!(
            "warning: {0}/results/force.csv was not written by asperity, or was changed; it is kept as {0}/results/force.csv.kept",
            folder.path().canonicalize().unwrap().display()
        )
    );
    let read = |name: &str| std::fs::read_to_string(folder.path().join("results").join(name)).unwrap();
    assert_eq!(
        (read("notes.txt").as_str(), read("force.csv.kept").as_str()),
        ("seen", "position,force\n1,2\n")
    );
    assert!(read("force.csv").lines().count() == 32, "no new results");
}

#[test]
fn a_place_that_cannot_be_written_fails_with_its_name() {
    let folder = folder();
    for place in ["quick.toml/results", "/proc/results", "/dev/full/results"] {
        let output = folder.run(&["run", "quick.toml", "-o", place]);
        assert_eq!(output.status.code(), Some(1), "{place}: {}", errors(&output));
        assert!(errors(&output).contains(place.split('/').next_back().unwrap()), "{}", errors(&output));
        assert_eq!(folder.names(), ["quick.toml"]);
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_leaves_no_half_folder() {
    let folder = folder();
    // Files may grow to four blocks and no further, as on a full disk.
    let script = r#"trap '' XFSZ; ulimit -f 4; exec "$0" run quick.toml -o results"#;
    let mut shell = Command::new("sh");
    shell.args(["-c", script, env!("CARGO_BIN_EXE_asperity")]).current_dir(folder.path());
    let output = shell.output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", errors(&output));
    assert!(errors(&output).contains("cannot write"), "{}", errors(&output));
    assert_eq!(folder.names(), ["quick.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = Folder::new().asperity(&["schema"]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("standard output"), "{}", errors(&output));
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_a_long_run_and_leaves_nothing() {
    let folder = folder();
    for long in ["ensemble.size=2000000000", "pull.distance=1e7"] {
        let mut run = folder.asperity(&["run", "quick.toml", "-o", "results", "--set", long]);
        let child = run.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(700));
        let interrupted = Instant::now();
        let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
        assert!(kill.success(), "{long}: it was over before it could be interrupted");
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{long}: {}", errors(&output));
        assert!(interrupted.elapsed() < Duration::from_secs(10), "{long}: {:?}", interrupted.elapsed());
        assert!(output.stdout.is_empty() && errors(&output).contains("interrupted"));
        assert_eq!(folder.names(), ["quick.toml"], "{long}");
    }
}

/// The limit of addresses is one that a test can set: 10⁸ contacts do not fit in 2 GB.
#[test]
#[cfg(target_os = "linux")]
fn more_than_the_memory_there_is_ends_with_1_before_anything_is_written() {
    let folder = folder();
    let scenario = SCENARIO.replace("[pull]", "[block]\nstiffness = 1.0\n\n[drive]");
    let scenario =
        scenario.replace("snapshots = [0.0, 1.0]\n", "").replace("size = 1000", "size = 100_000_000");
    folder.write("large.toml", &scenario);
    let program = folder.asperity(&["run", "large.toml", "--threads", "1"]);
    let limited = Command::new("sh")
        .args(["-c", "ulimit -v 2000000; exec \"$0\" \"$@\""])
        .arg(program.get_program())
        .args(program.get_args())
        .current_dir(folder.path())
        .output()
        .unwrap();
    let said = errors(&limited);
    assert_eq!(limited.status.code(), Some(1), "{said}");
    // What is drawn may break lines.
    assert!(["ensemble.size", "100000000", "11.9 GiB"].iter().all(|part| said.contains(part)), "{said}");
    assert!(!folder.path().join("out").exists(), "{:?}", folder.names());
}

#[test]
fn a_fit_that_does_not_converge_ends_with_an_error_and_its_last_values() {
    let folder = Folder::new();
    // A force that hardly changes, which no contacts show.
    let row = |i: u32| format!("{},{}\n", 0.03 * f64::from(i), 1.0 + 1e-9 * f64::from(i));
    let rows: String = (1..=100).map(row).collect();
    folder.write("flat.csv", &format!("position,force\n{rows}"));
    let scenario = "contacts.thresholds.gaussian = { mean = 0.9, std = 0.2 }
        contacts.count = 1500.0
        contacts.stiffness = 1.2
        contacts.reforming.gaussian = { mean = 0.1, std = 0.03 }
        [fit]
        file = 'flat.csv'
        noise = 'white'
        free = ['contacts.thresholds.gaussian.mean', 'contacts.thresholds.gaussian.std', 'contacts.count']";
    folder.write("fit.toml", scenario);
    let output = folder.run(&["run", "fit.toml", "--no-figures"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(errors(&output).contains("the fit has not converged; its last values and its misfit are in out"));
    let written = names(&folder.path().join("out/fit"));
    assert!(["fit.json", "fit.csv", "fitted.toml"].iter().all(|name| written.iter().any(|w| w == name)));
    let reported = std::fs::read_to_string(folder.path().join("out/fit/fit.json")).unwrap();
    assert!(reported.contains("\"converged\": false") && reported.contains("\"chi_squared\""));
}

/// The number after `word` in a line.
fn after(line: &str, word: &str) -> f64 {
    let rest = line.split_once(&format!("{word} ")).unwrap_or_else(|| panic!("{word} is not in {line}")).1;
    rest.split([',', ' ']).find_map(|part| part.parse().ok()).unwrap_or_else(|| panic!("{line}"))
}

#[test]
fn forces_in_time_are_told_as_friction_coefficients_too() {
    let folder = Folder::new();
    folder.write(
        "steps.toml",
        "contacts.thresholds.gaussian = { mean = 1.0, std = 0.2 }
         contacts.ageing.logarithmic = { growth = 0.04, time = 1.0 }
         contacts.normal_load = 2.0
         [[protocol]]
         velocity = 0.1
         distance = 6.0
         [[protocol]]
         velocity = 1.0
         distance = 6.0",
    );
    let text = folder.succeed(&["run", "steps.toml"]);
    let json = std::fs::read_to_string(folder.path().join("out/steps/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(summary["normal_load"], 2.0);
    let step = &summary["steps"][1];
    let told = text.lines().filter(|line| line.starts_with("  coefficients")).nth(1).unwrap();
    let read = text.lines().find(|line| line.ends_with("(friction coefficients)")).unwrap();
    for (line, word, force) in [
        (told, "end", &step["force"]),
        (told, "maximum", &step["peak"]["force"]),
        (told, "kinetic", &step["kinetic_friction"]),
        (read, "a", &step["rate_state"]["a"]),
        (read, "b", &step["rate_state"]["b"]),
    ] {
        let coefficient = force.as_f64().unwrap() / 2.0;
        // five digits are printed
        assert!((after(line, word) / coefficient - 1.0).abs() < 1e-4, "{line}: {word} {coefficient}");
    }
}
