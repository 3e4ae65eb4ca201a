//! A monitor that notes how often it is asked.
#![allow(dead_code)]

use std::ops::ControlFlow;
use std::time::Duration;

use asperity::Error;
use asperity::monitor::Monitor;
use cpu_time::ThreadTime;

/// CPU time between two questions, at most, in units of that of [`reference`]: 0.2 s where this takes 25 ms.
pub const MOST: f64 = 8.0;

/// Terms of the sum of [`reference`].
const REFERENCE_TERMS: u32 = 8_000_000;

/// CPU time after which a computation is asked to stop.
const LIMIT: Duration = Duration::from_millis(500);

/// Notes the longest time between two questions.
struct Patience {
    begun: Duration,
    last: Duration,
    longest: Duration,
    questions: usize,
    asked_to_stop: bool,
}

/// CPU time of this thread.
fn now() -> Duration {
    ThreadTime::now().as_duration()
}

impl Patience {
    fn new() -> Self {
        Self { begun: now(), last: now(), longest: Duration::ZERO, questions: 0, asked_to_stop: false }
    }

    fn note(&mut self) {
        self.longest = self.longest.max(now() - self.last);
        self.last = now();
    }
}

impl Monitor for Patience {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        self.note();
        self.questions += 1;
        self.asked_to_stop = now() - self.begun > LIMIT;
        if self.asked_to_stop { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// CPU time of a fixed computation. Limits are multiples of it, since the same work takes longer on a slower machine, or beside
/// other work on the same processor.
fn reference() -> Duration {
    let begun = now();
    let sum: f64 = (1..REFERENCE_TERMS).map(|i| (-1e-9 * f64::from(i)).exp().sqrt()).sum();
    // The sum is used, so that it is not left out: its terms are between 0.99 and 1.
    assert!(sum > 0.9 * f64::from(REFERENCE_TERMS));
    now() - begun
}

/// All work on one thread, of which the CPU time is known whatever else the machine does.
pub fn alone<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap().install(work)
}

/// Lets one computation go on for as long as it may; whether it was done then.
pub fn patient(name: &str, work: impl FnOnce(&mut dyn Monitor) -> asperity::Result<()>) -> bool {
    patient_within(MOST, name, work)
}

/// The same with another longest time between two questions, in units of that of [`reference`].
pub fn patient_within(
    most: f64,
    name: &str,
    work: impl FnOnce(&mut dyn Monitor) -> asperity::Result<()>,
) -> bool {
    let before = reference();
    let mut patience = Patience::new();
    let outcome = work(&mut patience);
    // What it takes to stop counts, too.
    patience.note();
    let (longest, questions, taken) = (patience.longest, patience.questions, now() - patience.begun);
    let most = before.max(reference()).mul_f64(most);
    assert!(
        longest < most,
        "{name}: nobody was asked for {longest:?} of {taken:?}, at most {most:?} expected"
    );
    match outcome {
        Err(Error::Stopped) => assert!(patience.asked_to_stop, "{name}: it stopped unasked"),
        Err(error) => panic!("{name}: {error}"),
        Ok(()) => assert!(questions > 0, "{name}: it never asks"),
    }
    !patience.asked_to_stop
}
