//! Scenarios read: overrides, tables, the resolved text, and where errors are marked.

use std::path::{Path, PathBuf};

use asperity::scenario::{Disorder, Law, TaskStart};
use asperity_runner::input::{self, Diagnostic, Input};

const SCENARIO: &str = "
[contacts]
thresholds.gaussian = { mean = 1.0, std = 0.05 }

[pull]
snapshots = [0.0, 20.0]
";

fn parse(text: &str, overrides: &[&str]) -> Result<Input, Box<Diagnostic>> {
    let overrides: Vec<_> = overrides.iter().map(|s| (*s).to_owned()).collect();
    input::parse(text, "test.toml", Path::new(env!("CARGO_MANIFEST_DIR")), &overrides)
}

fn set(overrides: &[&str]) -> Input {
    parse(SCENARIO, overrides).unwrap_or_else(|e| panic!("{overrides:?}: {e}"))
}

/// The text at the first mark of the error, and the name of its source.
fn marked(error: &Diagnostic) -> (&str, &str) {
    let source = error.source.as_ref().expect("it has a source");
    (&source.name, &source.text[source.marks[0].span.clone()])
}

fn shipped() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenarios");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files: Vec<_> = files.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    assert!(files.len() >= 10, "only {files:?}");
    files
}

#[test]
fn the_resolved_text_of_every_shipped_scenario_gives_the_same_scenario_and_the_same_text() {
    for path in shipped() {
        let first = input::read(&path, &[]).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let text = input::to_text(&first.scenario);
        let again =
            input::parse(&text, "resolved", Path::new("/nowhere"), &[]).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(again.scenario, first.scenario, "{}", path.display());
        assert_eq!(input::to_text(&again.scenario), text, "{}", path.display());
        assert!(!text.contains("file ="), "{}: a table was not inlined", path.display());
    }
}

#[test]
fn defaults_are_those_of_the_contract() {
    let scenario = parse("contacts.thresholds.point.at = 1\n[pull]", &[]).unwrap().scenario;
    let pull = scenario.pull.unwrap();
    assert_eq!((scenario.contacts.count, pull.points), (1.0, 2001));
    assert_eq!((scenario.initial, scenario.contacts.reforming), (Law::zero(), Law::zero()));
    assert_eq!((pull.start, scenario.master_equation.tolerance().value()), (TaskStart::Conditional, 1e-10));
    assert!(scenario.ensemble.is_none() && scenario.compare.is_none());
}

#[test]
fn an_override_replaces_a_value_and_adds_tables() {
    let scenario = set(&["contacts.thresholds.gaussian.std=0.1", "ensemble.size=10", "title=Broad"]).scenario;
    assert_eq!(scenario.contacts.thresholds, Some(Law::Gaussian { mean: 1.0, std: 0.1 }));
    assert_eq!(scenario.ensemble.map(|e| (e.size(), e.seed, e.disorder)), Some((10, 1, Disorder::Annealed)));
    assert_eq!(scenario.title, "Broad");
}

#[test]
fn an_override_on_a_law_replaces_the_law() {
    let weibull = Some(Law::Weibull { shape: 12.0, scale: 1.0 });
    for overrides in [
        &["contacts.thresholds.weibull={shape=12,scale=1}"][..],
        &["contacts.thresholds={weibull={shape=12,scale=1}}"],
        &["contacts.thresholds.weibull.shape=12", "contacts.thresholds.weibull.scale=1."],
    ] {
        assert_eq!(set(overrides).scenario.contacts.thresholds, weibull, "{overrides:?}");
    }
}

#[test]
fn overrides_reach_into_lists_and_take_numbers_as_people_type_them() {
    let scenario = set(&["pull.snapshots.0=.5", "contacts.count=1e3"]).scenario;
    assert_eq!((scenario.pull.unwrap().snapshots, scenario.contacts.count), (vec![0.5, 20.0], 1000.0));
}

#[test]
fn an_error_caused_by_an_override_is_marked_there() {
    for (argument, mark) in [
        ("contacts.thresholds.gaussian.std=-1", "-1"),
        ("contacts.thresholds.gamma.mean=1", "gamma"),
        ("contacts.cuont=3", "cuont"),
        ("contacts.count", "contacts.count"),
        ("pull.points=many", "many"),
        ("pull=3", "3"),
        ("pull.snapshots=[.5]", ""),
        ("contacts.thresholds.mixture=[]", "[]"),
    ] {
        let error = *parse(SCENARIO, &[argument]).unwrap_err();
        assert_eq!(marked(&error), ("--set", mark), "{argument}: {error}");
    }
}

#[test]
fn an_override_that_clashes_with_the_file_is_named() {
    let error = parse(SCENARIO, &["pull.distance=10"]).unwrap_err();
    assert_eq!(marked(&error), ("test.toml", "20.0"));
    assert_eq!(error.help.as_deref(), Some("with --set pull.distance=10"));
}

#[test]
fn both_of_two_laws_are_marked() {
    let error = parse(&SCENARIO.replace("[pull]", "thresholds.point.at = 1\n[pull]"), &[]).unwrap_err();
    let source = error.source.as_ref().unwrap();
    let marks: Vec<_> = source.marks.iter().map(|mark| &source.text[mark.span.clone()]).collect();
    assert_eq!(marks, ["gaussian", "point"], "{error}");
}

#[test]
fn tables_are_read_relative_to_the_scenario() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("density.csv", "stretch,density\n0.5,0\n 1.0 , 2\n1.5,0\n");
    write("samples.csv", "sample\n1.0\n1.25\n");
    write("bare.csv", "1.0\n1.25\n");
    write("scenario.toml", SCENARIO);
    for (file, samples, stretch) in [
        ("density.csv", None, Some(vec![0.5, 1.0, 1.5])),
        ("samples.csv", Some(vec![1.0, 1.25]), None),
        ("bare.csv", Some(vec![1.0, 1.25]), None),
    ] {
        let argument = format!("contacts.thresholds.tabulated.file={file}");
        let input = input::read(&folder.path().join("scenario.toml"), &[argument]);
        let Some(Law::Tabulated(table)) = input.unwrap().scenario.contacts.thresholds else {
            panic!("{file}")
        };
        assert_eq!((table.file, table.samples, table.stretch), (None, samples, stretch), "{file}");
    }
}

#[test]
fn every_law_has_a_name_that_overrides_know() {
    let schema = input::schema();
    let laws = schema["$defs"]["Law"]["oneOf"].as_array().unwrap();
    let names: Vec<_> = laws.iter().map(|law| law["required"][0].as_str().unwrap()).collect();
    assert_eq!(names, Law::NAMES);
}

#[test]
fn a_complete_text_names_no_file() {
    for path in shipped() {
        let [text, folder] =
            [std::fs::read_to_string(&path).unwrap(), path.parent().unwrap().display().to_string()];
        let complete = input::complete(&text, "a", Path::new(&folder)).unwrap_or_else(|e| panic!("{e}"));
        let again =
            input::parse_complete(&complete, "b").unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        assert_eq!(again.scenario, input::read(&path, &[]).unwrap().scenario, "{}", path.display());
        assert_eq!(complete == text, !text.contains("file = "), "{}", path.display());
    }
}

#[test]
fn without_a_folder_no_file_is_read() {
    let law = "contacts.thresholds.point.at = 1\n";
    let interface = "drive.distance = 1\ninterface = { cells = [4], contacts = 'one', coupling.neighbours.stiffness = 1.0, connection = 1.0, disorder.file = '/etc/passwd' }";
    for (text, key) in [
        (
            "contacts.thresholds.tabulated.file = '/etc/passwd'\npull = {}".into(),
            "contacts.thresholds.tabulated.file",
        ),
        (format!("{law}pull = {{}}\ncompare.file = '/etc/passwd'"), "compare.file"),
        (format!("{law}protocol_file = '/etc/passwd'"), "protocol_file"),
        (format!("{law}fit.file = '/etc/passwd'"), "fit.file"),
        (format!("{law}fit.curve = [{{ file = '/etc/passwd' }}]"), "fit.curve.0.file"),
        (format!("{law}fit.steady.file = '/etc/passwd'"), "fit.steady.file"),
        (format!("{law}{interface}"), "interface.disorder.file"),
    ] {
        let error = input::parse_complete(&text, "text").unwrap_err();
        assert_eq!((error.key.as_str(), error.found.as_str()), (key, "\"/etc/passwd\""), "{error}");
        assert_eq!(error.expected, "the values themselves, since no files are read here");
    }
}
