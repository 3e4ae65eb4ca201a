//! The watcher of a long computation: it hears how far the work is and may stop it.

use std::ops::ControlFlow;

/// Hears the fraction done, answers whether to go on.
///
/// Progress bars, Ctrl-C, time limits and checkpoints are monitors; `()` watches nothing.
pub trait Monitor: Send {
    /// Called now and then with the fraction of the work done, in `[0, 1]`, never decreasing.
    fn progress(&mut self, fraction: f64) -> ControlFlow<()>;

    /// Called, by what goes from event to event, with the number of events so far and the drive.
    fn events(&mut self, _events: u64, _drive: f64) {}
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
}

/// Asks `monitor` whether to go on, as a `Result` for use with `?`.
pub(crate) fn report(monitor: &mut dyn Monitor, fraction: f64) -> crate::Result<()> {
    match monitor.progress(fraction) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(crate::Error::Stopped),
    }
}
