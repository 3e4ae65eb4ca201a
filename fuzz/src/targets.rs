//! What strangers may hand over as bytes: scenarios, tables, results, checkpoints, parameters of distributions. Each must be read or
//! refused with an error; a panic, a crash, a hang or memory without limit is a defect.
//!
//! Each target is a plain function. cargo-fuzz calls it (`fuzz_targets`), and so does `runner/tests/fuzz.rs` on the stable compiler.
#![allow(missing_docs)]

use std::fs;
use std::num::NonZeroU64;
use std::ops::ControlFlow;
use std::path::Path;

use asperity::monitor::Monitor;
use asperity::scenario::{Component, Law, Scenario};
use asperity::task::Storage;
use asperity_runner::checkpoint::{Checkpoints, Every};
use asperity_runner::{input, output, run_with};
use tempfile::TempDir;

/// The text of a scenario. What is accepted is written as a text that is read as the same scenario.
pub fn scenario(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    // Without a folder: the names of files in a text lead nowhere.
    let Ok(read) = input::parse_complete(text, "fuzz") else { return };
    let again = input::to_text(&read.scenario);
    let second = input::parse_complete(&again, "again").unwrap_or_else(|error| panic!("{error}\n{again}"));
    assert_eq!(second.scenario, read.scenario, "{again}");
}

/// A folder for the files of a target, in memory where the system has that.
fn folder() -> TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a folder")
}

/// Scenarios that read a table, of each kind.
pub const TABLES: [&str; 7] = [
    "contacts.thresholds.tabulated.file = 'table.csv'\n[pull]\n",
    "contacts.thresholds.point.at = 1\n[pull]\n[compare]\nfile = 'table.csv'\n",
    "contacts.thresholds.gaussian = { mean = 1, std = 0.1 }\n[fit]\nfile = 'table.csv'\nfree = ['contacts.thresholds.gaussian.mean']\n",
    "contacts.thresholds.gaussian = { mean = 1, std = 0.1 }\nfit.free = ['contacts.thresholds.gaussian.mean']\n[fit.steady]\nfile = 'table.csv'\nspacing = 0.1\n",
    "contacts.thresholds.gaussian = { mean = 1, std = 0.1 }\ncontacts.delay.time = 1\nfit.free = ['contacts.delay.time']\n[fit.velocity_curve]\nfile = 'table.csv'\n",
    "contacts.thresholds.gaussian = { mean = 1, std = 0.1 }\n[interface]\ncells = [3]\nconnection = 1\ncoupling.neighbours = { stiffness = 1 }\ndisorder.file = 'table.csv'\n[drive]\ndistance = 1\n",
    "contacts.thresholds.gaussian = { mean = 1, std = 0.1 }\ncontacts.temperature = { energy = 0.1, attempt_rate = 1 }\nprotocol_file = 'table.csv'\n",
];

/// A table in CSV, as each kind of table that a scenario may name.
pub fn table(bytes: &[u8]) {
    let folder = folder();
    fs::write(folder.path().join("table.csv"), bytes).expect("the table is written");
    for text in TABLES {
        drop(input::parse(text, "fuzz", folder.path(), &[]));
    }
}

/// `result.nc`, beside a summary and a scenario that are right.
pub fn result(bytes: &[u8]) {
    let folder = folder();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).expect("a file");
    write("summary.json", include_bytes!("../seeds/summary.json"));
    write("scenario.toml", include_bytes!("../seeds/pull.toml"));
    write("result.nc", bytes);
    drop(output::read(folder.path()));
}

/// Stops after a number of questions: a changed state may have a longer way to go.
struct Patience(usize);

impl Monitor for Patience {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        self.0 = self.0.saturating_sub(1);
        if self.0 == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// The scenario of the checkpoints in the corpus.
pub const CHECKPOINTED: &str = include_str!("../seeds/chain.toml");

/// Runs it for some questions of a monitor from a checkpoint in a folder, if there is one, and leaves one there.
pub fn resume(folder: &Path, questions: usize) {
    let scenario: Scenario = input::parse_complete(CHECKPOINTED, "chain").expect("it is valid").scenario;
    let every = Every::Events(NonZeroU64::new(5).expect("5 is not 0"));
    let Ok(mut checkpoints) = Checkpoints::resume(&folder.join("run"), &scenario, Some(every)) else {
        return;
    };
    let storage = Storage { checkpoints: Some(&mut checkpoints), columns: None };
    drop(run_with(&scenario, storage, &mut Patience(questions)));
}

/// A checkpoint whose checksum is right, whatever is in it.
pub fn checkpoint(bytes: &[u8]) {
    let folder = folder();
    let body = bytes.split_last_chunk::<4>().map_or(bytes, |(body, _)| body);
    let whole = [body, &crc32fast::hash(body).to_le_bytes()].concat();
    fs::write(folder.path().join("run.checkpoint.0"), whole).expect("the checkpoint is written");
    resume(folder.path(), 20);
}

/// Parameters of distributions: the number of the family, and the bits of two numbers; a second group makes a mixture.
pub fn law(bytes: &[u8]) {
    let mut laws: Vec<Law> = bytes.chunks_exact(17).take(2).filter_map(parametric).collect();
    if let [first, second] = &laws[..] {
        let part = |law: &Law| Component { weight: 0.5, law: law.clone() };
        laws.push(Law::Mixture(vec![part(first), part(second)]));
    }
    for law in laws {
        let Ok(built) = law.build() else { continue };
        let mean = built.mean();
        assert!(mean >= 0.0, "{law:?}: the mean is {mean}");
        let mut before = 1.0;
        for x in [0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 10.0].map(|x| x * mean) {
            let (survival, density, hazard) = (built.survival(x), built.density(x), built.hazard(x));
            assert!((0.0..=before).contains(&survival), "{law:?}: S({x}) = {survival} after {before}");
            assert!(density >= 0.0 && hazard >= 0.0, "{law:?}: p({x}) = {density}, P = {hazard}");
            before = survival;
        }
        for p in [0.0, 1e-12, 0.25, 0.5, 0.75, 1.0] {
            let quantile = built.quantile(p);
            assert!(quantile >= 0.0, "{law:?}: the quantile of {p} is {quantile}");
        }
    }
}

/// The distribution of a family by its number and two numbers.
fn parametric(bytes: &[u8]) -> Option<Law> {
    let (family, numbers) = bytes.split_first()?;
    let number = |at: usize| Some(f64::from_le_bytes(numbers.get(8 * at..8 * at + 8)?.try_into().ok()?));
    let (a, b) = (number(0)?, number(1)?);
    Some(match family % 7 {
        0 => Law::Gaussian { mean: a, std: b },
        1 => Law::Gamma { mean: a, std: b },
        2 => Law::Lognormal { mean: a, std: b },
        3 => Law::Rectangular { min: a, max: b },
        4 => Law::Weibull { shape: a, scale: b },
        5 => Law::Exponential { mean: a },
        _ => Law::Point { at: a },
    })
}
