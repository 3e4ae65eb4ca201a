//! Scenarios that failed once: `found/NAME.toml`, whose first line says what must come of each.
//!
//! `# accepted`: a check accepts it. `# run`: it is accepted and gives numbers. `# refused KEY`: a check or a run refuses it,
//! with that key. `# awaited …`: it is to run, and does not yet; the test says so.

use std::path::Path;

use super::child::Limits;
use super::verdict;

const LIMITS: Limits = Limits { seconds: 20, bytes: 1 << 30, patience: None };

#[test]
fn what_failed_once_does_not_again() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/generated/found");
    let mut files: Vec<_> =
        std::fs::read_dir(folder).expect("the folder").map(|entry| entry.expect("a file").path()).collect();
    files.sort();
    assert!(files.len() > 5);
    let failures: Vec<_> = files.iter().filter_map(|file| judged(file)).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// What is wrong with a scenario, if anything.
fn judged(file: &Path) -> Option<String> {
    let name = file.file_stem().unwrap_or_default().display().to_string();
    let text = std::fs::read_to_string(file).expect("a scenario");
    let wanted = text
        .lines()
        .next()
        .and_then(|line| line.strip_prefix("# "))
        .expect("a first line that says what must come of it");
    if wanted.starts_with("awaited") {
        println!("{name}: {wanted}");
        return None;
    }
    let [folder, aside] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    std::fs::write(folder.path().join("scenario.toml"), &text).expect("the scenario is written");
    let run = |folder: &Path, aside: &Path, limits| verdict::run(folder, aside, limits, "--quiet");
    let judge = if wanted == "accepted" { verdict::check } else { run };
    let run = judge(folder.path(), aside.path(), LIMITS);
    let mut failures = run.failures;
    match (wanted.strip_prefix("refused "), run.ended.code()) {
        (Some(key), Some(1 | 2)) if !run.ended.errors.contains(key) => {
            failures.push(format!("{key} is not named: {}", run.ended.errors))
        }
        (Some(_), Some(1 | 2)) | (None, Some(0)) => {}
        (_, code) => {
            failures.push(format!("exit code {code:?} where it says {wanted}: {}", run.ended.errors))
        }
    }
    println!("{name}: {:.2} s", run.ended.seconds);
    (!failures.is_empty()).then(|| format!("{name}: {}", failures.join("; ")))
}
