//! Monitors of long computations: they receive progress and may stop the work.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::ThreadId;
use std::time::Duration;

use crate::{Error, Result};

/// Default limit of memory in bytes: 16 GiB.
pub const MEMORY: u64 = 16 << 30;

/// Pieces of work of which adaptive methods do more or fewer, as their control decides: a cost that depends on no clock and on no
/// number of threads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Cost {
    /// Cells of the Legendre series of a life.
    LifeCells,
    /// Cohorts that are added up to a life at a velocity.
    LifeCohorts,
    /// Cells of a solution of a Volterra equation.
    VolterraCells,
    /// Cells of it that were too wide.
    RejectedVolterraCells,
    /// Steps of TR-BDF2.
    Steps,
    /// Steps of it that were tried and repeated with a shorter duration.
    RejectedSteps,
    /// Steps of the transport of cohorts.
    TransportSteps,
    /// Steps of it that were tried and repeated with a shorter duration.
    RejectedTransportSteps,
    /// Cohorts moved in all of these steps.
    TransportedCohorts,
    /// Evaluations of the forces of all cells of an interface.
    Residuals,
}

/// Receives the fraction of work done, and decides whether to go on.
///
/// Progress bars, Ctrl-C, limits of time and memory and checkpoints are monitors; `()` monitors nothing. Computations that are
/// started by hand have two forms: `pull(20.0)` has the default tolerance and no monitor, `pull_with` takes both.
///
/// ```
/// use std::ops::ControlFlow;
/// use asperity::monitor::Monitor;
///
/// struct StopAtOnce;
///
/// impl Monitor for StopAtOnce {
///     fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
///         ControlFlow::Break(())
///     }
/// }
///
/// # use std::sync::Arc;
/// # use asperity::contacts::{Contacts, Initial};
/// # use asperity::law::{Gaussian, Point};
/// # let contacts = Contacts::new(Arc::new(Gaussian::new(1.0, 0.1)?), Arc::new(Point::new(0.0)?));
/// # use asperity::master::MasterEquation;
/// let equation = MasterEquation::new(contacts, &Initial::default())?;
/// let stopped = equation.pull_with(1000.0, 1e-10, &mut StopAtOnce);
/// assert!(matches!(stopped, Err(asperity::Error::Stopped)));
/// # Ok::<(), asperity::Error>(())
/// ```
pub trait Monitor: Send {
    /// Called now and then with the fraction of the work done, in `[0, 1]`, never decreasing.
    fn progress(&mut self, fraction: f64) -> ControlFlow<()>;

    /// Called by event-driven computations, with the number of events so far and the drive.
    fn events(&mut self, _events: u64, _drive: f64) {}

    /// Called where adaptive methods have done pieces of work, on any thread; the sums do not depend on the number of threads.
    fn cost(&mut self, _cost: Cost, _pieces: usize) {}

    /// Bytes that the computation may use; a job known to need more is refused.
    fn memory(&self) -> u64 {
        MEMORY
    }

    /// The time since some moment, from which computations see how often they ask. Without a clock it stands still, and they
    /// ask seldom.
    fn clock(&self) -> Duration {
        since_first_asked()
    }
}

/// The time since this was first called; 0 in WebAssembly, which has no clock of its own.
fn since_first_asked() -> Duration {
    #[cfg(not(target_family = "wasm"))]
    {
        static BEGUN: OnceLock<std::time::Instant> = OnceLock::new();
        BEGUN.get_or_init(std::time::Instant::now).elapsed()
    }
    #[cfg(target_family = "wasm")]
    Duration::ZERO
}

impl Monitor for () {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Forwards to `monitor` without advancing its progress.
pub struct Aside<'a> {
    /// The fraction of the whole that is done.
    pub fraction: f64,
    /// The monitor of the whole.
    pub monitor: &'a mut dyn Monitor,
}

impl std::fmt::Debug for Aside<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Aside").field("fraction", &self.fraction).finish_non_exhaustive()
    }
}

impl Monitor for Aside<'_> {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        self.monitor.progress(self.fraction)
    }

    fn cost(&mut self, cost: Cost, pieces: usize) {
        self.monitor.cost(cost, pieces);
    }

    fn memory(&self) -> u64 {
        self.monitor.memory()
    }

    fn clock(&self) -> Duration {
        self.monitor.clock()
    }
}

/// Forwards the progress of a preparation, such as a table, as a first part of the work once it takes long: of one that takes no
/// time nothing counts as done.
pub(crate) struct Preparation<'a> {
    monitor: &'a mut dyn Monitor,
    began: Duration,
    done: f64,
}

impl<'a> Preparation<'a> {
    /// The part of the work that a long preparation counts as.
    const SHARE: f64 = 0.5;
    /// The time from which on it is long.
    const LONG: Duration = Duration::from_secs(1);

    /// A preparation that begins now.
    pub(crate) fn new(monitor: &'a mut dyn Monitor) -> Self {
        let began = monitor.clock();
        Self { monitor, began, done: 0.0 }
    }

    /// The part of the work that is left.
    pub(crate) fn rest(self) -> Part<'a> {
        Part::new(self.monitor, self.done, 1.0 - self.done)
    }
}

impl Monitor for Preparation<'_> {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        if self.monitor.clock().saturating_sub(self.began) >= Self::LONG {
            self.done = self.done.max(Self::SHARE * fraction);
        }
        self.monitor.progress(self.done)
    }

    fn cost(&mut self, cost: Cost, pieces: usize) {
        self.monitor.cost(cost, pieces);
    }

    fn memory(&self) -> u64 {
        self.monitor.memory()
    }

    fn clock(&self) -> Duration {
        self.monitor.clock()
    }
}

/// Forwards progress that may go back, because work is repeated, as its running maximum.
pub(crate) struct Rising<'a> {
    most: f64,
    monitor: &'a mut dyn Monitor,
}

impl<'a> Rising<'a> {
    pub(crate) fn new(monitor: &'a mut dyn Monitor) -> Self {
        Self { most: 0.0, monitor }
    }
}

impl Monitor for Rising<'_> {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.most = self.most.max(fraction.min(1.0));
        self.monitor.progress(self.most)
    }

    fn events(&mut self, events: u64, drive: f64) {
        self.monitor.events(events, drive);
    }

    fn cost(&mut self, cost: Cost, pieces: usize) {
        self.monitor.cost(cost, pieces);
    }

    fn memory(&self) -> u64 {
        self.monitor.memory()
    }

    fn clock(&self) -> Duration {
        self.monitor.clock()
    }
}

/// Up to where a part of the work reports its progress, of its share. A part of the share 1/n that begins at k/n ends, by rounding,
/// now and then above (k + 1)/n, where the next one begins: progress would fall by its last digit.
const SHORT: f64 = 1.0 - 1e-9;

/// Forwards the progress of a part of the work as progress of the whole.
pub struct Part<'a> {
    whole: &'a mut dyn Monitor,
    start: f64,
    share: f64,
}

impl std::fmt::Debug for Part<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Part").field("start", &self.start).field("share", &self.share).finish_non_exhaustive()
    }
}

impl<'a> Part<'a> {
    /// The part of the work that begins at fraction `start` and is the fraction `share` of it.
    pub fn new(whole: &'a mut dyn Monitor, start: f64, share: f64) -> Self {
        Self { whole, start, share }
    }
}

impl Monitor for Part<'_> {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.whole.progress(self.start + self.share * SHORT * fraction)
    }

    fn cost(&mut self, cost: Cost, pieces: usize) {
        self.whole.cost(cost, pieces);
    }

    fn memory(&self) -> u64 {
        self.whole.memory()
    }

    fn clock(&self) -> Duration {
        self.whole.clock()
    }
}

/// A monitor for functions that are evaluated many times in adaptive loops, and on many threads.
///
/// Once the monitor has stopped the work, such a function must return 0, at which every adaptive loop ends at
/// once. The caller of the loop then calls [`Watch::check`], so that no such result is used.
pub(crate) struct Watch<'a> {
    monitor: Mutex<&'a mut dyn Monitor>,
    /// The thread that calls the monitor. Python receives Ctrl-C on its main thread only; other threads use
    /// the result of its last call.
    calling: ThreadId,
    stopped: AtomicBool,
    /// The bits of the fraction done, as far as it is known. Positive numbers are in the order of their bits.
    done: AtomicU64,
}

impl<'a> Watch<'a> {
    /// A watch that calls `monitor` on this thread.
    pub(crate) fn new(monitor: &'a mut dyn Monitor) -> Self {
        let calling = std::thread::current().id();
        Self {
            monitor: Mutex::new(monitor),
            calling,
            stopped: AtomicBool::new(false),
            done: AtomicU64::new(0),
        }
    }

    /// Sets the fraction done, unless it was larger before; it stays 0 where the number of evaluations is
    /// unknown.
    pub(crate) fn done(&self, fraction: f64) {
        self.done.fetch_max(fraction.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
    }

    /// Whether to stop.
    pub(crate) fn stops(&self) -> bool {
        let stopped = self.stopped.load(Ordering::Relaxed);
        if stopped || std::thread::current().id() != self.calling {
            return stopped;
        }
        // A panic of another thread leaves the monitor itself intact.
        let mut monitor = self.monitor.lock().unwrap_or_else(PoisonError::into_inner);
        let stops = monitor.progress(f64::from_bits(self.done.load(Ordering::Relaxed))).is_break();
        self.stopped.store(stops, Ordering::Relaxed);
        stops
    }

    /// Reports pieces of work, from any thread.
    pub(crate) fn cost(&self, cost: Cost, pieces: usize) {
        self.monitor.lock().unwrap_or_else(PoisonError::into_inner).cost(cost, pieces);
    }

    /// The value of a function that is evaluated many times.
    pub(crate) fn value<T: Default>(&self, of: impl FnOnce() -> T) -> T {
        if self.stops() { T::default() } else { of() }
    }

    /// [`Error::Stopped`] if the monitor has stopped the work.
    pub(crate) fn check(&self) -> Result<()> {
        if self.stops() { Err(Error::Stopped) } else { Ok(()) }
    }

    /// The same in a loop over cells, each of which takes some microseconds: asks at every sixteenth.
    pub(crate) fn check_at(&self, cell: usize) -> Result<()> {
        if cell.is_multiple_of(16) { self.check() } else { Ok(()) }
    }

    /// Computes `each`(number) for all numbers below `count` on all threads, each with its own `tools`;
    /// returns the results in order. The calling thread works, too, since it calls the monitor only between
    /// pieces of its own work.
    ///
    /// # Errors
    /// Stopped by the monitor.
    pub(crate) fn share<R, T: Send + Sync>(
        &self,
        count: usize,
        tools: impl Fn() -> R + Sync,
        each: impl Fn(&mut R, usize) -> T + Sync,
    ) -> Result<Vec<T>> {
        // Threads take numbers from a common counter, which balances pieces of different cost. Results are
        // stored by number, so that their order does not depend on the threads.
        let next = AtomicUsize::new(0);
        let made: Vec<OnceLock<T>> = (0..count).map(|_| OnceLock::new()).collect();
        let work = || {
            let mut tools = tools();
            while !self.stops() {
                let number = next.fetch_add(1, Ordering::Relaxed);
                let Some(place) = made.get(number) else { return };
                place.get_or_init(|| each(&mut tools, number));
            }
        };
        crate::parallel::in_place_scope(|scope| {
            for _ in 1..crate::parallel::current_num_threads().min(count) {
                scope.spawn(|_| work());
            }
            work();
        });
        made.into_iter().map(OnceLock::into_inner).collect::<Option<_>>().ok_or(Error::Stopped)
    }
}

/// Forwards to the watched monitor; progress is that of the whole.
impl Monitor for &Watch<'_> {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        if self.stops() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn cost(&mut self, cost: Cost, pieces: usize) {
        Watch::cost(self, cost, pieces);
    }

    fn memory(&self) -> u64 {
        self.monitor.lock().unwrap_or_else(PoisonError::into_inner).memory()
    }

    fn clock(&self) -> Duration {
        self.monitor.lock().unwrap_or_else(PoisonError::into_inner).clock()
    }
}

/// A watch as the monitor of a first part of the work: the fraction that it has done is that of the watch.
pub(crate) struct Counted<'a, 'b>(pub(crate) &'a Watch<'b>);

impl Monitor for Counted<'_, '_> {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.0.done(fraction);
        if self.0.stops() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn cost(&mut self, cost: Cost, pieces: usize) {
        self.0.cost(cost, pieces);
    }

    fn memory(&self) -> u64 {
        self.0.monitor.lock().unwrap_or_else(PoisonError::into_inner).memory()
    }

    fn clock(&self) -> Duration {
        self.0.monitor.lock().unwrap_or_else(PoisonError::into_inner).clock()
    }
}

/// Refuses a job that needs more bytes than allowed.
pub(crate) fn fits(key: &str, what: impl Into<String>, needed: u64, allowed: u64) -> Result<()> {
    if needed <= allowed {
        return Ok(());
    }
    Err(Error::TooLarge { key: key.into(), what: what.into(), needed, allowed })
}

/// Reports progress to `monitor`. Returns [`Error::Stopped`] if it stops the work, for use with `?`.
pub(crate) fn report(monitor: &mut dyn Monitor, fraction: f64) -> Result<()> {
    match monitor.progress(fraction) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Stopped),
    }
}

/// The same before step `i` of a loop of `count` cheap steps: reports at every 65 536th, some milliseconds apart.
pub(crate) fn report_at(monitor: &mut dyn Monitor, i: usize, count: usize) -> Result<()> {
    if i.is_multiple_of(1 << 16) { report(monitor, i as f64 / count as f64) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Progress that has never fallen so far.
    #[derive(Default)]
    struct NeverFalling(f64);

    impl Monitor for NeverFalling {
        fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
            assert!((self.0..=1.0).contains(&fraction), "{fraction} after {}", self.0);
            self.0 = fraction;
            ControlFlow::Continue(())
        }
    }

    /// Begins of parts are computed as k/n and as k (1/n), which differ by rounding.
    #[test]
    fn parts_in_a_row_never_fall() {
        for parts in 1..300_u32 {
            let share = 1.0 / f64::from(parts);
            let begins: [fn(f64, f64) -> f64; 2] = [|k, n| k / n, |k, n| k * (1.0 / n)];
            for begin in begins {
                let mut whole = NeverFalling::default();
                for part in 0..parts {
                    let start = begin(f64::from(part), f64::from(parts));
                    for fraction in [0.0, 0.5, 1.0] {
                        assert!(Part::new(&mut whole, start, share).progress(fraction).is_continue());
                    }
                }
                // The last part ends at 1 but for what parts leave out.
                assert!(whole.0 >= SHORT);
            }
        }
    }
}
