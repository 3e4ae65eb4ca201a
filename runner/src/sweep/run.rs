//! Computation of the cases of a plan on all threads: each thread takes the next case, and passes on what it has every 0.2 s.
//!
//! Threads share the memory. Cases that need more than a thread may take are computed last, one after the other with all of it,
//! so that results do not depend on the number of threads.

use std::ops::ControlFlow;
use std::str::FromStr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use asperity::monitor::Monitor;

use super::case::{self, Case};
use super::error::{Error, Result};
use super::plan::Plan;
use super::store::Store;

/// The least work of which the results are stored together.
const BATCH: Duration = Duration::from_millis(200);
/// The largest number of values of curves that wait until they are stored, 16 MB.
const VALUES: usize = 2_000_000;

/// A part of the cases: each `of`th, from the one with this index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// From 1 on.
    pub index: usize,
    /// Number of parts.
    pub of: usize,
}

impl Part {
    /// All cases.
    pub const ALL: Self = Self { index: 1, of: 1 };

    /// Whether a case belongs to the part.
    pub fn has(self, case: usize) -> bool {
        case % self.of == self.index - 1
    }
}

impl FromStr for Part {
    type Err = String;

    /// Parses `I/N`.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let number = |text: &str| text.trim().parse().ok().filter(|&number: &usize| number > 0);
        let parts = text.split_once('/').and_then(|(index, of)| Some((number(index)?, number(of)?)));
        match parts {
            Some((index, of)) if index <= of => Ok(Self { index, of }),
            _ => Err("expected I/N, the part I from 1 to N of N".into()),
        }
    }
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}-of-{}", self.index, self.of)
    }
}

/// Computes the cases with these numbers, and stores them as they are finished. `before` is the number of those of the same part
/// that were stored already.
///
/// # Errors
/// A stop by the monitor; cases that cannot be stored.
pub fn run(
    plan: &Plan,
    cases: &[usize],
    before: usize,
    store: &mut Store,
    monitor: &mut dyn Monitor,
) -> Result<()> {
    let sink = Mutex::new((store, None));
    let keep = |cases: &[Case]| {
        let mut sink = sink.lock().unwrap_or_else(PoisonError::into_inner);
        let failure = sink.0.add(cases).err();
        let failed = failure.is_some();
        sink.1 = sink.1.take().or(failure);
        if failed { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let computed = share(plan, cases, before, &keep, monitor);
    let failure = sink.into_inner().unwrap_or_else(PoisonError::into_inner).1;
    failure.map_or(computed.map_err(Error::from), Err)
}

/// Computes the cases with these numbers.
///
/// # Errors
/// A stop by the monitor.
pub fn compute(plan: &Plan, cases: &[usize], monitor: &mut dyn Monitor) -> asperity::Result<Vec<Case>> {
    let found = Mutex::new(Vec::new());
    let keep = |cases: &[Case]| {
        found.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(cases);
        ControlFlow::Continue(())
    };
    share(plan, cases, 0, &keep, monitor)?;
    let mut found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    found.sort_by_key(|case| case.number);
    Ok(found)
}

/// What the threads have in common.
struct Shared<'a> {
    plan: &'a Plan,
    cases: &'a [usize],
    before: usize,
    next: AtomicUsize,
    done: AtomicUsize,
    stopped: AtomicBool,
    /// What all threads may take.
    memory: u64,
    /// Cases that need more than one of them may take.
    large: Mutex<Vec<usize>>,
}

/// The monitor of one case.
struct Watch<'a, 'b> {
    shared: &'a Shared<'a>,
    /// The monitor of the whole, on the thread that started the work.
    whole: Option<&'a mut (dyn Monitor + 'b)>,
    memory: u64,
}

impl Monitor for Watch<'_, '_> {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        let Shared { before, cases, .. } = *self.shared;
        let done = before as f64 + self.shared.done.load(Ordering::Relaxed) as f64;
        if let Some(whole) = &mut self.whole {
            let all = (before + cases.len()) as f64;
            if whole.progress(((done + fraction) / all).min(1.0)).is_break() {
                self.shared.stopped.store(true, Ordering::Relaxed);
            }
        }
        if self.shared.stopped.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    fn memory(&self) -> u64 {
        self.memory
    }
}

fn share(
    plan: &Plan,
    cases: &[usize],
    before: usize,
    keep: &(dyn Fn(&[Case]) -> ControlFlow<()> + Sync),
    monitor: &mut dyn Monitor,
) -> asperity::Result<()> {
    let threads = rayon::current_num_threads().min(cases.len());
    let large = share_on(threads, plan, (cases, before), keep, monitor)?;
    if large.is_empty() {
        return Ok(());
    }
    let before = before + cases.len() - large.len();
    share_on(1, plan, (&large, before), keep, monitor).map(|_| ())
}

/// The same on these threads. Returns the cases that need more memory than one of them may take.
fn share_on(
    threads: usize,
    plan: &Plan,
    (cases, before): (&[usize], usize),
    keep: &(dyn Fn(&[Case]) -> ControlFlow<()> + Sync),
    monitor: &mut dyn Monitor,
) -> asperity::Result<Vec<usize>> {
    let whole = monitor.memory();
    let shared = Shared {
        plan,
        cases,
        before,
        next: AtomicUsize::new(0),
        done: AtomicUsize::new(0),
        stopped: AtomicBool::new(false),
        memory: whole,
        large: Mutex::default(),
    };
    let memory = whole / threads.max(1) as u64;
    rayon::in_place_scope(|scope| {
        for _ in 1..threads {
            scope.spawn(|_| shared.work(keep, Watch { shared: &shared, whole: None, memory }));
        }
        shared.work(keep, Watch { shared: &shared, whole: Some(monitor), memory });
    });
    if shared.stopped.load(Ordering::Relaxed) {
        return Err(asperity::Error::Stopped);
    }
    let mut large = shared.large.into_inner().unwrap_or_else(PoisonError::into_inner);
    large.sort_unstable();
    Ok(large)
}

impl Shared<'_> {
    /// Takes cases until there are none left, and passes them on in batches.
    fn work(&self, keep: &(dyn Fn(&[Case]) -> ControlFlow<()> + Sync), mut monitor: Watch<'_, '_>) {
        let (mut batch, mut began) = (Vec::new(), Instant::now());
        let each: usize = self.plan.places().iter().sum();
        while !self.stopped.load(Ordering::Relaxed) {
            let Some(&number) = self.cases.get(self.next.fetch_add(1, Ordering::Relaxed)) else { break };
            let scenario = self.plan.case(number);
            match case::compute(number, scenario, &self.plan.keep, self.memory, &mut monitor) {
                Ok(case) => batch.push(case),
                Err(asperity::Error::TooLarge { .. }) => {
                    self.large.lock().unwrap_or_else(PoisonError::into_inner).push(number);
                    continue;
                }
                // A case that was stopped is not one that failed.
                Err(_) => break,
            }
            self.done.fetch_add(1, Ordering::Relaxed);
            let _ = monitor.progress(0.0);
            if began.elapsed() >= BATCH || batch.len() * each >= VALUES {
                if keep(&batch).is_break() {
                    self.stopped.store(true, Ordering::Relaxed);
                }
                batch.clear();
                began = Instant::now();
            }
        }
        if keep(&batch).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_each_case_once() {
        let parts: Vec<Part> = ["1/3", "2/3", "3/3"].iter().map(|part| part.parse().unwrap()).collect();
        assert!((0..20).all(|case| parts.iter().filter(|part| part.has(case)).count() == 1));
        assert_eq!(parts[1].to_string(), "2-of-3");
        for wrong in ["0/3", "4/3", "3", "a/b", "1/0", ""] {
            assert!(wrong.parse::<Part>().is_err(), "{wrong}");
        }
    }
}
