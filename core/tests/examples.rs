//! The examples print what is kept beside them; python/tests/test_examples.py compares the same with Python.

use std::path::{Path, PathBuf};
use std::process::Command;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")
}

/// The names of the files of this kind beside the examples.
fn names(extension: &str) -> Vec<String> {
    let paths = std::fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path());
    let of_kind = paths.filter(|path| path.extension().is_some_and(|found| found == extension));
    let mut names: Vec<String> =
        of_kind.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    names.sort();
    names
}

/// What an example prints. Cargo builds the examples beside the tests.
fn printed(name: &str) -> String {
    let test = std::env::current_exe().unwrap();
    let built = test.parent().and_then(Path::parent).unwrap().join("examples");
    let program = built.join(name).with_extension(std::env::consts::EXE_EXTENSION);
    let output = Command::new(&program).output();
    let output =
        output.unwrap_or_else(|error| panic!("{}: {error}; cargo build --examples", program.display()));
    assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn examples_print_what_is_kept() {
    let update = std::env::var_os("ASPERITY_UPDATE").is_some();
    // One that somebody tries has no output that is kept.
    for name in names(if update { "rs" } else { "txt" }) {
        let (kept, found) = (folder().join(&name).with_extension("txt"), printed(&name));
        if update {
            std::fs::write(&kept, &found).unwrap();
        }
        let expected = std::fs::read_to_string(&kept).unwrap_or_default();
        assert_eq!(found, expected, "{name}; ASPERITY_UPDATE=1 keeps what it prints now");
    }
}

#[test]
fn every_example_has_its_counterpart_in_python() {
    let scripts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../python/examples");
    assert_eq!(names("txt").len(), 8);
    for name in names("txt") {
        assert!(scripts.join(&name).with_extension("py").is_file(), "python/examples/{name}.py is missing");
    }
}
