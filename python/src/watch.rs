//! The monitor of long computations: Ctrl-C and progress, while other Python threads run.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use asperity::monitor::Monitor;
use asperity::{Error, Result};
use asperity_runner::memory;
use pyo3::prelude::*;

use crate::{error, threads};

/// Interval between two checks for signals, and between two reports of progress.
const PERIOD: Duration = Duration::from_millis(20);

struct Watch {
    progress: Option<Py<PyAny>>,
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
        memory::available()
    }
}

/// Runs `work` without holding the interpreter lock. `progress` is None or False, a function of the completed
/// fraction, or True for a bar.
pub fn watched<T: Send>(
    progress: Option<Bound<'_, PyAny>>,
    py: Python<'_>,
    work: impl FnOnce(&mut dyn Monitor) -> Result<T> + Send,
) -> PyResult<T> {
    let progress = progress.map(|wish| listener(wish)).transpose()?.flatten();
    let mut watch = Watch { progress, called: Instant::now(), most: 0.0, raised: None };
    let outcome = detached(py, || work(&mut watch));
    match (outcome, watch.raised.take()) {
        (Err(Error::Stopped), Some(raised)) => Err(raised),
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
