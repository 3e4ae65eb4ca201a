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
        let path = path.to_str().unwrap();
        for command in [&["run", path][..], &["check", path]] {
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
    let law = format!("contacts.thresholds.tabulated = {{ samples = [{}] }}\n", samples.join(", "));
    folder.write("samples.toml", &format!("{law}pull.distance = 3.0\n"));
    let output = folder.run(&["run", "samples.toml"]);
    let message = flat(&errors(&output));
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("contacts.thresholds: expected what fits in"), "{message}");
}

#[test]
fn a_wrong_command_line_is_refused() {
    for arguments in [&["rum"][..], &["run"], &["run", "a.toml", "--threads", "0"], &["example", "fig9"]] {
        refused(arguments);
    }
}
