//! The watcher of a long computation: it hears how far the work is and may stop it.

use std::ops::ControlFlow;

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

/// Refuses `what` is asked for under `key` if it needs more bytes than allowed.
pub(crate) fn fits(key: &str, what: impl Into<String>, needed: u64, allowed: u64) -> crate::Result<()> {
    if needed <= allowed {
        return Ok(());
    }
    Err(crate::Error::TooLarge { key: key.into(), what: what.into(), needed, allowed })
}

/// Asks `monitor` whether to go on, as a `Result` for use with `?`.
pub(crate) fn report(monitor: &mut dyn Monitor, fraction: f64) -> crate::Result<()> {
    match monitor.progress(fraction) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(crate::Error::Stopped),
    }
}
