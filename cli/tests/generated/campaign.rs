//! Cases judged one after the other, on as many threads as there are.

use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

use super::agreement::{Deviations, ERRORS};
use super::child;
use super::prediction;
use super::scenario::Case;
use super::verdict::{self, Verdict};

/// What is done with a case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Task {
    /// It is checked.
    Check,
    /// It is checked and, if accepted, run.
    Run,
}

/// What came of cases.
#[derive(Debug, Default)]
pub struct Count {
    /// Accepted by a check.
    pub accepted: usize,
    /// Refused by it.
    pub refused: usize,
    /// Run to the end.
    pub run: usize,
    /// Refused by a run, with a reason.
    pub stopped: usize,
    /// Seconds of the processor.
    pub seconds: f64,
    /// Where there were both, how far the master equation was from an ensemble.
    pub deviations: Deviations,
    /// What should not have happened.
    pub failures: Vec<String>,
}

impl Count {
    /// Adds others.
    pub fn add(&mut self, other: Self) {
        self.accepted += other.accepted;
        self.refused += other.refused;
        self.run += other.run;
        self.stopped += other.stopped;
        self.seconds += other.seconds;
        self.deviations.add(other.deviations);
        self.failures.extend(other.failures);
    }

    /// Fails with the list of what should not have happened.
    pub fn assert_none_failed(&self) {
        assert!(self.failures.is_empty(), "{self}\n{}", self.failures.join("\n"));
    }

    fn failed(&mut self, case: &Case, command: &str, verdict: &Verdict) {
        if verdict.failures.is_empty() {
            return;
        }
        keep(case, verdict);
        let (number, reasons) = (case.number, verdict.failures.join("; "));
        let failure = format!("{command} of case {number}: {reasons} (again: make fuzz CASE={number})");
        println!("{failure}");
        self.failures.push(failure);
    }
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { accepted, refused, run, stopped, seconds, .. } = self;
        let (failed, both, most) = (self.failures.len(), self.deviations.len(), self.deviations.largest());
        write!(
            f,
            "{accepted} accepted, {refused} refused, {run} run, {stopped} stopped with a reason, {failed} failed, {seconds:.0} s; "
        )?;
        write!(f, "{both} beside an ensemble, {most:.2} standard errors apart at most")
    }
}

/// Cases that are known to fail, with the reason beside each in the file.
pub fn known() -> BTreeSet<u64> {
    let lines = include_str!("known.txt").lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    lines.map(|line| line.split_whitespace().next().and_then(|n| n.parse().ok()).expect("a number")).collect()
}

/// Judges all cases.
pub fn judge(cases: &[Case], task: Task) -> Count {
    let mut count = Count::default();
    child::shared(cases, |case| Some(judged(case, task))).into_iter().for_each(|one| count.add(one));
    count.failures.sort();
    count
}

fn judged(case: &Case, task: Task) -> Count {
    let [folder, aside] = [(); 2].map(|()| tempfile::tempdir().expect("a folder"));
    std::fs::write(folder.path().join("scenario.toml"), case.text()).expect("the scenario is written");
    let mut count = Count::default();
    let check = verdict::check(folder.path(), aside.path(), prediction::CHECK);
    count.seconds += check.ended.seconds;
    count.failed(case, "check", &check);
    if !check.accepted {
        count.refused += 1;
        return count;
    }
    count.accepted += 1;
    if task == Task::Run {
        let run = verdict::run(folder.path(), aside.path(), prediction::run(case), "--quiet");
        count.seconds += run.ended.seconds;
        count.failed(case, "run", &run);
        if run.accepted {
            count.run += 1
        } else {
            count.stopped += 1
        }
        // Thresholds that are kept for ever are none of the master equation.
        if let Some(deviation) = run.deviation.filter(|_| !case.has("ensemble.disorder = quenched")) {
            count.deviations.note(case.number, deviation);
            if deviation.is_nan() || deviation > ERRORS {
                let apart = format!("{deviation:.1} standard errors between master equation and ensemble");
                count.failed(case, "run", &Verdict { failures: vec![apart], ..run });
            }
        }
    }
    count
}

/// Writes what failed to `target/fuzz`, for whoever looks into it.
fn keep(case: &Case, verdict: &Verdict) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("../fuzz");
    let reasons: String = verdict.failures.iter().map(|reason| format!("# {reason}\n")).collect();
    let write = || {
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join(format!("{}.toml", case.number)), format!("{reasons}{}", case.text()))
    };
    write().unwrap_or_else(|error: std::io::Error| println!("{}: {error}", folder.display()));
}
