//! A part of the work, reported as a part of the whole.

use std::ops::ControlFlow;

use asperity::monitor::Monitor;
use asperity::{Error, Result};

/// Tells the monitor of the whole how far a part is.
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

/// Tells `monitor` the fraction done; an error if it wants to stop.
pub fn report(monitor: &mut dyn Monitor, fraction: f64) -> Result<()> {
    match monitor.progress(fraction) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Stopped),
    }
}
