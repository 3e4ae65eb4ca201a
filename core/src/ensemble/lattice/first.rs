//! When each contact of a lattice breaks for the first time.

use super::{Lattice, REPORT};
use crate::Result;
use crate::monitor::{Monitor, report};

impl Lattice {
    /// Drives the contacts until each has broken, and gives the drives at which they did so first, along rows.
    ///
    /// # Errors
    /// The monitor, who hears the share that has broken, says stop. The lattice is then between two avalanches.
    pub fn first_breaks(&mut self, monitor: &mut dyn Monitor) -> Result<Vec<f64>> {
        let mut first = vec![f64::INFINITY; self.size()];
        let (mut broken, mut events) = (0, 0);
        while broken < first.len() {
            if events % REPORT == 0 {
                report(monitor, broken as f64 / first.len() as f64)?;
            }
            let drive = self.next_event().drive;
            for contact in self.scar() {
                broken += usize::from(first[contact] == f64::INFINITY);
                first[contact] = first[contact].min(drive);
            }
            events += 1;
        }
        report(monitor, 1.0)?;
        Ok(first)
    }
}
