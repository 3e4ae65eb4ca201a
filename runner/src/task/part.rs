//! How far a task is.

use std::ops::ControlFlow;

use asperity::monitor::Monitor;
pub use asperity::monitor::Part;
use asperity::{Error, Result};

/// Tells `monitor` the fraction done; an error if it wants to stop.
pub fn report(monitor: &mut dyn Monitor, fraction: f64) -> Result<()> {
    match monitor.progress(fraction) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Stopped),
    }
}
