//! The monitor of long computations: Ctrl-C and progress, while other Python threads run.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::time::{Duration, Instant};

use asperity::monitor::Monitor;
use asperity::{Error, Result};
use asperity_runner::memory;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;

use crate::argument::Whole;
use crate::{error, threads};

/// Interval between two checks for signals, and between two reports of progress.
const PERIOD: Duration = Duration::from_millis(20);

struct Watch {
    progress: Option<Py<PyAny>>,
    /// Bytes that the computation may take; those that are free if none is given.
    memory: Option<u64>,
    called: Instant,
    /// The largest fraction so far, so that repeated work does not lower the reported progress.
    most: f64,
    raised: Option<PyErr>,
}

impl Watch {
    fn check(&self, fraction: f64) -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            self.progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (fraction,)).map(drop))
        })
    }
}

impl Monitor for Watch {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        if self.raised.is_some() {
            return ControlFlow::Break(());
        }
        if self.called.elapsed() < PERIOD {
            return ControlFlow::Continue(());
        }
        self.most = self.most.max(fraction);
        self.raised = self.check(self.most).err();
        self.called = Instant::now();
        if self.raised.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn memory(&self) -> u64 {
        self.memory.unwrap_or_else(memory::available)
    }
}

/// The monitor of work on other threads. This thread, on which Python hears of signals, calls the watch for it.
struct Relay<'a> {
    /// The bits of the fraction done.
    done: &'a AtomicU64,
    stop: &'a AtomicBool,
    memory: Option<u64>,
}

impl Monitor for Relay<'_> {
    fn progress(&mut self, fraction: f64) -> ControlFlow<()> {
        self.done.store(fraction.to_bits(), Ordering::Relaxed);
        if self.stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn memory(&self) -> u64 {
        self.memory.unwrap_or_else(memory::available)
    }
}

/// Runs `work` on so many threads of its own. `stop` is set as soon as it is to end.
fn on_threads<T: Send>(
    number: usize,
    stop: &AtomicBool,
    watch: &mut Watch,
    work: impl FnOnce(&mut dyn Monitor) -> Result<T> + Send,
) -> PyResult<Result<T>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(number).build();
    let pool = pool.map_err(|refused| PyRuntimeError::new_err(format!("threads: {refused}")))?;
    let done = AtomicU64::new(0);
    let mut relay = Relay { done: &done, stop, memory: watch.memory };
    let (send, receive) = mpsc::sync_channel(1);
    pool.in_place_scope(|scope| {
        // A panic drops the sender, and goes on where the scope ends.
        scope.spawn(move |_| drop(send.send(work(&mut relay))));
        let outcome = loop {
            match receive.recv_timeout(PERIOD) {
                Ok(outcome) => break Some(outcome),
                Err(RecvTimeoutError::Disconnected) => break None,
                Err(RecvTimeoutError::Timeout) => {
                    let stops = watch.progress(f64::from_bits(done.load(Ordering::Relaxed))).is_break();
                    stop.store(stops, Ordering::Relaxed);
                }
            }
        };
        Ok(outcome.unwrap_or(Err(Error::Stopped)))
    })
}

/// Runs `work` without holding the interpreter lock. `progress` is None or False, a function of the completed
/// fraction, or True for a bar.
pub fn watched<T: Send>(
    progress: Option<Bound<'_, PyAny>>,
    py: Python<'_>,
    work: impl FnOnce(&mut dyn Monitor) -> Result<T> + Send,
) -> PyResult<T> {
    watched_on(None, progress, py, work)
}

/// The same on this number of `threads`, for this computation alone.
pub fn watched_on<T: Send>(
    threads: Option<Whole>,
    progress: Option<Bound<'_, PyAny>>,
    py: Python<'_>,
    work: impl FnOnce(&mut dyn Monitor) -> Result<T> + Send,
) -> PyResult<T> {
    match checked(threads)? {
        None => concluded(progress, |watch| Ok(detached(py, || work(watch)))),
        Some(number) => concluded(progress, |watch| {
            py.detach(|| on_threads(number, &AtomicBool::new(false), watch, work))
        }),
    }
}

/// The same for work that cannot ask its monitor while it writes a file, and looks at `stop` instead: it always has threads of its
/// own, so that this thread hears of signals all the time.
pub fn watched_writing<T: Send>(
    threads: Option<Whole>,
    stop: &AtomicBool,
    progress: Option<Bound<'_, PyAny>>,
    py: Python<'_>,
    work: impl FnOnce(&mut dyn Monitor) -> Result<T> + Send,
) -> PyResult<T> {
    let number = checked(threads)?.unwrap_or_else(rayon::current_num_threads);
    concluded(progress, |watch| py.detach(|| on_threads(number, stop, watch, work)))
}

/// A monitor that only stops.
struct Stoppable {
    stop: Arc<AtomicBool>,
    memory: Option<u64>,
}

impl Monitor for Stoppable {
    fn progress(&mut self, _fraction: f64) -> ControlFlow<()> {
        if self.stop.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn memory(&self) -> u64 {
        self.memory.unwrap_or_else(memory::available)
    }
}

/// Does `work` that may take long without asking its monitor, on a thread beside this one, which hears of signals meanwhile. What a
/// signal interrupts is left to itself, and ends when it asks or is done.
pub fn beside<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&mut dyn Monitor) -> T + Send + 'static,
) -> PyResult<T> {
    let memory = memory::in_environment().map_err(PyValueError::new_err)?;
    let stop = Arc::new(AtomicBool::new(false));
    let mut asked = Stoppable { stop: stop.clone(), memory };
    if threads::is_forked() {
        return Ok(detached(py, || work(&mut asked)));
    }
    threads::settle();
    let (send, receive) = mpsc::sync_channel(1);
    // As much stack as that of the main thread.
    let thread = std::thread::Builder::new().stack_size(8 << 20);
    let thread = thread.spawn(move || drop(send.send(work(&mut asked))))?;
    let received = py.detach(move || -> PyResult<Option<T>> {
        loop {
            match receive.recv_timeout(PERIOD) {
                Err(RecvTimeoutError::Timeout) => Python::attach(|py| py.check_signals())?,
                received => return Ok(received.ok()),
            }
        }
    });
    match received.inspect_err(|_| stop.store(true, Ordering::Relaxed))? {
        Some(done) => Ok(done),
        // It has panicked.
        None => match thread.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => unreachable!("a thread that ends sends what it has done"),
        },
    }
}

/// The requested number of threads, if it is a sensible one.
fn checked(threads: Option<Whole>) -> PyResult<Option<usize>> {
    let threads = threads.map(|number| number.get("threads")).transpose()?;
    if let Some(number) = threads {
        asperity_runner::threads::check(number)
            .map_err(|expected| error::invalid("threads", expected, number))?;
    }
    Ok(threads)
}

/// Does `work` under a watch, and returns its result, or what was raised meanwhile.
fn concluded<T>(
    progress: Option<Bound<'_, PyAny>>,
    work: impl FnOnce(&mut Watch) -> PyResult<Result<T>>,
) -> PyResult<T> {
    let progress = progress.map(|wish| listener(wish)).transpose()?.flatten();
    let memory = memory::in_environment().map_err(PyValueError::new_err)?;
    let mut watch = Watch { progress, memory, called: Instant::now(), most: 0.0, raised: None };
    match (work(&mut watch)?, watch.raised.take()) {
        // What was raised while the last part of the work was done is not lost.
        (Err(Error::Stopped) | Ok(_), Some(raised)) => Err(raised),
        (Err(other), _) => Err(error::core(other)),
        (Ok(done), _) => {
            if watch.progress.is_some() {
                watch.check(1.0)?;
            }
            Ok(done)
        }
    }
}

/// Runs `work` without holding the interpreter lock, in a forked process too.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> T {
    threads::settle();
    py.detach(work)
}

/// Asks `monitor` whether to continue after the given number of `all`.
pub fn report(monitor: &mut dyn Monitor, done: usize, all: usize) -> Result<()> {
    if monitor.progress(done as f64 / all as f64).is_break() { Err(Error::Stopped) } else { Ok(()) }
}

/// The function to call with the completed fraction, if any.
fn listener(wish: Bound<'_, PyAny>) -> PyResult<Option<Py<PyAny>>> {
    let py = wish.py();
    match wish.extract::<Option<bool>>() {
        Ok(Some(true)) => Ok(Some(py.import("asperity._progress")?.call_method0("bar")?.unbind())),
        Ok(_) => Ok(None),
        Err(_) if wish.is_callable() => Ok(Some(wish.unbind())),
        Err(_) => Err(error::wrong_type("progress", "a function of the fraction done, True or None", &wish)),
    }
}
