//! The watcher of a long computation: it hears how far the work is and may stop it.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::ThreadId;

use crate::{Error, Result};

/// Bytes that a computation may take where nothing else is said: 16 GiB.
pub const MEMORY: u64 = 16 << 30;

/// Hears the fraction done, answers whether to go on.
///
/// Progress bars, Ctrl-C, limits of time and memory and checkpoints are monitors; `()` watches nothing.
pub trait Monitor: Send {
    /// Called now and then with the fraction of the work done, in `[0, 1]`, never decreasing.
    fn progress(&mut self, fraction: f64) -> ControlFlow<()>;

    /// Called, by what goes from event to event, with the number of events so far and the drive.
    fn events(&mut self, _events: u64, _drive: f64) {}

    /// Bytes that the computation may take; what would take more is refused, as far as that is known before.
    fn memory(&self) -> u64 {
        MEMORY
    }
}

impl Monitor for () {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Tells another monitor of work aside, by which nothing of the whole gets done.
pub struct Aside<'a> {
    /// The fraction of the whole that is done.
    pub fraction: f64,
    /// Who hears of the whole.
    pub monitor: &'a mut dyn Monitor,
}

impl Monitor for Aside<'_> {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        self.monitor.progress(self.fraction)
    }

    fn memory(&self) -> u64 {
        self.monitor.memory()
    }
}

/// Tells another monitor of a part of its work as a part of the whole.
pub struct Part<'a> {
    whole: &'a mut dyn Monitor,
    start: f64,
    share: f64,
}

impl<'a> Part<'a> {
    /// The part of the work that begins at fraction `start` and is the fraction `share` of it.
    pub fn new(whole: &'a mut dyn Monitor, start: f64, share: f64) -> Self {
        Self { whole, start, share }
    }
}

impl Monitor for Part<'_> {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.whole.progress(self.start + self.share * fraction)
    }

    fn memory(&self) -> u64 {
        self.whole.memory()
    }
}

/// A monitor for functions that are evaluated again and again in loops which adapt to them.
///
/// Once the monitor has asked to stop, such a function is to return 0, at which every loop of that kind ends at once. Who
/// began the loop calls [`Watch::check`] after it, so that no such result is seen.
pub(crate) struct Watch<'a> {
    monitor: Mutex<&'a mut dyn Monitor>,
    /// The thread that asks. Python hears Ctrl-C on its main thread alone: others look at what that one was told.
    asking: ThreadId,
    stopped: AtomicBool,
}

impl<'a> Watch<'a> {
    /// Asks `monitor`, on this thread.
    pub(crate) fn new(monitor: &'a mut dyn Monitor) -> Self {
        let asking = std::thread::current().id();
        Self { monitor: Mutex::new(monitor), asking, stopped: AtomicBool::new(false) }
    }

    /// Asks whether to stop. The fraction that is told is 0: how many evaluations there will be is not known.
    pub(crate) fn stops(&self) -> bool {
        let told = self.stopped.load(Ordering::Relaxed);
        if told || std::thread::current().id() != self.asking {
            return told;
        }
        let mut monitor = self.monitor.lock().unwrap_or_else(PoisonError::into_inner);
        let stops = monitor.progress(0.0).is_break();
        self.stopped.store(stops, Ordering::Relaxed);
        stops
    }

    /// What a function returns that is evaluated again and again.
    pub(crate) fn value<T: Default>(&self, of: impl FnOnce() -> T) -> T {
        if self.stops() { T::default() } else { of() }
    }

    /// [`Error::Stopped`] if the monitor has asked to stop.
    pub(crate) fn check(&self) -> Result<()> {
        if self.stops() { Err(Error::Stopped) } else { Ok(()) }
    }

    /// Calls `each` with the numbers below `count`, on all threads, as long as the monitor does not ask to stop. This thread
    /// works, too, since it asks only between pieces of its own work.
    pub(crate) fn share(&self, count: usize, each: impl Fn(usize) + Sync) {
        let next = AtomicUsize::new(0);
        let work = || {
            while !self.stops() {
                let number = next.fetch_add(1, Ordering::Relaxed);
                if number >= count {
                    return;
                }
                each(number);
            }
        };
        rayon::in_place_scope(|scope| {
            for _ in 1..rayon::current_num_threads().min(count) {
                scope.spawn(|_| work());
            }
            work();
        });
    }
}

/// Refuses `what` is asked for under `key` if it needs more bytes than allowed.
pub(crate) fn fits(key: &str, what: impl Into<String>, needed: u64, allowed: u64) -> Result<()> {
    if needed <= allowed {
        return Ok(());
    }
    Err(Error::TooLarge { key: key.into(), what: what.into(), needed, allowed })
}

/// Asks `monitor` whether to go on, as a `Result` for use with `?`.
pub(crate) fn report(monitor: &mut dyn Monitor, fraction: f64) -> Result<()> {
    match monitor.progress(fraction) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Stopped),
    }
}
