//! Wrong input: one message that says what was expected and what came, where; exit code 2; nothing written.

mod support;

use support::{Folder, errors, scenarios, tomls};

/// The message without the way it is wrapped and framed.
fn flat(text: &str) -> String {
    text.replace('│', " ").split_whitespace().collect::<Vec<_>>().join(" ")
}

fn refused(arguments: &[&str]) -> String {
    let folder = Folder::new();
    let output = folder.run(arguments);
    let message = errors(&output);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
    assert!(output.stdout.is_empty(), "{arguments:?} wrote to the standard output");
    assert_eq!(folder.names(), [""; 0], "{arguments:?} left files");
    assert!(!message.contains('\x1b'), "{arguments:?}: colours in a file");
    flat(&message)
}

#[test]
fn every_wrong_scenario_is_refused_with_the_line_drawn() {
    let wrong = tomls(&scenarios().join("invalid"));
    assert!(wrong.len() >= 20, "only {}", wrong.len());
    for path in wrong {
        let text = std::fs::read_to_string(&path).unwrap();
        let first = text.lines().next().unwrap();
        let expected =
            first.strip_prefix("# expect: ").unwrap_or_else(|| panic!("{}: {first}", path.display()));
        let command = support::command_of(&path);
        let path = path.to_str().unwrap();
        for command in [&[command, path][..], &["check", path]] {
            let message = refused(command);
            for part in expected.split(" | ") {
                assert!(message.contains(part), "{path}\nexpected: {part}\ngot: {message}");
            }
            assert!(message.contains(&format!("[{path}:")), "{path}: no line drawn in {message}");
        }
    }
}

#[test]
fn a_wrong_override_is_named() {
    let scenario = scenarios().join("fig2.toml");
    let scenario = scenario.to_str().unwrap();
    for (argument, expected) in [
        ("contacts.thresholds.gaussian.std=-1", "expected a finite number above 0, got -1"),
        ("contacts.thresholds.gausian.std=1", "did you mean gaussian?"),
        ("contacts.cuont=1", "did you mean count?"),
        ("pull.points=1", "pull.points: expected 2 points or more"),
        ("contacts.count", "expected KEY=VALUE"),
        ("=1", "expected KEY=VALUE"),
        ("pull.distance=1", "with --set pull.distance=1"),
    ] {
        let message = refused(&["run", scenario, "--set", argument]);
        assert!(message.contains(expected), "{argument}: {message}");
        assert!(message.contains("--set") && message.contains(argument), "{argument}: {message}");
    }
}

#[test]
fn a_scenario_that_is_not_there_is_named() {
    let message = refused(&["run", "nowhere.toml"]);
    assert!(message.contains("nowhere.toml: No such file"), "{message}");
}

/// Hundreds of samples that lie unevenly are so many jumps of the density of thresholds that there is an end to those that
/// follow from them.
#[test]
fn what_takes_too_much_names_what_asks_for_it() {
    let folder = Folder::new();
    let uneven = |i: i32| 0.8 + 0.4 * (f64::from(i * i) * 0.618_034).fract();
    let samples: Vec<_> = (0..400).map(|i| uneven(i).to_string()).collect();
    let law =
        format!("contacts.thresholds.tabulated = {{ exact = true, samples = [{}] }}\n", samples.join(", "));
    folder.write("samples.toml", &format!("{law}pull.distance = 3.0\n"));
    let output = folder.run(&["run", "samples.toml"]);
    let message = flat(&errors(&output));
    // Not wrong, but too much: the run failed.
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("contacts.thresholds: expected what fits in"), "{message}");
}

#[test]
fn a_wrong_command_line_is_refused() {
    for arguments in [&["rum"][..], &["run"], &["run", "a.toml", "--threads", "0"], &["example", "fig9"]] {
        refused(arguments);
    }
    for (option, value, expected) in [
        ("--threads", "100000", "expected a number from 1 to"),
        ("--threads", "many", "8 times the"),
        ("--checkpoint", "0", "expected a number of events above 0, or a time such as 90s, 10min"),
        ("--checkpoint", "10m", "expected a number of events above 0, or a time such as 90s, 10min"),
        ("--max-time", "10", "expected a time such as 90s, 10min, 1h30min, 2d or 23:50:00"),
    ] {
        let message = refused(&["run", "a.toml", option, value]);
        assert!(message.contains(expected) && message.contains(value), "{message}");
    }
}

#[test]
fn too_many_threads_in_the_environment_are_refused() {
    let folder = Folder::new();
    folder.write("a.toml", "contacts.thresholds.point.at = 1.0\npull.distance = 1.0\n");
    let output = folder.asperity(&["run", "a.toml"]).env("RAYON_NUM_THREADS", "100000").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let message = errors(&output);
    let begin = "error: environment variable RAYON_NUM_THREADS: expected a number from 1 to ";
    assert!(message.starts_with(begin) && message.ends_with(", got 100000\n"), "{message}");
}

#[test]
fn a_file_in_another_encoding_is_named_with_the_place() {
    let folder = Folder::new();
    let law = "contacts.thresholds.tabulated.file = 'table.csv'\npull.distance = 1.0\n";
    folder.write("table.toml", law);
    let wide = |text: &str| -> Vec<u8> {
        [vec![0xff, 0xfe], text.encode_utf16().flat_map(u16::to_le_bytes).collect()].concat()
    };
    for (name, bytes, run, expected) in [
        (
            "latin.toml",
            b"title = 'a'\nunits.length = '\xb5m'\n".to_vec(),
            "latin.toml",
            "latin.toml: byte 0xB5 at offset 28 (line 2, byte 17) is not UTF-8; save it as UTF-8",
        ),
        (
            "wide.toml",
            wide(law),
            "wide.toml",
            "wide.toml: a text in UTF-16, by the mark in its first two bytes; save it as UTF-8",
        ),
        (
            "table.csv",
            b"sample\n1.0\n1\xa00\n".to_vec(),
            "table.toml",
            "table.csv: byte 0xA0 at offset 12 (line 3, byte 2) is not UTF-8",
        ),
        ("table.csv", wide("sample\n1.0\n"), "table.toml", "table.csv: a text in UTF-16"),
        (
            "table.csv",
            b"sample\n1.0\n\0\n".to_vec(),
            "table.toml",
            "table.csv: byte 0x00 at offset 11 (line 3, byte 1) is not text",
        ),
    ] {
        std::fs::write(folder.path().join(name), bytes).unwrap();
        for command in ["run", "check"] {
            let output = folder.run(&[command, run]);
            let message = flat(&errors(&output));
            assert_eq!(output.status.code(), Some(2), "{message}");
            assert!(message.contains(expected), "{name}: {message}");
        }
    }
    // What spreadsheets put before UTF-8 is no letter.
    std::fs::write(folder.path().join("table.csv"), b"\xef\xbb\xbfsample\n1.0\n1.5\n").unwrap();
    std::fs::write(folder.path().join("marked.toml"), [b"\xef\xbb\xbf", law.as_bytes()].concat()).unwrap();
    folder.succeed(&["check", "marked.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn what_has_no_end_is_refused() {
    let folder = Folder::new();
    let message = refused(&["check", "/dev/zero"]);
    assert!(message.contains("/dev/zero: more than 256 MiB, the largest file that is read"), "{message}");
    folder.write("table.toml", "contacts.thresholds.tabulated.file = '/dev/zero'\npull.distance = 1.0\n");
    let output = folder.run(&["check", "table.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(flat(&errors(&output)).contains("/dev/zero: more than 256 MiB"), "{}", errors(&output));
}

#[test]
fn long_input_is_not_shown_whole() {
    let folder = Folder::new();
    let samples = |wrong: &str, separator: &str| {
        let samples = vec!["0.125"; 10_000].join(separator);
        format!("contacts.thresholds.tabulated = {{ samples = [{samples}, {wrong}] }}\npull.distance = 1.0\n")
    };
    for (text, expected) in [
        (samples("'many'", ", "), "got the text \"many\""),
        (samples("'many'", ",\n"), "got the text \"many\""),
        (samples("-1.0", ", "), "contacts.thresholds.tabulated.samples"),
        (samples("-1.0", ",\n"), "contacts.thresholds.tabulated.samples"),
        (format!("title = {}", "x".repeat(100_000)), "expected valid TOML"),
        (format!("contacts.thresholds.point = '{}'", "x".repeat(100_000)), "more letters)"),
    ] {
        folder.write("long.toml", &text);
        let output = folder.run(&["check", "long.toml"]);
        let message = errors(&output);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.len() < 2000, "{} bytes: {}", message.len(), &message[..2000]);
        assert!(flat(&message).contains(expected), "{expected} not in {message}");
    }
}

#[test]
fn more_runs_than_memory_has_are_refused_where_they_are_checked() {
    let scenario = scenarios().join("renormalised-cells.toml");
    let message = refused(&["check", scenario.to_str().unwrap(), "--set", "renormalisation.runs=1000000000"]);
    assert!(message.contains("renormalisation.runs: expected at most"), "{message}");
}
